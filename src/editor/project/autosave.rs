//! What is not saved, written down while one works, and found again after a kill.
//!
//! `recovery/0.json` holds the graph, its file and its folder; `recovery/0.lock` is locked while the program
//! that writes it runs, which the system undoes however it ends. So a second window finds another number, and
//! what nobody holds is recoverable. Written by a thread of its own, some seconds after a change at the most
//! often; removed when the graph is saved or given up. Tested by dropping without a save, which is a kill to
//! the files.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use serde_json::{Value as Json, json};

use super::Project;
use crate::graph::Document;
use crate::image::atomic::{self, WriteError};

/// Between two writings.
pub const EVERY: Duration = Duration::from_secs(3);

/// Writes down what is not saved.
#[derive(Debug)]
pub struct Autosave {
    /// The program's own.
    state: PathBuf,
    slot: Option<Slot>,
    running: Option<JoinHandle<Result<(), WriteError>>>,
    /// The revision that is written, or being.
    revision: Option<u64>,
    last: Option<Instant>,
}

/// A number that is ours as long as the lock is held.
#[derive(Debug)]
struct Slot {
    file: PathBuf,
    _lock: File,
}

/// A graph that was not saved when its program ended.
#[derive(Debug)]
pub struct Recoverable {
    /// The graph.
    pub document: Document,
    /// Its own file.
    pub file: Option<PathBuf>,
    /// When it was written down.
    pub time: SystemTime,
    slot: Slot,
}

impl Autosave {
    /// In the program's own folder.
    pub fn new(state: &Path) -> Self {
        Self { state: state.to_owned(), slot: None, running: None, revision: None, last: None }
    }

    /// To be called each frame: writes where something changed and the last writing is long enough ago. Gives
    /// what went wrong with the last one, once.
    pub fn tick(&mut self, project: &Project, now: Instant) -> Option<String> {
        let failed = match self.running.as_ref().is_some_and(JoinHandle::is_finished) {
            true => self.finish(),
            false => None,
        };
        if !project.is_unsaved() {
            self.forget();
            return failed;
        }
        let is_due = self.last.is_none_or(|last| now.saturating_duration_since(last) >= EVERY);
        let is_new = project.revision() > 0 && self.revision != Some(project.revision());
        if self.running.is_some() || !is_due || !is_new {
            return failed;
        }
        (self.last, self.revision) = (Some(now), Some(project.revision()));
        if self.slot.is_none() {
            match Slot::claim(&self.state) {
                Ok(slot) => self.slot = Some(slot),
                Err(error) => {
                    self.revision = None;
                    return Some(format!(
                        "cannot write down what is not saved in {}: {error}",
                        self.state.display()
                    ));
                }
            }
        }
        let path = self.slot.as_ref().expect("claimed above").file.clone();
        let text = to_text(project);
        self.running = Some(std::thread::spawn(move || atomic::write(&path, text.as_bytes())));
        failed
    }

    /// Writes down a graph whose window cannot go on, where it is not saved; says what has become of it.
    /// What was written `earlier` goes once this is, not before.
    pub fn write_down(project: &Project, state: Option<PathBuf>, earlier: Option<Self>) -> &'static str {
        let Some(state) = state.filter(|_| project.is_unsaved()) else { return "" };
        let mut autosave = Self::new(&state);
        let failed = autosave.tick(project, Instant::now()).or_else(|| autosave.finish());
        match failed {
            None => {
                earlier.into_iter().for_each(|mut earlier| earlier.forget());
                "; what is not saved is offered at the next start"
            }
            Some(_) => "; what is not saved could not be written down",
        }
    }

    /// Waits until all is written; what went wrong.
    pub fn finish(&mut self) -> Option<String> {
        let result = self.running.take()?.join();
        let error = match result {
            Ok(Ok(())) => return None,
            Ok(Err(error)) => error.to_string(),
            Err(_) => "the thread that writes ended".to_owned(),
        };
        // So that it is tried again.
        self.revision = None;
        Some(format!("what is not saved could not be written down: {error}"))
    }

    /// Removes what was written: the graph is saved, or given up.
    pub fn forget(&mut self) {
        let _ = self.finish();
        (self.revision, self.last) = (None, None);
        if let Some(slot) = self.slot.take() {
            slot.remove();
        }
    }

    /// Goes on with a graph that was not saved. What was written down of another is forgotten.
    pub fn recover(&mut self, found: Recoverable) -> Project {
        self.forget();
        self.slot = Some(found.slot);
        Project::unsaved(found.document, found.file)
    }
}

impl Slot {
    fn claim(state: &Path) -> std::io::Result<Self> {
        let folder = state.join("recovery");
        std::fs::create_dir_all(&folder)?;
        for number in 0_u32.. {
            let file = folder.join(format!("{number}.json"));
            if let Some(slot) = Self::lock(&file)? {
                // What another left is not ours to write over. Asked under the lock.
                if !file.exists() {
                    return Ok(slot);
                }
            }
        }
        unreachable!("there are fewer programs than numbers")
    }

    /// `None` where another program holds it.
    fn lock(file: &Path) -> std::io::Result<Option<Self>> {
        let lock = File::create(file.with_extension("lock"))?;
        match lock.try_lock() {
            Ok(()) => Ok(Some(Self { file: file.to_owned(), _lock: lock })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }

    fn remove(self) {
        // The lock's file stays: another may be about to lock it, and two files of one name would be two locks.
        let _ = std::fs::remove_file(&self.file);
    }
}

impl Recoverable {
    /// Removes it for good.
    pub fn discard(self) {
        self.slot.remove();
    }
}

/// The graphs that were not saved when their program ended, newest first. One that is older than its file is
/// not among them: it was saved since.
pub fn recoverable(state: &Path) -> Vec<Recoverable> {
    let entries = std::fs::read_dir(state.join("recovery")).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    let mut found: Vec<Recoverable> = files.filter_map(|path| read(&path)).collect();
    found.sort_by_key(|found| std::cmp::Reverse(found.time));
    found
}

fn to_text(project: &Project) -> String {
    let document = project.document();
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let file = project.file().map(absolute);
    json!({"file": file, "base": absolute_or_here(&document.base), "graph": document.to_json()}).to_string()
}

/// The empty path is the working directory, which `absolute` refuses.
fn absolute_or_here(base: &Path) -> PathBuf {
    let base = if base.as_os_str().is_empty() { Path::new(".") } else { base };
    std::path::absolute(base).unwrap_or_else(|_| base.to_owned())
}

fn read(path: &Path) -> Option<Recoverable> {
    let slot = Slot::lock(path).ok()??;
    let time = std::fs::metadata(path).ok()?.modified().ok()?;
    let json: Json = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    let text = |field: &str| json.get(field).and_then(Json::as_str);
    let (document, _) = Document::open_leniently(text("graph")?, Path::new(text("base")?)).ok()?;
    let file = text("file").map(PathBuf::from);
    let saved = file.as_ref().and_then(|file| std::fs::metadata(file).ok()?.modified().ok());
    let is_newer = saved.is_none_or(|saved| time >= saved);
    is_newer.then_some(Recoverable { document, file, time, slot })
}

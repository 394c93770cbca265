//! The arrows between the folders of `src`, checked on the source text.
//!
//! [`ARROWS`] is the whole rule: who may name whom. A name counts wherever the code says `crate::X`,
//! `tyndall::X` or a chain of `super::` that leaves the file's own folder; comments and strings do not.
//! Limits: names that reach code through a glob or a re-export are not followed, and a `super` is taken to
//! stand at the top of its file, so one inside of an inline module counts for one folder too many (it then
//! names no other folder, unless two bear one name).

use std::path::{Path, PathBuf};

/// Who may name whom; each may name itself.
const ARROWS: &[(&str, &[&str])] = &[
    ("main", &["cli", "editor"]),
    (
        "editor",
        &[
            "session", "template", "nodes", "planner", "graph", "gpu", "wire", "image", "volume", "camera",
            "optics",
        ],
    ),
    ("cli", &["session", "template", "nodes", "planner", "graph", "gpu", "image", "volume"]),
    ("template", &["graph", "nodes", "volume"]),
    ("session", &["nodes", "planner", "graph", "gpu"]),
    ("planner", &["graph", "wire", "light", "optics"]),
    (
        "nodes",
        &["planner", "graph", "gpu", "wire", "optics", "volume", "light", "geometry", "image", "camera"],
    ),
    ("wire", &["gpu", "optics", "volume", "light", "geometry", "image", "camera"]),
    ("graph", &[]),
    ("gpu", &[]),
    ("volume", &["optics"]),
    ("light", &["optics"]),
    ("geometry", &["optics"]),
    ("image", &["optics"]),
    ("camera", &["optics"]),
    ("optics", &[]),
];

/// Crates that have one home.
const HOMES: &[(&str, &str)] = &[("wgpu", "gpu"), ("clap", "cli"), ("egui", "editor"), ("eframe", "editor")];

const MAX_LINES: usize = 500;

struct Source {
    /// Module path without `crate`: `["nodes", "sun"]` for `src/nodes/sun/mod.rs`.
    module: Vec<String>,
    path: PathBuf,
    text: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn files(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for path in entries {
        if path.is_dir() {
            files(&path, ending, found);
        } else if path.extension().is_some_and(|found| found == ending) {
            found.push(path);
        }
    }
    found.sort();
}

fn sources() -> Vec<Source> {
    let mut paths = Vec::new();
    files(&root().join("src"), "rs", &mut paths);
    let source = |path: PathBuf| {
        let inside = path.strip_prefix(root().join("src")).unwrap().with_extension("");
        let mut module: Vec<String> = inside.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        module.pop_if(|last| last == "mod");
        Source { text: std::fs::read_to_string(&path).unwrap(), module, path }
    };
    paths.into_iter().map(source).filter(|source| source.module != ["lib"]).collect()
}

/// The code alone: no comments, and strings emptied. Of characters in quotes only `'"'` matters here.
fn code(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let raw_hashes =
            rest.strip_prefix('r').map(|after| after.len() - after.trim_start_matches('#').len());
        let skipped = if rest.starts_with("//") {
            rest.find('\n')
        } else if rest.starts_with("'\"'") {
            Some(3)
        } else if raw_hashes.is_some_and(|n| rest[1 + n..].starts_with('"')) && !out.ends_with(is_word) {
            let end = format!("\"{}", "#".repeat(raw_hashes.unwrap_or(0)));
            let start = 1 + end.len();
            rest[start..].find(&end).map(|at| start + at + end.len())
        } else if c == '"' {
            let mut escaped = false;
            let closing = |c: char| {
                let closes = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                closes
            };
            rest[1..].find(closing).map(|at| at + 2)
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        out.push(' ');
        rest = &rest[skipped.unwrap_or(rest.len())..];
    }
    out
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The first names after a path's `::`: one, or those of a group in braces.
fn first_names(after: &str) -> Vec<&str> {
    let word = |text: &str| text.find(|c| !is_word(c)).unwrap_or(text.len());
    let Some(group) = after.strip_prefix('{') else {
        return vec![&after[..word(after)]];
    };
    let mut names = Vec::new();
    let (mut depth, mut starts) = (0, true);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => starts = true,
            c if starts && is_word(c) => {
                names.push(&group[at..at + word(&group[at..])]);
                starts = false;
            }
            _ => {}
        }
    }
    names
}

/// Modules that the code of `module` names, from the crate's root: `["gpu"]`, or `["nodes", "sun"]`.
fn named(module: &[String], text: &str) -> Vec<Vec<String>> {
    let code = code(text);
    let mut found = Vec::new();
    let starts = |word: &'static str| {
        let before = |at: usize| code[..at].chars().next_back();
        code.match_indices(word)
            .map(|(at, _)| at)
            .filter(move |&at| before(at).is_none_or(|c| !is_word(c) && c != ':'))
            .collect::<Vec<_>>()
    };
    for prefix in ["crate::", "tyndall::"] {
        for at in starts(prefix) {
            found.extend(
                first_names(&code[at + prefix.len()..]).into_iter().map(|name| vec![name.to_owned()]),
            );
        }
    }
    for at in starts("super::") {
        let mut after = &code[at..];
        let mut up = 0;
        while let Some(next) = after.strip_prefix("super::") {
            (after, up) = (next, up + 1);
        }
        let parent = &module[..module.len().saturating_sub(up)];
        found.extend(first_names(after).into_iter().map(|name| [parent, &[name.to_owned()]].concat()));
    }
    found
}

/// What breaks the arrows in one file.
fn wrong_arrows(module: &[String], text: &str) -> Vec<String> {
    let from = module[0].as_str();
    let Some((_, allowed)) = ARROWS.iter().find(|(area, _)| *area == from) else {
        return vec![format!("{from} has no line in ARROWS")];
    };
    let mut wrong = Vec::new();
    for path in named(module, text) {
        let to = path[0].as_str();
        let is_area = ARROWS.iter().any(|(area, _)| *area == to);
        if is_area && to != from && !allowed.contains(&to) {
            wrong.push(format!("{from} names {to}"));
        }
        // A node is a folder with a mod.rs; the files beside them are what nodes share.
        let other_node = from == "nodes"
            && path.len() > 1
            && module.get(1) != path.get(1)
            && !path[1].is_empty()
            && root().join("src/nodes").join(&path[1]).join("mod.rs").is_file();
        if to == from && other_node && module.len() > 1 {
            wrong.push(format!("node {} names node {}", module[1], path[1]));
        }
    }
    wrong
}

/// Crates named away from home.
fn wrong_crates(module: &[String], text: &str) -> Vec<String> {
    let code = code(text);
    let named = |word: &str| {
        code.match_indices(word).any(|(at, _)| {
            let before = code[..at].chars().next_back().is_none_or(|c| !is_word(c));
            before && code[at + word.len()..].starts_with("::")
        })
    };
    let away = HOMES.iter().filter(|(_, home)| module[0] != *home).map(|(name, _)| *name);
    away.filter(|name| named(name)).map(str::to_owned).collect()
}

#[test]
fn arrows_hold() {
    let sources = sources();
    assert!(sources.len() > 50, "only {} files found", sources.len());
    let wrong: Vec<String> = sources
        .iter()
        .flat_map(|source| {
            let at = source.path.display();
            wrong_arrows(&source.module, &source.text).into_iter().map(move |what| format!("{at}: {what}"))
        })
        .collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn crates_stay_at_home() {
    for source in sources() {
        let wrong = wrong_crates(&source.module, &source.text);
        assert!(wrong.is_empty(), "{} names {wrong:?}", source.path.display());
    }
}

#[test]
fn files_have_one_subject() {
    for source in sources() {
        let n = source.text.lines().count();
        assert!(n <= MAX_LINES, "{}: {n} lines, at most {MAX_LINES}", source.path.display());
    }
}

/// Whether `name` is what `pattern` may become when its `{keys}` are filled in.
fn fills(pattern: &str, name: &str) -> bool {
    let Some((head, rest)) = pattern.split_once('{') else { return pattern == name };
    let tail = rest.split_once('}').map_or("", |(_, tail)| tail);
    name.strip_prefix(head).is_some_and(|rest| {
        (0..=rest.len()).filter(|&at| rest.is_char_boundary(at)).any(|at| fills(tail, &rest[at..]))
    })
}

#[test]
fn every_shader_is_used() {
    let mut paths = Vec::new();
    files(&root().join("shaders"), "wgsl", &mut paths);
    assert!(paths.len() > 10, "only {} shaders found", paths.len());
    let shaders: Vec<(String, String)> = paths
        .iter()
        .map(|path| {
            let name = path.strip_prefix(root().join("shaders")).unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read_to_string(path).unwrap())
        })
        .collect();
    let imports: Vec<&str> = shaders
        .iter()
        .flat_map(|(_, text)| text.lines())
        .filter_map(|line| line.trim().strip_prefix("#import \"")?.strip_suffix('"'))
        .collect();
    let users: Vec<String> = sources().into_iter().map(|source| source.text).collect();
    for (name, _) in &shaders {
        let stage = name.trim_end_matches(".wgsl");
        // By its whole name, or as one of a folder's stages: format!("folder/{stage}").
        let (folder, file) = stage.split_once('/').unwrap_or(("", stage));
        let listed = [format!("\"{folder}/{{stage}}\""), format!("\"{file}\"")];
        let runs = users.iter().any(|text| {
            text.contains(&format!("stage(\"{stage}\"")) || listed.iter().all(|part| text.contains(part))
        });
        let imported = imports.iter().any(|pattern| fills(pattern, name));
        assert!(runs || imported, "shaders/{name} is neither imported nor a stage: use it or remove it");
    }
}

#[test]
fn a_wrong_arrow_is_seen() {
    let module = |path: &str| path.split('/').map(str::to_owned).collect::<Vec<_>>();
    let wrong = |path: &str, text: &str| !wrong_arrows(&module(path), text).is_empty();
    assert!(wrong("graph/check", "use crate::gpu::Gpu;"));
    assert!(wrong("graph/check", "use crate::{volume::{grid, vdb}, gpu};"));
    assert!(wrong("optics/phase", "fn f() { crate::nodes::catalog(); }"));
    assert!(wrong("optics/phase", "use super::super::nodes;"));
    assert!(wrong("nodes/raymarch", "use super::sun::KIND;"));
    assert!(wrong("nodes/raymarch", "use super::{NodeKind, sun};"));
    assert!(wrong("nodes/raymarch/layers", "use super::super::sun;"));
    assert!(wrong("session", "const A: &str = \"//\"; use crate::cli;"));
    assert!(wrong("main", "use tyndall::session::Session;"));
    assert!(wrong("attic/canvas", ""));
    assert!(!wrong("graph/check", "// crate::gpu\nconst A: (&str, char) = (\"crate::gpu\", '\"');"));
    assert!(!wrong("graph/check", "const A: &str = r#\"\" use crate::gpu\"#; use crate::graph::Key;"));
    assert!(!wrong("nodes/raymarch", "use super::{NodeKind, walk}; use crate::gpu::Gpu;"));
    assert!(!wrong("nodes", "use sun::KIND; use crate::graph::Value;"));
}

#[test]
fn a_crate_away_from_home_is_seen() {
    let module = |path: &str| vec![path.to_owned()];
    assert_eq!(wrong_crates(&module("nodes"), "use wgpu::Device;"), ["wgpu"]);
    assert_eq!(wrong_crates(&module("session"), "#[derive(clap::Args)] struct A;"), ["clap"]);
    assert_eq!(wrong_crates(&module("cli"), "use egui::Ui; use clap::Parser;"), ["egui"]);
    assert_eq!(wrong_crates(&module("gpu"), "use wgpu::Device; // egui::Ui"), [] as [&str; 0]);
    assert_eq!(wrong_crates(&module("nodes"), "use my_wgpu::Device;"), [] as [&str; 0]);
}

#[test]
fn a_pattern_is_filled() {
    assert!(fills("lib/spectrum_{channels}.wgsl", "lib/spectrum_3.wgsl"));
    assert!(fills("a", "a") && !fills("a", "ab"));
    assert!(!fills("lib/spectrum_{channels}.wgsl", "lib/spectrum_3.glsl"));
}

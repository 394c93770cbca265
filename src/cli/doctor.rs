//! `tyndall doctor`: what this machine can do, proven by a small picture, and what it lacks.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use tyndall::gpu::{AdapterChoice, AdapterReport, adapters};
use tyndall::graph::{CancelToken, Document, Target};
use tyndall::session::Session;

use super::REFUSED;
use super::output::{NAME, RIGHT, TITLE, WRONG, columns, print, size};

/// Show the adapters of this machine, what is missing and how to install it.
///
/// Exit code 0: a picture can be rendered, else 2.
#[derive(clap::Args)]
pub struct Args {
    /// The adapter to try: auto, cpu, or a part of its name.
    #[arg(long, value_name = "ADAPTER", default_value = "auto", value_parser = <AdapterChoice as std::str::FromStr>::from_str)]
    adapter: AdapterChoice,
}

/// Every solver has a part in it.
const GRAPH: &str = r#"{ "tyndall": 1,
  "nodes": {
    "ball": { "type": "shape", "resolution": 4 },
    "medium": { "type": "medium", "g": 0.5 },
    "sun": { "type": "sun" },
    "split": { "type": "light_decomposition" },
    "beams": { "type": "principal_propagation" },
    "residual": { "type": "isotropic_residual" },
    "camera": { "type": "camera", "width": 8, "height": 8 },
    "march": { "type": "raymarch" }
  },
  "wires": [
    "ball.volume -> medium.volume", "sun.light -> split.lights",
    "medium.medium -> beams.medium", "split.ordinates -> beams.ordinates",
    "medium.medium -> residual.medium", "beams.beams -> residual.beams",
    "medium.medium -> march.medium", "beams.beams -> march.beams",
    "residual.residual -> march.residual", "camera.camera -> march.camera"
  ] }"#;

/// Prints the findings.
///
/// # Errors
/// When stdout cannot be written.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let found = adapters();
    let mut text = format!("{TITLE}Tyndall {}{TITLE:#}\n", env!("CARGO_PKG_VERSION"));
    for adapter in &found {
        describe(adapter, &mut text);
    }
    let code = match try_picture(&args.adapter) {
        Ok((name, ms)) => {
            let _ = writeln!(
                text,
                "{RIGHT}A picture can be rendered:{RIGHT:#} a test of 8x8 pixels took {ms:.0} ms on {name}."
            );
            ExitCode::SUCCESS
        }
        Err(why) => {
            // Without any adapter the help says it all.
            let why = if found.is_empty() { "there is no adapter with Vulkan, Metal or DX12" } else { &why };
            let _ = writeln!(text, "{WRONG}No picture can be rendered:{WRONG:#} {why}");
            text += help(&found);
            ExitCode::from(REFUSED)
        }
    };
    if !found.is_empty() && std::env::consts::OS == "linux" && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        text += "Mesa's remark about XDG_RUNTIME_DIR is harmless; NODEVICE_SELECT=1 in the environment silences it.\n";
    }
    print(&text)?;
    Ok(code)
}

fn describe(adapter: &AdapterReport, text: &mut String) {
    let _ = writeln!(text, "{NAME}{}{NAME:#}", adapter.name);
    let missing = match adapter.missing.as_slice() {
        [] => "nothing".to_owned(),
        missing => missing.join(", "),
    };
    let timestamps = if adapter.timestamps { "yes" } else { "no, GPU times are not shown" };
    let rows = [
        ("type", adapter.device_type.clone()),
        ("backend", adapter.backend.clone()),
        ("driver", adapter.driver.clone()),
        ("largest 3-D texture", format!("{0} x {0} x {0}", adapter.max_texture_3d)),
        ("largest buffer", size(adapter.max_buffer_bytes)),
        ("largest storage binding", size(adapter.max_storage_binding_bytes)),
        ("timestamps", timestamps.to_owned()),
        ("missing", missing),
    ];
    *text += &columns(&rows.map(|(name, value)| vec![name.to_owned(), value]));
}

/// The adapter's name and the time in ms, or why there is no picture.
fn try_picture(choice: &AdapterChoice) -> Result<(String, f64), String> {
    let mut session = Session::open(choice).map_err(|error| error.to_string())?;
    let document = Document::parse(GRAPH, Path::new("")).map_err(|error| error.to_string())?;
    let solved = session.solve(&document, Target::Sinks, &CancelToken::new(), &mut |_| {});
    if let Some((name, why)) = solved.evaluation.failures().next() {
        return Err(format!("node '{name}': {why}"));
    }
    Ok((session.gpu().report().name.clone(), solved.wall_ms))
}

/// What to install, by system.
fn help(found: &[AdapterReport]) -> &'static str {
    match (std::env::consts::OS, found.iter().all(|adapter| !adapter.missing.is_empty())) {
        (_, false) => "Another adapter of the list may do: --adapter NAME.\n",
        ("linux", _) => {
            "Install a Vulkan driver. Debian, Ubuntu: `apt-get install mesa-vulkan-drivers` (AMD, Intel, and any CPU); \
             NVIDIA: the package of its driver, such as nvidia-driver, with its Vulkan part.\n\
             VK_DRIVER_FILES and VK_ICD_FILENAMES in the environment, if set, must name files that exist.\n"
        }
        ("macos", _) => "Metal comes with macOS; version 12 or later is needed.\n",
        _ => "Install the graphics driver of the GPU's vendor; it brings Vulkan or DX12.\n",
    }
}

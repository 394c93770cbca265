//! Where the time of a picture goes: `cargo bench --bench picture -- GRAPH...`
//!
//! Renders each graph cold and warm, moves its camera, and prints the wall clock of all three, the cost
//! of each node, and the GPU time of each stage beside what a plain copy of the same device moves in this
//! run. Timings belong here, never into tests.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use tyndall::gpu::{AdapterChoice, Bind, Format, Gpu};
use tyndall::graph::{CancelToken, Document, Target};
use tyndall::nodes;
use tyndall::session::{Session, Solved};

fn main() -> anyhow::Result<()> {
    let graphs: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let adapter = std::env::var("TYNDALL_ADAPTER").unwrap_or_else(|_| "auto".to_owned());
    let adapter: AdapterChoice = adapter.parse()?;
    for graph in &graphs {
        let mut document = Document::load(Path::new(graph))?;
        let mut session = Session::open(&adapter)?;
        let report = session.gpu().report().clone();
        println!("# {graph} on {} ({})", report.name, report.driver);
        println!("copy kernel: {:.1} GB/s read and written", copy_bandwidth(session.gpu())?);
        solve("cold", &mut session, &document);
        // A fresh cache on the same device: pipelines are compiled, nothing else is known.
        session.forget();
        let warm = solve("warm", &mut session, &document);
        for cost in &warm.costs {
            println!(
                "  {:12} {:24} {:8.1} ms wall {:8.1} ms GPU {:7.1} MiB",
                cost.name,
                cost.kind,
                cost.cpu_ms,
                cost.gpu_ms,
                mib(cost.bytes)
            );
        }
        println!("  peak on the device: {:.0} MiB", mib(warm.peak_gpu_bytes));
        for camera in cameras(&document) {
            let moved = document.nodes[&camera].params["position"].as_array().map(|p| {
                let [x, y, z] = [0, 1, 2].map(|axis| p[axis].as_f64().unwrap_or(0.0));
                format!("[{}, {}, {}]", x + 0.01 * z, y, z - 0.01 * x)
            });
            if let Some(moved) = moved {
                document.set(nodes::catalog(), &format!("{camera}.position"), &moved)?;
            }
        }
        solve("camera moved", &mut session, &document);
        session.forget();
        session.gpu().time_stages();
        solve("stages timed apart", &mut session, &document);
        let mut stages: BTreeMap<String, (usize, f64)> = BTreeMap::new();
        for time in session.gpu().take_stage_times() {
            let entry = stages.entry(time.stage).or_default();
            entry.0 += 1;
            entry.1 += time.gpu_ms;
        }
        for (stage, (count, ms)) in stages {
            println!("  {stage:32} {count:5} x {ms:9.2} ms");
        }
    }
    Ok(())
}

fn cameras(document: &Document) -> Vec<String> {
    document.nodes.iter().filter(|(_, node)| node.type_id == "camera").map(|(name, _)| name.clone()).collect()
}

fn solve(what: &str, session: &mut Session, document: &Document) -> Solved {
    let start = Instant::now();
    let solved = session.solve(document, Target::Sinks, &CancelToken::new(), &mut |_| ());
    println!("{what}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    for (name, message) in solved.evaluation.failures() {
        println!("  {name}: {message}");
    }
    solved
}

fn mib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// GB/s of a kernel that copies 128³ texels of 16 bytes, best of five.
fn copy_bandwidth(gpu: &Gpu) -> anyhow::Result<f64> {
    let dims = [128; 3];
    let [from, to] =
        [0, 1].map(|_| gpu.texture3("copied", dims, Format::Rgba32Float, "")).map(|texture| texture.unwrap());
    let stage = gpu.stage("copy", &[])?;
    let bound = stage.bind(gpu, &[128_u32, 128, 128, 0], &[Bind::Texture(&from)], &[Bind::Texture(&to)]);
    let mut best = f64::INFINITY;
    for _ in 0..6 {
        let mut recorder = gpu.recorder("copy");
        recorder.dispatch(&bound, dims);
        best = best.min(recorder.finish()?);
    }
    Ok((from.bytes() + to.bytes()) as f64 / best * 1e-6)
}

//! Where the time of a picture goes: `cargo bench --bench picture -- GRAPH...`
//!
//! Renders each graph cold and warm, moves its camera, and prints the wall clock of all three, the cost
//! of each node, and the GPU time of each stage over the time in which a plain copy of this run moves what the
//! stage moves: the ratios of `planner::cost`. Timings belong here, never into tests.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use tyndall::gpu::AdapterChoice;
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
        let explained = session.explain(&document, Target::Sinks)?;
        println!("copy kernel: {:.2} GB/s read and written", explained.copy_gb_per_s);
        session.forget();
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
        // Copied again, because the machine may be slower by now.
        let copy_gb_per_s = session.gpu().copy_gb_per_s()?;
        println!("copy kernel: {copy_gb_per_s:.2} GB/s read and written");
        let works: Vec<_> = explained.nodes.iter().flat_map(|node| &node.report.stages).collect();
        for (stage, (count, ms)) in stages {
            let moved: u64 =
                works.iter().filter(|work| work.stage == stage).filter_map(|work| work.moved_bytes).sum();
            let floor_ms = moved as f64 / copy_gb_per_s * 1e-6;
            let ratio = if moved > 0 { format!("{:8.2}", ms / floor_ms) } else { "       -".to_owned() };
            println!(
                "  {stage:36} {count:5} x {ms:9.2} ms {:8.1} MB {ratio} of its floor",
                moved as f64 * 1e-6
            );
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

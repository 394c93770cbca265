fn main() -> anyhow::Result<()> {
    use tyndall::graph::*;
    let path = std::env::args().nth(1).unwrap();
    let doc = Document::load(std::path::Path::new(&path))?;
    for p in check(&doc, tyndall::nodes::catalog(), Target::Sinks) {
        println!("{p}");
    }
    let mut s = tyndall::session::Session::open(&"auto".parse()?)?;
    for _ in 0..2 {
        let r = s.solve(&doc, Target::Sinks, &CancelToken::new(), &mut |e| eprintln!("{e:?}"));
        for c in &r.costs {
            println!("{c:?}");
        }
        println!("{} ms peak {} MiB", r.wall_ms, r.peak_gpu_bytes >> 20);
        for (n, e) in r.evaluation.failures() {
            println!("{n}: {e}");
        }
    }
    Ok(())
}

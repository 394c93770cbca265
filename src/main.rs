//! The program `tyndall`: its command line stands in `cli`, the window in `editor`, everything else in the library.
#![forbid(unsafe_code)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::main(|graph, adapter| Ok(tyndall::editor::open(graph, adapter)?))
}

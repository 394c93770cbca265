//! What a node tells in words: its state, what it cost, what was left out. Tested by the texts.

use crate::editor::panels::status_bar::{size, time};
use crate::editor::{NodeState, NodeStatus};
use crate::graph::Decision;

/// Less reads 0.0 ms.
const LEAST_MS: f64 = 0.05;

/// State and cost for the foot of a node, the most that can be said first, then ever less, for less room.
pub fn foot(status: &NodeStatus) -> Vec<String> {
    let word = match &status.state {
        NodeState::Idle => "idle",
        NodeState::Stale => "stale",
        NodeState::Running => "running",
        NodeState::Done if status.cached => "cached",
        NodeState::Done => "",
        // The message itself, cut where the room ends.
        NodeState::Failed(message) => return vec![message.lines().next().unwrap_or_default().to_owned()],
        NodeState::Skipped(because) => return vec![format!("waits for {because}")],
    };
    let joined = |parts: &[&str]| {
        parts.iter().filter(|part| !part.is_empty()).copied().collect::<Vec<_>>().join(" · ")
    };
    let both = times(status).join(" · ");
    let [longest, memory] = [longest(status), bytes(status)];
    let mut texts = vec![
        joined(&[word, &both, &memory]),
        joined(&[word, &longest, &memory]),
        joined(&[word, &longest]),
        if word.is_empty() { longest } else { word.to_owned() },
    ];
    texts.dedup();
    texts
}

/// "gpu 12 ms" and "cpu 30 ms", as far as there are such.
fn times(status: &NodeStatus) -> Vec<String> {
    let parts = [("gpu", status.gpu_ms), ("cpu", status.cpu_ms)];
    parts.into_iter().filter(|(_, ms)| *ms >= LEAST_MS).map(|(of, ms)| format!("{of} {}", time(ms))).collect()
}

/// The time of the one that took longer: both wait for the other.
fn longest(status: &NodeStatus) -> String {
    let ms = status.gpu_ms.max(status.cpu_ms);
    if ms >= LEAST_MS { time(ms) } else { String::new() }
}

/// "3.4 MiB"; nothing of nothing.
fn bytes(status: &NodeStatus) -> String {
    if status.bytes > 0 { size(status.bytes) } else { String::new() }
}

/// What the scene did not require.
pub fn left_out(status: &NodeStatus) -> impl Iterator<Item = &Decision> {
    status.report.decisions.iter().filter(|decision| !decision.kept)
}

/// What was left out of a node's run, and why, a line each.
pub fn reasons(status: &NodeStatus) -> String {
    let line = |decision: &Decision| format!("{}: {}", decision.what, decision.reason);
    left_out(status).map(line).collect::<Vec<_>>().join("\n")
}

/// The state and the cost in words.
pub fn state_text(status: &NodeStatus) -> String {
    let state = match &status.state {
        NodeState::Idle => "idle: nothing that is shown needs it".to_owned(),
        NodeState::Stale => "stale: something that it depends on changed".to_owned(),
        NodeState::Running => "running".to_owned(),
        NodeState::Done if status.cached => "done, from the cache".to_owned(),
        NodeState::Done => "done".to_owned(),
        NodeState::Failed(message) => format!("failed: {message}"),
        NodeState::Skipped(because) => format!("skipped, because {because} failed"),
    };
    let cost = times(status).into_iter().chain(Some(bytes(status)).filter(|text| !text.is_empty()));
    let cost: Vec<String> = cost.collect();
    if cost.is_empty() { state } else { format!("{state}; {}", cost.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(state: NodeState, cpu_ms: f64, gpu_ms: f64, bytes: u64) -> NodeStatus {
        NodeStatus { state, cpu_ms, gpu_ms, bytes, ..NodeStatus::default() }
    }

    #[test]
    fn a_foot_says_as_much_as_there_is_room_for() {
        let all = foot(&status(NodeState::Stale, 4321.0, 12.3, 3_565_158));
        assert_eq!(
            all,
            ["stale · gpu 12 ms · cpu 4.3 s · 3.4 MiB", "stale · 4.3 s · 3.4 MiB", "stale · 4.3 s", "stale"]
        );
        let cached = NodeStatus { cached: true, ..status(NodeState::Done, 0.25, 0.0, 0) };
        assert_eq!(foot(&cached), ["cached · cpu 0.2 ms", "cached · 0.2 ms", "cached"]);
        assert_eq!(foot(&status(NodeState::Done, 5.0, 0.0, 0)), ["cpu 5.0 ms", "5.0 ms"]);
        assert_eq!(foot(&status(NodeState::Idle, 0.0, 0.0, 0)), ["idle"]);
        assert_eq!(foot(&status(NodeState::Failed("g is 3\nmore".into()), 1.0, 0.0, 0)), ["g is 3"]);
        assert_eq!(foot(&status(NodeState::Skipped("sun".into()), 1.0, 0.0, 0)), ["waits for sun"]);
    }

    #[test]
    fn memory_reads_well() {
        let of = |n| bytes(&status(NodeState::Done, 0.0, 0.0, n));
        assert_eq!([of(0), of(999), of(123 << 30), of(3_565_158)], ["", "999 B", "123 GiB", "3.4 MiB"]);
    }

    #[test]
    fn a_state_tells_its_cost() {
        let text = state_text(&status(NodeState::Done, 30.0, 12.0, 2048));
        assert_eq!(text, "done; gpu 12 ms, cpu 30 ms, 2.0 KiB");
        assert_eq!(state_text(&status(NodeState::Running, 0.0, 0.0, 0)), "running");
    }
}

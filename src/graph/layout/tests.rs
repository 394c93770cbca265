use std::path::Path;

use super::*;

/// Nodes `n0`.. with these wires; node i is 40 + 10 (i mod 4) high.
fn document(n_nodes: usize, wires: &[(usize, usize)]) -> Document {
    let nodes: Vec<String> = (0..n_nodes).map(|i| format!("\"n{i}\": {{\"type\": \"x\"}}")).collect();
    let wires: Vec<String> = wires.iter().map(|(a, b)| format!("\"n{a}.out -> n{b}.in\"")).collect();
    let text =
        format!("{{\"tyndall\": 1, \"nodes\": {{{}}}, \"wires\": [{}]}}", nodes.join(","), wires.join(","));
    Document::parse(&text, Path::new("")).unwrap()
}

fn size(name: &str) -> [f64; 2] {
    let number: usize = name[1..].parse().unwrap();
    [100.0, 40.0 + 10.0 * (number % 4) as f64]
}

fn overlaps(places: &IndexMap<String, [f64; 2]>) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    for (i, (a, at_a)) in places.iter().enumerate() {
        for (b, at_b) in places.iter().skip(i + 1) {
            let apart = |axis: usize| {
                at_a[axis] + size(a)[axis] <= at_b[axis] || at_b[axis] + size(b)[axis] <= at_a[axis]
            };
            if !apart(0) && !apart(1) {
                found.push((a.as_str(), b.as_str()));
            }
        }
    }
    found
}

/// Wires from a node to one of the next dozen, by a linear congruence (Numerical Recipes, 1992).
fn tangle(n_nodes: usize) -> Vec<(usize, usize)> {
    let mut state = 1_u32;
    let mut wires = Vec::new();
    for from in 0..n_nodes - 1 {
        for _ in 0..2 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            wires.push((from, (from + 1 + (state >> 24) as usize % 12).min(n_nodes - 1)));
        }
    }
    wires
}

#[test]
fn nothing_overlaps_and_wires_lead_right() {
    for n_nodes in [1, 2, 7, 60] {
        let wires = if n_nodes > 1 { tangle(n_nodes) } else { Vec::new() };
        let places = layered(&document(n_nodes, &wires), size);
        assert_eq!(places.len(), n_nodes);
        assert_eq!(overlaps(&places), []);
        for (a, b) in wires {
            let [a, b] = [a, b].map(|idx| places[idx][0]);
            assert!(a + 100.0 < b, "{a} {b}");
        }
    }
    assert!(layered(&document(0, &[]), size).is_empty());
}

#[test]
fn overlaps_are_seen() {
    let places = [("n0", [0.0, 0.0]), ("n1", [99.0, 39.0]), ("n2", [99.0, 200.0])];
    let places = places.map(|(name, place)| (name.to_owned(), place));
    assert_eq!(overlaps(&IndexMap::from(places)), [("n0", "n1")]);
}

#[test]
fn a_cycle_still_gets_places() {
    let places = layered(&document(4, &[(0, 1), (1, 2), (2, 0), (2, 3), (3, 3)]), size);
    assert_eq!(overlaps(&places), []);
    assert!(places["n0"][0] < places["n1"][0] && places["n2"][0] < places["n3"][0]);
}

#[test]
fn a_source_stands_beside_its_first_reader() {
    // 0 -> 1 -> 2 -> 3, and 4 into 3 alone.
    let places = layered(&document(5, &[(0, 1), (1, 2), (2, 3), (4, 3)]), size);
    assert_eq!(places["n4"][0], places["n2"][0]);
}

#[test]
fn wires_that_need_not_cross_do_not() {
    // 0 -> 3 and 1 -> 2, where the document's order would cross them.
    let places = layered(&document(5, &[(0, 3), (1, 2), (2, 4), (3, 4)]), size);
    let is_above = |a: &str, b: &str| places[a][1] < places[b][1];
    assert_eq!(is_above("n0", "n1"), is_above("n3", "n2"));
}

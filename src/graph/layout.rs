//! Places for nodes: layers from left to right along the wires.
//!
//! After K. Sugiyama, S. Tagawa, M. Toda, "Methods for visual understanding of hierarchical system
//! structures" (IEEE Trans. SMC 11, 1981): a node's layer is one more than the farthest of those that it
//! reads; a node that reads nothing moves right to stand beside its first reader; inside of the layers
//! nodes are ordered by the mean place of their neighbors, sweeping to and fro. Heights follow the
//! neighbors as far as what stands above leaves room. Wires of a cycle that lead back are left out of the
//! count. Limits: wires that skip layers get no lane of their own. Tested: nothing overlaps, wires lead to
//! the right, the same document gives the same places.

use indexmap::IndexMap;

use super::document::Document;

/// Room between layers and between the nodes of one, in points.
const GAP: [f64; 2] = [72.0, 28.0];
/// Sweeps of ordering; the crossings of graphs of this size settle in fewer.
const N_SWEEPS: usize = 8;

/// A place for every node, the first at the origin's right and below; `size` tells how large a node is drawn.
pub fn layered(document: &Document, size: impl Fn(&str) -> [f64; 2]) -> IndexMap<String, [f64; 2]> {
    let n_nodes = document.nodes.len();
    let (reads, readers) = neighbors(document);
    let ranks = ranks(&reads, &readers);
    let mut layers = vec![Vec::new(); ranks.iter().max().map_or(0, |last| last + 1)];
    for (idx, rank) in ranks.iter().enumerate() {
        layers[*rank].push(idx);
    }
    // An index among its layer, in heights of a node, while the order is sought.
    let mut slot = vec![0.0; n_nodes];
    let renumber = |layer: &[usize], slot: &mut [f64]| {
        for (place, idx) in layer.iter().enumerate() {
            slot[*idx] = place as f64 - layer.len() as f64 / 2.0;
        }
    };
    for layer in &layers {
        renumber(layer, &mut slot);
    }
    for sweep in 0..N_SWEEPS {
        let near = if sweep % 2 == 0 { &reads } else { &readers };
        let mut order: Vec<usize> = (0..layers.len()).collect();
        if sweep % 2 == 1 {
            order.reverse();
        }
        for rank in order {
            let wanted = |idx: &usize| mean(&near[*idx], &slot).unwrap_or(slot[*idx]);
            layers[rank].sort_by(|a, b| wanted(a).total_cmp(&wanted(b)));
            renumber(&layers[rank], &mut slot);
        }
    }
    let sizes: Vec<[f64; 2]> = document.nodes.keys().map(|name| size(name)).collect();
    let y = heights(&layers, &reads, &readers, &sizes);
    let top = y.iter().copied().fold(f64::INFINITY, f64::min);
    let mut x = 0.0;
    let mut left = vec![0.0; layers.len()];
    for (rank, layer) in layers.iter().enumerate() {
        left[rank] = x;
        x += layer.iter().map(|idx| sizes[*idx][0]).fold(0.0, f64::max) + GAP[0];
    }
    let place = |(idx, name): (usize, &String)| (name.clone(), [left[ranks[idx]], (y[idx] - top).round()]);
    document.nodes.keys().enumerate().map(place).collect()
}

/// For each node those that it reads and those that read it, without repeats, loops and the wires that lead
/// back in a cycle.
fn neighbors(document: &Document) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
    let n_nodes = document.nodes.len();
    let (mut reads, mut readers) = (vec![Vec::new(); n_nodes], vec![Vec::new(); n_nodes]);
    let place = |name: &str| document.nodes.get_index_of(name);
    for wire in &document.wires {
        let (Some(from), Some(to)) = (place(&wire.from.node), place(&wire.to.node)) else { continue };
        if from != to && !readers[from].contains(&to) {
            readers[from].push(to);
        }
    }
    // Depth first; a wire to a node on the path leads back.
    let (mut done, mut on_path) = (vec![false; n_nodes], vec![false; n_nodes]);
    for start in 0..n_nodes {
        let mut path = vec![(start, 0)];
        if done[start] {
            continue;
        }
        on_path[start] = true;
        while let Some((here, next)) = path.last_mut() {
            match readers[*here].get(*next).copied() {
                Some(reader) if on_path[reader] => drop(readers[*here].remove(*next)),
                Some(reader) => {
                    *next += 1;
                    if !done[reader] {
                        on_path[reader] = true;
                        path.push((reader, 0));
                    }
                }
                None => {
                    (done[*here], on_path[*here]) = (true, false);
                    path.pop();
                }
            }
        }
    }
    for (from, to) in readers.iter().enumerate().flat_map(|(from, all)| all.iter().map(move |to| (from, *to)))
    {
        reads[to].push(from);
    }
    (reads, readers)
}

/// The layer of each node: the longest path to it, but for what reads nothing the layer before its first
/// reader.
fn ranks(reads: &[Vec<usize>], readers: &[Vec<usize>]) -> Vec<usize> {
    let mut ranks = vec![0_usize; reads.len()];
    let mut waits_for: Vec<usize> = reads.iter().map(Vec::len).collect();
    let mut ready: Vec<usize> = (0..reads.len()).filter(|idx| waits_for[*idx] == 0).collect();
    while let Some(idx) = ready.pop() {
        for &reader in &readers[idx] {
            ranks[reader] = ranks[reader].max(ranks[idx] + 1);
            waits_for[reader] -= 1;
            if waits_for[reader] == 0 {
                ready.push(reader);
            }
        }
    }
    for idx in (0..reads.len()).filter(|idx| reads[*idx].is_empty()) {
        let first = readers[idx].iter().map(|reader| ranks[*reader]).min();
        ranks[idx] = first.map_or(0, |first| first - 1);
    }
    ranks
}

fn mean(near: &[usize], value: &[f64]) -> Option<f64> {
    (!near.is_empty()).then(|| near.iter().map(|idx| value[*idx]).sum::<f64>() / near.len() as f64)
}

/// The top of each node: its middle at the mean of its neighbors', as far as its layer's order leaves room.
fn heights(
    layers: &[Vec<usize>],
    reads: &[Vec<usize>],
    readers: &[Vec<usize>],
    sizes: &[[f64; 2]],
) -> Vec<f64> {
    let mut middle = vec![0.0; sizes.len()];
    let stack = |layer: &[usize], wanted: &[f64], middle: &mut [f64]| {
        let mut bottom = f64::NEG_INFINITY;
        for (idx, wanted) in layer.iter().zip(wanted) {
            let half = sizes[*idx][1] / 2.0;
            middle[*idx] = wanted.max(bottom + half);
            bottom = middle[*idx] + half + GAP[1];
        }
        // What was pushed down is pushed back as a whole, so that the layer stays where it is wanted.
        let pushed = layer.iter().zip(wanted).map(|(idx, wanted)| middle[*idx] - wanted);
        let shift = pushed.sum::<f64>() / layer.len().max(1) as f64;
        for idx in layer {
            middle[*idx] -= shift;
        }
    };
    for layer in layers {
        stack(layer, &vec![0.0; layer.len()], &mut middle);
    }
    for sweep in 0..N_SWEEPS {
        let near = if sweep % 2 == 0 { reads } else { readers };
        let mut order: Vec<usize> = (0..layers.len()).collect();
        if sweep % 2 == 1 {
            order.reverse();
        }
        for rank in order {
            let layer = &layers[rank];
            let wanted: Vec<f64> =
                layer.iter().map(|idx| mean(&near[*idx], &middle).unwrap_or(middle[*idx])).collect();
            stack(layer, &wanted, &mut middle);
        }
    }
    middle.iter().zip(sizes).map(|(middle, size)| middle - size[1] / 2.0).collect()
}

#[cfg(test)]
mod tests;

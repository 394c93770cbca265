// Surfaces between cells: a bit for each pair of opposite directions.

@group(1) @binding(1) var<storage, read> walls: array<u32>;

// Whether one stands between a cell and the next along the even direction of a pair.
fn is_walled(cell: i32, pair: u32) -> bool {
    return ((walls[cell] >> pair) & 1u) == 1u;
}

//! Some nodes of a surface, spread evenly over all parts.

/// Nodes of a part at least, as far as it has them.
const LEAST: usize = 32;

/// About `n` of the surface's nodes, rising: of each part as many as its share of all nodes, along a curve that fills
/// space.
pub fn spread(nodes: &[[f64; 3]], triangles: &[[u32; 3]], part: &[i32], n: usize) -> Vec<u32> {
    let mut by_part: Vec<(i32, u32)> =
        triangles.iter().zip(part).flat_map(|(triangle, &part)| triangle.map(|node| (part, node))).collect();
    // A node where parts meet counts for the first of them.
    by_part.sort_unstable_by_key(|&(part, node)| (node, part));
    by_part.dedup_by_key(|&mut (_, node)| node);
    let n_all = by_part.len();
    by_part.sort_unstable();
    let mut chosen: Vec<u32> = Vec::new();
    for own in by_part.chunk_by(|a, b| a.0 == b.0) {
        let own: Vec<u32> = own.iter().map(|&(_, node)| node).collect();
        let share = (n * own.len()).div_ceil(n_all).max(LEAST).min(own.len());
        let curve = along_curve(nodes, own);
        chosen.extend((0..share).map(|i| curve[i * curve.len() / share]));
    }
    chosen.sort_unstable();
    chosen
}

/// Nodes in the order in which Morton's curve passes them in the cube around them (Morton 1966).
fn along_curve(nodes: &[[f64; 3]], mut own: Vec<u32>) -> Vec<u32> {
    const CELLS: f64 = 1024.0;
    let end = |axis: usize, sign: f64| own.iter().map(|&n| sign * nodes[n as usize][axis]).fold(f64::MIN, f64::max);
    let low = [0, 1, 2].map(|axis| -end(axis, -1.0));
    let side = [0, 1, 2].map(|axis| end(axis, 1.0) - low[axis]).into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let cell = |n: u32, axis: usize| ((nodes[n as usize][axis] - low[axis]) / side * (CELLS - 1.0)) as u32;
    own.sort_by_cached_key(|&n| ((0..3).map(|axis| every_third_bit(cell(n, axis)) << axis).sum::<u32>(), n));
    own
}

/// The ten lowest bits with two zeros between them.
fn every_third_bit(x: u32) -> u32 {
    (0..10).map(|bit| (x >> bit & 1) << (3 * bit)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A large square of 40 x 40 cells and a small one of 2 x 2.
    fn squares() -> (Vec<[f64; 3]>, Vec<[u32; 3]>, Vec<i32>) {
        let (mut nodes, mut triangles, mut part) = (Vec::new(), Vec::new(), Vec::new());
        for (number, n, x0) in [(0, 40, 0.0), (1, 2, 100.0)] {
            let first = nodes.len() as u32;
            let node = |i: u32, j: u32| first + i + (n + 1) * j;
            nodes.extend((0..(n + 1) * (n + 1)).map(|k| [x0 + f64::from(k % (n + 1)), f64::from(k / (n + 1)), 0.0]));
            for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
                triangles.extend([
                    [node(i, j), node(i + 1, j), node(i, j + 1)],
                    [node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)],
                ]);
                part.extend([number; 2]);
            }
        }
        (nodes, triangles, part)
    }

    #[test]
    fn every_part_has_its_share_and_no_place_is_far_from_a_sample() {
        let (nodes, triangles, part) = squares();
        let chosen = spread(&nodes, &triangles, &part, 200);
        assert!((200..220).contains(&chosen.len()), "{}", chosen.len());
        assert!(chosen.is_sorted_by(|a, b| a < b), "none twice");
        assert_eq!(chosen.iter().filter(|&&n| n >= 41 * 41).count(), 9, "a small part has all of its nodes");
        for x in &nodes {
            let distance = |&n: &u32| (nodes[n as usize][0] - x[0]).hypot(nodes[n as usize][1] - x[1]);
            // 200 samples of 1600 cells are 2.8 apart on a square grid.
            assert!(chosen.iter().map(distance).fold(f64::MAX, f64::min) < 4.0, "{x:?}");
        }
    }

    #[test]
    fn a_surface_without_triangles_has_no_samples() {
        assert!(spread(&[], &[], &[], 2000).is_empty());
    }
}

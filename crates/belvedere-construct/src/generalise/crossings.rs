//! How often the rings of a polygon cross themselves and each other.

use belvedere_core::DVec2;
use belvedere_scene::city::Polygon;

/// Whether the rings of a polygon cross more than `most` times. Corners that touch do not count.
pub(super) fn exceed(polygon: &Polygon, most: usize) -> bool {
    let rings = std::iter::once(&polygon.outer).chain(&polygon.holes);
    let mut edges: Vec<[DVec2; 2]> = rings
        .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b]))
        .filter(|[a, b]| a.is_finite() && b.is_finite() && a != b)
        .collect();
    if edges.len().saturating_mul(edges.len()) / 2 <= most {
        return false;
    }
    // Sweep along the axis on which the edges are shorter.
    let extent = edges.iter().fold(DVec2::ZERO, |sum, [a, b]| sum + (*b - *a).abs());
    if extent.x > extent.y {
        edges.iter_mut().flatten().for_each(|p| *p = DVec2::new(p.y, p.x));
    }
    edges.iter_mut().filter(|[a, b]| a.x > b.x).for_each(|edge| edge.swap(0, 1));
    edges.sort_by(|[a, _], [b, _]| a.x.total_cmp(&b.x));
    let mut found = 0;
    for (i, edge) in edges.iter().enumerate() {
        let beside = edges[i + 1..].iter().take_while(|[start, _]| start.x <= edge[1].x);
        found += beside.filter(|other| cross(edge, other)).take(most + 1 - found).count();
        if found > most {
            return true;
        }
    }
    false
}

/// Whether two edges cross within both.
fn cross([a, b]: &[DVec2; 2], [c, d]: &[DVec2; 2]) -> bool {
    if a.y.max(b.y) < c.y.min(d.y) || c.y.max(d.y) < a.y.min(b.y) {
        return false;
    }
    let side = |from: DVec2, to: DVec2, p: DVec2| (to - from).perp_dot(p - from);
    side(*a, *b, *c) * side(*a, *b, *d) < 0.0 && side(*c, *d, *a) * side(*c, *d, *b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::random::Random;

    fn outline(outer: Vec<DVec2>) -> Polygon {
        Polygon { outer, holes: Vec::new() }
    }

    fn random(corners: usize, seed: u64) -> Vec<DVec2> {
        let mut random = Random::new(seed);
        (0..corners).map(|_| DVec2::new(random.range(0.0, 200.0), random.range(0.0, 200.0))).collect()
    }

    #[test]
    fn crossings_are_counted_as_by_all_pairs() {
        for seed in 0..20 {
            let points = random(40, seed);
            let edges: Vec<[DVec2; 2]> = (0..40).map(|i| [points[i], points[(i + 1) % 40]]).collect();
            let pairs = (0..40).flat_map(|i| (0..i).map(move |j| (i, j)));
            let count = pairs.filter(|(i, j)| cross(&edges[*i], &edges[*j])).count();
            assert!(count > 50, "{count}");
            let polygon = outline(points);
            assert!(exceed(&polygon, count - 1) && !exceed(&polygon, count), "{count} crossings, seed {seed}");
        }
    }

    #[test]
    fn long_outlines_that_do_not_cross_are_looked_through_in_time() {
        // A comb along each axis, of 200,000 corners.
        for turned in [false, true] {
            let teeth = 50_000;
            let tooth = |i: usize| [[0.0, 0.0], [0.0, 9.0], [0.4, 9.0], [0.4, 0.0]].map(|[x, y]| [x + i as f64, y]);
            let outer = (0..teeth).flat_map(tooth).chain([[teeth as f64, 0.0], [teeth as f64, -5.0], [0.0, -5.0]]);
            let outer = outer.map(|[x, y]| if turned { DVec2::new(y, x) } else { DVec2::new(x, y) });
            let begun = std::time::Instant::now();
            assert!(!exceed(&outline(outer.collect()), 1000));
            assert!(begun.elapsed().as_secs() < 10);
        }
    }
}

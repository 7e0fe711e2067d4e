//! A lake behind a dam of rubble.

use super::erosion::{Drainage, Land};
use belvedere_core::DVec2;
use std::collections::BTreeMap;

/// Wanted area of the lake, square metres.
const WANTED_M2: f64 = 0.7e6;

/// A lake.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lake {
    /// Nodes under water, all at one height.
    pub(crate) nodes: Vec<usize>,
    /// Shore, then islands; metres from the first node, x to the right, y down the rows.
    pub(crate) rings: Vec<Vec<DVec2>>,
}

/// Dams the valley in which the area of the lake is closest to [`WANTED_M2`], and fills it. `None` if no valley is suited.
pub(crate) fn dam(land: &mut Land, water: &Drainage) -> Option<Lake> {
    let (n, cell) = (land.n, land.dx * land.dx);
    let margin = n / 6;
    let (lo, hi) = land.z.iter().fold((f64::MAX, f64::MIN), |(l, h), &z| (l.min(z), h.max(z)));
    let suited = |&i: &usize| {
        let (c, r) = (i % n, i / n);
        let central = c > margin && c < n - margin && r > margin && r < n - margin;
        let height = (land.z[i] - lo) / (hi - lo);
        central && (2.5e6..40e6).contains(&water.area[i]) && (0.08..0.5).contains(&height)
    };
    let candidates: Vec<usize> = (0..n * n).filter(suited).collect();
    let stride = candidates.len().div_ceil(60).max(1);
    let mut best: Option<(f64, f64, Vec<usize>, usize)> = None;
    for &foot in candidates.iter().step_by(stride) {
        for depth in [25.0, 40.0, 60.0] {
            let level = land.z[foot] + depth;
            let nodes = flooded(land, water, foot, level);
            let ratio = nodes.len() as f64 * cell / WANTED_M2;
            let miss = ratio.max(1.0 / ratio.max(1e-9));
            if best.as_ref().is_none_or(|b| miss < b.0) {
                best = Some((miss, level, nodes, foot));
            }
        }
    }
    let (_, level, nodes, foot) = best.filter(|b| b.0 < 6.0)?;
    let rings = shore(land, &nodes, level);
    fill(land, &nodes, level, foot);
    Some(Lake { nodes, rings })
}

/// Nodes below `level` that drain through `foot` and are connected with it; empty if they reach the border.
fn flooded(land: &Land, water: &Drainage, foot: usize, level: f64) -> Vec<usize> {
    let mut seen = std::collections::BTreeSet::from([foot]);
    let (mut nodes, mut next) = (vec![foot], 0);
    while let Some(&i) = nodes.get(next) {
        next += 1;
        for (j, _) in land.around(i) {
            if land.z[j] < level && drains_through(land, water, j, foot, level) && seen.insert(j) {
                nodes.push(j);
            }
        }
        if land.outlet[i] || nodes.len() > 20_000 {
            return Vec::new();
        }
    }
    nodes.sort_unstable();
    nodes
}

fn drains_through(land: &Land, water: &Drainage, mut i: usize, foot: usize, level: f64) -> bool {
    while i != foot {
        let to = water.receiver[i] as usize;
        if to == i || land.z[to] < land.z[foot] - 1.0 || land.z[to] > level {
            return false;
        }
        i = to;
    }
    true
}

/// Raises the lake bed to the water and the ground below the dam to a slope of rubble.
fn fill(land: &mut Land, nodes: &[usize], level: f64, foot: usize) {
    let n = land.n as isize;
    let reach = ((level - land.z[foot] + 40.0) / 0.3 / land.dx) as isize + 2;
    let mut wet = vec![false; land.z.len()];
    nodes.iter().for_each(|&i| wet[i] = true);
    for &i in nodes {
        land.z[i] = level;
    }
    let rim: Vec<usize> = nodes.iter().copied().filter(|&i| land.around(i).any(|(j, _)| !wet[j])).collect();
    for i in rim {
        let (c, r) = (i as isize % n, i as isize / n);
        for dr in -reach..=reach {
            for dc in -reach..=reach {
                let (nc, nr) = (c + dc, r + dr);
                if nc < 0 || nr < 0 || nc >= n || nr >= n {
                    continue;
                }
                let j = (nr * n + nc) as usize;
                let away = ((dc * dc + dr * dr) as f64).sqrt() * land.dx;
                let rubble = level + 1.5 - 0.3 * (away - 1.5 * land.dx).max(0.0);
                if !wet[j] && !land.outlet[j] && land.z[j] < rubble {
                    land.z[j] = rubble;
                }
            }
        }
    }
    // nothing but the lake stays without an outlet
    let drained = land.drainage();
    for &i in &drained.order {
        let (i, to) = (i as usize, drained.receiver[i as usize] as usize);
        if !wet[i] && i != to {
            land.z[i] = land.z[i].max(land.z[to] + 1e-3 * land.dx);
        }
    }
}

/// Contour of the water at `level` over the ground before it was filled.
fn shore(land: &Land, nodes: &[usize], level: f64) -> Vec<Vec<DVec2>> {
    let n = land.n;
    let mut wet = vec![false; n * n];
    nodes.iter().for_each(|&i| wet[i] = true);
    let above = |i: usize| if wet[i] { (land.z[i] - level).min(-0.01) } else { (land.z[i] - level).max(2.0) };
    let at = |i: usize| DVec2::new((i % n) as f64, (i / n) as f64) * land.dx;
    // crossing of the shore with the edge between two nodes
    let cut = |a: usize, b: usize| {
        let t = (above(a) / (above(a) - above(b))).clamp(0.02, 0.98);
        ((a.min(b), a.max(b)), at(a).lerp(at(b), t))
    };
    let mut next: BTreeMap<(usize, usize), ((usize, usize), DVec2)> = BTreeMap::new();
    for r in 0..n - 1 {
        for c in 0..n - 1 {
            let i = r * n + c;
            let corners = [i, i + 1, i + n + 1, i + n];
            for k in 0..4 {
                // leave the water across one edge, turn around the dry corners, enter it again across another
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                if wet[a] && !wet[b] {
                    let back = (1..4)
                        .map(|m| (corners[(k + m) % 4], corners[(k + m + 1) % 4]))
                        .find(|(p, q)| !wet[*p] && wet[*q]);
                    if let Some((p, q)) = back {
                        let (from, xy) = cut(a, b);
                        next.insert(from, (cut(p, q).0, xy));
                    }
                }
            }
        }
    }
    let mut rings = Vec::new();
    while let Some((&first, _)) = next.iter().next() {
        let (mut ring, mut edge) = (Vec::new(), first);
        while let Some((to, xy)) = next.remove(&edge) {
            ring.push(xy);
            edge = to;
        }
        rings.push(ring);
    }
    rings.retain(|r| r.len() >= 8);
    rings.sort_by(|a, b| area_m2(b).abs().total_cmp(&area_m2(a).abs()));
    rings
}

/// Signed area of a ring, square metres.
fn area_m2(ring: &[DVec2]) -> f64 {
    (0..ring.len()).map(|k| 0.5 * ring[k].perp_dot(ring[(k + 1) % ring.len()])).sum()
}

//! Generated mountains with a valley route, and the processor's clock.
#![allow(missing_docs)]

use belvedere_core::DVec2;
use belvedere_disocclusion::internals::{Field, ReferencePoint, Wedge, in_view};
use belvedere_disocclusion::report::PointKind;
use belvedere_scene::{Heightfield, NodeState};

pub(crate) const NODES: usize = 1025;
/// Side of the ground, whatever its nodes.
const SIDE_M: f64 = 30.0 * 1024.0;

/// Fractal mountains of 2 km: midpoint displacement (diamond and square), roughness 1.1.
///
/// * `nodes`: per side, [`NODES`] or every 2nd, 4th, ... of them: the same mountains.
pub(crate) fn fractal(seed: u64, nodes: usize) -> Field {
    let n = NODES;
    let mut z = vec![0.0f64; n * n];
    let noise = |i: usize| {
        let mut x = (i as u64 ^ (seed << 32)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        x = (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((x ^ (x >> 32)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let (mut step, mut height) = (n - 1, 1000.0);
    while step > 1 {
        let half = step / 2;
        for row in (half..n).step_by(step) {
            for col in (half..n).step_by(step) {
                let corners = [
                    (row - half, col - half),
                    (row - half, col + half),
                    (row + half, col - half),
                    (row + half, col + half),
                ];
                let mean = corners.iter().map(|&(r, c)| z[r * n + c]).sum::<f64>() / 4.0;
                z[row * n + col] = mean + height * noise(row * n + col);
            }
        }
        for row in (0..n).step_by(half) {
            for col in ((row + half) % step..n).step_by(step) {
                let (mut sum, mut count) = (0.0, 0.0);
                for (r, c) in [(-1isize, 0isize), (1, 0), (0, -1), (0, 1)] {
                    let at = (row.checked_add_signed(r * half as isize), col.checked_add_signed(c * half as isize));
                    if let (Some(r), Some(c)) = at
                        && r < n
                        && c < n
                    {
                        sum += z[r * n + c];
                        count += 1.0;
                    }
                }
                z[row * n + col] = sum / count + height * noise(row * n + col);
            }
        }
        step = half;
        height *= 0.5f64.powf(1.1);
    }
    let [low, high] = z.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
    let step = (n - 1) / (nodes - 1);
    let of_row = |row: usize| z[row * n..(row + 1) * n].iter().step_by(step);
    let kept = (0..n).step_by(step).flat_map(of_row);
    let heights = kept.map(|v| (500.0 + 2000.0 * (v - low) / (high - low)) as f32).collect();
    let states = vec![NodeState::Measured; nodes * nodes];
    let spacing = DVec2::splat(SIDE_M / (nodes - 1) as f64);
    let hf = Heightfield::new(DVec2::ZERO, spacing, nodes, nodes, heights, states).expect("well formed");
    Field::new(&hf, |_| 0.0).expect("has data")
}

/// The valley route of the mountains on a grid of so many nodes per side.
pub(crate) fn route(seed: u64, nodes: usize) -> Vec<DVec2> {
    let scale = (nodes - 1) as f64 / (NODES - 1) as f64;
    valley(&fractal(seed, NODES)).into_iter().map(|p| p * scale).collect()
}

/// The lowest of ways from west to east, found row by row: a valley route.
fn valley(field: &Field) -> Vec<DVec2> {
    let (n, h) = (field.cols(), field.heights());
    let cost = |i: usize| (h[i] - field.datum()) * (h[i] - field.datum());
    let mut best: Vec<f64> = (0..n).map(|row| cost(row * n)).collect();
    let mut from = vec![0usize; n * n];
    for col in 1..n {
        let before = best.clone();
        for row in 0..n {
            let near = row.saturating_sub(1)..(row + 2).min(n);
            let least = near.min_by(|&a, &b| before[a].total_cmp(&before[b])).unwrap_or(row);
            from[row * n + col] = least;
            best[row] = before[least] + cost(row * n + col);
        }
    }
    let mut row = (0..n).min_by(|&a, &b| best[a].total_cmp(&best[b])).unwrap_or(0);
    let mut path = Vec::with_capacity(n);
    for col in (0..n).rev() {
        path.push(DVec2::new(col as f64, row as f64));
        row = from[row * n + col];
    }
    path
}

/// `count` points in view, equally spaced along the route.
pub(crate) fn points(field: &Field, route: &[DVec2], wedge: &Wedge, count: usize) -> Vec<ReferencePoint> {
    let at = |i: usize, of: usize| {
        let t = i as f64 / of as f64 * (route.len() - 2) as f64;
        let grid = route[t as usize].lerp(route[t as usize + 1], t.fract());
        let ground = field.surface_at(grid).expect("on the ground");
        ReferencePoint {
            layer: 0,
            feature: 0,
            along_m: 0.0,
            grid,
            ground,
            lift: 1.0,
            kind: PointKind::Line,
            amount: 1.0,
        }
    };
    let all: Vec<ReferencePoint> = (0..10_000).map(|i| at(i, 10_000)).collect();
    let seen = in_view(field, &all, wedge, 1.5).0;
    (0..count).map(|i| all[seen[i * seen.len() / count]]).collect()
}

/// Processor time of all threads so far, milliseconds; 0 where the kernel does not tell.
pub(crate) fn cpu_ms() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return 0.0 };
    let of_task = |t: std::fs::DirEntry| {
        let text = std::fs::read_to_string(t.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    tasks.flatten().filter_map(of_task).sum::<f64>() * 1e-6
}

/// Slope of the least-squares line through the logarithms.
pub(crate) fn exponent(of: &[(f64, f64)]) -> f64 {
    let n = of.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| of.iter().map(f).sum::<f64>() / n;
    let (mx, my) = (mean(|p| p.0.ln()), mean(|p| p.1.ln()));
    let slope = |p: &(f64, f64)| (p.0.ln() - mx) * (p.1.ln() - my);
    of.iter().map(slope).sum::<f64>() / of.iter().map(|p| (p.0.ln() - mx).powi(2)).sum::<f64>()
}

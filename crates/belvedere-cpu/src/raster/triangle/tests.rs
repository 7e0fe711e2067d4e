use super::*;
use crate::raster::band::sample_offsets;

fn random(seed: &mut u64) -> i32 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as i32
}

/// A sheet of `n` x `n` cells with shaken inner nodes, `pitch` fixed-point steps apart.
fn sheet(n: usize, pitch: i32, seed: u64) -> Vec<ScreenVertex> {
    let mut seed = seed;
    (0..(n + 1) * (n + 1))
        .map(|i| {
            let (c, r) = (i % (n + 1), i / (n + 1));
            let inner = c > 0 && r > 0 && c < n && r < n;
            let mut shake = || if inner { random(&mut seed) % (pitch / 4 + 1) - pitch / 8 } else { 0 };
            let (x, y) = (c as i32 * pitch + shake() - 300, r as i32 * pitch + shake() - 300);
            ScreenVertex { x, y, q: 1.0 }
        })
        .collect()
}

#[test]
fn every_sample_of_a_sheet_is_covered_exactly_once() {
    // Pitches below a pixel, of whole pixels (nodes on samples) and far above.
    for (n, pitch, samples) in [(90, 61, 1), (40, 256, 1), (40, 128, 4), (30, 700, 16), (7, 4000, 4), (64, 384, 16)] {
        let size = (n as i32 * pitch - 300) / SUB;
        let mut band = Band::new(0, size + 3, size + 3, sample_offsets(samples));
        let v = sheet(n, pitch, 7 + n as u64);
        for cell in 0..n * n {
            let nw = cell / n * (n + 1) + cell % n;
            let [a, b, c, d] = [nw, nw + 1, nw + n + 1, nw + n + 2].map(|i| v[i]);
            // Either orientation, any starting corner.
            band.draw([a, b, d], 0);
            band.draw([d, a, c], 1);
        }
        let last = n as i32 * pitch - 300;
        for (s, [ox, oy]) in band.offsets.iter().enumerate() {
            for y in 0..size + 3 {
                for x in 0..size + 3 {
                    let (xs, ys) = (x * SUB + ox, y * SUB + oy);
                    // The sheet owns its left and top border, not its right and bottom one.
                    let inside = xs < last && ys < last;
                    assert_eq!(band.hits[band.index(s, x, y)], u32::from(inside), "pitch {pitch}: ({x}, {y}) {s}");
                }
            }
        }
    }
}

#[test]
fn nearness_is_the_plane_through_the_corners() {
    let corner = |x: i32, y: i32| ScreenVertex { x: x * SUB, y: y * SUB, q: 0.5 + 0.001 * (2 * x + 3 * y) as f32 };
    let mut band = Band::new(0, 60, 60, sample_offsets(4));
    band.draw([corner(1, 1), corner(58, 4), corner(7, 55)], 9);
    let mut seen = 0;
    for (s, [ox, oy]) in band.offsets.iter().enumerate() {
        for i in 0..3600 {
            let (x, y) = (i % 60, i / 60);
            let at = band.index(s, x, y);
            if band.prim[at] == 9 {
                let (px, py) = (x as f32 + *ox as f32 / 256.0, y as f32 + *oy as f32 / 256.0);
                assert!((band.q[at] - (0.5 + 0.001 * (2.0 * px + 3.0 * py))).abs() < 1e-6);
                seen += 1;
            }
        }
    }
    assert!(seen > 5 * 1400);
}

use super::*;
use crate::raster::band::{SKY, sample_offsets};

/// Images of nodes (c, r) every `pitch` fixed-point steps, inner ones shaken by up to a quarter of that.
fn image([c, r]: [usize; 2], pitch: i32) -> ScreenVertex {
    let mix = |k: u64| {
        let x = (c as u64 * 7919 + r as u64 * 104_729 + k).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((x >> 40) as i32 % (pitch / 4 + 1)) - pitch / 8
    };
    let inner = c > 0 && r > 0 && c < 64 && r < 32;
    let shake = |k: u64| if inner { mix(k) } else { 0 };
    let q = 1.0 + 0.001 * mix(3) as f32 / pitch as f32;
    ScreenVertex { x: c as i32 * pitch + shake(1) - 300, y: r as i32 * pitch + shake(2) - 300, q }
}

/// A block of full detail beside one of half the detail: 64 x 32 cells together.
fn sheet(pitch: i32, fine_first: bool) -> [Nodes; 2] {
    let block = |from: usize, step: usize, seam: [bool; 4]| {
        let cells = [32 / step, 32 / step];
        let mut nodes = Nodes::default();
        nodes.reset(cells);
        for r in 0..=cells[1] {
            for c in 0..=cells[0] {
                nodes.set(c, r, image([from + step * c, step * r], pitch));
            }
        }
        nodes.close_seams(seam);
        nodes.cover();
        nodes
    };
    let fine = block(if fine_first { 0 } else { 32 }, 1, [false, fine_first, false, !fine_first]);
    [fine, block(if fine_first { 32 } else { 0 }, 2, [false; 4])]
}

const PITCHES: [i32; 8] = [37, 64, 128, 200, 256, 700, 1600, 3000];

#[test]
fn sheets_of_different_detail_cover_every_sample_once() {
    for (pitch, fine_first, samples) in
        PITCHES.into_iter().flat_map(|p| [(p, true, 1), (p, false, 1), (p, true, 4), (p, false, 16)])
    {
        let size = [(64 * pitch - 300) / SUB + 2, (32 * pitch - 300) / SUB + 2];
        let mut band = Band::new(0, size[1], size[0], sample_offsets(samples));
        for (i, nodes) in sheet(pitch, fine_first).iter().enumerate() {
            nodes.draw((i as u32) << 11, &mut band);
        }
        for (s, [ox, oy]) in band.offsets.iter().enumerate() {
            for (x, y) in (0..size[0]).flat_map(|x| (0..size[1]).map(move |y| (x, y))) {
                let inside = x * SUB + ox < 64 * pitch - 300 && y * SUB + oy < 32 * pitch - 300;
                let hits = band.hits[band.index(s, x, y)];
                assert_eq!(hits, u32::from(inside), "pitch {pitch}, {fine_first}: ({x}, {y}) sample {s}");
            }
        }
    }
}

#[test]
fn bands_of_any_height_and_blocks_in_any_order_give_the_same_samples() {
    for (pitch, samples) in PITCHES.into_iter().flat_map(|p| [(p, 1), (p, 4)]) {
        let (width, height) = ((64 * pitch - 300) / SUB + 2, (32 * pitch - 300) / SUB + 2);
        // Two sheets through each other.
        let sheets = [sheet(pitch, true), sheet(pitch, false)];
        let draw = |y0: i32, y1: i32, reverse: bool| {
            let mut band = Band::new(y0, y1, width, sample_offsets(samples));
            let all: Vec<(usize, &Nodes)> = sheets.iter().flatten().enumerate().collect();
            let order: Vec<_> = if reverse { all.into_iter().rev().collect() } else { all };
            order.into_iter().for_each(|(i, nodes)| nodes.draw((i as u32) << 11, &mut band));
            band
        };
        let whole = draw(0, height, false);
        for rows in [1, 5, 16] {
            for y0 in (0..height).step_by(rows as usize) {
                let band = draw(y0, (y0 + rows).min(height), true);
                for s in 0..band.offsets.len() {
                    for (x, y) in (0..width).flat_map(|x| (band.y0..band.y1).map(move |y| (x, y))) {
                        let (a, b) = (whole.index(s, x, y), band.index(s, x, y));
                        assert_eq!((whole.q[a].to_bits(), whole.prim[a]), (band.q[b].to_bits(), band.prim[b]));
                    }
                }
            }
        }
    }
}

#[test]
fn rows_behind_what_was_drawn_are_left_out_and_no_other() {
    // A level block, and one behind it from which some rows and single nodes stand out.
    let block = |q: &dyn Fn(usize, usize) -> f32| {
        let mut nodes = Nodes::default();
        nodes.reset([32, 32]);
        for (c, r) in (0..33).flat_map(|c| (0..33).map(move |r| (c, r))) {
            nodes.set(c, r, ScreenVertex { x: c as i32 * 300 - 400, y: r as i32 * 300 - 400, q: q(c, r) });
        }
        let cover = nodes.cover();
        (nodes, cover)
    };
    let rough = |c: usize, r: usize| if (7 * c + 11 * r) % 97 == 5 { 1.3 } else { 0.75 + 0.01 * r as f32 };
    let blocks = [block(&|_, _| 1.0), block(&rough)];
    let draw = |order: [usize; 2]| {
        let mut band = Band::new(0, 16, 32, sample_offsets(4));
        for i in order {
            blocks[i].0.draw((i as u32) << 11, &mut band);
            band.drew(blocks[i].1.x);
        }
        band
    };
    let (hiding, whole) = (draw([0, 1]), draw([1, 0]));
    assert!(hiding.q == whole.q && hiding.prim == whole.prim, "the same samples");
    let drawn = |band: &Band| band.hits.iter().sum::<u32>();
    assert!(drawn(&hiding) < drawn(&whole), "some rows were left out");
    assert!(hiding.prim.iter().any(|p| *p != SKY && p >> 11 == 1), "some stand out");
}

#[test]
fn all_versions_draw_the_same_bits() {
    for (pitch, samples) in PITCHES.into_iter().flat_map(|p| [(p, 1), (p, 4)]) {
        let (width, height) = ((64 * pitch - 300) / SUB + 2, (32 * pitch - 300) / SUB + 2);
        let draw = |plain: bool| {
            let mut band = Band::new(0, height, width, sample_offsets(samples));
            for (i, nodes) in sheet(pitch, true).iter().enumerate() {
                let draw = Draw { nodes, first_prim: (i as u32) << 11, band: &mut band };
                if plain { draw.run() } else { simd::run(draw) }
            }
            (band.q.iter().map(|q| q.to_bits()).collect::<Vec<_>>(), band.prim)
        };
        assert!(draw(true) == draw(false), "pitch {pitch}");
    }
}

use super::*;
use crate::shade::ground::patch::GroundShape;
use crate::shade::ground::planes::Planes;
use crate::shade::ground::surface::{MipPyramid, Surface};
use crate::shade::ground::tiles::CELL;
use belvedere_composite::tint::GroundTint;
use belvedere_core::DVec2;
use belvedere_scene::{Heightfield, Light, NodeState, Palette, PaletteName, Relief};
use std::sync::Arc;

fn hills(cols: usize, rows: usize) -> Heightfield {
    let h = |i: usize| {
        let (x, y) = ((i % cols) as f32 * 0.07, (i / cols) as f32 * 0.05);
        900.0 + 400.0 * (x.sin() * y.cos() + 0.3 * (3.0 * x + y).sin())
    };
    let heights = (0..cols * rows).map(h).collect();
    Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), cols, rows, heights, vec![NodeState::Measured; cols * rows])
        .unwrap()
}

fn with_inputs(hf: &Heightfield, palette: &Palette, relief: Relief, test: impl Fn(&LitGround, &LightingInputs<'_>)) {
    let surface = Surface::of_map(hf);
    let means = MipPyramid::new(&surface);
    let tint = GroundTint::new(palette, hf.z_range());
    let light = ReliefLight::new(relief, &Light::default());
    let inputs = LightingInputs {
        surface: &surface,
        means: &means,
        map: None,
        broad: None,
        shadows: None,
        tint: &tint,
        light: &light,
        exaggeration: 1.0,
    };
    test(&LitGround::new(hf.cols(), hf.rows(), means.top(), 0), &inputs);
}

/// Linear colour from its square roots.
fn linear(roots: [f32; 3]) -> Rgb {
    Rgb::from_array(roots.map(|v| v * v))
}

#[test]
fn interpolated_light_is_that_of_the_interpolated_ground() {
    let hf = hills(150, 131);
    with_inputs(&hf, &PaletteName::Alpine.into(), Relief::Swiss, |ground, m| {
        let mut row = Planes::new(150);
        let (mut worst, mut sum, mut n) = (0.0f32, 0.0, 0.0);
        for r in 1..129 {
            m.surface.row(r, 0, &mut row);
            for c in 1..148 {
                for share in [0i32, 64, 200] {
                    let at = [c * CELL + share, r as i32 * CELL];
                    let parts = ground.sample(at, 0, m);
                    let shape = row.get(c as usize).lerp(row.get(c as usize + 1), share as f32 / 256.0);
                    let near = m.means.at(1, c as f32 + share as f32 / 256.0, r as f32);
                    let steep = shape.truncate().truncate().length();
                    let normal = Vec3A::new(-shape.x, -shape.y, 1.0).normalize();
                    let light = m.light.at(normal, m.means.openness().at(shape.z, near.z, near.w), 1.0);
                    let want =
                        Rgb::from_array(m.tint.color(f64::from(shape.z), DVec2::new(f64::from(steep), 0.0))) * light;
                    let apart = parts.albedo() * (m.light.warm * parts.direct + m.light.cool * parts.sky);
                    let steps = |c: Rgb| c.max(Rgb::ZERO).to_array().map(|v| 255.0 * v.sqrt());
                    let film = linear(want.to_array().map(|v| m.light.film(v.max(0.0).sqrt())));
                    for (want, has) in [(want, apart), (film, linear(ground.color(at, 0, m)))] {
                        for (a, b) in steps(want).into_iter().zip(steps(has)) {
                            (worst, sum, n) = (worst.max((a - b).abs()), sum + (a - b).abs(), n + 1.0);
                        }
                    }
                }
            }
        }
        assert!(worst < 10.0 && sum / n < 0.6, "{worst} steps at most, {} on average", sum / n);
    });
}

#[test]
fn tints_are_those_of_the_map_wherever_the_ground_went() {
    let hf = hills(150, 131);
    // A bowl of 900 m, which would carry summits into the green of the valleys.
    let bowl = |i: usize| 900.0 * (-0.001 * ((i % 150) as f32 - 70.0).powi(2)).exp();
    let sunken = hf.heights().iter().enumerate().map(|(i, h)| h - bowl(i)).collect();
    let (map, moved) = (Surface::of_map(&hf), Surface::lifted(&hf, Arc::new(sunken)));
    let (map_means, moved_means) = (MipPyramid::new(&map), MipPyramid::new(&moved));
    let tint = GroundTint::new(&PaletteName::Alpine.into(), hf.z_range());
    let light = ReliefLight::new(Relief::Swiss, &Light::default());
    let inputs = |surface, means, map| LightingInputs {
        surface,
        means,
        map,
        broad: None,
        shadows: None,
        tint: &tint,
        light: &light,
        exaggeration: 1.0,
    };
    let undisplaced = GroundShape { surface: &map, means: &map_means };
    let (there, here) = (inputs(&moved, &moved_means, Some(undisplaced)), inputs(&map, &map_means, None));
    let ground = |means: &MipPyramid| LitGround::new(150, 131, means.top(), 0);
    let (moved_ground, map_ground) = (ground(&moved_means), ground(&map_means));
    let mut other_light = 0;
    for i in 0..8000i32 {
        let at = [i * 7919 % (149 * CELL), i * 104_729 % (130 * CELL)];
        let lod = (i * 37 % 1800) as u32;
        let (a, b) = (moved_ground.sample(at, lod, &there), map_ground.sample(at, lod, &here));
        assert_eq!(a.root, b.root, "{at:?}, level {lod} / 256");
        other_light += u32::from((a.direct - b.direct).abs() > 0.05);
    }
    assert!(other_light > 1000, "{other_light} places in another light");
}

#[test]
fn weights_are_whole_and_sum_up_everywhere() {
    let hf = hills(70, 70);
    with_inputs(&hf, &PaletteName::Plain.into(), Relief::None, |ground, m| {
        let (want, color) = (ground.sample([0, 0], 0, m), ground.color([0, 0], 0, m));
        for i in 0..20_000i32 {
            let at = [i * 7919 % (69 * CELL + 1), i * 104_729 % (69 * CELL + 1)];
            let lod = (i * 37 % 2300) as u32;
            assert_eq!(ground.sample(at, lod, m), want, "{at:?}");
            assert_eq!(ground.color(at, lod, m), color, "{at:?}");
        }
        for at in [[i32::MAX; 2], [-5 * CELL, 0], [0, 900 * CELL], [i32::MIN; 2]] {
            assert_eq!(ground.color(at, 0, m), [0.0; 3], "off the ground: {at:?}");
        }
    });
}

#[test]
fn averages_match_the_mean_of_what_they_stand_for() {
    let hf = hills(257, 257);
    with_inputs(&hf, &PaletteName::Alpine.into(), Relief::Swiss, |ground, m| {
        // A point at the middle of a node of level 5, against the mean over its 32 x 32 nodes.
        let (c, r, side) = (96, 64, 32i32);
        let mut mean = [0.0f32; 8];
        let values = |lit: Lit, color: Rgb| {
            let [[r, g, b], color] = [lit.root, color.to_array().map(f32::sqrt)];
            [r, g, b, lit.direct, lit.sky, color[0], color[1], color[2]]
        };
        for i in 0..side * side {
            let at = [(c + i % side) * CELL, (r + i / side) * CELL];
            let now = values(ground.sample(at, 0, m), linear(ground.color(at, 0, m)));
            mean.iter_mut().zip(now).for_each(|(s, v)| *s += v / (side * side) as f32);
        }
        let at = [c * CELL + (side - 1) * CELL / 2, r * CELL + (side - 1) * CELL / 2];
        let got = values(ground.sample(at, 5 << 8, m), linear(ground.color(at, 5 << 8, m)));
        assert!(mean.iter().zip(got).all(|(a, b)| (a - b).abs() < 0.1), "{mean:?} {got:?}");
    });
}

#[test]
fn levels_pass_into_each_other() {
    let hf = hills(150, 131);
    with_inputs(&hf, &PaletteName::Alpine.into(), Relief::Swiss, |ground, m| {
        let (mut worst, mut sum, mut n) = (0.0f32, 0.0, 0.0);
        for i in 0..20_000i32 {
            let at = [i * 7919 % (149 * CELL), i * 104_729 % (130 * CELL)];
            for k in 1..4 {
                let steps = |lod: u32| linear(ground.color(at, lod, m)).to_array().map(|v| 255.0 * v.sqrt());
                for (a, b) in steps((k << 8) - 1).into_iter().zip(steps(k << 8)) {
                    (worst, sum, n) = (worst.max((a - b).abs()), sum + (a - b).abs(), n + 1.0);
                }
            }
        }
        // What bends sharply at a node of the coarser level lies between nodes of the finer one.
        assert!(worst < 20.0 && sum / n < 1.8, "{worst} steps at most, {} on average", sum / n);
    });
}

use super::*;
use belvedere_scene::{Color, RampHeight, RampStop};
use std::sync::Arc;

/// Simulations of dichromatic vision in linear RGB (Machado, Oliveira, Fernandes 2009, severity 1).
const PROTAN: [[f32; 3]; 3] =
    [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]];
const DEUTAN: [[f32; 3]; 3] =
    [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_82, 0.042_94, 0.968_881]];
const TRITAN: [[f32; 3]; 3] =
    [[1.255_528, -0.076_749, -0.178_779], [-0.078_411, 0.930_809, 0.147_602], [0.004_733, 0.691_367, 0.303_9]];
const NORMAL: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// CIELAB under D65 of a linear colour as seen by an eye.
fn lab(c: Rgb, eye: [[f32; 3]; 3]) -> Rgb {
    let c = eye.map(|row| Rgb::from_array(row).dot(c).clamp(0.0, 1.0));
    let xyz = [
        (0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2]) / 0.9505,
        0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2],
        (0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2]) / 1.089,
    ];
    let [x, y, z] = xyz.map(|t: f32| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
    Rgb::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

fn color(tint: &GroundTint, height_m: f32, steep: f32) -> Rgb {
    let [[r], [g], [b], _] = tint.colors(&[height_m], &[steep], &[0.0]);
    Rgb::new(r, g, b)
}

#[test]
fn built_in_ramps_are_told_apart_by_every_kind_of_colour_vision() {
    for (stops, least) in [(ALPINE, 3.0), (DESERT, 3.0), (GLACIAL, 3.0), (CLEAR, 8.0)] {
        for eye in [NORMAL, PROTAN, DEUTAN, TRITAN] {
            let classes: Vec<Rgb> = (0..=8).map(|i| lab(ramp_at(stops, i as f32 / 8.0), eye)).collect();
            for (i, a) in classes.iter().enumerate() {
                for (j, b) in classes.iter().enumerate().skip(i + 1) {
                    let far = (*a - *b).length();
                    assert!(far >= least * (j - i) as f32 * 0.8, "classes {i} and {j}: {far} apart");
                }
            }
            let light: Vec<f32> = (0..=200).map(|i| lab(ramp_at(stops, i as f32 / 200.0), eye).x).collect();
            assert!(light.windows(2).all(|w| w[1] > w[0] - 0.02), "lightness falls: {light:?}");
        }
    }
}

#[test]
fn every_palette_tells_snow_from_ground_even_where_there_is_none() {
    for palette in PaletteName::ALL.map(|(_, name)| Palette::Named(name)) {
        // Winters have snow down to the valleys.
        if palette == PaletteName::Winter.into() {
            continue;
        }
        for range in [[0.0, 4000.0], [12.0, 12.0]] {
            let tint = GroundTint::new(&palette, range);
            let snow = tint.snow_m.at(range[0] as f32);
            assert!(snow == 0.0, "{palette:?}: {snow} of the lowest ground is snow");
        }
    }
}

#[test]
fn snow_slides_off_steep_ground() {
    let tint = GroundTint::new(&PaletteName::Alpine.into(), [1000.0, 4800.0]);
    let snow = |steep: f32| color(&tint, 4800.0, steep);
    assert!((snow(0.3) - tint.snow).abs().max_element() < 0.02, "gentle: {}", snow(0.3));
    for steep in [1.4, 3.0, 50.0] {
        assert!(snow(steep).max_element() < 0.6 * tint.snow.min_element(), "tangent {steep}: {}", snow(steep));
    }
}

#[test]
fn every_palette_has_colours_at_every_height() {
    for palette in PaletteName::ALL.map(|(_, name)| Palette::Named(name)) {
        for range in [[0.0, 0.0], [-400.0, 9000.0], [300.0, 3100.0], [1e6, 1e6 + 1e-6]] {
            let tint = GroundTint::new(&palette, range);
            for z in [range[0], 0.5 * (range[0] + range[1]), range[1], -1e9, 1e9] {
                for steep in [0.0, 0.9, 50.0] {
                    let c = color(&tint, z as f32, steep);
                    assert!(c.min_element() > 0.01 && c.max_element() <= 1.0, "{palette:?} {range:?} at {z}: {c}");
                }
            }
        }
    }
}

#[test]
fn a_ramp_of_its_own_colours_the_ground_as_it_says() {
    let stop = |z: f64, c: Color| RampStop { height: RampHeight::Metres(z), color: c };
    let (low, high) = (Color::rgb(10, 200, 30), Color::rgb(250, 20, 100));
    let ramp = Ramp { stops: vec![stop(0.0, low), stop(1000.0, high)], ..Ramp::default() };
    let tint = GroundTint::new(&Palette::Ramp(Arc::new(ramp)), [0.0, 1000.0]);
    let near = |z: f32, c: [u8; 3]| (color(&tint, z, 9.0) - linear(c)).abs().max_element() < 0.01;
    assert!(near(0.0, [10, 200, 30]) && near(500.0, [130, 110, 65]) && near(1000.0, [250, 20, 100]));
    let clear = Ramp { stops: vec![stop(0.0, low.with_alpha(0))], ..Ramp::default() };
    let tint = GroundTint::new(&Palette::Ramp(Arc::new(clear)), [0.0, 1000.0]);
    assert!((color(&tint, 5.0, 0.0) - linear(GREY)).abs().max_element() < 1e-3);
}

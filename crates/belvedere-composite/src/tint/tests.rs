use super::ramps::{ALPINE, CLEAR, DESERT, GLACIAL, GREY, ramp_at};
use super::*;
use crate::color::{Rgb, linear};
use belvedere_scene::{Climate, Color, Cover, CoverMap, Ramp, RampHeight, RampStop};
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
    Rgb::from_array(tint.color(f64::from(height_m), DVec2::new(f64::from(steep), 0.0)))
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
fn snow_lies_on_high_gentle_ground_and_slides_off_steep_ground() {
    let tint = GroundTint::new(&PaletteName::Alpine.into(), [1000.0, 4800.0]);
    let snow = color(&tint, 4800.0, 0.3);
    assert!(snow.min_element() > 0.75, "gentle: {snow}");
    for steep in [1.4, 3.0, 50.0] {
        assert!(color(&tint, 4800.0, steep).max_element() < 0.6 * snow.min_element(), "tangent {steep}");
    }
    assert!(color(&tint, 1000.0, 0.3).max_element() < 0.5, "the lowest ground has none");
}

const ALPS: Climate =
    Climate { snow_line_m: 2850.0, tree_line_m: 1900.0, dryness: 0.0, latitude_deg: 46.5, of_place: true };
const DESERT_CLIMATE: Climate = Climate { dryness: 1.0, ..ALPS };

/// Covers of 4096 places on a slope at one height, and their colours in CIELAB.
fn places(
    name: PaletteName,
    climate: Climate,
    height: f32,
    slope: [f32; 2],
    above: f32,
) -> (GroundCover<64>, Vec<Rgb>) {
    let tint = GroundTint::new(&Palette::Placed(name, climate, None), [400.0, 4200.0]);
    let mut all = GroundCover::of_color([[0.0; 64]; 3]);
    let mut colors = Vec::new();
    for row in 0..64 {
        let (x, y) = (std::array::from_fn(|i| 8.0 * i as f32), [8.0 * row as f32; 64]);
        let [east, north] = slope.map(|s| [s; 64]);
        let nodes = GroundNodes {
            height_m: &[height; 64],
            slope: [&east, &north],
            broad: [&east, &north],
            above_m: &[above; 64],
            at_m: [&x, &y],
            spacing_m: 8.0,
        };
        let cover = tint.cover(&nodes);
        for i in 0..64 {
            all.forest[i] += cover.forest[i] / 64.0;
            all.bare[i] += cover.bare[i] / 64.0;
            all.snow[i] += cover.snow[i] / 64.0;
            colors.push(lab(Rgb::from_array([0, 1, 2].map(|k| cover.color[k][i])), NORMAL));
        }
    }
    (all, colors)
}

fn mean(shares: [f32; 64]) -> f32 {
    shares.iter().sum::<f32>() / 64.0
}

#[test]
fn materials_lie_where_the_climate_and_the_form_of_the_ground_have_them() {
    let forest = |height, slope, above| mean(places(PaletteName::Auto, ALPS, height, slope, above).0.forest);
    let wood = forest(1400.0, [0.4, 0.0], -5.0);
    assert!(wood > 0.7, "a slope in the forest: {wood}");
    assert!(forest(2500.0, [0.4, 0.0], 0.0) < 0.01, "over the line of trees");
    assert!(forest(1400.0, [1.5, 0.0], 0.0) < 0.01, "on a cliff");
    assert!(forest(1400.0, [0.4, 0.0], 60.0) < 0.5 * wood, "on a ridge");
    assert!(forest(1950.0, [0.0, -0.5], 0.0) > 0.2 + forest(1950.0, [0.0, 0.5], 0.0), "in the shade and in the sun");
    let dry = mean(places(PaletteName::Auto, DESERT_CLIMATE, 900.0, [0.4, 0.0], 0.0).0.forest);
    assert!(dry < 0.1, "in a desert: {dry}");
    let bare = |height, slope| mean(places(PaletteName::Auto, ALPS, height, slope, 0.0).0.bare);
    assert!(bare(2300.0, [1.2, 0.0]) > 0.9 && bare(2100.0, [0.15, 0.0]) < 0.1);
    let snow = |name, height, slope| mean(places(name, ALPS, height, slope, 0.0).0.snow);
    assert!(snow(PaletteName::Auto, 3400.0, [0.3, 0.0]) > 0.95 && snow(PaletteName::Auto, 3400.0, [1.6, 0.0]) < 0.2);
    assert!(snow(PaletteName::Auto, 2000.0, [0.3, 0.0]) < 0.01 && snow(PaletteName::Winter, 1200.0, [0.2, 0.0]) > 0.95);
}

#[test]
fn forest_has_a_canopy_and_kinds_of_ground_differ_in_hue() {
    let (_, wood) = places(PaletteName::Auto, ALPS, 1400.0, [0.4, 0.0], -10.0);
    let middle = wood.iter().map(|c| c.x).sum::<f32>() / 4096.0;
    let spread = (wood.iter().map(|c| (c.x - middle).powi(2)).sum::<f32>() / 4096.0).sqrt();
    assert!(spread >= 5.0, "deviation of the lightness of a forest without light: {spread}");
    let hue = |name, height, slope: f32, above| {
        let (_, colors) = places(name, ALPS, height, [slope, 0.0], above);
        let sum = colors.iter().fold(Rgb::ZERO, |sum, c| sum + *c);
        (sum.z.atan2(sum.y).to_degrees(), sum.x / 4096.0)
    };
    let (wood, rock) = (hue(PaletteName::Auto, 1300.0, 0.4, -10.0), hue(PaletteName::Auto, 2500.0, 1.3, 0.0));
    assert!((wood.0 - rock.0).abs() >= 40.0, "hues of forest and rock: {wood:?}, {rock:?}");
    let winter = hue(PaletteName::Winter, 1300.0, 0.4, -10.0);
    assert!(
        winter.1 < 43.0 && winter.1 < 0.5 * hue(PaletteName::Winter, 2300.0, 0.2, 0.0).1,
        "forest in winter is dark: {winter:?}"
    );
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

#[test]
fn land_cover_decides_where_it_is_known_and_the_rules_where_it_is_not() {
    let classes = [Cover::Unknown, Cover::Forest, Cover::Grass, Cover::BuiltUp, Cover::Ice, Cover::Water, Cover::Bare];
    let row: Vec<Cover> = classes.iter().flat_map(|cover| [*cover; 32]).collect();
    let (cols, cells, from, spacing) = (row.len(), row.repeat(3), [0.0; 2], [100.0; 2]);
    let land = CoverMap { from, spacing, cols, cells, legend: "test" };
    let climate = Climate::at(9.0, 46.5);
    let tint = |land| GroundTint::new(&Palette::Placed(PaletteName::Auto, climate, land), [400.0, 4200.0]);
    let (known, ruled) = (tint(Some(Arc::new(land))), tint(None));
    for (k, class) in classes.into_iter().enumerate() {
        // The middle of the cells of a class, on a gentle meadow far below the line of trees.
        let east: [f32; 16] = std::array::from_fn(|i| 100.0 * (32 * k + 8 + i) as f32);
        let nodes = GroundNodes {
            height_m: &[700.0; 16],
            slope: [&[0.02; 16], &[0.03; 16]],
            broad: [&[0.02; 16], &[0.03; 16]],
            above_m: &[0.0; 16],
            at_m: [&east, &[100.0; 16]],
            spacing_m: 100.0,
        };
        let (a, b) = (known.cover(&nodes), ruled.cover(&nodes));
        let all = |of: [f32; 16], wanted: f32| of.iter().all(|v| (v - wanted).abs() < 1e-6);
        assert!(a.color.iter().flatten().chain(&a.snow).all(|v| v.is_finite() && *v >= 0.0), "{class:?}");
        match class {
            Cover::Unknown => assert_eq!((a.color, a.forest), (b.color, b.forest)),
            Cover::Forest => assert!(all(a.forest, 1.0) && all(a.bare, 0.0), "{:?}", a.forest),
            Cover::Ice => assert!(all(a.snow, 1.0) && all(a.forest, 0.0)),
            Cover::Bare => assert!(a.bare.iter().any(|bare| *bare > 0.1) && all(a.forest, 0.0), "{:?}", a.bare),
            _ => assert!(all(a.forest, 0.0) && all(a.bare, 0.0) && all(a.snow, 0.0), "{class:?}"),
        }
        if class == Cover::Water {
            assert!(a.color[2][0] > a.color[0][0], "water is blue");
        }
    }
}

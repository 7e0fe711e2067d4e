//! Classes of lines are told apart with every kind of colour vision.

use belvedere_scene::{Color, LineClass};

/// Linear light as it is, and as dichromats see it (Machado, Oliveira and Fernandes 2009, severity 1): without long, middle, short waves.
const EYES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
];
/// Least distance of the colours of two classes, or of their casings, in CIELAB, or else least ratio of their widths.
const APART: f64 = 20.0;
const CASINGS_APART: f64 = 30.0;
const WIDER: f64 = 1.3;
/// Least distance of a line or its casing from the ground: forest, snow, rock and meadow.
const OFF_GROUND: f64 = 25.0;
const GROUNDS: [Color; 4] =
    [Color::rgb(63, 92, 56), Color::rgb(240, 244, 250), Color::rgb(154, 147, 138), Color::rgb(147, 165, 102)];

/// CIELAB (D65) of a colour as somebody sees it.
fn seen(color: Color, by: &[[f64; 3]; 3]) -> [f64; 3] {
    let linear = [color.r, color.g, color.b].map(|v| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    });
    let times = |m: &[[f64; 3]; 3], v: [f64; 3]| m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    let light = times(by, linear).map(|v| v.clamp(0.0, 1.0));
    let to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    let f = |v: f64| if v > 216.0 / 24389.0 { v.cbrt() } else { (24389.0 / 27.0 * v + 16.0) / 116.0 };
    let [x, y, z] = times(&to_xyz, light);
    let [x, y, z] = [x / 0.95047, y, z / 1.08883].map(f);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn apart(a: Color, b: Color, eye: &[[f64; 3]; 3]) -> f64 {
    let (a, b) = (seen(a, eye), seen(b, eye));
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Whether two lines look alike to an eye: neither colour nor casing nor width tells them apart.
fn alike(a: LineClass, b: LineClass, eye: &[[f64; 3]; 3]) -> bool {
    let (a, b) = (a.look(), b.look());
    let ratio = a.width_px.max(b.width_px) / a.width_px.min(b.width_px);
    apart(a.color, b.color, eye) < APART && apart(a.casing, b.casing, eye) < CASINGS_APART && ratio < WIDER
}

#[test]
fn classes_of_lines_are_told_apart_with_every_colour_vision() {
    let classes = LineClass::NAMED.map(|(class, ..)| class);
    for eye in &EYES {
        for (i, a) in classes.iter().enumerate() {
            for b in &classes[i + 1..] {
                assert!(!alike(*a, *b, eye), "{a:?} and {b:?}: {:.1}", apart(a.look().color, b.look().color, eye));
            }
        }
    }
    // Grades of pistes have one width and one casing: their colours alone tell them apart.
    let grades = [LineClass::PisteGreen, LineClass::PisteBlue, LineClass::PisteRed, LineClass::PisteBlack];
    let width = grades[0].look().width_px;
    assert!(grades.iter().all(|grade| grade.look().width_px == width));
    // The judge is no rubber stamp: red and green of one lightness are alike without middle waves, and differ with them.
    let (red, green) = (Color::rgb(160, 80, 40), Color::rgb(105, 105, 40));
    assert!(apart(red, green, &EYES[2]) < APART && apart(red, green, &EYES[0]) > APART);
}

#[test]
fn lines_stand_out_of_forest_snow_rock_and_meadow() {
    for eye in &EYES {
        for (class, ground) in LineClass::NAMED.iter().flat_map(|(class, ..)| GROUNDS.map(|ground| (*class, ground))) {
            let look = class.look();
            let most = apart(look.color, ground, eye).max(apart(look.casing, ground, eye));
            assert!(most > OFF_GROUND, "{class:?} on {ground:?}: {most:.1}");
            assert!(apart(look.color, look.casing, eye) > OFF_GROUND, "{class:?}: its casing");
        }
    }
}

use super::*;

/// Linear light as dichromats see it (Machado, Oliveira and Fernandes 2009, severity 1): without long, middle, short waves.
const DICHROMATS: [[[f64; 3]; 3]; 3] = [
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
];

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

fn least(colors: &[Color]) -> (f64, String) {
    let mut worst = (f64::INFINITY, String::new());
    for by in &DICHROMATS {
        for (i, a) in colors.iter().enumerate() {
            for (j, b) in colors.iter().enumerate().skip(i + 1) {
                let (p, q) = (seen(*a, by), seen(*b, by));
                let apart = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
                if apart < worst.0 {
                    worst = (apart, format!("{i} and {j}: {apart:.1}"));
                }
            }
        }
    }
    worst
}

#[test]
fn classes_are_told_apart_with_every_colour_vision() {
    // A just noticeable difference is about 2.3.
    let (categories, which) = least(&CATEGORIES);
    assert!(categories > 9.0, "{which}");
    for (name, scale) in SCALES {
        let classes: Vec<Color> = (0..5).map(|i| scale.color_at(f64::from(i) / 4.0)).collect();
        let (apart, which) = least(&classes);
        assert!(apart > 9.0, "{name}: {which}");
    }
    // What differs in red and green alone does not.
    assert!(least(&[Color::rgb(160, 80, 40), Color::rgb(105, 105, 40)]).0 < 9.0);
}

use super::*;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, Pinhole, Projection};

fn camera() -> Pinhole {
    let screen = Projection::Perspective { fov_y: 0.9 };
    let (eye, target) = (DVec3::new(5e5, 4.6e6, 3000.0), DVec3::new(5.02e5, 4.61e6, 0.0));
    Pinhole::look_at(eye, target, DVec3::Z, screen, [160, 120], 1.0, None).unwrap()
}

fn views() -> Vec<(&'static str, View)> {
    let ph = camera();
    let earth = Stage::EarthCurvature(EarthCurvature { eye: ph.eye, radius: 2e5, refraction: 0.13 });
    let forward = ph.forward.with_z(0.0).normalize();
    let turn = |model, m| {
        let at = |d: f64| ph.eye + forward * d;
        let (viewpoint, pencil) = (ph.eye + DVec3::Z * 900.0, Pencil::Parallel { normal: -forward });
        let spec = TurnSpec { viewpoint, t0: at(4000.0), t1: at(5000.0), t2: at(6400.0), pencil, m };
        Stage::CurvedRays(CurvedRays::new(&ph, model, &[spec]).unwrap())
    };
    let level = ReferencePlane::level(0.0);
    let spline = |name| {
        let document = PresetDocument::builtin(name).unwrap();
        let bend = SplineBend::new(&ph, &document, &level, default_pivot(&ph, &level)).unwrap();
        (bend.adapted_pinhole(&ph), Stage::SplineBend(bend))
    };
    let of = |stages: &[&Stage]| View::new(ph.clone(), stages.iter().map(|s| (*s).clone()).collect()).unwrap();
    let (bent, progressive) = spline("progressive");
    let (bent_down, degressive) = spline("degressive");
    vec![
        ("earth", of(&[&earth])),
        ("conic", of(&[&turn(Model::Modified, Sharpness::Bend)])),
        ("sharp conic", of(&[&turn(Model::Modified, Sharpness::Value(6.0))])),
        ("parabola", of(&[&turn(Model::Original, Sharpness::Bend)])),
        ("kink", of(&[&turn(Model::C0, Sharpness::Bend)])),
        ("C2", of(&[&turn(Model::C2, Sharpness::Bend)])),
        ("earth and conic", of(&[&earth, &turn(Model::Modified, Sharpness::Bend)])),
        ("progressive", View::new(bent.clone(), vec![progressive.clone()]).unwrap()),
        ("degressive", View::new(bent_down, vec![degressive]).unwrap()),
        ("earth and spline", View::new(bent, vec![earth, progressive]).unwrap()),
    ]
}

#[test]
fn chords_stay_within_their_reach() {
    for (name, view) in views() {
        let split = Split::new(&view);
        let (mut spans_seen, mut tightest) = (0, 0.0f64);
        for i in 0..12 {
            let pixel = DVec2::new(f64::from(i) * 13.0 + 3.5, f64::from(i * 7 % 12) * 9.0 + 8.5);
            let row = split.row(pixel.y, [1.0, 30e3]);
            let curve = split.curve(pixel, row.as_ref());
            let mut spans = curve.spans([1.0, 30e3]);
            for level in 0..7 {
                for span in &spans {
                    let (Some((a, b)), true) = (span.chord(), span.reach.is_finite()) else { continue };
                    for k in 0..=24 {
                        let t = f64::from(k) / 24.0;
                        let Ok(truth) = view.ray(pixel).at(span.depth_at(t)) else { continue };
                        let off = truth.point.distance(a.lerp(b, t));
                        assert!(
                            off <= span.reach + 1e-7,
                            "{name} {pixel} level {level}: {off} m beyond {}",
                            span.reach
                        );
                        if span.reach > 1e-3 {
                            tightest = tightest.max(off / span.reach);
                        }
                        let here = curve.at(span.depth_at(t)).expect("the ray has the point");
                        assert!(here.distance(truth.point) < 1e-6, "{name}: {here} {}", truth.point);
                        spans_seen += 1;
                    }
                }
                spans = spans.iter().flat_map(|s| curve.halves(s)).collect();
            }
        }
        assert!(spans_seen > 5000, "{name}: {spans_seen}");
        // Bounds that are never nearly reached would be of little use, or hint at an error of this test.
        assert!(tightest > 0.02 || name == "kink", "{name}: {tightest}");
    }
}

#[test]
fn reach_falls_with_the_square_of_the_length() {
    for (name, view) in views().into_iter().filter(|(name, _)| *name != "kink") {
        let split = Split::new(&view);
        let pixel = DVec2::new(70.5, 50.5);
        let row = split.row(pixel.y, [1.0, 30e3]);
        let curve = split.curve(pixel, row.as_ref());
        let worst = |spans: &[Span]| spans.iter().map(|s| s.reach).filter(|r| r.is_finite()).fold(0.0, f64::max);
        let mut spans = curve.spans([1.0, 30e3]);
        for _ in 0..8 {
            spans = spans.iter().flat_map(|s| curve.halves(s)).collect();
        }
        let coarse = worst(&spans);
        for _ in 0..3 {
            spans = spans.iter().flat_map(|s| curve.halves(s)).collect();
        }
        // A jump of the curvature, where a curve meets its straight extension, costs half a power.
        assert!(worst(&spans) < coarse / 7.0, "{name}: {coarse} to {}", worst(&spans));
    }
}

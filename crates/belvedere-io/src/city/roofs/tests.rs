use super::*;
use std::collections::BTreeMap;

fn roof(tags: &[(&str, &str)]) -> Roof {
    let tags: BTreeMap<String, String> = tags.iter().map(|(k, v)| ((*k).into(), (*v).into())).collect();
    Roof::of(&tags, |t| t.parse().ok())
}

/// A turned rectangle of 20 m by 10 m at 47 degrees north.
fn house(turn: f64) -> Polygon {
    let scale = DVec2::new(DEGREE_M * 47f64.to_radians().cos(), DEGREE_M);
    let corner = |x: f64, y: f64| DVec2::new(11.0, 47.0) + DVec2::from_angle(turn).rotate(DVec2::new(x, y)) / scale;
    Polygon {
        outer: vec![corner(-10.0, -5.0), corner(10.0, -5.0), corner(10.0, 5.0), corner(-10.0, 5.0)],
        holes: vec![],
    }
}

/// Volume within faces, cubic metres, by the divergence theorem; and how far they are from closed.
fn volume(faces: &[CityFace]) -> (f64, f64) {
    let scale = DVec3::new(DEGREE_M * 47f64.to_radians().cos(), DEGREE_M, 1.0);
    let origin = DVec3::new(11.0, 47.0, 0.0);
    let (mut volume, mut open) = (0.0, DVec3::ZERO);
    for face in faces {
        let ring: Vec<DVec3> = face.rings[0].iter().map(|p| (*p - origin) * scale).collect();
        for k in 1..ring.len() - 1 {
            let n = 0.5 * (ring[k] - ring[0]).cross(ring[k + 1] - ring[0]);
            volume += n.dot(ring[0]) / 3.0;
            open += n;
        }
    }
    (volume, open.length())
}

/// Volumes of roofs 4 m high over eaves of 6 m, by hand.
#[test]
fn every_shape_closes_and_holds_what_it_should() {
    let heights = Heights { under: 0.0, eaves: 6.0, top: 10.0 };
    let dome = 0.5;
    for (shape, share, tolerance) in [
        ("flat", 1.0, 1e-6),
        ("gabled", 0.5, 1e-6),
        ("skillion", 0.5, 1e-6),
        ("hipped", 0.5 * (1.0 - 0.5 / 3.0), 1e-6),
        ("pyramidal", 1.0 / 3.0, 1e-6),
        ("gambrel", 0.6 * 0.825 + 0.4 * 0.325, 1e-6),
        ("round", std::f64::consts::FRAC_PI_4, 0.03),
        ("dome", dome, 0.2),
        ("mansard", 0.5, 0.1),
        ("half-hipped", 0.5, 0.05),
    ] {
        for turn in [0.0, 0.4, 2.0] {
            let faces = solid(&house(turn), heights, &roof(&[("roof:shape", shape)]));
            let (volume, open) = volume(&faces);
            let want = 200.0 * (6.0 + 4.0 * share);
            assert!(open < 1e-3, "{shape} {turn}: open by {open}");
            assert!((volume - want).abs() <= 800.0 * tolerance + 1e-2, "{shape} {turn}: {volume}, not {want}");
            let top = faces.iter().flat_map(|f| &f.rings[0]).map(|p| p.z).fold(0.0, f64::max);
            assert!((top - 10.0).abs() < 1e-6, "{shape}: {top}");
        }
    }
}

#[test]
fn a_raised_part_has_an_underside_and_courts_stay_flat() {
    let heights = Heights { under: 10.0, eaves: 50.0, top: 50.0 };
    let faces = solid(&house(0.3), heights, &roof(&[]));
    let lowest = faces.iter().flat_map(|f| &f.rings[0]).map(|p| p.z).fold(f64::INFINITY, f64::min);
    assert_eq!((lowest, faces.len()), (10.0, 6));
    assert!((volume(&faces).0 - 200.0 * 40.0).abs() < 1.0);
    let mut court = house(0.0);
    court.holes = vec![house(0.0).outer.iter().rev().map(|p| (*p + DVec2::new(11.0, 47.0)) / 2.0).collect()];
    let faces = solid(&court, Heights { under: 0.0, eaves: 6.0, top: 10.0 }, &roof(&[("roof:shape", "gabled")]));
    assert_eq!(faces.iter().filter(|f| f.surface == Surface::Roof).count(), 1);
}

#[test]
fn an_l_shaped_house_has_a_closed_roof() {
    let scale = DVec2::new(DEGREE_M * 47f64.to_radians().cos(), DEGREE_M);
    let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 8.0), (8.0, 8.0), (8.0, 15.0), (0.0, 15.0)];
    let outer = corners.map(|(x, y)| DVec2::new(11.0, 47.0) + DVec2::new(x, y) / scale).to_vec();
    for shape in ["gabled", "hipped", "skillion", "pyramidal", "dome"] {
        let heights = Heights { under: 0.0, eaves: 6.0, top: 10.0 };
        let faces = solid(&Polygon { outer: outer.clone(), holes: vec![] }, heights, &roof(&[("roof:shape", shape)]));
        let (volume, open) = volume(&faces);
        assert!(open < 1e-2 && (216.0 * 6.0..216.0 * 10.0).contains(&volume), "{shape}: {volume} {open}");
    }
}

use super::*;
use belvedere_scene::Color;

#[test]
fn walls_and_tops_get_points_by_their_area_just_in_front_of_them() {
    let shape = BoxShape {
        base: DVec3::new(10.0, 0.0, 5.0),
        size: DVec3::new(6.0, 3.0, 2.0),
        yaw: 0.4,
        color: Color::rgb(1, 2, 3),
    };
    let found = surface(&LayerKind::Boxes(BoxLayer::new(vec![shape])), 0.1).unwrap();
    // Walls 2 (6 + 3) 2, top 18.
    let area: f64 = found.samples.iter().map(|s| s.amount).sum();
    assert!(
        (area - 54.0).abs() < 1e-9 && (5390..5410).contains(&found.samples.len()),
        "{area} {}",
        found.samples.len()
    );
    let top = found.samples.iter().filter(|s| s.surface.unwrap().z > 0.5).count() as f64;
    assert!((top / found.samples.len() as f64 - 18.0 / 54.0).abs() < 0.005, "{top}");
    let corners = shape.corners();
    for s in &found.samples {
        let n = s.surface.unwrap();
        // Outside by a little: beyond every corner along the normal.
        let beyond = corners.iter().map(|c| n.dot(s.p_world - *c)).fold(f64::INFINITY, f64::min);
        assert!((1e-6..1e-3).contains(&beyond), "{beyond}");
    }
    // Evenly: both halves of the top alike.
    let left =
        found.samples.iter().filter(|s| s.surface.unwrap().z > 0.5 && (s.p_world - shape.base).dot(DVec3::X) < 0.0);
    assert!((left.count() as f64 / top - 0.5).abs() < 0.05);
    assert_eq!(found.samples, surface(&LayerKind::Boxes(BoxLayer::new(vec![shape])), 0.1).unwrap().samples);
}

#[test]
fn nothing_has_no_points_and_numbers_have_limits() {
    assert_eq!(surface(&LayerKind::Boxes(BoxLayer::default()), 1.0).unwrap().samples, []);
    let one = [[DVec3::ZERO, DVec3::X, DVec3::Y]];
    assert_eq!(spread(&one, 77, 0.0).len(), 77);
    let shape = BoxShape { base: DVec3::ZERO, size: DVec3::ONE, yaw: 0.0, color: Color::rgb(1, 2, 3) };
    let layer = LayerKind::Boxes(BoxLayer::new(vec![shape]));
    assert_eq!([1e-6, 1e6].map(|spacing| surface(&layer, spacing).unwrap().samples.len()), [6000, 1000]);
}

use super::*;
use crate::NodeState;

fn ridge(void: Option<usize>) -> Heightfield {
    let heights = (0..36).map(|i| ((i % 6) * (i % 6) + (i / 6) * 3) as f32).collect();
    let mut states = vec![NodeState::Measured; 36];
    if let Some(i) = void {
        states[i] = NodeState::Void;
    }
    Heightfield::new(DVec2::new(0.0, 50.0), DVec2::splat(10.0), 6, 6, heights, states).unwrap()
}

#[test]
fn a_draped_line_lies_on_the_surface_everywhere() {
    let hf = ridge(None);
    let d = drape_polyline(
        &hf,
        &[DVec2::new(1.0, 3.0), DVec2::new(47.3, 41.9), DVec2::new(47.3, 41.9), DVec2::new(3.0, 30.0)],
    );
    assert_eq!(d.parts.len(), 1);
    assert_eq!(d.outside_m, 0.0);
    let mut length = 0.0;
    for w in d.parts[0].windows(2) {
        length += w[0].truncate().distance(w[1].truncate());
        for k in 0..=10 {
            let p = w[0].lerp(w[1], f64::from(k) / 10.0);
            let z = hf.surface_at(p.truncate()).unwrap();
            assert!((p.z - z).abs() < 1e-9, "{p} floats {} m", p.z - z);
        }
    }
    assert!((length - d.length_m).abs() < 1e-9);
}

#[test]
fn a_line_across_a_void_falls_into_two_parts() {
    let hf = ridge(Some(2 * 6 + 2)); // node at (20, 30)
    let d = drape_polyline(&hf, &[DVec2::new(0.0, 29.0), DVec2::new(50.0, 29.0)]);
    assert_eq!(d.parts.len(), 2);
    // along y = 29 the triangles with that corner are crossed at x = 11..20 (upper one of its cell) and 20..30 (both)
    assert!((d.outside_m - 19.0).abs() < 1e-9, "{}", d.outside_m);
}

#[test]
fn what_leaves_the_grid_is_measured() {
    let d = drape_polyline(&ridge(None), &[DVec2::new(-30.0, 25.0), DVec2::new(70.0, 25.0)]);
    assert_eq!(d.parts.len(), 1);
    assert!((d.outside_m - 50.0).abs() < 1e-9);
    let d = drape_polyline(&ridge(None), &[DVec2::new(-30.0, 90.0), DVec2::new(70.0, 90.0)]);
    assert!(d.parts.is_empty());
    assert!((d.outside_m - d.length_m).abs() < 1e-9);
}

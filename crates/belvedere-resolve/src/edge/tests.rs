use super::*;
use belvedere_scene::NodeState;

fn ground(void: impl Fn(usize, usize) -> bool) -> Heightfield {
    let (cols, rows) = (9, 7);
    let heights = (0..cols * rows).map(|i| 100.0 + (i % cols) as f32 * 3.0 + (i / cols) as f32).collect();
    let state = |i: usize| if void(i % cols, i / cols) { NodeState::Void } else { NodeState::Measured };
    let states = (0..cols * rows).map(state).collect();
    Heightfield::new(DVec2::new(500.0, 900.0), DVec2::splat(10.0), cols, rows, heights, states).expect("ground")
}

#[test]
fn sides_stand_around_all_data_face_outwards_and_reach_from_the_ground_to_the_base() {
    let hf = ground(|_, _| false);
    let mesh = sides(&hf, 50.0).expect("sides");
    assert_eq!(mesh.triangles().len(), 2 * 2 * (8 + 6));
    let middle = hf.bounds().center();
    for t in 0..mesh.triangles().len() {
        let corners = mesh.corners(t);
        let outward = (corners[0] - middle).truncate();
        let normal = mesh.face_normal(t);
        assert!(normal.z.abs() < 1e-6 && normal.truncate().dot(outward) > 0.0, "{corners:?} {normal}");
        for p in corners {
            let on_ground = hf.surface_at(p.truncate()).is_some_and(|z| (z - p.z).abs() < 1e-3);
            assert!((p.z - 50.0).abs() < 1e-3 || on_ground, "{p}");
        }
    }
}

#[test]
fn sides_follow_the_rim_of_voids() {
    // A corner without data: the cells that touch it have none either.
    let mesh = sides(&ground(|c, r| c < 2 && r < 2), 0.0).expect("sides");
    assert_eq!(mesh.triangles().len(), 2 * 2 * (8 + 6), "a notch is as long as what it cuts off");
    // One node alone has no cell.
    assert!(sides(&ground(|c, r| c > 0 || r > 0), 0.0).is_none());
}

#[test]
fn a_mat_lies_below_the_ground_and_goes_on_beyond_it() {
    let hf = ground(|_, _| false);
    let mesh = mat(&hf).expect("a mat");
    let (all, own) = (mesh.bounds(), hf.bounds());
    assert!(all.min.z < own.min.z && all.min.z > own.min.z - 1.0);
    assert!(all.min.x < own.min.x - 79.0 && all.max.y > own.max.y + 79.0);
}

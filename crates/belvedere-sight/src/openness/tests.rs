use super::*;
use belvedere_scene::MeshColors;

/// Four corners of a rectangle as two triangles.
fn rectangle(corners: [[f64; 3]; 4], positions: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>) {
    let first = positions.len() as u32;
    positions.extend(corners.map(DVec3::from_array));
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

fn settings(rays: usize) -> OpennessSettings {
    OpennessSettings { reach: 40.0, step: 8.0, rays }
}

/// A floor from 0 to 200 in both directions, and a wall of a height at x = 0.
fn corner(height: f64) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    rectangle(
        [[0.0, 0.0, 0.0], [200.0, 0.0, 0.0], [200.0, 200.0, 0.0], [0.0, 200.0, 0.0]],
        &mut positions,
        &mut triangles,
    );
    rectangle(
        [[0.0, 0.0, 0.0], [0.0, 200.0, 0.0], [0.0, 200.0, height], [0.0, 0.0, height]],
        &mut positions,
        &mut triangles,
    );
    Mesh::new(&positions, triangles, MeshColors::Layer).unwrap()
}

#[test]
fn sample_points_are_bounded_by_the_triangles_whatever_the_reach() {
    let mut whole = Vec::new();
    for side in [1.0, 30.0] {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for k in 0..200 {
            let (x, y) = (2.0 * side * f64::from(k % 20), 2.0 * side * f64::from(k / 20));
            let corner = |dx: f64, dy: f64| [x + dx * side, y + dy * side, 0.0];
            let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            rectangle(corners, &mut positions, &mut triangles);
        }
        let mesh = Mesh::new(&positions, triangles, MeshColors::Layer).unwrap();
        for reach in [20.0, 0.2, 1e-3, 1e-9, f64::MIN_POSITIVE] {
            let settings = OpennessSettings::reaching(reach);
            let step = spacing(&mesh, settings.step);
            let of = |t: usize| usize::from(steps_of(mesh.corners(t), step));
            let points: usize = (0..400).map(|t| (of(t) + 1) * (of(t) + 2) / 2).sum();
            assert!(points <= 64 * 400 + 131_072, "{points} for a reach of {reach}");
            assert!(step == settings.step || points > 50_000, "no coarser than needed: {points}, {reach}");
            whole.push(step == settings.step);
        }
    }
    assert!(whole[0] && whole[5] && !whole[8], "{whole:?}");
}

#[test]
fn triangles_that_no_time_is_left_for_take_all_light_and_are_counted() {
    let late = Progress::silent().limited(std::time::Duration::ZERO).begin();
    let found = with_ambient_occlusion(corner(60.0), None, &settings(32), &late).unwrap();
    assert_eq!(found.left_out, 4);
    let all = with_ambient_occlusion(corner(60.0), None, &settings(32), &Progress::silent()).unwrap();
    assert_eq!((all.left_out, all.step), (0, 8.0));
    let cancelled = Progress::silent();
    cancelled.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(with_ambient_occlusion(corner(60.0), None, &settings(32), &cancelled).is_err());
}

/// Openness of the floor at a distance from an infinite wall, by quadrature over directions.
fn by_quadrature(distance: f64, reach: f64) -> f64 {
    let n = 400;
    let mut lost = 0.0;
    for i in 0..n {
        for j in 0..n {
            let (u, v) = ((f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n));
            let towards = -u.sqrt() * (std::f64::consts::TAU * v).cos();
            let r = if towards > 0.0 { distance / towards } else { f64::INFINITY };
            lost += (1.0 - (r / reach).powi(2)).max(0.0);
        }
    }
    1.0 - lost / f64::from(n * n)
}

#[test]
fn a_wall_takes_from_the_floor_what_the_integral_says() {
    let fine = OpennessSettings { step: 4.0, ..settings(512) };
    let mesh = with_ambient_occlusion(corner(60.0), None, &fine, &Progress::silent()).unwrap().mesh;
    for distance in [2.0, 6.0, 12.0, 25.0, 60.0] {
        let p = DVec3::new(distance, 100.0, 0.0);
        let triangle = usize::from(distance < 100.0);
        let open = mesh.openness_at(triangle, mesh.weights_at(triangle, p));
        let expected = by_quadrature(distance, 40.0);
        assert!((open - expected).abs() < 0.03, "{distance}: {open}, {expected}");
    }
}

#[test]
fn what_is_alone_is_open_and_ground_shades_the_foot_of_a_wall() {
    let alone = with_ambient_occlusion(corner(0.0), None, &settings(32), &Progress::silent()).unwrap().mesh;
    assert_eq!(alone.openness_at(0, [0.3, 0.3, 0.4]), 1.0);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    rectangle(
        [[0.0, 0.0, 10.0], [0.0, 100.0, 10.0], [0.0, 100.0, 60.0], [0.0, 0.0, 60.0]],
        &mut positions,
        &mut triangles,
    );
    let wall = Mesh::new(&positions, triangles, MeshColors::Layer).unwrap();
    let level = |_: DVec2| Some(10.0);
    let wall = with_ambient_occlusion(wall, Some(&level), &settings(256), &Progress::silent()).unwrap().mesh;
    let open = |z: f64| wall.openness_at(0, wall.weights_at(0, DVec3::new(0.0, 95.0, z)));
    // Half of the directions meet the ground, those of its foot at distance 0.
    assert!((open(10.0) - 0.5).abs() < 0.06, "{}", open(10.0));
    assert!(open(20.0) > open(12.0) && open(55.0) > 0.97, "{} {} {}", open(12.0), open(20.0), open(55.0));
}

#[test]
fn closed_things_are_light_outside_whichever_way_their_faces_run() {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let c = |x: f64, y: f64, z: f64| [10.0 * x, 10.0 * y, 10.0 * z];
    for (corners, turned) in [
        ([c(0.0, 0.0, 0.0), c(1.0, 0.0, 0.0), c(1.0, 1.0, 0.0), c(0.0, 1.0, 0.0)], true),
        ([c(0.0, 0.0, 1.0), c(1.0, 0.0, 1.0), c(1.0, 1.0, 1.0), c(0.0, 1.0, 1.0)], false),
        ([c(0.0, 0.0, 0.0), c(1.0, 0.0, 0.0), c(1.0, 0.0, 1.0), c(0.0, 0.0, 1.0)], true),
        ([c(0.0, 1.0, 0.0), c(1.0, 1.0, 0.0), c(1.0, 1.0, 1.0), c(0.0, 1.0, 1.0)], false),
        ([c(0.0, 0.0, 0.0), c(0.0, 1.0, 0.0), c(0.0, 1.0, 1.0), c(0.0, 0.0, 1.0)], true),
        ([c(1.0, 0.0, 0.0), c(1.0, 1.0, 0.0), c(1.0, 1.0, 1.0), c(1.0, 0.0, 1.0)], false),
    ] {
        let mut corners = corners;
        if turned {
            corners.reverse();
        }
        rectangle(corners, &mut positions, &mut triangles);
    }
    let cube = Mesh::new(&positions, triangles, MeshColors::Layer).unwrap();
    let cube = with_ambient_occlusion(cube, None, &settings(64), &Progress::silent()).unwrap().mesh;
    for triangle in 0..12 {
        assert!(cube.openness_at(triangle, [0.3, 0.3, 0.4]) > 0.98, "{triangle}");
    }
}

/// Points of fat triangles are a step apart at most, and no closer than that needs; points of slivers are limited by their area.
#[test]
fn steps_fit_the_edges_and_the_area_wherever_a_triangle_stands() {
    for middle in [DVec3::ZERO, DVec3::new(5e5, 4.7e6, 900.0)] {
        for (side, steps) in [(0.3, 1), (1.0, 1), (2.5, 3), (7.0, 7), (7.25, 8), (41.5, 42)] {
            let corners = [[0.0, 0.0], [side, 0.0], [0.5 * side, 0.8 * side]];
            let corners = corners.map(|[x, y]| middle + 4.0 * DVec3::new(x, 0.6 * y, 0.8 * y));
            assert_eq!(steps_of(corners, 4.0), steps, "{side} at {middle}");
        }
        // An area of 0.5 and an edge of 250 steps need about 254 points; 4 times as many are the most.
        let sliver = [DVec3::ZERO, DVec3::new(250.0, 0.0, 0.0), DVec3::new(125.0, 0.004, 0.0)].map(|p| middle + p);
        let steps = u32::from(steps_of(sliver, 1.0));
        assert!((40..=45).contains(&steps) && steps * steps / 2 <= 4 * 255, "{steps} at {middle}");
    }
}

/// Level ground with a pit from x = `pit` on: a ray that would meet the level ground passes over the pit.
#[test]
fn rays_meet_the_ground_where_they_come_down() {
    let mesh = corner(1.0);
    let tree = MeshTree::new(&mesh);
    let (from, by) = (DVec3::new(0.0, 0.0, 1.0), DVec3::new(4.0, 0.0, -2.0));
    for (pit, meets) in [(1.0, false), (1.9, false), (2.1, true), (9.0, true)] {
        let ground = move |xy: DVec2| Some(if xy.x < pit { 0.0 } else { -10.0 });
        let around = Around { tree: &tree, ground: Some(&ground), rays: &[], lift: 0.0 };
        assert_eq!(around.is_under(from, by), meets, "pit from {pit}");
    }
}

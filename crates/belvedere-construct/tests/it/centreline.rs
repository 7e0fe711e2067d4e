//! Centrelines through voxels of known shape.

use belvedere_construct::centreline::centreline;
use belvedere_core::{DMat3, DVec3};
use belvedere_scene::{Volume, VoxelValues};

const COIL: f64 = 15.0;
const TUBE: f64 = 5.0;
/// Height per radian.
const RISE: f64 = 2.6;
const TURNS: f64 = 2.25;

/// Point of a helix, by its angle.
fn helix(angle: f64) -> DVec3 {
    DVec3::new(25.0 + COIL * angle.cos(), 25.0 + COIL * angle.sin(), 8.0 + RISE * angle)
}

/// Distance to the helix, and the angle of its nearest point.
fn to_helix(p: DVec3) -> (f64, f64) {
    let steps = 4000;
    let angle = |k: i32| TURNS * std::f64::consts::TAU * f64::from(k) / f64::from(steps);
    let all = (0..=steps).map(|k| (p.distance(helix(angle(k))), angle(k)));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// A tube around the helix with dense values in it; voxels 0.8, 0.8 and 1.2 apart, the whole turned and moved.
fn tube() -> (Volume, DMat3, DVec3) {
    let (dims, spacing) = ([64, 64, 46], DVec3::new(0.8, 0.8, 1.2));
    let value = |i: usize| {
        let p = DVec3::new((i % 64) as f64, (i / 64 % 64) as f64, (i / 4096) as f64) * spacing;
        let plan = (p.truncate() - DVec3::splat(25.0).truncate()).length();
        // Voxels far from the coil need no search.
        let off = if (plan - COIL).abs() > TUBE + 1.0 { f64::INFINITY } else { to_helix_fast(p) };
        (100.0 + 40.0 * (TUBE - off)).clamp(0.0, 220.0) as u8
    };
    let values = VoxelValues::U8((0..64 * 64 * 46).map(value).collect());
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(1.1);
    let offset = DVec3::new(300.0, -20.0, 7.0);
    (Volume::new(dims, turn * DMat3::from_diagonal(spacing), offset, values).unwrap(), turn, offset)
}

/// The distance alone: the nearest angles are those of the place itself, turn by turn.
fn to_helix_fast(p: DVec3) -> f64 {
    let own = (p.y - 25.0).atan2(p.x - 25.0).rem_euclid(std::f64::consts::TAU);
    let most = TURNS * std::f64::consts::TAU;
    let mut best = f64::INFINITY;
    for turn in -1..=3 {
        let middle = own + std::f64::consts::TAU * f64::from(turn);
        for k in -20..=20 {
            best = best.min(p.distance(helix((middle + 0.02 * f64::from(k)).clamp(0.0, most))));
        }
    }
    best
}

#[test]
fn the_way_keeps_to_the_middle_of_a_coiled_tube() {
    let (volume, turn, offset) = tube();
    let scene = |p: DVec3| turn * p + offset;
    let most = TURNS * std::f64::consts::TAU;
    // Picked beside the middle, as one does.
    let (from, to) = (scene(helix(0.15) + DVec3::new(2.0, 0.0, 1.0)), scene(helix(most - 0.15) - DVec3::Z * 2.0));
    let found = centreline(&volume, from, to, [100.0, 255.0]).unwrap();
    assert_eq!(
        (found.points[0], found.points[found.points.len() - 1]),
        (from, to),
        "it begins and ends where it was asked to"
    );
    let inverse = turn.transpose();
    let (mut worst, mut last) = (0.0f64, 0.0);
    for p in &found.points {
        let (off, angle) = to_helix(inverse * (*p - offset));
        // The ways from the picked points to the middle are not judged.
        if angle > 0.5 && angle < most - 0.5 {
            worst = worst.max(off);
        }
        assert!(angle > last - 0.06, "it goes back from {last} to {angle}");
        last = angle.max(last);
    }
    assert!(worst < 1.0, "{worst} from the middle, edges of voxels are 0.8 and 1.2");
    let per_radian = (COIL * COIL + RISE * RISE).sqrt();
    let want = per_radian * (most - 0.3);
    assert!((found.report.length / want - 1.0).abs() < 0.04, "{} for {want}", found.report.length);
    let clearance = found.report.median_clearance;
    assert!((clearance - TUBE).abs() < 1.0, "{clearance}");
    // Steps are even and small.
    for pair in found.points.windows(2) {
        assert!(pair[0].distance(pair[1]) < 0.8, "{}", pair[0].distance(pair[1]));
    }
    assert_eq!(centreline(&volume, from, to, [100.0, 255.0]).unwrap(), found);
}

/// 24^3 voxels of 100, and of 0 where `wall` says so.
fn walled(wall: impl Fn([i32; 3]) -> bool) -> Volume {
    let at = |i: i32| [i % 24, i / 24 % 24, i / 576];
    let values = (0..24 * 24 * 24).map(|i| if wall(at(i)) { 0 } else { 100 }).collect();
    Volume::new([24; 3], DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(values)).unwrap()
}

#[test]
fn walls_are_tight_and_gates_are_found() {
    let (from, to) = (DVec3::new(4.0, 4.0, 12.0), DVec3::new(20.0, 20.0, 12.0));
    // A diagonal wall one voxel thick, which touches itself at edges only.
    let error = centreline(&walled(|[x, y, _]| x + y == 24), from, to, [50.0, 255.0]).unwrap_err().to_string();
    assert!(error.contains("not connected by voxels of 50 to 255") && error.contains("come within"), "{error}");
    // With a gate at one side.
    let gate = |[x, y, z]: [i32; 3]| (20..23).contains(&y) && (3..6).contains(&z) && x < 24;
    let open = walled(|p| p[0] + p[1] == 24 && !gate(p));
    let found = centreline(&open, from, to, [50.0, 255.0]).unwrap();
    let crossing = found.points.windows(2).find(|w| (w[0].x + w[0].y < 24.0) && (w[1].x + w[1].y >= 24.0)).unwrap();
    assert!(crossing[0].y > 19.0 && (2.0..7.0).contains(&crossing[0].z), "{}", crossing[0]);
    assert!(found.points.iter().all(|p| open.at(*p).is_some_and(|v| v > 20.0)));
}

#[test]
fn what_cannot_be_is_said_with_numbers() {
    let volume = walled(|[x, _, _]| x < 12);
    let at = |x: f64| DVec3::new(x, 12.0, 12.0);
    let error = |from, to, values| centreline(&volume, from, to, values).unwrap_err().to_string();
    let text = error(at(3.0), at(20.0), [50.0, 255.0]);
    assert!(text.contains("from = [3, 12, 12] has the value 0") && text.contains("within 3 of it"), "{text}");
    let text = error(at(20.0), at(90.0), [50.0, 255.0]);
    assert!(text.contains("to = [90, 12, 12] has no value, it lies outside the volume"), "{text}");
    assert!(error(at(20.0), at(f64::NAN), [50.0, 255.0]).contains("no value"));
    assert!(error(at(20.0), at(21.0), [50.0, 5.0]).contains("the least first"));
    // A point a little beside the voxels of the range is taken for the nearest of them.
    let found = centreline(&volume, at(10.4), at(20.0), [50.0, 255.0]).unwrap();
    assert_eq!(found.points[0], at(12.0));
    let same = centreline(&volume, at(20.0), at(20.0), [50.0, 255.0]).unwrap();
    assert_eq!((same.points.len(), same.report.length), (1, 0.0));
}

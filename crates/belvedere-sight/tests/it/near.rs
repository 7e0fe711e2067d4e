//! What comes near a segment, against searches that look at everything.

use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{BoxShape, Color, Heightfield};
use belvedere_sight::{BoxTree, Ground};
use belvedere_testkit::Random;
use belvedere_testkit::synthetic::mountains;
use std::collections::BTreeSet;

const COLOR: Color = Color::rgb(1, 2, 3);

fn point(random: &mut Random, side: f64) -> DVec3 {
    DVec3::new(random.range(-side, side), random.range(-side, side), random.range(-10.0, 40.0))
}

fn boxes(random: &mut Random, count: usize) -> Vec<BoxShape> {
    let one = |_| BoxShape {
        base: point(random, 100.0),
        size: DVec3::new(random.range(2.0, 20.0), random.range(2.0, 20.0), random.range(2.0, 30.0)),
        yaw: random.range(0.0, 6.0),
        color: COLOR,
    };
    (0..count).map(one).collect()
}

/// Position in a box: along its own axes from its middle, as shares of half its size.
fn local(shape: &BoxShape, p: DVec3) -> DVec3 {
    let d = p - (shape.base + 0.5 * shape.size.z * DVec3::Z);
    DVec2::from_angle(-shape.yaw).rotate(d.truncate()).extend(d.z) / (0.5 * shape.size)
}

/// A tree visits every box that one of 1,000 points of the segment lies in, and none that is farther than its reach from all of them.
#[test]
fn trees_of_boxes_visit_what_a_segment_meets() {
    let random = &mut Random::new(5);
    let (mut met, mut passed) = (0, 0);
    for count in [1, 4, 5, 40, 150] {
        let shapes = boxes(random, count);
        let tree = BoxTree::new(shapes.iter().enumerate().map(|(i, shape)| ([3, i], shape)), None);
        for _ in 0..60 {
            let (a, b) = (point(random, 140.0), point(random, 140.0));
            let mut visited = BTreeSet::new();
            assert!(tree.near(a, b, 0.0, &mut |shape, [t0, t1]| {
                assert!(shape.layer == 3 && (0.0..=1.0).contains(&t0) && t0 <= t1 && t1 <= 1.0);
                visited.insert(shape.index)
            }));
            for (i, shape) in shapes.iter().enumerate() {
                let deepest = (0..=1000)
                    .map(|k| local(shape, a.lerp(b, f64::from(k) / 1000.0)).abs().max_element())
                    .fold(f64::INFINITY, f64::min);
                assert!(deepest > 1.0 || visited.contains(&i), "{count}: box {i} is met, but not visited");
                assert!(deepest < 1.3 || !visited.contains(&i), "{count}: box {i} is visited, but not met");
                met += usize::from(visited.contains(&i));
                passed += usize::from(!visited.contains(&i));
            }
            let first = tree.near(a, b, 0.0, &mut |_, _| false);
            assert_eq!(first, visited.is_empty(), "a visit that ends the search says so");
        }
    }
    assert!(met > 80 && passed > 5000, "{met} {passed}");
}

/// Outside a face, the normal of a box leads away from it: a small step along it raises the distance by as much.
#[test]
fn normals_of_boxes_lead_away_from_their_nearest_face() {
    let random = &mut Random::new(8);
    for shape in boxes(random, 40) {
        let tree = BoxTree::new([([0, 0], &shape)], None);
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut on_face = [0.3, -0.2, 0.4];
                on_face[axis] = 1.2 * side;
                let own = DVec3::from_array(on_face) * 0.5 * shape.size;
                let plan = DVec2::from_angle(shape.yaw).rotate(own.truncate());
                let p = plan.extend(own.z) + shape.base + 0.5 * shape.size.z * DVec3::Z;
                let mut seen = 0;
                tree.near(p, p, 20.0, &mut |found, _| {
                    let normal = found.normal(p);
                    let rise = found.outside(p + 0.01 * normal) - found.outside(p);
                    assert!((rise - 0.01).abs() < 1e-9, "{axis} {side}: {rise}");
                    seen += 1;
                    true
                });
                assert_eq!(seen, 1);
            }
        }
    }
}

/// Clear is never said of a segment that a dense search finds within the reach of the ground, and is said of most others.
#[test]
fn clear_segments_keep_their_distance_from_the_ground() {
    let hf = mountains(40, 4);
    let ground = Ground::lifted(&hf, None);
    let (size, random) = (hf.bounds().max.x, &mut Random::new(11));
    let (mut clear, mut high) = (0, 0);
    for _ in 0..600 {
        let mut end = || DVec3::new(random.range(-0.2, 1.2) * size, random.range(-0.2, 1.2) * size, 0.0);
        let (a, b) = (end(), end());
        let [low, top] = hf.z_range();
        let mut z = || random.range(low - 100.0, top + 500.0);
        let (a, b) = (a + z() * DVec3::Z, b + z() * DVec3::Z);
        let reach = [0.0, 5.0, 60.0, 150.0][random.below(4)];
        let gap = (0..=1500)
            .filter_map(|k| {
                let p = a.lerp(b, f64::from(k) / 1500.0);
                hf.surface_at(p.truncate()).map(|z| (p.z - z).abs())
            })
            .fold(f64::INFINITY, f64::min);
        let said = ground.is_clear(a, b, reach);
        assert!(!said || gap > reach, "{a} {b}: {gap} m away, reach {reach}");
        clear += usize::from(said);
        let far = a.z.min(b.z) > top + reach + 1.0;
        assert!(said || !far, "{a} {b} lies above everything");
        high += usize::from(far);
    }
    assert!(clear > 150 && high > 60, "{clear} {high}");
}

/// Over level ground with one high peak, a line 20 m over the ground is clear within 5 m wherever the peak is 64 cells away.
#[test]
fn a_peak_far_away_does_not_make_a_low_line_unclear() {
    let (side, spacing) = (129, 30.0);
    let heights = (0..side * side).map(|i| if i == 0 { 3000.0 } else { 0.0 }).collect();
    let hf = Heightfield::measured(DVec2::ZERO, DVec2::splat(spacing), side, side, heights).expect("ground");
    let ground = Ground::lifted(&hf, None);
    for (row, east) in [(70.5, 125.0), (100.0, 80.0), (120.2, 20.0)] {
        let at = |col: f64| DVec3::new(spacing * col, -spacing * row, 20.0);
        assert!(ground.is_clear(at(3.0), at(east), 5.0), "row {row}");
        assert!(!ground.is_clear(at(3.0), at(east), 25.0), "row {row}");
    }
}

/// A box is off the ground only if no point of it meets it: at a grid of places in plan, the surface is below or above it, or beside.
#[test]
fn boxes_off_the_ground_meet_none_of_it() {
    let hf = mountains(40, 6);
    let ground = Ground::lifted(&hf, None);
    let (size, random) = (hf.bounds().max.x, &mut Random::new(13));
    let [low, top] = hf.z_range();
    let (mut off, mut far) = (0, 0);
    for _ in 0..3000 {
        let min = DVec3::new(
            random.range(-0.1, 1.1) * size,
            random.range(-0.1, 1.1) * size,
            random.range(low - 60.0, top + 60.0),
        );
        let bounds = Aabb {
            min,
            max: min + DVec3::new(random.range(1.0, 300.0), random.range(1.0, 300.0), random.range(1.0, 80.0)),
        };
        let said = ground.is_off(&bounds);
        let meets = (0..400).any(|k| {
            let share = DVec2::new(f64::from(k % 20), f64::from(k / 20)) / 19.0;
            let p = bounds.min.truncate() + share * (bounds.max - bounds.min).truncate();
            hf.surface_at(p).is_some_and(|z| (bounds.min.z..=bounds.max.z).contains(&z))
        });
        assert!(!said || !meets, "{bounds:?}");
        off += usize::from(said);
        let is_far = min.z > top || bounds.max.z < low || min.x > size || bounds.max.x < 0.0;
        assert!(said || !is_far, "{bounds:?} is beside all ground");
        far += usize::from(is_far);
    }
    assert!(off > 800 && far > 300, "{off} {far}");
}

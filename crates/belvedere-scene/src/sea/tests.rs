use super::*;

/// A ground of `side` squared nodes 30 m apart.
fn ground(side: usize, height: impl Fn(usize, usize) -> f32) -> Heightfield {
    let heights = (0..side * side).map(|i| height(i % side, i / side)).collect();
    Heightfield::measured(DVec2::new(0.0, 3000.0), DVec2::splat(30.0), side, side, heights).unwrap()
}

fn with_voids(side: usize, height: impl Fn(usize, usize) -> f32) -> Heightfield {
    let heights: Vec<f32> = (0..side * side).map(|i| height(i % side, i / side)).collect();
    let state = |h: &f32| if h.is_nan() { NodeState::Void } else { NodeState::Measured };
    let states = heights.iter().map(state).collect();
    Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), side, side, heights, states).unwrap()
}

/// Land that rises from column `shore` on, `step` m a node.
fn coast(shore: usize, step: f32) -> impl Fn(usize, usize) -> f32 {
    move |c, r| if c < shore { 0.0 } else { step * (c - shore + 1) as f32 + 0.1 * (r % 3) as f32 }
}

/// Whether a place lies in the sea.
fn contains(sea: &Sea, p: DVec2) -> bool {
    let crossed = sea.coasts.iter().flat_map(|r| r.iter().zip(r.iter().cycle().skip(1)));
    let crossed =
        crossed.filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x));
    crossed.count() % 2 == 1
}

#[test]
fn level_ground_at_0_that_reaches_the_edge_is_sea_with_its_islands() {
    let island = |c: usize, r: usize| c.abs_diff(25) + r.abs_diff(50) < 6;
    let hf = ground(101, |c, r| if island(c, r) { 7.0 } else { coast(60, 4.0)(c, r) });
    let sea = Sea::of(&hf).expect("sea");
    assert_eq!(sea.level_m, 0.0);
    for i in 0..101 * 101 {
        let p = hf.node(i % 101, i / 101).unwrap();
        assert_eq!(contains(&sea, p.truncate()), p.z == 0.0, "node {i} at {p}");
    }
    assert_eq!(sea.area_m2, hf.heights().iter().filter(|h| **h == 0.0).count() as f64 * 900.0);
}

#[test]
fn what_is_not_constant_or_small_or_inland_or_framed_is_land() {
    let wide = coast(60, 4.0);
    // A polder: below 0, and its heights differ.
    let polder = ground(101, |c, r| wide(c, r) - 4.0 - 0.1 * ((c * 7 + r * 3) % 5) as f32);
    // A lake at 0 behind a dike.
    let lake = ground(101, |c, r| if c == 0 || r == 0 || r == 100 { 3.0 } else { wide(c, r) });
    let small = ground(101, coast(4, 4.0));
    // A frame of undeclared voids around land 150 m high.
    let frame = ground(101, |c, r| if c.min(r).min(100 - c).min(100 - r) < 20 { 0.0 } else { 150.0 + c as f32 });
    let inland = ground(101, |c, r| 400.0 + wide(c, r));
    let level = ground(101, |_, _| 0.0);
    // Noise of whole metres around 0.
    let flats = ground(101, |c, r| ((c * 7919 + r * 104_729) % 3) as f32 - 1.0);
    for (what, hf) in [
        ("polder", polder),
        ("lake", lake),
        ("small", small),
        ("frame", frame),
        ("inland", inland),
        ("level", level),
        ("flats", flats),
    ] {
        assert_eq!(Sea::of(&hf), None, "{what}");
    }
}

#[test]
fn a_level_sea_below_0_is_the_lowest_of_the_ground() {
    let caspian = ground(101, |c, r| coast(60, 4.0)(c, r) - 28.0);
    assert_eq!(Sea::of(&caspian).map(|s| s.level_m), Some(-28.0));
    // A plain at -4 m beside a deeper hollow is land.
    let hollow = ground(101, |c, r| if c == 90 { -9.0 - r as f32 } else { coast(60, 4.0)(c, r) - 4.0 });
    assert_eq!(Sea::of(&hollow), None);
}

#[test]
fn voids_outside_the_data_are_an_edge_and_voids_inside_it_are_none() {
    let shore = coast(60, 4.0);
    let rim = with_voids(101, |c, r| if c < 9 || r < 9 { f32::NAN } else { shore(c, r) });
    let sea = Sea::of(&rim).expect("sea beside the rim");
    assert!(contains(&sea, rim.node_xy(30, 50)) && !contains(&sea, rim.node_xy(80, 50)));
    let lake = with_voids(101, |c, r| {
        let dike = c == 0 || r == 0 || r == 100;
        if (20..25).contains(&c) && r == 50 {
            f32::NAN
        } else if dike {
            3.0
        } else {
            shore(c, r)
        }
    });
    assert_eq!(Sea::of(&lake), None);
}

#[test]
fn a_frame_that_a_new_lattice_has_blended_with_the_land_is_no_sea_and_a_steep_coast_is_one() {
    // The first node of the land is anything between 0 and its height.
    let blended = |c: usize, r: usize| match c {
        0..40 => 0.0,
        40 => 250.0 * ((r * 37 % 100) as f32 / 100.0),
        _ => 250.0 + (c % 7) as f32,
    };
    assert_eq!(Sea::of(&ground(101, blended)), None);
    let fjord = |c: usize, r: usize| coast(40, 9.0)(c, r);
    assert!(Sea::of(&ground(101, fjord)).is_some());
}

use super::*;
use belvedere_core::DVec2;
use belvedere_scene::{Heightfield, NodeState};

fn ground(height: impl Fn(usize, usize) -> f32) -> Heightfield {
    let heights = (0..30 * 24).map(|i| height(i % 30, i / 30)).collect();
    let states = vec![NodeState::Measured; 30 * 24];
    Heightfield::new(DVec2::ZERO, DVec2::new(10.0, 20.0), 30, 24, heights, states).unwrap()
}

fn field(height: impl Fn(usize, usize) -> f32) -> Field {
    Field::new(&ground(height), |_| 0.0).unwrap()
}

fn rough(x: usize, y: usize) -> f32 {
    (((x * 7919 + y * 104_729) % 1013) as f32).mul_add(0.02, (x as f32 * 0.4).sin() * 30.0)
}

#[test]
fn what_is_filled_up_is_the_least_ground_that_keeps_the_limits() {
    let field = field(rough);
    let limits = Limits::of(&field);
    let dug: Vec<f64> = (0..field.heights().len()).map(|i| -(((i * 31) % 97) as f64) * 3.0).collect();
    let mut u = dug.clone();
    let told = limits.keep(&field, &Waters::default(), &mut u).expect("deep pits");
    assert!(told.held_share > 0.1 && told.held_most_m > 10.0, "{told:?}");
    let h = field.heights();
    for i in 0..h.len() {
        assert!(u[i] >= dug[i] && u[i] <= 1e-9, "between what was dug and the terrain");
        assert!(h[i] + u[i] >= limits.floor - 1e-9);
        let mut stands_on_a_limit = u[i] == dug[i] || (h[i] + u[i] - limits.floor).abs() < 1e-9;
        for (j, d) in Ways::over(&field).from(i) {
            let allowed = (limits.slope * d).max((h[i] - h[j]).abs());
            let fall = h[j] + u[j] - h[i] - u[i];
            assert!(fall <= allowed + 1e-5, "{i} {j}: {fall} of {allowed}");
            stands_on_a_limit |= fall > allowed - 1e-5;
        }
        assert!(stands_on_a_limit, "node {i} could lie lower");
    }
    let again = u.clone();
    assert!(
        limits.keep(&field, &Waters::default(), &mut u).is_none_or(|r| r.held_most_m < 1e-4)
            && u.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-4)
    );
}

#[test]
fn a_displacement_that_is_surely_within_the_limits_is_within_them() {
    let field = field(rough);
    let grid = Hierarchy::whole(30, 24, 8);
    let limited = LimitedTerrain::new(&ground(rough), &field, &grid);
    let (mut sure, mut held) = (0, 0);
    for k in 0..200u32 {
        let depth = 0.4 * f64::from(k);
        let u: Vec<f64> = (0..grid.nodes()).map(|i| -depth * (((i * 37) % 11) as f64) / 11.0).collect();
        let mut fine = grid.prolong(&u);
        let report = limited.keep(&field, &Waters::default(), &mut fine);
        if limited.surely_kept(&grid, &u) {
            sure += 1;
            assert!(report.is_none(), "depth {depth}");
        }
        held += usize::from(report.is_some());
    }
    assert!(sure > 3 && held > 3, "{sure} {held}");
}

/// An island in a sea.
fn island(x: usize, y: usize) -> f32 {
    (90.0 - 9.0 * (x as f32 - 14.0).hypot(y as f32 - 11.0)).max(0.0)
}

#[test]
fn the_sea_stays_and_land_does_not_sink_below_it() {
    let (hf, field, grid) = (ground(island), field(island), Hierarchy::whole(30, 24, 8));
    let limited = LimitedTerrain::new(&hf, &field, &grid);
    let (level, sea) = Sea::nodes(&hf).expect("a sea");
    let (mut kept, mut held) = (0, 0);
    for k in 0..200u32 {
        // Every second one moves the middle of the island alone.
        let middle = |i: usize| i % grid.cols() == 3 && i / grid.cols() == 3;
        let uneven = |i: usize| ((i * 37) % 11) as f64 / 11.0;
        let share = |i: usize| if k % 2 == 0 { uneven(i) } else { f64::from(u8::from(middle(i))) };
        let of = |i: usize| -0.3 * f64::from(k) * share(i);
        let u: Vec<f64> = (0..grid.nodes()).map(of).collect();
        let mut fine = grid.prolong(&u);
        let surely = limited.surely_kept(&grid, &u);
        let changed = limited.keep(&field, &Waters::default(), &mut fine).is_some();
        assert!(!(surely && changed), "{k}");
        for (i, u) in fine.iter().enumerate() {
            let after = field.heights()[i] + u;
            assert!(if sea[i] { *u == 0.0 } else { after >= level }, "node {i}: {u}, {after}");
        }
        (kept, held) = (kept + u32::from(surely), held + u32::from(changed));
    }
    assert!(kept > 3 && held > 50, "{kept} {held}");
}

//! Least-cost routes.

use belvedere_builtin::{RouteCost, RouteError, least_cost_route, valley_route};
use belvedere_core::DVec2;
use belvedere_scene::{Heightfield, NodeState};

fn field(n: usize, height: impl Fn(usize, usize) -> f32, void: impl Fn(usize, usize) -> bool) -> Heightfield {
    let node = |i: usize| (i % n, i / n);
    let heights = (0..n * n).map(|i| height(node(i).0, node(i).1)).collect();
    let states =
        (0..n * n).map(|i| if void(node(i).0, node(i).1) { NodeState::Void } else { NodeState::Measured }).collect();
    Heightfield::new(DVec2::new(0.0, 10.0 * (n - 1) as f64), DVec2::splat(10.0), n, n, heights, states).unwrap()
}

#[test]
fn a_route_on_flat_ground_is_straight() {
    let hf = field(21, |_, _| 5.0, |_, _| false);
    let route = least_cost_route(&hf, DVec2::new(0.0, 100.0), DVec2::new(200.0, 100.0), &RouteCost::default()).unwrap();
    let length: f64 = route.windows(2).map(|w| w[0].distance(w[1])).sum();
    assert!((length - 200.0).abs() < 1e-9, "{length}");
}

#[test]
fn a_route_takes_the_gap_in_a_wall_and_avoids_voids() {
    let wall = |c: usize, r: usize| if c == 10 && r != 3 { 400.0 } else { (c % 3) as f32 };
    let hf = field(21, wall, |_, _| false);
    let (from, to) = (DVec2::new(0.0, 20.0), DVec2::new(200.0, 20.0));
    let route = least_cost_route(&hf, from, to, &RouteCost::default()).unwrap();
    let gap = hf.node_xy(10, 3);
    assert!(route.iter().any(|p| p.distance(gap) < 8.0), "{route:?}");
    let hf = field(21, |_, _| 1.0, |c, r| c == 10 && r.abs_diff(4) > 1);
    let route = least_cost_route(&hf, from, to, &RouteCost::default()).unwrap();
    assert_eq!(
        belvedere_scene::drape_polyline(&hf, &route).parts.len(),
        1,
        "the drawn surface is whole along the route"
    );
    let hf = field(21, |_, _| 1.0, |c, _| c == 10);
    assert_eq!(least_cost_route(&hf, from, to, &RouteCost::default()), Err(RouteError::NoWay));
}

#[test]
fn bad_ends_and_weights_are_errors() {
    let hf = field(21, |c, r| (c + r) as f32, |c, _| c < 5);
    let inside = DVec2::new(100.0, 100.0);
    let cost = RouteCost::default();
    for bad in [DVec2::new(-50.0, 0.0), DVec2::new(10.0, 100.0), DVec2::NAN, DVec2::INFINITY] {
        let e = least_cost_route(&hf, bad, inside, &cost).unwrap_err();
        assert!(matches!(e, RouteError::NoGround { end: "start", .. }), "{bad}: {e}");
        assert!(least_cost_route(&hf, inside, bad, &cost).is_err());
    }
    let negative = RouteCost { slope_weight: -1.0, ..cost };
    assert!(matches!(least_cost_route(&hf, inside, inside, &negative), Err(RouteError::Weights { .. })));
}

#[test]
fn valley_routes_keep_low_and_repeat() {
    // two crests from north to south with one pass each
    let hilly = |c: usize, r: usize| {
        let crest = |at: i64, pass: i64| {
            let away = (c as i64 - at).abs() as f32;
            (300.0 - 20.0 * away).max(0.0) * ((r as i64 - pass).abs() as f32 / 60.0).min(1.0)
        };
        crest(40, 30) + crest(80, 90) + ((c * 3 + r * 5) % 4) as f32
    };
    let hf = field(121, hilly, |_, _| false);
    for seed in 0..6 {
        let route = valley_route(&hf, seed).unwrap();
        assert_eq!(route, valley_route(&hf, seed).unwrap());
        let highest = route.iter().map(|p| hf.height_at(*p).unwrap()).fold(0.0, f64::max);
        assert!(highest < 120.0, "seed {seed} climbs to {highest} m");
        assert!(route.len() > 60);
    }
    let hf = field(40, |_, _| 1.0, |c, r| (c + r) % 2 == 0);
    let text = valley_route(&hf, 1).unwrap_err().to_string();
    assert!(text.contains("40 x 40 nodes with 50 % voids"), "{text}");
}

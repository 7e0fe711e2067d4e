//! Lengths of routes on moved ground.

use super::{KeptLine, RouteReport};
use belvedere_core::DVec3;
use belvedere_core::map::ground_moves::MoveNet;

/// Routes that change by less than this share are not reported.
const UNMOVED: f64 = 1e-9;

fn length(points: impl IntoIterator<Item = DVec3>) -> f64 {
    let mut points = points.into_iter();
    let Some(mut last) = points.next() else { return 0.0 };
    points.map(|p| std::mem::replace(&mut last, p).distance(p)).sum()
}

fn both(net: &MoveNet, route: &KeptLine) -> [f64; 2] {
    let moved = route.points.iter().map(|p| *p + net.at(p.truncate()));
    [length(route.points.iter().copied()), length(moved)]
}

/// Largest change of a route's length, as a share of it.
pub(super) fn largest_change(net: &MoveNet, routes: &[KeptLine]) -> f64 {
    let change = |[before, after]: [f64; 2]| if before > 0.0 { (after / before - 1.0).abs() } else { 0.0 };
    routes.iter().map(|route| change(both(net, route))).fold(0.0, f64::max)
}

/// The routes that move, with their lengths.
pub(super) fn lengths(net: &MoveNet, routes: &[KeptLine]) -> Vec<RouteReport> {
    let one = |route: &KeptLine| {
        let [length_m, moved_length_m] = both(net, route);
        RouteReport { name: route.name.clone(), length_m, moved_length_m }
    };
    let moves = |r: &RouteReport| (r.moved_length_m - r.length_m).abs() > UNMOVED * r.length_m;
    routes.iter().map(one).filter(moves).collect()
}

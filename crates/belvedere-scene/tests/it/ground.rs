//! Ground: heights between nodes.

use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{CellTriangle, Color, Heightfield, LineFeature, LineLayer, NodeState, Sea};

fn height(col: usize, row: usize) -> f32 {
    (7 * col * col + 13 * row + 5 * (col * row) % 11) as f32
}

fn ground(cols: usize, rows: usize) -> Heightfield {
    let heights = (0..cols * rows).map(|i| height(i % cols, i / cols)).collect();
    Heightfield::measured(DVec2::new(100.0, 500.0), DVec2::new(10.0, 20.0), cols, rows, heights).expect("ground")
}

/// In every cell, the last ones too, heights mix those of its four corners.
#[test]
fn heights_between_nodes_are_bilinear_up_to_the_border() {
    let (cols, rows) = (5, 4);
    let ground = ground(cols, rows);
    for row in 0..rows - 1 {
        for col in 0..cols - 1 {
            for (u, v) in [(0.25, 0.5), (0.875, 0.125), (0.5, 1.0), (1.0, 0.75), (1.0, 1.0)] {
                let corner = |c: usize, r: usize| f64::from(height(col + c, row + r));
                let north = corner(0, 0) * (1.0 - u) + corner(1, 0) * u;
                let south = corner(0, 1) * (1.0 - u) + corner(1, 1) * u;
                let at = DVec2::new(100.0 + 10.0 * (col as f64 + u), 500.0 - 20.0 * (row as f64 + v));
                let found = ground.height_at(at).expect("inside");
                assert!((found - (north * (1.0 - v) + south * v)).abs() < 1e-9, "{col} {row} {u} {v}: {found}");
            }
        }
    }
    assert_eq!(ground.height_at(DVec2::new(140.1, 490.0)), None);
}

/// Differences of its own height.
#[test]
fn the_slope_of_a_triangle_is_how_its_height_changes() {
    let corners = [3.0, 8.0, 4.5, 17.0];
    for triangle in [CellTriangle::NorthEast, CellTriangle::SouthWest] {
        let at = |u: f64, v: f64| triangle.height(corners, DVec2::new(u, v));
        let want = DVec2::new(at(0.75, 0.5) - at(-0.25, 0.5), at(0.5, 0.75) - at(0.5, -0.25));
        assert!((triangle.slope(corners) - want).length() < 1e-12, "{triangle:?}");
    }
}

/// Three pieces of one way, each given forwards and backwards, in every order: the same way, or the same reversed.
#[test]
fn pieces_of_a_route_join_at_their_near_ends() {
    let point = |x: f64| DVec3::new(x, 0.1 * x * x, 0.0);
    let pieces = [[0.0, 1.0, 2.0].as_slice(), &[2.2, 3.0, 4.0, 5.0, 6.0], &[6.3, 7.0, 8.0]];
    let whole: Vec<DVec3> = pieces.concat().into_iter().map(point).collect();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for turned in 0..8 {
            let features = order.map(|k| {
                let mut points: Vec<DVec3> = pieces[k].iter().copied().map(point).collect();
                if turned >> k & 1 == 1 {
                    points.reverse();
                }
                LineFeature { name: String::new(), style: None, points }
            });
            let mut chain = LineLayer::new(features.to_vec(), Color::rgb(0, 0, 0)).longest_chain(1.5);
            if chain[0].x > chain[1].x {
                chain.reverse();
            }
            assert_eq!(chain, whole, "{order:?} {turned}");
        }
    }
}

/// 60 columns of sea west of land that is level; the westernmost `voids` columns hold no data. Nodes are 30 m apart, the first stands at 0.
fn shore(land: f32, voids: usize) -> Sea {
    let side = 101;
    let heights = (0..side * side).map(|i| if i % side < 60 { 0.0 } else { land }).collect();
    let state = |i: usize| if i % side < voids { NodeState::Void } else { NodeState::Measured };
    let states = (0..side * side).map(state).collect();
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), side, side, heights, states).expect("ground");
    Sea::of(&hf).expect("sea")
}

/// The western and the eastern end of a sea where a coast crosses the middle row.
fn ends(sea: &Sea) -> [f64; 2] {
    let places = sea.coasts.iter().flatten().filter(|p| (p.y + 1500.0).abs() < 300.0);
    places.fold([f64::INFINITY, f64::NEG_INFINITY], |[west, east], p| [west.min(p.x), east.max(p.x)])
}

/// A coast lies where the ground between two nodes rises half a metre over the sea: an eighth of the way to land 4 m high.
#[test]
fn coasts_lie_half_a_metre_over_the_sea() {
    for (land, share) in [(1.0, 0.5), (2.0, 0.25), (3.125, 0.16), (4.0, 0.125), (20.0, 0.12)] {
        let [_, east] = ends(&shore(land, 0));
        assert!((east - 30.0 * (59.0 + share)).abs() < 1e-6, "land at {land} m: {east}");
    }
}

/// Outside the ground, and in voids, the sea goes on for two nodes and a half.
#[test]
fn the_sea_goes_on_two_nodes_and_a_half_beyond_the_data() {
    for voids in [0, 9] {
        let [west, _] = ends(&shore(4.0, voids));
        assert!((west - 30.0 * (voids as f64 - 2.5)).abs() < 1e-6, "{voids} columns of voids: {west}");
    }
}

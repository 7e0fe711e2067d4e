//! Compares coarse ground under a bend with the same ground divided finely beforehand.

use crate::support::{Random, hills, layer, options, pinhole, render, scene, terrain};
use crate::support_views::{small_planet, spline, views};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Frame, Heightfield, LayerKind, NodeState, RenderOptions, Scene};

fn ground(hf: Heightfield) -> Scene {
    scene(vec![layer("ground", LayerKind::Terrain(terrain(hf)))])
}

/// The same drawn surface with `k` times the nodes along each side.
fn refined(hf: &Heightfield, k: usize) -> Heightfield {
    let (cols, rows) = ((hf.cols() - 1) * k + 1, (hf.rows() - 1) * k + 1);
    let spacing = hf.spacing() / k as f64;
    let heights = (0..cols * rows).map(|i| {
        let at = hf.north_west() + DVec2::new((i % cols) as f64 * spacing.x, -((i / cols) as f64) * spacing.y);
        let last = hf.node_xy(hf.cols() - 1, hf.rows() - 1);
        let at = DVec2::new(at.x.min(last.x), at.y.max(last.y));
        hf.surface_at(at).expect("inside the grid") as f32
    });
    let states = vec![NodeState::Measured; cols * rows];
    Heightfield::new(hf.north_west(), spacing, cols, rows, heights.collect(), states).expect("well formed")
}

/// Largest distance in pixels, over columns, between the skylines of two frames (first row with ground).
fn skyline_off(a: &Frame, b: &Frame) -> usize {
    let first = |f: &Frame, x: usize| (0..f.height).find(|y| f.id[y * f.width + x] != 0).unwrap_or(f.height);
    (0..a.width).map(|x| first(a, x).abs_diff(first(b, x))).max().unwrap_or(0)
}

#[test]
fn a_coarse_grid_bends_like_a_fine_one() {
    let coarse = hills(5, 280.0, 60.0, 11);
    let fine = ground(refined(&coarse, 48));
    let coarse = ground(coarse);
    for (name, view) in views([320, 240]).into_iter().skip(1) {
        let reference = render(&fine, &view, &options(1));
        let frame = render(&coarse, &view, &options(1));
        assert!(frame.stats.edges_split > 20, "{name}: {} edges split", frame.stats.edges_split);
        let off = skyline_off(&frame, &reference);
        assert!(off <= 1, "{name}: the skyline is {off} px off");
        // The world position seen by a pixel must be projected to that pixel within the tolerance.
        let with_world = RenderOptions { aux: belvedere_scene::Aux { world: true, exact: false }, ..options(1) };
        let frame = render(&coarse, &view, &with_world);
        let mut worst = 0.0f64;
        for (i, p) in frame.world.as_ref().expect("asked for").iter().enumerate().filter(|(i, _)| frame.id[*i] != 0) {
            let seen = view.project(DVec3::from_array(*p)).expect("it was seen").pixel;
            let centre = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
            worst = worst.max(seen.distance(centre));
        }
        assert!(worst <= 0.51, "{name}: what a pixel sees lies {worst:.2} px away from it");
    }
}

#[test]
fn without_subdivision_the_coarse_grid_would_be_wrong() {
    // Shows that the test above can fail: with an enormous tolerance the same grid is wrong by several pixels.
    let coarse = hills(5, 280.0, 60.0, 11);
    let fine = ground(refined(&coarse, 48));
    let coarse = ground(coarse);
    let (_, view) = views([320, 240]).remove(2);
    let loose = RenderOptions { tolerance_px: 1e6, ..options(1) };
    let off = skyline_off(&render(&coarse, &view, &loose), &render(&fine, &view, &options(1)));
    assert!(off > 2, "the skyline is only {off} px off");
}

#[test]
fn straight_views_and_fine_grids_split_nothing() {
    let fine = ground(hills(513, 2.2, 60.0, 2));
    for (name, view) in views([320, 240]).into_iter().take(2) {
        let frame = render(&fine, &view, &options(1));
        assert_eq!(frame.stats.edges_split, 0, "{name}");
    }
}

/// A closed sheet has no sky inside its outline, however its edges were split.
#[test]
fn split_ground_has_no_cracks() {
    let mut random = Random::new(5);
    for round in 0..24 {
        let hf = hills(if round % 3 == 0 { 70 } else { 9 }, if round % 3 == 0 { 18.0 } else { 150.0 }, 90.0, round);
        let eye = DVec3::new(random.range(-80.0, 80.0), random.range(-560.0, -300.0), random.range(260.0, 500.0));
        let target = DVec3::new(random.range(-60.0, 60.0), random.range(-40.0, 80.0), 0.0);
        let camera = pinhole(eye, target, random.range(35.0, 60.0), [400, 300]);
        let view = match round % 3 {
            0 => small_planet(camera),
            1 => spline(camera, "progressive"),
            _ => spline(camera, "degressive"),
        };
        let frame = render(&ground(hf), &view, &options(1));
        assert!(frame.id.contains(&1));
        assert_eq!(cracks(&frame), 0, "round {round}");
    }
}

#[test]
fn straight_ground_has_no_cracks() {
    let mut random = Random::new(9);
    for round in 0..24 {
        let eye = DVec3::new(random.range(-80.0, 80.0), random.range(-560.0, -100.0), random.range(200.0, 600.0));
        let target = DVec3::new(random.range(-60.0, 60.0), random.range(0.0, 80.0), 0.0);
        let view = View::straight(pinhole(eye, target, random.range(20.0, 100.0), [400, 300]));
        let frame = render(&ground(hills(90, 14.0, 120.0, round)), &view, &options(1));
        assert_eq!(cracks(&frame), 0, "round {round}");
    }
}

/// Sky pixels with ground on all four sides within three pixels.
pub(crate) fn cracks(frame: &Frame) -> usize {
    let (w, h) = (frame.width, frame.height);
    let ground = |x: usize, y: usize| frame.id[y * w + x] != 0;
    let mut n = 0;
    for y in 3..h - 3 {
        for x in 3..w - 3 {
            let near = |f: &dyn Fn(usize) -> bool| (1..=3).any(f);
            n += usize::from(
                !ground(x, y)
                    && near(&|k| ground(x - k, y))
                    && near(&|k| ground(x + k, y))
                    && near(&|k| ground(x, y - k))
                    && near(&|k| ground(x, y + k)),
            );
        }
    }
    n
}

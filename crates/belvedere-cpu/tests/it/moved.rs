//! Light on ground that moves from frame to frame is that of ground never seen before.

use crate::support::{hills, layer, pinhole, render, scene, terrain};
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, DVec3, Stage, TerrainDisocclusion, View};
use belvedere_scene::{LayerKind, RenderOptions};

/// The ground gives way around `at`, at one end of the ground.
fn hollow(at: DVec2, depth: f64) -> Stage {
    let corner = DVec2::new(-3500.0, 3500.0);
    let value = |i: usize| {
        let p = corner + DVec2::new((i % 101) as f64, -((i / 101) as f64)) * 70.0;
        let near = 1.0 - (p.distance(at) / 900.0).powi(2);
        if near > 0.0 { -depth * near * near } else { 0.0 }
    };
    let grid = Grid::new(corner, DVec2::splat(70.0), 101, 101, (0..101 * 101).map(value).collect());
    Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid.expect("well formed")))
}

#[test]
fn light_kept_from_frame_to_frame_is_light_made_anew() {
    let ground = || scene(vec![layer("ground", LayerKind::Terrain(terrain(hills(701, 10.0, 900.0, 3))))]);
    let kept = ground();
    let camera = pinhole(DVec3::new(0.0, -3000.0, 2200.0), DVec3::new(0.0, 300.0, 0.0), 60.0, [160, 90]);
    let options = RenderOptions { samples: 4, lod_px: 0.5, ..RenderOptions::default() };
    let straight = render(&kept, &View::straight(camera.clone()), &options);
    let mut before = None;
    for (x, depth) in
        [(-2000.0, 300.0), (-1990.0, 300.0), (-1990.0, 310.0), (-1990.0, 310.0), (1500.0, 120.0), (0.0, 0.0)]
    {
        let view = View::new(camera.clone(), vec![hollow(DVec2::new(x, 300.0), depth)]).expect("one stage");
        let (again, anew) = (render(&kept, &view, &options), render(&ground(), &view, &options));
        assert!(again.color == anew.color, "the hollow at {x}, {depth} m deep");
        assert!(before.as_ref() != Some(&again.color) || (x, depth) == (-1990.0, 310.0), "it moved");
        assert_eq!(again.color == straight.color, depth == 0.0, "it is seen");
        before = Some(again.color);
    }
}

use super::*;
use crate::shade::ground::patch::LightingInputs;
use crate::shade::ground::tiles::CELL;
use crate::shade::relief::ReliefLight;
use belvedere_composite::tint::GroundTint;
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, SpaceMap};
use belvedere_scene::{Light, PaletteName, Relief};

fn hills(cols: usize, rows: usize) -> Heightfield {
    let h = |i: usize| 900.0 + 300.0 * ((i % cols) as f32 * 0.07).sin() * ((i / cols) as f32 * 0.05).cos();
    Heightfield::measured(DVec2::new(-7.0, 90.0), DVec2::new(10.0, 20.0), cols, rows, (0..cols * rows).map(h).collect())
        .unwrap()
}

#[test]
fn rows_are_lifted_like_their_points() {
    let hf = hills(130, 77);
    for (corner, spacing) in
        [(DVec2::new(-7.0, 90.0), DVec2::new(10.0, 20.0)), (DVec2::new(103.3, -250.0), DVec2::new(37.0, 41.0))]
    {
        let values = (0..20 * 16).map(|i| 30.0 * f64::from(i * 7 % 11).sin()).collect();
        let stage = TerrainDisocclusion::new(Grid::new(corner, spacing, 20, 16, values).unwrap());
        let (got, mut moved) = (heights(&hf, &[Stage::TerrainDisocclusion(stage.clone())]), 0);
        for (i, got) in got.into_iter().enumerate() {
            let p = hf.node(i % 130, i / 130).unwrap();
            let want = stage.apply(p).unwrap().z;
            assert!((f64::from(got) - want).abs() < 0.51 * 10.0 * STEP + 1e-4, "node {i}: {got} {want}");
            moved += u32::from((want - p.z).abs() > 1.0);
        }
        assert!(moved > 100, "{moved}");
    }
}

#[test]
fn only_tiles_around_what_moved_on_are_made_again() {
    let (hf, cache) = (Arc::new(hills(1100, 1100)), GroundCache::default());
    let key = LitKey {
        relief: Relief::Swiss,
        light: Light::default(),
        palette: PaletteName::Alpine.into(),
        exaggeration: 1.0,
    };
    let tint = GroundTint::new(&key.palette, hf.z_range());
    let relief = ReliefLight::new(key.relief, &key.light);
    let frame = |depth: f32| {
        let mut heights = hf.heights().to_vec();
        heights[700 * 1100 + 800] -= depth;
        let surface = Surface::lifted(&hf, Arc::new(heights));
        let DisplacedLight { means, lit, .. } =
            light(&cache, &hf, &surface, surface.moved().unwrap(), (key.clone(), 0), &|_| None);
        let before = lit.bytes();
        let inputs = LightingInputs {
            surface: &surface,
            means: &means,
            map: None,
            broad: None,
            shadows: None,
            tint: &tint,
            light: &relief,
            exaggeration: 1.0,
        };
        for i in 0..289 {
            lit.color([i % 17 * 64 * CELL, i / 17 * 64 * CELL], 0, &inputs);
        }
        [before, lit.bytes()]
    };
    let [nothing, all] = frame(3.0);
    assert!(nothing == 0 && frame(3.0) == [all, all], "nothing moved on");
    let [kept, again] = frame(4.0);
    // Those over and beside 64 + 2 (256 + 8) nodes, of 1100.
    assert!(again == all && kept < all && kept > all * 6 / 10, "{kept} of {all}");
}

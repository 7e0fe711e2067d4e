//! The data that a renderer keeps between pictures change no picture.

use crate::support::{hills, layer, pinhole, scene, terrain};
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, DVec3, Pinhole, Stage, TerrainDisocclusion, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    Drape, Frame, Heightfield, LayerKind, Light, PaletteName, Progress, Relief, RenderJob, RenderOptions, Renderer,
    Scene, Shading, TerrainLayer,
};
use std::sync::Arc;

fn render_by(renderer: &CpuRenderer, scene: &Scene, view: &View, light: &Light) -> Frame {
    let options = RenderOptions { samples: 4, lod_px: 0.5, ..RenderOptions::default() };
    renderer
        .render(&RenderJob { scene, view, light, options: &options, progress: &Progress::silent() })
        .expect("picture is possible")
}

fn camera() -> Pinhole {
    pinhole(DVec3::new(0.0, -3000.0, 2200.0), DVec3::new(0.0, 300.0, 0.0), 60.0, [160, 90])
}

/// Disocclusion around `at`, at one end of the ground.
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
    let (kept, renderer, light, camera) = (ground(), CpuRenderer::default(), Light::default(), camera());
    let straight = render_by(&renderer, &kept, &View::straight(camera.clone()), &light);
    let mut before = None;
    for (x, depth) in
        [(-2000.0, 300.0), (-1990.0, 300.0), (-1990.0, 310.0), (-1990.0, 310.0), (1500.0, 120.0), (0.0, 0.0)]
    {
        let view = View::new(camera.clone(), vec![hollow(DVec2::new(x, 300.0), depth)]).expect("one stage");
        let again = render_by(&renderer, &kept, &view, &light);
        let anew = render_by(&CpuRenderer::default(), &ground(), &view, &light);
        assert!(again.color == anew.color, "the hollow at {x}, {depth} m deep");
        assert!(before.as_ref() != Some(&again.color) || (x, depth) == (-1990.0, 310.0), "it moved");
        assert_eq!(again.color == straight.color, depth == 0.0, "it is seen");
        before = Some(again.color);
    }
}

#[test]
fn a_renderer_tells_apart_everything_that_its_pictures_depend_on() {
    let ground = hills(301, 20.0, 900.0, 3);
    let placed = |corner: DVec2, spacing: f64| {
        Heightfield::measured(corner, DVec2::splat(spacing), 301, 301, ground.heights().to_vec()).expect("well formed")
    };
    let base = TerrainLayer { relief: Relief::Sun, palette: PaletteName::Alpine.into(), ..terrain(ground.clone()) };
    let corner = ground.north_west();
    let [drape, moved_drape] = [0.0, 0.4].map(|by| Drape {
        pixels: (0..64).map(|i| [(i * 4) as u8, 90, 30, 255]).collect(),
        width: 8,
        height: 8,
        pixel_from_scene: [8.0 / 6000.0, 0.0, 4.0 + by, 0.0, -8.0 / 6000.0, 4.0],
    });
    let sun = Light { shadows: true, altitude: 0.5, ..Light::default() };
    let cases: [(&str, TerrainLayer, Light); 15] = [
        ("base", base.clone(), sun),
        ("spacing", TerrainLayer { heightfield: Arc::new(placed(corner, 17.0)), ..base.clone() }, sun),
        ("corner", TerrainLayer { heightfield: Arc::new(placed(corner + 130.0, 20.0)), ..base.clone() }, sun),
        ("heights", TerrainLayer { heightfield: Arc::new(hills(301, 20.0, 900.0, 4)), ..base.clone() }, sun),
        ("size", TerrainLayer { heightfield: Arc::new(hills(257, 20.0, 900.0, 3)), ..base.clone() }, sun),
        ("azimuth", base.clone(), Light { azimuth: 2.0, ..sun }),
        ("altitude", base.clone(), Light { altitude: 0.9, ..sun }),
        ("shadows", base.clone(), Light { shadows: false, ..sun }),
        ("relief", TerrainLayer { relief: Relief::Swiss, ..base.clone() }, sun),
        ("palette", TerrainLayer { palette: PaletteName::Desert.into(), ..base.clone() }, sun),
        ("exaggeration", TerrainLayer { exaggeration: 2.0, ..base.clone() }, sun),
        ("shading", TerrainLayer { shading: Some(Shading::Map), ..base.clone() }, sun),
        ("drape", TerrainLayer { drapes: vec![drape], ..base.clone() }, sun),
        ("placement of the drape", TerrainLayer { drapes: vec![moved_drape], ..base.clone() }, sun),
        ("base again", base, sun),
    ];
    let bent = View::new(camera(), vec![hollow(DVec2::new(-400.0, 300.0), 300.0)]).expect("one stage");
    for view in [View::straight(camera()), bent] {
        let (renderer, mut pictures) = (CpuRenderer::default(), Vec::<(&str, Vec<[u8; 3]>)>::new());
        // Each picture after all others, which are drawn before and after it in turn.
        for &(name, ref terrain, ref light) in cases.iter().chain(cases.iter().rev()) {
            let scene = scene(vec![layer("ground", LayerKind::Terrain(terrain.clone()))]);
            let fresh = render_by(&CpuRenderer::default(), &scene, &view, light).color;
            assert!(render_by(&renderer, &scene, &view, light).color == fresh, "{name}");
            let same = |other: &&(&str, Vec<[u8; 3]>)| other.1 == fresh;
            let others: Vec<&str> = pictures.iter().filter(same).map(|p| p.0).collect();
            // Without displaced ground, both kinds of shading are that of the map.
            let expected = |other: &str| {
                let plain = |n: &str| n.starts_with("base") || n == "shading" && !view.is_bent();
                other == name || plain(other) && plain(name)
            };
            assert!(others.iter().all(|other| expected(other)), "{name} looks like {others:?}");
            pictures.push((name, fresh));
        }
    }
}

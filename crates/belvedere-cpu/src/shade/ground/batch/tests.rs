use super::*;
use crate::cache::GroundCache;
use crate::geometry::blocks::Blocks;
use crate::geometry::drawn_solids::DrawnSolids;
use crate::geometry::pass::Pass;
use crate::raster::band::{Band, SKY, sample_offsets};
use crate::screen::Screen;
use crate::shade::LightCache;
use belvedere_core::{DVec3, Pinhole, Projection, View};
use belvedere_scene::{
    Heightfield, Layer, Light, PaletteName, Progress, Relief, RenderJob, RenderOptions, Scene, TerrainLayer,
};
use belvedere_sight::Solids;

fn hills() -> Scene {
    let h = |c: usize, r: usize| 40.0 * ((c as f32 * 0.06).sin() + (r as f32 * 0.045).cos()) + 0.1 * (c * r % 5) as f32;
    let heights = (0..257 * 257).map(|i| h(i % 257, i / 257)).collect();
    let corner = DVec2::new(-1280.0, 1280.0);
    let terrain = TerrainLayer {
        heightfield: Heightfield::measured(corner, DVec2::splat(10.0), 257, 257, heights).unwrap().into(),
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: PaletteName::Alpine.into(),
        contours: None,
        edge: belvedere_scene::Edge::Plain,
    };
    let layer = Layer { id: "ground".into(), must_see: false, kind: terrain.into() };
    Scene { layers: vec![layer], ..Scene::default() }
}

/// Square roots of colours may differ by one step of an 8-bit picture: the two computations round differently.
const STEP: f32 = 1.0 / 255.0;

#[test]
fn samples_taken_together_are_those_of_their_triangles() {
    let scene = hills();
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, lod_px: 0.5, ..RenderOptions::default() };
    // Samples in cells along the north, east, south and west side beside coarser blocks, and others.
    let (mut odd, mut plain) = ([0; 4], 0);
    // From all sides, since coarser blocks lie farther away.
    for (x, y) in [(100.0, -1300.0), (1300.0, 100.0), (-100.0, 1300.0), (-1300.0, -100.0)] {
        let screen = Projection::Perspective { fov_y: 0.9 };
        let (eye, target) = (DVec3::new(x, y, 260.0), DVec3::new(0.0, 0.0, -60.0));
        let view = View::straight(Pinhole::look_at(eye, target, DVec3::Z, screen, [331, 160], 1.0, None).unwrap());
        let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
        let (screen, passes) = (Screen::new(view.pinhole()), Pass::all(&view));
        let (mut blocks, light_cache) = (Blocks::default(), LightCache::default());
        blocks.build(&job, (&passes, None), &screen, None, &GroundCache::default());
        let shader = Shader::new(&job, &screen, &blocks, &light_cache);
        let mut band = Band::new(0, 160, 331, sample_offsets(1));
        blocks.draw(&mut band, DrawnSolids { scene: &scene, solids: Solids::Opaque });
        let x: Vec<i32> = (0..331).map(|x| x * SUB + SUB / 2).collect();
        for row in 0..160 {
            let (y, from) = (vec![row * SUB + SUB / 2; 331], band.index(0, 0, row));
            let samples = Samples { prim: &band.prim[from..][..331], q: &band.q[from..][..331], x: &x, y: &y };
            let [mut together, mut each] = [Painted::default(), Painted::default()];
            shader.paint(samples, &mut together);
            shader.paint(samples, &mut each);
            each.root.iter_mut().for_each(|plane| plane.fill(-1.0));
            let mut batch = Batch::new();
            for k in (0..331).filter(|k| samples.prim[*k] != SKY) {
                batch.take_odd(0, &shader, &samples, k, &mut each);
                let (block, cell) = (samples.prim[k] >> 11, (samples.prim[k] >> 1) & 1023);
                let (c, r, seam) = (cell % 32, cell / 32, blocks.list[block as usize].seam_cells());
                let beside = [r == seam[0], c == seam[1], r == seam[2], c == seam[3]];
                odd.iter_mut().zip(beside).for_each(|(odd, beside)| *odd += u32::from(beside));
                plain += u32::from(!beside.contains(&true));
            }
            batch.flush(&shader, &samples, &mut each);
            assert_eq!(together.id, each.id);
            for (plane, each) in together.root.iter().zip(&each.root) {
                for (k, (a, b)) in plane.iter().zip(each).enumerate().filter(|(k, _)| samples.prim[*k] != SKY) {
                    assert!((a - b).abs() < STEP, "row {row}, column {k}: {a} {b}");
                }
            }
        }
    }
    assert!(odd.iter().all(|odd| *odd > 100) && plain > 40_000, "{odd:?} beside coarser blocks, {plain} others");
}

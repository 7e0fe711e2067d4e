//! Laws of a [`Renderer`], over small mountains in straight and bent views. What they compare with is a dense march along the ray of each
//! pixel, which shares nothing with a renderer.

use crate::synthetic::{march, on_a_small_planet, scene};
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, SplineBend, Stage, View};
use belvedere_scene::{Aux, Frame, Light, Progress, ROWS, RenderError, RenderJob, RenderOptions, Renderer, Scene};
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Size of the pictures, pixels.
const IMAGE: [u32; 2] = [96, 64];
/// Steps of the march.
const STEPS: usize = 1500;
/// Share of the pixels off the silhouettes that must show what the march meets.
const SAME: f64 = 0.99;
/// Largest error of their depths, as a share of the depth.
const DEPTH: f64 = 2e-3;
/// Largest distance between the middle of a pixel and the image of its world point, pixels.
const WORLD_PX: f64 = 1.0;

/// A camera over the southern end of the mountains: no ray comes to the ground from below its edge.
fn camera(scene: &Scene) -> Pinhole {
    let size = scene.bounds().max.x;
    let (eye, target) = (DVec3::new(0.45 * size, 0.05 * size, 1800.0), DVec3::new(0.5 * size, 0.6 * size, 1150.0));
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    Pinhole::look_at(eye, target, DVec3::Z, lens, IMAGE, 1.0, None).expect("a camera")
}

/// Views of the mountains by name: one of each technique that bends.
fn views(scene: &Scene) -> Vec<(&'static str, View)> {
    let pinhole = camera(scene);
    vec![
        ("straight", View::straight(pinhole.clone())),
        ("small planet", on_a_small_planet(pinhole.clone(), 30_000.0)),
        ("progressive", spline(&pinhole, "progressive")),
        ("one turn", turn(pinhole)),
    ]
}

fn spline(pinhole: &Pinhole, preset: &str) -> View {
    let ground = ReferencePlane::level(1150.0);
    let document = PresetDocument::builtin(preset).expect("the preset is built in");
    let bend =
        SplineBend::new(pinhole, &document, &ground, default_pivot(pinhole, &ground)).expect("it fits the camera");
    View::new(bend.adapted_pinhole(pinhole), vec![Stage::SplineBend(bend)]).expect("one stage is in order")
}

/// Rays that rise behind the middle of the mountains.
fn turn(pinhole: Pinhole) -> View {
    let (forward, eye) = (pinhole.forward.with_z(0.0).normalize(), pinhole.eye);
    let plane = |d: f64| eye + forward * d;
    let spec = TurnSpec {
        viewpoint: eye + DVec3::Z * 400.0,
        t0: plane(900.0),
        t1: plane(1100.0),
        t2: plane(1300.0),
        pencil: Pencil::Parallel { normal: -forward },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&pinhole, Model::Modified, &[spec]).expect("the turn is valid");
    View::new(pinhole, vec![Stage::CurvedRays(rays)]).expect("one stage is in order")
}

/// One sample per pixel, without marks and level of detail, with world points of the very centres.
fn options(world: bool) -> RenderOptions {
    let aux = Aux { world, exact: world };
    RenderOptions { samples: 1, lod_px: 0.0, marks: false, aux, ..RenderOptions::default() }
}

fn with_job<T>(
    (scene, view, options, progress): (&Scene, &View, &RenderOptions, &Progress),
    work: impl FnOnce(&RenderJob<'_>) -> T,
) -> T {
    work(&RenderJob { scene, view, light: &Light::default(), options, progress })
}

fn drawn(renderer: &dyn Renderer, scene: &Scene, view: &View, options: &RenderOptions) -> Frame {
    with_job((scene, view, options, &Progress::silent()), |job| renderer.render(job)).expect("a picture")
}

fn pixel(i: usize) -> DVec2 {
    let width = IMAGE[0] as usize;
    DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5)
}

/// Whether the eight neighbours of a pixel lie on the same slope: their depths differ by less than 4 %.
fn is_off_silhouettes(depths: &[Option<f64>], i: usize) -> bool {
    let [w, h] = IMAGE.map(|n| n as usize);
    let (x, y) = (i % w, i / w);
    let mut around = (y.saturating_sub(1)..(y + 2).min(h))
        .flat_map(|v| (x.saturating_sub(1)..(x + 2).min(w)).map(move |u| v * w + u));
    around.all(|k| match (depths[i], depths[k]) {
        (Some(a), Some(b)) => (b / a - 1.0).abs() <= 0.04,
        (a, b) => a.is_none() && b.is_none(),
    })
}

/// At the middle of a pixel the frame shows what its ray meets first: the layer, the depth, and a world point that is seen there.
pub fn draws_what_a_ray_meets(renderer: &dyn Renderer) {
    let scene = scene(60, 5);
    let ground = scene.terrain().expect("mountains");
    for (name, view) in views(&scene) {
        let far = 2.5 * ground.bounds().max.x;
        let count = IMAGE.iter().product::<u32>() as usize;
        let met: Vec<Option<f64>> =
            (0..count).into_par_iter().map(|i| march(&view, ground, pixel(i), 1.0, far, STEPS)).collect();
        let frame = drawn(renderer, &scene, &view, &options(true));
        let world = frame.world.as_ref().expect("world points were asked for");
        let judged: Vec<usize> = (0..count).filter(|&i| is_off_silhouettes(&met, i)).collect();
        let is_right = |&&i: &&usize| match met[i] {
            None => frame.id[i] == 0,
            Some(depth) => {
                let image = view.project(DVec3::from_array(world[i])).map(|image| image.pixel.distance(pixel(i)));
                frame.id[i] == 1
                    && (f64::from(frame.depth[i]) / depth - 1.0).abs() <= DEPTH
                    && image.is_ok_and(|off| off <= WORLD_PX)
            }
        };
        let right = judged.iter().filter(is_right).count();
        let (most, enough) = (judged.len(), SAME * judged.len() as f64);
        assert!(2 * most > count, "{name}: only {most} of {count} pixels lie off silhouettes");
        assert!(
            right as f64 >= enough,
            "{}, {name}: {right} of {most} pixels show what their rays meet",
            renderer.name()
        );
    }
}

/// Every buffer has one value per pixel; where nothing is seen the id is 0, the depth infinite and the world point no number, and only
/// there; world points are there only if they are asked for.
pub fn fills_its_buffers(renderer: &dyn Renderer) {
    let scene = scene(40, 2);
    for (name, view) in views(&scene) {
        let frame = drawn(renderer, &scene, &view, &options(true));
        let [w, h] = IMAGE.map(|n| n as usize);
        assert_eq!([frame.width, frame.height], [w, h], "{name}");
        let world = frame.world.as_ref().expect("world points were asked for");
        assert_eq!([frame.color.len(), frame.id.len(), frame.depth.len(), world.len()], [w * h; 4], "{name}");
        for (i, ((id, depth), point)) in frame.id.iter().zip(&frame.depth).zip(world).enumerate() {
            let nothing = *id == 0;
            assert_eq!(*depth == f32::INFINITY, nothing, "{name} {i}: depth {depth}");
            assert_eq!(point.iter().all(|v| v.is_nan()), nothing, "{name} {i}: {point:?}");
            assert!(*id as usize <= scene.layers.len() && *depth > 0.0, "{name} {i}");
        }
        assert!(drawn(renderer, &scene, &view, &options(false)).world.is_none(), "{name}");
    }
}

/// Two drawings of one job are the same, also after another job.
pub fn is_deterministic(renderer: &dyn Renderer) {
    let (one, other) = (scene(40, 2), scene(30, 3));
    for (name, view) in views(&one) {
        let first = drawn(renderer, &one, &view, &options(true));
        drawn(renderer, &other, &View::straight(camera(&other)), &options(false));
        assert!(is_same(&first, &drawn(renderer, &one, &view, &options(true))), "{name}");
    }
}

/// A frame that is drawn into the memory of another one holds nothing of it.
pub fn draws_into_an_old_frame(renderer: &dyn Renderer) {
    let scene = scene(40, 2);
    let views = views(&scene);
    let mut frame = drawn(renderer, &scene, &views[0].1, &options(true));
    for (name, view) in &views {
        let options = options(true);
        with_job((&scene, view, &options, &Progress::silent()), |job| renderer.render_into(job, &mut frame))
            .expect("a picture");
        assert!(is_same(&frame, &drawn(renderer, &scene, view, &options)), "{name}");
    }
}

/// A picture that is drawn some rows at a time is that drawn in one piece, where the renderer says that it can.
pub fn draws_rows_as_the_whole(renderer: &dyn Renderer) {
    let scene = scene(40, 2);
    let options = options(false);
    for (name, view) in views(&scene) {
        let whole = drawn(renderer, &scene, &view, &options);
        let width = whole.width;
        with_job((&scene, &view, &options, &Progress::silent()), |job| {
            let mut drawn = 0;
            let done = renderer.in_rows(job, &mut |rows| {
                let mut frame = Frame::default();
                for first in (0..whole.height).step_by(ROWS) {
                    let band = first..(first + ROWS).min(whole.height);
                    rows.draw(band.clone(), &mut frame)?;
                    assert_eq!(frame.color, whole.color[band.start * width..band.end * width], "{name} {band:?}");
                    drawn += band.len();
                }
                Ok(())
            });
            match renderer.whole_only(job) {
                Some(_) => assert!(matches!(done, Err(RenderError::WholeOnly { .. })), "{name}: {done:?}"),
                None => assert!(done.is_ok() && drawn == whole.height, "{name}: {done:?}"),
            }
        });
    }
}

/// A cancelled job ends with [`RenderError::Cancelled`].
pub fn ends_when_it_is_cancelled(renderer: &dyn Renderer) {
    let scene = scene(40, 2);
    let progress = Progress::silent();
    progress.cancel_flag().store(true, Ordering::Relaxed);
    for (name, view) in views(&scene) {
        let made = with_job((&scene, &view, &options(false), &progress), |job| renderer.render(job));
        assert!(matches!(made, Err(RenderError::Cancelled(_))), "{name}: {:?}", made.err());
    }
}

/// Whether two frames hold the same values, bit by bit.
fn is_same(a: &Frame, b: &Frame) -> bool {
    let bits = |frame: &Frame| -> Vec<u64> {
        frame.world.iter().flatten().flatten().map(|v| if v.is_nan() { u64::MAX } else { v.to_bits() }).collect()
    };
    a.color == b.color && a.id == b.id && a.depth == b.depth && bits(a) == bits(b)
}

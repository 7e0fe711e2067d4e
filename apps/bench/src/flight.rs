//! Cost of a frame of a flight over disoccluded terrain: solved for every frame, and solved in the background.

use crate::clock::{Stopwatch, median, quantile};
use crate::scene::ground;
use anyhow::Result;
use belvedere::builtin::valley_route;
use belvedere::construct::{Flight, FlightOptions};
use belvedere::core::{DVec3, Pinhole, Projection, Stage, View};
use belvedere::cpu::CpuRenderer;
use belvedere::disocclusion::{LiveTerrain, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere::scene::{
    Color, Frame, Layer, Light, LineFeature, LineLayer, Progress, RenderJob, RenderOptions, Renderer, Scene,
    drape_polyline,
};
use schemars::JsonSchema;
use serde::Serialize;
use std::sync::Arc;

/// Pictures per second, and distance between the eyes of two successive pictures, metres.
const RATE: f64 = 25.0;
const STEP_M: f64 = 3.0;

/// Cost of the ground of a flight's pictures by one method.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct FlightCost {
    /// `solved and judged for every picture`, or `solved in the background`.
    pub method: &'static str,
    /// Pictures after the first.
    pub pictures: usize,
    /// Reference points in the picture, on average.
    pub points: f64,
    /// Wall time until the ground of a picture is solved, milliseconds: median and 95 % quantile.
    pub ground_ms: [f64; 2],
    /// Wall time until the picture is drawn, solving included, milliseconds: median and 95 % quantile.
    pub picture_ms: [f64; 2],
    /// Largest number of pictures that the ground lags behind.
    pub lag: u64,
    /// Largest share of the points of a picture that its ground hides.
    pub hidden: f64,
}

/// Flies over ground of `nodes` x `nodes` nodes.
pub(crate) fn fly(nodes: usize, image: [u32; 2], pictures: usize) -> Result<Vec<FlightCost>> {
    let scene = Arc::new(with_route(ground(nodes)?)?);
    let views = views(&scene, image, pictures + 1)?;
    let solver = TerrainSolver::new(TerrainSettings::default())?.with_time_step(1.0 / RATE);
    let mut memory = TerrainMemory::default();
    let each = time("solved and judged for every picture", &scene, &views, |view| {
        let solved = solver.solve(&scene, view, &mut memory, &Progress::silent())?;
        let hidden = 1.0 - solved.report.metrics.visible;
        Ok(Ground { stage: Stage::TerrainDisocclusion(solved.stage), points: solved.report.points, lag: 0, hidden })
    })?;
    let mut live = LiveTerrain::new(solver.clone(), scene.clone());
    let beside = time("solved in the background", &scene, &views, |view| {
        let frame = live.frame(view)?;
        let hidden = frame.hidden as f64 / frame.points.max(1) as f64;
        Ok(Ground { stage: Stage::TerrainDisocclusion(frame.stage), points: frame.points, lag: frame.lag, hidden })
    })?;
    Ok(vec![each, beside])
}

struct Ground {
    stage: Stage,
    points: usize,
    lag: u64,
    hidden: f64,
}

/// Times the pictures of one method; the first picture warms up and does not count.
fn time(
    method: &'static str,
    scene: &Scene,
    views: &[View],
    mut ground: impl FnMut(&View) -> Result<Ground>,
) -> Result<FlightCost> {
    let options = RenderOptions { samples: 1, lod_px: 0.5, ..RenderOptions::default() };
    let (renderer, light) = (CpuRenderer::default(), Light::default());
    let (progress, mut frame) = (Progress::silent(), Frame::default());
    let (mut waits, mut wholes, mut points, mut lag, mut hidden) = (Vec::new(), Vec::new(), 0, 0, 0.0f64);
    for (k, view) in views.iter().enumerate() {
        let watch = Stopwatch::start();
        let made = ground(view)?;
        let ground_ms = watch.wall_ms();
        let bent = View::new(view.pinhole().clone(), vec![made.stage])?;
        let job = RenderJob { scene, view: &bent, light: &light, options: &options, progress: &progress };
        renderer.render_into(&job, &mut frame)?;
        if k > 0 {
            waits.push(ground_ms);
            wholes.push(watch.wall_ms());
            points += made.points;
            lag = lag.max(made.lag);
            hidden = hidden.max(made.hidden);
        }
    }
    let pictures = waits.len();
    let both = |times: Vec<f64>| [median(times.clone()), quantile(times, 0.95)];
    let points = points as f64 / pictures.max(1) as f64;
    Ok(FlightCost { method, pictures, points, ground_ms: both(waits), picture_ms: both(wholes), lag, hidden })
}

/// A route along the valleys that must be seen.
fn with_route(mut scene: Scene) -> Result<Scene> {
    let Some(terrain) = scene.terrain() else { return Ok(scene) };
    let route = valley_route(terrain, 7)?;
    let feature = |points| LineFeature { style: None, name: "route".into(), points };
    let features = drape_polyline(terrain, &route).parts.into_iter().map(feature).collect();
    let line = LineLayer::new(features, Color::rgb(215, 48, 31));
    scene.layers.push(Layer { id: "route".into(), must_see: true, kind: line.into() });
    Ok(scene)
}

fn views(scene: &Scene, image: [u32; 2], pictures: usize) -> Result<Vec<View>> {
    let lines = scene.layers.iter().filter_map(|l| l.kind.lines().and_then(|line| line.features.first()));
    let route: Vec<_> = lines.flat_map(|f| f.points.iter().map(|p| p.truncate())).collect();
    let length: f64 = route.windows(2).map(|p| p[0].distance(p[1])).sum();
    let flight = Flight::along(&route, scene.terrain(), &FlightOptions::for_length(length))?;
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    let view = |k: usize| {
        let (eye, target) = flight.at(STEP_M * k as f64);
        Pinhole::look_at(eye, target, DVec3::Z, lens, image, 1.0, None).map(View::straight)
    };
    Ok((0..pictures).map(view).collect::<Result<_, _>>()?)
}

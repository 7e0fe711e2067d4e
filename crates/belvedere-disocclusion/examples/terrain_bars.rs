//! Acceptance figures of terrain disocclusion: many eyes over three ranges, and a fly-through.
//!
//! `cargo run --release -p belvedere-construct --example terrain_bars [EYES] [FRAMES] [andorra|gotthard|baltoro|all] [W]`
//! (default 20, 60, all, and the default smoothness of mode qp). Prints one line per eye
//! and a summary per range: visible and densely visible share before and after, points left out, rise, and the displacement of
//! mode qp against that of mode paper (w = 0.6) for the same eye and points.

#![expect(clippy::print_stdout, reason = "it prints figures")]

use belvedere_builtin::valley_route;
use belvedere_construct::{Flight, FlightOptions};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{SolverMode, TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_io::{TerrainRequest, areas_on_terrain, lines_on_terrain, load_terrain, load_vectors};
use belvedere_scene::{
    AreaLayer, AreaSurface, Color, Heightfield, Hidden, Layer, LayerKind, LineFeature, LineLayer, Progress, Relief,
    Scene, TerrainLayer, drape_polyline,
};
use belvedere_testkit::{Random, data};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let argument = |k: usize, usual: usize| std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(usual);
    let (eyes, frames) = (argument(1, 20), argument(2, 60));
    let only = std::env::args().nth(3).filter(|o| o != "all");
    let w = std::env::args().nth(4).and_then(|a| a.parse().ok());
    for (name, dem) in [
        ("andorra", "andorra/N42E001.hgt"),
        ("gotthard", "gotthard/N46E008.tif"),
        ("baltoro", "baltoro/baltoro_srtm.tif"),
    ] {
        if only.as_ref().is_some_and(|o| o != name) {
            continue;
        }
        let Some(path) = data(dem) else { continue };
        let request = TerrainRequest { fill_voids: true, ..TerrainRequest::default() };
        let loaded = load_terrain(&[path], &request, &Progress::silent())?.value;
        let mut layers = Vec::new();
        if name == "andorra" {
            let Some(gr11) = data("andorra/gr11_andorra_no_elevation.gpx") else { continue };
            let lines = lines_on_terrain(&load_vectors(&gr11)?.value, loaded.crs, Some(&loaded.heightfield))?.value;
            layers.push(("gr11", line(lines.features)));
            let Some(roads) = data("andorra/roads.geojson") else { continue };
            let lines = lines_on_terrain(&load_vectors(&roads)?.value, loaded.crs, Some(&loaded.heightfield))?.value;
            layers.push(("roads", line(lines.features)));
            let Some(water) = data("andorra/water.geojson") else { continue };
            let areas = areas_on_terrain(&load_vectors(&water)?.value, loaded.crs, Some(&loaded.heightfield))?.value;
            let fill = Color::rgb(80, 140, 200);
            let lakes = AreaLayer {
                features: areas.features,
                fill,
                outline: None,
                width_px: 1.0,
                surface: AreaSurface::Water,
                hidden: Hidden::Dash,
                lift_m: 1.0,
                label_px: None,
                beyond: 0.0,
            };
            layers.push(("lakes", LayerKind::Area(lakes)));
        } else {
            for seed in [7, 8] {
                let way = valley_route(&loaded.heightfield, seed)?;
                let parts = drape_polyline(&loaded.heightfield, &way).parts;
                let features = parts
                    .into_iter()
                    .map(|points| LineFeature { style: None, name: format!("route {seed}"), points })
                    .collect();
                layers.push((if seed == 7 { "route7" } else { "route8" }, line(features)));
            }
        }
        let scene = scene(loaded.heightfield, loaded.crs, layers);
        bars(name, &scene, eyes, w)?;
        fly(name, &scene, frames, w)?;
    }
    Ok(())
}

fn line(features: Vec<LineFeature>) -> LayerKind {
    LayerKind::Line(LineLayer::new(features, Color::rgb(215, 48, 31)))
}

fn scene(heightfield: Heightfield, crs: belvedere_scene::Crs, features: Vec<(&str, LayerKind)>) -> Scene {
    let ground = TerrainLayer {
        heightfield: heightfield.into(),
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: belvedere_scene::PaletteName::Auto.into(),
        contours: None,
        edge: belvedere_scene::Edge::Plain,
    };
    let mut layers = vec![Layer { id: "ground".into(), must_see: false, kind: ground.into() }];
    layers.extend(features.into_iter().map(|(id, kind)| Layer { id: id.into(), must_see: true, kind }));
    Scene { crs, layers, ..Scene::default() }
}

fn ways(scene: &Scene) -> Vec<Vec<DVec2>> {
    let lines = scene.layers.iter().filter_map(|l| l.kind.lines().map(|l| &l.features));
    lines.flatten().map(|f| f.points.iter().map(|p| p.truncate()).collect()).collect()
}

fn view(eye: DVec3, target: DVec3) -> Result<View, Failure> {
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    Ok(View::straight(Pinhole::look_at(eye, target, DVec3::Z, lens, [1280, 720], 1.0, None)?))
}

/// Seeded views of places on the routes, from 2 to 12 km away and 200 to 1500 m above the ground.
fn views(scene: &Scene, count: usize) -> Result<Vec<(f64, View)>, Failure> {
    let hf = scene.terrain().ok_or("no terrain")?;
    let places: Vec<DVec2> = ways(scene).concat();
    let mut random = Random::new(20_130_415);
    let mut out = Vec::new();
    while out.len() < count {
        let place = places[random.below(places.len())];
        let away = random.range(2_000.0, 12_000.0) * DVec2::from_angle(random.range(0.0, std::f64::consts::TAU));
        let above = random.range(200.0, 1500.0);
        let (Some(ground), Some(target)) = (hf.surface_at(place + away), hf.surface_at(place)) else { continue };
        out.push((above, view((place + away).extend(ground + above), place.extend(target))?));
    }
    Ok(out)
}

fn solve(scene: &Scene, view: &View, mode: SolverMode, w: Option<f64>) -> Result<(TerrainReport, f64), Failure> {
    let solver = TerrainSolver::new(TerrainSettings { mode, w, ..TerrainSettings::default() })?;
    let began = Instant::now();
    let solved = solver.solve(scene, view, &mut TerrainMemory::default(), &Progress::silent())?;
    Ok((solved.report, began.elapsed().as_secs_f64() * 1e3))
}

fn bars(name: &str, scene: &Scene, count: usize, w: Option<f64>) -> Result<(), Failure> {
    println!(
        "{name}: above  points  before  visible  dense  in_guard  worst_m  unresolved  raised  rms(qp)  rms(paper)  ratio  normal(qp)  normal(paper)  visible(paper)  rows  active  rounds  qp_ms"
    );
    let (mut worst_visible, mut worst_dense, mut failed, mut raised, mut ratios) =
        (1.0f64, 1.0f64, 0, 0.0f64, Vec::new());
    let mut squares = [0.0f64; 2];
    for (above, view) in views(scene, count)? {
        let (qp, _) = solve(scene, &view, SolverMode::Qp, w)?;
        let (paper, _) = solve(scene, &view, SolverMode::Paper, None)?;
        let unresolved: usize = qp.unresolved.iter().map(|r| r.points).sum();
        let ratio = qp.metrics.rms_m / paper.metrics.rms_m.max(1e-9);
        let rows = qp.qp.ok_or("no program")?;
        println!(
            "{name}  {above:6.0} {:6} {:8.4} {:8.5} {:8.5} {:8.5} {:7.2} {unresolved:6} {:8.3} {:8.2} {:8.2} {ratio:7.3} {:6.3} {:6.3} {:6.3} {:6} {:5} {:4} {:8.0}",
            qp.points,
            qp.visible_before,
            qp.metrics.visible,
            qp.metrics.visible_dense,
            qp.metrics.hidden_in_guard,
            qp.metrics.hidden_worst_m,
            qp.metrics.raised_max_m,
            qp.metrics.rms_m,
            paper.metrics.rms_m,
            qp.metrics.normal_mean_deg,
            paper.metrics.normal_mean_deg,
            paper.metrics.visible,
            rows.rows,
            rows.active,
            rows.rounds,
            qp.times.qp_ms
        );
        for run in qp.unresolved.iter().take(3) {
            println!("    {run:?}");
        }
        worst_visible = worst_visible.min(qp.metrics.visible);
        worst_dense = worst_dense.min(qp.metrics.visible_dense);
        failed += usize::from(unresolved > 0);
        raised = raised.max(qp.metrics.raised_max_m);
        squares = [squares[0] + qp.metrics.rms_m.powi(2), squares[1] + paper.metrics.rms_m.powi(2)];
        if paper.metrics.rms_m > 0.5 {
            ratios.push(ratio);
        }
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "{name}: {count} eyes, visible >= {worst_visible:.5}, dense >= {worst_dense:.5}, {failed} with unresolved points, raised <= {raised:.3} m, rms ratio median {:.3}, largest {:.3}, of all eyes together {:.3}",
        ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN),
        ratios.last().copied().unwrap_or(f64::NAN),
        (squares[0] / squares[1]).sqrt()
    );
    Ok(())
}

/// A walker's film: 1.4 m/s at 25 frames per second, then 3 m per frame.
fn fly(name: &str, scene: &Scene, frames: usize, w: Option<f64>) -> Result<(), Failure> {
    let way = ways(scene).into_iter().max_by_key(Vec::len).ok_or("no route")?;
    let length: f64 = way.windows(2).map(|w| w[0].distance(w[1])).sum();
    let flight = Flight::along(&way, scene.terrain(), &FlightOptions::for_length(length))?;
    for (label, step, dt) in [("walking, 1.4 m/s at 25 fps", 0.056, 0.04), ("3 m per frame at 30 fps", 3.0, 1.0 / 30.0)]
    {
        let settings = TerrainSettings { w, ..TerrainSettings::default() };
        let solver = TerrainSolver::new(settings)?.with_time_step(dt);
        let mut memory = TerrainMemory::default();
        let (mut worst, mut mean, mut visible, mut times) = (0.0f64, 0.0, 1.0f64, Vec::new());
        for i in 0..frames {
            let (eye, target) = flight.at(0.3 * length + i as f64 * step);
            let solved = solver.solve(scene, &view(eye, target)?, &mut memory, &Progress::silent())?;
            if let Some(change) = solved.report.metrics.frame {
                worst = worst.max(change.max_m);
                mean += change.rms_m / (frames - 1) as f64;
                times.push(solved.report.times.qp_ms);
            }
            visible = visible.min(solved.report.metrics.visible_dense);
        }
        times.sort_by(f64::total_cmp);
        let at = |q: f64| times.get((q * times.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        println!(
            "{name}: {label}, {frames} frames: worst step {worst:.2} m, mean rms step {mean:.3} m, dense >= {visible:.5}, warm qp p50 {:.0} ms, p95 {:.0} ms",
            at(0.5),
            at(0.95)
        );
    }
    Ok(())
}

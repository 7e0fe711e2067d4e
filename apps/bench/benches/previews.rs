//! How evenly path previews move, how much of the path they show, and how much sky is in their lower half: two canyons, two towns and a
//! vessel that are generated, and a town, a hiking route and a vessel of the data collection (`BELVEDERE_DATA`). A line of a table per path.
//!
//! Two frames are compared at every position: one there, and one a thousandth of the preview's length farther (1000 steps take 40 seconds
//! of film). The shift of the points seen by every 16th pixel is measured in pixels; points that leave the picture do not count.
//!
//! `cargo bench -p belvedere-bench --bench previews -- [NAME..] [--positions 60]`
#![allow(missing_docs, clippy::print_stdout, clippy::print_stderr)]

use anyhow::{Context, Result};
use belvedere::construct::centreline::centreline;
use belvedere::construct::rays::{Lens, PathPreview, Target, TargetSight, find_wall};
use belvedere::core::{DVec2, DVec3, View};
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{
    Frame, LayerKind, Light, Progress, RenderJob, RenderOptions, Renderer, Scene, TransferFunction,
};
use belvedere::{OpenOptions, Session};
use std::path::{Path, PathBuf};

const IMAGE: [u32; 2] = [320, 180];
/// Spacing of the measured pixels in both directions, pixels.
const EVERY: u32 = 4;
/// Steps to the length of a preview.
const STEPS: f64 = 1000.0;
/// Samples of the path ahead.
const SAMPLES: f64 = 100.0;

/// A path to be previewed: name, layers, the layer of the path or the two ends of a centreline, and the length of the preview.
struct Case {
    name: &'static str,
    layers: &'static str,
    path: Way,
    preview_m: f64,
}

enum Way {
    Line(&'static str),
    Vessel { from: [f64; 3], to: [f64; 3], values: [f64; 2] },
}

const CANYON: &str = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'builtin:canyon?seed=SEED'\n\
    [[layer]]\nid = 'path'\nkind = 'line'\nsource = 'builtin:canyon?seed=SEED'\n";
const STREET: &str = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'builtin:street?seed=SEED'\n\
    [[layer]]\nid = 'towers'\nkind = 'boxes'\nsource = 'builtin:street?seed=SEED'\n\
    [[layer]]\nid = 'path'\nkind = 'line'\nsource = 'builtin:street?seed=SEED'\n";
const TUBE: &str = "[[layer]]\nid = 'vessel'\nkind = 'volume'\nsource = 'builtin:tube?seed=SEED'\n";
const SWELLENDAM: &str = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'swellendam/srtm_41_19_utm33s.tif'\n\
    [[layer]]\nid = 'town'\nkind = 'city'\nsource = 'swellendam/buildings.geojson'\n\
    [[layer]]\nid = 'path'\nkind = 'line'\nsource = 'swellendam_route.geojson'\n";
const ANDORRA: &str = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'andorra/N42E001.hgt'\n\
    [[layer]]\nid = 'path'\nkind = 'line'\nsource = 'andorra/hrp_andorra_no_elevation.gpx'\n";
const ANEURISM: &str = "[[layer]]\nid = 'vessel'\nkind = 'volume'\nsource = 'volumes/aneurism.vti'\n";

const CASES: [(Case, u64); 8] = [
    (Case { name: "canyon 1", layers: CANYON, path: Way::Line("path"), preview_m: 4000.0 }, 1),
    (Case { name: "canyon 2", layers: CANYON, path: Way::Line("path"), preview_m: 4000.0 }, 2),
    (Case { name: "street 1", layers: STREET, path: Way::Line("path"), preview_m: 400.0 }, 1),
    (Case { name: "street 2", layers: STREET, path: Way::Line("path"), preview_m: 400.0 }, 2),
    (
        Case {
            name: "tube",
            layers: TUBE,
            path: Way::Vessel { from: [97.0, 63.0, 25.0], to: [97.0, 56.0, 86.0], values: [12.0, 70.0] },
            preview_m: 70.0,
        },
        1,
    ),
    (Case { name: "Swellendam", layers: SWELLENDAM, path: Way::Line("path"), preview_m: 300.0 }, 0),
    (Case { name: "Andorra", layers: ANDORRA, path: Way::Line("path"), preview_m: 1000.0 }, 0),
    (
        Case {
            name: "aneurism",
            layers: ANEURISM,
            path: Way::Vessel { from: [185.0, 35.0, 152.0], to: [95.0, 119.0, 179.0], values: [110.0, 255.0] },
            preview_m: 40.0,
        },
        0,
    ),
];

fn main() -> Result<()> {
    let (mut names, mut positions) = (Vec::new(), 60);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--positions" => positions = args.next().context("--positions needs a number")?.parse()?,
            "--bench" => {}
            _ => names.push(arg),
        }
    }
    println!(
        "| path | positions | 99 % of the picture, at most, medians | half of it | path seen | sky in the lower half |"
    );
    println!("| --- | --- | --- | --- | --- | --- |");
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| name.starts_with(n.as_str()));
    for (case, seed) in CASES.iter().filter(|(case, _)| wanted(case.name)) {
        match opened(case, *seed) {
            Ok((scene, path)) => measured(case, &scene, &path, positions)?,
            Err(e) => eprintln!("SKIPPED: {}: {e}", case.name),
        }
    }
    Ok(())
}

/// The scene of a path, with volumes drawn as walls, and the path.
fn opened(case: &Case, seed: u64) -> Result<(Scene, Vec<DVec3>)> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = std::env::var_os("BELVEDERE_DATA").map_or_else(|| here.join("../../../shared/data"), PathBuf::from);
    let layers = case.layers.replace("SEED", &seed.to_string());
    let unit = if matches!(case.path, Way::Vessel { .. }) { "unit = 'voxel'\n" } else { "" };
    let text = format!("format = 1\n{unit}[camera]\neye = [0, 0, 1e5]\nlook_at = [0, 1, 0]\n{layers}");
    let options = OpenOptions { allow_roots: vec![data, here.join("scenes")], ..OpenOptions::default() };
    let session = Session::from_text(Path::new("preview.toml"), &text, &options)?;
    let mut scene = session.scene().clone();
    let mut path = Vec::new();
    for layer in &mut scene.layers {
        match (&mut layer.kind, &case.path) {
            (LayerKind::Line(line), Way::Line(id)) if layer.id == *id => path = line.longest_chain(500.0),
            (LayerKind::Volume(volume), Way::Vessel { from, to, values }) => {
                let [from, to] = [from, to].map(|p| DVec3::from_array(*p));
                path = centreline(&volume.volume, from, to, *values)?.points;
                let wall = find_wall(&volume.volume, &path)?;
                volume.transfer = TransferFunction::wall(wall.lumen, wall.isovalue, wall.wall);
            }
            _ => {}
        }
    }
    Ok((scene, path))
}

fn measured(case: &Case, scene: &Scene, path: &[DVec3], positions: usize) -> Result<()> {
    let level = matches!(case.path, Way::Line(_));
    let usual = Lens::for_preview(case.preview_m, level);
    let preview = PathPreview::fitted(scene, path, case.preview_m, usual, level, IMAGE)?;
    let (whole, step) = (preview.length(), case.preview_m / STEPS);
    let (mut fast, mut usual, mut seen, mut sky) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut slowest, mut wide): (Vec<(f64, f64)>, Vec<f64>) = (Vec::new(), Vec::new());
    for k in 0..positions {
        let at = (whole - case.preview_m).max(0.5 * whole) * k as f64 / positions as f64;
        let [now, next] = [at, at + step].map(|at| preview.at(at, IMAGE, None).map(|p| p.view));
        let (now, next) = (now?, next?);
        wide.push(2.0 * (0.5 * f64::from(IMAGE[0]) / now.pinhole().scale_px()).atan().to_degrees());
        let frame = drawn(scene, &now)?;
        let moved = motions(&frame, &now, &next);
        fast.push(share_of(&moved, 0.99));
        usual.push(share_of(&moved, 0.5));
        slowest.push((share_of(&moved, 0.99), at));
        let lower = &frame.id[frame.id.len() / 2..];
        sky.push(lower.iter().filter(|id| **id == 0).count() as f64 / lower.len() as f64);
        let ahead = case.preview_m.min(whole - at);
        let lift = if level { 0.001 * case.preview_m * DVec3::Z } else { DVec3::ZERO };
        let samples = preview.samples(at, ahead, ahead / SAMPLES).into_iter().map(|p| p + lift);
        seen.push(TargetSight::new(scene, &Target::points(samples)).share(&now, 0.0));
    }
    let ratio = |all: &[f64]| share_of(all, 1.0) / share_of(all, 0.5);
    let mean = |all: &[f64]| 100.0 * all.iter().sum::<f64>() / all.len() as f64;
    println!(
        "| {} | {positions} | {:.1} | {:.1} | {:.1} % | {:.1} % |",
        case.name,
        ratio(&fast),
        ratio(&usual),
        mean(&seen),
        mean(&sky)
    );
    slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let places: Vec<String> = slowest.iter().take(6).map(|(m, at)| format!("{m:.2} px at {at:.1}")).collect();
    eprintln!(
        "{}: lens {:.1?}; fastest {}; median {:.2} px, of half the picture {:.2} px; least of the path seen {:.2}; \
         the near eye looks {:.0} degrees wide, {:.0} at 90 % of the positions, {:.0} at most",
        case.name,
        preview.lens(),
        places.join(", "),
        share_of(&fast, 0.5),
        share_of(&usual, 0.5),
        seen.iter().copied().fold(1.0, f64::min),
        share_of(&wide, 0.5),
        share_of(&wide, 0.9),
        share_of(&wide, 1.0)
    );
    Ok(())
}

fn drawn(scene: &Scene, view: &View) -> Result<Frame> {
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
    Ok(CpuRenderer::default().render(&job)?)
}

/// Distances in pixels between the images, in two successive views, of the points that every 16th pixel sees.
fn motions(frame: &Frame, now: &View, next: &View) -> Vec<f64> {
    let [w, h] = IMAGE;
    let mut moved = Vec::new();
    for y in (EVERY / 2..h).step_by(EVERY as usize) {
        for x in (EVERY / 2..w).step_by(EVERY as usize) {
            let i = (y * w + x) as usize;
            let pixel = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            if frame.id[i] == 0 {
                continue;
            }
            let Ok(place) = now.ray(pixel).at(f64::from(frame.depth[i])) else { continue };
            if let Ok(image) = next.project(place.point)
                && next.pinhole().contains(image.pixel)
            {
                moved.push((image.pixel - pixel).length());
            }
        }
    }
    moved
}

/// Quantile: the value that `share` of all values do not exceed; 0 without values.
fn share_of(all: &[f64], share: f64) -> f64 {
    let mut sorted = all.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted.get((share * last as f64).round() as usize).copied().unwrap_or(0.0)
}

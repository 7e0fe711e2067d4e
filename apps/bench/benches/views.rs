//! Multi-perspective views of generated towns at three levels of abstraction, 1600 x 1200: straight and bent, one section and six, one
//! preset and two blended, dither and layers. The frames of a row are drawn alternately. The output is one line of JSON per row.
//!
//! `cargo bench -p belvedere-bench --bench views -- [--frames 7] [--size 1600]`
#![allow(missing_docs, clippy::print_stdout)]

use anyhow::{Context, Result};
use belvedere::core::View;
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Compositing, Progress, RenderJob, RenderOptions, Renderer, Scene};
use belvedere::{OpenOptions, Session};
use belvedere_bench::clock::{Stopwatch, median, quantile};
use std::path::Path;

const IMAGE: [u32; 2] = [1600, 1200];
/// The curve of every preset here: progressive.
const CURVE: &str = "s = 0.5, e = 1.9, control = [[0.0, -0.42], [0.17, -0.08], [0.42, 0.03], [1.0, 0.20]]";

fn main() -> Result<()> {
    let (mut frames, mut size) = (7, 1600.0);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--frames" => frames = args.next().context("--frames needs a number")?.parse()?,
            "--size" => size = args.next().context("--size needs metres")?.parse()?,
            _ => {}
        }
    }
    let preset = |phi: f64, sections: &str, tags: &str| {
        format!("{{ phi = {phi}, {CURVE}, tags = [{tags}], sections = [{sections}] }}")
    };
    let tags = |shares: &[f64]| shares.iter().map(|u| format!("{{ u = {u}, delta = 0.04 }}, ")).collect::<String>();
    let (two, five) = (tags(&[0.35, 0.7]), tags(&[0.17, 0.33, 0.5, 0.67, 0.83]));
    let level = |loa: u32| (["loa0", "loa1", "loa2"][loa as usize], loa);
    let levels = [0, 1, 2].map(level);
    let one = session(size, &levels[..1], &preset(30.0, "\"loa0\"", ""))?;
    let same = ["a", "b", "c", "d", "e", "f"].map(|name| (name, 0));
    let six = session(size, &same, &preset(30.0, "\"a\", \"b\", \"c\", \"d\", \"e\", \"f\"", &five))?;
    let all = "\"loa0\", \"loa1\", \"loa2\"";
    let three = session(size, &levels, &preset(30.0, all, &two))?;
    // Halfway between two presets of one curve, whose sections differ.
    let pair = [preset(10.0, "\"loa0\", \"loa0\", \"loa1\"", &two), preset(50.0, all, &two)].join(", ");
    let blended = session(size, &levels, &pair)?;
    let straight = one.view().straightened();
    let dither = RenderOptions { samples: 4, ..RenderOptions::default() };
    let layers = RenderOptions { compositing: Compositing::Layers, ..dither.clone() };
    row("bent to straight", frames, &[(one.scene(), &straight, &dither), (one.scene(), one.view(), &dither)])?;
    row("six sections to one", frames, &[(one.scene(), one.view(), &dither), (six.scene(), six.view(), &dither)])?;
    row(
        "two presets to one",
        frames,
        &[(three.scene(), three.view(), &dither), (blended.scene(), blended.view(), &dither)],
    )?;
    row(
        "layers to dither, three sections",
        frames,
        &[(three.scene(), three.view(), &dither), (three.scene(), three.view(), &layers)],
    )?;
    table(size)
}

/// A town.
///
/// * `representations`: names, and the level of abstraction of each.
fn session(size: f64, representations: &[(&str, u32)], presets: &str) -> Result<Session> {
    let names: String = representations.iter().map(|(name, loa)| format!("{name} = [\"level{loa}\"]\n")).collect();
    let mut levels: Vec<u32> = representations.iter().map(|(_, loa)| *loa).collect();
    levels.dedup();
    let layer = |loa: &u32| {
        format!(
            "[[layer]]\nid = \"level{loa}\"\nkind = \"city\"\nsource = \"builtin:town?seed=7&size={size}\"\nloa = {loa}\n"
        )
    };
    let layers: String = levels.iter().map(layer).collect();
    let (eye, [width, height]) = ([-0.06 * size, -0.5 * size, 0.29 * size], IMAGE);
    let text = format!(
        "format = 1\ncrs = \"local\"\n[representations]\n{names}{layers}\
        [camera]\neye = {eye:?}\nlook_at = [0.0, 0.0, 0.0]\nimage = [{width}, {height}]\n\
        [[stage]]\nkind = \"spline_bend\"\npresets = {{ version = 1, units = \"distance\", presets = [{presets}] }}\n"
    );
    Ok(Session::from_text(Path::new("town.toml"), &text, &OpenOptions::default())?)
}

/// A scene in a view at some quality.
type Case<'a> = (&'a Scene, &'a View, &'a RenderOptions);

/// Draws the frames of both cases alternately and prints the ratio of the second to the first.
fn row(name: &str, frames: usize, cases: &[Case<'_>; 2]) -> Result<()> {
    let renderers = [CpuRenderer::default(), CpuRenderer::default()];
    let (light, progress) = (Default::default(), Progress::silent());
    let mut times = [Vec::new(), Vec::new()];
    let (mut triangles, mut bytes) = ([0; 2], [0; 2]);
    for round in 0..=frames {
        for (k, (scene, view, options)) in cases.iter().enumerate() {
            let job = RenderJob { scene, view, light: &light, options, progress: &progress };
            let clock = Stopwatch::start();
            let frame = renderers[k].render(&job)?;
            let ms = clock.cpu_ms().unwrap_or_else(|| clock.wall_ms());
            (triangles[k], bytes[k]) = (frame.stats.triangles_in, frame.stats.layer_bytes);
            if round > 0 {
                times[k].push(ms);
            }
        }
    }
    let ratio = median(times[1].iter().zip(&times[0]).map(|(a, b)| a / b).collect());
    let [first, second] = times.map(median);
    println!(
        "{}",
        serde_json::json!({ "row": name, "ms": [first, second], "ratio": ratio, "triangles": triangles, "layer_bytes": bytes })
    );
    Ok(())
}

/// Frames at the combinations of levels that Pasewaldt et al. 2011 measure: wall time.
fn table(size: f64) -> Result<()> {
    for (name, loas, shares) in
        [("LoA 0/1", vec![0, 1], "0.5"), ("LoA 1/2", vec![1, 2], "0.5"), ("LoA 0/1/2", vec![0, 1, 2], "0.35 0.7")]
    {
        let names: Vec<String> = loas.iter().map(|loa| format!("loa{loa}")).collect();
        let representations: Vec<(&str, u32)> = names.iter().map(String::as_str).zip(loas).collect();
        let sections: String = names.iter().map(|name| format!("\"{name}\", ")).collect();
        let tags: String = shares.split(' ').map(|u| format!("{{ u = {u}, delta = 0.04 }}, ")).collect();
        let preset = format!("{{ phi = 30.0, {CURVE}, tags = [{tags}], sections = [{sections}] }}");
        let session = session(size, &representations, &preset)?;
        let renderer = CpuRenderer::default();
        let (light, progress) = (Default::default(), Progress::silent());
        let options = RenderOptions { samples: 4, ..RenderOptions::default() };
        let (mut times, mut triangles) = (Vec::new(), 0);
        for _ in 0..12 {
            let (scene, view) = (session.scene(), session.view());
            let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
            let clock = Stopwatch::start();
            triangles = renderer.render(&job)?.stats.triangles_in;
            times.push(clock.wall_ms());
        }
        times.remove(0);
        let worst = quantile(times.clone(), 0.99);
        println!(
            "{}",
            serde_json::json!({ "table": name, "median_ms": median(times), "p99_ms": worst, "triangles": triangles })
        );
    }
    Ok(())
}

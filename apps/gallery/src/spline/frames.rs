//! Time per frame at the three combinations of levels of abstraction that the paper measures.

use super::bent::TILE;
use crate::easel::Easel;
use crate::figure_set::Figure;
use anyhow::Result;
use belvedere::Session;
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Instant, Progress, RenderJob, RenderOptions, Renderer};

/// Measured frames of each combination, after a first one that fills the caches.
const FRAMES: usize = 5;
const IMAGE: [u32; 2] = [1600, 1200];

/// A row of the paper's table (frames per second on a GeForce GTX 285), and the size of a generated town with about as many faces.
struct Combination {
    levels: &'static [u32],
    faces: usize,
    per_second: f64,
    /// Width of the town, metres.
    town_m: f64,
}

const PAPER: [Combination; 3] = [
    Combination { levels: &[0, 1], faces: 477_437, per_second: 21.0, town_m: 4450.0 },
    Combination { levels: &[1, 2], faces: 364_500, per_second: 39.0, town_m: 4900.0 },
    Combination { levels: &[0, 1, 2], faces: 720_587, per_second: 17.0, town_m: 4680.0 },
];

/// A panel for each row.
pub(super) fn table(easel: &Easel<'_>) -> Result<Figure> {
    let mut panels = Vec::new();
    for row in &PAPER {
        let text = scene(row, easel.scale());
        let (triangles, times) = measured(&easel.open(&text, IMAGE)?)?;
        let levels: Vec<String> = row.levels.iter().map(u32::to_string).collect();
        let note = format!(
            "{triangles} triangles, {:.0} to {:.0} ms; paper: {}, {:.0} ms",
            times[0],
            times[FRAMES - 1],
            row.faces,
            1e3 / row.per_second
        );
        panels.push(easel.panel(&easel.open(&text, TILE)?, &format!("LoA {}", levels.join("/")), note)?);
    }
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}

/// A town with a section for each level, bent progressively.
///
/// * `scale`: factor of the width of the town.
fn scene(row: &Combination, scale: f64) -> String {
    let size = (row.town_m * scale).round();
    let named = |level: &u32| format!("loa{level} = [\"level{level}\"]\n");
    let layer = |level: &u32| {
        format!(
            "[[layer]]\nid = \"level{level}\"\nkind = \"city\"\nsource = \"builtin:town?seed=7&size={size}\"\nloa = {level}\n"
        )
    };
    let of_levels = |text: &dyn Fn(&u32) -> String| row.levels.iter().map(text).collect::<String>();
    let sections = of_levels(&|level| format!("\"loa{level}\", "));
    let count = row.levels.len() as f64;
    let tags: String =
        (1..row.levels.len()).map(|i| format!("{{ u = {}, delta = 0.04 }}, ", i as f64 / count)).collect();
    format!(
        "format = 1\ncrs = \"local\"\n[representations]\n{}{}[camera]\neye = [{}, {}, {}]\nlook_at = [0.0, 0.0, 0.0]\n\
         [[stage]]\nkind = \"spline_bend\"\n[stage.presets]\nversion = 1\nunits = \"distance\"\n[[stage.presets.presets]]\nphi = 30.0\n\
         s = 0.5\ne = 1.9\ncontrol = [[0.0, -0.42], [0.17, -0.08], [0.42, 0.03], [1.0, 0.20]]\ntags = [{tags}]\nsections = [{sections}]\n",
        of_levels(&named),
        of_levels(&layer),
        -0.06 * size,
        -0.5 * size,
        0.29 * size,
    )
}

/// Triangles, and wall milliseconds of frames, ascending.
fn measured(session: &Session) -> Result<(u64, Vec<f64>)> {
    let (renderer, options, progress) = (CpuRenderer::default(), RenderOptions::default(), Progress::silent());
    let (scene, view, light) = (session.scene(), session.view(), session.light());
    let job = RenderJob { scene, view, light, options: &options, progress: &progress };
    let triangles = renderer.render(&job)?.stats.triangles_in;
    let mut times = Vec::new();
    for _ in 0..FRAMES {
        let start = Instant::now();
        renderer.render(&job)?;
        times.push(1e3 * start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok((triangles, times))
}

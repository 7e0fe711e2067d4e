//! `figures algorithms`: the charts of docs/algorithms, drawn from the algorithms' own results on generated ground.

use crate::chart::{self, Chart, Curve, SeriesLabelPosition, Style};
use crate::sheet;
use crate::terrain::area::Area;
use crate::terrain::profile::Profile;
use anyhow::{Context, Result};
use belvedere::core::map::curved_rays::Pencil;
use belvedere::core::{DVec2, DVec3, SpaceMap, Stage, TerrainDisocclusion};
use belvedere::cpu::CpuRenderer;
use belvedere::disocclusion::SolverMode;
use belvedere::output;
use belvedere::scene::{RenderJob, RenderOptions, Renderer};
use belvedere::{OpenOptions, Session};
use std::path::{Path, PathBuf};

const SIZE: [u32; 2] = [660, 310];
const NAMES: [&str; 6] =
    ["curved-rays", "spline-bend", "greedy-pass", "smooth-pass", "visibility-program", "level-of-detail"];
const CURVED_RAYS: &str = include_str!("../../../scenes/massif_curved_rays.toml");
const SPLINE_BEND: &str = include_str!("../../../scenes/massif.toml");
const TERRAIN: &str = include_str!("../../../scenes/massif_terrain.toml");

const GROUND: [u8; 3] = [176, 168, 156];
const AFTER: [u8; 3] = [120, 160, 108];
const BLUE: [u8; 3] = [30, 90, 170];
const RED: [u8; 3] = [200, 70, 60];
const DARK: [u8; 3] = [30, 40, 60];

/// Draws the charts into `folder`, which is made if need be, as `NAME.png`. Returns the files.
///
/// # Errors
/// A file that exists if `overwrite` is false; those of solving and drawing.
pub fn figures(folder: &Path, options: &OpenOptions, overwrite: bool) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let paths = NAMES.map(|name| folder.join(format!("{name}.png")));
    paths.iter().try_for_each(|path| output::check(path, &[], overwrite))?;
    let open = |text| Session::from_text(Path::new("figure.toml"), text, options);
    let (rays, bend) = (curved_rays(&open(CURVED_RAYS)?)?, spline_bend(&open(SPLINE_BEND)?)?);
    let [greedy, smooth, program] = terrain(options)?;
    let charts = [rays, bend, greedy, smooth, program, level_of_detail(options)?];
    for (path, chart) in paths.iter().zip(&charts) {
        sheet::write(path, chart::draw(chart, SIZE)?, &chart.title, overwrite)?;
    }
    Ok(paths.into())
}

/// The vertical plane through an eye along its direction of view: kilometres ahead, metres of height.
struct Section {
    eye: DVec3,
    heading: DVec3,
}

impl Section {
    fn of(session: &Session) -> Self {
        let pinhole = session.view().pinhole();
        Self { eye: pinhole.eye, heading: pinhole.forward.with_z(0.0).normalize() }
    }

    fn place(&self, p: DVec3) -> (f64, f64) {
        ((p - self.eye).dot(self.heading) / 1000.0, p.z)
    }

    /// Points of the surface every 50 m up to `far_m`.
    fn ground(&self, session: &Session, far_m: f64) -> Vec<DVec3> {
        let Some(terrain) = session.scene().terrain() else { return Vec::new() };
        let sample = |i: usize| {
            let xy = (self.eye + self.heading * (50.0 * i as f64)).truncate();
            Some(xy.extend(terrain.surface_at(xy)?))
        };
        (0..(far_m / 50.0) as usize).filter_map(sample).collect()
    }
}

fn chart(title: &str, x: &str, y: &str, legend: SeriesLabelPosition, curves: Vec<Curve>) -> Chart {
    Chart { title: title.into(), x: x.into(), y: y.into(), legend, curves }
}

/// Curved rays of the picture's middle column, in the plane of the camera's heading.
fn curved_rays(session: &Session) -> Result<Chart> {
    let (section, view) = (Section::of(session), session.view());
    let turn = view.curved_rays().context("the scene bends no rays")?.spec()[0];
    let ground = section.ground(session, 16_000.0).into_iter().map(|p| section.place(p)).collect();
    let mut curves = vec![Curve::new("ground", ground, GROUND, Style::Filled)];
    let [w, h] = view.pinhole().image.map(f64::from);
    let terrain = session.scene().terrain();
    let surface = |p: DVec3| terrain.and_then(|t| t.surface_at(p.truncate())).unwrap_or(0.0);
    for share in [0.35, 0.45, 0.55, 0.65, 0.75] {
        let ray = view.ray(DVec2::new(0.5 * w, share * h));
        let points = ray.samples(1.0, 15_000.0, 40).flatten().map(|p| p.point).take_while(|p| p.z > surface(*p));
        let name = if share == 0.35 { "rays of the middle column" } else { "" };
        curves.push(Curve::new(name, points.map(|p| section.place(p)).collect(), BLUE, Style::Line));
    }
    let Pencil::Parallel { normal } = turn.pencil else { anyhow::bail!("the planes of the scene are not parallel") };
    let plane = |t: DVec3| {
        let at = |z: f64| {
            let foot = (normal.dot(t - section.eye) - normal.z * (z - section.eye.z)) / normal.dot(section.heading);
            (foot / 1000.0, z)
        };
        vec![at(0.0), at(9000.0)]
    };
    for (name, t) in [("planes t0, t1, t2", turn.t0), ("", turn.t1), ("", turn.t2)] {
        curves.push(Curve::new(name, plane(t), RED, Style::Dashes));
    }
    let eyes = vec![section.place(section.eye), section.place(turn.viewpoint)];
    curves.push(Curve::new("eye, and viewpoint after the turn", eyes, DARK, Style::Dots));
    let title = "Curved rays from the side: straight, bent between t0 and t2, straight";
    Ok(chart(title, "distance ahead of the eye, km", "height, m", SeriesLabelPosition::UpperRight, curves))
}

/// The ground of the plane of the camera's heading before and after the bend, and the curve that carries it.
fn spline_bend(session: &Session) -> Result<Chart> {
    let section = Section::of(session);
    let bend = session.view().stages().iter().find_map(|s| match s {
        Stage::SplineBend(bend) => Some(bend),
        _ => None,
    });
    let bend = bend.context("the scene has no spline")?;
    let ground = section.ground(session, 24_000.0);
    let carry = |points: &[DVec3]| points.iter().flat_map(|p| bend.apply(*p)).map(|p| section.place(p)).collect();
    let level: Vec<DVec3> = ground.iter().step_by(8).map(|p| p.with_z(bend.pivot().z)).collect();
    let before = ground.iter().map(|p| section.place(*p)).collect();
    let curves = vec![
        Curve::new("ground after", carry(&ground), AFTER, Style::Filled),
        Curve::new("ground before", before, GROUND, Style::Filled),
        Curve::new("reference plane", level.iter().map(|p| section.place(*p)).collect(), RED, Style::Dashes),
        Curve::new("deformation curve", carry(&level), BLUE, Style::Line),
        Curve::new("eye and pivot", vec![section.place(section.eye), section.place(bend.pivot())], DARK, Style::Dots),
    ];
    let title = "Spline bend from the side: the ground rides on the curve";
    Ok(chart(title, "distance ahead of the eye, km", "height, m", SeriesLabelPosition::LowerRight, curves))
}

/// Lines of sight before and after the greedy pass, both passes of the paper, and the quadratic program.
fn terrain(options: &OpenOptions) -> Result<[Chart; 3]> {
    let area = Area::open(Path::new("figure.toml"), Some(TERRAIN), options)?;
    let profiles = Profile::all(&area);
    let naive = area.naive_stage(&area.naive(&area.in_mode(SolverMode::Paper)))?;
    let paper = area.solve(&area.in_mode(SolverMode::Paper), &area.view)?.stage;
    let program = area.solve(&area.in_mode(SolverMode::Qp), &area.view)?.stage;
    let worst = profiles.first().context("nothing that must be seen is in view")?;
    let greedy = vec![Curve::new("after the greedy pass", worst.ground(Some(&naive)), DARK, Style::Line)];
    // The profile whose line of sight the ground touches most often.
    let touches = profiles.iter().rev().map(|p| (touches(p, &program), p)).max_by_key(|(touches, _)| touches.len());
    let (active, tightest) = touches.unwrap_or((Vec::new(), worst));
    let active = vec![Curve::new("active rows: the ground touches the line", active, RED, Style::Dots)];
    let mut charts = [
        worst.chart("Greedy pass: mountain by mountain is shifted and scaled", &naive, Vec::new()),
        worst.chart("Smooth pass: cliffs become slopes", &paper, greedy),
        tightest.chart("Visibility program: the least bending that clears every line of sight", &program, active),
    ];
    charts.iter_mut().for_each(|c| c.legend = SeriesLabelPosition::LowerLeft);
    Ok(charts)
}

/// Samples at which the displaced ground comes within 4 m of the line of sight, the nearest of each stretch.
fn touches(profile: &Profile<'_>, stage: &TerrainDisocclusion) -> Vec<(f64, f64)> {
    let (ground, sight) = (profile.ground(Some(stage)), profile.line_of_sight(Some(stage)));
    let ((_, eye), (far, point)) = (sight[0], sight[1]);
    // Near the reference point the ground is left out: there it is the point's own slope.
    let clearance =
        |p: (f64, f64)| if p.0 < 0.95 * far { eye + (point - eye) * p.0 / far - p.1 } else { f64::INFINITY };
    let least = |w: &[(f64, f64)]| clearance(w[1]) < 4.0 && clearance(w[1]) <= clearance(w[0]).min(clearance(w[2]));
    ground.windows(3).filter(|w| least(w)).map(|w| w[1]).collect()
}

/// Triangles drawn of the same mountains in three resolutions, against the permitted error.
fn level_of_detail(options: &OpenOptions) -> Result<Chart> {
    let mut curves = Vec::new();
    for (size, color) in [(1025, BLUE), (513, AFTER), (257, RED)] {
        let text = SPLINE_BEND.replace("?seed=7", &format!("?seed=7&size={size}"));
        let session = Session::from_text(Path::new("figure.toml"), &text, options)?;
        let (scene, view, light) = (session.scene(), session.view(), session.light());
        let renderer = CpuRenderer::default();
        let drawn = |lod_px: f64| -> Result<(f64, f64)> {
            let quality = RenderOptions { lod_px, samples: 1, marks: false, ..RenderOptions::default() };
            let job = RenderJob { scene, view, light, options: &quality, progress: &options.progress };
            Ok((lod_px, renderer.render(&job)?.stats.triangles_drawn as f64 / 1000.0))
        };
        let points = (0..=8).map(|i| drawn(f64::from(i) / 2.0)).collect::<Result<_>>()?;
        curves.push(Curve::new(&format!("ground of {size} x {size} nodes"), points, color, Style::Line));
    }
    let title = "Level of detail: triangles drawn follow the picture, not the ground";
    Ok(chart(
        title,
        "permitted error of a block, pixels",
        "thousand triangles",
        SeriesLabelPosition::UpperRight,
        curves,
    ))
}

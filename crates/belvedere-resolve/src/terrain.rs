//! Terrain disocclusion from an intent: parameters, solver, and the document with its defaults.

use super::camera::ResolvedCamera;
use super::solving::Solving;
use crate::BelvedereError;
use belvedere_core::{DVec3, Pinhole, Stage, View};
use belvedere_core::{Warning, WarningKind};
use belvedere_disocclusion::DisocclusionError;
use belvedere_disocclusion::report::{FeatureCost, PriceReport, Spike, Taken, UnresolvedReason, UnresolvedRun};
use belvedere_disocclusion::rivers::RIVER_TOLERANCE_M;
use belvedere_disocclusion::{
    Detail, Solved, SolverMode, TerrainReport, TerrainSettings, TerrainSolver, ViewpointOptions,
};
use belvedere_document::{
    DetailDoc, PointDoc, SolverMode as ModeDoc, SourceDocument, StageDoc, Table, TerrainStageDoc,
};
use belvedere_scene::Scene;

/// Checks the ranges of the parameters of a document.
pub fn check(doc: &TerrainStageDoc) -> Result<(), (&'static str, String)> {
    if let Err(DisocclusionError::Setting { key, value, range }) = TerrainSolver::new(settings(doc)?) {
        return Err((key, DisocclusionError::Setting { key, value, range }.to_string()));
    }
    match doc.adjust_viewpoint {
        Some(slider) if !(0.0..=1.0).contains(&slider) => {
            Err(("adjust_viewpoint", format!("adjust_viewpoint is {slider}, it must be in 0..=1")))
        }
        _ => Ok(()),
    }
}

/// The parameters of a document.
pub fn settings(doc: &TerrainStageDoc) -> Result<TerrainSettings, (&'static str, String)> {
    let usual = TerrainSettings::default();
    let cells = match doc.cells {
        Some(n) if !(n >= 1.0 && n.fract() == 0.0 && n <= 1e9) => {
            return Err(("cells", format!("cells is {n}, it must be a whole number of at least 1")));
        }
        other => other.map(|n| n as usize),
    };
    Ok(TerrainSettings {
        mode: match doc.mode {
            Some(ModeDoc::Paper) => SolverMode::Paper,
            Some(ModeDoc::PaperQp) => SolverMode::PaperQp,
            Some(ModeDoc::Qp) | None => SolverMode::Qp,
        },
        cells,
        spacing: doc.spacing.unwrap_or(usual.spacing),
        lift_m: doc.lift_m,
        guard: doc.guard.unwrap_or(usual.guard),
        eta: doc.eta.unwrap_or(usual.eta),
        mu: doc.mu.unwrap_or(usual.mu),
        mu_dev: doc.mu_dev.unwrap_or(usual.mu_dev),
        w: doc.w,
        rows_weight: doc.rows_weight.unwrap_or(usual.rows_weight),
        gamma_time_s: doc.gamma_time_s.unwrap_or(usual.gamma_time_s),
        solver_nodes: doc.solver_nodes.map_or(usual.solver_nodes, |n| n as usize),
        detail: doc.detail.map(|d| match d {
            DetailDoc::Scaled => Detail::Scaled,
            DetailDoc::Plain => Detail::Plain,
        }),
        rise_limit_m: doc.rise_limit_m.unwrap_or(usual.rise_limit_m),
        margin_m: doc.margin_m.unwrap_or(usual.margin_m),
        candidates: doc.candidates.unwrap_or(usual.candidates),
        ahead_m: doc.ahead_m,
        limits: doc.limits.unwrap_or(usual.limits),
        spikes: doc.spikes.unwrap_or(usual.spikes),
        rivers: doc.rivers.clone(),
        show: doc.show,
        move_at_most_m: doc.move_at_most_m,
        slack_price: doc.slack_price,
    })
}

/// The document with every default filled in.
pub fn document(settings: &TerrainSettings, scene: &Scene) -> TerrainStageDoc {
    TerrainStageDoc {
        delta: None,
        delta_sha256: None,
        mode: Some(match settings.mode {
            SolverMode::Paper => ModeDoc::Paper,
            SolverMode::PaperQp => ModeDoc::PaperQp,
            SolverMode::Qp => ModeDoc::Qp,
        }),
        cells: settings.cells.or_else(|| scene.terrain().map(|t| settings.cells_on(t))).map(|n| n as f64),
        spacing: Some(settings.spacing),
        lift_m: settings.lift_m,
        guard: Some(settings.guard),
        eta: Some(settings.eta),
        mu: Some(settings.mu),
        mu_dev: Some(settings.mu_dev),
        w: settings.w.or_else(|| scene.terrain().map(|t| settings.smoothness_on(t))),
        rows_weight: Some(settings.rows_weight),
        gamma_time_s: Some(settings.gamma_time_s),
        solver_nodes: Some(settings.solver_nodes as u32),
        detail: Some(match settings.detail() {
            Detail::Scaled => DetailDoc::Scaled,
            Detail::Plain => DetailDoc::Plain,
        }),
        rise_limit_m: Some(settings.rise_limit_m),
        margin_m: Some(settings.margin_m),
        candidates: Some(settings.candidates),
        ahead_m: settings.ahead_m,
        limits: Some(settings.limits),
        spikes: Some(settings.spikes),
        rivers: settings.rivers.clone(),
        show: settings.show,
        move_at_most_m: settings.move_at_most_m,
        slack_price: settings.slack_price,
        adjust_viewpoint: None,
    }
}

/// Time for judging and drawing, as a multiple of the time before solving.
const DRAWING: f64 = 3.0;
/// Share of the remaining time for adjusting the camera.
const ADJUSTING: f64 = 0.4;

/// Bytes of a node of the ground while it is solved, at least: its cell, heights, moves, and the systems of the smooth pass.
const NODE_BYTES: u64 = 64;

/// Asks for the memory of solving the ground of a scene.
pub fn ask(scene: &Scene) -> Result<(), BelvedereError> {
    let nodes = scene.terrain().map_or(0, |t| t.cols() as u64 * t.rows() as u64);
    belvedere_io::budget::ask("solving the ground", nodes * NODE_BYTES).map_err(BelvedereError::Memory)
}

/// Solves the intent for the picture of `base` (earth and later stages).
pub(super) fn solve(
    settings: TerrainSettings,
    scene: &Scene,
    base: &View,
    solving: &mut Solving<'_>,
    at: Table<'_>,
) -> Result<Solved, BelvedereError> {
    let mut solver = TerrainSolver::new(settings).map_err(|e| match &e {
        DisocclusionError::Setting { key, .. } => at.error(&[*key], &e),
        _ => at.error(&[], &e),
    })?;
    if let Some(seconds) = solving.time_step_s {
        solver = solver.with_time_step(seconds);
    }
    ask(scene)?;
    Ok(solver.solve(scene, base, &mut solving.memory.terrain, &solving.progress.before(DRAWING))?)
}

/// Moves the camera if the scene allows it and less ground then moves; films keep their cameras.
pub(super) fn adjust(
    source: &SourceDocument,
    scene: &Scene,
    camera: &mut ResolvedCamera,
    earth: Vec<Stage>,
    solving: &mut Solving<'_>,
    warnings: &mut Vec<Warning>,
) -> Result<(), BelvedereError> {
    let wanted = source.document.stage.iter().enumerate().find_map(|(i, stage)| match stage {
        StageDoc::TerrainDisocclusion(doc) if doc.delta.is_none() => Some((i, doc, doc.adjust_viewpoint?)),
        _ => None,
    });
    // At 1 the camera stays where it is.
    let moves = wanted.filter(|(.., slider)| *slider < 1.0 && solving.time_step_s.is_none());
    let Some((index, doc, slider)) = moves else { return Ok(()) };
    let at = Table { origin: &source.origin, list: "stage", index };
    let fail = |key: &str, reason: String| at.error(&[key], reason);
    let Some(target) = camera.look_at else {
        let reason =
            "adjust_viewpoint needs a point that the camera keeps looking at; give look_at in place of the angles";
        return Err(fail("adjust_viewpoint", reason.into()).into());
    };
    let settings = settings(doc).map_err(|(key, reason)| fail(key, reason))?;
    let solver = TerrainSolver::new(settings)?;
    let view = View::new(camera.pinhole.clone(), earth).map_err(|e| source.error(&["stage"], e))?;
    let options = ViewpointOptions { slider, ..ViewpointOptions::default() };
    let found = solver.adjust(scene, &view, target, &options, &solving.progress.part(ADJUSTING))?;
    let Some(found) = found.filter(|f| f.moved_m > 0.0) else { return Ok(()) };
    let from = &camera.pinhole;
    let up = DVec3::from_array(source.document.camera.up);
    camera.pinhole = Pinhole::look_at(found.eye, target, up, from.projection, from.image, from.near, from.far)
        .map_err(|e| fail("adjust_viewpoint", e.to_string()))?;
    camera.document.eye = PointDoc::Scene(found.eye.to_array());
    let text = format!(
        "terrain_disocclusion: adjust_viewpoint moved the eye by {:.0} m; the energy of the ground's displacement falls from {:.3e} to {:.3e}",
        found.moved_m, found.energy[0], found.energy[1]
    );
    let warning = of_solver(WarningKind::Moved, text).with("moved_m", found.moved_m);
    warnings.push(warning.with("energy_before", found.energy[0]).with("energy", found.energy[1]));
    Ok(())
}

/// Hidden share of the features in view above which a warning is given.
const WORTH_SAYING: f64 = 0.005;
/// Displacement below the lowest ground, as a share of the relief, and excess of slopes over the terrain's own, degrees, beyond which
/// the ground looks implausible.
const IMPLAUSIBLE_SHARE: f64 = 0.2;
const IMPLAUSIBLE_DEG: f64 = 5.0;
/// Largest number of spikes that a warning names.
const SPIKES_NAMED: usize = 3;

/// A warning about the stage.
fn of_solver(kind: WarningKind, text: String) -> Warning {
    Warning::new(kind, text).about("terrain_disocclusion")
}

/// Warnings about a solution: one sentence each.
pub fn remarks(solved: &Solved, scene: &Scene) -> Vec<Warning> {
    let report = &solved.report;
    let mut out = Vec::new();
    let points: usize = report.unresolved.iter().map(|r| r.points).sum();
    if points > 0 {
        let mut why: Vec<String> = report
            .unresolved
            .iter()
            .filter_map(|r| serde_json::to_value(r).ok()?.get("reason")?.as_str().map(|s| s.replace('_', " ")))
            .collect();
        why.sort();
        why.dedup();
        let text = format!(
            "terrain_disocclusion: {points} points cannot be shown ({}); the report names them",
            why.join(", ")
        );
        out.push(of_solver(WarningKind::Hidden, text).with("points", points as f64));
    }
    if report.out_of_time {
        let text = format!(
            "terrain_disocclusion: the solver was out of time and ended with the best ground it had{}; give it more time",
            match report.taken {
                Some(Taken::Unmoved) => ", that which did not move".into(),
                Some(Taken::FrameBefore) => ", that of the frame before".into(),
                Some(Taken::Sample { every }) => format!(", solved for one of {every} of the points"),
                Some(Taken::SinglePass) => ", that of the greedy and the smooth pass".into(),
                Some(Taken::Unfinished) | None => String::new(),
            }
        );
        out.push(of_solver(WarningKind::Limited, text));
    }
    let hidden = 1.0 - report.metrics.visible_dense;
    if hidden > WORTH_SAYING && report.parameters.mode != SolverMode::Paper {
        let text = format!(
            "terrain_disocclusion: {:.1} % of what is in view stays hidden, by {:.1} m of ground at most; the report names the parts \
             under {}",
            100.0 * hidden,
            report.metrics.hidden_worst_m,
            if report.parameters.slack_price.is_some() {
                "`covered` and `hidden`"
            } else {
                "`unresolved` and `hidden`"
            }
        );
        let warning = of_solver(WarningKind::Hidden, text).with("hidden_share", hidden);
        out.push(warning.with("hidden_worst_m", report.metrics.hidden_worst_m));
    }
    out.extend(report.price.as_ref().and_then(|price| given_up(price, report)));
    out.extend(held(report));
    out.extend(confined(report));
    out.extend(implausible(report, scene));
    out.extend(spiky(&report.spikes));
    if report.asked == 0 {
        out.push(nothing_asked(report.parameters.ahead_m));
    }
    out
}

/// Warning that stretches were given up at the stated price or for the landscape, or that the price is higher all the same.
fn given_up(price: &PriceReport, report: &TerrainReport) -> Option<Warning> {
    let (all, paid) = (price.curve.first()?, Some(&price.taken).filter(|taken| taken.asked < 1.0)?);
    let TerrainSettings { show, move_at_most_m, .. } = report.parameters;
    let why = match (show, move_at_most_m) {
        (None, None) => "so that the landscape stays like itself: the ground moves".into(),
        _ => "so that the ground moves".to_owned(),
    };
    let more = match move_at_most_m {
        Some(most) if paid.max_m > most => ", which is more than is allowed: show a smaller share",
        None if show.is_none() => "; show = 1 shows all, whatever it costs",
        _ => "",
    };
    let higher = report.higher_eye.map_or_else(String::new, |eye| {
        format!("; an eye {:.0} m higher would save {:.0} % of the displacement for all", eye.up_m, 100.0 * eye.saves)
    });
    let text = format!(
        "terrain_disocclusion: {:.1} % of the features in view were given up, {why} by {:.0} m at most instead of {:.0} m ({:.1} m rms \
         instead of {:.1} m){higher}{more}; the report names them under `price`",
        100.0 * (1.0 - paid.asked),
        paid.max_m,
        all.max_m,
        paid.rms_m,
        all.rms_m,
    );
    let warning = Warning::new(WarningKind::Limited, text).about("terrain_disocclusion").settled_by("show");
    Some(warning.with("asked", paid.asked).with("max_m", paid.max_m).with("max_m_for_all", all.max_m))
}

/// Warning that samples of the elevation model stand apart from all their neighbours.
fn spiky(spikes: &[Spike]) -> Option<Warning> {
    let place = |s: &Spike| {
        let (by, side) = ((s.height_m - s.taken_m).abs(), if s.height_m > s.taken_m { "above" } else { "below" });
        format!("{by:.0} m {side} at {:.0},{:.0} ({:.0} m)", s.at[0], s.at[1], s.height_m)
    };
    let places: Vec<String> = spikes.iter().take(SPIKES_NAMED).map(place).collect();
    let more = if spikes.len() > SPIKES_NAMED { ", and more in the report" } else { "" };
    let samples = if spikes.len() == 1 { "1 sample stands".into() } else { format!("{} samples stand", spikes.len()) };
    (!spikes.is_empty()).then(|| {
        let text = format!(
            "terrain_disocclusion: {samples} far from all neighbours, as spikes do that are faults of the elevation model: {}{more}; the ground \
             does not make way for them, and they may hide something; set them to no data, or smooth them, in the elevation model",
            places.join(", ")
        );
        of_solver(WarningKind::Suspect, text).with("samples", spikes.len() as f64)
    })
}

/// Warning that limits of depth or slope keep something hidden.
fn held(report: &TerrainReport) -> Option<Warning> {
    let limits = report.limited?;
    let hidden = 1.0 - report.metrics.visible_dense;
    let by_limits = |run: &UnresolvedRun| matches!(run.reason, UnresolvedReason::Limits { .. });
    let is_held = report.unresolved.iter().chain(&report.hidden).any(by_limits);
    (is_held && !report.guaranteed).then(|| {
        let text = format!(
            "terrain_disocclusion: not all can be shown on ground that looks like ground, no lower than {:.0} m and no steeper than {:.0} \
             degrees: {:.2} % of what is in view stays hidden, which the report names; look from higher up or elsewhere, or lift the \
             limits (limits = false)",
            limits.floor_m,
            limits.steepest_deg,
            100.0 * hidden
        );
        let warning = of_solver(WarningKind::Limited, text).with("hidden_share", hidden).settled_by("limits");
        warning.with("floor_m", limits.floor_m).with("steepest_deg", limits.steepest_deg)
    })
}

/// Warnings that rivers keep something hidden, or still run uphill.
fn confined(report: &TerrainReport) -> Option<Warning> {
    let hidden = 1.0 - report.metrics.visible_dense;
    if let Some(worst) =
        report.rivers.iter().map(|r| r.excess_m).max_by(f64::total_cmp).filter(|m| *m > RIVER_TOLERANCE_M)
    {
        let text = format!(
            "terrain_disocclusion: a river runs uphill by {worst:.1} m more than on the elevation model; the report names it"
        );
        return Some(of_solver(WarningKind::Suspect, text).with("uphill_m", worst));
    }
    (!report.rivers.is_empty() && hidden > 0.0 && !report.guaranteed).then(|| {
        let text = format!(
            "terrain_disocclusion: {:.2} % of what is in view stays hidden where no river may run uphill; leave rivers out, or look from \
             higher up or elsewhere",
            100.0 * hidden
        );
        of_solver(WarningKind::Limited, text).with("hidden_share", hidden)
    })
}

/// Warning that the displaced ground looks implausible, with the feature that needs it.
fn implausible(report: &TerrainReport, scene: &Scene) -> Option<Warning> {
    let m = &report.metrics;
    let relief = scene.terrain().map_or(0.0, |t| t.z_range()[1] - t.z_range()[0]);
    let mut what = Vec::new();
    if m.sunk_below_m > IMPLAUSIBLE_SHARE * relief {
        what.push(format!(
            "the ground sinks to {:.0} m below the lowest of the terrain, whose relief is {relief:.0} m",
            m.sunk_below_m
        ));
    }
    if m.steepest_deg > m.steepest_before_deg + IMPLAUSIBLE_DEG {
        what.push(format!(
            "slopes become as steep as {:.0} degrees, those of the terrain are {:.0} at most",
            m.steepest_deg, m.steepest_before_deg
        ));
    }
    if what.is_empty() {
        return None;
    }
    let name = |cost: &FeatureCost| {
        let layer = &scene.layers[cost.layer];
        let name = layer.kind.feature_name(cost.feature);
        let name = name.map_or_else(|| format!("feature {}", cost.feature), |n| format!("\"{n}\""));
        format!("{name} of layer \"{}\" ({:.0} %)", layer.id, 100.0 * cost.share)
    };
    let costly: Vec<String> = report.costliest.iter().map(name).collect();
    let most = if costly.is_empty() { String::new() } else { format!("; most of it for {}", costly.join(", ")) };
    let text = format!(
        "terrain_disocclusion: {}{most}; look from higher up or elsewhere (adjust_viewpoint = 0.5 lets the eye move), or leave some out",
        what.join(", and ")
    );
    let warning = of_solver(WarningKind::Moved, text).with("sunk_below_m", m.sunk_below_m).with("relief_m", relief);
    Some(warning.with("steepest_deg", m.steepest_deg).with("steepest_before_deg", m.steepest_before_deg))
}

/// Warning that there was nothing to solve, with the reason.
fn nothing_asked(ahead_m: Option<f64>) -> Warning {
    let (limit, remedy) = match ahead_m {
        Some(m) => {
            (format!(" up to ahead_m = {m} m along their path from the eye"), "give a longer ahead_m or another view")
        }
        None => (String::new(), "give another view"),
    };
    let text = format!(
        "terrain_disocclusion: nothing was asked for: no part of the features lies on the ground in the picture{limit}; the ground \
         stays as it is and nothing is guaranteed; {remedy}"
    );
    of_solver(WarningKind::Suspect, text)
}

//! Resolves the turns of a document to curved rays.

use crate::BelvedereError;
use belvedere_construct::rays::Sidestep;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::split_rays::{Fork, Merge, Seam, SplitSpec};
use belvedere_core::{CurvedRays, DVec3, Pinhole, SplitRays, Stage};
use belvedere_document::DocumentError;
use belvedere_document::{AxisDoc, MergeDoc, RaysStageDoc, SplitDoc, StageDoc, Table, TurnDoc, WayDoc};

/// The stage behind `root`, and its document with every rule replaced by its value.
pub(super) fn resolve(root: &Pinhole, doc: &RaysStageDoc, at: Table<'_>) -> Result<(Stage, StageDoc), BelvedereError> {
    if let Some(split) = &doc.split {
        return parting(root, doc, split, at);
    }
    if doc.turn.is_empty() {
        return Err(at.error(&["turn"], "curved_rays has no turn; give at least one [[stage.turn]]").into());
    }
    let specs = turn_specs(&doc.turn, &[], at)?;
    let rays = CurvedRays::new(root, doc.model, &specs).map_err(|e| at.error(&["turn"], e))?;
    let mut resolved = doc.clone();
    for (turn, computed) in resolved.turn.iter_mut().zip(rays.turns()) {
        // A rule may give a number that files may not state; then the rule is kept.
        if let Some(m) = computed.m.filter(|m| doc.model == Model::Modified && (0.2..=20.0).contains(m)) {
            turn.m = Sharpness::Value(m);
        }
    }
    Ok((Stage::CurvedRays(rays), StageDoc::CurvedRays(resolved)))
}

/// A stage of curved rays that was made valid.
#[derive(Debug, Clone)]
pub struct MendedRays {
    /// The stage.
    pub stage: RaysStageDoc,
    /// Near distance of the camera, scene units.
    pub near: f64,
    /// What was wrong, in words, in the order in which it was put right.
    pub wrong: Vec<String>,
}

/// A valid stage near one of a document, behind `root`; `None` where there is none, and for rays that part.
pub fn mended(root: &Pinhole, doc: &RaysStageDoc) -> Option<MendedRays> {
    if doc.split.is_some() {
        return None;
    }
    let specs: Vec<TurnSpec> = doc.turn.iter().map(|turn| stated(turn, root)).collect();
    let made = CurvedRays::mended(root, doc.model, &specs)?;
    let turn = made.rays.spec().iter().zip(&doc.turn).map(|(spec, own)| match stated(own, root) == *spec {
        true => TurnDoc { m: spec.m, ..own.clone() },
        false => turn_doc(spec),
    });
    let stage = RaysStageDoc { model: made.rays.model(), turn: turn.collect(), split: None };
    let wrong = made.changes.iter().map(ToString::to_string).collect();
    Some(MendedRays { stage, near: made.rays.root().near, wrong })
}

/// A turn as it is stated, in range or not; planes without a line or normal are parallel, across the axis.
fn stated(doc: &TurnDoc, root: &Pinhole) -> TurnSpec {
    let pencil = match (&doc.line, doc.normal) {
        (Some(AxisDoc { point, dir }), _) => {
            Pencil::Line { point: DVec3::from_array(*point), dir: DVec3::from_array(*dir) }
        }
        (None, Some(normal)) => Pencil::Parallel { normal: DVec3::from_array(normal) },
        (None, None) => Pencil::Parallel { normal: root.forward },
    };
    let [viewpoint, t0, t1, t2] = [doc.viewpoint, doc.t0, doc.t1, doc.t2].map(DVec3::from_array);
    TurnSpec { viewpoint, t0, t1, t2, pencil, m: doc.m }
}

/// Resolves rays that part.
fn parting(
    root: &Pinhole,
    doc: &RaysStageDoc,
    split: &SplitDoc,
    at: Table<'_>,
) -> Result<(Stage, StageDoc), BelvedereError> {
    let turns = turn_specs(&doc.turn, &[], at)?;
    let spec = SplitSpec { turns, fork: Some(Box::new(fork(split, &["split"], at)?)) };
    let rays = SplitRays::new(root, doc.model, &spec).map_err(|e| at.error(&["split"], e))?;
    let WayDoc { turn, split } = way_doc(rays.spec());
    let resolved = RaysStageDoc { model: doc.model, turn, split: split.map(|split| *split) };
    Ok((Stage::SplitRays(rays), StageDoc::CurvedRays(resolved)))
}

/// * `path`: path of the split within the stage.
fn fork(doc: &SplitDoc, path: &[&str], at: Table<'_>) -> Result<Fork, BelvedereError> {
    let way = |name: &str, way: &WayDoc| -> Result<SplitSpec, BelvedereError> {
        let path = [path, &[name]].concat();
        let fork = match &way.split {
            Some(split) => Some(Box::new(fork(split, &[&path[..], &["split"]].concat(), at)?)),
            None => None,
        };
        Ok(SplitSpec { turns: turn_specs(&way.turn, &path, at)?, fork })
    };
    let seam = doc.seam.map_or(Seam::MIDDLE, |[from, to]| Seam { from: from.into(), to: to.into() });
    let merge = doc.merge.map(|m| Merge { viewpoint: DVec3::from_array(m.viewpoint), reach: m.reach });
    Ok(Fork { seam, sides: [way("left", &doc.left)?, way("right", &doc.right)?], merge })
}

fn way_doc(spec: &SplitSpec) -> WayDoc {
    let split = |fork: &Fork| {
        let [left, right] = &fork.sides;
        let merge = fork.merge.map(|m| MergeDoc { viewpoint: m.viewpoint.to_array(), reach: m.reach });
        let seam = Some([fork.seam.from.to_array(), fork.seam.to.to_array()]);
        Box::new(SplitDoc { seam, left: way_doc(left), right: way_doc(right), merge })
    };
    WayDoc { turn: spec.turns.iter().map(turn_doc).collect(), split: spec.fork.as_deref().map(split) }
}

/// * `path`: path of the table with the turns, within the stage.
fn turn_specs(docs: &[TurnDoc], path: &[&str], at: Table<'_>) -> Result<Vec<TurnSpec>, DocumentError> {
    let way = if path.is_empty() { String::new() } else { format!("{}, ", path.join(".")) };
    let spec = |(j, turn): (usize, &TurnDoc)| {
        let number = j.to_string();
        turn_spec(turn).map_err(|(key, reason)| {
            at.error(&[path, &["turn", &number, key]].concat(), format!("{way}turn {}: {reason}", j + 1))
        })
    };
    docs.iter().enumerate().map(spec).collect()
}

fn turn_spec(doc: &TurnDoc) -> Result<TurnSpec, (&'static str, String)> {
    let pencil = match (doc.line, doc.normal) {
        (Some(AxisDoc { point, dir }), None) => {
            Pencil::Line { point: DVec3::from_array(point), dir: DVec3::from_array(dir) }
        }
        (None, Some(normal)) => Pencil::Parallel { normal: DVec3::from_array(normal) },
        (Some(_), Some(_)) => return Err(("normal", "both line and normal are given; give exactly one".into())),
        (None, None) => return Err((
            "t0",
            "neither line nor normal is given; give the common line of the planes, or the normal of parallel planes"
                .into(),
        )),
    };
    if let Sharpness::Value(m) = doc.m
        && !(0.2..=20.0).contains(&m)
    {
        return Err(("m", format!("m is {m}, it must lie in 0.2..=20; or give \"bend\", \"left\" or \"mid\"")));
    }
    Ok(TurnSpec {
        viewpoint: DVec3::from_array(doc.viewpoint),
        t0: DVec3::from_array(doc.t0),
        t1: DVec3::from_array(doc.t1),
        t2: DVec3::from_array(doc.t2),
        pencil,
        m: doc.m,
    })
}

/// The stage of a single turn with its second viewpoint beside the eye of `root`.
pub fn sidestep_stage(sidestep: &Sidestep, root: &Pinhole) -> RaysStageDoc {
    RaysStageDoc { model: Model::Modified, turn: vec![turn_doc(&sidestep.turn(root))], split: None }
}

fn turn_doc(turn: &TurnSpec) -> TurnDoc {
    let (line, normal) = match turn.pencil {
        Pencil::Line { point, dir } => (Some(AxisDoc { point: point.to_array(), dir: dir.to_array() }), None),
        Pencil::Parallel { normal } => (None, Some(normal.to_array())),
    };
    let [viewpoint, t0, t1, t2] = [turn.viewpoint, turn.t0, turn.t1, turn.t2].map(|p| p.to_array());
    TurnDoc { viewpoint, t0, t1, t2, line, normal, m: turn.m }
}

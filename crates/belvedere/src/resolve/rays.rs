//! From the turns of a document to curved rays.

use crate::BelvedereError;
use crate::scene_file::{AxisDoc, RaysStageDoc, StageDoc, Table, TurnDoc};
use belvedere_construct::rays::Sidestep;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{CurvedRays, DVec3, Pinhole, Stage};

/// The stage behind `root`, and its document with every rule for m replaced by the number it came to.
pub(super) fn resolve(root: &Pinhole, doc: &RaysStageDoc, at: Table<'_>) -> Result<(Stage, StageDoc), BelvedereError> {
    if doc.turn.is_empty() {
        return Err(at.error(&["turn"], "curved_rays has no turn; give at least one [[stage.turn]]"));
    }
    let specs: Vec<TurnSpec> = doc
        .turn
        .iter()
        .enumerate()
        .map(|(j, turn)| {
            turn_spec(turn)
                .map_err(|(key, reason)| at.error(&["turn", &j.to_string(), key], format!("turn {}: {reason}", j + 1)))
        })
        .collect::<Result<_, _>>()?;
    let rays = CurvedRays::new(root, doc.model, &specs).map_err(|e| at.error(&["turn"], e))?;
    let mut resolved = doc.clone();
    for (turn, computed) in resolved.turn.iter_mut().zip(rays.turns()) {
        // A rule may come to a number that a file may not state; then the rule stays.
        if let Some(m) = computed.m.filter(|m| doc.model == Model::Modified && (0.2..=20.0).contains(m)) {
            turn.m = Sharpness::Value(m);
        }
    }
    Ok((Stage::CurvedRays(rays), StageDoc::CurvedRays(resolved)))
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

/// The stage of a second viewpoint beside the eye of `root`.
pub(crate) fn sidestep_stage(sidestep: &Sidestep, root: &Pinhole) -> RaysStageDoc {
    let turn = sidestep.turn(root);
    let (line, normal) = match turn.pencil {
        Pencil::Line { point, dir } => (Some(AxisDoc { point: point.to_array(), dir: dir.to_array() }), None),
        Pencil::Parallel { normal } => (None, Some(normal.to_array())),
    };
    let [viewpoint, t0, t1, t2] = [turn.viewpoint, turn.t0, turn.t1, turn.t2].map(|p| p.to_array());
    RaysStageDoc { model: Model::Modified, turn: vec![TurnDoc { viewpoint, t0, t1, t2, line, normal, m: turn.m }] }
}

//! A volume: a block with a valve in a chamber that opens above.

use crate::easel::{Easel, bent, straight, turns};
use crate::figure_set::Figure;
use anyhow::{Context, Result};
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::{Model, TurnSpec};
use belvedere::{CameraPicture, Session};

const SCENE: &str = include_str!("../../../../scenes/engine_curved_rays.toml");
const TILE: [u32; 2] = [480, 400];

fn scene(easel: &Easel<'_>) -> Result<(Session, TurnSpec)> {
    let session = easel.open(SCENE, TILE)?;
    let [turn] = turns(&session)?[..] else { return None.context("the scene has not one turn") };
    Ok((session, turn))
}

/// The turn with its second viewpoint at a share of the line from the eye.
fn part(session: &Session, turn: &TurnSpec, share: f64) -> TurnSpec {
    TurnSpec { viewpoint: session.view().pinhole().eye.lerp(turn.viewpoint, share), ..*turn }
}

/// From straight to strongly bent.
pub(super) fn curvature(easel: &Easel<'_>) -> Result<Figure> {
    let (session, turn) = scene(easel)?;
    let mut panels = vec![easel.panel(&straight(&session), "Straight rays", "the wall hides the chamber".into())?];
    for share in [0.2, 0.4, 0.6, 0.8, 1.0] {
        let turned = bent(&session, Model::Modified, &[part(&session, &turn, share)])?;
        let [before, after] = [session.view().pinhole().eye, session.view().pinhole().eye.lerp(turn.viewpoint, share)]
            .map(|v| (turn.t1 - v).normalize());
        let angle = before.angle_between(after).to_degrees();
        panels.push(easel.panel(
            &turned,
            &format!("{:.0} % of the way", 100.0 * share),
            format!("rays turn by {angle:.0} degrees"),
        )?);
    }
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}

/// Three stages of planes that draw together, and their rays.
pub(super) fn collapse(easel: &Easel<'_>) -> Result<Figure> {
    let (session, turn) = scene(easel)?;
    let [mut pictures, mut cameras] = [Vec::new(), Vec::new()];
    for (title, share) in [("Planes apart", 1.0), ("Drawn together", 0.4), ("Collapsed: a kink", 0.0)] {
        let draw = |p: DVec3| turn.t1.lerp(p, share);
        let spec = TurnSpec { t0: draw(turn.t0), t2: draw(turn.t2), ..turn };
        let model = if share > 0.0 { Model::Modified } else { Model::C0 };
        let turned = bent(&session, model, &[spec])?;
        let apart = (spec.t2 - spec.t0).length();
        pictures.push(easel.panel(&turned, title, format!("planes {apart:.0} voxels apart"))?);
        let outside = CameraPicture::Outside(Some([[-420.0, -40.0, 190.0], [80.0, -40.0, 110.0]]));
        cameras.push(easel.camera(&turned, outside, title, "the rays from beside".into())?);
    }
    Ok(Figure { panels: pictures.into_iter().chain(cameras).collect(), columns: 3, ..Figure::default() })
}

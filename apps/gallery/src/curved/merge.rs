//! Rays that part before a helix and are one again behind it.

use crate::easel::{Easel, Shown, straight};
use crate::figure_set::{Facts, Figure};
use crate::sheet::Panel;
use anyhow::{Context, Result};
use belvedere::core::DVec2;
use belvedere::{CameraPicture, Session};

pub(crate) const SCENE: &str = include_str!("../../../../scenes/dna_merge.toml");
/// Layer of the required feature.
const BEHIND: &str = "behind";
/// Depths at which the rays on either side of the seam are compared, scene units: between fork and merge, and behind the merge.
const AMID: f64 = 110.0;
const PAST: f64 = 215.0;

/// Straight, round both sides, and the rays.
pub(super) fn round_both_sides(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, [760, 420])?;
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for (title, session) in [("Straight rays", straight(&session)), ("Round both sides", session.clone())] {
        let Shown { share, frame } = easel.shown(&session, BEHIND)?;
        let note = format!("{:.0} % of the marked atoms' picture is seen", 100.0 * share);
        panels.push(Panel { title: title.into(), note, frame });
        seen.push(share);
    }
    panels.push(easel.camera(&session, CameraPicture::Overhead, "Their rays", "apart, and one again".into())?);
    let facts =
        Facts::from([("seam: apart amid", gap(&session, AMID)?), ("seam: apart past the merge", gap(&session, PAST)?)]);
    Ok(Figure { panels, columns: 3, seen, facts, ..Figure::default() })
}

/// Largest distance at a depth between the rays just left and right of the seam in the middle of the picture.
fn gap(session: &Session, depth: f64) -> Result<f64> {
    let [w, h] = session.view().pinhole().image.map(f64::from);
    let at = |x: f64, y: f64| session.view().ray(DVec2::new(x, y)).at(depth).ok().map(|p| p.point);
    let rows = (1..10).map(|k| 0.1 * f64::from(k) * h);
    let gaps = rows.map(|y| Some(at(0.5 * w - 1e-6, y)?.distance(at(0.5 * w + 1e-6, y)?)));
    gaps.collect::<Option<Vec<_>>>().map(|g| g.into_iter().fold(0.0, f64::max)).context("rays of the seam end")
}

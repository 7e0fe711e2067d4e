//! The rays of the street corner, and where they end.

use super::street::TURNS;
use super::town::{CROSSING, ahead_and_right, ahead_on_avenue, both_sides, in_side_street, town, town_for, turn};
use crate::easel::{Easel, bent, ray_points};
use crate::figure_set::{Facts, Figure};
use anyhow::Result;
use belvedere::core::map::curved_rays::Model;
use belvedere::core::{DVec2, DVec3};
use belvedere::sight::trace::Tracer;
use belvedere::{CameraPicture, Session};

/// Size of the panels, pixels; number of rays across the picture; rows in which they start, shares of its height from the horizon down.
const TILE: [u32; 2] = [560, 560];
const ACROSS: u32 = 24;
const ROWS: [f64; 3] = [0.5, 0.55, 0.6];
/// Length of rays that hit nothing, metres.
const FAR: f64 = 300.0;

/// Share of the rays that start within a part of the picture and pass a point for which `there` holds.
///
/// * `part`: shares of the picture's width.
fn reaching(session: &Session, part: [f64; 2], there: &dyn Fn(DVec3) -> bool) -> f64 {
    let (view, tracer) = (session.view(), Tracer::new(session.scene(), session.view()));
    let [w, h] = view.pinhole().image.map(f64::from);
    let [mut all, mut good] = [0, 0];
    for (i, row) in (0..ACROSS).flat_map(|i| ROWS.map(|row| (i, row))) {
        let share = (f64::from(i) + 0.5) / f64::from(ACROSS);
        if share >= part[0] && share < part[1] {
            let points = ray_points(view, &tracer, DVec2::new(w * share, h * row), FAR);
            all += 1;
            good += u32::from(points.into_iter().any(there));
        }
    }
    f64::from(good) / f64::from(all.max(1))
}

/// The cameras of the bent pictures, from above; one of them and the parted one from outside as well.
pub(super) fn rays(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, TILE)?;
    let (mut panels, mut facts) = (Vec::new(), Facts::new());
    let whole = [0.0, 1.0];
    for (title, crossing, side, _) in TURNS {
        let session = bent(&town_for(easel, TILE, crossing)?, Model::Modified, &[turn(crossing, side)])?;
        let share = reaching(&session, whole, &|p| in_side_street(p, crossing, side));
        let note = format!("{:.0} % of the rays reach the side street", 100.0 * share);
        panels.push(easel.camera(&session, CameraPicture::Overhead, title, note)?);
        facts.insert(title, share);
    }
    let both = both_sides(&town)?;
    let [left, right] = [(-1.0, [0.0, 0.5]), (1.0, [0.5, 1.0])]
        .map(|(side, part)| reaching(&both, part, &|p| in_side_street(p, CROSSING, side)));
    let note = format!("{:.0} % of the left and {:.0} % of the right rays reach theirs", 100.0 * left, 100.0 * right);
    panels.push(easel.camera(&both, CameraPicture::Overhead, "Both side streets", note)?);
    let outside = CameraPicture::Outside(Some([[-150.0, -420.0, 300.0], [-151.6, CROSSING, 14.0]]));
    panels.push(easel.camera(&both, outside, "Both side streets", "from outside".into())?);
    let forward = ahead_and_right(&town)?;
    let ahead = reaching(&forward, [0.0, 0.5], &ahead_on_avenue);
    let aside = reaching(&forward, [0.5, 1.0], &|p| in_side_street(p, CROSSING, 1.0));
    let note =
        format!("{:.0} % of the left rays go on ahead, {:.0} % of the right ones aside", 100.0 * ahead, 100.0 * aside);
    panels.push(easel.camera(&forward, CameraPicture::Overhead, "Forward and right together", note)?);
    for (name, share) in [("both: left", left), ("both: right", right), ("ahead", ahead), ("aside", aside)] {
        facts.insert(name, share);
    }
    Ok(Figure { panels, columns: 3, facts, ..Figure::default() })
}

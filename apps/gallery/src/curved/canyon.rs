//! A river in a canyon, previewed.

use crate::easel::{Easel, above, turns as specs, with_lines};
use crate::figure_set::{Facts, Figure};
use anyhow::{Context, Result};
use belvedere::construct::{self, MeasureOptions};
use belvedere::core::map::curved_rays::{Pencil, TurnSpec};
use belvedere::core::{DVec2, DVec3};
use belvedere::scene::{Color, Frame, Progress};
use belvedere::{CameraPicture, Session};

const SCENE: &str = include_str!("../../../../scenes/canyon_preview.toml");
/// Lines of the scene file that give length and position of the preview, metres.
const LENGTH: &str = "preview_m = 4000.0";
const POSITION: &str = "position_m = 4500.0";
const START: f64 = 4500.0;

/// The scene with another length of preview, metres.
fn ahead(easel: &Easel<'_>, length: f64, image: [u32; 2]) -> Result<Session> {
    anyhow::ensure!(SCENE.contains(LENGTH), "the canyon's scene does not say {LENGTH}");
    easel.open(&SCENE.replace(LENGTH, &format!("preview_m = {length:.1}")), image)
}

/// Shares of the distance to the first turn at which the pictures of [`collapse`] are taken.
const WAYS: [f64; 4] = [0.0, 0.5, 0.8, 0.95];
/// For `collapse`: length of the preview, metres; its lens, given so that none is searched for; distance in plan, metres, from which on
/// two bend points count as different turns.
const SHORT: f64 = 1500.0;
const LENS: &str = "lens = { behind_m = 1500.0, width_m = 375.0, rise_m = 150.0 }\n";
const SAME: f64 = 60.0;
/// Ground shown around the turn, metres; rays drawn; colours of them and of the planes where they begin and end to bend.
const AROUND: f64 = 520.0;
const RAYS: u32 = 9;
const RAY: Color = Color::rgb(230, 150, 0);
const BEFORE: Color = Color::rgb(0, 96, 168);
const AFTER: Color = Color::rgb(200, 60, 130);

/// Caption of a preview, and the visible length of the river, metres.
fn note(session: &Session) -> Result<(String, f64)> {
    let turns = bends(session)?.len();
    let options = MeasureOptions::default();
    let measures = construct::measure(session.scene(), session.view(), None, &options, &Progress::silent())?;
    let seen = measures.lines.context("the scene has no river")?.bent.sight.visible;
    Ok((format!("{turns} turns; {seen:.0} m of the river in sight"), seen))
}

/// The turns of a preview that bend rays aside: all but the one that widens them.
fn bends(session: &Session) -> Result<Vec<TurnSpec>> {
    let all = specs(session)?;
    Ok(all.into_iter().filter(|turn| matches!(turn.pencil, Pencil::Line { .. })).collect())
}

/// Share of the pixels of a picture's lower half that show no layer.
fn sky(frame: &Frame) -> f64 {
    let lower = &frame.id[frame.id.len() / 2..];
    lower.iter().filter(|id| **id == 0).count() as f64 / lower.len().max(1) as f64
}

/// The preview at growing lengths, round one bend after the other.
pub(super) fn preview(easel: &Easel<'_>) -> Result<Figure> {
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for length in [600.0, 1500.0, 2500.0, 4000.0] {
        let session = ahead(easel, length, [640, 360])?;
        let (note, metres) = note(&session)?;
        panels.push(easel.panel(&session, &format!("{length:.0} m ahead"), note)?);
        seen.push(metres);
    }
    let most = panels.iter().map(|panel| sky(&panel.frame)).fold(0.0, f64::max);
    let facts = Facts::from([("sky in the lower half", most)]);
    Ok(Figure { panels, columns: 2, seen, facts, ..Figure::default() })
}

/// The preview as a picture, and the rays of its camera.
pub(super) fn turns(easel: &Easel<'_>) -> Result<Figure> {
    let session = ahead(easel, 1500.0, [1000, 750])?;
    let panels = vec![
        easel.panel(&session, "What it sees", note(&session)?.0)?,
        easel.camera(
            &session,
            CameraPicture::Overhead,
            "The camera from above",
            "rays, planes and viewpoints".into(),
        )?,
    ];
    let facts = Facts::from([("sky in the lower half", sky(&panels[0].frame))]);
    Ok(Figure { panels, columns: 2, facts, ..Figure::default() })
}

/// Positions towards a turn of the river: the planes of the turn draw together until it is passed.
pub(super) fn collapse(easel: &Easel<'_>) -> Result<Figure> {
    let at = |position: f64| -> Result<Session> {
        let text = SCENE.replace(LENGTH, &format!("preview_m = {SHORT:.1}\n{LENS}"));
        anyhow::ensure!(text.contains(POSITION), "the canyon's scene does not say {POSITION}");
        easel.open(&text.replace(POSITION, &format!("position_m = {position:.1}")), [480, 360])
    };
    let first = *bends(&at(START)?)?.first().context("the river turns ahead")?;
    let way = along_river(&at(START)?, first.t1)? - START;
    anyhow::ensure!(way > 0.0, "the first turn lies {way} m ahead");
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for share in WAYS {
        let session = at(START + share * way)?;
        let same = |t: &&TurnSpec| t.t1.truncate().distance(first.t1.truncate()) < SAME;
        let width = bends(&session)?.iter().find(same).map_or(0.0, |t| t.t0.distance(t.t2));
        let title = format!("{:.0} m before the turn", (1.0 - share) * way);
        let note = format!("its planes t0 and t2 are {width:.0} m apart");
        let index = specs(&session)?.iter().position(|t| matches!(t.pencil, Pencil::Line { .. }) && same(&t));
        let marked = with_lines(&session, marks(&session, index));
        panels.push(easel.panel(&above(&marked, first.t1, AROUND)?, &title, note)?);
        seen.push(width);
    }
    Ok(Figure { panels, columns: 2, seen, facts: Facts::from([("way, m", way)]), ..Figure::default() })
}

/// Rays along the middle of the picture up to some way past a turn, and where they pass its planes.
fn marks(session: &Session, turn: Option<usize>) -> Vec<(&'static str, Vec<Vec<DVec3>>, Color, f64)> {
    let view = session.view();
    let [w, h] = view.pinhole().image.map(f64::from);
    let (mut rays, mut planes) = (Vec::new(), [Vec::new(), Vec::new()]);
    for i in 0..RAYS {
        let ray = view.ray(DVec2::new(w * (f64::from(i) + 0.5) / f64::from(RAYS), 0.5 * h));
        let bend = ray.pieces().ok().zip(turn).and_then(|(pieces, j)| Some(pieces.get(2 * j + 1)?.depth));
        let [t0, t2] = bend.unwrap_or([view.pinhole().near; 2]);
        let points = ray.samples(view.pinhole().near, t2 + AROUND, 160).map_while(Result::ok).map(|p| p.point);
        rays.push(points.collect());
        for (plane, depth) in planes.iter_mut().zip([t0, t2]) {
            plane.extend(bend.and(ray.at(depth).ok()).map(|p| p.point));
        }
    }
    let [t0, t2] = planes.map(|plane| if plane.len() > 1 { vec![plane] } else { Vec::new() });
    vec![("rays", rays, RAY, 1.4), ("t0", t0, BEFORE, 4.0), ("t2", t2, AFTER, 4.0)]
}

/// Arc length, metres, of the river's vertex nearest in plan to a point.
fn along_river(session: &Session, place: DVec3) -> Result<f64> {
    let line = session.scene().layers.iter().find_map(|l| l.kind.lines().and_then(|l| l.features.first()));
    let points = &line.context("the scene has no river")?.points;
    let (mut best, mut along) = ((f64::INFINITY, 0.0), 0.0);
    for (i, p) in points.iter().enumerate() {
        along += if i > 0 { p.distance(points[i - 1]) } else { 0.0 };
        let off = p.truncate().distance(place.truncate());
        best = if off < best.0 { (off, along) } else { best };
    }
    Ok(best.1)
}

//! A river in a canyon, previewed.

use crate::easel::{Easel, turns as specs};
use crate::figure_set::{Facts, Figure};
use anyhow::{Context, Result};
use belvedere::construct::{self, MeasureOptions};
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::TurnSpec;
use belvedere::scene::{LayerKind, Progress};
use belvedere::{CameraPicture, Session};

const SCENE: &str = include_str!("../../../../scenes/canyon_preview.toml");
/// What the scene says about the preview, metres.
const LENGTH: &str = "preview_m = 4000.0";
const POSITION: &str = "position_m = 4500.0";
const START: f64 = 4500.0;

/// The scene with another length of preview, metres.
fn ahead(easel: &Easel<'_>, length: f64, image: [u32; 2]) -> Result<Session> {
    anyhow::ensure!(SCENE.contains(LENGTH), "the canyon's scene does not say {LENGTH}");
    easel.open(&SCENE.replace(LENGTH, &format!("preview_m = {length:.1}")), image)
}

/// The part of the way to the first turn at which each picture of [`collapse`] is taken.
const WAYS: [f64; 4] = [0.0, 0.5, 0.8, 0.95];
/// Length of its preview; its lens, so that none has to be searched for; turns as far apart in plan are another turn. Metres.
const SHORT: f64 = 1500.0;
const LENS: &str = "lens = { behind_m = 1500.0, width_m = 375.0, rise_m = 150.0 }\n";
const SAME: f64 = 60.0;

/// What is said of a preview, and metres of the river that it shows.
fn note(session: &Session) -> Result<(String, f64)> {
    let turns = session.view().curved_rays().context("the preview bends no rays")?.turn_count();
    let options = MeasureOptions::default();
    let measures = construct::measure(session.scene(), session.view(), None, &options, &Progress::silent())?;
    let seen = measures.lines.context("the scene has no river")?.bent.sight.visible;
    Ok((format!("{turns} turns; {seen:.0} m of the river in sight"), seen))
}

/// Further and further round the bends.
pub(super) fn preview(easel: &Easel<'_>) -> Result<Figure> {
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for length in [600.0, 1500.0, 2500.0, 4000.0] {
        let session = ahead(easel, length, [640, 360])?;
        let (note, metres) = note(&session)?;
        panels.push(easel.panel(&session, &format!("{length:.0} m ahead"), note)?);
        seen.push(metres);
    }
    Ok(Figure { panels, columns: 2, seen, ..Figure::default() })
}

/// Picture and rays of one camera.
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
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}

/// From position to position towards a turn of the river: its planes draw together until it is passed.
pub(super) fn collapse(easel: &Easel<'_>) -> Result<Figure> {
    let at = |position: f64| -> Result<Session> {
        let text = SCENE.replace(LENGTH, &format!("preview_m = {SHORT:.1}\n{LENS}"));
        anyhow::ensure!(text.contains(POSITION), "the canyon's scene does not say {POSITION}");
        easel.open(&text.replace(POSITION, &format!("position_m = {position:.1}")), [640, 480])
    };
    let first = *specs(&at(START)?)?.first().context("the river turns ahead")?;
    let way = along_river(&at(START)?, first.t1)? - START;
    anyhow::ensure!(way > 0.0, "the first turn lies {way} m ahead");
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for share in WAYS {
        let session = at(START + share * way)?;
        let same = |t: &&TurnSpec| t.t1.truncate().distance(first.t1.truncate()) < SAME;
        let width = specs(&session)?.iter().find(same).map_or(0.0, |t| t.t0.distance(t.t2));
        let title = format!("{:.0} m before the turn", (1.0 - share) * way);
        let note = format!("its planes are {width:.0} m apart");
        panels.push(easel.camera(&session, CameraPicture::Overhead, &title, note)?);
        seen.push(width);
    }
    Ok(Figure { panels, columns: 2, seen, facts: Facts::from([("way, m", way)]), ..Figure::default() })
}

/// Arc length of the point of the river nearest to a place in plan, metres.
fn along_river(session: &Session, place: DVec3) -> Result<f64> {
    let line = session.scene().layers.iter().find_map(|l| match &l.kind {
        LayerKind::Line(l) => l.features.first(),
        _ => None,
    });
    let points = &line.context("the scene has no river")?.points;
    let (mut best, mut along) = ((f64::INFINITY, 0.0), 0.0);
    for (i, p) in points.iter().enumerate() {
        along += if i > 0 { p.distance(points[i - 1]) } else { 0.0 };
        let off = p.truncate().distance(place.truncate());
        best = if off < best.0 { (off, along) } else { best };
    }
    Ok(best.1)
}

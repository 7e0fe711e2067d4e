//! A strip along a road, unrolled.

use super::bent::TILE;
use crate::easel::{Easel, straight};
use crate::figure_set::Figure;
use anyhow::{Context, Result};
use belvedere::core::map::straighten::Strip;
use belvedere::core::{DVec2, DVec3, Pinhole, Projection, Stage, View};

const SCENE: &str = include_str!("../../../../scenes/massif_strip.toml");

/// The picture stage by stage, and the plan of the strip at three shares of its unrolling.
pub(super) fn unrolled(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, TILE)?;
    let strip = session.view().stages().iter().find_map(|s| match s {
        Stage::Strip(strip) => Some(strip),
        _ => None,
    });
    let strip = strip.context("the scene has a strip")?;
    let alone = View::new(session.view().pinhole().clone(), vec![Stage::Strip(strip.clone())])?;
    let width = format!("{:.1} km to both sides of the road", strip.half_width() / 1000.0);
    let mut panels = vec![
        easel.panel(&straight(&session), "Straight", "the road winds out of sight".into())?,
        easel.panel(&session.clone().with_view(alone), "The road unrolled", width)?,
        easel.panel(&session, "and space bent", "a progressive preset after the strip".into())?,
    ];
    for (share, title) in [(0.0, "The strip where it is"), (0.5, "Half unrolled"), (1.0, "Unrolled")] {
        let view = plan(strip, share, session.view().pinhole().image)?;
        panels.push(easel.panel(&session.clone().with_view(view), title, "from above, in one scale".into())?);
    }
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}

/// The strip unrolled by a share, from straight above; the same picture extent for all three shares.
fn plan(strip: &Strip, share: f64, image: [u32; 2]) -> Result<View> {
    let at = |share: f64| Strip::new(strip.line().clone(), strip.half_width(), share, strip.anchor());
    let shapes = [0.0, 0.5, 1.0].map(at).into_iter().collect::<Result<Vec<_>, _>>()?;
    let places: Vec<DVec2> = shapes.iter().flat_map(|s| s.unrolled().positions()).collect();
    let (low, high) = places.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (middle, size) = (0.5 * (low + high), high - low + 3.0 * strip.half_width());
    let height = size.y.max(size.x * f64::from(image[1]) / f64::from(image[0]));
    let above = Pinhole::look_at(
        middle.extend(30_000.0),
        middle.extend(0.0),
        DVec3::Y,
        Projection::Orthographic { height },
        image,
        1.0,
        None,
    )?;
    Ok(View::new(above, vec![Stage::Strip(at(share)?)])?)
}

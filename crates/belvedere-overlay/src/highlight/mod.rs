//! Highlights of the bend: displacement of points in the picture, the part of the chain that moves them, points that the straight picture
//! hides, and straight positions of required features.
//!
//! Source: the highlighting of displaced subsets proposed for curved rays; here for every chain of stages, since it is measured with the
//! straight camera, in which the point that a pixel shows has another image and another depth.

mod ghosts;
mod legend;
mod outline;
mod shift;
#[cfg(test)]
mod tests;

pub use ghosts::GhostRecord;
pub use outline::{border, regions, spread};

use super::heat;
use belvedere_composite::canvas::Canvas;
use belvedere_core::View;
use belvedere_document::{HighlightMark, OverlayDoc};
use belvedere_scene::{Frame, Scene};
use serde::Serialize;
use shift::{Parts, Straight, Survey};

/// Colours of parts, told apart with any colour vision (Okabe, Ito 2008); longer chains take theirs from the ramp.
const PART_COLORS: [[u8; 3]; 7] =
    [[230, 159, 0], [86, 180, 233], [0, 158, 115], [204, 121, 167], [213, 94, 0], [0, 114, 178], [240, 228, 66]];

/// Share of a part's colour in a pixel that it hardly moves, 0..=1, so that small displacements are visible too.
const LEAST_TINT: f32 = 0.4;

/// Figures of the highlights of a picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct HighlightRecord {
    /// Marks that were drawn.
    pub marks: Vec<HighlightMark>,
    /// Distance at the upper end of the colours, pixels.
    pub ramp_px: f64,
    /// Largest distance between the bent and the straight image of the point at a pixel, pixels; of points in both pictures.
    pub max_px: f64,
    /// Mean of that distance over these pixels.
    pub mean_px: f64,
    /// Share of the pixels with a surface whose point the straight picture hides, 0..=1; null unless it was measured.
    pub revealed_share: Option<f64>,
    /// Share of those whose point lies outside the straight picture, or behind its camera.
    pub outside_share: Option<f64>,
    /// The parts of the chain, in order of application.
    pub parts: Vec<PartRecord>,
    /// Bent and straight positions of required features.
    pub ghosts: Vec<GhostRecord>,
}

/// A part of the chain: a stage, or a turn of curved rays.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartRecord {
    /// Name of the part.
    pub name: String,
    /// Colour of the part, sRGB.
    pub color: [u8; 3],
    /// Share of the pixels with a surface that it moves by more than a pixel, 0..=1.
    pub share: f64,
    /// Share drawn in its colour: its stage moved them farthest, and it is the last turn of curved rays that reaches them.
    pub shown_share: f64,
    /// Largest displacement by this part, pixels, from the image after the parts before it; of points in the bent and the straight picture.
    pub max_px: f64,
}

/// Pictures without marks from which highlights are computed.
pub struct Bare<'a> {
    /// Bent, without marks, with exact world positions.
    pub bent: &'a Frame,
    /// Straight, without marks; needed for [`HighlightMark::Revealed`].
    pub straight: Option<&'a Frame>,
}

/// Draws `marks` over `frame`.
/// * `ramp_px`: distance at the upper end of the colours, pixels, > 0.
pub fn paint(
    frame: &mut Frame,
    bare: &Bare<'_>,
    scene: &Scene,
    view: &View,
    marks: &[HighlightMark],
    ramp_px: f64,
) -> HighlightRecord {
    let parts = Parts::of(view);
    let survey = shift::survey(&parts, bare.bent, bare.straight);
    let (moved, mut record) = (&survey.pixels, record(&parts, &survey, marks, ramp_px));
    let wants = |mark| marks.contains(&mark);
    if wants(HighlightMark::Shift) || wants(HighlightMark::Stages) {
        let by_stage = wants(HighlightMark::Stages);
        for ((color, bare), moved) in frame.color.iter_mut().zip(&bare.bent.color).zip(moved) {
            // A mark changes every pixel, except those that it hardly touches.
            let Some(moved) = moved.filter(|_| color == bare) else { continue };
            let share = (f64::from(moved.px) / ramp_px).min(1.0);
            *color = match moved.part.and_then(|part| record.parts.get(usize::from(part))) {
                Some(part) if by_stage => of_part(*color, part.color, LEAST_TINT + (1.0 - LEAST_TINT) * share as f32),
                None if by_stage => of_part(*color, [0; 3], 0.0),
                _ => heat::tinted(*color, heat::ramp(share)),
            };
        }
    }
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    if wants(HighlightMark::Revealed) {
        let hidden: Vec<bool> = moved.iter().map(|m| m.is_some_and(|m| m.straight == Straight::Hidden)).collect();
        outline::draw(&mut canvas, &hidden, frame.width);
    }
    if wants(HighlightMark::GhostBox) {
        record.ghosts = ghosts::draw(&mut canvas, scene, view, parts.straight());
    }
    record
}

/// Draws the legend of [`paint`]; `above`: height at the lower rim that is already occupied, pixels.
pub fn legend(canvas: &mut Canvas<'_>, record: &HighlightRecord, above: f64) {
    legend::draw(canvas, record, above);
}

/// The marks to draw, and whether the heat map is drawn; the caller's choice overrides the scene's.
///
/// # Errors
/// In words, if the caller asks for two ways to colour surfaces.
pub fn chosen(
    (asked, asked_heatmap): (&[HighlightMark], bool),
    scene: &OverlayDoc,
) -> Result<(Vec<HighlightMark>, bool), &'static str> {
    if let Some(reason) = conflict(asked, asked_heatmap) {
        return Err(reason);
    }
    let colours = |m: &HighlightMark| matches!(m, HighlightMark::Shift | HighlightMark::Stages);
    if asked.is_empty() {
        let marks = scene.highlight.iter().copied().filter(|m| !(asked_heatmap && colours(m)));
        return Ok((marks.collect(), asked_heatmap || scene.heatmap));
    }
    Ok((asked.to_vec(), asked_heatmap || (scene.heatmap && !asked.iter().any(colours))))
}

/// Conflict between marks, in words; `None` if they can be drawn together.
pub fn conflict(marks: &[HighlightMark], heatmap: bool) -> Option<&'static str> {
    let wants = |mark| marks.contains(&mark);
    match (wants(HighlightMark::Shift), wants(HighlightMark::Stages), heatmap) {
        (true, true, _) => Some("highlights \"shift\" and \"stages\" both colour the surfaces; choose one"),
        (true, _, true) => Some("the heat map and highlight \"shift\" both colour the surfaces; choose one"),
        (_, true, true) => Some("the heat map and highlight \"stages\" both colour the surfaces; choose one"),
        _ => None,
    }
}

fn record(parts: &Parts, survey: &Survey, marks: &[HighlightMark], ramp_px: f64) -> HighlightRecord {
    let seen = || survey.pixels.iter().flatten();
    let share = |count: usize| count as f64 / seen().count().max(1) as f64;
    let distances = || seen().filter(|m| m.in_both).map(|m| f64::from(m.px));
    let with = |straight: Straight| share(seen().filter(|m| m.straight == straight).count());
    let many = parts.names.len() > PART_COLORS.len();
    let part = |(k, name): (usize, &String)| {
        let shown = seen().filter(|m| m.part.map(usize::from) == Some(k)).count();
        let (reached, max_px) = survey.parts[k];
        let color = if many { heat::ramp(k as f64 / (parts.names.len() - 1) as f64) } else { PART_COLORS[k] };
        PartRecord { name: name.clone(), color, share: share(reached), shown_share: share(shown), max_px }
    };
    let looked = marks.contains(&HighlightMark::Revealed);
    HighlightRecord {
        marks: marks.to_vec(),
        ramp_px,
        max_px: distances().fold(0.0, f64::max),
        mean_px: distances().sum::<f64>() / distances().count().max(1) as f64,
        revealed_share: looked.then(|| with(Straight::Hidden)),
        outside_share: looked.then(|| with(Straight::Outside)),
        parts: parts.names.iter().enumerate().map(part).collect(),
        ghosts: Vec::new(),
    }
}

/// Grey without displacement, the colour of the part at the end of the ramp.
fn of_part(color: [u8; 3], part: [u8; 3], share: f32) -> [u8; 3] {
    let light = 255.0 * heat::light(color);
    let full = heat::tinted(color, part).map(f32::from);
    full.map(|full| (light + share * (full - light)).round() as u8)
}

/// Scale of line widths: 1 for a picture 720 high.
fn scale(canvas: &Canvas<'_>) -> f64 {
    (canvas.size().y / 720.0).max(0.4)
}

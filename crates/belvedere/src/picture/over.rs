//! What lies over a picture beside its marks: legends, the inset, furniture and the mark of bent pictures.

use super::displacement::DisplacementReport;
use super::furniture::made_ground;
use super::options::PictureOptions;
use super::plan::Plan;
use super::sidecar::OverlayRecord;
use crate::Session;
use crate::scene_file::Inset;
use belvedere_composite::canvas::Canvas;
use belvedere_overlay::highlight::HighlightRecord;
use belvedere_overlay::{badge, curve_inset, heat, highlight};

/// Distance between legends, pixels.
const GAP: f64 = 10.0;

/// What was measured in a picture for its legends.
#[derive(Debug, Default)]
pub(super) struct Measured {
    pub(super) displacement: Option<DisplacementReport>,
    /// Displacement at the upper end of the heat map, scene units.
    pub(super) heatmap_max: Option<f64>,
    pub(super) highlight: Option<HighlightRecord>,
}

/// Everything over the pixels of a picture.
pub(super) struct Over<'a> {
    plan: &'a Plan<'a>,
    heatmap_max: Option<f64>,
    highlight: Option<HighlightRecord>,
    inset: Option<(Inset, curve_inset::CurveFigure)>,
    mark: Option<String>,
}

impl<'a> Over<'a> {
    /// * `size`: of the picture, pixels.
    pub(super) fn new(plan: &'a Plan<'a>, measured: Measured, size: [usize; 2]) -> Self {
        let Measured { displacement, heatmap_max, highlight } = measured;
        let asked = plan.session.resolved.overlay.inset;
        let inset = asked.and_then(|inset| Some((inset, curve_inset::CurveFigure::of(&plan.view)?)));
        // Small pictures have no room for it.
        let has_room = |figure: &curve_inset::CurveFigure| {
            draw_inset(Canvas::recording(&mut Vec::new(), size), figure, plan.request)
        };
        let inset = inset.filter(|(_, figure)| has_room(figure));
        let mark = mark_words(plan.session, plan.request, size, displacement);
        Self { plan, heatmap_max, highlight, inset, mark }
    }

    /// Draws kind after kind, each on a canvas that `on` provides.
    pub(super) fn draw(&self, mut on: impl FnMut(&'static str, &dyn Fn(Canvas<'_>))) {
        let request = self.plan.request;
        on("legend", &|canvas| {
            let mut canvas = canvas.scaled(request.density);
            if let Some(most) = self.heatmap_max {
                heat::legend(&mut canvas, most);
            }
            if let Some(record) = &self.highlight {
                let taken = if self.heatmap_max.is_some() { heat::LEGEND_HEIGHT + GAP } else { 0.0 };
                highlight::legend(&mut canvas, record, taken);
            }
        });
        on("inset", &|canvas| {
            if let Some((_, figure)) = &self.inset {
                draw_inset(canvas, figure, request);
            }
        });
        for (name, shapes) in &self.plan.furniture.kinds {
            on(name, &|mut canvas| shapes.iter().for_each(|shape| canvas.put(shape)));
        }
        on("mark", &|mut canvas| {
            if let Some(words) = &self.mark {
                badge::draw(&mut canvas, words, request.density);
            }
        });
    }

    /// What the picture's record says of it.
    pub(super) fn record(&self) -> OverlayRecord {
        let wanted = &self.plan.wanted;
        OverlayRecord {
            edges: Some(wanted.stylisation.edges).filter(|strength| *strength > 0.0),
            unsharp: Some(wanted.stylisation.unsharp).filter(|strength| *strength > 0.0),
            mark: self.mark.is_some(),
            mark_words: self.mark.clone(),
            inset: self.inset.as_ref().map(|(inset, _)| *inset),
            grid: wanted.grid,
            heatmap_max: self.heatmap_max,
            ghost: wanted.ghost,
            highlight: self.highlight.clone(),
            camera: None,
        }
    }
}

/// Words of the mark of a bent picture, if it has one.
fn mark_words(
    session: &Session,
    request: &PictureOptions,
    size: [usize; 2],
    displacement: Option<DisplacementReport>,
) -> Option<String> {
    let [width, height] = size.map(|pixels| (pixels as f64 / request.density) as usize);
    match displacement {
        _ if !session.resolved.overlay.mark || request.no_mark || !badge::fits(width, height) => None,
        _ if request.steady_mark => Some(badge::WORDS.to_owned()),
        moved => moved.map(|moved| badge::words(width, moved.max_m, session.scene().unit, made_ground(session))),
    }
}

/// Draws the curve of a spline; whether the picture is large enough.
fn draw_inset(canvas: Canvas<'_>, figure: &curve_inset::CurveFigure, request: &PictureOptions) -> bool {
    // Its letters are of one size in windows of every density; on paper they are lengths.
    curve_inset::draw(&mut canvas.scaled(if request.print.is_some() { request.density } else { 1.0 }), figure)
}

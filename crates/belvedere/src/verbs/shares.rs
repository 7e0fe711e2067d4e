//! One figure for the visible share of features in each picture.

use belvedere_construct::Measures;
use belvedere_construct::measure::Shares;
use belvedere_disocclusion::TerrainReport;

/// Largest difference between two measures of one picture of ground for which the judge's figure is reported.
const ONE_FIGURE: f64 = 0.005;

/// Shares of the whole features straight and bent: one figure for each picture, see [`MeasureReport::visible`](super::measure::MeasureReport::visible).
pub(super) fn shares(measures: &Measures, terrain: Option<&TerrainReport>) -> Option<[Shares; 2]> {
    let [straight, mut bent] = measures.shares()?;
    let judged = terrain.filter(|t| t.judged_every == 1).map(|t| t.metrics.visible_dense);
    // The judge knows the ground alone: where other layers hide, or a surface is required, lines of sight give less.
    if let (Some(share), Some(judged)) = (bent.visible_in_frame(), judged)
        && (judged - share).abs() <= ONE_FIGURE
    {
        bent.visible = judged * bent.in_frame;
    }
    Some([straight, bent])
}

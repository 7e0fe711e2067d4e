//! Scores of pictures: composition, and what they show.

use super::evaluate::Evaluation;

/// Share of the picture's height that the sky takes up, least and most: a little within what painters leave (12 to 25 %).
const SKY: [f64; 2] = [0.14, 0.23];
/// Tilt of the skyline that costs nothing, and what each degree over it costs.
const LEVEL_DEG: f64 = 1.0;
const PER_DEGREE: f64 = 0.2;
/// Share of its width that the features take up.
pub(super) const WIDTH: [f64; 2] = [0.61, 0.79];

/// Score of a picture by its composition, whatever it hides: the whole of the features in it, large, on ground of the data that its cells
/// can carry, under a horizon.
pub(super) fn composition(a: &Evaluation) -> f64 {
    let [least, most] = SKY;
    let sky = 16.0 * (least - a.skyline).max(0.0) + 4.0 * (a.skyline - most).max(0.0);
    let fill = (0.45 - a.spread).max(0.0) + 2.0 * (a.spread - 0.85).max(0.0);
    // Beyond the rim of the data sky shows below the horizon, too.
    let beyond = (a.skyline / least).min(1.0);
    let without = 1.5 * (0.02 - a.horizon).clamp(0.0, 0.5) * (1.0 - 0.7 * beyond);
    frame(a) - sky - without - 0.5 * fill
}

/// The part of [`composition`] that a bend changes little: it turns the ground up and down, so that it brings the horizon into the picture and
/// spreads the features over its height, but moves nothing sideways.
pub(super) fn frame(a: &Evaluation) -> f64 {
    let void = 1.0 - a.covered;
    let outside = 4.0 * (1.0 - a.in_frame) + 6.0 * (0.97 - a.in_frame).max(0.0);
    let [narrow, wide] = WIDTH;
    let width = 0.35 * (a.width / 0.7).min(1.0) - 2.2 * (narrow - a.width).max(0.0) - 4.5 * (a.width - wide).max(0.0);
    0.25 * (a.drawn / 0.8).min(1.0) + width + 0.15 * a.rise.clamp(-1.0, 1.0)
        - outside
        - 3.0 * (a.in_frame - a.in_margin)
        - 6.0 * void.min(0.15)
        - 5.0 * (void - 0.15).max(0.0)
        - 5.0 * (a.slant - 0.035).max(0.0)
        - PER_DEGREE * (a.tilt_deg - LEVEL_DEG).clamp(0.0, 6.0)
        - 0.01 * (a.coarse_px - 32.0).clamp(0.0, 40.0)
}

/// Score of a straight picture that hides nothing.
pub(super) const UNBENT: f64 = 0.2;

/// Score of a straight picture in which nothing is hidden, or hardly anything: it wins over a bent one that is a little better.
pub(super) fn unbent(a: &Evaluation) -> f64 {
    UNBENT * (1.0 - (1.0 - a.visible_in_frame) / 0.05).max(0.0)
}

/// Score of a picture that shows all of the features.
pub(super) const PER_SHARE: f64 = 6.0;

/// Score of what a picture shows: of the whole features, and more and more where much of what it holds is hidden.
pub(super) fn shown(a: &Evaluation) -> f64 {
    PER_SHARE * a.visible - 2.0 * (0.95 - a.visible_in_frame).max(0.0) - 2.0 * (0.8 - a.visible_in_frame).max(0.0)
}

#[cfg(test)]
mod tests;

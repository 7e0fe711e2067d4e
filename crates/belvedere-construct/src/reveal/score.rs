//! Scores of pictures: composition, and what they show.

use super::evaluate::Evaluation;

/// Score of a picture by its composition, whatever it hides: the whole of the features in it, large, on ground of the data that its cells
/// can carry, under a horizon.
pub(super) fn composition(a: &Evaluation) -> f64 {
    let sky = 6.0 * (0.08 - a.skyline).max(0.0) + 2.0 * (a.skyline - 0.20).max(0.0);
    let fill = (0.45 - a.spread).max(0.0) + 2.0 * (a.spread - 0.85).max(0.0);
    frame(a) - sky - 0.5 * fill
}

/// The part of [`composition`] that a bend changes little: it turns the ground up and down, so that it brings the horizon into the picture and
/// spreads the features over its height, but moves nothing sideways.
pub(super) fn frame(a: &Evaluation) -> f64 {
    let void = 1.0 - a.covered;
    let outside = 4.0 * (1.0 - a.in_frame) + 6.0 * (0.97 - a.in_frame).max(0.0);
    0.25 * (a.drawn / 0.8).min(1.0) + 0.35 * (a.width / 0.7).min(1.0) + 0.15 * a.rise.clamp(-1.0, 1.0)
        - outside
        - 1.0 * (a.in_frame - a.in_margin)
        - 4.0 * void.min(0.15)
        - 2.0 * (void - 0.15).max(0.0)
        - 3.0 * (a.slant - 0.05).max(0.0)
        - 0.03 * (a.coarse_px - 8.0).clamp(0.0, 40.0)
}

/// Score of a straight picture in which nothing is hidden, or hardly anything: it wins over a bent one that is a little better.
pub(super) fn unbent(a: &Evaluation) -> f64 {
    0.2 * (1.0 - (1.0 - a.visible_in_frame) / 0.05).max(0.0)
}

/// Score of what a picture shows: of the whole features, and more and more where much of what it holds is hidden.
pub(super) fn shown(a: &Evaluation) -> f64 {
    3.0 * a.visible - 2.0 * (0.95 - a.visible_in_frame).max(0.0) - 2.0 * (0.8 - a.visible_in_frame).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Evaluation = Evaluation {
        in_frame: 1.0,
        in_margin: 1.0,
        visible: 1.0,
        visible_in_frame: 1.0,
        attainable: 1.0,
        spread: 0.5,
        drawn: 1.0,
        covered: 1.0,
        skyline: 0.15,
        slant: 0.04,
        width: 0.8,
        coarse_px: 4.0,
        rise: 0.5,
    };

    #[test]
    fn the_whole_feature_in_the_frame_outweighs_everything_else_about_a_composition() {
        let all = composition(&GOOD);
        let part = Evaluation { in_frame: 0.6, in_margin: 0.6, ..GOOD };
        let poor =
            Evaluation { spread: 0.2, drawn: 0.3, width: 0.4, covered: 0.8, skyline: 0.3, coarse_px: 25.0, ..GOOD };
        assert!(all > composition(&poor) && composition(&poor) > composition(&part));
        let worse = [
            Evaluation { coarse_px: 30.0, ..GOOD },
            Evaluation { skyline: 0.0, ..GOOD },
            Evaluation { slant: 0.3, ..GOOD },
            Evaluation { rise: -0.5, ..GOOD },
            Evaluation { covered: 0.9, ..GOOD },
            Evaluation { drawn: 0.2, ..GOOD },
            Evaluation { width: 0.3, ..GOOD },
            Evaluation { in_frame: 0.95, in_margin: 0.95, ..GOOD },
        ];
        assert!(worse.iter().all(|w| composition(w) < all), "{:?}", worse.map(|w| composition(&w)));
    }

    #[test]
    fn a_bend_brings_the_horizon_but_neither_the_ground_nor_the_width() {
        let steep = Evaluation { skyline: 0.0, spread: 0.2, ..GOOD };
        assert!(frame(&steep) == frame(&GOOD) && composition(&steep) < composition(&GOOD));
        for worse in [Evaluation { covered: 0.7, ..GOOD }, Evaluation { width: 0.2, ..GOOD }] {
            assert!(frame(&worse) < frame(&GOOD), "{worse:?}");
        }
    }

    #[test]
    fn only_a_straight_picture_that_shows_nearly_all_is_preferred_for_being_straight() {
        let of = |visible_in_frame: f64| unbent(&Evaluation { visible_in_frame, ..GOOD });
        assert!(of(1.0) > of(0.98) && of(0.98) > 0.0 && of(0.94) == 0.0);
    }

    #[test]
    fn what_is_hidden_never_gains() {
        for step in 0..100 {
            let (less, more) = (0.01 * f64::from(step), 0.01 * f64::from(step + 1));
            let of = |visible: f64| shown(&Evaluation { visible, visible_in_frame: visible, ..GOOD });
            assert!(of(less) < of(more), "{less}");
        }
    }
}

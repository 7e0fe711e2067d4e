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
    horizon: 0.15,
    slant: 0.04,
    tilt_deg: 0.5,
    width: 0.7,
    coarse_px: 4.0,
    rise: 0.5,
};

#[test]
fn the_whole_feature_in_the_frame_outweighs_everything_else_about_a_composition() {
    let all = composition(&GOOD);
    let part = Evaluation { in_frame: 0.6, in_margin: 0.6, ..GOOD };
    let poor = Evaluation { spread: 0.2, drawn: 0.3, width: 0.4, covered: 0.8, skyline: 0.3, coarse_px: 50.0, ..GOOD };
    assert!(all > composition(&poor) && composition(&poor) > composition(&part));
    let worse = [
        Evaluation { coarse_px: 60.0, ..GOOD },
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

//! A long mast that lies across a transition.

use crate::easel::{Easel, bent, straight, with_boxes};
use crate::figure_set::Figure;
use anyhow::Result;
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::scene::{BoxShape, Color};

const SCENE: &str = include_str!("scenes/mast.toml");
/// Stripes of the mast, and the length of each, metres.
const STRIPES: u32 = 28;
const STRIPE_M: f64 = 10.0;

/// Straight, with a kink, and curved.
pub(super) fn kink_and_curve(easel: &Easel<'_>) -> Result<Figure> {
    let stripe = |k: u32| BoxShape {
        base: DVec3::new(-40.0 + 2.2 * f64::from(k), 40.0 + STRIPE_M * f64::from(k), 24.0),
        size: DVec3::new(9.0, STRIPE_M, 9.0),
        yaw: -0.2165,
        color: if k.is_multiple_of(2) { Color::rgb(206, 48, 40) } else { Color::rgb(246, 242, 234) },
    };
    let session = easel.open(SCENE, [480, 400])?;
    let session = with_boxes(&session, [("mast".to_owned(), (0..STRIPES).map(stripe).collect())]);
    let at = |y: f64| DVec3::new(0.0, y, 30.0);
    let turn = TurnSpec {
        viewpoint: DVec3::new(230.0, 30.0, 260.0),
        t0: at(110.0),
        t1: at(180.0),
        t2: at(250.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let kink = bent(&session, Model::C0, &[turn])?;
    let curve = bent(&session, Model::Modified, &[turn])?;
    let panels = vec![
        easel.panel(&straight(&session), "Straight rays", "the mast as it is".into())?,
        easel.panel(&kink, "C0: rays with a kink", "the mast breaks where the rays do".into())?,
        easel.panel(&curve, "C1: curved rays", "the mast bends as the rays do".into())?,
    ];
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}

//! A car that stands across a transition.

use crate::compare::bent_edges_of;
use crate::easel::{Easel, bent, pixels_of, straight, with_boxes};
use crate::figure_set::{Facts, Figure};
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::Session;
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::scene::{BoxShape, Color};

const SCENE: &str = include_str!("scenes/car.toml");
const CAR: &str = "car";

/// A car of boxes: body, cabin, roof and four wheels, `scale` times 4.4 m long.
pub(super) fn boxes(middle: DVec3, yaw: f64, scale: f64) -> (String, Vec<BoxShape>) {
    let (sin, cos) = yaw.sin_cos();
    let part = |[along, across, up]: [f64; 3], size: [f64; 3], color| BoxShape {
        base: middle + scale * DVec3::new(cos * along - sin * across, sin * along + cos * across, up),
        size: scale * DVec3::from_array(size),
        yaw,
        color,
    };
    let (paint, glass, tyre) = (Color::rgb(246, 190, 30), Color::rgb(44, 54, 66), Color::rgb(36, 36, 38));
    let wheel = |along: f64, across: f64| part([along, across, 0.0], [0.64, 0.22, 0.64], tyre);
    let boxes = vec![
        part([0.0, 0.0, 0.3], [4.4, 1.8, 0.55], paint),
        part([-0.25, 0.0, 0.85], [2.3, 1.6, 0.45], glass),
        part([-0.25, 0.0, 1.3], [2.1, 1.5, 0.1], paint),
        wheel(1.35, 0.85),
        wheel(1.35, -0.85),
        wheel(-1.35, 0.85),
        wheel(-1.35, -0.85),
    ];
    (CAR.to_owned(), boxes)
}

/// The car along straight rays, rays with a kink and curved rays.
pub(super) fn across(easel: &Easel<'_>) -> Result<Figure> {
    let session = with_boxes(&easel.open(SCENE, [480, 400])?, [boxes(DVec3::new(0.0, 10.0, 12.0), 1.15, 1.0)]);
    let at = |y: f64| DVec3::new(0.0, y, 12.6);
    let turn = TurnSpec {
        viewpoint: DVec3::new(9.5, -2.0, 19.0),
        t0: at(5.5),
        t1: at(10.0),
        t2: at(14.5),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let (mut panels, mut facts, mut seen) = (Vec::new(), Facts::new(), Vec::new());
    for (title, name, session) in [
        ("Straight rays", "straight", straight(&session)),
        ("C0: rays with a kink", "kink", bent(&session, Model::C0, &[turn])?),
        ("C1: curved rays", "curved", bent(&session, Model::Modified, &[turn])?),
    ] {
        let edges = bent_edges(&session);
        facts.insert(name, edges);
        let frame = easel.draw(&session)?;
        seen.push(pixels_of(&frame, &session, CAR) as f64);
        let note = format!("edges of the car bend by up to {:.1} % of their length", 100.0 * edges);
        panels.push(Panel { title: title.into(), note, frame });
    }
    Ok(Figure { panels, columns: 3, seen, facts, ..Figure::default() })
}

/// Largest distance of the image of an edge of the car from the chord between its ends, as a share of the chord's length.
fn bent_edges(session: &Session) -> f64 {
    let layers = session.scene().layers.iter().filter(|l| l.id == CAR);
    let boxes = layers.filter_map(|l| l.kind.boxes().map(|layer| &layer.boxes));
    boxes.flatten().map(|shape| bent_edges_of(shape, session.view())).fold(0.0, f64::max)
}

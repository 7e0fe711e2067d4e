//! The town of the figures: vehicles in its streets, and turns at its crossings.

use crate::easel::{Easel, parted, with_boxes};
use anyhow::Result;
use belvedere::Session;
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::scene::{BoxShape, Color};

const SCENE: &str = include_str!("scenes/street.toml");

/// Middle of the avenue, of its crossing and of the next one; the eye stands on the avenue, south of them. Metres.
pub(super) const AVENUE: f64 = -151.6;
pub(super) const CROSSING: f64 = -160.3;
pub(super) const NEXT_CROSSING: f64 = -55.0;
/// Half the width of avenue and streets, from wall to wall, metres.
pub(super) const HALF_STREET: f64 = 18.0;
const EYE: [f64; 2] = [-234.0, 22.0];
const LEVEL: f64 = 20.5;
/// Shift of the second viewpoints to the south, metres: the side streets then stand in the middle of each half of the picture.
const ASIDE: f64 = 6.0;
/// Height of the ground, metres.
const GROUND: f64 = 12.0;

/// Line of the scene file that gives the lens; lenses for turns at the first crossing and at the next one, degrees.
const FOV: &str = "fov_y_deg = 24.0";
const NEAR_FOV: f64 = 24.0;
const FAR_FOV: f64 = 9.0;

/// Layers with a vehicle each.
pub(super) const BUS: &str = "bus";
pub(super) const CAR: &str = "car";
pub(super) const LORRY: &str = "lorry";
pub(super) const TRAM: &str = "tram";

/// A vehicle of one colour with windows all around, `size` long, wide and high.
fn vehicle(id: &str, [x, y]: [f64; 2], yaw: f64, size: [f64; 3], [r, g, b]: [u8; 3]) -> (String, Vec<BoxShape>) {
    let body = |up: f64, size: [f64; 3], color| BoxShape {
        base: DVec3::new(x, y, GROUND + up),
        size: DVec3::from_array(size),
        yaw,
        color,
    };
    let [long, wide, high] = size;
    let window = [long - 0.6, wide + 0.1, 0.25 * high];
    let boxes = vec![
        body(0.4, [long, wide, high - 0.4], Color::rgb(r, g, b)),
        body(0.4 + 0.55 * high, window, Color::rgb(40, 50, 62)),
    ];
    (id.to_owned(), boxes)
}

/// The town with vehicles: in both side streets, in the street of the next crossing, and on the avenue ahead.
///
/// * `fov_deg`: narrower for crossings farther ahead, so that the rays keep between the walls.
fn town_in(easel: &Easel<'_>, image: [u32; 2], fov_deg: f64) -> Result<Session> {
    anyhow::ensure!(SCENE.contains(FOV), "the town's scene does not say {FOV}");
    let scene = SCENE.replace(FOV, &format!("fov_y_deg = {fov_deg:.1}"));
    let (_, car) = super::car::boxes(DVec3::new(-104.0, CROSSING - 1.0, GROUND), -0.75, 1.25);
    Ok(with_boxes(
        &easel.open(&scene, image)?,
        [
            vehicle(BUS, [-196.0, CROSSING - 2.0], 0.9, [12.0, 3.0, 4.2], [200, 40, 36]),
            (CAR.to_owned(), car),
            vehicle(LORRY, [-112.0, NEXT_CROSSING], 0.9, [13.0, 3.4, 5.2], [36, 130, 84]),
            vehicle(TRAM, [AVENUE - 8.0, -92.0], 1.45, [22.0, 3.0, 4.6], [36, 84, 160]),
        ],
    ))
}

/// The town as seen for turns at the first crossing.
pub(super) fn town(easel: &Easel<'_>, image: [u32; 2]) -> Result<Session> {
    town_in(easel, image, NEAR_FOV)
}

/// The town as seen for a turn at a crossing.
pub(super) fn town_for(easel: &Easel<'_>, image: [u32; 2], crossing: f64) -> Result<Session> {
    town_in(easel, image, if crossing > CROSSING { FAR_FOV } else { NEAR_FOV })
}

/// A quarter turn at a crossing, to the west (`side` = -1) or to the east (1).
///
/// The planes share a line beside the frustum; the second viewpoint is as far from the crossing as the eye.
pub(super) fn turn(crossing: f64, side: f64) -> TurnSpec {
    let (eye, up) = (EYE[0], EYE[1]);
    let way = crossing - eye;
    let place = |across: f64, y: f64, z: f64| DVec3::new(AVENUE + side * across, y, z);
    TurnSpec {
        viewpoint: place(-way, crossing, up),
        t0: place(0.0, crossing - 0.2 * way, LEVEL),
        t1: place(0.0, crossing, LEVEL),
        t2: place(13.0, crossing + 10.0, LEVEL),
        pencil: Pencil::Line { point: place(0.38 * way, crossing - 0.35 * way, 0.0), dir: DVec3::Z },
        m: Sharpness::Bend,
    }
}

/// The turn of half a picture.
fn half_turn(side: f64) -> Vec<TurnSpec> {
    let whole = turn(CROSSING, side);
    vec![TurnSpec { viewpoint: whole.viewpoint - ASIDE * DVec3::Y, ..whole }]
}

/// The left half of the picture turns to the west, the right half to the east.
pub(super) fn both_sides(town: &Session) -> Result<Session> {
    parted(town, Model::Modified, [half_turn(-1.0), half_turn(1.0)])
}

/// The left half of the picture goes on along the avenue, the right half turns to the east.
pub(super) fn ahead_and_right(town: &Session) -> Result<Session> {
    parted(town, Model::Modified, [Vec::new(), half_turn(1.0)])
}

/// Whether a point lies in the side street of a crossing, past the walls of the avenue.
pub(super) fn in_side_street(place: DVec3, crossing: f64, side: f64) -> bool {
    side * (place.x - AVENUE) > HALF_STREET && (place.y - crossing).abs() < HALF_STREET
}

/// Whether a point lies on the avenue, past the crossing.
pub(super) fn ahead_on_avenue(place: DVec3) -> bool {
    (place.x - AVENUE).abs() < HALF_STREET && place.y > CROSSING + HALF_STREET
}

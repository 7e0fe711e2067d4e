//! A street corner: what waits in the side streets.

use crate::easel::{Easel, bent, parted, pixels_of, straight, with_boxes};
use crate::figure_set::Figure;
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{DVec2, DVec3};
use belvedere::scene::{BoxShape, Color, Frame};
use belvedere::{CameraPicture, Session};

const SCENE: &str = include_str!("scenes/street.toml");
const TILE: [u32; 2] = [480, 480];

/// Middle of the avenue, of its crossing and of the next one; the eye stands on the avenue, south of them. Metres.
const AVENUE: f64 = -151.6;
const CROSSING: f64 = -160.3;
const NEXT_CROSSING: f64 = -55.0;
const EYE: [f64; 2] = [-262.0, 22.0];
const LEVEL: f64 = 17.0;
/// South of the crossing's middle, metres: as from there the side streets stand in the middle of each half of the picture.
const ASIDE: f64 = 14.6;

/// Differences are drawn this many times as strong.
const STRONGER: u8 = 20;

/// Layers with a vehicle each.
const BUS: &str = "bus";
const VAN: &str = "van";
const LORRY: &str = "lorry";

/// The town with vehicles in side streets.
fn town(easel: &Easel<'_>, image: [u32; 2]) -> Result<Session> {
    let vehicle = |id: &str, [x, y]: [f64; 2], yaw: f64, size: [f64; 3], [r, g, b]: [u8; 3]| {
        let body = |up: f64, size: [f64; 3], color| BoxShape {
            base: DVec3::new(x, y, 12.0 + up),
            size: DVec3::from_array(size),
            yaw,
            color,
        };
        let [long, wide, high] = size;
        let window = [long - 0.6, wide + 0.1, 0.25 * high];
        let boxes = vec![body(0.4, size, Color::rgb(r, g, b)), body(0.4 + 0.55 * high, window, Color::rgb(40, 50, 62))];
        (id.to_owned(), boxes)
    };
    Ok(with_boxes(
        &easel.open(SCENE, image)?,
        [
            vehicle(BUS, [-190.0, CROSSING - 2.0], 1.0, [13.0, 4.4, 7.0], [200, 40, 36]),
            vehicle(VAN, [-112.0, CROSSING + 2.0], -0.9, [10.0, 4.0, 6.0], [246, 190, 30]),
            vehicle(LORRY, [-116.0, NEXT_CROSSING], 0.9, [16.0, 4.8, 8.0], [36, 130, 84]),
        ],
    ))
}

/// A quarter turn at a crossing, to the west (`side` = -1) or to the east (1).
///
/// The planes share a line beside the frustum; the second viewpoint is as far from the crossing as the eye.
fn turn(crossing: f64, side: f64) -> TurnSpec {
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

const TURNS: [(&str, f64, f64, &str); 3] = [
    ("To the left", CROSSING, -1.0, BUS),
    ("To the right", CROSSING, 1.0, VAN),
    ("Forward, then to the right", NEXT_CROSSING, 1.0, LORRY),
];

/// Straight, to the left, to the right, forward and then to the right.
pub(super) fn corners(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, TILE)?;
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    let mut keep = |session: &Session, title: &str, wanted: &[&str]| -> Result<()> {
        let frame = easel.draw(session)?;
        let pixels: usize = wanted.iter().map(|id| pixels_of(&frame, session, id)).sum();
        let note =
            if pixels == 0 { "no vehicle in sight".into() } else { format!("{}: {pixels} pixels", wanted.join(", ")) };
        panels.push(Panel { title: title.into(), note, frame });
        seen.push(pixels as f64);
        Ok(())
    };
    keep(&straight(&town), "Straight rays", &[BUS, VAN, LORRY])?;
    for (title, crossing, side, vehicle) in TURNS {
        keep(&bent(&town, Model::Modified, &[turn(crossing, side)])?, title, &[vehicle])?;
    }
    let both = both_sides(&town)?;
    keep(&both, "Both side streets", &[BUS, VAN])?;
    panels.push(easel.camera(&both, CameraPicture::Overhead, "Their rays", "from above".into())?);
    Ok(Figure { panels, columns: 3, seen })
}

/// The left half of the picture turns to the west, the right half to the east.
fn both_sides(town: &Session) -> Result<Session> {
    let side = |side| {
        let whole = turn(CROSSING, side);
        TurnSpec { viewpoint: whole.viewpoint - ASIDE * DVec3::Y, ..whole }
    };
    parted(town, Model::Modified, [-1.0, 1.0].map(side))
}

/// The cameras of the bent pictures, from outside and from above.
pub(super) fn rays(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, [720, 720])?;
    let mut panels = Vec::new();
    for (title, crossing, side, _) in TURNS {
        let session = bent(&town, Model::Modified, &[turn(crossing, side)])?;
        let outside = CameraPicture::Outside(Some([[-330.0 * side - 100.0, -520.0, 330.0], [AVENUE, crossing, 20.0]]));
        panels.push(easel.camera(&session, outside, title, "from outside".into())?);
        panels.push(easel.camera(&session, CameraPicture::Overhead, title, "from above".into())?);
    }
    let both = both_sides(&town)?;
    let outside = CameraPicture::Outside(Some([[-100.0, -560.0, 420.0], [AVENUE, CROSSING, 20.0]]));
    panels.push(easel.camera(&both, outside, "Both side streets", "from outside".into())?);
    panels.push(easel.camera(&both, CameraPicture::Overhead, "Both side streets", "from above".into())?);
    Ok(Figure { panels, columns: 2, seen: Vec::new() })
}

/// Modified beside original rays of the turn to the left, and the difference of the pictures.
pub(super) fn models(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, TILE)?;
    let turn = turn(CROSSING, -1.0);
    let (modified, original) = (bent(&town, Model::Modified, &[turn])?, bent(&town, Model::Original, &[turn])?);
    let (a, b) = (easel.draw(&modified)?, easel.draw(&original)?);
    let colors = a.color.iter().zip(&b.color).map(|(a, b)| difference(*a, *b)).collect();
    let difference = Frame { color: colors, ..a.clone() };
    let panel = |title: &str, note: String, frame| Panel { title: title.into(), note, frame };
    let [most, mean] = apart(&modified, &original);
    let panels = vec![
        panel("Modified rays", "conic arcs: projection in closed form".into(), a),
        panel("Original rays", "parabolas".into(), b),
        panel(
            "Difference",
            format!("{STRONGER} times as strong; places move by {mean:.1} pixels, {most:.1} at most"),
            difference,
        ),
    ];
    Ok(Figure { panels, columns: 3, seen: Vec::new() })
}

/// White where both are the same.
fn difference(a: [u8; 3], b: [u8; 3]) -> [u8; 3] {
    std::array::from_fn(|k| 255 - a[k].abs_diff(b[k]).saturating_mul(STRONGER))
}

/// Largest and mean distance between the images of a place that is in both pictures, pixels.
fn apart(a: &Session, b: &Session) -> [f64; 2] {
    let [w, h] = a.view().pinhole().image.map(f64::from);
    let (mut most, mut sum, mut count) = (0.0f64, 0.0, 0.0);
    for i in 0..20u32 * 20 * 20 {
        let share = |k: u32| (f64::from(k % 20) + 0.5) / 20.0;
        let pixel = DVec2::new(w * share(i), h * share(i / 20));
        let place = a.view().ray(pixel).at(60.0 + 140.0 * share(i / 400));
        let Some(image) = place.ok().and_then(|p| b.view().project(p.point).ok()) else { continue };
        let off = image.pixel.distance(pixel);
        (most, sum, count) = (most.max(off), sum + off, count + 1.0);
    }
    [most, sum / f64::max(count, 1.0)]
}

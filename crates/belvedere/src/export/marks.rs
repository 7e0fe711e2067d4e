//! Lines as tubes and points as balls, as wide as the picture draws them.

use super::Carrier;
use super::glb::Ball;
use super::ground::linear_of;
use super::sheet::Sheet;
use belvedere_core::{DVec3, Pinhole};
use belvedere_scene::{Color, FeatureStyle, LineLayer, PointLayer};

/// Sides of a tube.
const SIDES: usize = 6;
/// Largest distance between the image of the middle of a piece of line and its drawn middle, pixels.
const TOLERANCE_PX: f64 = 0.25;
/// How often a piece of line is halved at most.
const HALVINGS: usize = 6;

/// The lines of a layer.
pub(super) fn tubes(layer: &LineLayer, carrier: &Carrier<'_>) -> Sheet {
    let mut sheet = Sheet { smooth: true, ..Sheet::default() };
    for feature in &layer.features {
        let (color, scale) = style(feature.style.as_ref(), layer.color);
        let lifted = feature.points.iter().map(|p| *p + layer.lift_m * DVec3::Z);
        for run in runs(lifted, carrier) {
            tube(&mut sheet, &run, 0.5 * scale * layer.width_px, linear_of(color), carrier);
        }
    }
    sheet
}

/// The points of a layer.
pub(super) fn balls(layer: &PointLayer, carrier: &Carrier<'_>, id: &str) -> Vec<Ball> {
    let ball = |(k, feature): (usize, &belvedere_scene::PointFeature)| {
        let at = carrier.carry(feature.position + layer.lift_m * DVec3::Z)?;
        let (color, scale) = style(feature.style.as_ref(), layer.color);
        let radius = 0.5 * scale * layer.size_px * carrier.pixel_at(at)?;
        let name = if feature.name.is_empty() { format!("{id} {}", k + 1) } else { feature.name.clone() };
        Some(Ball { name, layer: id.to_owned(), at, radius, color: linear_of(color) })
    };
    layer.features.iter().enumerate().filter_map(ball).collect()
}

fn style(own: Option<&FeatureStyle>, color: Color) -> (Color, f64) {
    own.map_or((color, 1.0), |own| (own.color.unwrap_or(color), own.scale))
}

/// The displaced line in pieces between points without an image, with points between where the bend curves it.
fn runs(points: impl Iterator<Item = DVec3>, carrier: &Carrier<'_>) -> Vec<Vec<DVec3>> {
    let mut out: Vec<Vec<DVec3>> = Vec::new();
    let mut last: Option<(DVec3, DVec3)> = None;
    for p in points {
        let carried = carrier.carry(p);
        match (last, carried) {
            (Some(from), Some(to)) => {
                if let Some(run) = out.last_mut() {
                    between(from, (p, to), HALVINGS, carrier, run);
                    run.push(to);
                }
            }
            (None, Some(to)) => out.push(vec![to]),
            (_, None) => {}
        }
        last = carried.map(|to| (p, to));
    }
    out.retain(|run| run.len() > 1);
    out
}

fn between(a: (DVec3, DVec3), b: (DVec3, DVec3), left: usize, carrier: &Carrier<'_>, run: &mut Vec<DVec3>) {
    let world = 0.5 * (a.0 + b.0);
    let Some(carried) = carrier.carry(world).filter(|_| left > 0) else { return };
    if is_straight(carrier.view.pinhole(), carried, 0.5 * (a.1 + b.1)) {
        return;
    }
    between(a, (world, carried), left - 1, carrier, run);
    run.push(carried);
    between((world, carried), b, left - 1, carrier, run);
}

fn is_straight(pinhole: &Pinhole, middle: DVec3, drawn: DVec3) -> bool {
    match (pinhole.project(middle), pinhole.project(drawn)) {
        (Ok((a, _)), Ok((b, _))) => (a - b).length() <= TOLERANCE_PX,
        _ => true,
    }
}

/// Adds a tube around a displaced line.
///
/// * `radius_px`: in the picture.
fn tube(sheet: &mut Sheet, line: &[DVec3], radius_px: f64, color: [f32; 3], carrier: &Carrier<'_>) {
    let mut line: Vec<DVec3> = line.to_vec();
    line.dedup_by(|b, a| (*b - *a).length() <= 1e-9 * (1.0 + a.length()));
    if line.len() < 2 {
        return;
    }
    let mut side: Option<DVec3> = None;
    let mut before: Option<[u32; SIDES]> = None;
    for (i, &p) in line.iter().enumerate() {
        let [from, to] = [i.saturating_sub(1), (i + 1).min(line.len() - 1)].map(|k| line[k]);
        // Where a line turns back the direction of one side serves.
        let along = (to - from).try_normalize().or((to - p).try_normalize()).unwrap_or(DVec3::X);
        // The side is carried along, so that the tube does not twist.
        let across = side.map(|s| s - s.dot(along) * along).and_then(DVec3::try_normalize);
        let across = across.unwrap_or_else(|| along.any_orthonormal_vector());
        side = Some(across);
        let other = along.cross(across);
        let radius = radius_px * carrier.pixel_at(p).unwrap_or(0.0);
        let ring: [u32; SIDES] = std::array::from_fn(|k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / SIDES as f64).sin_cos();
            let place = p + radius * (cos * across + sin * other);
            sheet.push(place, Some(place), color)
        });
        if let Some(before) = before {
            for k in 0..SIDES {
                let next = (k + 1) % SIDES;
                sheet.triangles.extend([[before[k], before[next], ring[next]], [before[k], ring[next], ring[k]]]);
            }
        } else {
            cap(sheet, ring, true);
        }
        if i + 1 == line.len() {
            cap(sheet, ring, false);
        }
        before = Some(ring);
    }
}

/// Closes an end of a tube.
fn cap(sheet: &mut Sheet, ring: [u32; SIDES], is_first: bool) {
    for k in 1..SIDES - 1 {
        let [a, b, c] = [ring[0], ring[k], ring[k + 1]];
        sheet.triangles.push(if is_first { [a, c, b] } else { [a, b, c] });
    }
}

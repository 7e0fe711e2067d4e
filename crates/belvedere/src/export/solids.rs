//! Boxes, meshes and the surfaces of molecules.

use super::ground::linear_of;
use super::sheet::Sheet;
use super::{Carrier, ExportOptions, MOST_TRIANGLES};
use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_scene::{Bodies, BoxShape, Color, LayerKind};

/// The displaced triangles of a layer. Rigid bodies are carried as a whole.
pub(super) fn sheet(kind: &LayerKind, carrier: &Carrier<'_>, options: &ExportOptions) -> Result<Sheet, BelvedereError> {
    let bodies = Bodies::of(kind).filter(|_| carrier.view.carries_bodies());
    let (mut loose, mut carried) = (Sheet::default(), Sheet::default());
    // Triangles of a body follow each other, so its view serves many of them.
    let mut last: Option<(usize, Option<belvedere_core::View>)> = None;
    for (t, corners, colors) in triangles(kind) {
        let Some((bodies, body)) = bodies.as_ref().and_then(|bodies| Some((bodies, bodies.of_triangle(t)?))) else {
            add(&mut loose, corners, colors, carrier);
            continue;
        };
        if last.as_ref().is_none_or(|(known, _)| *known != body) {
            let motion = carrier.view.body_motion(bodies.feet()[body]).ok();
            last = Some((body, motion.map(|motion| carrier.view.of_body(motion))));
        }
        if let Some((_, Some(view))) = &last {
            let own = Carrier { view };
            let mut part = Sheet::default();
            add(&mut part, corners, colors, &own);
            carried.append(part.refined(&own, MOST_TRIANGLES, &options.progress)?);
        }
    }
    let mut sheet = loose.refined(carrier, MOST_TRIANGLES, &options.progress)?;
    sheet.append(carried);
    Ok(sheet)
}

/// Corners and colours of all triangles of a layer, with their numbers.
fn triangles(kind: &LayerKind) -> Vec<(usize, [DVec3; 3], [Color; 3])> {
    if let Some(layer) = kind.boxes() {
        let of_box = |(k, shape): (usize, &BoxShape)| {
            let (corners, color) = (shape.corners(), shape.color);
            let outward = BoxShape::TRIANGLES.map(|t| t.map(|corner| corners[corner]));
            (0..outward.len())
                .map(move |i| (BoxShape::TRIANGLES.len() * k + i, outward[i], [color; 3]))
                .collect::<Vec<_>>()
        };
        return layer.boxes.iter().enumerate().flat_map(of_box).collect();
    }
    let Some(layer) = kind.triangles() else { return Vec::new() };
    let mesh = &layer.mesh;
    let one = |t: usize| {
        let corners = mesh.corners(t);
        let footprint = 0.5 * (corners[1] - corners[0]).length();
        let at = |k: usize| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        let color = |k: usize| mesh.surface_color_at(t, at(k), footprint).unwrap_or(layer.color);
        (t, corners, [color(0), color(1), color(2)])
    };
    (0..mesh.triangles().len()).map(one).collect()
}

fn add(sheet: &mut Sheet, corners: [DVec3; 3], colors: [Color; 3], carrier: &Carrier<'_>) {
    let numbers: [u32; 3] =
        std::array::from_fn(|k| sheet.push(corners[k], carrier.carry(corners[k]), linear_of(colors[k])));
    sheet.triangles.push(numbers);
}

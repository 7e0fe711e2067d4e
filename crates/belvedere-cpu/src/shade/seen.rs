//! Colour of what a traced ray meets.

use super::{LayerShade, Shaded, Shader, TerrainShade, box_color};
use crate::exact::{Part, Seen};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::NodeState;

impl Shader<'_> {
    /// What the ray of `pixel` sees: `seen`, or the sky.
    pub(crate) fn shade_seen(&self, view: &View, seen: Option<&Seen>, pixel: DVec2) -> Shaded {
        let Some(seen) = seen else {
            return Shaded { color: self.sky.at(self.lens, pixel), id: 0, world: DVec3::NAN };
        };
        let layer = seen.layer as u32;
        let footprint = self.lens.footprint(seen.depth);
        let (color, id) = match (&self.layers[seen.layer], seen.part) {
            (LayerShade::Terrain(t), Part::Cell(cell, upper)) => {
                let fp = t.ground_per_px(view, seen.point, cell, upper).unwrap_or(footprint);
                t.shade_at(self, seen.point.truncate(), fp.clamp(footprint, 6.0 * footprint), pixel)
            }
            (LayerShade::Boxes(b, light), Part::Face(index, normal)) => match b.boxes.get(index) {
                Some(shape) => (box_color(shape, light, normal, seen.point, footprint), None),
                None => (super::Rgb::ZERO, None),
            },
            (LayerShade::Mesh(m), Part::Triangle(index, front)) => (m.color_at(index, front, seen.point), None),
            _ => (super::Rgb::ZERO, None),
        };
        let color = self.sky.through_air(color, seen.depth as f32);
        Shaded { color, id: id.unwrap_or(layer) + 1, world: seen.point }
    }
}

impl TerrainShade<'_> {
    /// Side of the square on the ground that a pixel covers, scene units: the derivative of the image along the triangle.
    fn ground_per_px(&self, view: &View, p: DVec3, [col, row]: [usize; 2], upper: bool) -> Option<f64> {
        let node = |c: usize, r: usize| {
            let i = r * self.hf.cols() + c;
            (self.hf.states().get(i)? != &NodeState::Void).then(|| f64::from(self.hf.heights()[i]))
        };
        let (nw, se) = (node(col, row)?, node(col + 1, row + 1)?);
        let (east, south) = if upper {
            let ne = node(col + 1, row)?;
            (ne - nw, se - ne)
        } else {
            let sw = node(col, row + 1)?;
            (se - sw, sw - nw)
        };
        let slope = DVec2::new(east, -south) / self.hf.spacing();
        let along = view.jacobian(p).ok()?.map(|g| g.truncate() + slope * g.z);
        let px_per_unit = along[0].perp_dot(along[1]).abs();
        (px_per_unit > 0.0 && px_per_unit.is_finite()).then(|| (1.0 / px_per_unit).sqrt())
    }
}

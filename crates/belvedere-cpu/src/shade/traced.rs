//! Colours of traced hits.

use crate::shade::ground::terrain::TerrainShade;
use crate::shade::{LayerShade, Shaded, Shader};
use belvedere_composite::color::Rgb;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{CellTriangle, NodeState};
use belvedere_sight::trace::{Part, RayHit};

impl Shader<'_> {
    /// Colour, id and point of the hit `seen` on the ray of `pixel`, or of the sky.
    pub(crate) fn shade_hit(&self, view: &View, seen: Option<&RayHit>, pixel: DVec2) -> Shaded {
        let Some(seen) = seen else {
            return Shaded { color: self.sky.at(pixel.as_vec2().to_array()), id: 0, world: DVec3::NAN };
        };
        let (color, id) = self.mixed_at(seen.layer, seen.point, |layer| self.color_of(layer, view, seen, pixel));
        let color = self.sky.through_air(color, seen.depth as f32);
        let faded = self.faded(seen.layer, seen.point.truncate(), pixel.as_vec2().to_array(), color);
        Shaded { color: faded.unwrap_or(color), id, world: seen.point }
    }

    /// Colour and id of a hit, in the colours of a layer that is the same surface.
    fn color_of(&self, layer: usize, view: &View, seen: &RayHit, pixel: DVec2) -> (Rgb, u32) {
        let footprint = self.screen.footprint(seen.depth);
        let sun = |p: DVec3, n: DVec3| self.sun_on(layer, p, n, footprint);
        let (color, id) = match (&self.layers[layer], seen.part) {
            (LayerShade::Terrain(t), Part::Cell(cell, triangle)) => {
                let facing = [DVec2::X * footprint, DVec2::Y * footprint];
                let axes = t.ground_per_px(view, seen.point, cell, triangle).unwrap_or(facing);
                let fp = axes[0].perp_dot(axes[1]).abs().sqrt().clamp(footprint, 6.0 * footprint);
                t.shade_at(self, seen.point.truncate(), fp, axes, seen.depth, pixel)
            }
            (LayerShade::Boxes(b, light), Part::Face(index, normal)) => match b.boxes.get(index) {
                Some(shape) => (self.box_color(layer, shape, light, normal, seen.point, footprint), None),
                None => (Rgb::ZERO, None),
            },
            (LayerShade::Mesh(m), Part::Triangle(index, front)) => {
                (m.color_at(index, front, seen.point, footprint, &sun), None)
            }
            (LayerShade::Molecule(m), Part::Triangle(index, _)) => (m.color_at(index, seen.point), None),
            _ => (Rgb::ZERO, None),
        };
        (color, id.unwrap_or(layer as u32) + 1)
    }
}

impl TerrainShade<'_> {
    /// Displacement on the map per pixel to the right and per pixel down, scene units: the inverse of the image's derivative along the
    /// triangle.
    fn ground_per_px(
        &self,
        view: &View,
        p: DVec3,
        [col, row]: [usize; 2],
        triangle: CellTriangle,
    ) -> Option<[DVec2; 2]> {
        let nw = row * self.hf.cols() + col;
        let nodes = [nw, nw + 1, nw + self.hf.cols(), nw + self.hf.cols() + 1];
        if triangle.corners().iter().any(|&k| self.hf.states()[nodes[k]] == NodeState::Void) {
            return None;
        }
        let per_cell = triangle.slope(nodes.map(|i| f64::from(self.hf.heights()[i])));
        let slope = DVec2::new(per_cell.x, -per_cell.y) / self.hf.spacing();
        let along = view.jacobian(p).ok()?.map(|g| g.truncate() + slope * g.z);
        let area = along[0].perp_dot(along[1]);
        let axes = [DVec2::new(along[1].y, -along[0].y) / area, DVec2::new(-along[1].x, along[0].x) / area];
        (area != 0.0 && axes.iter().all(|a| a.is_finite())).then_some(axes)
    }
}

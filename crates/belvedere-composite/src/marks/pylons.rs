//! Pylons of lifts: where their cables touch one, and the stations at their ends.

use crate::marks::path::{self, LinePoint};
use crate::marks::ribbon::Stroke;
use crate::marks::{MarkBuilder, Marker, Style};
use belvedere_core::DVec3;
use belvedere_scene::{LineFeature, Symbol};

/// Half sizes of the signs of pylons and stations in those of the cable.
const PYLON: f64 = 1.7;
const STATION: f64 = 2.8;
/// Least distance of signs, half widths of the cable.
const APART: f64 = 14.0;

impl MarkBuilder<'_> {
    /// Draws the signs of the pylons of a lift, fewer where they would come too close, and returns the pylons from the ground to the cable.
    ///
    /// * `lift_m`: height of lines above what they lie on; `style`: of the cable.
    pub(super) fn pylons(
        &self,
        lift: &LineFeature,
        (lift_m, style): (f64, Style),
        out: &mut Vec<Stroke>,
    ) -> Vec<Vec<LinePoint>> {
        let Some(ground) = self.scene.terrain() else { return Vec::new() };
        let last = lift.points.len().saturating_sub(1);
        let ends = [0, last].map(|i| lift.points.get(i).copied().unwrap_or_default());
        let mut signed: Option<DVec3> = None;
        let mut pylons = Vec::new();
        for (i, &top) in lift.points.iter().enumerate() {
            let top = top + DVec3::Z * lift_m;
            let foot = ground.surface_at(top.truncate()).map(|z| top.with_z(z + lift_m));
            pylons.extend(foot.map(|foot| path::as_given(&[foot, top])));
            let room = APART * style.half_px * self.screen.pixel_size(top);
            let is_station = i == 0 || i == last;
            let near_end =
                ends.iter().any(|end| end.distance(top) < room) || signed.is_some_and(|p| p.distance(top) < room);
            if near_end && !is_station {
                continue;
            }
            signed = Some(top);
            let (symbol, share) = if is_station { (Symbol::Square, STATION) } else { (Symbol::Dot, PYLON) };
            let half_px = share * style.half_px;
            let marker = Marker { symbol, half_px, casing: style.casing_px.is_some(), hidden: style.hidden };
            self.mark(&LinePoint { p: top, along: 0.0, on_ground: false }, lift_m, marker, out);
        }
        pylons
    }
}

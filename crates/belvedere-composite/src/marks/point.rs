//! Points and their names.

use crate::marks::alike::{self, alike};
use crate::marks::request::LabelRequest;
use crate::marks::path::LinePoint;
use crate::marks::ribbon::{Lane, Stroke, StrokeLayer};
use crate::marks::{HIDDEN_WIDTH, MarkBuilder, Marker, casing_of, darker, inks, symbol, width_or_none};
use crate::screen::BAND;
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{Color, Hidden, OverlayPoint, PointFeature, PointLayer, PointStyle};
use rayon::prelude::*;

impl MarkBuilder<'_> {
    pub(super) fn points(&self, layer: &PointLayer, id: u32, requests: &mut Vec<LabelRequest>) -> Vec<StrokeLayer> {
        let sheet = |group| self.points_alike(layer, group, id, requests);
        alike(&layer.features, layer.color, |f| f.style).into_iter().map(sheet).collect()
    }

    fn points_alike(
        &self,
        layer: &PointLayer,
        group: alike::Alike<'_, PointFeature>,
        id: u32,
        requests: &mut Vec<LabelRequest>,
    ) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(group.scale * layer.size_px);
        let PointStyle { symbol, casing, label_px } = layer.style;
        let marker = Marker { symbol, half_px, casing: casing.is_some(), hidden: layer.hidden };
        let found: Vec<(Vec<Stroke>, Vec<DVec2>)> = group
            .features
            .par_iter()
            .map(|feature| {
                let p = feature.position + DVec3::Z * layer.lift_m;
                let mut strokes = Vec::new();
                let on_line = LinePoint { p, along: 0.0, on_ground: false };
                let named = self.mark(&on_line, layer.lift_m, marker, &mut strokes);
                (strokes, named)
            })
            .collect();
        let mut strokes = Vec::new();
        for (feature, (s, named)) in group.features.iter().zip(found) {
            strokes.extend(s);
            let Some(size_px) = label_px.filter(|_| !feature.name.trim().is_empty()) else { continue };
            requests.extend(
                named
                    .into_iter()
                    .map(|at| label_request(feature.name.trim(), at, marker, (size_px, group.color), self.density)),
            );
        }
        StrokeLayer::new(strokes, inks(group.color, casing, layer.hidden), id, self.screen.height as usize, BAND)
    }

    pub(super) fn overlay_point(&self, point: &OverlayPoint, requests: &mut Vec<LabelRequest>) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(point.size_px);
        let marker = Marker { symbol: point.symbol, half_px, casing: true, hidden: point.hidden };
        let on_line = LinePoint { p: point.position, along: 0.0, on_ground: false };
        let mut strokes = Vec::new();
        let named = self.mark(&on_line, 0.0, marker, &mut strokes);
        if !point.label.is_empty() {
            requests.extend(
                named.into_iter().map(|at| {
                    label_request(&point.label, at, marker, (13.0 * self.density, point.color), self.density)
                }),
            );
        }
        let casing = Some(Color::rgb(255, 255, 255));
        StrokeLayer::new(strokes, inks(point.color, casing, point.hidden), 0, self.screen.height as usize, BAND)
    }

    /// Draws a marker at every image of a point; returns where a name belongs.
    pub(super) fn mark(&self, on_line: &LinePoint, lift_m: f64, marker: Marker, out: &mut Vec<Stroke>) -> Vec<DVec2> {
        let mut named = Vec::new();
        let p = self.sight.on_surface(on_line, lift_m);
        for pass in self.passes_for(std::iter::once(Aabb::of([p; 2]))) {
            let Some(v) = pass.displace(p).map(|d| self.screen.view_from(d)) else { continue };
            if !v.is_finite() || !self.screen.is_drawable(v) || pass.margins(p).iter().any(|m| !(*m >= 0.0)) {
                continue;
            }
            let pixel = self.screen.pixel(v);
            let Some(behind) = self.map.behind(self.screen, pixel, v.z) else { continue };
            let visible = self.sight.sees(self.screen, pixel, v.z).unwrap_or(behind <= 1.5);
            stamp(pixel, marker, (visible, self.density), out);
            if visible || marker.hidden == Hidden::Show {
                named.push(pixel);
            }
        }
        named
    }
}

/// Strokes of a marker.
fn stamp(at: DVec2, marker: Marker, (visible, density): (bool, f64), out: &mut Vec<Stroke>) {
    let Marker { symbol, half_px: half, casing, hidden } = marker;
    let mut put = |half: f64, grow: f64, lane: Lane| out.push(Stroke::symbol(symbol, at, half, grow, lane));
    match (visible, hidden) {
        (true, _) | (false, Hidden::Show) => {
            if casing {
                put(half, casing_of(half, density) - half, Lane::Casing);
            }
            put(half, 0.0, if visible { Lane::Fill } else { Lane::Shown });
        }
        (false, Hidden::Fade) => put(half, 0.0, Lane::Hidden),
        (false, Hidden::Dash) => put(half * HIDDEN_WIDTH, 0.0, Lane::Hidden),
        (false, Hidden::Cut) => {}
    }
}

fn label_request(text: &str, at: DVec2, marker: Marker, (size_px, color): (f64, Color), density: f64) -> LabelRequest {
    let side = marker.half_px + 2.0 * density;
    let above = symbol::top(marker.symbol) * marker.half_px + 2.5 * density;
    LabelRequest { marker: [side, above], leader: true, ..LabelRequest::new(text, at, size_px, darker(color)) }
}

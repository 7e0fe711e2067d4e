//! Points and their names.

use crate::marks::alike::{self, alike};
use crate::marks::drawing::PlacedDrawing;
use crate::marks::path::LinePoint;
use crate::marks::request::LabelRequest;
use crate::marks::ribbon::{Lane, Stroke, StrokeLayer};
use crate::marks::{HIDDEN_WIDTH, MarkBuilder, Marker, casing_of, darker, inks, symbol, width_or_none};
use crate::screen::BAND;
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{Color, Hidden, OverlayPoint, PointFeature, PointLayer, PointStyle, Symbol};
use rayon::prelude::*;

impl MarkBuilder<'_> {
    /// The symbols of a layer; names of points of higher rank come first.
    pub(super) fn points(&self, layer: &PointLayer, id: u32, out: &mut PointMarks) -> Vec<StrokeLayer> {
        let mut named: Vec<(Option<f64>, LabelRequest)> = Vec::new();
        let sheets = alike(&layer.features, layer.color, |f| f.style)
            .into_iter()
            .map(|group| self.points_alike(layer, group, id, (&mut named, &mut out.drawings)))
            .collect();
        // Those without a rank come last, in their order.
        let rank = |rank: Option<f64>| rank.filter(|rank| !rank.is_nan()).unwrap_or(f64::NEG_INFINITY);
        named.sort_by(|a, b| rank(b.0).total_cmp(&rank(a.0)));
        out.requests.extend(named.into_iter().map(|(_, request)| request));
        sheets
    }

    fn points_alike(
        &self,
        layer: &PointLayer,
        group: alike::Alike<'_, PointFeature>,
        id: u32,
        (requests, drawings): (&mut Vec<(Option<f64>, LabelRequest)>, &mut Vec<PlacedDrawing>),
    ) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(group.scale * layer.size_px, self.density);
        let PointStyle { symbol, casing, label_px } = layer.style;
        let is_own = matches!(symbol, Symbol::Own(_));
        let marker_of = |feature: &PointFeature| {
            let symbol = feature.style.and_then(|own| own.symbol).filter(|_| !is_own).unwrap_or(symbol);
            // A drawing has its own rim.
            Marker { symbol, half_px, casing: casing.is_some() && !is_own, hidden: layer.hidden }
        };
        let found: Vec<(Vec<Stroke>, Vec<Seen>)> = group
            .features
            .par_iter()
            .map(|feature| {
                let p = feature.position + DVec3::Z * layer.lift_m;
                let mut strokes = Vec::new();
                let on_line = LinePoint { p, along: 0.0, on_ground: false };
                let named = self.mark_all(&on_line, layer.lift_m, marker_of(feature), &mut strokes);
                (strokes, named)
            })
            .collect();
        let mut strokes = Vec::new();
        for (feature, (s, named)) in group.features.iter().zip(found) {
            let marker = marker_of(feature);
            strokes.extend(s);
            if let Symbol::Own(number) = marker.symbol {
                drawings.extend(named.iter().filter_map(|seen| {
                    let drawing = self.scene.drawings.get(usize::from(number))?.clone();
                    let opacity = seen.opacity(layer.hidden)?;
                    Some(PlacedDrawing { drawing, at: seen.pixel, half_px, color: group.color, opacity })
                }));
            }
            let Some(size_px) = label_px.filter(|_| !feature.name.trim().is_empty()) else { continue };
            let own = feature.style.unwrap_or_default();
            let request = |seen: Seen| {
                let request =
                    label_request(feature.name.trim(), seen.pixel, marker, (size_px, group.color), self.density);
                let second = own.height.map(|height| height.to_string()).unwrap_or_default();
                let skyline = self.skyline.over(seen.pixel, self.density);
                (own.rank, LabelRequest { second, skyline, ..request })
            };
            requests.extend(named.into_iter().filter(|seen| seen.is_named(layer.hidden)).map(request));
        }
        // Under drawings lie discs that are not seen, so that they are found at their pixels.
        let color = if is_own { group.color.with_alpha(0) } else { group.color };
        let inks = inks(color, casing.filter(|_| !is_own), layer.hidden);
        StrokeLayer::new(strokes, inks, id, self.screen.height as usize, BAND)
    }

    pub(super) fn overlay_point(&self, point: &OverlayPoint, requests: &mut Vec<LabelRequest>) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(point.size_px, self.density);
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
        let seen = self.mark_all(on_line, lift_m, marker, out).into_iter();
        seen.filter(|seen| seen.is_named(marker.hidden)).map(|seen| seen.pixel).collect()
    }

    /// Draws a marker at every image of a point, and returns them.
    fn mark_all(&self, on_line: &LinePoint, lift_m: f64, marker: Marker, out: &mut Vec<Stroke>) -> Vec<Seen> {
        let mut all = Vec::new();
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
            all.push(Seen { pixel, visible });
        }
        all
    }
}

/// An image of a point.
#[derive(Debug, Clone, Copy)]
struct Seen {
    pixel: DVec2,
    visible: bool,
}

impl Seen {
    fn is_named(&self, hidden: Hidden) -> bool {
        self.visible || hidden == Hidden::Show
    }

    /// Opacity of a drawing; `None`: it is not drawn.
    fn opacity(&self, hidden: Hidden) -> Option<f32> {
        match hidden {
            _ if self.is_named(hidden) => Some(1.0),
            Hidden::Cut => None,
            _ => Some(FAINT),
        }
    }
}

/// Opacity of drawings behind surfaces.
const FAINT: f32 = 0.4;

/// What point layers add to a picture besides their symbols.
#[derive(Debug, Default)]
pub(super) struct PointMarks {
    pub(super) requests: Vec<LabelRequest>,
    pub(super) drawings: Vec<PlacedDrawing>,
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

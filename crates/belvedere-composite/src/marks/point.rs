//! Points and their names.

use crate::marks::alike::{self, alike};
use crate::marks::drawing::PlacedDrawing;
use crate::marks::path::LinePoint;
use crate::marks::request::{LabelRequest, rank_of};
use crate::marks::ribbon::{Lane, Stroke, StrokeLayer};
use crate::marks::symbols::{PointGroup, PointImage};
use crate::marks::{HIDDEN_WIDTH, MarkBuilder, Marker, casing_of, darker, inks, symbol, width_or_none};
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{Color, FeatureStyle, Hidden, OverlayPoint, PointFeature, PointLayer, PointStyle, ROWS, Symbol};
use rayon::prelude::*;
use std::collections::HashMap;

impl MarkBuilder<'_> {
    /// The images of the points of a layer, by their styles.
    pub(super) fn points(&self, layer: &PointLayer, id: u32) -> Vec<PointGroup> {
        let mut counts = HashMap::new();
        let groups = alike(&layer.features, layer.color, |f| f.style).into_iter();
        groups.map(|group| self.points_alike(layer, group, id, &mut counts)).collect()
    }

    /// * `counts`: how many features of the layer there are of each name.
    fn points_alike(
        &self,
        layer: &PointLayer,
        group: alike::Alike<'_, PointFeature>,
        id: u32,
        counts: &mut HashMap<String, u32>,
    ) -> PointGroup {
        let half_px = 0.5 * width_or_none(group.scale * layer.size_px, self.density);
        let PointStyle { symbol, casing, .. } = layer.style;
        let is_own = matches!(symbol, Symbol::Own(_));
        let marker_of = |feature: &PointFeature| {
            let symbol = feature.style.and_then(|own| own.symbol).filter(|_| !is_own).unwrap_or(symbol);
            // A drawing has its own rim.
            Marker { symbol, half_px, casing: casing.is_some() && !is_own, hidden: layer.hidden }
        };
        let found: Vec<Vec<(Seen, Vec<Stroke>)>> = group
            .features
            .par_iter()
            .map(|feature| {
                let p = feature.position + DVec3::Z * layer.lift_m;
                self.images(&LinePoint { p, along: 0.0, on_ground: false }, layer.lift_m, marker_of(feature))
            })
            .collect();
        let mut images = Vec::new();
        for (feature, found) in group.features.iter().zip(found) {
            let (marker, name) = (marker_of(feature), feature.name.trim());
            let own = feature.style.unwrap_or_default();
            let count = counts.entry(name.to_owned()).or_default();
            *count += 1;
            let number = *count - 1;
            images.extend(found.into_iter().map(|(seen, strokes)| PointImage {
                at: seen.pixel,
                symbol: marker.symbol,
                half_px,
                rank: rank_of(own.rank),
                seen: seen.is_named,
                strokes,
                drawing: self.drawing_of(&seen, marker, layer.hidden, group.color),
                request: self.name_of(name, &seen, (layer, group.color), (marker, own, number)),
            }));
        }
        // Under drawings lie discs that are not seen, so that they are found at their pixels.
        let color = if is_own { group.color.with_alpha(0) } else { group.color };
        PointGroup { id, inks: inks(color, casing.filter(|_| !is_own), layer.hidden), images }
    }

    /// The drawing of the scene's own at an image of a point.
    fn drawing_of(&self, seen: &Seen, marker: Marker, hidden: Hidden, color: Color) -> Option<PlacedDrawing> {
        let Symbol::Own(number) = marker.symbol else { return None };
        let drawing = self.scene.drawings.get(usize::from(number))?.clone();
        Some(PlacedDrawing { drawing, at: seen.pixel, half_px: marker.half_px, color, opacity: seen.opacity(hidden)? })
    }

    /// The name at an image of a point, if the layer writes names.
    ///
    /// * `number`: of the feature among those of its name.
    fn name_of(
        &self,
        name: &str,
        seen: &Seen,
        (layer, color): (&PointLayer, Color),
        (marker, own, number): (Marker, FeatureStyle, u32),
    ) -> Option<LabelRequest> {
        let size_px = layer.style.label_px.filter(|_| !name.is_empty() && self.asks_for(seen))?;
        let request = label_request(name, seen, marker, (size_px, color), self.density);
        let second = own.height.map(|height| height.to_string()).unwrap_or_default();
        let skyline = self.skyline.over(seen.pixel, self.density);
        Some(LabelRequest { second, skyline, number, rank: rank_of(own.rank), ..request })
    }

    /// What is drawn of groups of points: symbols, drawings, and names, those of higher rank first within their layer.
    pub(super) fn drawn_points(&self, groups: Vec<PointGroup>, out: &mut PointMarks) -> Vec<StrokeLayer> {
        let mut names: Vec<LabelRequest> = Vec::new();
        let sheet = |group: PointGroup| {
            let mut strokes = Vec::new();
            for image in group.images {
                strokes.extend(image.strokes);
                out.drawings.extend(image.drawing);
                names.extend(image.request.map(|request| LabelRequest { layer: group.id, ..request }));
            }
            StrokeLayer::new(strokes, group.inks, group.id, self.screen.height as usize, ROWS)
        };
        let sheets = groups.into_iter().map(sheet).collect();
        // Those without a rank come last, in their order.
        names.sort_by(|a, b| a.layer.cmp(&b.layer).then(b.rank.total_cmp(&a.rank)));
        out.requests.append(&mut names);
        sheets
    }

    pub(super) fn overlay_point(&self, point: &OverlayPoint, requests: &mut Vec<LabelRequest>) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(point.size_px, self.density);
        let marker = Marker { symbol: point.symbol, half_px, casing: true, hidden: point.hidden };
        let on_line = LinePoint { p: point.position, along: 0.0, on_ground: false };
        let mut strokes = Vec::new();
        let named = self.mark(&on_line, 0.0, marker, &mut strokes);
        if !point.label.is_empty() {
            requests.extend(named.iter().map(|seen| {
                label_request(&point.label, seen, marker, (13.0 * self.density, point.color), self.density)
            }));
        }
        let casing = Some(Color::rgb(255, 255, 255));
        StrokeLayer::new(strokes, inks(point.color, casing, point.hidden), 0, self.screen.height as usize, ROWS)
    }

    /// Draws a marker at every image of a point; returns where a name belongs.
    pub(super) fn mark(&self, on_line: &LinePoint, lift_m: f64, marker: Marker, out: &mut Vec<Stroke>) -> Vec<Seen> {
        let mut seen = self.mark_all(on_line, lift_m, marker, out);
        seen.retain(|seen| self.asks_for(seen));
        seen
    }

    /// Whether a name is asked for at an image of a point.
    fn asks_for(&self, seen: &Seen) -> bool {
        seen.is_named || self.choice.asks_for_hidden()
    }

    /// Draws a marker at every image of a point, and returns them.
    fn mark_all(&self, on_line: &LinePoint, lift_m: f64, marker: Marker, out: &mut Vec<Stroke>) -> Vec<Seen> {
        let images = self.images(on_line, lift_m, marker).into_iter();
        images
            .map(|(seen, strokes)| {
                out.extend(strokes);
                seen
            })
            .collect()
    }

    /// Every image of a point with the strokes of its marker.
    fn images(&self, on_line: &LinePoint, lift_m: f64, marker: Marker) -> Vec<(Seen, Vec<Stroke>)> {
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
            let mut strokes = Vec::new();
            stamp(pixel, marker, (visible, self.density), &mut strokes);
            let is_named = visible || marker.hidden == Hidden::Show;
            all.push((Seen { pixel, image: all.len() as u32, is_named }, strokes));
        }
        all
    }
}

/// An image of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) pixel: DVec2,
    /// Number of the image among those of the point.
    pub(super) image: u32,
    /// Whether it is visible, or named behind surfaces as well.
    pub(super) is_named: bool,
}

impl Seen {
    /// A name beside it.
    pub(super) fn request(&self, text: impl Into<String>, size_px: f64, color: Color) -> LabelRequest {
        LabelRequest { image: self.image, seen: self.is_named, ..LabelRequest::new(text, self.pixel, size_px, color) }
    }

    /// Opacity of a drawing; `None`: it is not drawn.
    fn opacity(&self, hidden: Hidden) -> Option<f32> {
        match hidden {
            _ if self.is_named => Some(1.0),
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

fn label_request(
    text: &str,
    seen: &Seen,
    marker: Marker,
    (size_px, color): (f64, Color),
    density: f64,
) -> LabelRequest {
    let side = marker.half_px + 2.0 * density;
    let above = symbol::top(marker.symbol) * marker.half_px + 2.5 * density;
    LabelRequest { marker: [side, above], leader: true, ..seen.request(text, size_px, darker(color)) }
}

//! Lines, outlines, points and names, drawn over the surfaces.

mod alike;
mod area_names;
mod dash;
mod distance;
mod face;
mod label;
mod line_of_sight;
mod names;
mod path;
mod pole;
mod ribbon;
mod segment;
mod shown;
mod symbol;
mod visibility;

use crate::canvas::Canvas;
use crate::color::{Packed, linear};
use crate::drawn::{Drawn, Pass};
use crate::screen::{BAND, COARSE_PX, Screen};
use crate::sections::Sections;
use alike::alike;
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{
    AreaLayer, Color, Hidden, LayerKind, LineFeature, LineLayer, Overlay, OverlayLine, OverlayPoint, PointFeature,
    PointLayer, PointStyle, RenderJob, Scene, Symbol,
};
use face::Face;
use label::{LabelRequest, Labels};
use line_of_sight::LineOfSight;
use path::LinePoint;
use rayon::prelude::*;
use ribbon::{Ink, Lane, Stroke, StrokeLayer};
use visibility::{DepthMap, LineVisibility, Run};

/// Width of a hidden line in widths of the visible one.
const HIDDEN_WIDTH: f64 = 0.6;

/// All marks of a frame, in the order of the layers.
#[derive(Debug, Default)]
pub struct Marks {
    under: Vec<StrokeLayer>,
    faces: Vec<Face>,
    sheets: Vec<StrokeLayer>,
    labels: Labels,
}

impl Marks {
    /// Places all marks of a job over its drawn surfaces.
    pub fn new(job: &RenderJob<'_>, drawn: &Drawn<'_>) -> Self {
        if !job.options.marks {
            return Self::default();
        }
        let Drawn { passes, screen, tolerance_px, depth, sight } = *drawn;
        let map = DepthMap { depth, width: screen.width, height: screen.height };
        let sections = Sections::new(job);
        let sight = LineOfSight { scene: job.scene, sight };
        let builder = MarkBuilder {
            sections: sections.as_ref(),
            scene: job.scene,
            passes,
            records: job.view.records(),
            screen,
            tolerance_px,
            map,
            sight: &sight,
        };
        let overlay = &job.options.overlay;
        let mut requests: Vec<LabelRequest> = Vec::new();
        let mut sheets: Vec<StrokeLayer> = Vec::new();
        for (i, layer) in job.scene.layers.iter().enumerate() {
            let id = i as u32 + 1;
            match &layer.kind {
                LayerKind::Line(l) => {
                    let l = &*builder.shown_lines(i, l);
                    sheets.extend(builder.line_sheets(l, id));
                    sheets.extend(builder.distances(l, id, &mut requests));
                    requests.extend(builder.line_names(l));
                }
                LayerKind::Area(a) => {
                    sheets.extend(builder.outlines(a, id));
                    requests.extend(builder.area_names(i, a));
                }
                LayerKind::Point(p) => sheets.extend(builder.points(&builder.shown_points(i, p), id, &mut requests)),
                _ => {}
            }
        }
        sheets.extend(overlay.over.iter().map(|l| builder.overlay_line(l, &mut requests)));
        sheets.extend(overlay.points.iter().map(|p| builder.overlay_point(p, &mut requests)));
        let under = overlay.under.iter().map(|l| builder.overlay_line(l, &mut requests)).collect();
        let faces = overlay
            .faces
            .iter()
            .flat_map(|f| passes.iter().take(job.view.records()).filter_map(|p| Face::new(f, *p, screen)));
        Self { under, faces: faces.collect(), sheets, labels: Labels::place(requests, 2.0 * screen.center) }
    }

    /// Whether the job may have any marks.
    pub fn are_in(job: &RenderJob<'_>) -> bool {
        let drawn = |kind: &LayerKind| {
            matches!(kind, LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_) | LayerKind::Volume(_))
        };
        job.scene.layers.iter().any(|l| drawn(&l.kind)) || job.options.overlay != Overlay::default()
    }

    /// Draws the rows from `y0` on, one band; `depth` as in [`Marks::new`].
    pub fn draw(&self, y0: i32, screen: &Screen, depth: &[f32], color: &mut [Packed], id: &mut [u32]) {
        let mut masks = ribbon::CoverageMasks::default();
        for sheet in &self.under {
            sheet.draw(&mut masks, y0, screen.width, color, id);
        }
        for face in &self.faces {
            face.draw(screen, y0, color, depth);
        }
        for sheet in &self.sheets {
            sheet.draw(&mut masks, y0, screen.width, color, id);
        }
    }

    /// Coverage of the pixels of a band by parts of lines, outlines and points that nothing hides, 0..=1 with their opacity; empty if
    /// there are none. `y0` is the first row, `pixels` the size of the band.
    pub(crate) fn visible_cover(&self, y0: i32, screen: &Screen, pixels: usize) -> Vec<f32> {
        let mut masks = ribbon::CoverageMasks::default();
        let mut cover = Vec::new();
        for sheet in &self.sheets {
            sheet.add_visible(&mut masks, y0, screen.width, pixels, &mut cover);
        }
        cover
    }

    /// Writes the names over the finished picture.
    pub fn write_names(&self, pixels: &mut [[u8; 3]], width: usize) {
        self.labels.draw(&mut Canvas::new(pixels, width));
    }
}

struct MarkBuilder<'a> {
    sections: Option<&'a Sections<'a>>,
    scene: &'a Scene,
    /// All passes of the view, the first ones of its records.
    passes: &'a [&'a dyn Pass],
    records: usize,
    screen: &'a Screen,
    tolerance_px: f64,
    map: DepthMap<'a>,
    sight: &'a LineOfSight<'a>,
}

/// Width and treatment of hidden parts of a line.
#[derive(Clone, Copy)]
struct Style {
    half_px: f64,
    casing_px: Option<f64>,
    hidden: Hidden,
    lift_m: f64,
}

/// Symbol of a point and treatment of hidden ones.
#[derive(Clone, Copy)]
struct Marker {
    symbol: Symbol,
    half_px: f64,
    casing: bool,
    hidden: Hidden,
}

impl<'a> MarkBuilder<'a> {
    /// The passes that draw the contents of some boxes, each image once: the records, or the segments where the records leave something
    /// out; segments part at the ends of the turns.
    fn passes_for(&self, boxes: impl Iterator<Item = Aabb>) -> &'a [&'a dyn Pass] {
        let (records, segments) = self.passes.split_at(self.records.min(self.passes.len()));
        let mut boxes = boxes;
        let left_out = |b: &Aabb| segments.iter().any(|s| s.fills_in(self.screen, b));
        if !segments.is_empty() && boxes.any(|b| left_out(&b)) { segments } else { records }
    }
}

impl MarkBuilder<'_> {
    /// The screen of a coarse picture; `None` for any other.
    fn coarse(&self) -> Option<&Screen> {
        (self.tolerance_px >= COARSE_PX).then_some(self.screen)
    }

    fn line_sheets(&self, layer: &LineLayer, id: u32) -> Vec<StrokeLayer> {
        let sheet = |group: alike::Alike<'_, LineFeature>| {
            let half_px = 0.5 * width_or_none(group.scale * layer.width_px);
            let casing_px = layer.casing.map(|_| casing_of(half_px));
            let style = Style { half_px, casing_px, hidden: layer.hidden, lift_m: layer.lift_m };
            let paths = group
                .features
                .par_iter()
                .map(|f| path::drape(self.scene, &f.points, layer.lift_m, self.coarse()))
                .collect();
            self.sheet(paths, style, inks(group.color, layer.casing, layer.hidden), id)
        };
        alike(&layer.features, layer.color, |f| f.style).into_iter().map(sheet).collect()
    }

    fn outlines(&self, layer: &AreaLayer, id: u32) -> Option<StrokeLayer> {
        let color = layer.outline?;
        let mut paths: Vec<Vec<LinePoint>> = Vec::new();
        for ring in layer.features.iter().flat_map(|f| &f.rings) {
            let closed = ring.iter().chain(ring.first()).map(|xy| xy.extend(0.0));
            paths.extend(path::lay(self.scene, &closed.collect::<Vec<_>>(), layer.lift_m, self.coarse()));
        }
        let half_px = 0.5 * width_or_none(layer.width_px);
        let style = Style { half_px, casing_px: None, hidden: layer.hidden, lift_m: layer.lift_m };
        let paths = self.shown_paths(id as usize - 1, paths);
        Some(self.sheet(paths, style, inks(color, None, layer.hidden), id))
    }

    fn overlay_line(&self, line: &OverlayLine, requests: &mut Vec<LabelRequest>) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(line.width_px);
        let casing_px = line.casing.map(|_| casing_of(half_px));
        let style = Style { half_px, casing_px, hidden: line.hidden, lift_m: 0.0 };
        let paths = match line.on_ground {
            true => path::lay(self.scene, &line.points, 0.0, self.coarse()),
            false => vec![path::as_given(&line.points)],
        };
        if !line.label.is_empty() {
            requests.extend(self.rim_label(line, &paths, style));
        }
        self.sheet(paths, style, inks(line.color, line.casing, line.hidden), 0)
    }

    /// The text of a line at its visible end nearest to the bottom of the picture.
    fn rim_label(&self, line: &OverlayLine, paths: &[Vec<LinePoint>], style: Style) -> Option<LabelRequest> {
        let size = 2.0 * self.screen.center;
        let margin = DVec2::splat(1.5 * line.label_px);
        let inside = |p: DVec2| p.cmpge(margin).all() && p.cmple(size - margin).all();
        let runs = paths.iter().flat_map(|p| self.runs(p, style));
        let parts = runs.flat_map(|r| r.1.parts()).filter(|(visible, _)| *visible);
        let ends = parts.filter_map(|(_, part)| {
            let mut seen = part.iter().map(|s| s.pixel).filter(|p| inside(*p));
            let first = seen.next()?;
            Some([first, seen.next_back().unwrap_or(first)])
        });
        let at = ends.flatten().max_by(|a, b| a.y.total_cmp(&b.y))?;
        let (text, color) = (line.label.clone(), line.color.with_alpha(255));
        Some(LabelRequest { text, at, marker: [2.0, 2.0], size_px: line.label_px, color, leader: false, over: false })
    }

    fn sheet(&self, paths: Vec<Vec<LinePoint>>, style: Style, inks: [Ink; 3], id: u32) -> StrokeLayer {
        let strokes: Vec<Vec<Stroke>> = paths
            .par_iter()
            .map(|line| {
                let mut strokes = Vec::new();
                for (_, run) in self.runs(line, style) {
                    self.strokes(&run, style, &mut strokes);
                }
                strokes
            })
            .collect();
        StrokeLayer::new(strokes.concat(), inks, id, self.screen.height as usize, BAND)
    }

    /// Images of a line in every pass, with the number of the pass.
    fn runs(&self, line: &[LinePoint], style: Style) -> Vec<(usize, Run)> {
        let reach = style.half_px + 4.0;
        let mut runs = Vec::new();
        let pairs = line.windows(2).map(|pair| Aabb::of([pair[0].p, pair[1].p]));
        for (i, pass) in self.passes_for(pairs).iter().enumerate() {
            let judge = LineVisibility {
                pass: *pass,
                screen: self.screen,
                map: self.map,
                sight: self.sight,
                lift_m: style.lift_m,
            };
            for piece in path::project(*pass, self.screen, line, self.tolerance_px) {
                runs.extend(judge.runs(&piece, reach).into_iter().map(|run| (i, run)));
            }
        }
        runs
    }

    fn strokes(&self, run: &Run, style: Style, out: &mut Vec<Stroke>) {
        for (visible, part) in run.parts() {
            if visible || style.hidden == Hidden::Show {
                if let Some(casing) = style.casing_px {
                    dash::trace(&part, casing, Lane::Casing, out);
                }
                dash::trace(&part, style.half_px, if visible { Lane::Fill } else { Lane::Shown }, out);
            } else {
                let half = style.half_px * HIDDEN_WIDTH;
                match style.hidden {
                    Hidden::Fade => dash::trace(&part, half, Lane::Hidden, out),
                    Hidden::Dash => dash::dashes(&part, style.half_px * 2.0, half, out),
                    Hidden::Show | Hidden::Cut => {}
                }
            }
        }
    }

    /// Marks at equal distances along the lines of a layer.
    fn distances(&self, layer: &LineLayer, id: u32, requests: &mut Vec<LabelRequest>) -> Option<StrokeLayer> {
        let markers = layer.markers?;
        let lines: Vec<_> =
            layer.features.iter().map(|f| path::drape(self.scene, &f.points, layer.lift_m, self.coarse())).collect();
        let lengths = lines.iter().filter_map(|l| l.last().map(|p| p.along));
        let every = distance::spacing(markers, lengths)?;
        let half_px = (0.5 * width_or_none(layer.width_px)).max(1.0) + 1.2;
        // A hidden mark cannot be told from the dashes.
        let hidden = if layer.hidden == Hidden::Show { Hidden::Show } else { Hidden::Cut };
        let marker = Marker { symbol: Symbol::Dot, half_px, casing: true, hidden };
        let mut strokes = Vec::new();
        for (on_line, text) in lines.iter().flat_map(|l| distance::marks(l, every)) {
            for at in self.mark(&on_line, layer.lift_m, marker, &mut strokes) {
                let color = darker(layer.color);
                let side = half_px + 2.0;
                requests.push(LabelRequest {
                    text: text.clone(),
                    at,
                    marker: [side, side],
                    size_px: layer.marker_px,
                    color,
                    leader: false,
                    over: false,
                });
            }
        }
        let white = Color::rgb(255, 255, 255);
        let inks = inks(white, Some(layer.color), hidden);
        Some(StrokeLayer::new(strokes, inks, id, self.screen.height as usize, BAND))
    }

    fn points(&self, layer: &PointLayer, id: u32, requests: &mut Vec<LabelRequest>) -> Vec<StrokeLayer> {
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
                named.into_iter().map(|at| label_request(feature.name.trim(), at, marker, size_px, group.color)),
            );
        }
        StrokeLayer::new(strokes, inks(group.color, casing, layer.hidden), id, self.screen.height as usize, BAND)
    }

    fn overlay_point(&self, point: &OverlayPoint, requests: &mut Vec<LabelRequest>) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(point.size_px);
        let marker = Marker { symbol: point.symbol, half_px, casing: true, hidden: point.hidden };
        let on_line = LinePoint { p: point.position, along: 0.0, on_ground: false };
        let mut strokes = Vec::new();
        let named = self.mark(&on_line, 0.0, marker, &mut strokes);
        if !point.label.is_empty() {
            requests.extend(named.into_iter().map(|at| label_request(&point.label, at, marker, 13.0, point.color)));
        }
        let casing = Some(Color::rgb(255, 255, 255));
        StrokeLayer::new(strokes, inks(point.color, casing, point.hidden), 0, self.screen.height as usize, BAND)
    }

    /// Draws a marker at every image of a point; returns where a name belongs.
    fn mark(&self, on_line: &LinePoint, lift_m: f64, marker: Marker, out: &mut Vec<Stroke>) -> Vec<DVec2> {
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
            stamp(pixel, marker, visible, out);
            if visible || marker.hidden == Hidden::Show {
                named.push(pixel);
            }
        }
        named
    }
}

/// Strokes of a marker.
fn stamp(at: DVec2, marker: Marker, visible: bool, out: &mut Vec<Stroke>) {
    let Marker { symbol, half_px: half, casing, hidden } = marker;
    let mut put = |half: f64, grow: f64, lane: Lane| out.push(Stroke::symbol(symbol, at, half, grow, lane));
    match (visible, hidden) {
        (true, _) | (false, Hidden::Show) => {
            if casing {
                put(half, casing_of(half) - half, Lane::Casing);
            }
            put(half, 0.0, if visible { Lane::Fill } else { Lane::Shown });
        }
        (false, Hidden::Fade) => put(half, 0.0, Lane::Hidden),
        (false, Hidden::Dash) => put(half * HIDDEN_WIDTH, 0.0, Lane::Hidden),
        (false, Hidden::Cut) => {}
    }
}

fn label_request(text: &str, at: DVec2, marker: Marker, size_px: f64, color: Color) -> LabelRequest {
    let side = marker.half_px + 2.0;
    let above = symbol::top(marker.symbol) * marker.half_px + 2.5;
    LabelRequest {
        text: text.to_owned(),
        at,
        marker: [side, above],
        size_px,
        color: darker(color),
        leader: true,
        over: false,
    }
}

/// A colour that reads as text.
fn darker(c: Color) -> Color {
    let [r, g, b] = [c.r, c.g, c.b].map(|v| (f32::from(v) * 0.6) as u8);
    Color::rgb(r, g, b)
}

/// The width, or 0 if it cannot be drawn.
fn width_or_none(width_px: f64) -> f64 {
    if width_px.is_finite() { width_px.clamp(0.0, 1000.0) } else { 0.0 }
}

fn casing_of(half_px: f64) -> f64 {
    half_px + (0.6 * half_px).clamp(0.9, 2.5)
}

/// Inks of hidden, casing and fill.
fn inks(color: Color, casing: Option<Color>, hidden: Hidden) -> [Ink; 3] {
    let ink = |c: Color, share: f32| Ink { color: linear([c.r, c.g, c.b]), alpha: share * f32::from(c.a) / 255.0 };
    let faint = if hidden == Hidden::Fade { 0.45 } else { 0.75 };
    [ink(color, faint), ink(casing.unwrap_or(color), if casing.is_some() { 0.9 } else { 0.0 }), ink(color, 1.0)]
}

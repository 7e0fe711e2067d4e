//! Lines, outlines and points, drawn over the surfaces.

mod path;
mod ribbon;
mod visibility;

use crate::BAND;
use crate::lens::{Lens, Pass};
use crate::shade::color::{Packed, linear};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{AreaLayer, Color, Hidden, LayerKind, LineLayer, PointLayer, RenderJob, Scene};
use path::PathPoint;
use rayon::prelude::*;
use ribbon::{Ink, Lane, Sheet, Stroke};
use visibility::{DepthMap, Station, stations};

/// Lengths of dash and gap in widths of the line, and the width of a hidden line in widths of the visible one.
const DASH: [f64; 2] = [2.4, 2.0];
const HIDDEN_WIDTH: f64 = 0.6;

/// All marks of a frame, in the order of the layers.
pub(crate) struct Marks {
    sheets: Vec<Sheet>,
}

impl Marks {
    /// * `depth`: surfaces at the pixel centres, to judge visibility by.
    pub(crate) fn new(job: &RenderJob<'_>, passes: &[Pass<'_>], lens: &Lens, tolerance_px: f64, depth: &[f32]) -> Self {
        let map = DepthMap { depth, width: lens.width, height: lens.height };
        let maker = Maker { scene: job.scene, passes, lens, tolerance_px, map };
        let sheets = job.scene.layers.iter().enumerate().filter_map(|(i, layer)| {
            let id = i as u32 + 1;
            match &layer.kind {
                LayerKind::Line(l) => Some(maker.line_layer(l, id)),
                LayerKind::Area(a) => maker.outlines(a, id),
                LayerKind::Point(p) => Some(maker.points(p, id)),
                _ => None,
            }
        });
        Self { sheets: sheets.collect() }
    }

    /// Draws the rows from `y0` on, one band.
    pub(crate) fn draw(&self, y0: i32, width: i32, color: &mut [Packed], id: &mut [u32]) {
        let mut masks = ribbon::Masks::default();
        for sheet in &self.sheets {
            sheet.draw(&mut masks, y0, width, color, id);
        }
    }
}

struct Maker<'a> {
    scene: &'a Scene,
    passes: &'a [Pass<'a>],
    lens: &'a Lens,
    tolerance_px: f64,
    map: DepthMap<'a>,
}

/// Width and treatment of hidden parts of a line.
#[derive(Clone, Copy)]
struct Style {
    half_px: f64,
    casing_px: Option<f64>,
    hidden: Hidden,
}

impl Maker<'_> {
    fn line_layer(&self, layer: &LineLayer, id: u32) -> Sheet {
        let half_px = 0.5 * width_or_none(layer.width_px);
        let casing_px = layer.casing.map(|_| casing_of(half_px));
        let style = Style { half_px, casing_px, hidden: layer.hidden };
        let paths = layer.features.iter().map(|f| f.points.as_slice()).collect::<Vec<_>>();
        self.sheet(&paths, layer.lift_m, style, inks(layer.color, layer.casing, layer.hidden), id)
    }

    fn outlines(&self, layer: &AreaLayer, id: u32) -> Option<Sheet> {
        let color = layer.outline?;
        let hf = self.scene.terrain()?;
        let step = 0.9 * hf.spacing().min_element();
        let mut paths: Vec<Vec<DVec3>> = Vec::new();
        for ring in layer.features.iter().flat_map(|f| &f.rings) {
            let mut path = Vec::new();
            for (i, &a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                let n = ((b - a).length() / step).ceil().clamp(1.0, 4096.0) as usize;
                for k in usize::from(i > 0)..=n {
                    let xy = a.lerp(b, k as f64 / n as f64);
                    match hf.surface_at(xy) {
                        Some(z) => path.push(xy.extend(z)),
                        None => paths.push(std::mem::take(&mut path)),
                    }
                }
            }
            paths.push(path);
        }
        let style = Style { half_px: 0.5 * width_or_none(layer.width_px), casing_px: None, hidden: layer.hidden };
        let paths: Vec<&[DVec3]> = paths.iter().map(Vec::as_slice).collect();
        Some(self.sheet(&paths, layer.lift_m, style, inks(color, None, layer.hidden), id))
    }

    fn sheet(&self, paths: &[&[DVec3]], lift_m: f64, style: Style, inks: [Ink; 3], id: u32) -> Sheet {
        let strokes: Vec<Vec<Stroke>> = paths
            .par_iter()
            .map(|points| {
                let mut strokes = Vec::new();
                let ground = path::drape(self.scene, points, lift_m);
                for pass in self.passes {
                    for piece in path::project(pass, self.lens, &ground, self.tolerance_px) {
                        self.strokes(&piece, style, &mut strokes);
                    }
                }
                strokes
            })
            .collect();
        Sheet::new(strokes.concat(), inks, id, self.lens.height as usize, BAND)
    }

    fn strokes(&self, piece: &[PathPoint], style: Style, out: &mut Vec<Stroke>) {
        let reach = style.half_px + 4.0;
        for run in stations(piece, self.lens, self.map, reach) {
            for (visible, part) in parts_of(&run) {
                if visible || style.hidden == Hidden::Show {
                    if let Some(casing) = style.casing_px {
                        trace(part, casing, Lane::Casing, out);
                    }
                    trace(part, style.half_px, if visible { Lane::Fill } else { Lane::Shown }, out);
                } else {
                    let half = style.half_px * HIDDEN_WIDTH;
                    match style.hidden {
                        Hidden::Fade => trace(part, half, Lane::Hidden, out),
                        Hidden::Dash => dashes(part, style.half_px * 2.0, half, out),
                        Hidden::Show | Hidden::Cut => {}
                    }
                }
            }
        }
    }

    fn points(&self, layer: &PointLayer, id: u32) -> Sheet {
        let half = 0.5 * width_or_none(layer.size_px);
        let mut strokes = Vec::new();
        for feature in &layer.features {
            let p = feature.position + DVec3::Z * layer.lift_m;
            for pass in self.passes {
                let Some(v) = pass.displace(p).map(|d| self.lens.view_from(d)) else { continue };
                if !v.is_finite() || !self.lens.is_drawable(v) || pass.margins(p).iter().any(|m| !(*m >= 0.0)) {
                    continue;
                }
                let pixel = self.lens.pixel(v);
                let visible = self.map.behind(self.lens, pixel, v.z).is_none_or(|b| b <= 1.5);
                self.disc(pixel, half, visible, layer.hidden, &mut strokes);
            }
        }
        let casing = Color::rgb(255, 255, 255);
        Sheet::new(strokes, inks(layer.color, Some(casing), layer.hidden), id, self.lens.height as usize, BAND)
    }

    fn disc(&self, pixel: DVec2, half: f64, visible: bool, hidden: Hidden, out: &mut Vec<Stroke>) {
        let mut dot = |half: f64, lane: Lane| out.push(Stroke::new(pixel, pixel, half, lane));
        match (visible, hidden) {
            (true, _) | (false, Hidden::Show) => {
                dot(casing_of(half), Lane::Casing);
                dot(half, if visible { Lane::Fill } else { Lane::Shown });
            }
            (false, Hidden::Fade) => dot(half, Lane::Hidden),
            (false, Hidden::Dash) => dot(half * HIDDEN_WIDTH, Lane::Hidden),
            (false, Hidden::Cut) => {}
        }
    }
}

/// A width that cannot be drawn is none.
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

/// Maximal parts of one visibility. A hidden part reaches to the visible stations beside it, so that no gap opens.
fn parts_of(run: &[Station]) -> Vec<(bool, &[Station])> {
    let mut parts = Vec::new();
    let mut start = 0;
    while start < run.len() {
        let visible = run[start].visible;
        let end = start + run[start..].iter().take_while(|s| s.visible == visible).count();
        let grow = usize::from(!visible);
        parts.push((visible, &run[start.saturating_sub(grow)..(end + grow).min(run.len())]));
        start = end;
    }
    parts
}

/// Strokes along stations, as few as straightness allows.
fn trace(part: &[Station], half: f64, lane: Lane, out: &mut Vec<Stroke>) {
    if half <= 0.0 {
        return;
    }
    if let [only] = part {
        out.push(Stroke::new(only.pixel, only.pixel, half, lane));
    }
    let mut from = 0;
    while from + 1 < part.len() {
        let mut to = from + 1;
        while to + 1 < part.len() && to - from < 24 {
            let (a, b) = (part[from].pixel, part[to + 1].pixel);
            let straight = part[from + 1..=to].iter().all(|s| crate::shade::area::distance(s.pixel, a, b) < 0.06);
            if !straight {
                break;
            }
            to += 1;
        }
        out.push(Stroke::new(part[from].pixel, part[to].pixel, half, lane));
        from = to;
    }
}

/// Dashes at fixed places of the whole line, so that they do not jump where the line comes out of hiding.
fn dashes(part: &[Station], width: f64, half: f64, out: &mut Vec<Stroke>) {
    let [on, off] = DASH.map(|d| d * width.max(1.5));
    let period = on + off;
    let mut dash: Vec<Station> = Vec::new();
    for s in part {
        if s.arc_px.rem_euclid(period) < on {
            dash.push(*s);
        } else {
            trace(&dash, half, Lane::Hidden, out);
            dash.clear();
        }
    }
    trace(&dash, half, Lane::Hidden, out);
}

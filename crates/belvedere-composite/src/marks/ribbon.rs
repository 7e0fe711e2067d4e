//! Anti-aliased ribbons and symbols: the union of strokes, so that overlaps are not darker.

use crate::color::{Packed, Rgb};
use crate::marks::occupied::Rect;
use crate::marks::shapes::{LayerShapes, LineShape, Paint, Role, SymbolShape};
use crate::marks::symbol;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Symbol};
use glam::Vec2;

/// Colour with opacity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ink {
    pub(crate) color: Rgb,
    pub(crate) alpha: f32,
    /// The colour as stored.
    pub(crate) stored: Color,
}

/// Coverage mask that a stroke is drawn into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lane {
    /// Below: parts behind surfaces.
    Hidden = 0,
    /// Rim of the visible parts, below every fill of the layer, so that crossings look right.
    Casing = 1,
    /// Visible parts; they own the id buffer.
    Fill = 2,
    /// Hidden parts drawn like visible ones.
    Shown = 3,
}

/// A straight piece with round ends, or a symbol.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stroke {
    a: Vec2,
    b: Vec2,
    half: f32,
    /// Rim added to a symbol.
    grow: f32,
    symbol: Option<Symbol>,
    lane: Lane,
}

impl Stroke {
    pub(crate) fn new(a: DVec2, b: DVec2, half: f64, lane: Lane) -> Self {
        Self { a: a.as_vec2(), b: b.as_vec2(), half: half as f32, grow: 0.0, symbol: None, lane }
    }

    /// A symbol of half size `half` at `at`, widened by `grow`.
    pub(crate) fn symbol(symbol: Symbol, at: DVec2, half: f64, grow: f64, lane: Lane) -> Self {
        let at = at.as_vec2();
        Self { a: at, b: at, half: half as f32, grow: grow as f32, symbol: Some(symbol), lane }
    }

    /// The same, moved by pixels.
    pub(crate) fn moved(self, by: DVec2) -> Self {
        let by = by.as_vec2();
        Self { a: self.a + by, b: self.b + by, ..self }
    }

    fn symbol_shape(&self) -> Option<SymbolShape> {
        let symbol = self.symbol?;
        let (at, half, grow) = (self.a.as_dvec2(), f64::from(self.half), f64::from(self.grow));
        let role = match self.lane {
            Lane::Hidden => Role::Hidden,
            Lane::Casing => Role::Casing,
            Lane::Fill | Lane::Shown => Role::Fill,
        };
        Some(SymbolShape { symbol, at, half, grow, role })
    }

    #[cfg(test)]
    pub(crate) fn ends(&self) -> [Vec2; 2] {
        [self.a, self.b]
    }

    /// Farthest ink from the axis, pixels.
    fn reach(&self) -> f32 {
        self.symbol.map_or(self.half, |s| symbol::reach(s) * self.half + 2.0 * self.grow)
    }

    /// Signed distance to the outline, negative inside.
    fn distance(&self, p: Vec2) -> f32 {
        if let Some(symbol) = self.symbol {
            return symbol::distance(symbol, p - self.a, self.half) - self.grow;
        }
        let (p, d) = (p - self.a, self.b - self.a);
        let length = d.length_squared();
        let t = if length > 0.0 { (p.dot(d) / length).clamp(0.0, 1.0) } else { 0.0 };
        (p - t * d).length() - self.half
    }
}

/// The strokes of a layer, sorted into bands.
#[derive(Debug)]
pub(crate) struct StrokeLayer {
    strokes: Vec<Stroke>,
    bands: Vec<Vec<u32>>,
    inks: [Ink; 3],
    /// 0 leaves the id buffer alone.
    id: u32,
    rows: usize,
    /// Lines as shapes, where they are wanted.
    lines: Vec<LineShape>,
}

/// Coverage of a band by lane.
#[derive(Debug, Default)]
pub(crate) struct CoverageMasks {
    lanes: [Vec<f32>; 4],
}

impl StrokeLayer {
    /// * `rows`: height of a band, pixels.
    pub(crate) fn new(strokes: Vec<Stroke>, inks: [Ink; 3], id: u32, height: usize, rows: usize) -> Self {
        let mut bands = vec![Vec::new(); height.div_ceil(rows)];
        for (i, s) in strokes.iter().enumerate() {
            let reach = s.reach() + 1.0;
            let (top, bottom) = (s.a.y.min(s.b.y) - reach, s.a.y.max(s.b.y) + reach);
            if bottom < 0.0 || top >= height as f32 {
                continue;
            }
            let last = (bottom as usize / rows).min(bands.len() - 1);
            bands[top.max(0.0) as usize / rows..=last].iter_mut().for_each(|b| b.push(i as u32));
        }
        Self { strokes, bands, inks, id, rows, lines: Vec::new() }
    }

    /// The same with more strokes.
    pub(crate) fn with_strokes(self, more: Vec<Stroke>) -> Self {
        if more.is_empty() {
            return self;
        }
        let Self { mut strokes, bands, inks, id, rows, lines } = self;
        strokes.extend(more);
        Self { lines, ..Self::new(strokes, inks, id, bands.len() * rows, rows) }
    }

    /// 1 + index of the layer; 0 for marks of none.
    pub(crate) fn id(&self) -> u32 {
        self.id
    }

    /// Boxes that cover its visible lines, each about as long as the line is wide.
    pub(crate) fn visible_boxes(&self) -> impl Iterator<Item = Rect> + '_ {
        let seen = self.strokes.iter().filter(|s| s.symbol.is_none() && matches!(s.lane, Lane::Fill | Lane::Shown));
        seen.flat_map(|s| {
            let (a, b, half) = (s.a.as_dvec2(), s.b.as_dvec2(), f64::from(s.half));
            let parts = (a.distance(b) / (2.0 * half).max(4.0)).ceil().clamp(1.0, 1000.0) as usize;
            (0..parts).map(move |i| {
                let [p, q] = [i, i + 1].map(|k| a.lerp(b, k as f64 / parts as f64));
                [p.min(q) - half, p.max(q) + half]
            })
        })
    }

    /// The same with its lines as shapes.
    pub(crate) fn with_lines(self, lines: Vec<LineShape>) -> Self {
        Self { lines, ..self }
    }

    /// The layer as shapes.
    pub(crate) fn shapes(&self) -> LayerShapes {
        let paint = |ink: &Ink| Paint { color: ink.stored, opacity: ink.alpha };
        let [hidden, casing, fill] = &self.inks;
        LayerShapes {
            id: self.id,
            hidden: paint(hidden),
            casing: paint(casing),
            fill: paint(fill),
            lines: self.lines.clone(),
            symbols: self.strokes.iter().filter_map(Stroke::symbol_shape).collect(),
        }
    }

    /// Coverage of the band whose first row is `y0`, a band of `pixels` pixels; whether it has any stroke.
    fn fill(&self, masks: &mut CoverageMasks, y0: i32, width: i32, pixels: usize) -> bool {
        let Some(band) = self.bands.get(y0 as usize / self.rows).filter(|b| !b.is_empty()) else { return false };
        for lane in &mut masks.lanes {
            lane.clear();
            lane.resize(pixels, 0.0);
        }
        let rows = pixels as i32 / width.max(1);
        for &i in band {
            let s = &self.strokes[i as usize];
            cover(s, &mut masks.lanes[s.lane as usize], y0, rows, width);
        }
        true
    }

    /// Adds the coverage by visible parts, with their opacity, to that of other layers; `all` stays empty while there is none.
    pub(crate) fn add_visible(
        &self,
        masks: &mut CoverageMasks,
        y0: i32,
        width: i32,
        pixels: usize,
        all: &mut Vec<f32>,
    ) {
        if !self.fill(masks, y0, width, pixels) {
            return;
        }
        all.resize(pixels, 0.0);
        let [_, casing, fill, _] = &masks.lanes;
        let [_, rim, ink] = self.inks.map(|ink| ink.alpha);
        for (all, (c, f)) in all.iter_mut().zip(casing.iter().zip(fill)) {
            *all = 1.0 - (1.0 - *all) * (1.0 - rim * c) * (1.0 - ink * f);
        }
    }

    /// Draws the band whose first row is `y0`.
    pub(crate) fn draw(&self, masks: &mut CoverageMasks, y0: i32, width: i32, color: &mut [Packed], id: &mut [u32]) {
        if !self.fill(masks, y0, width, color.len()) {
            return;
        }
        let [hidden, casing, fill, shown] = &masks.lanes;
        for i in 0..color.len() {
            let (h, c, f, s) = (hidden[i], casing[i], fill[i], shown[i]);
            if h.max(c).max(f).max(s) <= 0.0 {
                continue;
            }
            let mut rgb = color[i].rgb();
            // Hidden parts do not show through visible ones.
            let h = h * (1.0 - c.max(f).max(s));
            for (ink, cover) in self.inks.iter().zip([h, c, f.max(s)]) {
                rgb = rgb.lerp(ink.color, ink.alpha * cover);
            }
            color[i] = Packed::new(rgb);
            if f >= 0.5 && self.id != 0 {
                id[i] = self.id;
            }
        }
    }
}

/// Coverage by distance to the stroke, largest wins.
fn cover(s: &Stroke, mask: &mut [f32], y0: i32, rows: i32, width: i32) {
    let reach = s.reach() + 0.5;
    let (lo, hi) = (s.a.min(s.b) - reach, s.a.max(s.b) + reach);
    let x0 = ((lo.x - 0.5).ceil().max(0.0) as i32).min(width);
    let x1 = (hi.x - 0.5).floor().min((width - 1) as f32) as i32;
    let ya = ((lo.y - 0.5).ceil().max(y0 as f32) as i32).min(y0 + rows);
    let yb = (hi.y - 0.5).floor().min((y0 + rows - 1) as f32) as i32;
    // The coverage of a line thinner than a pixel is proportional to its width.
    let most = (2.0 * s.half).min(1.0);
    for y in ya..=yb {
        for x in x0..=x1 {
            let cover = (0.5 - s.distance(Vec2::new(x as f32 + 0.5, y as f32 + 0.5))).clamp(0.0, most);
            let m = &mut mask[((y - y0) * width + x) as usize];
            *m = m.max(cover);
        }
    }
}

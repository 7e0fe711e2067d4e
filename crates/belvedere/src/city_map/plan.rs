//! Drawing in plan: from metres to pixels, and the order and colours of a map.

use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::Color;
use belvedere_scene::city::{City, LandCover, Polygon, Way, WayClass};

/// Colour of ground without land cover.
pub(super) const PAPER: Color = Color::rgb(243, 240, 233);

/// Scale and position of a drawing.
pub(super) struct Plan {
    /// South-western corner, metres.
    pub low: DVec2,
    /// Metres per pixel.
    pub m_per_px: f64,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pixel of its north-western corner on the canvas.
    pub at: DVec2,
}

/// Order, colour and drawn width in metres of a class of ways; casing where it has one.
struct WayStyle {
    class: WayClass,
    width_m: f64,
    least_px: f64,
    fill: Color,
    casing: Option<Color>,
}

const fn way_style(class: WayClass, width_m: f64, least_px: f64, fill: [u8; 3], casing: Option<[u8; 3]>) -> WayStyle {
    let casing = match casing {
        Some([r, g, b]) => Some(Color::rgb(r, g, b)),
        None => None,
    };
    WayStyle { class, width_m, least_px, fill: Color::rgb(fill[0], fill[1], fill[2]), casing }
}

/// In drawing order: later ones cover earlier ones.
const WAYS: [WayStyle; 9] = [
    way_style(WayClass::Waterway, 6.0, 1.2, [160, 196, 222], None),
    way_style(WayClass::Footway, 2.0, 0.8, [226, 214, 196], None),
    way_style(WayClass::Service, 4.0, 0.9, [255, 255, 255], Some([214, 206, 194])),
    way_style(WayClass::Residential, 7.0, 1.2, [255, 255, 255], Some([200, 190, 176])),
    way_style(WayClass::Tertiary, 9.0, 1.6, [255, 252, 232], Some([190, 174, 146])),
    way_style(WayClass::Rail, 4.0, 1.0, [150, 148, 150], None),
    way_style(WayClass::Secondary, 12.0, 2.0, [252, 240, 190], Some([196, 164, 104])),
    way_style(WayClass::Primary, 14.0, 2.2, [250, 220, 160], Some([190, 144, 86])),
    way_style(WayClass::Motorway, 18.0, 2.6, [244, 188, 136], Some([182, 116, 70])),
];

/// Land cover from the lowest to the highest.
const COVERS: [(LandCover, Color); 6] = [
    (LandCover::Other, Color::rgb(236, 232, 222)),
    (LandCover::Green, Color::rgb(214, 228, 192)),
    (LandCover::Forest, Color::rgb(186, 210, 168)),
    (LandCover::Water, Color::rgb(168, 202, 226)),
    (LandCover::Rail, Color::rgb(220, 216, 214)),
    (LandCover::Road, Color::rgb(255, 255, 255)),
];

impl Plan {
    /// A plan of `bounds`, its longer side `most_px` pixels, unless these were smaller than `least_m` metres.
    pub(super) fn within([low, high]: [DVec2; 2], most_px: usize, least_m: f64) -> Self {
        let span = (high - low).max(DVec2::splat(1.0));
        let m_per_px = (span.max_element() / most_px as f64).max(least_m);
        let [width, height] = [span.x, span.y].map(|side| ((side / m_per_px - 1e-6).ceil() as usize).clamp(1, most_px));
        Self { low, m_per_px, width, height, at: DVec2::ZERO }
    }

    fn pixel(&self, p: DVec2) -> DVec2 {
        let q = (p - self.low) / self.m_per_px;
        self.at + DVec2::new(q.x, self.height as f64 - q.y)
    }

    /// Fills a polygon, moved by `shift` pixels.
    pub(super) fn fill(&self, canvas: &mut Canvas<'_>, polygon: &Polygon, color: Color, shift: DVec2) {
        let rings: Vec<Vec<DVec2>> = std::iter::once(&polygon.outer)
            .chain(&polygon.holes)
            .map(|ring| ring.iter().map(|p| self.pixel(*p) + shift).collect())
            .collect();
        canvas.polygon(rings.iter().map(Vec::as_slice), color);
    }

    /// Draws the rings of a polygon.
    pub(super) fn outline(&self, canvas: &mut Canvas<'_>, polygon: &Polygon, width_px: f64, color: Color) {
        for ring in std::iter::once(&polygon.outer).chain(&polygon.holes) {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                self.segment(canvas, *a, *b, width_px, color);
            }
        }
    }

    /// Draws one straight piece in a box of its own, so that long lines do not fill large boxes. Pieces off the drawing are left out.
    fn segment(&self, canvas: &mut Canvas<'_>, a: DVec2, b: DVec2, width_px: f64, color: Color) {
        let (a, b) = (self.pixel(a), self.pixel(b));
        let (low, high) = (a.min(b) - width_px, a.max(b) + width_px);
        let size = DVec2::new(self.width as f64, self.height as f64);
        if !(low.cmplt(self.at + size).all() && high.cmpgt(self.at).all()) {
            return;
        }
        // Slanted pieces are cut, so that their boxes stay small.
        let parts = ((b - a).abs().min_element() / 32.0).ceil().clamp(1.0, 512.0) as usize;
        for part in 0..parts {
            let ends = [part, part + 1].map(|i| a.lerp(b, i as f64 / parts as f64));
            canvas.line(&ends, width_px, color);
        }
    }

    /// Paper and land cover.
    pub(super) fn ground(&self, canvas: &mut Canvas<'_>, city: &City) {
        canvas.rect(self.at, self.at + DVec2::new(self.width as f64, self.height as f64), 0.0, PAPER);
        for (cover, color) in COVERS {
            for polygon in city.areas.iter().filter(|a| a.cover == cover).flat_map(|a| &a.polygons) {
                self.fill(canvas, polygon, color, DVec2::ZERO);
            }
        }
    }

    /// Ways by class: all casings of a class, then its fills, so that crossings are open.
    pub(super) fn ways(&self, canvas: &mut Canvas<'_>, ways: &[Way]) {
        for style in &WAYS {
            let width = (style.width_m / self.m_per_px).max(style.least_px);
            // No casing where a road is hardly wider than it: it would cover the fill.
            let casing = style.casing.filter(|_| width >= 1.5).map(|color| (width + 2.0, color));
            for (width, color) in casing.into_iter().chain([(width, style.fill)]) {
                for way in ways.iter().filter(|w| w.class == style.class) {
                    for ends in way.points.windows(2).filter(|e| e.iter().all(|p| p.is_finite())) {
                        self.segment(canvas, ends[0], ends[1], width, color);
                    }
                }
            }
        }
    }
}

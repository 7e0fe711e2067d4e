//! The curved ray of a pixel as spans of depth with a bound on their distance from the chord.

use belvedere_core::map::curved_rays::Shape;
use belvedere_core::{Camera, DVec2, DVec3, RayPath, Stage, TerrainDisocclusion, View};

/// Spans that a ray of unknown shape is first looked at in.
const SPANS: usize = 8;

/// A view in two parts: the smooth displacements, which bend rays, and the displacement of the ground, which moves the ground instead.
///
/// Earth curvature and terrain disocclusion both move points of a vertical line alike, so their order does not matter and the
/// latter may be left on the ground: there it is a height per place, kinks and all, and no curve has to follow it.
pub(crate) struct Split<'a> {
    pub(crate) view: &'a View,
    smooth: View,
    pub(crate) ground: Option<&'a TerrainDisocclusion>,
}

impl<'a> Split<'a> {
    pub(crate) fn new(view: &'a View) -> Self {
        let ground = view.stages().iter().find_map(|s| match s {
            Stage::TerrainDisocclusion(t) => Some(t),
            _ => None,
        });
        let stages = view.stages().iter().filter(|s| !matches!(s, Stage::TerrainDisocclusion(_))).cloned().collect();
        // A chain without one of its stages is in order if the chain is.
        let smooth = View::new(view.pinhole().clone(), stages).unwrap_or_else(|_| view.clone());
        Self { view, smooth, ground }
    }

    /// Height by which the ground at a place is displaced.
    pub(crate) fn lift(&self, p: DVec3) -> f64 {
        self.ground.map_or(0.0, |g| g.delta_at(p))
    }

    pub(crate) fn ray(&self, pixel: DVec2) -> RayPath<'_> {
        self.smooth.ray(pixel)
    }

    /// Spans that cover the depths `near..far` of a pixel's ray, in order.
    pub(crate) fn spans(&self, ray: &RayPath<'_>, [near, far]: [f64; 2]) -> Vec<Span> {
        let at = |w: f64| ray.at(w).ok().map(|p| p.point);
        let line = |a: f64, b: f64| Span { depth: [a, b], points: [at(a), None, None, None, at(b)], straight: true };
        match self.smooth.stages() {
            [] => return vec![line(near, far)],
            [Stage::CurvedRays(_)] => {
                if let Ok(pieces) = ray.pieces() {
                    let mut spans = Vec::new();
                    for piece in pieces {
                        let [a, b] = [piece.depth[0].max(near), piece.depth[1].min(far)];
                        if a >= b {
                            continue;
                        }
                        let middle = 0.5 * (a + b);
                        match piece.shape {
                            Shape::Line { .. } => spans.push(line(a, b)),
                            _ => spans.extend([Span::new(&at, a, middle), Span::new(&at, middle, b)]),
                        }
                    }
                    return spans;
                }
            }
            _ => {}
        }
        let depth = |i: usize| near + (far - near) * i as f64 / SPANS as f64;
        (0..SPANS).map(|i| Span { depth: [depth(i), depth(i + 1)], points: [None; 5], straight: false }).collect()
    }
}

/// Part of a ray: its points at the quarters of a range of depths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) depth: [f64; 2],
    pub(crate) points: [Option<DVec3>; 5],
    /// Known to be straight: only the ends count.
    pub(crate) straight: bool,
}

impl Span {
    pub(crate) fn new(at: &impl Fn(f64) -> Option<DVec3>, from: f64, to: f64) -> Self {
        let points = std::array::from_fn(|i| at(from + 0.25 * i as f64 * (to - from)));
        Self { depth: [from, to], points, straight: false }
    }

    /// Fills in the points of a span that came without.
    pub(crate) fn filled(self, at: &impl Fn(f64) -> Option<DVec3>) -> Self {
        if self.straight || self.points.iter().any(Option::is_some) {
            return self;
        }
        Self::new(at, self.depth[0], self.depth[1])
    }

    /// Both halves; three points of each are known.
    pub(crate) fn halves(&self, at: &impl Fn(f64) -> Option<DVec3>) -> [Self; 2] {
        let [a, b] = self.depth;
        let middle = 0.5 * (a + b);
        let half = |from: f64, to: f64, known: &[Option<DVec3>]| {
            let quarter = 0.25 * (to - from);
            let points = [known[0], at(from + quarter), known[1], at(to - quarter), known[2]];
            Self { depth: [from, to], points, straight: false }
        };
        [half(a, middle, &self.points[..3]), half(middle, b, &self.points[2..])]
    }

    /// Ends, and how far a point of the ray may be from the point of the chord at the same share of the span; `None` where
    /// some of the ray has no point.
    ///
    /// For a parabola the quarters hold the very largest distance, for a cubic 97 % of it, for a kink three quarters: half as much again is
    /// a bound for all three.
    pub(crate) fn chord(&self) -> Option<(DVec3, DVec3, f64)> {
        let (a, b) = (self.points[0]?, self.points[4]?);
        if self.straight {
            return Some((a, b, 0.0));
        }
        let mut bow = 0.0f64;
        for (i, p) in self.points.iter().enumerate() {
            bow = bow.max((*p)?.distance(a.lerp(b, 0.25 * i as f64)));
        }
        Some((a, b, 1.5 * bow))
    }

    pub(crate) fn depth_at(&self, t: f64) -> f64 {
        self.depth[0] + t * (self.depth[1] - self.depth[0])
    }
}

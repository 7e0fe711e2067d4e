//! Which parts of a line the surfaces hide, steadily.

use super::path::PathPoint;
use crate::lens::Lens;
use belvedere_core::DVec2;

/// Hidden gaps shorter than this are closed, then visible specks shorter than this are dropped, pixels.
const SHORTEST_RUN_PX: f64 = 4.0;
/// How much farther than the surface a point must be to count as hidden at once, in units of the tolerance.
const HYSTERESIS: f64 = 2.5;

/// Depths of the surfaces at the pixel centres.
#[derive(Clone, Copy)]
pub(crate) struct DepthMap<'a> {
    pub(crate) depth: &'a [f32],
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl DepthMap<'_> {
    fn at(&self, x: i32, y: i32) -> Option<f64> {
        let inside = x >= 0 && y >= 0 && x < self.width && y < self.height;
        inside.then(|| f64::from(self.depth[(y * self.width + x) as usize]))
    }

    /// How far `depth` lies behind the surface seen at `pixel`, in units of the tolerance: the depth that the surface
    /// itself gains within a pixel, plus the width of a pixel on it.
    pub(crate) fn behind(&self, lens: &Lens, pixel: DVec2, depth: f64) -> Option<f64> {
        let (x, y) = (pixel.x.floor() as i32, pixel.y.floor() as i32);
        let surface = self.at(x, y)?;
        if !surface.is_finite() {
            return Some(f64::NEG_INFINITY);
        }
        let step = |a: Option<f64>, b: Option<f64>| {
            // The smaller of the two: the surface goes on at least on one side, also along a skyline.
            let d = |n: Option<f64>| n.map_or(f64::INFINITY, |n| (n - surface).abs());
            let least = d(a).min(d(b));
            if least.is_finite() { least } else { 0.0 }
        };
        let gain = step(self.at(x - 1, y), self.at(x + 1, y)) + step(self.at(x, y - 1), self.at(x, y + 1));
        let tolerance = gain + lens.footprint(surface) + 1e-6 * surface;
        Some((depth - surface) / tolerance)
    }
}

/// A place on a line about a pixel from the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Station {
    pub(crate) pixel: DVec2,
    /// Length of the line on the image from its beginning, pixels.
    pub(crate) arc_px: f64,
    pub(crate) visible: bool,
}

/// The parts of a piece on the image (`margin_px` around it included) as runs of stations with settled visibility.
pub(crate) fn stations(piece: &[PathPoint], lens: &Lens, map: DepthMap<'_>, margin_px: f64) -> Vec<Vec<Station>> {
    let mut runs = Vec::new();
    let mut run: Vec<Station> = Vec::new();
    let mut verdicts: Vec<Option<bool>> = Vec::new();
    let mut arc = 0.0;
    for pair in piece.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let length = (b.pixel - a.pixel).length();
        let Some([s, t]) = on_image(a.pixel, b.pixel, map, margin_px) else {
            settle(&mut run, &mut verdicts, &mut runs);
            arc += length;
            continue;
        };
        if s > 0.0 {
            settle(&mut run, &mut verdicts, &mut runs);
        }
        let n = ((t - s) * length).ceil().clamp(1.0, 1e6) as usize;
        for i in usize::from(!run.is_empty())..=n {
            let k = s + (t - s) * i as f64 / n as f64;
            let (pixel, depth) = (a.pixel.lerp(b.pixel, k), between(lens, a.depth, b.depth, k));
            run.push(Station { pixel, arc_px: arc + k * length, visible: true });
            verdicts.push(match map.behind(lens, pixel, depth) {
                Some(behind) if behind <= 1.0 => Some(true),
                Some(behind) if behind > HYSTERESIS => Some(false),
                _ => None,
            });
        }
        if t < 1.0 {
            settle(&mut run, &mut verdicts, &mut runs);
        }
        arc += length;
    }
    settle(&mut run, &mut verdicts, &mut runs);
    runs
}

/// Depth along a segment that is straight on the image.
fn between(lens: &Lens, a: f64, b: f64, k: f64) -> f64 {
    if lens.ortho { a + k * (b - a) } else { a * b / (b + k * (a - b)) }
}

/// Undecided stations follow the one before; then short runs go.
fn settle(run: &mut Vec<Station>, verdicts: &mut Vec<Option<bool>>, runs: &mut Vec<Vec<Station>>) {
    let mut state = verdicts.iter().flatten().next().copied().unwrap_or(true);
    for (station, verdict) in run.iter_mut().zip(verdicts.iter()) {
        state = verdict.unwrap_or(state);
        station.visible = state;
    }
    drop_short(run, false);
    drop_short(run, true);
    verdicts.clear();
    if run.len() > 1 {
        runs.push(std::mem::take(run));
    } else {
        run.clear();
    }
}

/// Turns runs of `visible` stations that are short and lie between two others into their opposite.
fn drop_short(run: &mut [Station], visible: bool) {
    let mut start = 0;
    while start < run.len() {
        let state = run[start].visible;
        let end = start + run[start..].iter().take_while(|s| s.visible == state).count();
        let inner = start > 0 && end < run.len();
        if state == visible && inner && run[end].arc_px - run[start - 1].arc_px < SHORTEST_RUN_PX {
            run[start..end].iter_mut().for_each(|s| s.visible = !visible);
        }
        start = end;
    }
}

/// Parameters of the part of a segment on the image.
fn on_image(a: DVec2, b: DVec2, map: DepthMap<'_>, margin: f64) -> Option<[f64; 2]> {
    let (lo, hi) = (-margin, DVec2::new(f64::from(map.width), f64::from(map.height)) + margin);
    let (mut s, mut t) = (0.0f64, 1.0f64);
    for (x, y) in [(a.x - lo, b.x - lo), (hi.x - a.x, hi.x - b.x), (a.y - lo, b.y - lo), (hi.y - a.y, hi.y - b.y)] {
        match (x >= 0.0, y >= 0.0) {
            (true, true) => {}
            (false, false) => return None,
            (true, false) => t = t.min(x / (x - y)),
            (false, true) => s = s.max(x / (x - y)),
        }
    }
    (s < t).then_some([s, t])
}

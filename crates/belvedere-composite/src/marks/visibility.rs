//! Visible and hidden parts of a line, stable from frame to frame.

use crate::depths::Depths;
use crate::marks::line_of_sight::LineOfSight;
use crate::marks::path::{LinePoint, PathPoint};
use crate::marks::segment;
use belvedere_core::DVec2;
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::Screen;

/// Hidden gaps shorter than this are closed, then visible specks shorter than this are dropped, pixels; up to twice this length
/// they are shortened, so that they grow continuously from nothing.
const SHORTEST_RUN_PX: f64 = 4.0;
/// Halvings that locate a change of visibility between two stations: to a few thousandths of a pixel.
const HALVINGS: u32 = 8;
/// Distance behind the surface at which a point counts as hidden without a line of sight, in units of the tolerance.
const HYSTERESIS: f64 = 2.5;

/// Depths of the surfaces at the pixel centres.
#[derive(Clone, Copy)]
pub(crate) struct DepthMap<'a> {
    pub(crate) depth: Depths<'a>,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl DepthMap<'_> {
    fn at(&self, x: i32, y: i32) -> Option<f64> {
        let inside = x >= 0 && y >= 0 && x < self.width && y < self.height;
        inside.then(|| match self.depth {
            Depths::Whole(depth) => f64::from(depth[y as usize * self.width as usize + x as usize]),
            Depths::Tiles(tiles) => f64::from(tiles.at(x as usize, y as usize)),
            Depths::Wanted(tiles) => {
                tiles.want(x as usize, y as usize);
                // Seen everywhere: no line of sight is needed to know which depths are read.
                f64::INFINITY
            }
        })
    }

    /// Whether the depths are only asked for.
    pub(crate) fn only_asks(&self) -> bool {
        matches!(self.depth, Depths::Wanted(_))
    }

    /// Distance of `depth` behind the surface seen at `pixel`, in units of the tolerance, which is the change of the surface's depth
    /// within a pixel plus the width of a pixel on it.
    pub(crate) fn behind(&self, screen: &Screen, pixel: DVec2, depth: f64) -> Option<f64> {
        let (x, y) = (pixel.x.floor() as i32, pixel.y.floor() as i32);
        let surface = self.at(x, y)?;
        if let Depths::Wanted(_) = self.depth {
            for (x, y) in [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)] {
                let _ = self.at(x, y);
            }
        }
        if !surface.is_finite() {
            return Some(f64::NEG_INFINITY);
        }
        let step = |a: Option<f64>, b: Option<f64>| {
            // The smaller of both differences: the surface continues on at least one side, also along a skyline.
            let d = |n: Option<f64>| n.map_or(f64::INFINITY, |n| (n - surface).abs());
            let least = d(a).min(d(b));
            if least.is_finite() { least } else { 0.0 }
        };
        let gain = step(self.at(x - 1, y), self.at(x + 1, y)) + step(self.at(x, y - 1), self.at(x, y + 1));
        let tolerance = gain + screen.footprint(surface) + 1e-6 * surface;
        Some((depth - surface) / tolerance)
    }
}

/// A sample of a line; stations are about a pixel apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Station {
    pub(crate) pixel: DVec2,
    /// Length of the line on the image from its beginning, pixels.
    pub(crate) arc_px: f64,
    pub(crate) on_line: LinePoint,
}

impl Station {
    pub(crate) fn lerp(&self, other: &Self, t: f64) -> Self {
        Self {
            pixel: self.pixel.lerp(other.pixel, t),
            arc_px: self.arc_px + t * (other.arc_px - self.arc_px),
            on_line: self.on_line.lerp(other.on_line, t),
        }
    }
}

/// A stretch of line on the image and its hidden parts.
#[derive(Debug, Default)]
pub(crate) struct Run {
    pub(crate) stations: Vec<Station>,
    /// Hidden stretches by `arc_px`, ascending, disjoint.
    pub(crate) hidden: Vec<[f64; 2]>,
}

impl Run {
    /// Stretches of equal visibility, in order, with exact ends.
    pub(crate) fn parts(&self) -> Vec<(bool, Vec<Station>)> {
        let [Some(first), Some(last)] = [self.stations.first(), self.stations.last()] else { return Vec::new() };
        let mut parts = Vec::new();
        let mut from = first.arc_px;
        for &[a, b] in &self.hidden {
            parts.push((true, self.cut(from, a)));
            parts.push((false, self.cut(a, b)));
            from = b;
        }
        parts.push((true, self.cut(from, last.arc_px)));
        parts.retain(|(_, part)| part.len() > 1);
        parts
    }

    fn cut(&self, from: f64, to: f64) -> Vec<Station> {
        let mut part = Vec::new();
        for pair in self.stations.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let length = b.arc_px - a.arc_px;
            if b.arc_px <= from || a.arc_px >= to || !(length > 0.0) {
                continue;
            }
            let share = |arc: f64| ((arc - a.arc_px) / length).clamp(0.0, 1.0);
            if part.is_empty() {
                part.push(a.lerp(b, share(from)));
            }
            part.push(a.lerp(b, share(to)));
        }
        part
    }
}

/// Judges the stations of a line: by the depth buffer where it is clear, else by lines of sight.
#[derive(Clone, Copy)]
pub(crate) struct LineVisibility<'a> {
    pub(crate) pass: &'a Pass<'a>,
    pub(crate) screen: &'a Screen,
    pub(crate) map: DepthMap<'a>,
    pub(crate) sight: &'a LineOfSight<'a>,
    pub(crate) lift_m: f64,
}

impl LineVisibility<'_> {
    /// The parts of a piece on the image (`margin_px` around it included).
    pub(crate) fn runs(&self, piece: &[PathPoint], margin_px: f64) -> Vec<Run> {
        let mut runs = Vec::new();
        let (mut run, mut verdicts): (Vec<Station>, Vec<Option<bool>>) = Default::default();
        let mut arc = 0.0;
        for pair in piece.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let length = (b.pixel - a.pixel).length();
            let Some([s, t]) = on_image(a.pixel, b.pixel, self.map, margin_px) else {
                self.settle(&mut run, &mut verdicts, &mut runs);
                arc += length;
                continue;
            };
            if s > 0.0 {
                self.settle(&mut run, &mut verdicts, &mut runs);
            }
            let n = ((t - s) * length).ceil().clamp(1.0, 1e6) as usize;
            for i in usize::from(!run.is_empty())..=n {
                let k = s + (t - s) * i as f64 / n as f64;
                let (pixel, depth) = (a.pixel.lerp(b.pixel, k), between(self.screen, a.depth, b.depth, k));
                // Share of the segment in the world; on the image the far half is shorter (perspective).
                let w = if self.screen.ortho { k } else { k * a.depth / (b.depth + k * (a.depth - b.depth)) };
                run.push(Station { pixel, arc_px: arc + k * length, on_line: a.on_line.lerp(b.on_line, w) });
                verdicts.push(match self.map.behind(self.screen, pixel, depth) {
                    Some(behind) if behind <= 1.0 => Some(true),
                    Some(behind) if behind > HYSTERESIS => Some(false),
                    _ => None,
                });
            }
            if t < 1.0 {
                self.settle(&mut run, &mut verdicts, &mut runs);
            }
            arc += length;
        }
        self.settle(&mut run, &mut verdicts, &mut runs);
        runs
    }

    fn settle(&self, run: &mut Vec<Station>, verdicts: &mut Vec<Option<bool>>, runs: &mut Vec<Run>) {
        let stations = std::mem::take(run);
        let verdicts = std::mem::take(verdicts);
        if stations.len() < 2 {
            return;
        }
        let states = self.states(&stations, &verdicts);
        let hidden = steady(self.hidden(&stations, &states), &stations);
        runs.push(Run { stations, hidden });
    }

    /// Whether each station is visible. Lines of sight decide where the depth buffer is in doubt and on both sides of every change, and
    /// further along until both agree.
    fn states(&self, stations: &[Station], verdicts: &[Option<bool>]) -> Vec<bool> {
        let n = stations.len();
        let mut states: Vec<bool> = Vec::with_capacity(n);
        let mut state = verdicts.iter().flatten().next().copied().unwrap_or(true);
        for verdict in verdicts {
            state = verdict.unwrap_or(state);
            states.push(state);
        }
        let differs = |i: usize, j: usize| verdicts[i].is_none() || verdicts[i] != verdicts[j];
        let mut tested = vec![false; n];
        let mut open: Vec<usize> =
            (0..n).filter(|&i| differs(i, i.saturating_sub(1)) || differs(i, (i + 1).min(n - 1))).collect();
        while let Some(i) = open.pop() {
            if std::mem::replace(&mut tested[i], true) {
                continue;
            }
            let Some(visible) = self.sees(&stations[i].on_line) else { continue };
            states[i] = visible;
            if verdicts[i] != Some(visible) {
                open.extend([i.checked_sub(1), Some(i + 1).filter(|&j| j < n)].into_iter().flatten());
            }
        }
        states
    }

    /// Whether the eye sees a point of the line; `None` if the line of sight cannot tell.
    fn sees(&self, on_line: &LinePoint) -> Option<bool> {
        let p = self.sight.on_surface(on_line, self.lift_m);
        let v = self.screen.view_from(self.pass.displace(p)?);
        if !v.is_finite() || !self.screen.is_drawable(v) {
            return None;
        }
        self.sight.sees(self.screen, self.screen.pixel(v), v.z)
    }

    /// Hidden stretches, their ends found by halving.
    fn hidden(&self, stations: &[Station], states: &[bool]) -> Vec<[f64; 2]> {
        let mut hidden = Vec::new();
        let mut from = (!states[0]).then_some(stations[0].arc_px);
        for (pair, state) in stations.windows(2).zip(states.windows(2)) {
            if state[0] == state[1] {
                continue;
            }
            let at = self.crossing(&pair[0], &pair[1], state[0]);
            match from.take() {
                Some(start) => hidden.push([start, at]),
                None => from = Some(at),
            }
        }
        if let (Some(start), Some(last)) = (from, stations.last()) {
            hidden.push([start, last.arc_px]);
        }
        hidden
    }

    fn crossing(&self, a: &Station, b: &Station, visible_at_a: bool) -> f64 {
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (lo + hi);
            match self.sees(&a.on_line.lerp(b.on_line, middle)) {
                Some(visible) if visible == visible_at_a => lo = middle,
                Some(_) => hi = middle,
                None => break,
            }
        }
        a.arc_px + 0.5 * (lo + hi) * (b.arc_px - a.arc_px)
    }
}

/// Closes short hidden gaps, then drops short visible specks. Somewhat longer ones are shortened, so that they grow continuously from
/// nothing as the camera moves.
fn steady(hidden: Vec<[f64; 2]>, stations: &[Station]) -> Vec<[f64; 2]> {
    let (Some(first), Some(last)) = (stations.first(), stations.last()) else { return hidden };
    let ends = [first.arc_px, last.arc_px];
    let mut gaps: Vec<[f64; 2]> = Vec::new();
    for gap in hidden {
        if gap[0] <= ends[0] || gap[1] >= ends[1] {
            gaps.push(gap);
        } else if let Some(less) = shrunk(gap) {
            gaps.push(less);
        }
    }
    // The visible specks are the gaps of the hidden stretches.
    let mut out: Vec<[f64; 2]> = Vec::new();
    for gap in gaps {
        match out.last_mut() {
            None => out.push(gap),
            Some(before) => match shrunk([before[1], gap[0]]) {
                None => before[1] = gap[1],
                Some([a, b]) => {
                    before[1] = a;
                    out.push([b, gap[1]]);
                }
            },
        }
    }
    out
}

/// A stretch as drawn: empty up to [`SHORTEST_RUN_PX`], whole from twice that on, continuous between.
fn shrunk([a, b]: [f64; 2]) -> Option<[f64; 2]> {
    let length = b - a;
    let drawn = if length >= 2.0 * SHORTEST_RUN_PX { length } else { 2.0 * (length - SHORTEST_RUN_PX) };
    let off = 0.5 * (length - drawn);
    (drawn > 0.0).then_some([a + off, b - off])
}

/// Depth along a segment that is straight on the image.
fn between(screen: &Screen, a: f64, b: f64, k: f64) -> f64 {
    if screen.ortho { a + k * (b - a) } else { a * b / (b + k * (a - b)) }
}

/// Parameters of the part of a segment on the image.
fn on_image(a: DVec2, b: DVec2, map: DepthMap<'_>, margin: f64) -> Option<[f64; 2]> {
    let (lo, hi) = (-margin, DVec2::new(f64::from(map.width), f64::from(map.height)) + margin);
    segment::within([(a.x - lo, b.x - lo), (hi.x - a.x, hi.x - b.x), (a.y - lo, b.y - lo), (hi.y - a.y, hi.y - b.y)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawn::Sight;
    use crate::marks::path;
    use belvedere_core::{DVec3, Pinhole, Projection, View};
    use belvedere_scene::Scene;

    /// There is no surface.
    struct Empty;

    impl Sight for Empty {
        fn first_depth(&self, _: DVec2) -> Option<f64> {
            Some(f64::INFINITY)
        }
    }

    #[test]
    fn shares_along_a_line_are_those_of_perspective() {
        let lens = Projection::Perspective { fov_y: 0.9 };
        let pinhole = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [320, 240], 1.0, None).unwrap();
        let (scene, screen, depth) = (Scene::default(), Screen::new(&pinhole), vec![f32::INFINITY; 320 * 240]);
        let sight = LineOfSight { scene: &scene, sight: &Empty };
        let map = DepthMap { depth: Depths::Whole(&depth), width: 320, height: 240 };
        let view = View::straight(pinhole.clone());
        let pass = &Pass::all(&view)[0];
        let visibility = LineVisibility { pass, screen: &screen, map, sight: &sight, lift_m: 0.0 };
        // From near to forty times as far.
        let line = path::as_given(&[DVec3::new(-20.0, 50.0, -5.0), DVec3::new(600.0, 2000.0, -40.0)]);
        let pieces = path::project(pass, &screen, &line, 0.5);
        let runs: Vec<Run> = pieces.iter().flat_map(|piece| visibility.runs(piece, 0.0)).collect();
        let stations: Vec<&Station> = runs.iter().flat_map(|run| &run.stations).collect();
        assert!(stations.len() > 50, "{}", stations.len());
        for s in stations {
            let image = screen.pixel(screen.view_from(s.on_line.p));
            assert!(image.distance(s.pixel) < 1e-6, "{image} is drawn at {}", s.pixel);
            let along = s.on_line.p.distance(line[0].p);
            assert!((s.on_line.along - along).abs() < 1e-6, "{} of {along}", s.on_line.along);
        }
    }
}

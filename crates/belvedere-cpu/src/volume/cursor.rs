//! The samples of a ray, in stretches: those that lie on one segment.

use super::clip::Segment;
use belvedere_core::DVec3;

/// Samples a step apart on one segment, in single precision. Positions are cubics over the distance from the start of the segment, in
/// steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) c: [[f32; 3]; 4],
    /// Bound on half the second derivative, per axis; 0 for a straight one.
    pub(super) bend: [f32; 3],
    /// Distance of the first sample, and a bound on that of the last.
    pub(super) first: f32,
    pub(super) last: f32,
    /// Number of samples.
    pub(super) count: f32,
    /// Share of a step that the last sample counts for.
    pub(super) share: f32,
}

/// Goes along a ray. Adjoining segments are a run, with samples at `(k + within)` steps of their joint length; the last, shorter step ends
/// with them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor<'s> {
    segments: &'s [Segment],
    step: f64,
    /// Place of samples within their steps, 0..=1.
    within: f64,
    /// First segment of the run, and the one past its last.
    run: [usize; 2],
    /// The current segment, and its start and end in steps from the beginning of the run.
    at: usize,
    start: f64,
    end: f64,
    /// Numbers of the first sample of the stretch and of the one past its last.
    taken: [f64; 2],
    /// Whole steps of the run, and the shorter one after them; 0 where there is none.
    whole: f64,
    part: f64,
}

impl<'s> Cursor<'s> {
    /// * `segments`: not empty.
    pub(super) fn new(segments: &'s [Segment], step: f64, within: f64) -> Self {
        let mut out = Self {
            segments,
            step,
            within,
            run: [0; 2],
            at: 0,
            start: 0.0,
            end: 0.0,
            taken: [0.0; 2],
            whole: 0.0,
            part: 0.0,
        };
        out.begin(0);
        out
    }

    fn begin(&mut self, first: usize) {
        let adjoining = self.segments[first + 1..].iter().take_while(|s| !s.is_new).count();
        self.run = [first, first + 1 + adjoining];
        let total = self.segments[first..self.run[1]].iter().map(|s| s.length).sum::<f64>() / self.step;
        // Rounding must not add a step.
        self.whole = (total + 1e-6).floor();
        self.part = if total - self.whole > 1e-6 { total - self.whole } else { 0.0 };
        (self.at, self.start, self.end) = (first, 0.0, self.segments[first].length / self.step);
        self.taken = [0.0; 2];
    }

    /// The next stretch.
    pub(super) fn next(&mut self) -> Option<Stretch> {
        let mut samples = self.whole + self.part.ceil();
        while self.taken[1] >= samples {
            if self.run[1] == self.segments.len() {
                return None;
            }
            self.begin(self.run[1]);
            samples = self.whole + self.part.ceil();
        }
        let k = self.taken[1];
        let way = k + self.within;
        while way >= self.end && self.at + 1 < self.run[1] {
            self.at += 1;
            self.start = self.end;
            self.end += self.segments[self.at].length / self.step;
        }
        let is_last = self.at + 1 == self.run[1];
        let count = if is_last { samples - k } else { (self.end - way).ceil().clamp(1.0, samples - k) };
        self.taken = [k, k + count];
        let ends = self.taken[1] > self.whole;
        let last = if ends { (self.whole + self.within * self.part - self.start).max(0.0) } else { f64::INFINITY };
        let segment = &self.segments[self.at];
        let per_step = self.step / segment.length;
        let mut scale = 1.0;
        let c = segment.curve.0.map(|c| {
            let scaled = (c * scale).as_vec3().to_array();
            scale *= per_step;
            scaled
        });
        let steps = (self.end - self.start) as f32;
        Some(Stretch {
            c,
            bend: std::array::from_fn(|a| c[2][a].abs() + 3.0 * steps * c[3][a].abs()),
            first: (way - self.start) as f32,
            last: last as f32,
            count: count as f32,
            share: if ends { self.part as f32 } else { 1.0 },
        })
    }

    /// Depth and lattice position within sample `m` of the stretch.
    ///
    /// * `within`: share of its step, 0..=1.
    pub(super) fn place(&self, m: f32, within: f64) -> (f64, DVec3) {
        let k = self.taken[0] + f64::from(m);
        let way = if k < self.whole { k + within } else { self.whole + within * self.part };
        let mut start = 0.0;
        let [first, past] = self.run;
        for (i, segment) in self.segments[first..past].iter().enumerate() {
            let end = start + segment.length / self.step;
            if way < end || first + i + 1 == past {
                let t = ((way - start) / (end - start)).clamp(0.0, 1.0);
                return (segment.depth.at(t), segment.curve.at(t));
            }
            start = end;
        }
        (0.0, DVec3::ZERO)
    }
}

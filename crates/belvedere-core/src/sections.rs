//! Styling sections: which representation is shown where along the deformation curve.

use serde::{Deserialize, Serialize};

/// Border between two styling sections.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TagPoint {
    /// Position on the curve as a share of its arc length, 0..=1.
    pub u: f64,
    /// Half width of the transition, share of the arc length, >= 0.
    #[serde(default)]
    pub delta: f64,
}

/// Two lists of styling sections over common tag points, cross-faded by `beta`.
///
/// Weights are functions of `t`, the arc length along the curve as a share of its length (below 0 and above 1 on the extensions).
/// For every `t` the weights of the sections are non-negative and sum to 1, also where transitions overlap.
///
/// Source: Pasewaldt et al. 2011, section 4.4; the monotone steps are ours (the printed ramps leave holes).
#[derive(Debug, Clone, PartialEq)]
pub struct StylingSections {
    tags: Vec<TagPoint>,
    start: Vec<String>,
    target: Vec<String>,
    beta: f64,
    /// The distinct ids, in order of first appearance: all of `start` before those of `target`.
    representations: Vec<String>,
    /// Per section the indices in `representations` of its start and its target.
    numbers: Vec<[usize; 2]>,
}

/// Most different representations of a document.
pub const MOST_REPRESENTATIONS: usize = 32;

impl StylingSections {
    /// Sections `start` fading to `target`, both with one more entry than `tags`; `beta` in 0..=1 is the share of `target`.
    /// `None` if the numbers do not fit or a value is not finite.
    pub fn new(tags: Vec<TagPoint>, start: Vec<String>, target: Vec<String>, beta: f64) -> Option<Self> {
        let fits = start.len() == tags.len() + 1 && target.len() == start.len();
        let finite = tags.iter().all(|t| t.u.is_finite() && t.delta.is_finite()) && (0.0..=1.0).contains(&beta);
        let mut representations: Vec<String> = Vec::new();
        for id in start.iter().chain(&target) {
            if !representations.contains(id) {
                representations.push(id.clone());
            }
        }
        let few = representations.len() <= MOST_REPRESENTATIONS;
        let number = |id: &String| representations.iter().position(|r| r == id).unwrap_or(0);
        let numbers = start.iter().zip(&target).map(|(a, b)| [number(a), number(b)]).collect();
        (fits && finite && few).then_some(Self { tags, start, target, beta, representations, numbers })
    }

    /// One section of the representation `all`.
    pub fn plain() -> Self {
        let all = vec!["all".to_owned()];
        let (start, target) = (all.clone(), all.clone());
        Self { tags: Vec::new(), start, target, beta: 0.0, representations: all, numbers: vec![[0, 0]] }
    }

    /// Number of sections, at least 1.
    pub fn len(&self) -> usize {
        self.start.len()
    }

    /// Never: there is at least one section.
    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// Tag points between the sections.
    pub fn tags(&self) -> &[TagPoint] {
        &self.tags
    }

    /// Share of the target representations, 0..=1.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Representations of section `i` before and after the transition.
    pub fn ids(&self, i: usize) -> Option<(&str, &str)> {
        Some((self.start.get(i)?, self.target.get(i)?))
    }

    /// Weight of each section at `t`, near to far.
    pub fn weights(&self, t: f64) -> Vec<f64> {
        let mut step = 1.0;
        let mut weights = Vec::with_capacity(self.len());
        for tag in &self.tags {
            let next = ramp(tag, t).min(step);
            weights.push(step - next);
            step = next;
        }
        weights.push(step);
        weights
    }

    /// The distinct representations, in order of first appearance.
    pub fn representations(&self) -> Vec<&str> {
        self.representations.iter().map(String::as_str).collect()
    }

    /// Number, in [`Self::representations`], of the representation that a threshold in 0..1 shows at `t`.
    ///
    /// At every `t` the representations own half-open intervals of 0..1, one after the other, as long as their weights: exactly one is
    /// shown. Source: ours; the mean over all thresholds is the weighted composite of Pasewaldt et al. 2011, section 4.4.
    pub fn shown(&self, t: f64, threshold: f64) -> usize {
        let (ends, count) = (self.interval_ends(t), self.representations.len());
        let last = (1..count).rev().find(|&i| ends[i] > ends[i - 1]).unwrap_or(0);
        ends[..count].iter().position(|end| threshold < *end).unwrap_or(last)
    }

    /// End of each representation's interval at `t`, rising to 1, see [`Self::shown`]; entries past the last one have no meaning.
    pub fn interval_ends(&self, t: f64) -> [f64; MOST_REPRESENTATIONS] {
        let mut shares = [0.0; MOST_REPRESENTATIONS];
        let mut step = 1.0;
        for (i, &[start, target]) in self.numbers.iter().enumerate() {
            let next = self.tags.get(i).map_or(0.0, |tag| ramp(tag, t).min(step));
            shares[start] += (step - next) * (1.0 - self.beta);
            shares[target] += (step - next) * self.beta;
            step = next;
        }
        let mut sum = 0.0;
        for share in &mut shares[..self.representations.len()] {
            sum += *share;
            *share = sum;
        }
        shares
    }

    /// Values of `t`, ascending, at which the slope of a weight may change: the ends of the transitions, and where their ramps cross.
    pub fn knees(&self) -> Vec<f64> {
        let ramps = self.tags.iter().map(|tag| [tag.u - tag.delta, tag.u + tag.delta]);
        let mut knees: Vec<f64> = ramps.clone().flatten().collect();
        for (a, b) in ramps.clone().enumerate().flat_map(|(i, a)| ramps.clone().skip(i + 1).map(move |b| (a, b))) {
            let (wide, apart) = ([a[1] - a[0], b[1] - b[0]], b[0] - a[0]);
            // (t - a0) / wide_a = (t - b0) / wide_b
            let crossing = a[0] - apart * wide[0] / (wide[1] - wide[0]);
            knees.extend(Some(crossing).filter(|t| t.is_finite() && a[0].max(b[0]) <= *t && *t <= a[1].min(b[1])));
        }
        knees.sort_by(f64::total_cmp);
        knees
    }

    /// The representations, as bits of their numbers, that may have a weight anywhere between `t0` and `t1`.
    pub fn supported(&self, [t0, t1]: [f64; 2]) -> u32 {
        let from = |i: usize| i.checked_sub(1).map_or(f64::NEG_INFINITY, |i| self.tags[i].u - self.tags[i].delta);
        let to = |i: usize| self.tags.get(i).map_or(f64::INFINITY, |tag| tag.u + tag.delta);
        let held = |i: &usize| from(*i) <= t1 && t0 <= to(*i);
        let bits = |i: usize| {
            let [start, target] = self.numbers[i];
            (if self.beta < 1.0 { 1 << start } else { 0 }) | (if self.beta > 0.0 { 1 << target } else { 0 })
        };
        (0..self.len()).filter(held).map(bits).fold(0, |all, bit: u32| all | bit)
    }

    /// Weight of representation `id` at `t`: the section weights, cross-faded by `beta`; 0 for an id that does not occur.
    pub fn representation_weight(&self, id: &str, t: f64) -> f64 {
        let share = |i: usize| {
            let before = if self.start[i] == id { 1.0 - self.beta } else { 0.0 };
            before + if self.target[i] == id { self.beta } else { 0.0 }
        };
        self.weights(t).iter().enumerate().map(|(i, w)| w * share(i)).sum()
    }
}

/// Step from 0 to 1 at a tag, over the width of its transition.
fn ramp(tag: &TagPoint, t: f64) -> f64 {
    if tag.delta < 1e-12 || t.is_nan() {
        return if t >= tag.u { 1.0 } else { 0.0 };
    }
    ((t - tag.u + tag.delta) / (2.0 * tag.delta)).clamp(0.0, 1.0)
}

//! Matching two lists of styling sections of different lengths.

use super::Preset;
use crate::sections::TagPoint;

/// Indices of matched sections of both presets; `None` = without partner.
type Pair = (Option<usize>, Option<usize>);

/// One preset's sections after matching.
pub(super) struct Aligned {
    pub(super) tags: Vec<TagPoint>,
    pub(super) sections: Vec<String>,
}

/// Both presets' sections, split so that both lists have the same length and matched sections the same index.
///
/// Lists of equal length are matched by index, as in Pasewaldt et al. 2011, section 5: equal ids at different indices are not matched.
/// Of lists of different lengths the cheapest edit is taken: the same id 0, another id 1, a section without partner 0.5 + its length. Where a section has no
/// partner the other preset's neighbouring section is split in two of the same id, with a border of no width, which changes no weight.
pub(super) fn align(p: &Preset, q: &Preset) -> [Aligned; 2] {
    let pairs = if p.sections.len() == q.sections.len() { by_index(p.sections.len()) } else { pair(p, q) };
    let indices = |side: fn(&Pair) -> Option<usize>| -> Vec<usize> {
        let first = pairs.iter().find_map(side).unwrap_or(0);
        pairs
            .iter()
            .scan(first, |last, pair| {
                *last = side(pair).unwrap_or(*last);
                Some(*last)
            })
            .collect()
    };
    let (at_p, at_q) = (indices(|pair| pair.0), indices(|pair| pair.1));
    [split(p, &at_p, q, &at_q), split(q, &at_q, p, &at_p)]
}

/// Pairs of equal index.
fn by_index(count: usize) -> Vec<Pair> {
    (0..count).map(|i| (Some(i), Some(i))).collect()
}

/// Start and end of section `i` on the curve.
fn extent(preset: &Preset, i: usize) -> [f64; 2] {
    let from = if i == 0 { 0.0 } else { border(preset, i - 1).u };
    [from, border(preset, i).u]
}

/// Border `i`; the end of the curve after the last one.
fn border(preset: &Preset, i: usize) -> TagPoint {
    preset.tags.get(i).copied().unwrap_or(TagPoint { u: 1.0, delta: 0.0 })
}

/// Pairs by edit distance; every entry advances at least one side.
fn pair(p: &Preset, q: &Preset) -> Vec<Pair> {
    let (m, n) = (p.sections.len(), q.sections.len());
    let alone = |preset: &Preset, i: usize| {
        let [from, to] = extent(preset, i);
        0.5 + to - from
    };
    let together = |i: usize, j: usize| if p.sections[i] == q.sections[j] { 0.0 } else { 1.0 };
    let mut cost = vec![vec![0.0; n + 1]; m + 1];
    for i in (0..=m).rev() {
        for j in (0..=n).rev() {
            let mut best = if i == m && j == n { 0.0 } else { f64::INFINITY };
            if i < m && j < n {
                best = together(i, j) + cost[i + 1][j + 1];
            }
            if j < n {
                best = f64::min(best, alone(q, j) + cost[i][j + 1]);
            }
            if i < m {
                best = f64::min(best, alone(p, i) + cost[i + 1][j]);
            }
            cost[i][j] = best;
        }
    }
    let (mut i, mut j, mut pairs) = (0, 0, Vec::new());
    while i < m || j < n {
        if i < m && j < n && cost[i][j] == together(i, j) + cost[i + 1][j + 1] {
            pairs.push((Some(i), Some(j)));
            (i, j) = (i + 1, j + 1);
        } else if j < n && cost[i][j] == alone(q, j) + cost[i][j + 1] {
            pairs.push((None, Some(j)));
            j += 1;
        } else {
            pairs.push((Some(i), None));
            i += 1;
        }
    }
    pairs
}

/// Sections `at` of `preset`; a section that occurs twice in a row is split where `other` has its border.
fn split(preset: &Preset, at: &[usize], other: &Preset, other_at: &[usize]) -> Aligned {
    let sections = at.iter().map(|&i| preset.sections[i].clone()).collect();
    let tags = (1..at.len())
        .map(|k| {
            if at[k] != at[k - 1] {
                return border(preset, at[k - 1]);
            }
            let [from, to] = extent(preset, at[k]);
            // A border inside the section's own far transition would cut that off.
            let to = to - border(preset, at[k]).delta;
            TagPoint { u: border(other, other_at[k - 1]).u.max(from).min(to), delta: 0.0 }
        })
        .collect();
    Aligned { tags, sections }
}

//! Streets that go on straight through crossings are one run; long runs are main streets where no class says so.
//!
//! Source: the principle of good continuation, Thomson and Richardson, "The 'good continuation' principle of perceptual
//! organization applied to the generalization of road networks", ICC 1999; thresholds are ours.

use belvedere_core::DVec2;
use belvedere_scene::city::Way;
use std::collections::BTreeMap;

/// Largest bend at which a street goes on, radians.
const MOST_BEND: f64 = std::f64::consts::FRAC_PI_4;
/// Share of the length of all streets that main runs make up.
const MAIN_SHARE: f64 = 1.0 / 3.0;

/// Streets of the longest runs, a third of the length of all of `streets` (indices in `ways`).
pub(super) fn longest_strokes(ways: &[Way], streets: &[usize]) -> Vec<usize> {
    let mut root: Vec<usize> = (0..streets.len()).collect();
    for [a, b] in continuations(ways, streets) {
        let [a, b] = [a, b].map(|i| find(&root, i));
        root[a.max(b)] = a.min(b);
    }
    let length = |i: usize| ways[streets[i]].points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
    let mut runs: BTreeMap<usize, f64> = BTreeMap::new();
    for i in 0..streets.len() {
        *runs.entry(find(&root, i)).or_default() += length(i);
    }
    let total: f64 = runs.values().sum();
    let mut order: Vec<(usize, f64)> = runs.into_iter().collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut kept = 0.0;
    let main: Vec<usize> = order
        .into_iter()
        .take_while(|(_, length)| {
            let more = kept < MAIN_SHARE * total;
            kept += length;
            more
        })
        .map(|(run, _)| run)
        .collect();
    (0..streets.len()).filter(|i| main.contains(&find(&root, *i))).map(|i| streets[i]).collect()
}

fn find(root: &[usize], mut i: usize) -> usize {
    while root[i] != i {
        i = root[i];
    }
    i
}

/// Pairs of streets that continue each other where their ends meet: at every end the straightest pairs first.
fn continuations(ways: &[Way], streets: &[usize]) -> Vec<[usize; 2]> {
    let key = |p: DVec2| [(p.x * 2.0).round() as i64, (p.y * 2.0).round() as i64];
    let mut ends: BTreeMap<[i64; 2], Vec<(usize, DVec2)>> = BTreeMap::new();
    for (i, street) in streets.iter().enumerate() {
        let points = &ways[*street].points;
        let n = points.len();
        for (at, next) in [(points[0], points[1]), (points[n - 1], points[n - 2])] {
            ends.entry(key(at)).or_default().push((i, (next - at).normalize_or_zero()));
        }
    }
    let mut found = Vec::new();
    for meeting in ends.values() {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for a in 0..meeting.len() {
            for b in a + 1..meeting.len() {
                let bend = (-meeting[a].1).dot(meeting[b].1).clamp(-1.0, 1.0).acos();
                if bend <= MOST_BEND && meeting[a].0 != meeting[b].0 {
                    pairs.push((bend, a, b));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut taken = vec![false; meeting.len()];
        for (_, a, b) in pairs {
            if !taken[a] && !taken[b] {
                (taken[a], taken[b]) = (true, true);
                found.push([meeting[a].0, meeting[b].0]);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::city::WayClass;

    fn way(points: [[f64; 2]; 2]) -> Way {
        Way { name: String::new(), class: WayClass::Residential, points: points.map(DVec2::from).to_vec() }
    }

    #[test]
    fn a_street_through_a_crossing_is_one_run() {
        let ways = [
            way([[0.0, 0.0], [100.0, 2.0]]),
            way([[100.0, 2.0], [200.0, 0.0]]),
            way([[100.0, 2.0], [100.0, 60.0]]),
            way([[100.0, 2.0], [110.0, -60.0]]),
        ];
        assert_eq!(longest_strokes(&ways, &[0, 1, 2, 3]), [0, 1]);
        assert_eq!(longest_strokes(&ways, &[2, 3]), [2, 3], "they go on in each other");
        assert_eq!(longest_strokes(&ways, &[]), [0usize; 0]);
    }
}

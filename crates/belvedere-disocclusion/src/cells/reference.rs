//! Plain reference of the partition into cells, for tests.

use super::super::Field;
use super::NO_CELL;
use std::collections::BTreeMap;

/// Label (the node of the summit) of every node, and the persistence of every kept summit.
pub(super) fn partition(field: &Field, keep: usize) -> (Vec<u32>, BTreeMap<u32, f64>) {
    let (cols, heights) = (field.cols(), field.heights());
    let nodes: Vec<usize> = (0..heights.len()).filter(|&i| !field.void()[i]).collect();
    let key = |i: usize| (heights[i], i);
    let higher = |i: usize, j: usize| key(i).partial_cmp(&key(j)).unwrap().is_gt();
    let touching = |i: usize| {
        let (c, r) = ((i % cols) as isize, (i / cols) as isize);
        let all = (-1..=1).flat_map(move |y| (-1..=1).map(move |x| (c + x, r + y)));
        let (w, h) = (cols as isize, field.rows() as isize);
        let inside = all.filter(move |&(x, y)| (x, y) != (c, r) && x >= 0 && y >= 0 && x < w && y < h);
        inside.map(move |(x, y)| (y * w + x) as usize).filter(|&j| !field.void()[j])
    };
    let metres = |i: usize, j: usize| (field.node(i) * field.spacing() - field.node(j) * field.spacing()).length();
    let step_up = |i: usize| {
        let up = touching(i).filter(|&j| higher(j, i)).map(|j| ((heights[j] - heights[i]) * (1.0 / metres(i, j)), j));
        up.max_by(|a, b| a.partial_cmp(b).unwrap()).map(|(_, j)| j)
    };
    let summit = |i: usize| std::iter::successors(Some(i), |&i| step_up(i)).last().unwrap_or(i);
    let region: BTreeMap<usize, usize> = nodes.iter().map(|&i| (i, summit(i))).collect();

    let mut saddles: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for &i in &nodes {
        for j in touching(i).filter(|j| region[j] != region[&i]) {
            let pair = (region[&i].min(region[&j]), region[&i].max(region[&j]));
            let lower = if higher(i, j) { j } else { i };
            let best = saddles.entry(pair).or_insert(lower);
            if higher(lower, *best) {
                *best = lower;
            }
        }
    }
    let mut descending: Vec<_> = saddles.into_iter().collect();
    descending.sort_by(|(p, a), (q, b)| key(*b).partial_cmp(&key(*a)).unwrap().then(p.cmp(q)));

    let mut component: BTreeMap<usize, usize> = region.values().map(|&s| (s, s)).collect();
    let mut died: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
    for ((a, b), saddle) in descending {
        let (ca, cb) = (component[&a], component[&b]);
        if ca == cb {
            continue;
        }
        let (stays, goes, beyond) = if higher(ca, cb) { (ca, cb, a) } else { (cb, ca, b) };
        died.insert(goes, (heights[goes] - heights[saddle], beyond));
        component.values_mut().filter(|c| **c == goes).for_each(|c| *c = stays);
    }
    let persistence = |s: usize| died.get(&s).map_or(f64::INFINITY, |d| d.0);
    let mut ranked: Vec<usize> = component.keys().copied().collect();
    ranked.sort_by(|&a, &b| (persistence(b), heights[b], b).partial_cmp(&(persistence(a), heights[a], a)).unwrap());
    let endless = ranked.iter().filter(|&&s| !died.contains_key(&s)).count();
    ranked.truncate(keep.max(endless));
    let follow = |s: usize| {
        let mut into = std::iter::successors(Some(s), |s| died.get(s).map(|merged| merged.1));
        into.find(|s| ranked.contains(s)).unwrap() as u32
    };
    let labels = (0..heights.len()).map(|i| region.get(&i).map_or(NO_CELL, |&s| follow(s))).collect();
    (labels, ranked.iter().map(|&s| (s as u32, persistence(s))).collect())
}

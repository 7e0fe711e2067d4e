//! Ways whose pieces are features of their own, as maps cut roads and rivers at every crossing.

use belvedere_core::DVec3;
use belvedere_scene::LineFeature;
use std::collections::HashMap;

/// Ends that lie in one cube of this side meet, scene units.
const MEET: f64 = 0.1;

/// A way: one feature, or several of one name that follow each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    /// Index of its first piece in the layer.
    pub(super) first: usize,
    pub(super) points: Vec<DVec3>,
}

/// The ways of the features of a layer that have a name. Pieces are joined where exactly two of one name meet; a fork stays apart.
pub(super) fn of(features: &[LineFeature]) -> Vec<Way> {
    let mut named: HashMap<&str, Vec<usize>> = HashMap::new();
    for (i, feature) in features.iter().enumerate().filter(|(_, f)| !f.name.trim().is_empty() && f.points.len() > 1) {
        named.entry(feature.name.trim()).or_default().push(i);
    }
    let mut ways: Vec<Way> = named.into_values().flat_map(|pieces| joined(features, &pieces)).collect();
    ways.sort_by_key(|way| way.first);
    ways
}

type Corner = [i64; 3];

fn corner(p: DVec3) -> Corner {
    p.to_array().map(|v| (v / MEET).round().clamp(-1e15, 1e15) as i64)
}

fn ends(feature: &LineFeature) -> [Corner; 2] {
    let last = feature.points.len() - 1;
    [0, last].map(|i| corner(feature.points[i]))
}

/// * `pieces`: features of one name with at least two points.
fn joined(features: &[LineFeature], pieces: &[usize]) -> Vec<Way> {
    let mut meeting: HashMap<Corner, Vec<usize>> = HashMap::new();
    for &i in pieces {
        for end in ends(&features[i]) {
            meeting.entry(end).or_default().push(i);
        }
    }
    let mut used: HashMap<usize, bool> = pieces.iter().map(|i| (*i, false)).collect();
    let mut ways = Vec::new();
    for &first in pieces {
        if used.insert(first, true) == Some(true) {
            continue;
        }
        let mut next = |end: Corner| -> Option<usize> {
            let here = meeting.get(&end).filter(|here| here.len() == 2)?;
            let other = here.iter().copied().find(|i| used.get(i) == Some(&false))?;
            used.insert(other, true);
            Some(other)
        };
        let mut points = features[first].points.clone();
        for _ in 0..2 {
            while let Some(other) = points.last().and_then(|last| next(corner(*last))) {
                let more = &features[other].points;
                let is_forward = points.last().map(|last| corner(*last)) == more.first().map(|p| corner(*p));
                match is_forward {
                    true => points.extend(more.iter().skip(1)),
                    false => points.extend(more.iter().rev().skip(1)),
                }
            }
            // Then from the other end, and back into the direction of the first piece.
            points.reverse();
        }
        ways.push(Way { first, points });
    }
    ways
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(name: &str, xs: &[f64]) -> LineFeature {
        let points = xs.iter().map(|x| DVec3::new(*x, 2.0 * x, 0.0)).collect();
        LineFeature { name: name.to_owned(), style: None, points }
    }

    fn run(way: &Way) -> Vec<f64> {
        let mut xs: Vec<f64> = way.points.iter().map(|p| p.x).collect();
        if xs[0] > xs[xs.len() - 1] {
            xs.reverse();
        }
        xs
    }

    #[test]
    fn pieces_of_one_name_are_one_way_in_any_order_and_direction() {
        let pieces = [
            piece("Inn", &[20.0, 25.0, 30.0]),
            piece("", &[0.0, 100.0]),
            piece("Inn", &[10.0, 0.0]),
            piece("Inn", &[20.0, 10.0]),
            piece("Sill", &[30.0, 40.0]),
            piece("Inn", &[50.0, 60.0]),
        ];
        let ways = of(&pieces);
        let told: Vec<(usize, Vec<f64>)> = ways.iter().map(|way| (way.first, run(way))).collect();
        let inn = vec![0.0, 10.0, 20.0, 25.0, 30.0];
        assert_eq!(told, [(0, inn), (4, vec![30.0, 40.0]), (5, vec![50.0, 60.0])]);
    }

    #[test]
    fn forks_stay_apart_and_rings_end() {
        let fork = [piece("A", &[0.0, 10.0]), piece("A", &[10.0, 20.0]), piece("A", &[10.0, 30.0])];
        assert_eq!(of(&fork).len(), 3);
        let corners = [DVec3::ZERO, DVec3::X * 9.0, DVec3::Y * 9.0];
        let side =
            |i: usize| LineFeature { name: "R".into(), style: None, points: vec![corners[i], corners[(i + 1) % 3]] };
        let ring = [side(0), side(1), side(2)];
        let ways = of(&ring);
        assert_eq!((ways.len(), ways[0].points.len()), (1, 4));
    }
}

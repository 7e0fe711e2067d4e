//! A polyline by arc length, and its simplification.

use super::turns::HAIRPIN;
use belvedere_core::DVec3;

/// Where a simplified path turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Control {
    /// Arc length of the path there.
    pub(super) s: f64,
    pub(super) at: DVec3,
    /// Half the length over which the path itself turns here; `None` if it turns at once.
    pub(super) half_length: Option<f64>,
}

/// A polyline by its arc length, scene units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Path {
    points: Vec<DVec3>,
    along: Vec<f64>,
}

impl Path {
    /// Points that coincide with the one before, or are not finite, are left out.
    pub(super) fn new(points: &[DVec3]) -> Self {
        let mut kept: Vec<DVec3> = Vec::with_capacity(points.len());
        for &p in points.iter().filter(|p| p.is_finite()) {
            if kept.last().is_none_or(|last| last.distance(p) > 1e-9 * (1.0 + p.length())) {
                kept.push(p);
            }
        }
        let mut along = vec![0.0; kept.len()];
        for i in 1..kept.len() {
            along[i] = along[i - 1] + kept[i].distance(kept[i - 1]);
        }
        Self { points: kept, along }
    }

    pub(super) fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// The point at an arc length, held at the ends.
    pub(super) fn at(&self, s: f64) -> DVec3 {
        let i = self.along.partition_point(|a| *a <= s).clamp(1, self.points.len() - 1);
        let (s0, s1) = (self.along[i - 1], self.along[i]);
        self.points[i - 1].lerp(self.points[i], ((s - s0) / (s1 - s0)).clamp(0.0, 1.0))
    }

    /// Distance of a point from the path in plan.
    pub(super) fn distance_in_plan(&self, p: DVec3) -> f64 {
        let level = |p: DVec3| p.truncate().extend(0.0);
        let p = level(p);
        self.points.windows(2).map(|w| off_segment(p, level(w[0]), level(w[1]))).fold(f64::INFINITY, f64::min)
    }

    /// Simplifies the path (Douglas, Peucker 1973): keeps points so that none of the others lies farther than `tolerance` from the
    /// line through them. Returns them with their arc lengths; both ends are among them.
    ///
    /// * `flat`: distances and directions count in plan only.
    pub(super) fn simplified(&self, tolerance: f64, flat: bool) -> Vec<(f64, DVec3)> {
        let level = |p: DVec3| if flat { p.truncate().extend(0.0) } else { p };
        let points: Vec<DVec3> = self.points.iter().map(|p| level(*p)).collect();
        let mut keep = vec![false; points.len()];
        let mut open = vec![(0, points.len() - 1)];
        while let Some((a, b)) = open.pop() {
            (keep[a], keep[b]) = (true, true);
            let farthest = (a + 1..b)
                .map(|i| (off_segment(points[i], points[a], points[b]), i))
                .max_by(|x, y| x.0.total_cmp(&y.0));
            if let Some((_, i)) = farthest.filter(|(off, _)| *off > tolerance) {
                open.extend([(a, i), (i, b)]);
            }
        }
        (0..points.len()).filter(|i| keep[*i]).map(|i| (self.along[i], points[i])).collect()
    }
}

impl Path {
    /// The simplified path with every bend as one corner: vertices nearer than `merge` that turn to the same side become the point
    /// where the legs before and after them meet.
    pub(super) fn controls(&self, tolerance: f64, merge: f64, flat: bool) -> Vec<Control> {
        let all = self.simplified(tolerance, flat);
        let corner = |(s, at): (f64, DVec3)| Control { s, at, half_length: None };
        let way = |i: usize| all[i].1 - all[i - 1].1;
        let mut out = vec![corner(all[0])];
        let mut i = 1;
        while i + 1 < all.len() {
            let axis = way(i).cross(way(i + 1));
            let mut last = i;
            while last + 2 < all.len()
                && way(last + 1).length() < merge
                && way(last + 1).cross(way(last + 2)).dot(axis) > 0.0
                && way(i).angle_between(way(last + 2)) < HAIRPIN
            {
                last += 1;
            }
            let (first_at, last_at) = (all[i].1, all[last].1);
            let meet = meeting_point((first_at, way(i)), (last_at, way(last + 1)));
            match meet.filter(|k| last > i && k.distance(first_at).max(k.distance(last_at)) < 2.0 * merge) {
                Some(at) => {
                    let half_length = Some(at.distance(first_at).min(at.distance(last_at)));
                    out.push(Control { s: 0.5 * (all[i].0 + all[last].0), at, half_length });
                }
                None => out.extend(all[i..=last].iter().copied().map(corner)),
            }
            i = last + 1;
        }
        out.push(corner(all[all.len() - 1]));
        out
    }
}

/// Where two lines come nearest to each other; `None` if they are parallel.
fn meeting_point((p, u): (DVec3, DVec3), (q, v): (DVec3, DVec3)) -> Option<DVec3> {
    let (u, v) = (u.normalize(), v.normalize());
    let (between, cos) = (q - p, u.dot(v));
    let sine2 = 1.0 - cos * cos;
    if sine2 < 1e-3 {
        return None;
    }
    let along_u = (between.dot(u) - cos * between.dot(v)) / sine2;
    let along_v = (cos * between.dot(u) - between.dot(v)) / sine2;
    Some(0.5 * (p + along_u * u + q + along_v * v))
}

fn off_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let way = b - a;
    let t = ((p - a).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + t * way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_walked_evenly_and_simplified_to_its_corners() {
        let points: Vec<DVec3> = (0..=100)
            .map(|i| {
                let t = f64::from(i);
                let wiggle = 0.2 * (3.0 * t).sin();
                if t < 60.0 { DVec3::new(t, wiggle, 0.0) } else { DVec3::new(60.0 + wiggle, t - 60.0, 5.0) }
            })
            .collect();
        let path = Path::new(&points);
        let corners = path.simplified(1.0, true);
        assert_eq!(corners.len(), 3, "{corners:?}");
        assert!(corners[1].1.distance(DVec3::new(60.0, 0.0, 0.0)) < 1.5 && corners[1].1.z == 0.0);
        assert!((path.at(corners[1].0).truncate() - corners[1].1.truncate()).length() < 1e-9);
        assert_eq!(path.at(-3.0), points[0]);
        assert_eq!(path.at(1e9), points[100]);
        let twice: Vec<DVec3> = points.iter().flat_map(|p| [*p, *p]).collect();
        assert_eq!(Path::new(&twice).length(), path.length());
    }
}

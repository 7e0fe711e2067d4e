//! The route of a film by the distance walked.

use belvedere_core::{DVec2, DVec3};

/// A polyline by its length in plan.
#[derive(Debug, Clone)]
pub(crate) struct RouteLine {
    points: Vec<DVec3>,
    /// Distance from the start at every point, scene units, rising.
    along: Vec<f64>,
}

impl RouteLine {
    /// Points that repeat the one before are left out.
    pub(crate) fn new(points: &[DVec3]) -> Self {
        let mut out = Self { points: Vec::new(), along: Vec::new() };
        for p in points.iter().copied().filter(|p| p.is_finite()) {
            let step = out.points.last().map_or(0.0, |last: &DVec3| last.truncate().distance(p.truncate()));
            if out.points.is_empty() || step > 0.0 {
                out.along.push(out.length() + step);
                out.points.push(p);
            }
        }
        out
    }

    /// Length in plan, scene units.
    pub(crate) fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// Points in plan.
    pub(crate) fn plan(&self) -> Vec<DVec2> {
        self.points.iter().map(|p| p.truncate()).collect()
    }

    /// Point at a distance from the start, held at the ends; `None` for a route without points.
    pub(crate) fn at(&self, walked: f64) -> Option<DVec3> {
        let (first, last) = (*self.points.first()?, *self.points.last()?);
        let i = self.along.partition_point(|a| *a <= walked);
        if i == 0 {
            return Some(first);
        }
        if i >= self.points.len() {
            return Some(last);
        }
        let t = (walked - self.along[i - 1]) / (self.along[i] - self.along[i - 1]);
        Some(self.points[i - 1].lerp(self.points[i], t))
    }

    /// Distance from the start of the place nearest to `p` in plan that lies at or behind `from`, and its distance to `p`.
    pub(crate) fn nearest(&self, p: DVec2, from: f64) -> Option<(f64, f64)> {
        let legs = self.points.windows(2).zip(self.along.windows(2)).filter(|(_, along)| along[1] >= from);
        let places = legs.map(|(leg, along)| {
            let (a, b) = (leg[0].truncate(), leg[1].truncate());
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let s = (along[0] + t * (along[1] - along[0])).max(from);
            (s, self.at(s).map_or(f64::INFINITY, |q| q.truncate().distance(p)))
        });
        places.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_on_a_route_are_found_both_ways() {
        let corner = [DVec3::ZERO, DVec3::ZERO, DVec3::new(100.0, 0.0, 10.0), DVec3::new(100.0, 50.0, 20.0)];
        let route = RouteLine::new(&corner);
        assert_eq!(route.length(), 150.0);
        assert_eq!(route.at(50.0), Some(DVec3::new(50.0, 0.0, 5.0)));
        assert_eq!([route.at(-1.0), route.at(1e9)], [Some(DVec3::ZERO), Some(corner[3])]);
        assert_eq!(route.nearest(DVec2::new(30.0, 5.0), 0.0), Some((30.0, 5.0)));
        let (s, _) = route.nearest(DVec2::new(30.0, 5.0), 120.0).expect("a place");
        assert_eq!(s, 120.0, "not before where the walker is");
        assert_eq!(RouteLine::new(&[]).at(0.0), None);
    }
}

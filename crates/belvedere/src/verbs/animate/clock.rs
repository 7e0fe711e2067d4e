//! Times along the route of a film, from the GPX files of its layer.

use crate::film::RouteLine;
use crate::scene_file::LayerDoc;
use crate::{Session, scene_file};
use belvedere_resolve::ground::Ground;

/// Distance along the route, rising, and time, which rises or falls all the way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RouteTimes(Vec<(f64, f64)>);

/// Farthest that a timed point lies beside the route, as a share of its length.
const BESIDE: f64 = 0.02;

/// Why a route has no clock.
const NO_TIMES: &str = "its files give no times along the route, so no clock is drawn";
const UNSTEADY: &str = "its times do not follow each other along the route, so no clock is drawn";

impl RouteTimes {
    /// Times of the route of a line layer.
    ///
    /// # Errors
    /// In words, if its files give fewer than two, or times that go to and fro.
    pub(super) fn of(session: &Session, layer: &str, route: &RouteLine) -> Result<Self, &'static str> {
        let found = Self::found(session, layer, route).ok_or(NO_TIMES)?;
        if found.is_steady() { Ok(found) } else { Err(UNSTEADY) }
    }

    /// Whether time rises or falls all the way.
    fn is_steady(&self) -> bool {
        let steps = || self.0.windows(2).map(|pair| pair[1].1 - pair[0].1);
        steps().all(|step| step >= 0.0) || steps().all(|step| step <= 0.0)
    }

    fn found(session: &Session, layer: &str, route: &RouteLine) -> Option<Self> {
        let description = session.resolved.description.as_ref()?;
        let doc = description.resolved.layer.iter().find_map(|l| match l {
            LayerDoc::Line(line) if line.id == layer => Some(line),
            _ => None,
        })?;
        let ground = Ground::of(session.scene());
        let mut timed = Vec::new();
        for source in doc.source.iter().flat_map(|paths| paths.as_slice()) {
            let text = description.roots.resolve(source).ok().and_then(|path| scene_file::read_text(&path).ok());
            let points = text.and_then(|(text, _)| belvedere_io::vector::track_times(&text).ok()).unwrap_or_default();
            timed.extend(points.into_iter().filter_map(|(p, t)| Some((ground.position_of(p.x, p.y).ok()?, t))));
        }
        // A route may be walked against the order of its file.
        let first = timed.first().and_then(|(p, _)| route.nearest(*p, 0.0))?;
        let last = timed.last().and_then(|(p, _)| route.nearest(*p, 0.0))?;
        if first.0 > last.0 {
            timed.reverse();
        }
        let (mut out, mut from): (Vec<(f64, f64)>, f64) = (Vec::new(), 0.0);
        for (p, time) in timed {
            let Some((s, _)) = route.nearest(p, from).filter(|(_, off)| *off <= BESIDE * route.length()) else {
                continue;
            };
            if out.last().is_none_or(|(before, _)| s > *before) {
                out.push((s, time));
                from = s;
            }
        }
        (out.len() > 1).then_some(Self(out))
    }

    /// Time of day at a distance walked, `h:mm:ss`.
    pub(super) fn at(&self, walked: f64) -> String {
        let i = self.0.partition_point(|(s, _)| *s <= walked).clamp(1, self.0.len() - 1);
        let ((s0, t0), (s1, t1)) = (self.0[i - 1], self.0[i]);
        let time = t0 + (t1 - t0) * ((walked - s0) / (s1 - s0)).clamp(0.0, 1.0);
        let seconds = time.rem_euclid(86_400.0).floor() as u32;
        format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_go_to_and_fro_are_no_clock() {
        let of = |times: [f64; 4]| RouteTimes(times.iter().enumerate().map(|(i, t)| (i as f64, *t)).collect());
        assert!(of([1.0, 2.0, 2.0, 9.0]).is_steady() && of([9.0, 4.0, 4.0, 1.0]).is_steady());
        assert!(!of([1.0, 4.0, 2.0, 9.0]).is_steady());
    }

    #[test]
    fn times_run_evenly_between_points() {
        let times = RouteTimes(vec![(0.0, 86_400.0 + 3600.0), (100.0, 86_400.0 + 3700.0), (200.0, 86_400.0 + 7300.0)]);
        assert_eq!([-5.0, 50.0, 150.0, 900.0].map(|s| times.at(s)), ["1:00:00", "1:00:50", "1:31:40", "2:01:40"]);
    }
}

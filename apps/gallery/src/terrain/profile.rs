//! The ground along the line of sight that is hidden most.

use super::area::Area;
use crate::chart::{self, Chart, Curve, SeriesLabelPosition, Style};
use crate::sheet::Pixels;
use anyhow::Result;
use belvedere::core::{DVec2, TerrainDisocclusion};
use belvedere::disocclusion::Solved;
use belvedere::disocclusion::internals::ReferencePoint;
use belvedere::sight::{guard_tau, sight_samples};

/// Samples along the line, besides its ends.
const SAMPLES: usize = 1200;

/// A vertical section of an area from the eye to a reference point: kilometres from the eye, metres of height.
pub(crate) struct Profile<'a> {
    area: &'a Area,
    point: &'a ReferencePoint,
    foot: DVec2,
}

impl<'a> Profile<'a> {
    /// Profiles to all reference points in view, ordered by how far the ground rises over their lines of sight, the highest first.
    pub(crate) fn all(area: &'a Area) -> Vec<Self> {
        let (field, eye) = (&area.field, area.eye());
        let to = field.grid_from_scene(eye.truncate());
        let excess = |p: &ReferencePoint| {
            let samples = sight_samples(field, p.grid, to, true);
            let (guard, from) = (guard_tau(p.grid, to, area.settings.guard), p.ground + p.lift);
            let over = samples.iter().filter(|s| s.tau > guard);
            let over = over.map(|s| s.of(field.heights()) - (from + s.tau * (eye.z - from)));
            over.fold(f64::NEG_INFINITY, f64::max)
        };
        let mut points: Vec<(f64, &ReferencePoint)> = area.points.iter().map(|p| (excess(p), p)).collect();
        points.sort_by(|a, b| b.0.total_cmp(&a.0));
        let profile =
            |(_, point): (f64, &'a ReferencePoint)| Self { area, point, foot: field.scene_from_grid(point.grid) };
        points.into_iter().map(profile).collect()
    }

    /// The ground, as it is or displaced.
    pub(crate) fn ground(&self, stage: Option<&TerrainDisocclusion>) -> Vec<(f64, f64)> {
        let (field, eye) = (&self.area.field, self.area.eye().truncate());
        let sample = |i: usize| {
            let t = i as f64 / SAMPLES as f64;
            let xy = eye.lerp(self.foot, t);
            let ground = field.surface_at(field.grid_from_scene(xy))?;
            Some((t * self.km(), ground + stage.map_or(0.0, |s| s.delta_at(xy.extend(0.0)))))
        };
        (0..=SAMPLES).filter_map(sample).collect()
    }

    /// The line of sight from the eye to the reference point, which moves with the ground.
    pub(crate) fn line_of_sight(&self, stage: Option<&TerrainDisocclusion>) -> Vec<(f64, f64)> {
        let moved = stage.map_or(0.0, |s| s.delta_at(self.foot.extend(0.0)));
        vec![(0.0, self.area.eye().z), (self.km(), self.point.ground + self.point.lift + moved)]
    }

    fn km(&self) -> f64 {
        self.foot.distance(self.area.eye().truncate()) / 1000.0
    }

    /// Ground and line of sight before and after, and more curves between them.
    pub(crate) fn chart(&self, title: &str, after: &TerrainDisocclusion, more: Vec<Curve>) -> Chart {
        let mut curves = vec![
            Curve::new("ground before", self.ground(None), [176, 168, 156], Style::Filled),
            Curve::new("ground after", self.ground(Some(after)), [120, 160, 108], Style::Filled),
        ];
        curves.extend(more);
        curves.extend([
            Curve::new("line of sight before", self.line_of_sight(None), [200, 70, 60], Style::Dashes),
            Curve::new("line of sight after", self.line_of_sight(Some(after)), [30, 90, 170], Style::Line),
            Curve::new("eye and point", self.line_of_sight(Some(after)), [30, 40, 60], Style::Dots),
        ]);
        let (x, y) = ("distance from the eye, km".into(), "height, m".into());
        Chart { title: title.into(), x, y, legend: SeriesLabelPosition::UpperRight, curves }
    }
}

/// The chart, or `None` if nothing is in view.
pub(crate) fn profile(area: &Area, solved: &Solved) -> Result<Option<Pixels>> {
    let title = "The line of sight that is hidden most, before and after (mode qp)";
    Profile::all(area).first().map(|p| chart::draw(&p.chart(title, &solved.stage, Vec::new()), chart::WIDE)).transpose()
}

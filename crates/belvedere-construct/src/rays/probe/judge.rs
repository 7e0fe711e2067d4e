//! Judges views by the surfaces that their pictures show, and by distortion.

use super::surfaces::SurfacePoint;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Scene;
use belvedere_sight::{Obstacles, SightOptions};
use rayon::prelude::*;

/// A piece of surface counts in full if it covers this share of the picture, divided by the number of pieces.
const FULL_SIZE: f64 = 0.2;
/// Weight of points outside the straight picture, relative to points hidden in it.
const BESIDE: f64 = 0.15;
/// Weight of lost surface, relative to gained surface.
const LOSS: f64 = 0.5;
/// Price of distortion, of roll (per radian) and of undersampling, shares of the surface that the straight picture shows.
const DISTORTION: f64 = 2.5;
const ROLL: f64 = 0.8;
const UNDERSAMPLED: f64 = 0.3;
/// Cells of the picture in which sampling rates are compared.
const COMPARED: [usize; 2] = [8, 5];

/// Judges views by points on surfaces.
pub(super) struct Judge<'a> {
    obstacles: Obstacles<'a>,
    sight: SightOptions,
    pub(super) points: Vec<SurfacePoint>,
    /// Images of the points in the straight view; `None` where a point is not seen.
    straight: Vec<Option<Image>>,
    /// Worth of seeing each point, per unit of area.
    interest: Vec<f64>,
    straight_marks: Marks,
}

/// A point that is seen.
#[derive(Debug, Clone, Copy)]
struct Image {
    pixel: DVec2,
    /// Singular values of the derivative of the pixel, pixels per scene unit, the larger first.
    rates: [f64; 2],
    /// Angle by which what is up at the point is turned in the picture, radians, times how much of it is to be seen.
    roll: f64,
    /// Area of the point's piece of surface by its interest, less where it is too small in the picture to be of use.
    worth: f64,
}

/// A point that the straight picture does not show.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unseen {
    pub(super) at: DVec3,
    pub(super) normal: DVec3,
    /// Worth of seeing it.
    pub(super) worth: f64,
}

/// Distortion, roll and undersampling of a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Marks {
    /// Mean of 1 - the ratio of scales across and along the bend, by what is seen; 0 = as through a long lens.
    pub(super) distortion: f64,
    /// Mean angle by which the camera's up is turned in the picture, radians.
    pub(super) roll: f64,
    /// Share of what is seen that is drawn at less than half the scale of its surroundings.
    pub(super) undersampled: f64,
}

/// The verdict on a view.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Verdict {
    /// Shares of the surface: seen; seen but not in the straight picture; seen in the straight picture alone.
    pub(super) seen: f64,
    pub(super) gained: f64,
    pub(super) lost: f64,
    pub(super) marks: Marks,
    /// Score: the larger the better; 0 = as good as the straight picture.
    pub(super) score: f64,
}

impl<'a> Judge<'a> {
    /// * `region`: extent of the region that is judged, scene units.
    pub(super) fn new(scene: &'a Scene, base: &View, points: Vec<SurfacePoint>, region: f64) -> Self {
        let cell = scene.terrain().map_or(0.0, |t| t.spacing().max_element());
        let sight = SightOptions { chord_m: 2e-4 * region + 0.02 * cell, cap_m: 0.0, guard_m: 1.5 * cell };
        let mut judge = Self {
            obstacles: Obstacles::new(scene),
            sight,
            points,
            straight: Vec::new(),
            interest: Vec::new(),
            straight_marks: Marks::default(),
        };
        // Wide open ground is worth no more, in all, than the surfaces that stand on it.
        let area = |on_ground| judge.points.iter().filter(|p| p.on_ground == on_ground).map(|p| p.area).sum::<f64>();
        let [ground, standing] = [true, false].map(area);
        let of_ground = if standing > 0.0 { (standing / ground).min(1.0) } else { 1.0 };
        let pinhole = base.pinhole();
        let interest = |p: &SurfacePoint| {
            let image = base.project(p.at);
            let framed = image.is_ok_and(|i| i.depth >= pinhole.near && pinhole.contains(i.pixel));
            (if framed { 1.0 } else { BESIDE }) * if p.on_ground { of_ground } else { 1.0 }
        };
        judge.interest = judge.points.iter().map(interest).collect();
        judge.straight = judge.images(base, 1);
        judge.straight_marks = marks(base, &judge.straight);
        judge
    }

    pub(super) fn obstacles(&self) -> &Obstacles<'a> {
        &self.obstacles
    }

    /// Points that the straight picture does not show.
    pub(super) fn unseen(&self) -> Vec<Unseen> {
        let points = self.points.iter().zip(&self.straight).zip(&self.interest);
        let unseen = points.filter(|((_, image), _)| image.is_none());
        unseen.map(|((p, _), interest)| Unseen { at: p.at, normal: p.normal, worth: p.area * interest }).collect()
    }

    /// Share of the surface that the straight picture shows.
    pub(super) fn seen_straight(&self) -> f64 {
        let (mut seen, mut all) = (0.0, 0.0);
        for (p, image) in self.points.iter().zip(&self.straight) {
            all += p.area;
            seen += if image.is_some() { p.area } else { 0.0 };
        }
        if all > 0.0 { seen / all } else { 0.0 }
    }

    /// The verdict on a view by every `stride`-th point.
    pub(super) fn verdict(&self, view: &View, stride: usize) -> Verdict {
        let images = self.images(view, stride);
        let mut out = Verdict { marks: marks(view, &images), ..Verdict::default() };
        let (mut all, mut worth) = (0.0, [0.0; 3]);
        let looked_at = self.points.iter().zip(&self.straight).step_by(stride);
        for ((p, before), after) in looked_at.zip(&images) {
            all += p.area;
            worth[0] += before.map_or(0.0, |b| b.worth);
            out.seen += if after.is_some() { p.area } else { 0.0 };
            match (before, after) {
                (None, Some(a)) => (out.gained, worth[1]) = (out.gained + p.area, worth[1] + a.worth),
                (Some(b), None) => (out.lost, worth[2]) = (out.lost + p.area, worth[2] + b.worth),
                _ => {}
            }
        }
        if !(all > 0.0) {
            return Verdict::default();
        }
        [&mut out.seen, &mut out.gained, &mut out.lost].into_iter().for_each(|share| *share /= all);
        let gain = (worth[1] - LOSS * worth[2]) / worth[0].max(1e-3 * all);
        let before = self.straight_marks;
        let distortion = (out.marks.distortion - before.distortion).max(0.0);
        let undersampled = (out.marks.undersampled - before.undersampled).max(0.0);
        let roll = (out.marks.roll - before.roll).max(0.0);
        out.score = gain - DISTORTION * distortion - ROLL * roll - UNDERSAMPLED * undersampled;
        out
    }

    fn images(&self, view: &View, stride: usize) -> Vec<Option<Image>> {
        let chosen: Vec<(&SurfacePoint, &f64)> = self.points.iter().zip(&self.interest).step_by(stride).collect();
        let [w, h] = view.pinhole().image.map(f64::from);
        let full = FULL_SIZE * w * h / self.points.len().max(1) as f64;
        chosen.into_par_iter().map(|(p, interest)| self.image(view, p, *interest, full)).collect()
    }

    /// * `full`: pixels that the piece must cover to count in full.
    fn image(&self, view: &View, p: &SurfacePoint, interest: f64, full: f64) -> Option<Image> {
        let image = view.project(p.at).ok()?;
        let pinhole = view.pinhole();
        let in_range = image.depth >= pinhole.near && pinhole.far.is_none_or(|far| image.depth <= far);
        if !in_range || image.folded || !pinhole.contains(image.pixel) {
            return None;
        }
        if self.obstacles.clearance(view, (p.at, 0.0), (image.pixel, image.depth), &self.sight) < 0.0 {
            return None;
        }
        let [x, y] = view.jacobian(p.at).ok()?;
        let (u, v) = p.normal.any_orthonormal_pair();
        let covered = p.area * (x.dot(u) * y.dot(v) - x.dot(v) * y.dot(u)).abs();
        let worth = p.area * interest * (covered / full).min(1.0);
        let rates = singular_values(x, y);
        let up = DVec2::new(-x.dot(pinhole.down), -y.dot(pinhole.down));
        let roll = up.angle_to(DVec2::NEG_Y).abs() * (up.length() / rates[0].max(1e-300)).min(1.0);
        Some(Image { pixel: image.pixel, rates, roll: if roll.is_finite() { roll } else { 0.0 }, worth })
    }
}

/// Singular values of a matrix of two rows.
fn singular_values(a: DVec3, b: DVec3) -> [f64; 2] {
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    let (mean, spread) = (0.5 * (aa + bb), (0.25 * (aa - bb).powi(2) + ab * ab).sqrt());
    [mean + spread, (mean - spread).max(0.0)].map(f64::sqrt)
}

fn marks(view: &View, images: &[Option<Image>]) -> Marks {
    let seen: Vec<&Image> = images.iter().flatten().collect();
    let all: f64 = seen.iter().map(|i| i.worth).sum();
    if !(all > 0.0) {
        return Marks::default();
    }
    let [w, h] = view.pinhole().image.map(f64::from);
    let place = |i: &Image| {
        let [x, y] = [i.pixel.x / w, i.pixel.y / h].map(|v| v.clamp(0.0, 0.999));
        [(x * COMPARED[0] as f64) as usize, (y * COMPARED[1] as f64) as usize]
    };
    let mut places: Vec<Vec<f64>> = vec![Vec::new(); COMPARED[0] * COMPARED[1]];
    for i in &seen {
        // A cell also takes the rates of its eight neighbours.
        let [x, y] = place(i);
        for near_y in y.saturating_sub(1)..=(y + 1).min(COMPARED[1] - 1) {
            for near_x in x.saturating_sub(1)..=(x + 1).min(COMPARED[0] - 1) {
                places[near_y * COMPARED[0] + near_x].push(i.rates[1]);
            }
        }
    }
    let medians: Vec<f64> = places
        .into_iter()
        .map(|mut rates| {
            rates.sort_by(f64::total_cmp);
            rates.get(rates.len() / 2).copied().unwrap_or(0.0)
        })
        .collect();
    let (mut distorted, mut turned, mut undersampled) = (0.0, 0.0, 0.0);
    for i in &seen {
        let [x, y] = place(i);
        distorted += i.worth * (1.0 - i.rates[1] / i.rates[0].max(1e-300));
        turned += i.worth * i.roll;
        undersampled += if i.rates[1] < 0.5 * medians[y * COMPARED[0] + x] { i.worth } else { 0.0 };
    }
    Marks { distortion: distorted / all, roll: turned / all, undersampled: undersampled / all }
}

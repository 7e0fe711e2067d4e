//! A view: a pinhole behind a chain of displacements, and the rays of its pixels.

mod edges;
mod ray_path;
mod rigid;

pub use edges::{EdgeError, EdgePoint, Edges};
pub use ray_path::{RayPath, RayPoint};

use crate::map::split_rays::{Branch, SplitRays};
use crate::map::unroll::Seam;
use crate::{
    Aabb, CurvedRays, Displaced, EarthCurvature, ImageBox, Miss, Pinhole, SpaceMap, SplineBend, Stage, Strip,
    TerrainDisocclusion,
};
use glam::{DVec2, DVec3};
use std::ops::RangeInclusive;

/// Image of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projected {
    /// Pixel coordinates: (0, 0) is the outer corner of the top-left pixel, x right, y down. May lie outside the image.
    pub pixel: DVec2,
    /// Forward distance of the displaced point along the optical axis, > 0, scene units.
    pub depth: f64,
    /// Segment of the ray that sees the point, see [`crate::Displaced::segment`].
    pub segment: u32,
    /// Whether a stage folded over at the point.
    pub folded: bool,
}

/// A pinhole photograph of a displaced world: `pixel, depth = pinhole.project(D_n(...D_1(p)))`.
///
/// Plain data; everything that draws, measures or picks works on this.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    pinhole: Pinhole,
    stages: Vec<Stage>,
}

/// Stages that cannot be chained.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Wrong order or a repeated stage.
    #[error(
        "stage {second} cannot follow stage {first}; the order is earth, terrain_disocclusion, ground_moves, strip, tube or unroll, relief, spline_bend, curved_rays, each at most once"
    )]
    Order {
        /// Name of the earlier stage.
        first: &'static str,
        /// Name of the later stage.
        second: &'static str,
    },
    /// Curved rays that start in another camera.
    #[error(
        "the curved_rays stage was built for another camera (eye {built}, this view's is {here}); build it with this view's pinhole"
    )]
    OtherRoot {
        /// Eye of the pinhole the stage was built for.
        built: DVec3,
        /// Eye of the view's pinhole.
        here: DVec3,
    },
}

impl View {
    /// Chains `stages`, in order of application, before `pinhole`.
    ///
    /// # Errors
    /// [`ViewError::Order`] unless the stages are in the order of [`Stage::rank`], each at most once but own maps;
    /// [`ViewError::OtherRoot`] if curved rays were built for a pinhole with other rays.
    pub fn new(pinhole: Pinhole, stages: Vec<Stage>) -> Result<Self, ViewError> {
        for pair in stages.windows(2) {
            let both_own = pair.iter().all(|stage| matches!(stage, Stage::Own(_)));
            if pair[0].rank() >= pair[1].rank() && !both_own {
                return Err(ViewError::Order { first: pair[0].name(), second: pair[1].name() });
            }
        }
        let root = match stages.last() {
            Some(Stage::CurvedRays(rays)) => Some(rays.root()),
            Some(Stage::SplitRays(rays)) => Some(rays.root()),
            _ => None,
        };
        if let Some(root) = root.filter(|root| !root.has_same_rays(&pinhole)) {
            return Err(ViewError::OtherRoot { built: root.eye, here: pinhole.eye });
        }
        Ok(Self { pinhole, stages })
    }

    /// A view without any displacement.
    pub fn straight(pinhole: Pinhole) -> Self {
        Self { pinhole, stages: Vec::new() }
    }

    /// The root pinhole.
    pub fn pinhole(&self) -> &Pinhole {
        &self.pinhole
    }

    /// The stages in order of application.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// Whether any stage bends the picture: any but those of the world, which is the earth's curvature.
    pub fn is_bent(&self) -> bool {
        self.stages.iter().any(|s| !s.is_of_world())
    }

    /// The same camera without the bends (the earth's curvature stays): the "straight" picture.
    pub fn straightened(&self) -> Self {
        let stages = self.stages.iter().filter(|s| s.is_of_world()).cloned().collect();
        Self { pinhole: self.pinhole.clone(), stages }
    }

    /// The same camera with its bends at a share of their strength: pictures between the straight and the bent one.
    ///
    /// * `share`: at or below 0 straight, at or above 1 as it is.
    ///
    /// `None` if a stage is not valid at that share.
    pub fn eased(&self, share: f64) -> Option<Self> {
        if !(share > 0.0) {
            return Some(self.straightened());
        }
        if share >= 1.0 {
            return Some(self.clone());
        }
        let stages = self.stages.iter().map(|stage| stage.eased(share)).collect::<Option<Vec<_>>>()?;
        Some(Self { pinhole: self.pinhole.clone(), stages })
    }

    /// Image of a world point.
    ///
    /// Law: `project(ray(px).at(d)) == (px, d)`, unless an earlier cell of a curved-ray chain also sees the point.
    pub fn project(&self, p_world: DVec3) -> Result<Projected, Miss> {
        self.photograph(self.displace(p_world)?)
    }

    /// The (curved) ray of a pixel.
    pub fn ray(&self, pixel: DVec2) -> RayPath<'_> {
        RayPath::new(self, pixel)
    }

    /// `p_world` after all stages, before the pinhole.
    pub fn displace(&self, p_world: DVec3) -> Result<Displaced, Miss> {
        let start = Displaced { point: p_world, segment: 0, folded: false };
        self.stages.iter().try_fold(start, |d, stage| {
            let next = stage.displace(d.point)?;
            Ok(Displaced { folded: d.folded || next.folded, ..next })
        })
    }

    /// World point and ray segment that the chain carries onto `p_displaced`.
    pub fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        let mut segment = 0;
        let mut p = p_displaced;
        for stage in self.stages.iter().rev() {
            let (before, of_stage) = stage.undisplace(p)?;
            // Only one stage, the last, has segments.
            (p, segment) = (before, segment.max(of_stage));
        }
        Ok((p, segment))
    }

    /// The earth's curvature, if it is a stage.
    pub fn earth(&self) -> Option<&EarthCurvature> {
        self.stages.iter().find_map(|s| if let Stage::EarthCurvature(earth) = s { Some(earth) } else { None })
    }

    /// The displacement of the ground, if it is a stage.
    pub fn ground(&self) -> Option<&TerrainDisocclusion> {
        self.stages.iter().find_map(|s| if let Stage::TerrainDisocclusion(ground) = s { Some(ground) } else { None })
    }

    /// The stage that straightens a strip or tube, if there is one.
    pub fn straightener(&self) -> Option<&Stage> {
        self.stages.iter().find(|s| matches!(s, Stage::Strip(_) | Stage::Tube(_)))
    }

    /// Where the images of world points beside each other lie apart, if that is a half plane: where a circle is unrolled and earlier stages move
    /// points up and down alone.
    pub fn seam(&self) -> Option<Seam> {
        let at = self.stages.iter().position(|s| s.seam().is_some())?;
        if self.stages[..at].iter().all(|s| s.is_upright()) { self.stages[at].seam() } else { None }
    }

    /// The strip, if it is a stage.
    pub fn strip(&self) -> Option<&Strip> {
        self.stages.iter().find_map(|s| if let Stage::Strip(strip) = s { Some(strip) } else { None })
    }

    /// The spline bend, if it is a stage.
    pub fn spline_bend(&self) -> Option<&SplineBend> {
        self.stages.iter().find_map(|s| if let Stage::SplineBend(bend) = s { Some(bend) } else { None })
    }

    /// The rays that part at seams, if the chain ends with them.
    pub fn split_rays(&self) -> Option<&SplitRays> {
        match self.stages.last() {
            Some(Stage::SplitRays(rays)) => Some(rays),
            _ => None,
        }
    }

    /// This view as one of its branches sees it, over the whole image: with curved rays in place of those that part.
    pub fn along(&self, branch: &Branch) -> Self {
        let earlier = self.stages.iter().filter(|s| !matches!(s, Stage::SplitRays(_))).cloned();
        Self {
            pinhole: self.pinhole.clone(),
            stages: earlier.chain([Stage::CurvedRays(branch.rays.clone())]).collect(),
        }
    }

    /// The curved rays, if the chain ends with them; not those that part, see [`View::split_rays`].
    pub fn curved_rays(&self) -> Option<&CurvedRays> {
        match self.stages.last() {
            Some(Stage::CurvedRays(rays)) => Some(rays),
            _ => None,
        }
    }

    /// The stages before the curved rays, all of them if there are none.
    pub fn earlier_stages(&self) -> &[Stage] {
        let last = self.stages.last().is_some_and(|s| s.bends_rays());
        &self.stages[..self.stages.len() - usize::from(last)]
    }

    fn displace_earlier(&self, p_world: DVec3) -> Result<Displaced, Miss> {
        let start = Displaced { point: p_world, segment: 0, folded: false };
        self.earlier_stages().iter().try_fold(start, |d, stage| {
            let next = stage.displace(d.point)?;
            Ok(Displaced { folded: d.folded || next.folded, ..next })
        })
    }

    /// How often a renderer draws an object that spans the whole chain: once per turn of the curved rays, once without them.
    /// Rays that part are drawn branch by branch ([`View::along`]); the records here are not theirs.
    pub fn records(&self) -> usize {
        self.curved_rays().map_or(1, CurvedRays::records)
    }

    /// `p_world` after all stages, the curved rays by the record of one turn alone ([`CurvedRays::displace_in`]).
    ///
    /// # Errors
    /// Those of [`View::displace`]; [`Miss::OutsideDomain`] if `record` is not below [`View::records`].
    pub fn displace_in(&self, record: usize, p_world: DVec3) -> Result<Displaced, Miss> {
        let d = self.displace_earlier(p_world)?;
        match self.curved_rays() {
            Some(rays) => Ok(Displaced { folded: d.folded, ..rays.displace_in(record, d.point)? }),
            None if record == 0 && self.split_rays().is_none() => Ok(d),
            None => Err(Miss::OutsideDomain),
        }
    }

    /// Signed distances to the planes that cut a record from its neighbours ([`CurvedRays::record_margins`]): a renderer
    /// that draws once per record keeps points where both are positive. Negative infinity where earlier stages have no image.
    pub fn record_margins(&self, record: usize, p_world: DVec3) -> [f64; 2] {
        match (self.displace_earlier(p_world), self.curved_rays()) {
            (Ok(d), Some(rays)) => rays.record_margins(record, d.point),
            (Ok(_), None) if self.split_rays().is_none() => [f64::INFINITY; 2],
            _ => [f64::NEG_INFINITY; 2],
        }
    }

    /// `p_world` after all stages, the curved rays by one segment of the rays alone ([`CurvedRays::displace_along`]).
    ///
    /// # Errors
    /// Those of [`View::displace`]; [`Miss::OutsideDomain`] if there is no such segment.
    pub fn displace_along(&self, segment: u32, p_world: DVec3) -> Result<Displaced, Miss> {
        let d = self.displace_earlier(p_world)?;
        let rays = self.curved_rays().ok_or(Miss::OutsideDomain)?;
        Ok(Displaced { folded: d.folded, ..rays.displace_along(segment, d.point)? })
    }

    /// Signed distances to the planes at the ends of a segment ([`CurvedRays::segment_planes`]), infinite where it has no end: rays reach
    /// only points where both are not negative. Negative infinity where earlier stages have no image.
    pub fn segment_margins(&self, segment: u32, p_world: DVec3) -> [f64; 2] {
        let (Ok(d), Some(rays)) = (self.displace_earlier(p_world), self.curved_rays()) else {
            return [f64::NEG_INFINITY; 2];
        };
        let at =
            |plane: Option<crate::map::curved_rays::LinearForm>| plane.map_or(f64::INFINITY, |form| form.at(d.point));
        rays.segment_planes(segment).map(at).map(|d| if d.is_nan() { f64::NEG_INFINITY } else { d })
    }

    /// All images of a point, in ray order. More than one only where cells of a curved-ray chain overlap, or where several
    /// branches of rays that part show it.
    pub fn project_all(&self, p_world: DVec3) -> Vec<Projected> {
        let Ok(d) = self.displace_earlier(p_world) else { return Vec::new() };
        let images = match self.stages.last() {
            Some(Stage::CurvedRays(rays)) => rays.displace_all(d.point),
            Some(Stage::SplitRays(rays)) => rays.displace_all(d.point).into_iter().map(|(_, image)| image).collect(),
            _ => return self.photograph(d).into_iter().collect(),
        };
        let images = images.into_iter();
        images.filter_map(|image| self.photograph(Displaced { folded: d.folded, ..image }).ok()).collect()
    }

    fn photograph(&self, d: Displaced) -> Result<Projected, Miss> {
        let (pixel, depth) = self.pinhole.project(d.point)?;
        Ok(Projected { pixel, depth, segment: d.segment, folded: d.folded })
    }

    /// Derivative of the pixel with respect to the world point: rows d(pixel.x), d(pixel.y); pixels per scene unit.
    pub fn jacobian(&self, p_world: DVec3) -> Result<[DVec3; 2], Miss> {
        let mut p = p_world;
        let mut chain = glam::DMat3::IDENTITY;
        for stage in &self.stages {
            chain = stage.jacobian(p)? * chain;
            p = stage.apply(p)?;
        }
        let rows = self.pinhole.jacobian(p)?.map(|row| chain.transpose() * row);
        if rows.iter().all(|r| r.is_finite()) { Ok(rows) } else { Err(Miss::OutsideDomain) }
    }

    /// Bound on the error of drawing the edge `p0 p1` as a straight image edge between its projected ends.
    pub fn edge_error(&self, p0: DVec3, p1: DVec3) -> EdgeError {
        self.error_of_edge(p0, p1, None)
    }

    /// The same bound when curved rays displace by the record of one turn alone, see [`View::displace_in`].
    pub fn edge_error_in(&self, record: usize, p0: DVec3, p1: DVec3) -> EdgeError {
        self.error_of_edge(p0, p1, Some(record))
    }

    /// The same bound where records displace as one map ([`CurvedRays::is_continuous`]), each end by the record it belongs to.
    pub fn edge_error_between(&self, records: RangeInclusive<usize>, p0: DVec3, p1: DVec3) -> EdgeError {
        let (Some((a, b, mut error)), Some(rays)) = (self.earlier_error(p0, p1), self.curved_rays()) else {
            return EdgeError::UNKNOWN;
        };
        if error > 0.0 {
            error *= stretch(rays, a, b);
        }
        let ends = [a, b].map(|p| rays.record_of(records.clone(), p));
        let (Ok(a1), Ok(b1)) = (rays.displace_in(ends[0], a), rays.displace_in(ends[1], b)) else {
            return EdgeError::UNKNOWN;
        };
        // Turns that both ends are before, or past, do not bend the edge.
        let shifts = (ends[0].min(ends[1])..=ends[0].max(ends[1])).map(|record| rays.record_edge_shift(record, a, b));
        let shifts: Option<Vec<DVec3>> = shifts.collect();
        shifts.map_or(EdgeError::UNKNOWN, |shifts| self.image_error([a1.point, b1.point], error, &shifts))
    }

    /// The same bound for one segment alone, see [`View::displace_along`].
    pub fn edge_error_along(&self, segment: u32, p0: DVec3, p1: DVec3) -> EdgeError {
        let Some(map) = self.curved_rays().and_then(|rays| rays.straight_map(segment)) else {
            return self.edge_error_in(segment as usize / 2, p0, p1);
        };
        let Some((a, b, error)) = self.earlier_error(p0, p1) else { return EdgeError::UNKNOWN };
        if error == 0.0 {
            return EdgeError::NONE;
        }
        let stretch = map.linear.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
        let ends = [a, b].map(|p| self.pinhole.eye + map.linear * (p - map.viewpoint));
        self.image_error(ends, error * stretch, &[])
    }

    fn error_of_edge(&self, p0: DVec3, p1: DVec3, record: Option<usize>) -> EdgeError {
        let Some((a, b, mut error)) = self.earlier_error(p0, p1) else { return EdgeError::UNKNOWN };
        if let Some(split) = self.split_rays() {
            return match split.branch_of_edge(a, b) {
                Some(branch) if record.is_none() => self.along(branch).error_of_edge(p0, p1, None),
                _ => EdgeError::UNKNOWN,
            };
        }
        let Some(rays) = self.curved_rays() else { return self.image_error([a, b], error, &[]) };
        if error > 0.0 {
            error *= stretch(rays, a, b);
        }
        let displaced = |p| match record {
            Some(record) => rays.displace_in(record, p),
            None => rays.displace(p),
        };
        let (Ok(a1), Ok(b1)) = (displaced(a), displaced(b)) else { return EdgeError::UNKNOWN };
        let ends = [a1.point, b1.point];
        match record {
            Some(record) => match rays.record_edge_shift(record, a, b) {
                Some(shift) => self.image_error(ends, error, &[shift]),
                None => EdgeError::UNKNOWN,
            },
            None => {
                let mut shifts = Vec::new();
                if !rays.edge_shifts(a, b, |shift| shifts.push(shift)) {
                    return EdgeError::UNKNOWN;
                }
                self.image_error(ends, error, &shifts)
            }
        }
    }

    /// Ends and error, in scene units, of an edge after the stages before the curved rays.
    fn earlier_error(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        let (mut a, mut b, mut error) = (p0, p1, 0.0f64);
        for stage in self.earlier_stages() {
            let carried = if error > 0.0 { error * stretch(&**stage, a, b) } else { 0.0 };
            let bound;
            (a, b, bound) = stage.edge(a, b)?;
            error = carried + bound;
        }
        Some((a, b, error))
    }

    /// Image of an error: a ball of radius `error` and shifts back along fixed vectors, around the edge between displaced ends.
    ///
    /// A shift by -d moves a pixel by at most |d_xy - pixel d_w| / (depth - |d_w|), in pixels and from the image centre;
    /// the numerator is convex in the pixel, so the ends decide.
    fn image_error(&self, ends: [DVec3; 2], error: f64, shifts: &[DVec3]) -> EdgeError {
        if error == 0.0 && shifts.iter().all(|d| *d == DVec3::ZERO) {
            return EdgeError::NONE;
        }
        let ph = &self.pinhole;
        let length = error + shifts.iter().map(|d| d.length()).sum::<f64>();
        let (Ok((pixel0, depth0)), Ok((pixel1, depth1))) = (ph.project(ends[0]), ph.project(ends[1])) else {
            return EdgeError { px: f64::INFINITY, length };
        };
        let scale = ph.scale_px();
        let lateral = |d: DVec3| DVec2::new(d.dot(ph.right), d.dot(ph.down)) * scale;
        if ph.is_orthographic() {
            return EdgeError { px: error * scale + shifts.iter().map(|&d| lateral(d).length()).sum::<f64>(), length };
        }
        let offsets = [pixel0, pixel1].map(|px| px - ph.center_px());
        let across = |d: DVec3| {
            offsets.map(|off| (lateral(d) - off * d.dot(ph.forward)).length()).into_iter().fold(0.0, f64::max)
        };
        let ball =
            error * offsets.map(|off| (scale * scale + off.length_squared()).sqrt()).into_iter().fold(0.0, f64::max);
        let along = shifts.iter().map(|d| d.dot(ph.forward).abs()).sum::<f64>();
        let depth = depth0.min(depth1) - (error + along);
        let off = shifts.iter().map(|&d| across(d)).sum::<f64>().max(along * scale);
        EdgeError { px: edges::seen_from(ball + off, depth), length }
    }

    /// Conservative image of a box, or `None` if part of it has no image or lies nearer than `near`.
    pub fn image_box(&self, bounds: &Aabb) -> Option<ImageBox> {
        if let Some(split) = self.split_rays() {
            let boxes = split.branches().iter().map(|branch| self.along(branch).image_box(bounds));
            return boxes.reduce(|a, b| Some(a?.union(b?))).flatten();
        }
        let earlier = self.earlier_stages().iter().try_fold(*bounds, |b, stage| stage.displaced_bounds(&b))?;
        let Some(rays) = self.curved_rays().filter(|rays| rays.turn_count() > 0) else {
            return self.pinhole.image_box(&earlier);
        };
        // The pinhole carries hulls to hulls, so the image of the hull points bounds the image of the box.
        let (mut out, mut whole) = (ImageBox::EMPTY, true);
        rays.displaced_hull(&earlier, |v| match self.pinhole.project(self.pinhole.eye + v) {
            Ok((pixel, depth)) if depth >= self.pinhole.near => out = out.including(pixel, depth),
            _ => whole = false,
        })?;
        whole.then_some(out)
    }
}

/// Largest factor by which the map lengthens a small difference at either end of an edge.
fn stretch(map: &dyn SpaceMap, a: DVec3, b: DVec3) -> f64 {
    let norm =
        |p| map.jacobian(p).map_or(f64::INFINITY, |j| j.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt());
    norm(a).max(norm(b))
}

//! A view: a pinhole behind a chain of displacements.

use super::{Camera, Pinhole, Projected, RayPath};
use crate::{Aabb, Displaced, Miss, Stage};
use glam::{DVec2, DVec3};

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
        "stage {second} cannot follow stage {first}; the order is earth, terrain_disocclusion, spline_bend, curved_rays, each at most once"
    )]
    Order {
        /// Name of the earlier stage.
        first: &'static str,
        /// Name of the later stage.
        second: &'static str,
    },
}

/// Conservative image of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageBox {
    /// Smallest pixel coordinates.
    pub min: DVec2,
    /// Largest pixel coordinates.
    pub max: DVec2,
    /// Smallest depth, scene units.
    pub depth_min: f64,
    /// Largest depth, scene units.
    pub depth_max: f64,
}

impl ImageBox {
    /// The box that contains nothing.
    pub const EMPTY: Self =
        Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY, depth_min: f64::INFINITY, depth_max: 0.0 };

    /// This box grown to contain `pixel` at `depth`.
    pub fn including(self, pixel: DVec2, depth: f64) -> Self {
        Self {
            min: self.min.min(pixel),
            max: self.max.max(pixel),
            depth_min: self.depth_min.min(depth),
            depth_max: self.depth_max.max(depth),
        }
    }
}

impl View {
    /// Chains `stages`, in order of application, before `pinhole`.
    ///
    /// # Errors
    /// [`ViewError::Order`] unless the stages are in the order earth, terrain, spline, curved rays, each at most once.
    pub fn new(pinhole: Pinhole, stages: Vec<Stage>) -> Result<Self, ViewError> {
        for pair in stages.windows(2) {
            if pair[0].rank() >= pair[1].rank() {
                return Err(ViewError::Order { first: pair[0].name(), second: pair[1].name() });
            }
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

    /// Whether any stage but the earth's curvature bends the picture.
    pub fn is_bent(&self) -> bool {
        self.stages.iter().any(|s| !matches!(s, Stage::EarthCurvature(_)))
    }

    /// The same camera without the bends (the earth's curvature stays): the "straight" picture.
    pub fn straightened(&self) -> Self {
        let stages = self.stages.iter().filter(|s| matches!(s, Stage::EarthCurvature(_))).cloned().collect();
        Self { pinhole: self.pinhole.clone(), stages }
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
            if let Stage::CurvedRays(rays) = stage {
                segment = rays.segment_at(p);
            }
            p = stage.as_map().invert(p)?;
        }
        Ok((p, segment))
    }

    /// All images of a point, in ray order. More than one only where cells of a curved-ray chain overlap.
    pub fn project_all(&self, p_world: DVec3) -> Vec<Projected> {
        let Some((Stage::CurvedRays(rays), earlier)) = self.stages.split_last() else {
            return self.project(p_world).into_iter().collect();
        };
        let Ok(d) = earlier.iter().try_fold(Displaced { point: p_world, segment: 0, folded: false }, |d, s| {
            let next = s.displace(d.point)?;
            Ok::<_, Miss>(Displaced { folded: d.folded || next.folded, ..next })
        }) else {
            return Vec::new();
        };
        rays.displace_all(d.point)
            .into_iter()
            .filter_map(|image| self.photograph(Displaced { folded: d.folded, ..image }).ok())
            .collect()
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
            chain = stage.as_map().jacobian(p)? * chain;
            p = stage.as_map().apply(p)?;
        }
        let (pixel, depth) = self.pinhole.project(p)?;
        let ph = &self.pinhole;
        let offset = pixel - ph.center_px();
        let rows = [(ph.right, offset.x), (ph.down, offset.y)].map(|(axis, off)| {
            if ph.is_orthographic() { ph.scale_px() * axis } else { (ph.scale_px() * axis - off * ph.forward) / depth }
        });
        Ok(rows.map(|row| chain.transpose() * row))
    }

    /// Bound in pixels on the error of drawing the edge `p0 p1` as a straight image edge between its projected ends.
    /// Infinite if an end has no image or no bound is known.
    pub fn edge_error_px(&self, p0: DVec3, p1: DVec3) -> f64 {
        let (mut a, mut b, mut error) = (p0, p1, 0.0f64);
        for stage in &self.stages {
            let map = stage.as_map();
            let (Ok(a1), Ok(b1)) = (map.apply(a), map.apply(b)) else { return f64::INFINITY };
            // An earlier error is carried on by the stage; along a short edge its stretch is that of the ends.
            let stretch = [a, b].map(|p| {
                map.jacobian(p).map_or(f64::INFINITY, |j| j.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt())
            });
            let carried = if error > 0.0 { error * stretch[0].max(stretch[1]) } else { 0.0 };
            error = carried + stage.edge_bound(a, b);
            (a, b) = (a1, b1);
        }
        if error == 0.0 {
            return 0.0;
        }
        let depth =
            [a, b].map(|p| (p - self.pinhole.eye).dot(self.pinhole.forward)).into_iter().fold(f64::INFINITY, f64::min);
        if self.pinhole.is_orthographic() {
            return error * self.pinhole.scale_px();
        }
        if depth <= error { f64::INFINITY } else { error * self.pinhole.scale_px() / (depth - error) }
    }

    /// Conservative image of a box, or `None` if part of it has no image.
    pub fn image_box(&self, bounds: &Aabb) -> Option<ImageBox> {
        let mut b = *bounds;
        for stage in &self.stages {
            b = stage.displaced_bounds(&b)?;
        }
        self.pinhole.image_box(&b)
    }
}

impl Camera for View {
    fn project(&self, p_world: DVec3) -> Result<Projected, Miss> {
        self.photograph(self.displace(p_world)?)
    }

    fn ray(&self, pixel: DVec2) -> RayPath<'_> {
        RayPath::new(self, pixel)
    }
}

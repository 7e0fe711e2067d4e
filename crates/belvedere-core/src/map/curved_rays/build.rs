//! Builds a chain of turns from its specification.

use super::check::{PreviousTurn, TurnContext, UnscaledTurn, corner_direction, crossing, numbers};
use super::form::{Forms, LinearForm, StraightPart};
use super::phi::Hinge;
use super::remedy::{rays_cross, report};
use super::spec::{CurvedRaysError, Model, Sharpness, TurnSpec};
use super::turn::Turn;
use super::{CurvedRays, Remedy};
use crate::Pinhole;
use glam::{DMat3, DVec2};

/// * `corners`: of the part of the image that the chain draws.
/// * `advise`: whether errors name the nearest valid value.
pub(super) fn build(
    root: &Pinhole,
    model: Model,
    spec: &[TurnSpec],
    corners: &[DVec2],
    advise: bool,
) -> Result<CurvedRays, CurvedRaysError> {
    let mut chain = Chain::new(root, model, corners, advise)?;
    spec.iter().try_for_each(|turn| chain.add(turn))?;
    Ok(chain.finish())
}

/// A chain of valid turns that grows by one turn after the other.
pub(super) struct Chain<'a> {
    root: &'a Pinhole,
    model: Model,
    corners: &'a [DVec2],
    advise: bool,
    part: StraightPart,
    previous: Option<PreviousTurn>,
    spec: Vec<TurnSpec>,
    turns: Vec<Turn>,
}

impl<'a> Chain<'a> {
    /// A chain without turns.
    pub(super) fn new(
        root: &'a Pinhole,
        model: Model,
        corners: &'a [DVec2],
        advise: bool,
    ) -> Result<Self, CurvedRaysError> {
        if root.is_orthographic() {
            return Err(CurvedRaysError::Orthographic);
        }
        let part = StraightPart { viewpoint: root.eye, linear: DMat3::IDENTITY, inverse: DMat3::IDENTITY };
        Ok(Self { root, model, corners, advise, part, previous: None, spec: Vec::new(), turns: Vec::new() })
    }

    /// The context of the turn that comes next.
    pub(super) fn context(&self) -> TurnContext<'a> {
        let Self { root, corners, part, advise, .. } = *self;
        TurnContext { root, corners, turn: self.turns.len() + 1, part, previous: self.previous.clone(), advise }
    }

    /// Adds a turn if it is valid.
    pub(super) fn add(&mut self, spec: &TurnSpec) -> Result<(), CurvedRaysError> {
        let context = self.context();
        numbers(spec, context.turn)?;
        let unscaled = UnscaledTurn::new(spec, context.turn, &self.part)?;
        let forms = unscaled.check(spec, &context).map_err(|violation| report(violation, spec, &context))?;
        let hinge = hinge(self.model, spec, &forms, &context)?;
        let ends = self.corners.iter().map(|px| forms.end(corner_direction(*px, self.root, &self.part))).collect();
        self.previous = Some(PreviousTurn { spec: *spec, part: self.part, ends });
        let turn = Turn::new(&self.part, spec, &forms, hinge);
        self.part = turn.part_after();
        self.spec.push(*spec);
        self.turns.push(turn);
        Ok(())
    }

    pub(super) fn finish(self) -> CurvedRays {
        let Self { root, model, spec, turns, .. } = self;
        let separators = turns.windows(2).map(|pair| separator(&pair[0], &pair[1])).collect();
        CurvedRays { root: root.clone(), model, spec, turns, separators, scale_px: root.scale_px() }
    }
}

/// Hinge of a turn by the ray model.
fn hinge(model: Model, spec: &TurnSpec, forms: &Forms, context: &TurnContext<'_>) -> Result<Hinge, CurvedRaysError> {
    if forms.kink {
        return Ok(Hinge::Broken);
    }
    Ok(match model {
        Model::C0 => Hinge::Broken,
        Model::C2 => Hinge::C2,
        Model::Original => Hinge::Bezier { sigma: original_range(spec, forms, context)? },
        Model::Modified => Hinge::Conic { m: sharpness(spec, forms, context)? },
        Model::Circular => {
            // Our reading of beta: the angle between the planes t0 and t2, normals along the rays, by which a ray that
            // crosses both at right angles turns. Parallel planes: m = 1.
            let (n0, n2) = (forms.a.gradient.normalize(), -forms.b.gradient.normalize());
            let half_square = 0.5 * (1.0 + n0.dot(n2).clamp(-1.0, 1.0));
            if half_square < 1e-12 {
                return Err(CurvedRaysError::SamePlanes { turn: context.turn, distance: 0.0 });
            }
            Hinge::Conic { m: 1.0 / half_square.sqrt() }
        }
    })
}

/// Least and greatest sigma of the picture, between which no rays of the original model may cross.
fn original_range(spec: &TurnSpec, forms: &Forms, context: &TurnContext<'_>) -> Result<[f64; 2], CurvedRaysError> {
    let (range, crossed) = crossing(forms, context);
    match crossed {
        None => Ok(range),
        Some((pixel, sigma)) => Err(rays_cross(pixel, sigma, spec, context)),
    }
}

/// Sharpness m of a turn of the modified model. Computed values are not clamped.
fn sharpness(spec: &TurnSpec, forms: &Forms, context: &TurnContext<'_>) -> Result<f64, CurvedRaysError> {
    let root = context.root;
    let at_pixel = |pixel: DVec2| {
        let sigma = forms.sigma_on(corner_direction(pixel, root, &context.part));
        forms.values.m_sigma(sigma).ok_or_else(|| end_not_reached(pixel, sigma, forms, context))
    };
    match spec.m {
        Sharpness::Value(m) => Ok(m),
        Sharpness::Left => at_pixel(left(context.corners)),
        Sharpness::Mid => {
            let (mut low, mut high) = (f64::INFINITY, 0.0f64);
            for &corner in context.corners {
                let m = at_pixel(corner)?;
                (low, high) = (low.min(m), high.max(m));
            }
            Ok((low * high).sqrt())
        }
        Sharpness::Bend => forms.values.m_sigma(forms.sigma).ok_or_else(|| {
            let v = context.part.linear * (spec.t1 - context.part.viewpoint);
            let pixel = root.project(root.eye + v).map_or(DVec2::ZERO, |(pixel, _)| pixel);
            end_not_reached(pixel, forms.sigma, forms, context)
        }),
    }
}

/// Middle of the corners that lie farthest left.
fn left(corners: &[DVec2]) -> DVec2 {
    let x = corners.iter().map(|c| c.x).fold(f64::INFINITY, f64::min);
    let ys: Vec<f64> = corners.iter().filter(|c| c.x == x).map(|c| c.y).collect();
    DVec2::new(x, ys.iter().sum::<f64>() / ys.len() as f64)
}

fn end_not_reached(pixel: DVec2, sigma: f64, forms: &Forms, context: &TurnContext<'_>) -> CurvedRaysError {
    let turn = context.turn;
    CurvedRaysError::EndNotReached { turn, pixel, sigma, limit: forms.values.b1, remedy: Remedy::BendInPicture }
}

/// The plane halfway, in 1/depth, between t2 of one turn and t0 of the next: 1/depth of a plane is affine in the pixel,
/// so there is such a plane, and it lies in the straight part for every pixel.
fn separator(turn: &Turn, next: &Turn) -> LinearForm {
    let (t2, t0) = (turn.b.scaled(-1.0 / turn.values.b1), next.a.scaled(-1.0 / next.values.a0));
    let gradient = t2.gradient + t0.gradient;
    let origin = turn.viewpoint;
    // Both forms are -1 at the viewpoint, by their scale.
    LinearForm { origin, at_origin: -2.0, gradient }.scaled(1.0 / gradient.length())
}

//! Rays that bend around occluders: the curved ray camera as a displacement of space.
//!
//! Source: Cui, Rosen, Popescu, Hoffmann, "A Curved Ray Camera for Handling Occlusions through Continuous Multiperspective
//! Visualization" (2010). A turn j joins the planar pinholes of viewpoints j-1 and j: rays are straight up to plane t0,
//! straight again after plane t2, and tangent arcs in between. Our reading (see `phi`): this is the root pinhole looking at
//!
//! ```text
//! X' = X + sum_j phi_j(X) d_j
//! ```
//!
//! where phi_j is a smooth hinge, 0 before t0 and affine after t2, and d_j is a fixed vector per turn.

mod bounds;
mod build;
mod check;
mod form;
mod location;
mod mend;
mod nearest;
mod phi;
mod ray;
mod remedy;
mod segments;
mod spec;
mod turn;

pub(crate) use bounds::EdgeEnd;
pub use form::LinearForm;
pub use mend::Mended;
pub use phi::ViewpointValues;
pub use ray::{Bend, C2Arc, RayPiece, Shape};
pub use segments::StraightMap;
pub use spec::{CurvedRaysError, Model, Pencil, Remedy, Sharpness, TurnSpec};
pub use turn::Turn;

use super::{Displaced, Miss, SpaceMap};
use crate::Pinhole;
use glam::{DMat3, DVec2, DVec3};
use turn::Cell;

/// How far outside the image, in pixels, a point still counts as inside when cells are told apart: covers rounding.
const MARGIN_PX: f64 = 1e-6;

/// A curved ray camera with any number of turns, as the last stage of a view.
///
/// ```
/// use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
/// use belvedere_core::{DVec2, DVec3, Pinhole, Projection, Stage, View};
///
/// let perspective = Projection::Perspective { fov_y: 45f64.to_radians() };
/// let eye = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, perspective, [1280, 720], 1.0, None)?;
/// let turn = TurnSpec {
///     viewpoint: DVec3::new(40.0, 0.0, 0.0),
///     t0: DVec3::new(0.0, 40.0, 0.0),
///     t1: DVec3::new(0.0, 50.0, 0.0),
///     t2: DVec3::new(0.0, 60.0, 0.0),
///     pencil: Pencil::Parallel { normal: DVec3::Y },
///     m: Sharpness::Bend,
/// };
/// let rays = CurvedRays::new(&eye, Model::Modified, &[turn])?;
/// let view = View::new(eye, vec![Stage::CurvedRays(rays)])?;
/// let seen = view.ray(DVec2::new(640.0, 360.0)).at(100.0).unwrap();
/// assert!((seen.point - DVec3::new(-40.0, 100.0, 0.0)).length() < 1e-9); // the central ray leans left past the turn
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CurvedRays {
    root: Pinhole,
    model: Model,
    spec: Vec<TurnSpec>,
    turns: Vec<Turn>,
    /// `separators[k]` cuts record k from record k + 1; positive on the side of record k + 1; unit gradient.
    separators: Vec<LinearForm>,
    /// `root.scale_px()`, which costs a tangent.
    scale_px: f64,
}

/// A cell of the chain that holds a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Index of the turn whose record displaces the point.
    turn: usize,
    cell: Cell,
    /// Displaced point relative to the eye.
    v: DVec3,
}

impl Hit {
    fn segment(&self) -> u32 {
        segment(self.turn, self.cell)
    }
}

/// Segment number of a cell of a turn.
fn segment(turn: usize, cell: Cell) -> u32 {
    let first = 2 * u32::try_from(turn).unwrap_or(u32::MAX / 4);
    match cell {
        Cell::Before => first,
        Cell::Wedge => first + 1,
        Cell::After => first + 2,
    }
}

impl CurvedRays {
    /// The camera whose rays start in `root` and bend at `turns`, in ray order. No turn at all is the pinhole itself.
    ///
    /// # Errors
    /// Every [`CurvedRaysError`]: the first condition, turn by turn, that does not hold, with the nearest valid value.
    pub fn new(root: &Pinhole, model: Model, turns: &[TurnSpec]) -> Result<Self, CurvedRaysError> {
        build::build(root, model, turns, &check::corner_pixels(root), true)
    }

    /// The same for searches that try many turns: `None` where [`CurvedRays::new`] returns an error, without the search for the nearest
    /// valid value, which takes a hundred times as long.
    pub fn if_valid(root: &Pinhole, model: Model, turns: &[TurnSpec]) -> Option<Self> {
        build::build(root, model, turns, &check::corner_pixels(root), false).ok()
    }

    /// The same for a part of the image: the conditions hold within the convex polygon of `corners`, pixels.
    pub(crate) fn within(
        root: &Pinhole,
        model: Model,
        turns: &[TurnSpec],
        corners: &[DVec2],
    ) -> Result<Self, CurvedRaysError> {
        build::build(root, model, turns, corners, true)
    }

    /// These rays at a share of their strength: viewpoints are interpolated from the eye. `None` if such turns are not valid.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        let turns: Vec<TurnSpec> = self.spec.iter().map(|turn| turn.eased(self.root.eye, share)).collect();
        Self::if_valid(&self.root, self.model, &turns)
    }

    /// The pinhole that the rays start in.
    pub fn root(&self) -> &Pinhole {
        &self.root
    }

    /// Shape of the rays in the transitions.
    pub fn model(&self) -> Model {
        self.model
    }

    /// The turns as given.
    pub fn spec(&self) -> &[TurnSpec] {
        &self.spec
    }

    /// The turns with everything derived from them.
    pub fn turns(&self) -> &[Turn] {
        &self.turns
    }

    /// Number of turns.
    pub fn turn_count(&self) -> usize {
        self.turns.len()
    }

    /// Number of records, at least 1: how often a renderer draws an object that spans the whole chain.
    pub fn records(&self) -> usize {
        self.turns.len().max(1)
    }

    /// Displaced point and segment: the first cell in ray order inside the image, the sequential plane test outside it.
    ///
    /// Inside the image the ray that reaches the point decides, so that every point of a ray has its pixel among the images.
    ///
    /// # Errors
    /// [`Miss::BehindEye`] where a later part looks backwards; [`Miss::OutsideDomain`] for numbers that are not finite.
    /// Points behind the eye before the first turn stay where they are.
    pub fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        self.finish(p, self.locate(p)?)
    }

    /// All images of `p`, in ray order: a point that two parts of rays reach is truly visible twice.
    pub fn displace_all(&self, p: DVec3) -> Vec<Displaced> {
        let mut all = self.displace_into_image(p);
        if all.is_empty() {
            all.extend(self.displace(p));
        }
        all
    }

    /// The same for images inside the picture only.
    pub(crate) fn displace_into_image(&self, p: DVec3) -> Vec<Displaced> {
        let mut all = Vec::new();
        self.cells_in_image(p, |hit| {
            all.extend(self.finish(p, hit));
            false
        });
        all
    }

    /// Displacement by the record of turn `record` (from 0) alone, for drawing once per record. It is one continuous map of space: beyond
    /// the common line, points before t1 are displaced as before the turn, points past t1 as after it. Points there that rays also reach on
    /// the other part are left to [`CurvedRays::displace_along`].
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] if there is no such record.
    pub fn displace_in(&self, record: usize, p: DVec3) -> Result<Displaced, Miss> {
        if self.turns.is_empty() && record == 0 {
            return self.displace(p);
        }
        self.finish(p, self.hit_in(record, p)?)
    }

    /// Signed distances of `p`, scene units, to the two planes that cut record `record` from its neighbours;
    /// a renderer keeps points where both are positive (infinite at the ends of the chain).
    /// On such a plane both records displace alike.
    pub fn record_margins(&self, record: usize, p: DVec3) -> [f64; 2] {
        let beyond = record.checked_sub(1).and_then(|k| self.separators.get(k)).map_or(f64::INFINITY, |y| y.at(p));
        let before = self.separators.get(record).map_or(f64::INFINITY, |y| -y.at(p));
        // comparisons with NaN are false, so a margin of NaN would not clip: such a point is outside all records
        [beyond, before].map(|d| if d.is_nan() { f64::NEG_INFINITY } else { d })
    }

    /// The plane between records `record` and `record + 1`: zero on it, positive beyond, per scene unit; `None` at the end of the chain.
    pub fn separator(&self, record: usize) -> Option<&LinearForm> {
        self.separators.get(record)
    }

    /// Segment of the ray that passes through a displaced point; 0 where no ray passes.
    pub fn segment_at(&self, p_displaced: DVec3) -> u32 {
        self.undisplace(p_displaced).map_or(0, |(_, segment)| segment)
    }

    /// The point that is displaced onto `p_displaced`, and its segment: the curved ray in closed form.
    ///
    /// # Errors
    /// [`Miss::BehindEye`] behind the eye, except before the first turn; [`Miss::OutsideDomain`] where no ray passes.
    pub fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        let v = p_displaced - self.root.eye;
        if !v.is_finite() {
            return Err(Miss::OutsideDomain);
        }
        let Some(first) = self.turns.first() else { return Ok((p_displaced, 0)) };
        if !(v.dot(self.root.forward) > 0.0) {
            return if first.is_before(p_displaced) { Ok((p_displaced, 0)) } else { Err(Miss::BehindEye) };
        }
        let last = self.turns.len() - 1;
        for (index, turn) in self.turns.iter().enumerate() {
            let (p, cell) = turn.undisplaced(v)?;
            if cell == Cell::After && index < last {
                continue;
            }
            let p = if index == 0 && cell == Cell::Before { p_displaced } else { p };
            return if p.is_finite() { Ok((p, segment(index, cell))) } else { Err(Miss::OutsideDomain) };
        }
        Err(Miss::OutsideDomain)
    }

    fn hit_in(&self, record: usize, p: DVec3) -> Result<Hit, Miss> {
        let turn = self.turns.get(record).ok_or(Miss::OutsideDomain)?;
        let cell = turn.cell(p)?;
        Ok(Hit { turn: record, cell, v: turn.displaced(p, cell)? })
    }

    /// The cell that displaces a point.
    fn locate(&self, p: DVec3) -> Result<Hit, Miss> {
        let mut first = None;
        self.cells_in_image(p, |hit| {
            first = Some(hit);
            true
        });
        first.map_or_else(|| self.walk(p), Ok)
    }

    /// The paper's sequential test: the first turn whose t2 the point has not passed.
    fn walk(&self, p: DVec3) -> Result<Hit, Miss> {
        let Some(last) = self.turns.len().checked_sub(1) else {
            return Ok(Hit { turn: 0, cell: Cell::Before, v: p - self.root.eye });
        };
        let past = |turn: &Turn| !turn.is_before(p) && turn.is_after(p);
        let record = self.turns.iter().position(|turn| !past(turn)).unwrap_or(last);
        let turn = &self.turns[record];
        let cell = if turn.is_before(p) { Cell::Before } else { turn.cell(p)? };
        let hit = Hit { turn: record, cell, v: turn.displaced(p, cell)? };
        let root_part = record == 0 && hit.cell == Cell::Before;
        if root_part || hit.v.dot(self.root.forward) > 0.0 { Ok(hit) } else { Err(Miss::BehindEye) }
    }

    /// Visits, in ray order, the cells in which rays through the image reach the point, until `visit` returns `true`.
    ///
    /// On a straight part the test is one plane at either end, and whether the part maps the point into the image: the forms of the planes
    /// are affine along its rays, see [`Turn::is_before`] and [`Turn::is_after`].
    fn cells_in_image(&self, p: DVec3, mut visit: impl FnMut(Hit) -> bool) {
        let mut held = |index: usize, cell: Cell| {
            let v = self.turns[index].displaced(p, cell).ok().filter(|&v| self.in_image(v));
            v.is_some_and(|v| visit(Hit { turn: index, cell, v }))
        };
        for (index, turn) in self.turns.iter().enumerate() {
            let before_next = || self.turns.get(index + 1).is_none_or(|next| next.is_before(p));
            // The straight part before a later turn is the one after the turn before it.
            if (index == 0 && turn.is_before(p) && held(index, Cell::Before))
                || (turn.cell(p) == Ok(Cell::Wedge) && held(index, Cell::Wedge))
                || (turn.is_after(p) && before_next() && held(index, Cell::After))
            {
                return;
            }
        }
    }

    fn in_image(&self, v: DVec3) -> bool {
        let depth = v.dot(self.root.forward);
        let pixel =
            self.root.center_px() + DVec2::new(v.dot(self.root.right), v.dot(self.root.down)) * (self.scale_px / depth);
        let [w, h] = self.root.image.map(f64::from);
        depth > 0.0
            && (-MARGIN_PX..=w + MARGIN_PX).contains(&pixel.x)
            && (-MARGIN_PX..=h + MARGIN_PX).contains(&pixel.y)
    }

    fn finish(&self, p: DVec3, hit: Hit) -> Result<Displaced, Miss> {
        let point = if hit.turn == 0 && hit.cell == Cell::Before { p } else { self.root.eye + hit.v };
        let displaced = Displaced { point, segment: hit.segment(), folded: false };
        if point.is_finite() { Ok(displaced) } else { Err(Miss::OutsideDomain) }
    }
}

impl SpaceMap for CurvedRays {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        self.displace(p).map(|d| d.point)
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        self.undisplace(p_displaced).map(|(p, _)| p)
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        if !p.is_finite() {
            return Err(Miss::OutsideDomain);
        }
        let hit = self.locate(p)?;
        let Some(turn) = self.turns.get(hit.turn) else { return Ok(DMat3::IDENTITY) };
        let j = turn.jacobian(p, hit.cell)?;
        if j.is_finite() { Ok(j) } else { Err(Miss::OutsideDomain) }
    }
}

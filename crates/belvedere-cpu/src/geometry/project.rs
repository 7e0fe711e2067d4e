//! Projects nodes of the ground onto the image in single precision, many at once.
//!
//! Everything is measured from the eye, where rounding to 24 bits costs a direction less than 1e-7 of a radian. Plain loops
//! without branches over slices, so that compilers turn them into vector instructions; only operations that IEEE 754
//! rounds exactly, so that every machine and every vector width gives the same bits.

mod cameras;
mod runs;

use crate::geometry::spline_from_eye::SplineFromEye;
use crate::screen::{Row, SUB};
use crate::simd;
use belvedere_core::map::curved_rays::{LinearForm, StraightMap, Turn};
use belvedere_core::map::terrain::TerrainDisocclusion;
use belvedere_core::{DVec2, DVec3, Pinhole, View};
use belvedere_scene::Heightfield;
use belvedere_sight::Fast;
use belvedere_sight::pass::{SplineTable, Way};
use cameras::{Bend, Form, Spline};
use rayon::prelude::*;
pub(crate) use runs::Batch;
use runs::{BatchRun, LANES, Run};

/// Nodes lifted at a time.
const CHUNK: usize = 64;

/// The chain of a view in single precision, for one record of its curved rays.
///
/// Agrees with [`View`] to 0.01 px: curved earth around the eye, terrain disocclusion, one turn of conic arcs or a spline bend, pinhole.
#[derive(Debug)]
pub(crate) struct Projector<'a> {
    eye: DVec3,
    /// Height of the eye, and its remainder after rounding to single precision.
    eye_z: [f32; 2],
    /// Drop of the ground per squared distance.
    earth: f32,
    lift: Option<&'a TerrainDisocclusion>,
    /// Parts of one record, or of all records that displace as one map.
    parts: Vec<Part>,
    /// A spline bend, which comes after earth and disocclusion.
    spline: Option<Spline>,
    /// Affine forms between each part and the next: positive beyond.
    separators: Vec<Form>,
    scale: f32,
    center: [i32; 2],
    ortho: bool,
    near: f32,
    far: f32,
}

/// A record.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// View space before the turn: right, down, forward.
    view: [Form; 3],
    bend: Option<Bend>,
}

impl<'a> Projector<'a> {
    /// `None` if the chain has a stage without this form.
    pub(crate) fn new(view: &'a View, way: Way) -> Option<Self> {
        let p = view.pinhole();
        let high = p.eye.z as f32;
        let mut out = Self {
            eye: p.eye,
            eye_z: [high, (p.eye.z - f64::from(high)) as f32],
            earth: 0.0,
            lift: None,
            parts: vec![Part { view: [p.right, p.down, p.forward].map(|axis| Form::new(axis, 0.0)), bend: None }],
            spline: None,
            separators: Vec::new(),
            scale: p.scale_px() as f32,
            center: (p.center_px() * f64::from(SUB)).to_array().map(|c| c.round() as i32),
            ortho: p.is_orthographic(),
            near: p.near as f32,
            far: p.far.map_or(f32::INFINITY, |far| far as f32),
        };
        for stage in view.stages() {
            match Fast::of(stage) {
                Fast::Earth(e) if e.eye.truncate() == p.eye.truncate() => {
                    out.earth = ((1.0 - e.refraction) / (2.0 * e.radius)) as f32;
                }
                Fast::Ground(t) => out.lift = Some(t),
                Fast::Spline(bend) => {
                    let table = SplineFromEye::new(&SplineTable::new(bend), p.eye)?;
                    out.spline = Some(Spline::new(table, [p.right, p.down, p.forward]));
                }
                // Turns take what a spline has bent.
                Fast::Rays(_) if out.spline.is_some() => return None,
                Fast::Rays(rays) if rays.turns().is_empty() => {}
                Fast::Rays(rays) => {
                    let of_record = |record| Part::of(p, rays.turns().get(record)?);
                    match way {
                        Way::Records([first, last]) => {
                            let form = |y: &LinearForm| Form::new(y.gradient, y.at(p.eye));
                            out.parts = (first..=last).map(of_record).collect::<Option<_>>()?;
                            out.separators = (first..last).filter_map(|k| rays.separator(k)).map(form).collect();
                        }
                        Way::Segment(number) => {
                            out.parts = vec![match rays.straight_map(number) {
                                Some(map) => Part { view: Part::view_of(p, &map), bend: None },
                                None => of_record(number as usize / 2)?,
                            }];
                        }
                    }
                }
                _ => return None,
            }
        }
        Some(out)
    }

    /// A coordinate relative to the eye; nodes of one column (or row) share it whatever block they are drawn in.
    #[inline]
    pub(crate) fn relative(&self, xy: DVec2) -> [f32; 2] {
        [(xy.x - self.eye.x) as f32, (xy.y - self.eye.y) as f32]
    }

    /// Images of nodes with the given heights; `false` if one of them has none here: it has no image, must be clipped, or lies
    /// far outside the image.
    /// * `x`, `y`: relative to the eye.
    pub(crate) fn row(&self, x: &[f32], y: f32, heights: &[f32], out: &mut Row<'_>) -> bool {
        let Some(lift) = self.lift else { return self.run(x, y, heights, out) };
        let mut whole = true;
        for (k, (x, heights)) in x.chunks(CHUNK).zip(heights.chunks(CHUNK)).enumerate() {
            let mut lifted = [0.0f32; CHUNK];
            for ((l, h), x) in lifted.iter_mut().zip(heights).zip(x) {
                let p = DVec3::new(self.eye.x + f64::from(*x), self.eye.y + f64::from(y), 0.0);
                *l = (f64::from(*h) + lift.delta_at(p)) as f32;
            }
            let part = k * CHUNK..k * CHUNK + x.len();
            let mut out = Row { x: &mut out.x[part.clone()], y: &mut out.y[part.clone()], q: &mut out.q[part.clone()] };
            whole &= self.run(x, y, &lifted[..x.len()], &mut out);
        }
        whole
    }

    /// Images of positions: sets images, nearness and misses of a batch. `false` if the chain has no such form here: moved ground, or
    /// several records that displace as one map.
    /// * `places`: in scene coordinates.
    pub(crate) fn batch(&self, places: impl ExactSizeIterator<Item = DVec3>, batch: &mut Batch) -> bool {
        let ([part], None) = (&self.parts[..], self.lift) else { return false };
        let n = places.len().next_multiple_of(LANES);
        let Batch { x, y, z, images, nearness, missed } = batch;
        [&mut *x, &mut *y, &mut *z].into_iter().for_each(|list| list.clear());
        for p in places {
            let p = p - self.eye;
            x.push(p.x as f32);
            y.push(p.y as f32);
            z.push(p.z as f32);
        }
        [x, y, z, nearness].into_iter().for_each(|list| list.resize(n, 0.0));
        images.iter_mut().for_each(|list| list.resize(n, 0));
        missed.resize(n, 0);
        simd::run(BatchRun { projector: self, part, batch })
    }

    fn run(&self, x: &[f32], y: f32, heights: &[f32], out: &mut Row<'_>) -> bool {
        if let [part] = &self.parts[..] {
            return simd::run(Run { projector: self, part, x, y, heights, out });
        }
        let run = |part, x, heights, out: &mut Row<'_>| simd::run(Run { projector: self, part, x, y, heights, out });
        if let Some(part) = self.only_part(x, y, heights) {
            return run(&self.parts[part], x, heights, out);
        }
        let of = |i: usize| self.part_of(x[i], y, self.z(x[i], y, heights[i]));
        let (mut from, mut whole) = (0, true);
        while from < x.len() {
            let part = of(from);
            let to = (from + 1..x.len()).find(|&i| of(i) != part).unwrap_or(x.len());
            let nodes = from..to;
            let (x, heights) = (&x[nodes.clone()], &heights[nodes.clone()]);
            let mut out = Row { x: &mut out.x[nodes.clone()], y: &mut out.y[nodes.clone()], q: &mut out.q[nodes] };
            whole &= run(&self.parts[part], x, heights, &mut out);
            from = to;
        }
        whole
    }

    /// Number of the part that a node belongs to.
    fn part_of(&self, x: f32, y: f32, z: f32) -> usize {
        self.separators.partition_point(|s| s.at([x, y, z]) > 0.0)
    }

    /// The part that all nodes of a row belong to, if there is one, judged by the corners of a rectangle around them.
    fn only_part(&self, x: &[f32], y: f32, heights: &[f32]) -> Option<usize> {
        let (&west, &east) = (x.first()?, x.last()?);
        let low = heights.iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a });
        let high = heights.iter().fold(f32::NEG_INFINITY, |a, &b| if b > a { b } else { a });
        let far = if west.abs() > east.abs() { west } else { east };
        let (low, high) = (self.z(far, y, low), self.z(west.max(0.0).min(east), y, high));
        let part = self.part_of(west, y, low);
        [(west, high), (east, low), (east, high)]
            .into_iter()
            .all(|(x, z)| self.part_of(x, y, z) == part)
            .then_some(part)
    }

    /// Height over the eye after the earth's drop.
    #[inline(always)]
    fn z(&self, x: f32, y: f32, height: f32) -> f32 {
        ((height - self.eye_z[0]) - self.eye_z[1]) - self.earth * (x * x + y * y)
    }
}

impl Part {
    /// View space of a straight part.
    fn view_of(p: &Pinhole, map: &StraightMap) -> [Form; 3] {
        [p.right, p.down, p.forward].map(|axis| {
            let gradient = map.linear.transpose() * axis;
            Form::new(gradient, gradient.dot(p.eye - map.viewpoint))
        })
    }

    fn of(p: &Pinhole, turn: &Turn) -> Option<Self> {
        let axes = [p.right, p.down, p.forward];
        let view = Self::view_of(p, &StraightMap { viewpoint: turn.viewpoint_before, linear: turn.before });
        let bend = Bend {
            a: Form::new(turn.a.gradient, turn.a.at(p.eye)),
            b: Form::new(turn.b.gradient, turn.b.at(p.eye)),
            m: turn.m? as f32,
            shift: axes.map(|axis| turn.shift.dot(axis) as f32),
        };
        Some(Self { view, bend: Some(bend) })
    }
}

/// Images of all nodes of a ground, row-major, as the first step of a frame.
///
/// Pixels in 1/256, nearness (1 / depth in perspective, -depth in parallel projection); within 0.01 px of
/// [`View::project_all`]'s image by one record.
#[derive(Debug, Default)]
pub struct GroundImage {
    /// Pixels from the left border, times 256.
    pub x: Vec<i32>,
    /// Pixels from the top border, times 256.
    pub y: Vec<i32>,
    /// Nearness.
    pub nearness: Vec<f32>,
}

impl GroundImage {
    /// Projects every node, holes included, by a record of the view; `false` if a stage has no form in single precision, or
    /// if a node has no image or lies more than 16 000 px from the image centre (its values are then unspecified).
    pub fn project(&mut self, hf: &Heightfield, view: &View, record: usize) -> bool {
        let Some(projector) = Projector::new(view, Way::Records([record; 2])) else { return false };
        let n = hf.heights().len();
        self.x.resize(n, 0);
        self.y.resize(n, 0);
        self.nearness.resize(n, 0.0);
        let columns: Vec<f32> = (0..hf.cols()).map(|c| projector.relative(hf.node_xy(c, 0))[0]).collect();
        let rows = self.x.par_chunks_mut(hf.cols()).zip(self.y.par_chunks_mut(hf.cols()));
        rows.zip(self.nearness.par_chunks_mut(hf.cols()))
            .zip(hf.heights().par_chunks(hf.cols()))
            .enumerate()
            .map(|(r, (((x, y), q), heights))| {
                let north = projector.relative(hf.node_xy(0, r))[1];
                projector.row(&columns, north, heights, &mut Row { x, y, q })
            })
            .reduce(|| true, |a, b| a & b)
    }
}

#[cfg(test)]
mod tests;

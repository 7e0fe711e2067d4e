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
mod tests {
    use super::*;
    use crate::simd::Kernel;
    use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
    use belvedere_core::map::earth::EarthCurvature;
    use belvedere_core::map::spline::{ReferencePlane, default_pivot};
    use belvedere_core::presets::PresetDocument;
    use belvedere_core::{CurvedRays, Projection, SplineBend, Stage};

    fn camera(screen: Projection) -> Pinhole {
        let (eye, target) = (DVec3::new(512_345.678, 4_712_345.432, 3021.37), DVec3::new(513_000.0, 4.725e6, 0.0));
        Pinhole::look_at(eye, target, DVec3::Z, screen, [1280, 720], 1.0, None).unwrap()
    }

    fn turns(camera: &Pinhole, specs: &[(f64, f64)]) -> Stage {
        let specs: Vec<TurnSpec> = specs
            .iter()
            .map(|&(at, rise)| TurnSpec {
                viewpoint: camera.eye + DVec3::new(60.0, -90.0, rise),
                t0: camera.eye + DVec3::new(0.0, at, -2000.0),
                t1: camera.eye + DVec3::new(0.0, at + 1000.0, -2000.0),
                t2: camera.eye + DVec3::new(0.0, at + 2200.0, -2000.0),
                pencil: Pencil::Parallel { normal: DVec3::Y },
                m: Sharpness::Bend,
            })
            .collect();
        Stage::CurvedRays(CurvedRays::new(camera, Model::Modified, &specs).unwrap())
    }

    fn spline(camera: &Pinhole, name: &str) -> Stage {
        let plane = ReferencePlane::level(600.0);
        let document = PresetDocument::builtin(name).unwrap();
        Stage::SplineBend(SplineBend::new(camera, &document, &plane, default_pivot(camera, &plane)).unwrap())
    }

    fn views() -> Vec<View> {
        let camera = camera(Projection::Perspective { fov_y: 0.9 });
        let flat = self::camera(Projection::Orthographic { height: 9000.0 });
        let earth = Stage::EarthCurvature(EarthCurvature { eye: camera.eye, radius: 6.37e6, refraction: 0.13 });
        let grid = belvedere_core::grid::Grid::new(
            camera.eye.truncate() + DVec2::new(-20e3, 40e3),
            DVec2::splat(500.0),
            81,
            81,
            (0..81 * 81).map(|i| 40.0 * f64::from(i % 13).sin()).collect(),
        );
        let lift = Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid.unwrap()));
        let bent = turns(&camera, &[(4000.0, 700.0), (9000.0, 1300.0)]);
        let [near, far, steep] =
            ["progressive", "degressive", "hybrid-flat-steep-flat"].map(|name| spline(&camera, name));
        let low = spline(&flat, "progressive");
        let stages = [
            vec![],
            vec![earth.clone()],
            vec![lift.clone()],
            vec![bent.clone()],
            vec![earth.clone(), lift.clone(), bent],
            vec![near.clone()],
            vec![far],
            vec![steep],
            vec![earth, lift, near],
        ];
        let with = |stages| View::new(camera.clone(), stages).unwrap();
        let parallel = [View::straight(flat.clone()), View::new(flat, vec![low]).unwrap()];
        stages.into_iter().map(with).chain(parallel).collect()
    }

    /// Columns, rows and heights around the eye, in scene coordinates.
    fn ground() -> (Vec<f64>, Vec<f64>, Vec<f32>) {
        let eye = camera(Projection::Perspective { fov_y: 0.9 }).eye;
        let x = (0..33).map(|c| eye.x - 6e3 + 11.3 + 390.0 * f64::from(c)).collect();
        let y: Vec<f64> = (0..400).map(|r| eye.y + 60.0 + 1.1 * f64::from(r) + 0.15 * f64::from(r * r)).collect();
        let z = (0..33 * 400u32).map(|i| (900.0 + 700.0 * f64::from(i * 7 % 101).sin()) as f32).collect();
        (x, y, z)
    }

    #[test]
    fn single_precision_is_within_a_hundredth_of_a_pixel() {
        let (xs, ys, zs) = ground();
        for (k, view) in views().iter().enumerate() {
            for record in 0..view.records() {
                let projector = Projector::new(view, Way::Records([record; 2])).expect("has a form");
                let (mut worst, mut seen) = (0.0f64, 0);
                for (r, &y) in ys.iter().enumerate() {
                    for (c, &x) in xs.iter().enumerate() {
                        let p = DVec3::new(x, y, f64::from(zs[r * 33 + c]));
                        let [rx, ry] = projector.relative(p.truncate());
                        let ([mut px], [mut py], [mut q]) = ([0], [0], [0.0]);
                        let mut out = Row {
                            x: std::slice::from_mut(&mut px),
                            y: std::slice::from_mut(&mut py),
                            q: std::slice::from_mut(&mut q),
                        };
                        let whole = projector.row(&[rx], ry, &[zs[r * 33 + c]], &mut out);
                        let exact = view.displace_in(record, p).ok().and_then(|d| view.pinhole().project(d.point).ok());
                        let Some((pixel, depth)) = exact.filter(|(_, depth)| *depth > 5.0) else { continue };
                        let off = (pixel - view.pinhole().center_px()).abs().max_element();
                        assert!(whole || off > 15_000.0, "view {k}, record {record}: {p} at {pixel} is missed");
                        if off < 4000.0 {
                            let image = DVec2::new(f64::from(px), f64::from(py)) / f64::from(SUB);
                            worst = worst.max(image.distance(pixel));
                            let near = if view.pinhole().is_orthographic() { -depth } else { 1.0 / depth };
                            assert!((f64::from(q) - near).abs() < 2e-6 * near.abs(), "view {k}: nearness {q}, {near}");
                            seen += 1;
                        }
                    }
                }
                assert!(seen > 3000, "view {k}: {seen}");
                assert!(worst <= 0.01, "view {k}, record {record}: {worst} px");
            }
        }
    }

    #[test]
    fn a_row_and_its_nodes_agree_to_the_last_bit() {
        let (xs, ys, zs) = ground();
        for view in views() {
            let projector = Projector::new(&view, Way::Records([0; 2])).expect("has a form");
            let relative: Vec<f32> = xs.iter().map(|&x| projector.relative(DVec2::new(x, 0.0))[0]).collect();
            for (r, &y) in ys.iter().enumerate().step_by(7) {
                let (mut x, mut py, mut q) = ([0; 33], [0; 33], [0.0; 33]);
                let north = projector.relative(DVec2::new(0.0, y))[1];
                let heights = &zs[r * 33..][..33];
                let mut out = Row { x: &mut x, y: &mut py, q: &mut q };
                if !projector.row(&relative, north, heights, &mut out) {
                    continue;
                }
                for c in 0..33 {
                    let (mut x1, mut y1, mut q1) = ([0], [0], [0.0]);
                    let mut out = Row { x: &mut x1, y: &mut y1, q: &mut q1 };
                    assert!(projector.row(&relative[c..=c], north, &heights[c..=c], &mut out));
                    assert_eq!((x1[0], y1[0], q1[0].to_bits()), (x[c], py[c], q[c].to_bits()));
                }
            }
        }
    }

    #[test]
    fn all_versions_give_the_same_bits() {
        let (xs, ys, zs) = ground();
        for view in views() {
            let projector = Projector::new(&view, Way::Records([0; 2])).expect("has a form");
            let relative: Vec<f32> = xs.iter().map(|&x| projector.relative(DVec2::new(x, 0.0))[0]).collect();
            for (r, &y) in ys.iter().enumerate().step_by(7) {
                let y = projector.relative(DVec2::new(0.0, y))[1];
                let image = |plain: bool| {
                    let (mut x, mut py, mut q) = ([0; 33], [0; 33], [0.0; 33]);
                    let out = &mut Row { x: &mut x, y: &mut py, q: &mut q };
                    let run = Run {
                        projector: &projector,
                        part: &projector.parts[0],
                        x: &relative,
                        y,
                        heights: &zs[r * 33..][..33],
                        out,
                    };
                    let whole = if plain { run.run() } else { simd::run(run) };
                    (x, py, q.map(f32::to_bits), whole)
                };
                assert!(image(true) == image(false), "row {r}");
            }
        }
    }
}

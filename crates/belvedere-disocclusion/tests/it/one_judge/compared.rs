//! Random cases, and the share of what must be seen by the report, by `measure`, and by a march along rays that shares no code with either.

use belvedere_construct::measure::{FeatureMeasure, Visibility};
use belvedere_construct::{MeasureOptions, Measures, measure};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere_cpu::CpuRenderer;
use belvedere_disocclusion::{TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_scene::{
    AreaFeature, AreaLayer, AreaSurface, Color, Heightfield, Hidden, Layer, LayerKind, NodeState, Progress, Scene,
};
use belvedere_testkit::Random;
use belvedere_testkit::synthetic::{line_layer, point_layer, terrain_layer};
use rayon::prelude::*;

const NODES: usize = 33;
pub(crate) const LIFT_M: f64 = 1.0;
/// Largest difference between the shares of two methods.
pub(crate) const AGREES: f64 = 0.005;

/// Ground, its spacing, and a path, an area and a summit on it.
pub(crate) struct Case {
    pub(crate) scene: Scene,
    spacing: f64,
    way: Vec<DVec2>,
    square: [DVec2; 2],
    pub(crate) base: View,
}

/// Made ground: fine and coarse, gentle and steep.
pub(crate) fn made(seed: u64) -> Heightfield {
    let mut random = Random::new(seed);
    let spacing = [10.0, 30.0, 90.0, 250.0][seed as usize % 4];
    let size = (NODES - 1) as f64 * spacing;
    let relief = size * random.range(0.08, 0.3);
    let (a, b, phase) = (random.range(0.2, 0.5), random.range(0.2, 0.5), random.range(0.0, 6.0));
    let heights: Vec<f32> = (0..NODES * NODES)
        .map(|i| {
            let (x, y) = ((i % NODES) as f64, (i / NODES) as f64);
            let ridges = (a * x + (0.3 * y).sin() + phase).sin().abs() + (b * y + (0.2 * x).cos()).sin().abs();
            (500.0 + 0.45 * relief * ridges + 0.1 * relief * random.unit()) as f32
        })
        .collect();
    let states = vec![NodeState::Measured; NODES * NODES];
    Heightfield::new(DVec2::new(0.0, size), DVec2::splat(spacing), NODES, NODES, heights, states).unwrap()
}

/// A path, an area and a summit on square ground without holes, and an eye at its southern rim.
///
/// * `image`: of the picture, pixels.
pub(crate) fn case(hf: Heightfield, seed: u64, image: [u32; 2]) -> Case {
    let mut random = Random::new(seed ^ 0x5eed);
    let spacing = hf.spacing().x;
    let size = (hf.cols() - 1) as f64 * spacing;
    let south_west = hf.node_xy(0, hf.rows() - 1);
    let heights = hf.heights().iter().map(|z| f64::from(*z));
    let [lowest, highest] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], z| [z.min(l), z.max(h)]);
    let relief = highest - lowest;
    let place = |random: &mut Random, low: f64, high: f64| {
        south_west + DVec2::new(random.range(low, high), random.range(low, high)) * size
    };
    // Every third from corner to corner.
    let mut way: Vec<DVec2> = (0..6).map(|_| place(&mut random, 0.05, 0.95)).collect();
    if seed.is_multiple_of(3) {
        let corner = |share: f64| south_west + DVec2::splat(share * size);
        way = vec![corner(0.03), place(&mut random, 0.3, 0.7), corner(0.97)];
    }
    let low = place(&mut random, 0.3, 0.6);
    let square = [low, low + size * random.range(0.08, 0.2)];
    let [l, h] = square;
    let ring = vec![l, DVec2::new(h.x, l.y), h, DVec2::new(l.x, h.y)];
    let area = LayerKind::Area(AreaLayer {
        features: vec![AreaFeature { style: None, name: "field".into(), rings: vec![ring] }],
        fill: Color::rgb(0, 0, 0),
        outline: None,
        width_px: 1.0,
        surface: AreaSurface::Plain,
        hidden: Hidden::Cut,
        lift_m: LIFT_M,
        label_px: None,
        beyond: 0.0,
    });
    let summit = place(&mut random, 0.2, 0.8);
    let on = |xy: DVec2| xy.extend(hf.surface_at(xy).unwrap());
    let eye =
        on(south_west + DVec2::new(random.range(0.1, 0.9), 0.02) * size) + DVec3::Z * relief * random.range(0.1, 0.5);
    let target = on(place(&mut random, 0.4, 0.6));
    let lens = Projection::Perspective { fov_y: random.range(0.6, 0.9) };
    let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, image, 1.0, None).unwrap();
    let layers = vec![
        line_layer("way", way.iter().map(|p| on(*p)).collect()),
        Layer { id: "field".into(), must_see: true, kind: area },
        point_layer("summit", on(summit)),
        terrain_layer(hf),
    ];
    Case { scene: Scene { layers, ..Scene::default() }, spacing, way, square, base: View::straight(pinhole) }
}

/// Ground as it is drawn and written, flat between displaced nodes, and as it is traced, displaced everywhere: one surface.
struct Ground<'a> {
    still: Vec<f64>,
    moved: Vec<f64>,
    spacing: f64,
    north_west: DVec2,
    nodes: usize,
    view: &'a View,
}

impl Ground<'_> {
    /// Height of flat triangles between nodes, split from north-west to south-east; row 0 is the northern one.
    fn flat(&self, heights: &[f64], p: DVec2) -> Option<f64> {
        let last = (self.nodes - 1) as f64;
        let g = DVec2::new(p.x - self.north_west.x, self.north_west.y - p.y) / self.spacing;
        if g.min_element() < 0.0 || g.max_element() > last {
            return None;
        }
        let corner = g.floor().min(DVec2::splat(last - 1.0));
        let (f, k) = (g - corner, corner.y as usize * self.nodes + corner.x as usize);
        let [nw, ne, sw, se] = [0, 1, self.nodes, self.nodes + 1].map(|d| heights[k + d]);
        Some(if f.x >= f.y { nw + (ne - nw) * f.x + (se - ne) * f.y } else { nw + (sw - nw) * f.y + (se - sw) * f.x })
    }

    fn height(&self, p: DVec2, traced: bool) -> Option<f64> {
        if !traced {
            return self.flat(&self.moved, p);
        }
        let still = self.flat(&self.still, p)?;
        Some(self.view.displace(p.extend(still)).ok()?.point.z)
    }

    /// Whether the picture shows the position and no ground rises over its line of sight; `None` beside the picture.
    fn seen(&self, xy: DVec2) -> Option<bool> {
        let pinhole = self.view.pinhole();
        let shown = self.view.project(xy.extend(self.flat(&self.still, xy)? + LIFT_M)).ok()?;
        if shown.depth < pinhole.near || !pinhole.contains(shown.pixel) {
            return None;
        }
        let clear = |traced: bool| {
            let p = xy.extend(self.height(xy, traced).unwrap_or(f64::NAN) + LIFT_M);
            let to = p - pinhole.eye;
            let free = |t: f64| {
                let q = p - to * t;
                self.height(q.truncate(), traced).is_none_or(|ground| ground <= q.z + 1e-6)
            };
            // Flat ground rises most over a line where that crosses an edge.
            let from = p.truncate() - self.north_west;
            let (from, along) = (from.extend(from.x + from.y), -DVec3::new(to.x, to.y, to.x + to.y));
            let crossings = [0, 1, 2].into_iter().flat_map(|k| {
                let [from, along] = [from, along].map(|v| v[k] / self.spacing);
                let [low, high] = [from.min(from + along).ceil() as i64, from.max(from + along).floor() as i64];
                (low..=high).map(move |line| (line as f64 - from) / along)
            });
            let mut crossings = crossings.filter(|t| *t > 0.0 && *t < 1.0);
            let steps = if traced { (to.truncate().length() / self.spacing * 25.0).ceil() as usize } else { 1 };
            crossings.all(free) && (1..steps).all(|i| free(i as f64 / steps as f64))
        };
        Some(clear(false) && (!self.view.is_bent() || clear(true)))
    }

    /// Visible share of what the positions stand for.
    fn share(&self, places: Vec<(DVec2, f64)>) -> Option<f64> {
        let shown: Vec<(bool, f64)> =
            places.into_par_iter().filter_map(|(xy, amount)| Some((self.seen(xy)?, amount))).collect();
        let [seen, all] =
            shown.iter().fold([0.0; 2], |[s, a], (seen, amount)| [s + if *seen { *amount } else { 0.0 }, a + amount]);
        (all > 0.0).then(|| seen / all)
    }
}

/// Least visible share of path, area and summit by the march.
fn marched(case: &Case, view: &View) -> f64 {
    let hf = case.scene.terrain().unwrap();
    let nodes = hf.cols();
    let node = |i: usize| hf.node(i % nodes, i / nodes).unwrap();
    let heights = |of: &dyn Fn(DVec3) -> DVec3| (0..nodes * nodes).map(|i| of(node(i)).z).collect::<Vec<f64>>();
    let ground = Ground {
        still: heights(&|p| p),
        moved: heights(&|p| view.displace(p).unwrap().point),
        spacing: case.spacing,
        north_west: hf.node_xy(0, 0),
        nodes,
        view,
    };
    let along = case.way.windows(2).flat_map(|leg| {
        let (from, step) = (leg[0], leg[1] - leg[0]);
        let parts = (step.length() / case.spacing * 23.0).ceil();
        (0..parts as usize).map(move |i| (from + step * ((i as f64 + 0.5) / parts), step.length() / parts))
    });
    let [low, high] = case.square;
    // Halton's points.
    let digits = |i: usize, base: usize| {
        let (mut i, mut place, mut sum) = (i, 1.0 / base as f64, 0.0);
        while i > 0 {
            (sum, i, place) = (sum + (i % base) as f64 * place, i / base, place / base as f64);
        }
        sum
    };
    let inside = (1..2500).map(|i| (low + DVec2::new(digits(i, 2), digits(i, 3)) * (high - low), 1.0));
    let Some(points) = case.scene.layers[2].kind.points() else { unreachable!("the third layer is the summit") };
    let summit = points.features.iter().map(|f| (f.position.truncate(), 1.0));
    let shares = [ground.share(along.collect()), ground.share(inside.collect()), ground.share(summit.collect())];
    shares.into_iter().flatten().fold(1.0, f64::min)
}

/// Least share of lines, areas and points by line of sight and by depth buffer.
fn measured(measures: &Measures, of: fn(&FeatureMeasure) -> &Visibility) -> [f64; 2] {
    let kinds = [&measures.lines, &measures.areas, &measures.points];
    let least = |share: &dyn Fn(&Visibility) -> Option<f64>| {
        kinds.into_iter().flatten().filter_map(|kind| share(of(kind))).fold(1.0, f64::min)
    };
    [least(&|v| v.sight.share), least(&|v| v.buffer.and_then(|b| b.share))]
}

/// One case: what the report says before and after, and what three other methods do.
pub(crate) struct Compared {
    pub(crate) report: TerrainReport,
    pub(crate) view: View,
    /// The report, lines of sight, depth buffers, rays.
    pub(crate) shares: [[f64; 4]; 2],
}

pub(crate) fn compared(case: &Case, settings: TerrainSettings) -> Compared {
    let solver = TerrainSolver::new(settings).unwrap();
    let solved = solver.solve(&case.scene, &case.base, &mut TerrainMemory::default(), &Progress::silent()).unwrap();
    let stages = vec![Stage::TerrainDisocclusion(solved.stage)];
    let view = View::new(case.base.pinhole().clone(), stages).unwrap();
    let (renderer, options) = (CpuRenderer::default(), MeasureOptions::default());
    let measures = measure(&case.scene, &view, Some(&renderer), &options, &Progress::silent()).unwrap();
    let report = solved.report;
    let row = |said: f64, [sight, buffer]: [f64; 2], rays: f64| [said, sight, buffer, rays];
    let shares = [
        row(report.visible_dense_before, measured(&measures, |m| &m.straight), marched(case, &case.base)),
        row(report.metrics.visible_dense, measured(&measures, |m| &m.bent), marched(case, &view)),
    ];
    Compared { report, view, shares }
}

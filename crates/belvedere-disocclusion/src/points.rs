//! Points that stand for the features that must be seen.

use super::{Field, TerrainSettings};
use belvedere_core::DVec2;
use belvedere_core::polygon::{self, doubled_area, is_inside};
use belvedere_scene::{AreaFeature, Layer, LayerKind, LineFeature, Scene};

/// Points along one line or rim, and inside one area, at most; a longer feature gets wider spacing.
const MOST_POINTS: f64 = 50_000.0;

/// What part of a feature a reference point stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PointKind {
    /// On a line.
    Line,
    /// On the rim of an area.
    Rim,
    /// Inside an area.
    Inside,
    /// A point feature.
    Landmark,
}

/// A point that must be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferencePoint {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Length in plan along the line, or along the rings of the area one after the other, scene units; 0 elsewhere.
    pub along_m: f64,
    /// Grid coordinates.
    pub grid: DVec2,
    /// Height of the drawn surface there, scene units.
    pub ground: f64,
    /// Height over the ground at which it must be seen, scene units.
    pub lift: f64,
    /// Part of the feature that it stands for.
    pub kind: PointKind,
    /// Length of line, area, or number of point features that it stands for, scene units; all in plan.
    pub amount: f64,
}

/// Where shares are judged, about this many points lie on all lines together at least, unless their spacing would be less than
/// `FINEST` grid cells.
const LEAST_ON_LINES: f64 = 4000.0;
const FINEST: f64 = 0.002;

/// Why a point cannot be a reference point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum UnusableReason {
    /// Beside the terrain.
    OutsideDem,
    /// Where the terrain holds no data.
    NoData,
}

/// A point of a feature that cannot be a reference point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unusable {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// As in [`ReferencePoint::along_m`].
    pub along_m: f64,
    /// Grid coordinates.
    pub grid: DVec2,
    /// Part of the feature that it would have stood for.
    pub kind: PointKind,
    /// Why it cannot be used.
    pub reason: UnusableReason,
    /// What it stands for, see [`ReferencePoint::amount`].
    pub amount: f64,
}

/// Reference points of every feature of the layers that must be seen, in the order of layers and features, along each.
///
/// * Lines: equal arc length in plan, both ends included, `spacing` cells at most; a line of one point is that point.
/// * Areas: each ring likewise, and a square lattice of 4 x `spacing` inside (even-odd rule).
/// * Points: themselves.
///
/// Lengths in cells are measured in grid coordinates. `spacing` is `settings.spacing` for the points that stand for the
/// features.
pub fn reference_points(
    scene: &Scene,
    field: &Field,
    settings: &TerrainSettings,
    spacing: f64,
) -> (Vec<ReferencePoint>, Vec<Unusable>) {
    collect_points(PointCollector::new(field, false), &required_features(scene), settings, spacing)
}

/// As [`reference_points`], of features.
pub(super) fn reference_points_of(
    features: &[RequiredFeature],
    field: &Field,
    settings: &TerrainSettings,
) -> Vec<ReferencePoint> {
    collect_points(PointCollector::new(field, false), features, settings, settings.spacing).0
}

/// Candidate points of the quadratic program: as [`reference_points`] `settings.candidates` apart, but each on the nearest bend of
/// the drawn line that is no farther than half of that: a corner of the line, or an edge of the ground's mesh. Between two bends line
/// and ground are straight, so a line is hidden first at a bend.
pub(super) fn candidate_points(scene: &Scene, field: &Field, settings: &TerrainSettings) -> Vec<ReferencePoint> {
    collect_points(PointCollector::new(field, true), &required_features(scene), settings, settings.candidates).0
}

/// Points by which a result is judged: as [`reference_points`] `spacing` apart, but scattered evenly inside areas. Further points
/// stand for no length or area: they lie on the edges of the ground's triangles inside areas, and wherever lines and rims cross these
/// edges. On a flat triangle a straight piece of a feature is hidden first at one of its ends, and an area first at the rim of the
/// triangle or of the area. So if no edge is hidden, nothing between the edges is.
///
/// Returns also what lies beside the ground or in its holes: lengths, areas and numbers, see [`ReferencePoint::amount`].
pub(super) fn judged_points(
    features: &[RequiredFeature],
    field: &Field,
    settings: &TerrainSettings,
    spacing: f64,
) -> (Vec<ReferencePoint>, [f64; KINDS]) {
    let out = PointCollector { edges: true, ..PointCollector::new(field, false) };
    let (points, unusable) = collect_points(out, features, settings, spacing);
    let mut beside = [0.0; KINDS];
    unusable.iter().for_each(|point| beside[point.kind.of_feature()] += point.amount);
    for required in features {
        if let Shape::Beyond(kind, amount) = required.shape {
            beside[kind.of_feature()] += amount;
        }
    }
    (points, beside)
}

/// Number of kinds of features: lines, areas and points, whose shares are never added up.
pub(super) const KINDS: usize = 3;

impl PointKind {
    /// Index of the kind of feature.
    pub(super) fn of_feature(self) -> usize {
        match self {
            Self::Line => 0,
            Self::Rim | Self::Inside => 1,
            Self::Landmark => 2,
        }
    }
}

/// A feature that must be seen, with all that its points depend on besides the ground and the parameters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RequiredFeature {
    layer: usize,
    feature: usize,
    lift_m: f64,
    shape: Shape,
}

/// Scene x, y.
#[derive(Debug, Clone, PartialEq)]
enum Shape {
    Line(Vec<DVec2>),
    Area(Vec<Vec<DVec2>>),
    Point(DVec2),
    /// What of a layer's source lies beyond the ground: an amount, see [`ReferencePoint::amount`].
    Beyond(PointKind, f64),
}

/// The features of all layers that must be seen. Corners that are not finite are left out.
pub(super) fn required_features(scene: &Scene) -> Vec<RequiredFeature> {
    let finite = |points: &mut dyn Iterator<Item = DVec2>| points.filter(|p| p.is_finite()).collect::<Vec<_>>();
    let of_layer = |(layer, content): (usize, &Layer)| {
        let (lift_m, shapes): (f64, Vec<Shape>) = match &content.kind {
            LayerKind::Line(l) => {
                let line = |f: &LineFeature| Shape::Line(finite(&mut f.points.iter().map(|p| p.truncate())));
                (l.lift_m, l.features.iter().map(line).collect())
            }
            LayerKind::Area(a) => {
                let ring = |r: &Vec<DVec2>| finite(&mut r.iter().copied());
                let area = |f: &AreaFeature| Shape::Area(f.rings.iter().map(ring).collect());
                (a.lift_m, a.features.iter().map(area).collect())
            }
            LayerKind::Point(p) => (p.lift_m, p.features.iter().map(|f| Shape::Point(f.position.truncate())).collect()),
            LayerKind::Terrain(_)
            | LayerKind::Boxes(_)
            | LayerKind::Mesh(_)
            | LayerKind::Own(_)
            | LayerKind::Molecule(_)
            | LayerKind::Volume(_) => (0.0, Vec::new()),
        };
        let kind = match &content.kind {
            LayerKind::Area(_) => PointKind::Inside,
            LayerKind::Point(_) => PointKind::Landmark,
            _ => PointKind::Line,
        };
        let beyond = Some(content.kind.beyond()).filter(|amount| *amount > 0.0);
        let shapes = shapes.into_iter().chain(beyond.map(|amount| Shape::Beyond(kind, amount)));
        shapes.enumerate().map(move |(feature, shape)| RequiredFeature { layer, feature, lift_m, shape })
    };
    scene.must_see().flat_map(of_layer).collect()
}

impl RequiredFeature {
    /// The feature in other coordinates.
    ///
    /// * `line`: the image of a chain of positions.
    pub(super) fn mapped(&self, line: &dyn Fn(&[DVec2]) -> Vec<DVec2>) -> Self {
        let ring = |ring: &Vec<DVec2>| {
            let end = ring.first().filter(|first| ring.last() != Some(first));
            line(&ring.iter().chain(end).copied().collect::<Vec<_>>())
        };
        let shape = match &self.shape {
            Shape::Line(points) => Shape::Line(line(points)),
            Shape::Area(rings) => Shape::Area(rings.iter().map(ring).collect()),
            Shape::Beyond(..) => self.shape.clone(),
            Shape::Point(p) => line(&[*p]).first().map_or(Shape::Line(Vec::new()), |p| Shape::Point(*p)),
        };
        Self { shape, ..self.clone() }
    }
}

fn collect_points(
    mut out: PointCollector<'_>,
    features: &[RequiredFeature],
    settings: &TerrainSettings,
    spacing: f64,
) -> (Vec<ReferencePoint>, Vec<Unusable>) {
    let field = out.field;
    let to_grid = |points: &Vec<DVec2>| points.iter().map(|p| field.grid_from_scene(*p)).collect::<Vec<_>>();
    // Shares of short lines are to be as fine as those of long ones.
    let length = |f: &RequiredFeature| match &f.shape {
        Shape::Line(points) => to_grid(points).windows(2).map(|w| w[0].distance(w[1])).sum(),
        Shape::Area(_) | Shape::Point(_) | Shape::Beyond(..) => 0.0,
    };
    let lines: f64 = if out.edges { features.iter().map(length).sum() } else { f64::INFINITY };
    let along_lines = spacing.min((lines / LEAST_ON_LINES).max(FINEST));
    out.areas = features.iter().filter(|required| matches!(required.shape, Shape::Area(_))).count();
    for required in features {
        (out.layer, out.feature) = (required.layer, required.feature);
        out.lift = settings.lift_m.unwrap_or(required.lift_m);
        match &required.shape {
            Shape::Line(points) => {
                out.along(&to_grid(points), along_lines, 0.0, PointKind::Line);
            }
            Shape::Area(rings) => out.area(&rings.iter().map(to_grid).collect::<Vec<_>>(), spacing),
            Shape::Point(p) => {
                out.amount = 1.0;
                out.put(field.grid_from_scene(*p), 0.0, PointKind::Landmark);
            }
            Shape::Beyond(..) => {}
        }
    }
    (out.usable, out.unusable)
}

/// Collects the points of features.
struct PointCollector<'a> {
    field: &'a Field,
    /// Whether points along paths move to bends.
    bends: bool,
    /// Whether areas have points on the edges of triangles in place of a lattice.
    edges: bool,
    layer: usize,
    feature: usize,
    lift: f64,
    /// See [`ReferencePoint::amount`].
    amount: f64,
    /// Number of areas, which share the number of points inside.
    areas: usize,
    usable: Vec<ReferencePoint>,
    unusable: Vec<Unusable>,
}

impl<'a> PointCollector<'a> {
    fn new(field: &'a Field, bends: bool) -> Self {
        let (usable, unusable) = (Vec::new(), Vec::new());
        Self { field, bends, edges: false, layer: 0, feature: 0, lift: 0.0, amount: 1.0, areas: 1, usable, unusable }
    }

    fn put(&mut self, grid: DVec2, along_m: f64, kind: PointKind) {
        let (layer, feature) = (self.layer, self.feature);
        match self.field.surface_at(grid) {
            Some(ground) => {
                let (lift, amount) = (self.lift, self.amount);
                self.usable.push(ReferencePoint { layer, feature, along_m, grid, ground, lift, kind, amount });
            }
            None => {
                let reason =
                    if self.field.contains(grid) { UnusableReason::NoData } else { UnusableReason::OutsideDem };
                let amount = self.amount;
                self.unusable.push(Unusable { layer, feature, along_m, grid, kind, reason, amount });
            }
        }
    }

    /// Points along a path, which starts at `start_m`; returns where it ends. A closed path has its first point once.
    fn along(&mut self, path: &[DVec2], spacing: f64, start_m: f64, kind: PointKind) -> f64 {
        let Some(&first) = path.first() else { return start_m };
        let cells: f64 = path.windows(2).map(|w| (w[1] - w[0]).length()).sum();
        let parts = (cells / spacing).ceil().clamp(0.0, MOST_POINTS) as usize;
        let closed = path.len() > 2 && path.last() == Some(&first);
        let spacing_m = self.field.spacing();
        let first_of_path = self.usable.len();
        if kind == PointKind::Line {
            let length_m: f64 = path.windows(2).map(|w| ((w[1] - w[0]) * spacing_m).length()).sum();
            self.amount = length_m / (parts.max(1) + usize::from(!closed)) as f64;
        }
        self.put(first, start_m, kind);
        let (mut placed, mut before, mut before_m) = (1, 0.0, start_m);
        for pair in path.windows(2) {
            let step = pair[1] - pair[0];
            let (length, length_m) = (step.length(), (step * spacing_m).length());
            while placed < parts {
                let share = (cells * placed as f64 / parts as f64 - before) / length;
                if share.is_nan() || share > 1.0 {
                    break;
                }
                let share = share.max(0.0);
                let reach = 0.5 * cells / (parts as f64 * length);
                let share = if self.bends { nearest_bend(pair[0], step, share, reach) } else { share };
                self.put(pair[0] + share * step, before_m + share * length_m, kind);
                placed += 1;
            }
            before += length;
            before_m += length_m;
        }
        if !closed && parts > 0 {
            self.put(path[path.len() - 1], before_m, kind);
        }
        if self.edges {
            self.on_bends(path, start_m, kind);
            self.usable[first_of_path..].sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
        }
        before_m
    }

    /// Points wherever a path crosses the mesh, which stand for no length.
    fn on_bends(&mut self, path: &[DVec2], start_m: f64, kind: PointKind) {
        let amount = std::mem::replace(&mut self.amount, 0.0);
        let (spacing_m, mut before_m) = (self.field.spacing(), start_m);
        for pair in path.windows(2) {
            let step = pair[1] - pair[0];
            let length_m = (step * spacing_m).length();
            let shares = mesh_crossings(pair[0], step);
            // A path far beyond the terrain crosses no mesh there.
            let shares = shares.filter(|share| self.field.contains(pair[0] + *share * step)).collect::<Vec<_>>();
            for share in shares {
                self.put(pair[0] + share * step, before_m + share * length_m, kind);
            }
            self.put(pair[1], before_m + length_m, kind);
            before_m += length_m;
        }
        self.amount = amount;
    }

    /// Equal parts of an area have equally many points inside; if none lies inside, points on its rims stand for it.
    fn area(&mut self, rings: &[Vec<DVec2>], spacing: f64) {
        let first = self.usable.len();
        self.amount = 0.0;
        self.on_rims(rings, spacing);
        let rims = self.usable.len();
        let beside = self.unusable.len();
        self.inside(rings, spacing);
        if self.usable.len() == rims && self.unusable.len() == beside {
            let enclosed =
                self.field.spacing().element_product() * rings.iter().map(|r| 0.5 * doubled_area(r).abs()).sum::<f64>();
            let each = enclosed / (rims - first).max(1) as f64;
            self.usable[first..].iter_mut().for_each(|p| p.amount = each);
        }
    }

    fn on_rims(&mut self, rings: &[Vec<DVec2>], spacing: f64) {
        let mut start_m = 0.0;
        for ring in rings {
            let mut closed = ring.clone();
            if closed.last() != ring.first() {
                closed.extend(ring.first());
            }
            start_m = self.along(&closed, spacing, start_m, PointKind::Rim);
        }
    }

    fn inside(&mut self, rings: &[Vec<DVec2>], spacing: f64) {
        let corners = rings.iter().flatten();
        let [low, high] = corners.fold([DVec2::MAX, DVec2::MIN], |[lo, hi], &p| [lo.min(p), hi.max(p)]);
        let extent = high - low;
        if !(extent.x > 0.0 && extent.y > 0.0) {
            return;
        }
        let last = DVec2::new((self.field.cols() - 1) as f64, (self.field.rows() - 1) as f64);
        if self.edges {
            self.amount = 0.0;
            self.on_edges(rings, [low, high]);
            return self.scattered(rings, [low, extent]);
        }
        let step = (4.0 * spacing).max((extent.x * extent.y / MOST_POINTS).sqrt());
        let count = (extent / step).ceil();
        self.amount = step * step * self.field.spacing().element_product();
        let origin = low + 0.5 * (extent - (count - 1.0) * step);
        let (from, to) = (((-origin) / step).ceil().max(DVec2::ZERO), ((last - origin) / step).floor() + 1.0);
        let to = to.min(count);
        for row in from.y as usize..to.y.max(0.0) as usize {
            for col in from.x as usize..to.x.max(0.0) as usize {
                let p = origin + step * DVec2::new(col as f64, row as f64);
                if is_inside(rings, p) {
                    self.put(p, 0.0, PointKind::Inside);
                }
            }
        }
    }
}

/// Where shares are judged, number of points in the box of an area: 16 per grid cell, within bounds for all areas together, at most
/// `MOST_INSIDE` and at least `FEWEST_INSIDE` for one of them.
const INSIDE_A_CELL: f64 = 16.0;
const INSIDE_ALL: [f64; 2] = [16_000.0, 60_000.0];
const MOST_INSIDE: f64 = 16_000.0;
const FEWEST_INSIDE: f64 = 100.0;
/// Fractional part of the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Points on the edges of triangles inside one area, at most about.
const MOST_ON_EDGES: f64 = 800_000.0;

impl PointCollector<'_> {
    /// Points inside the rings that stand for equal areas, in rows of one point each (a Fibonacci lattice): shadows begin along straight lines,
    /// which a square lattice would meet with whole rows.
    fn scattered(&mut self, rings: &[Vec<DVec2>], [low, extent]: [DVec2; 2]) {
        let [least, most] = INSIDE_ALL.map(|all| (all / self.areas.max(1) as f64).clamp(FEWEST_INSIDE, MOST_INSIDE));
        let count = (INSIDE_A_CELL * extent.element_product()).clamp(least, most).floor();
        self.amount = extent.element_product() * self.field.spacing().element_product() / count;
        for i in 0..count as usize {
            let p = low + extent * DVec2::new((i as f64 * GOLDEN).fract(), (i as f64 + 0.5) / count);
            if is_inside(rings, p) {
                self.put(p, 0.0, PointKind::Inside);
            }
        }
    }

    /// Points on the edges of the ground's triangles in a box that lie inside the rings, which stand for no area: each grid cell has
    /// those of its node, and of its upper, left and diagonal edge.
    fn on_edges(&mut self, rings: &[Vec<DVec2>], [low, high]: [DVec2; 2]) {
        let last = DVec2::new((self.field.cols() - 1) as f64, (self.field.rows() - 1) as f64);
        let (low, high) = (low.floor().max(DVec2::ZERO), high.ceil().min(last));
        let cells = (high - low).max(DVec2::ZERO).element_product();
        // Points a fifth of a grid cell apart leave no gap of visible size; on huge areas halves of edges, then nodes alone, have to
        // suffice.
        let points = |parts: usize| (3 * parts - 2) as f64 * cells;
        let parts = [5, 2].into_iter().find(|&parts| points(parts) <= MOST_ON_EDGES).unwrap_or(1);
        let every = (points(parts) / MOST_ON_EDGES).sqrt().ceil().max(1.0);
        let mut crossings = Vec::new();
        let mut row = low.y;
        while row <= high.y {
            for part in 0..parts {
                let down = part as f64 / parts as f64;
                let y = row + down;
                crossings.clear();
                crossings.extend(rings.iter().flat_map(|ring| polygon::crossings(ring, y)));
                crossings.sort_by(f64::total_cmp);
                let across: &[usize] = if part == 0 { &[0, 1, 2, 3, 4][..parts] } else { &[0, part] };
                for pair in crossings.chunks_exact(2) {
                    let mut col = (pair[0].max(low.x) / every).floor() * every;
                    while col <= pair[1].min(high.x) {
                        let xs = across.iter().map(|k| col + *k as f64 / parts as f64);
                        let within = xs.filter(|x| *x > pair[0] && *x <= pair[1] && *x <= last.x && y <= last.y);
                        for x in within.collect::<Vec<_>>() {
                            self.put(DVec2::new(x, y), 0.0, PointKind::Inside);
                        }
                        col += every;
                    }
                }
            }
            row += every;
        }
    }
}

/// Parameters (0..1) at which a straight segment crosses the mesh, at most [`MOST_POINTS`] of each family of its lines.
pub(super) fn mesh_crossings(from: DVec2, step: DVec2) -> impl Iterator<Item = f64> {
    let lines = [(from.x, step.x), (from.y, step.y), (from.x - from.y, step.x - step.y)];
    lines.into_iter().flat_map(|(from, step)| {
        let (low, high) = (from.min(from + step).floor() + 1.0, from.max(from + step).ceil());
        let count = (high - low).clamp(0.0, MOST_POINTS) as usize;
        (0..count).map(move |i| (low + i as f64 - from) / step)
    })
}

/// Parameter nearest to `share`, by less than `reach`, at which a straight segment ends or crosses the mesh; `share` if there is none.
fn nearest_bend(from: DVec2, step: DVec2, share: f64, reach: f64) -> f64 {
    let at = from + share * step;
    let lines = [(from.x, step.x, at.x), (from.y, step.y, at.y), (from.x - from.y, step.x - step.y, at.x - at.y)];
    let crossings = lines.into_iter().map(|(from, step, at)| (at.round() - from) / step);
    let bends = crossings.chain([0.0, 1.0]).filter(|b| (0.0..=1.0).contains(b) && (b - share).abs() < reach);
    bends.min_by(|a, b| (a - share).abs().total_cmp(&(b - share).abs())).unwrap_or(share)
}

#[cfg(test)]
mod tests;

//! The soft edge of the data: ground fades into what stands behind everything, by its distance from where the data end.
//!
//! Every sample is faded by its own place, so that pixels whose samples see the rim and the sky are mixed of faded colours.

use crate::raster::band::SKY;
use crate::shade::{LayerShade, Painted, Sample, Samples, Shader, pixel_of};
use belvedere_composite::color::{Rgb, smoothstep};
use belvedere_core::DVec2;
use belvedere_scene::{Edge, Heightfield, LayerKind, NodeState, RenderJob, TerrainLayer};

/// Width of the edge as a share of the shorter side of the data.
const SHARE: f64 = 0.05;
/// Voids are a sea where this share of their shore lies within this share of the range of heights above the lowest.
const LOW_SHORE: f64 = 0.9;
const COAST: f64 = 0.15;
/// Distance from what must be seen at which ground fades as elsewhere, widths of the edge; up to half of it nothing fades.
const KEPT: f32 = 0.8;
/// Most cells along a side of the map of distances.
const CELLS: usize = 384;

/// Distances from where the data end: from their rim, and from voids that reach it; holes within are holes.
pub(crate) struct Border {
    cols: usize,
    rows: usize,
    /// Distances of the cells, widths of the edge.
    distance: Vec<f32>,
    /// Least opacity of the cells: ground under and in front of what must be seen does not fade.
    kept: Vec<f32>,
    /// Cells per scene unit, and the north-western corner.
    per_unit: DVec2,
    north_west: DVec2,
    /// Width of the edge, scene units.
    width: f64,
}

impl Border {
    /// The border of a ground that fades; `None` for other edges.
    pub(super) fn of(layer: &TerrainLayer, job: &RenderJob<'_>) -> Option<Self> {
        (layer.edge == Edge::Soft).then(|| {
            let mut border = Self::new(&layer.heightfield);
            let eye = job.view.pinhole().eye.truncate();
            job.scene.must_see().for_each(|(_, layer)| each_place(&layer.kind, &mut |place| border.keep(place, eye)));
            border.widen_kept();
            border
        })
    }

    /// Keeps the cells from a place near the rim towards the eye.
    fn keep(&mut self, place: DVec2, eye: DVec2) {
        let cell = |xy: DVec2| {
            let at = DVec2::new(xy.x - self.north_west.x, self.north_west.y - xy.y) * self.per_unit;
            let inside = at.cmpge(DVec2::ZERO).all() && at.x < self.cols as f64 && at.y < self.rows as f64;
            inside.then(|| at.y as usize * self.cols + at.x as usize)
        };
        let step = (eye - place).normalize_or_zero() / self.per_unit.max_element();
        let (mut at, mut cells) = (place, Vec::new());
        // Towards the eye, as far as the ground fades.
        while let Some(i) = cell(at).filter(|i| self.distance[*i] < 1.0 + KEPT) {
            cells.push(i);
            at += step;
            if cells.len() > self.cols + self.rows || step == DVec2::ZERO || (eye - at).dot(step) < 0.0 {
                break;
            }
        }
        cells.into_iter().for_each(|i| self.kept[i] = 1.0);
    }

    /// Lets what is kept pass into what fades.
    fn widen_kept(&mut self) {
        if self.kept.iter().all(|kept| *kept == 0.0) {
            return;
        }
        let kept: Vec<bool> = self.kept.iter().map(|kept| *kept > 0.0).collect();
        let far = spread(
            kept.iter().map(|kept| if *kept { 0.0 } else { f64::INFINITY }).collect(),
            [self.cols, self.rows],
            1.0 / self.per_unit,
        );
        self.kept = far.into_iter().map(|d| 1.0 - smoothstep(0.5 * KEPT, KEPT, (d / self.width) as f32)).collect();
    }

    fn new(ground: &Heightfield) -> Self {
        let [cols, rows] = [ground.cols(), ground.rows()].map(|n| (n - 1).clamp(1, CELLS));
        let bounds = ground.bounds();
        let size = (bounds.max - bounds.min).truncate();
        let cell = size / DVec2::new(cols as f64, rows as f64);
        let outside = outside(ground, [cols, rows]);
        let width = SHARE * size.min_element();
        let distance = distances(&outside, [cols, rows], cell).into_iter().map(|d| (d / width) as f32).collect();
        let north_west = DVec2::new(bounds.min.x, bounds.max.y);
        Self { cols, rows, distance, kept: vec![0.0; cols * rows], width, per_unit: 1.0 / cell, north_west }
    }

    /// Opacity of the ground at a place, 0..=1.
    fn opacity(&self, xy: DVec2) -> f32 {
        let at = DVec2::new(xy.x - self.north_west.x, self.north_west.y - xy.y) * self.per_unit;
        let rim = at.min(DVec2::new(self.cols as f64, self.rows as f64) - at).min_element();
        if !(rim > 0.0) {
            return 0.0;
        }
        // Between the middles of the cells.
        let at = (at - 0.5).clamp(DVec2::ZERO, DVec2::new(self.cols as f64 - 1.0, self.rows as f64 - 1.0));
        let (c, r) = (at.x as usize, at.y as usize);
        let (c1, r1) = ((c + 1).min(self.cols - 1), (r + 1).min(self.rows - 1));
        let (u, v) = ((at.x - c as f64) as f32, (at.y - r as f64) as f32);
        let between = |values: &[f32]| {
            let of = |c: usize, r: usize| values[r * self.cols + c];
            let (north, south) = (of(c, r) + u * (of(c1, r) - of(c, r)), of(c, r1) + u * (of(c1, r1) - of(c, r1)));
            north + v * (south - north)
        };
        // The outermost half cell lies beyond the middles: down to 0 at the very rim.
        smoothstep(0.0, 1.0, between(&self.distance) * (2.0 * rim as f32).min(1.0)).max(between(&self.kept))
    }
}

/// Cells without data that reach the rim, but for seas: land does not fade at its coast.
fn outside(ground: &Heightfield, [cols, rows]: [usize; 2]) -> Vec<bool> {
    let node = |i: usize, n: usize, all: usize| ((2 * i + 1) * (n - 1) / (2 * all)).min(n - 1);
    let node = |at: usize| node(at / cols, ground.rows(), rows) * ground.cols() + node(at % cols, ground.cols(), cols);
    let is_void = |at: usize| ground.states().get(node(at)) == Some(&NodeState::Void);
    let height = |at: usize| ground.heights().get(node(at)).map_or(f64::NAN, |h| f64::from(*h));
    let [low, high] = [ground.bounds().min.z, ground.bounds().max.z];
    let coast_m = low + COAST * (high - low);
    let (mut seen, mut found) = (vec![false; cols * rows], vec![false; cols * rows]);
    let rim = (0..cols)
        .flat_map(|c| [c, (rows - 1) * cols + c])
        .chain((0..rows).flat_map(|r| [r * cols, (r + 1) * cols - 1]));
    for start in rim {
        let (mut open, mut void, mut shore, mut at_coast) = (vec![start], Vec::new(), 0usize, 0usize);
        while let Some(at) = open.pop() {
            if seen[at] {
                continue;
            }
            if !is_void(at) {
                // The same cell of the shore may be met from several sides.
                shore += 1;
                at_coast += usize::from(height(at) < coast_m);
                continue;
            }
            seen[at] = true;
            void.push(at);
            let (c, r) = (at % cols, at / cols);
            open.extend([(c > 0).then(|| at - 1), (c + 1 < cols).then_some(at + 1)].into_iter().flatten());
            open.extend([(r > 0).then(|| at - cols), (r + 1 < rows).then_some(at + cols)].into_iter().flatten());
        }
        if (at_coast as f64) < LOW_SHORE * shore as f64 {
            void.into_iter().for_each(|at| found[at] = true);
        }
    }
    found
}

/// Places of what a layer holds on the map.
fn each_place(kind: &LayerKind, take: &mut dyn FnMut(DVec2)) {
    kind.lines().iter().flat_map(|l| &l.features).flat_map(|f| &f.points).for_each(|p| take(p.truncate()));
    kind.points().iter().flat_map(|l| &l.features).for_each(|f| take(f.position.truncate()));
    kind.areas().iter().flat_map(|l| &l.features).flat_map(|f| f.rings.iter().flatten()).for_each(|p| take(*p));
}

/// Distances of the middles of cells from the nearest cell outside, or from the rim, scene units (a chamfer of two passes).
fn distances(outside: &[bool], [cols, rows]: [usize; 2], cell: DVec2) -> Vec<f64> {
    let [dx, dy] = cell.to_array();
    let rim = |c: usize, r: usize| {
        let x = (c.min(cols - 1 - c) as f64 + 0.5) * dx;
        x.min((r.min(rows - 1 - r) as f64 + 0.5) * dy)
    };
    spread(
        (0..cols * rows).map(|i| if outside[i] { 0.0 } else { rim(i % cols, i / cols) }).collect(),
        [cols, rows],
        cell,
    )
}

/// Distances that do not exceed those of the cells around by more than the way there.
fn spread(mut distance: Vec<f64>, [cols, rows]: [usize; 2], cell: DVec2) -> Vec<f64> {
    let [dx, dy, both] = [cell.x, cell.y, cell.length()];
    for back in [false, true] {
        for k in 0..cols * rows {
            let i = if back { cols * rows - 1 - k } else { k };
            let (c, r) = ((i % cols) as i64, (i / cols) as i64);
            let sign = if back { 1 } else { -1 };
            let nearest = [(sign, 0, dx), (0, sign, dy), (sign, sign, both), (-sign, sign, both)].map(|(x, y, way)| {
                let (c, r) = (c + x, r + y);
                let inside = c >= 0 && r >= 0 && c < cols as i64 && r < rows as i64;
                if inside { distance[r as usize * cols + c as usize] + way } else { f64::INFINITY }
            });
            distance[i] = nearest.into_iter().fold(distance[i], f64::min);
        }
    }
    distance
}

impl Shader<'_> {
    /// Fades samples of grounds with a soft edge into the sky behind them.
    pub(in crate::shade) fn fade(&self, samples: Samples<'_>, painted: &mut Painted) {
        if !self.layers.iter().any(|layer| matches!(layer, LayerShade::Terrain(t) if t.border.is_some())) {
            return;
        }
        for (k, &prim) in samples.prim.iter().enumerate() {
            let drawn = if prim == SKY { None } else { self.blocks.layer_of(prim) };
            let Some(layer) = drawn.filter(|layer| self.border(*layer as usize).is_some()) else { continue };
            let place = self.world(Sample { prim, at: samples.at(k) }).truncate();
            let root = Rgb::from_array(painted.root.each_ref().map(|plane| plane[k]));
            if let Some(color) = self.faded(layer as usize, place, pixel_of(samples.at(k)), root * root) {
                painted.set(k, color, painted.id[k]);
            }
        }
    }

    /// `color` on the ground of a layer at a place, faded into the sky at a pixel; `None` where nothing fades.
    pub(crate) fn faded(&self, layer: usize, place: DVec2, pixel: [f32; 2], color: Rgb) -> Option<Rgb> {
        let opacity = self.border(layer)?.opacity(place);
        (opacity < 1.0).then(|| self.sky.at(pixel).lerp(color, opacity))
    }

    fn border(&self, layer: usize) -> Option<&Border> {
        match self.layers.get(layer) {
            Some(LayerShade::Terrain(ground)) => ground.border.as_ref(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(void: impl Fn(usize, usize) -> bool) -> Heightfield {
        let side = 101;
        let state = |i: usize| if void(i % side, i / side) { NodeState::Void } else { NodeState::Measured };
        let states = (0..side * side).map(state).collect();
        let corner = DVec2::new(0.0, 1000.0);
        Heightfield::new(corner, DVec2::splat(10.0), side, side, vec![5.0; side * side], states).expect("ground")
    }

    #[test]
    fn opacity_falls_to_nothing_at_the_rim_and_is_whole_a_twentieth_within() {
        let border = Border::new(&square(|_, _| false));
        for x in [0.0, -5.0, 1000.0] {
            assert_eq!(border.opacity(DVec2::new(x, 500.0)), 0.0);
        }
        assert_eq!(border.opacity(DVec2::new(500.0, 500.0)), 1.0);
        assert_eq!(border.opacity(DVec2::new(60.0, 400.0)), 1.0);
        let half = border.opacity(DVec2::new(25.0, 400.0));
        assert!((half - 0.5).abs() < 0.1, "{half}");
        let way: Vec<f32> = (0..60).map(|x| border.opacity(DVec2::new(f64::from(x), 300.0))).collect();
        assert!(way.windows(2).all(|w| w[0] <= w[1] && w[1] - w[0] < 0.08), "{way:?}");
    }

    #[test]
    fn nothing_fades_under_and_in_front_of_what_must_be_seen() {
        let ground = square(|_, _| false);
        // A path along the western rim, seen from the south-west.
        let (mut border, eye) = (Border::new(&ground), DVec2::new(-800.0, -200.0));
        (300..500).step_by(5).for_each(|y| border.keep(DVec2::new(12.0, f64::from(y)), eye));
        border.widen_kept();
        for y in (310..500).step_by(10) {
            let place = DVec2::new(12.0, f64::from(y));
            assert_eq!(border.opacity(place), 1.0, "under the path at {y}");
            let before = place + 8.0 * (eye - place).normalize();
            assert_eq!(border.opacity(before), 1.0, "in front of it at {y}");
        }
        assert!(border.opacity(DVec2::new(12.0, 800.0)) < 0.5 && border.opacity(DVec2::new(985.0, 400.0)) < 0.5);
        let way: Vec<f32> = (480..640).map(|y| border.opacity(DVec2::new(12.0, f64::from(y)))).collect();
        assert!(way.windows(2).all(|w| (w[1] - w[0]).abs() < 0.12), "{way:?}");
    }

    #[test]
    fn land_does_not_fade_at_its_coast() {
        // Islands of 100 m in a sea without data, and the same heights cut by a slanted frame.
        let side = 101;
        let height = |c: usize, r: usize| 100.0 - 12.0 * ((c % 50) as f32 - 25.0).hypot((r % 50) as f32 - 25.0);
        let ground = |void: &dyn Fn(usize, usize) -> bool| {
            let nodes = (0..side * side).map(|i| (i % side, i / side));
            let states = nodes.clone().map(|(c, r)| if void(c, r) { NodeState::Void } else { NodeState::Measured });
            let heights = nodes.map(|(c, r)| height(c, r).max(0.0)).collect();
            let corner = DVec2::new(0.0, 1000.0);
            Heightfield::new(corner, DVec2::splat(10.0), side, side, heights, states.collect()).expect("ground")
        };
        let islands = Border::new(&ground(&|c, r| height(c, r) < 4.0));
        assert_eq!(islands.opacity(DVec2::new(250.0, 750.0)), 1.0, "the top of an island");
        assert_eq!(islands.opacity(DVec2::new(180.0, 750.0)), 1.0, "its shore");
        let cut = Border::new(&ground(&|c, r| 3 * c < r + 60));
        assert!(cut.opacity(DVec2::new(400.0, 400.0)) < 0.6, "a frame cuts through high land");
    }

    #[test]
    fn voids_that_reach_the_rim_end_the_data_and_holes_within_do_not() {
        // A slanted western rim, as reprojected grids have it, and a hole in the middle.
        let border = Border::new(&square(|c, r| c < r / 4 || (48..53).contains(&c) && (48..53).contains(&r)));
        assert_eq!(border.opacity(DVec2::new(150.0, 200.0)), 0.0, "outside");
        let near = border.opacity(DVec2::new(220.0, 200.0));
        assert!(near > 0.05 && near < 0.6, "{near}");
        assert_eq!(border.opacity(DVec2::new(300.0, 200.0)), 1.0);
        assert_eq!(border.opacity(DVec2::new(470.0, 500.0)), 1.0, "beside the hole");
    }
}

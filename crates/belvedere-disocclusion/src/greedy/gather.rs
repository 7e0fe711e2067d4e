//! What the ground is like where a line of sight crosses the grid.

use super::super::register::{LANES, NTH, UNITS, load, split, store};
use super::Blocks;
use super::blocks::Node;
use belvedere_sight::{AT_NODE, SightLine};
use pulp::Simd;

/// Crossings of a line of sight with one family of lines of the grid, and the ground there; one array for each quantity.
///
/// First all places are worked out, then all ground is fetched, and only then is it judged: what is far away in memory is
/// waited for once and not for each register again.
#[derive(Default)]
pub(super) struct Crossings {
    count: usize,
    /// Columns (or rows) of the grid.
    pub(super) line: Vec<f64>,
    pub(super) tau: Vec<f64>,
    /// The northern (or western) end of the edge that is crossed, as the lowest bits of a number.
    node: Vec<f64>,
    /// Share of the other end.
    pub(super) weight: Vec<f64>,
    /// Heights of both ends.
    pub(super) heights: [Vec<f64>; 2],
    /// Cell of the nearer end, and of the other one.
    pub(super) cells: [Vec<u32>; 2],
    /// The most that is done to the cell of the nearer end.
    pub(super) scale: Vec<f64>,
    pub(super) shift: Vec<f64>,
}

impl Crossings {
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Works out the crossings with columns (family 0) or rows (1), and fetches the ground.
    ///
    /// * `stretches`: parts of the line to look at, in order;
    /// * `cells`: what is done to each, and a last one for none.
    #[inline(always)]
    pub(super) fn gather<S: Simd, const FAMILY: usize>(
        &mut self,
        simd: S,
        line: &SightLine<'_>,
        stretches: &[[f64; 2]],
        blocks: &Blocks,
        cells: &[[f64; 2]],
    ) {
        self.count = 0;
        self.reserve(blocks.nodes()[FAMILY] + LANES);
        let (start, dir) = (line.from()[FAMILY], line.dir()[FAMILY]);
        if dir == 0.0 {
            return;
        }
        // Along the line, whichever way it goes.
        let (sign, last) = (dir.signum(), blocks.nodes()[FAMILY] as f64 - 1.0);
        let (mut next, end) = if sign > 0.0 { (0.0, last) } else { (-last, 0.0) };
        for [from, to] in stretches {
            let first = (sign * (start + from * dir) - AT_NODE).ceil().max(next);
            let past = (sign * (start + to * dir) + AT_NODE).floor().min(end) + 1.0;
            let mut at = first;
            while at < past {
                self.places::<S, FAMILY>(simd, line, blocks.nodes(), [sign * at, sign]);
                at += S::F64_LANES as f64;
                self.count += S::F64_LANES;
            }
            self.count -= (at - past.max(first)) as usize;
            next = next.max(past);
        }
        self.fetch(blocks.ground(), along::<FAMILY>(blocks.nodes()), cells);
    }

    fn reserve(&mut self, room: usize) {
        if self.tau.len() < room {
            let [a, b] = &mut self.heights;
            let places = [&mut self.line, &mut self.tau, &mut self.node, &mut self.weight];
            let ground = [a, b, &mut self.scale, &mut self.shift];
            places.into_iter().chain(ground).for_each(|numbers| numbers.resize(room, 0.0));
            self.cells.iter_mut().for_each(|cells| cells.resize(room, 0));
        }
    }

    /// A register of places behind those there are.
    #[inline(always)]
    fn places<S: Simd, const FAMILY: usize>(
        &mut self,
        simd: S,
        sight: &SightLine<'_>,
        nodes: [usize; 2],
        [first, sign]: [f64; 2],
    ) {
        let other = 1 - FAMILY;
        let (start, dir) = (sight.from(), sight.dir());
        let splat = |x: f64| simd.splat_f64s(x);
        let along = along::<FAMILY>(nodes) as f64;
        let across = if FAMILY == 0 { 1.0 } else { nodes[0] as f64 };
        let line = simd.mul_add_e_f64s(load::<S>(&NTH), splat(sign), splat(first));
        let tau = simd.mul_f64s(simd.sub_f64s(line, splat(start[FAMILY])), splat(dir[FAMILY].recip()));
        let place = simd.mul_add_e_f64s(tau, splat(dir[other]), splat(start[other]));
        let (whole, weight) = split(simd, place, nodes[other] as f64 - 2.0);
        let node = simd.mul_add_e_f64s(line, splat(across), splat(UNITS));
        let node = simd.mul_add_e_f64s(whole, splat(along), node);
        let at = self.count..self.count + LANES;
        self.line[at.clone()].copy_from_slice(&store::<S>(line));
        self.tau[at.clone()].copy_from_slice(&store::<S>(tau));
        self.weight[at.clone()].copy_from_slice(&store::<S>(weight));
        self.node[at].copy_from_slice(&store::<S>(node));
    }

    #[inline(always)]
    fn fetch(&mut self, ground: &[Node], along: usize, done: &[[f64; 2]]) {
        let n = self.count;
        let (node, weight) = (&self.node[..n], &self.weight[..n]);
        let [a, b] = self.heights.each_mut().map(|h| &mut h[..n]);
        let [near, far] = self.cells.each_mut().map(|c| &mut c[..n]);
        let (scale, shift) = (&mut self.scale[..n], &mut self.shift[..n]);
        for i in 0..n {
            let first = node[i].to_bits() as u32 as usize;
            let [begin, end] = [ground[first], ground[first + along]];
            (a[i], b[i]) = (f64::from(begin.height), f64::from(end.height));
            (near[i], far[i]) = if weight[i] > 0.5 { (end.cell, begin.cell) } else { (begin.cell, end.cell) };
            [scale[i], shift[i]] = done[near[i] as usize];
        }
    }
}

/// From one end of an edge to the other, in nodes.
#[inline(always)]
fn along<const FAMILY: usize>(nodes: [usize; 2]) -> usize {
    if FAMILY == 0 { nodes[0] } else { 1 }
}

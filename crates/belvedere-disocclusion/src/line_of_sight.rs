//! Where a line of sight meets the edges of the ground's triangles.

use super::Field;
use belvedere_core::DVec2;

/// Lines that come closer to a node than this pass through it, cells.
pub(super) const AT_NODE: f64 = 1e-9;

/// One crossing of the line of sight from a point P to the eye V with an edge of the ground.
///
/// The line of sight's height there is `(1 - tau) z_P + tau z_V`, the ground's
/// `(1 - weight) h[nodes[0]] + weight h[nodes[1]]`, both exact; between crossings (with the diagonals) both are linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SightSample {
    /// 0 at the point, 1 at the eye, in between here.
    pub tau: f64,
    /// Ends of the edge as indices into the heights; twice the same where the line passes through a node.
    pub nodes: [u32; 2],
    /// Share of the second node, 0..1.
    pub weight: f64,
    /// Distance to the eye in plan, scene units.
    pub rho: f64,
}

impl SightSample {
    /// Value of a field given at the nodes.
    pub fn of(&self, values: &[f64]) -> f64 {
        let [a, b] = self.nodes.map(|n| values[n as usize]);
        a + self.weight * (b - a)
    }

    /// Whether both are the same node, met on two lines of the grid.
    pub(super) fn same_node(&self, other: &Self) -> bool {
        self.weight == 0.0 && other.weight == 0.0 && self.nodes == other.nodes
    }

    /// The end of the edge that is nearer to the crossing.
    pub fn nearest(&self) -> usize {
        self.nodes[usize::from(self.weight > 0.5)] as usize
    }
}

/// Part of the line of sight, 0..=1, in which the ground counts as the point's own and cannot hide it.
///
/// * `from`, `eye`: grid coordinates; `guard`: cells.
pub fn guard_tau(from: DVec2, eye: DVec2, guard: f64) -> f64 {
    let length = (eye - from).length();
    if length > guard { guard / length } else { 1.0 }
}

/// Crossings of the line of sight with the lines x = int and y = int, from the point to the eye, each once.
///
/// * `from`, `eye`: grid coordinates; either may lie beside the grid, where nothing is crossed;
/// * `diagonals`: also with the cells' north-west to south-east diagonals, where the drawn surface has its kinks;
/// * `out` is overwritten.
///
/// Where an end of an edge is void there is no ground and no sample. A point under the eye has no samples.
pub fn sight_samples(field: &Field, from: DVec2, eye: DVec2, diagonals: bool, out: &mut Vec<SightSample>) {
    out.clear();
    if let Some(mut walk) = SightWalk::new(field, from, eye, diagonals) {
        let (_, end) = walk.line.span;
        walk.samples_to(end, out);
    }
}

/// A line of sight over the grid, in plan.
pub(super) struct SightLine<'a> {
    field: &'a Field,
    from: DVec2,
    dir: DVec2,
    plan_m: f64,
    span: (f64, f64),
}

/// A line of sight on its way from the point to the eye.
struct SightWalk<'a> {
    line: SightLine<'a>,
    crossings: [Crossings; 3],
}

impl<'a> SightWalk<'a> {
    /// `None` if the line does not meet the grid.
    fn new(field: &'a Field, from: DVec2, eye: DVec2, diagonals: bool) -> Option<Self> {
        let line = SightLine::new(field, from, eye)?;
        let (dir, span) = (line.dir, line.span);
        let diagonal = if diagonals { dir.x - dir.y } else { 0.0 };
        let crossings = [
            Crossings::new(from.x, dir.x, span),
            Crossings::new(from.y, dir.y, span),
            Crossings::new(from.x - from.y, diagonal, span),
        ];
        Some(Self { line, crossings })
    }

    /// Appends the crossings from where the walk is up to `tau`.
    #[inline(always)]
    fn samples_to(&mut self, end: f64, out: &mut Vec<SightSample>) {
        loop {
            let next = self.crossings.each_ref().map(|c| c.tau);
            let family = if next[1] < next[0] { 1 } else { 0 };
            let family = if next[2] < next[family] { 2 } else { family };
            let tau = next[family];
            // Beside the span there are none, so the last may lie beyond its end by rounding.
            if tau == f64::INFINITY || (tau > end && end < self.line.span.1) {
                return;
            }
            let k = self.crossings[family].advance();
            let Some(sample) = self.line.at(family, k, tau) else { continue };
            if !out.last().is_some_and(|s| s.same_node(&sample)) {
                out.push(sample);
            }
        }
    }
}

impl<'a> SightLine<'a> {
    /// `None` if the line does not meet the grid.
    pub(super) fn new(field: &'a Field, from: DVec2, eye: DVec2) -> Option<Self> {
        let dir = eye - from;
        let span = over(field, from, dir)?;
        Some(Self { field, from, dir, plan_m: (dir * field.spacing()).length(), span })
    }

    /// The part of the line over the grid.
    pub(super) fn span(&self) -> (f64, f64) {
        self.span
    }

    /// Where the line of sight starts, cells.
    pub(super) fn from(&self) -> DVec2 {
        self.from
    }

    /// From the point to the eye, cells.
    pub(super) fn dir(&self) -> DVec2 {
        self.dir
    }

    /// The crossing with line `k` of a family (0: x = k, 1: y = k).
    #[inline(always)]
    pub(super) fn crossing(&self, family: usize, k: f64) -> Option<SightSample> {
        self.at(family, k, (k - self.from[family]) / self.dir[family])
    }

    #[inline(always)]
    fn at(&self, family: usize, k: f64, tau: f64) -> Option<SightSample> {
        if !(tau > 0.0 && tau < 1.0) {
            return None;
        }
        let (nodes, weight) = self.edge(family, k, tau);
        let void = nodes.iter().any(|&n| self.field.void()[n as usize]);
        (!void).then_some(SightSample { tau, nodes, weight, rho: (1.0 - tau) * self.plan_m })
    }

    /// The edge crossed at `tau` on line `k` of a family (x, y, x - y), and the share of its second node.
    #[inline(always)]
    fn edge(&self, family: usize, k: f64, tau: f64) -> ([u32; 2], f64) {
        let cols = self.field.cols();
        let last = DVec2::new((cols - 1) as f64, (self.field.rows() - 1) as f64);
        // What runs along the edge: y on a line x = k, else x.
        let axis = usize::from(family == 0);
        let along = (self.from[axis] + tau * self.dir[axis]).clamp(0.0, last[axis]);
        let near = along.round();
        let at_node = (along - near).abs() <= AT_NODE;
        let start = if at_node { near } else { along.floor() };
        let (corner, step) = match family {
            0 => (DVec2::new(k, start), cols),
            1 => (DVec2::new(start, k), 1),
            _ => (DVec2::new(start, start - k), cols + 1),
        };
        let corner = corner.clamp(DVec2::ZERO, last);
        let node = corner.y as usize * cols + corner.x as usize;
        if at_node { ([node as u32; 2], 0.0) } else { ([node as u32, (node + step) as u32], along - start) }
    }
}

/// The part of a line over the grid.
fn over(field: &Field, from: DVec2, dir: DVec2) -> Option<(f64, f64)> {
    if !(from.is_finite() && dir.is_finite()) {
        return None;
    }
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for (axis, last) in [field.cols() - 1, field.rows() - 1].into_iter().enumerate() {
        let (p, d) = (from[axis], dir[axis]);
        if d == 0.0 {
            if !(0.0..=last as f64).contains(&p) {
                return None;
            }
            continue;
        }
        let (s0, s1) = (-p / d, (last as f64 - p) / d);
        t0 = t0.max(s0.min(s1));
        t1 = t1.min(s0.max(s1));
    }
    (t0 <= t1).then_some((t0, t1))
}

/// Crossings with one family of parallel lines, by rising tau.
struct Crossings {
    start: f64,
    step: f64,
    /// The next line and the last one, and the next one's tau (infinite after the last).
    k: f64,
    last: f64,
    tau: f64,
}

impl Crossings {
    fn new(start: f64, step: f64, (t0, t1): (f64, f64)) -> Self {
        if step == 0.0 {
            return Self { start, step, k: 0.0, last: 0.0, tau: f64::INFINITY };
        }
        let end = start + t1 * step;
        let last = if step > 0.0 { (end + AT_NODE).floor() } else { (end - AT_NODE).ceil() };
        let mut out = Self { start, step, k: 0.0, last, tau: 0.0 };
        out.k = out.first_from(t0);
        out.set();
        out
    }

    #[inline(always)]
    fn first_from(&self, tau: f64) -> f64 {
        let at = self.start + tau * self.step;
        if self.step > 0.0 { (at - AT_NODE).ceil() } else { (at + AT_NODE).floor() }
    }

    #[inline(always)]
    fn set(&mut self) {
        let over = if self.step > 0.0 { self.k > self.last } else { self.k < self.last };
        self.tau = if over { f64::INFINITY } else { (self.k - self.start) / self.step };
    }

    /// The line crossed now; goes on to the next one.
    #[inline(always)]
    fn advance(&mut self) -> f64 {
        let k = self.k;
        self.k += self.step.signum();
        self.set();
        k
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::{Heightfield, NodeState};

    fn field(cols: usize, rows: usize, void: &[usize]) -> Field {
        let heights = (0..cols * rows).map(|i| ((i * 7919) % 101) as f32).collect();
        let mut states = vec![NodeState::Measured; cols * rows];
        void.iter().for_each(|&i| states[i] = NodeState::Void);
        let hf = Heightfield::new(DVec2::new(0.0, 0.0), DVec2::new(10.0, 20.0), cols, rows, heights, states).unwrap();
        Field::new(&hf, |_| 0.0).unwrap()
    }

    fn samples(field: &Field, from: [f64; 2], eye: [f64; 2], diagonals: bool) -> Vec<SightSample> {
        let mut out = Vec::new();
        sight_samples(field, DVec2::from(from), DVec2::from(eye), diagonals, &mut out);
        out
    }

    /// Number of crossings of one axis, by counting integers strictly between.
    fn between(a: f64, b: f64) -> usize {
        (0..40).filter(|&k| (f64::from(k) - a) * (f64::from(k) - b) < 0.0).count()
    }

    #[test]
    fn every_grid_line_is_crossed_once_in_order_and_heights_are_those_of_the_edges() {
        let field = field(20, 17, &[]);
        for (from, eye) in [([1.3, 2.7], [17.9, 14.2]), ([17.9, 14.2], [1.3, 2.7]), ([3.5, 15.2], [18.1, 0.4])] {
            let (p, v) = (DVec2::from(from), DVec2::from(eye));
            let plain = samples(&field, from, eye, false);
            assert_eq!(plain.len(), between(p.x, v.x) + between(p.y, v.y));
            let fine = samples(&field, from, eye, true);
            let more = (-40..40).filter(|&k| (f64::from(k) - p.x + p.y) * (f64::from(k) - v.x + v.y) < 0.0).count();
            assert_eq!(fine.len(), plain.len() + more);
            for s in &fine {
                let g = p + s.tau * (v - p);
                assert!((field.surface_at(g).unwrap() - s.of(field.heights())).abs() < 1e-9, "{s:?}");
                assert!((s.rho - ((v - g) * field.spacing()).length()).abs() < 1e-9);
            }
            assert!(fine.windows(2).all(|w| w[0].tau < w[1].tau));
        }
    }

    #[test]
    fn along_a_grid_line_and_through_nodes_each_node_comes_once() {
        let field = field(9, 9, &[]);
        let along = samples(&field, [1.5, 3.0], [6.5, 3.0], true);
        let nodes: Vec<u32> = along.iter().map(|s| s.nodes[0]).collect();
        assert_eq!(nodes, [29, 30, 31, 32, 33]);
        assert!(along.iter().all(|s| s.nodes[0] == s.nodes[1] && s.weight == 0.0));
        let column = samples(&field, [4.0, 7.5], [4.0, 0.0], true);
        assert_eq!(column.iter().map(|s| s.nodes[0]).collect::<Vec<_>>(), [67, 58, 49, 40, 31, 22, 13]);
        // Down the diagonal of the cells, from a node to a node: ends excluded.
        let diagonal = samples(&field, [1.0, 1.0], [6.0, 6.0], true);
        assert_eq!(diagonal.iter().map(|s| s.nodes).collect::<Vec<_>>(), [[20; 2], [30; 2], [40; 2], [50; 2]]);
        // Through nodes with a slope of 1 : 3, which f64 cannot hold.
        let third = samples(&field, [1.0, 2.0], [7.0, 4.0], false);
        let at_nodes: Vec<u32> = third.iter().filter(|s| s.weight == 0.0).map(|s| s.nodes[0]).collect();
        assert_eq!((third.len(), at_nodes), (5, vec![31]));
    }

    #[test]
    fn beside_the_grid_nothing_is_crossed_and_the_rim_is() {
        let field = field(6, 5, &[]);
        let outside = samples(&field, [2.5, 2.5], [2.5, 40.0], true);
        assert_eq!(outside.len(), 3, "two rows and a diagonal in the middle of a cell");
        assert_eq!(outside.last().unwrap().nodes, [26, 27], "the southern rim");
        assert!((outside.last().unwrap().tau - 1.5 / 37.5).abs() < 1e-12);
        assert_eq!(samples(&field, [2.5, 2.5], [-3e6, 2.25], true).last().unwrap().nodes, [12, 18]);
        assert!(samples(&field, [-2.0, 2.0], [-1.0, 4.0], true).is_empty());
        assert!(samples(&field, [2.5, 2.5], [2.5, 2.5], true).is_empty(), "under the eye");
        assert!(samples(&field, [2.5, f64::NAN], [1.0, 2.0], true).is_empty());
        assert_eq!(samples(&field, [0.0, 0.5], [0.0, 4.0], true).len(), 3, "along the western rim");
        assert_eq!(samples(&field, [5.0, 0.5], [5.0, 9.0], true).len(), 4, "along the eastern rim and over the corner");
        // A point on the rim, looking along the south-eastern corner's diagonal.
        assert_eq!(samples(&field, [5.0, 4.0], [1.0, 0.0], true).len(), 3);
    }

    #[test]
    fn an_edge_without_both_ends_is_no_ground() {
        let (solid, holed) = (field(6, 6, &[]), field(6, 6, &[14]));
        let all = samples(&solid, [0.5, 2.2], [4.6, 2.4], true);
        let left = samples(&holed, [0.5, 2.2], [4.6, 2.4], true);
        assert_eq!(all.iter().copied().filter(|s| !s.nodes.contains(&14)).collect::<Vec<_>>(), left);
        assert_eq!(all.len() - left.len(), 2, "the southern and the diagonal edge of the node");
    }

    #[test]
    fn both_directions_see_the_same_edges() {
        let field = field(20, 17, &[]);
        let (a, b) = ([2.0, 3.0], [15.0, 11.25]);
        let forth = samples(&field, a, b, true);
        let mut back = samples(&field, b, a, true);
        back.reverse();
        assert_eq!(forth.iter().map(|s| s.nodes).collect::<Vec<_>>(), back.iter().map(|s| s.nodes).collect::<Vec<_>>());
        assert!(forth.iter().zip(&back).all(|(f, b)| (f.tau + b.tau - 1.0).abs() < 1e-12));
    }

    #[test]
    fn the_guard_is_measured_in_cells() {
        let (p, v) = (DVec2::new(1.0, 2.0), DVec2::new(4.0, 6.0));
        assert!((guard_tau(p, v, 1.5) - 0.3).abs() < 1e-15);
        assert_eq!(guard_tau(p, p, 1.5), 1.0);
    }
}

//! Sources over one another: the finer is blended over the coarser along its border.

use super::bilinear::Bilinear;
use super::grid_map::GridMap;
use super::source::SourceGrid;
use super::together::depth;
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use rayon::prelude::*;

/// Width of the seam of a source, in samples of what lies under it, and its limits in samples of its own.
const OVERLAP: f64 = 3.0;
const LEAST_SEAM: f64 = 4.0;
const MOST_SEAM: f64 = 200.0;
/// Differences of sources up to this are not said, metres: rounding to whole metres.
const WORTH_SAYING_M: f32 = 1.0;

/// Heights of several sources, the finest first, each blended over those after it.
pub(super) fn drawn_over(
    [cols, rows]: [usize; 2],
    sources: &[SourceGrid],
    maps: &[GridMap<'_>],
    warnings: &mut Vec<Warning>,
) -> Vec<f32> {
    let mut nodes = vec![Node { height: f32::INFINITY, sure: 0.0 }; cols * rows];
    let mut under_m = sources.last().map_or(1.0, SourceGrid::spacing_m);
    for (source, map) in sources.iter().zip(maps).rev() {
        let seam = Seam::new(source, under_m);
        under_m = source.spacing_m();
        let over = draw_over(&mut nodes, cols, source, map, &seam);
        if over.nodes > 0 && over.largest > WORTH_SAYING_M {
            let rms = (over.squares / over.nodes as f64).sqrt();
            let text = format!(
                "it lies over other ground of which it differs by {rms:.1} m (rms), {:.1} m at most; it is drawn, and blended with that over {:.0} of its samples along its border",
                over.largest,
                seam.width()
            );
            let warning = Warning::new(WarningKind::Repaired, text).with("rms_m", rms);
            warnings.push(warning.with("largest_m", f64::from(over.largest)).in_file(&source.path));
        }
    }
    nodes.into_iter().map(|node| node.height).collect()
}

/// A node on which sources are drawn.
#[derive(Clone, Copy)]
struct Node {
    height: f32,
    /// Share of the sources there, 0 at their borders.
    sure: f32,
}

/// Differences of a source from the ground under it.
#[derive(Default, Clone, Copy)]
struct Over {
    nodes: usize,
    largest: f32,
    squares: f64,
}

impl Over {
    fn and(self, other: Self) -> Self {
        let nodes = self.nodes + other.nodes;
        Self { nodes, largest: self.largest.max(other.largest), squares: self.squares + other.squares }
    }
}

/// Blends a source over what was drawn before.
fn draw_over(nodes: &mut [Node], cols: usize, source: &SourceGrid, map: &GridMap<'_>, seam: &Seam) -> Over {
    let of_source = Bilinear::new(&source.heights, [source.cols, source.rows], 0.5);
    let of_row = |indices: &mut Vec<DVec2>, (r, row): (usize, &mut [Node])| {
        map.row(r, indices);
        let mut over = Over::default();
        for (node, &index) in row.iter_mut().zip(indices.iter()) {
            let new = of_source.at(index);
            if !new.is_finite() {
                // A void stays one where nothing else is known.
                if node.height.is_infinite() {
                    node.height = new;
                }
                continue;
            }
            let share = seam.share(index);
            if !node.height.is_finite() {
                *node = Node { height: new, sure: share };
                continue;
            }
            let differs = new - node.height;
            over = over.and(Over { nodes: 1, largest: differs.abs(), squares: f64::from(differs * differs) });
            let below = (1.0 - share) * node.sure;
            let sure = share + below;
            node.height += if sure > 0.0 { differs * (share / sure) } else { 0.5 * differs };
            node.sure = sure;
        }
        over
    };
    let rows = nodes.par_chunks_exact_mut(cols).enumerate();
    let per_row: Vec<Over> = rows.map_init(|| vec![DVec2::ZERO; cols], of_row).collect();
    per_row.into_iter().fold(Over::default(), Over::and)
}

/// How much of a source is taken over what lies under it: none at its border and beside its voids, all from some samples on.
struct Seam {
    depth: Vec<u8>,
    size: [usize; 2],
    width: f32,
}

impl Seam {
    /// * `under_m`: spacing of the source that lies under it, metres.
    fn new(source: &SourceGrid, under_m: f64) -> Self {
        let quarter = (source.cols.min(source.rows) / 4) as f64;
        let width = (OVERLAP * under_m / source.spacing_m()).clamp(LEAST_SEAM, MOST_SEAM).min(quarter.max(1.0));
        let depth = depth(&source.heights, source.cols, width.ceil() as u8 + 1);
        Self { depth, size: [source.cols, source.rows], width: width as f32 }
    }

    /// Samples of its source over which it is blended.
    fn width(&self) -> f32 {
        self.width
    }

    /// Share of the source at a fractional node, 0..=1, smooth.
    fn share(&self, index: DVec2) -> f32 {
        let [cols, rows] = self.size;
        let at = index.clamp(DVec2::ZERO, DVec2::new((cols - 1) as f64, (rows - 1) as f64));
        let [c, r] = [(at.x as usize).min(cols - 2), (at.y as usize).min(rows - 2)];
        let [u, v] = [(at.x - c as f64) as f32, (at.y - r as f64) as f32];
        let depth = |c: usize, r: usize| f32::from(self.depth[r * cols + c]);
        let row = |r: usize| depth(c, r) + (depth(c + 1, r) - depth(c, r)) * u;
        let t = ((row(r) + (row(r + 1) - row(r)) * v - 1.0) / self.width).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

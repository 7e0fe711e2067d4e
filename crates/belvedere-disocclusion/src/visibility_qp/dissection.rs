//! Order of elimination on the solver's grid by nested dissection (George 1973).
//!
//! A strip of nodes separates each rectangle into two; rows that join both sides, for a point is seen past ground far away from it,
//! bring the nodes around their points into the separator.

use std::collections::BTreeSet;

/// Rectangles of at most so many nodes are not separated any more.
const LEAF: usize = 36;
/// Columns or rows of a separator: the stencil of H reaches two nodes far.
const STRIP: usize = 2;
/// Mark of nodes that are not unknowns of their own, and of those not yet ordered.
const NONE: u32 = u32::MAX;

/// Part of the elimination: nodes that are eliminated together, after those of all parts below.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) nodes: Vec<u32>,
    /// Parts below, by index; all have lower ones.
    pub(super) below: Vec<usize>,
}

/// Parts in the order of elimination; the last one is the root.
#[derive(Debug, Clone)]
pub(super) struct Dissection {
    pub(super) parts: Vec<Part>,
    /// Part of each node; `u32::MAX` for nodes that are not unknowns.
    pub(super) part_of: Vec<u32>,
}

/// Two groups of nodes of a row, at its ground and at its point. Nodes may occur twice.
pub(super) type Pair = [[u32; 4]; 2];

impl Dissection {
    /// * `cols`, `rows`: the grid;
    /// * `stands_for`: for each node the unknown that it belongs to, mostly itself; unknowns of several nodes are eliminated last;
    /// * `pairs`: groups of unknowns that rows join.
    pub(super) fn new([cols, rows]: [usize; 2], stands_for: &[u32], pairs: &BTreeSet<Pair>) -> Self {
        let mut out = Self { parts: Vec::new(), part_of: vec![NONE; cols * rows] };
        let mut work = Work { cols, taken: vec![false; cols * rows] };
        let mut last = BTreeSet::new();
        for (node, own) in stands_for.iter().enumerate() {
            if *own != node as u32 {
                work.taken[node] = true;
                work.taken[*own as usize] = true;
                last.insert(*own);
            }
        }
        let pairs: Vec<Pair> = pairs.iter().copied().collect();
        work.split([0, cols, 0, rows], &pairs, last.into_iter().collect(), &mut out);
        out
    }
}

struct Work {
    cols: usize,
    /// Nodes that have their part.
    taken: Vec<bool>,
}

impl Work {
    /// Separates the free nodes of a rectangle (from and to columns, from and to rows) and those of its parts; `first` = nodes that
    /// join its own part. Returns the index of that part.
    fn split(&mut self, rect: [usize; 4], pairs: &[Pair], first: Vec<u32>, out: &mut Dissection) -> usize {
        let [x0, x1, y0, y1] = rect;
        let (width, height) = (x1 - x0, y1 - y0);
        let mut nodes = first;
        let mut below = Vec::new();
        if width * height <= LEAF || width.max(height) <= STRIP + 2 {
            self.take(rect, &mut nodes);
        } else {
            let (strip, sides) = if width >= height {
                let cut = x0 + (width - STRIP) / 2;
                ([cut, cut + STRIP, y0, y1], [[x0, cut, y0, y1], [cut + STRIP, x1, y0, y1]])
            } else {
                let cut = y0 + (height - STRIP) / 2;
                ([x0, x1, cut, cut + STRIP], [[x0, x1, y0, cut], [x0, x1, cut + STRIP, y1]])
            };
            self.take(strip, &mut nodes);
            let mut inside = [Vec::new(), Vec::new()];
            for pair in pairs {
                let [[a, b], [c, d]] = pair.map(|group| sides.map(|side| self.has_free(&group, side)));
                if (a && d) || (b && c) {
                    for node in pair[1] {
                        if !self.taken[node as usize] {
                            self.taken[node as usize] = true;
                            nodes.push(node);
                        }
                    }
                }
                // Only pairs of two far groups can join sides further down.
                if a && c {
                    inside[0].push(*pair);
                } else if b && d {
                    inside[1].push(*pair);
                }
            }
            for (side, pairs) in sides.into_iter().zip(inside) {
                below.push(self.split(side, &pairs, Vec::new(), out));
            }
        }
        let part = out.parts.len();
        nodes.iter().for_each(|node| out.part_of[*node as usize] = part as u32);
        out.parts.push(Part { nodes, below });
        part
    }

    /// Moves the free nodes of a rectangle to `nodes`.
    fn take(&mut self, [x0, x1, y0, y1]: [usize; 4], nodes: &mut Vec<u32>) {
        for y in y0..y1 {
            for node in y * self.cols + x0..y * self.cols + x1 {
                if !std::mem::replace(&mut self.taken[node], true) {
                    nodes.push(node as u32);
                }
            }
        }
    }

    /// Whether one of these nodes is free and inside a rectangle.
    fn has_free(&self, group: &[u32; 4], [x0, x1, y0, y1]: [usize; 4]) -> bool {
        group.iter().any(|node| {
            let (x, y) = (*node as usize % self.cols, *node as usize / self.cols);
            x >= x0 && x < x1 && y >= y0 && y < y1 && !self.taken[*node as usize]
        })
    }
}

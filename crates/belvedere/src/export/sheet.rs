//! Triangles with shared vertices, split where a bend would make their straight edges visible.

use super::Carrier;
use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_scene::Progress;
use rayon::prelude::*;
use std::collections::HashMap;

/// Largest distance between the image of the middle of an edge and the middle of the drawn edge, pixels.
const TOLERANCE_PX: f64 = 0.25;
/// The same along the ray, as a share of the depth.
const TOLERANCE_DEPTH: f64 = 0.002;
/// How often a triangle is split at most.
const ROUNDS: usize = 6;

/// A surface: vertices where the scene has them, where the stages put them, and their colours.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    /// Scene coordinates.
    pub(super) world: Vec<DVec3>,
    /// Displaced; `None` without an image.
    pub(super) carried: Vec<Option<DVec3>>,
    /// Linear red, green, blue.
    pub(super) colors: Vec<[f32; 3]>,
    /// Numbers of vertices; all of them have images once the sheet is finished.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether neighbouring triangles share their normals.
    pub(super) smooth: bool,
}

impl Sheet {
    /// Adds a vertex and returns its number.
    pub(super) fn push(&mut self, world: DVec3, carried: Option<DVec3>, color: [f32; 3]) -> u32 {
        self.world.push(world);
        self.carried.push(carried);
        self.colors.push(color);
        (self.world.len() - 1) as u32
    }

    /// Adds the triangles and vertices of another sheet.
    pub(super) fn append(&mut self, other: Self) {
        let first = self.world.len() as u32;
        self.world.extend(other.world);
        self.carried.extend(other.carried);
        self.colors.extend(other.colors);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|v| first + v)));
    }

    /// Splits edges until they follow the bend, and leaves out triangles of which a corner has no image.
    pub(super) fn refined(
        mut self,
        carrier: &Carrier<'_>,
        most: usize,
        progress: &Progress,
    ) -> Result<Self, BelvedereError> {
        let mut done: Vec<[u32; 3]> = Vec::with_capacity(self.triangles.len());
        let mut open = std::mem::take(&mut self.triangles);
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        for round in 0..=ROUNDS {
            progress.tick("export", 0.0)?;
            open.retain(|t| t.iter().all(|v| self.carried[*v as usize].is_some()));
            if round == ROUNDS || done.len() + open.len() > most {
                break;
            }
            let bent: Vec<[bool; 3]> =
                open.par_iter().map(|t| std::array::from_fn(|k| self.is_bent(t[k], t[(k + 1) % 3], carrier))).collect();
            let mut next = Vec::new();
            for (t, bent) in open.iter().zip(&bent) {
                if *bent == [false; 3] {
                    done.push(*t);
                    continue;
                }
                let mut middle = |k: usize| self.middle(t[k], t[(k + 1) % 3], carrier, &mut middles);
                let split: [Option<u32>; 3] = std::array::from_fn(|k| bent[k].then(|| middle(k)));
                next.extend(parts(*t, split));
            }
            open = next;
            if open.is_empty() {
                break;
            }
        }
        done.extend(open);
        self.triangles = done;
        Ok(self)
    }

    /// Whether the bend curves an edge; the same for both triangles at it.
    fn is_bent(&self, a: u32, b: u32, carrier: &Carrier<'_>) -> bool {
        let (a, b) = (a.min(b) as usize, a.max(b) as usize);
        let (Some(from), Some(to)) = (self.carried[a], self.carried[b]) else { return false };
        let Some(middle) = carrier.carry(0.5 * (self.world[a] + self.world[b])) else { return false };
        let pinhole = carrier.view.pinhole();
        let (Ok((pixel, depth)), Ok((drawn, at))) = (pinhole.project(middle), pinhole.project(0.5 * (from + to)))
        else {
            return false;
        };
        let size = belvedere_core::DVec2::from(pinhole.image.map(f64::from));
        // What lies far outside the picture may be coarse.
        let is_near = pixel.cmpge(-size).all() && pixel.cmple(2.0 * size).all();
        is_near && ((pixel - drawn).length() > TOLERANCE_PX || (depth - at).abs() > TOLERANCE_DEPTH * depth)
    }

    fn middle(&mut self, a: u32, b: u32, carrier: &Carrier<'_>, known: &mut HashMap<(u32, u32), u32>) -> u32 {
        let (a, b) = (a.min(b), a.max(b));
        if let Some(number) = known.get(&(a, b)) {
            return *number;
        }
        let world = 0.5 * (self.world[a as usize] + self.world[b as usize]);
        let [from, to] = [a, b].map(|v| self.colors[v as usize]);
        let color = std::array::from_fn(|k| 0.5 * (from[k] + to[k]));
        let number = self.push(world, carrier.carry(world), color);
        known.insert((a, b), number);
        number
    }
}

/// A triangle split at the middles of some of its edges; edge `k` leads from corner `k` to the next.
fn parts([a, b, c]: [u32; 3], split: [Option<u32>; 3]) -> Vec<[u32; 3]> {
    match split {
        [None, None, None] => vec![[a, b, c]],
        [Some(m), None, None] => vec![[a, m, c], [m, b, c]],
        [None, Some(m), None] => vec![[b, m, a], [m, c, a]],
        [None, None, Some(m)] => vec![[c, m, b], [m, a, b]],
        [Some(m), Some(n), None] => vec![[m, b, n], [a, m, n], [a, n, c]],
        [None, Some(m), Some(n)] => vec![[m, c, n], [b, m, n], [b, n, a]],
        [Some(n), None, Some(m)] => vec![[m, a, n], [c, m, n], [c, n, b]],
        [Some(m), Some(n), Some(o)] => vec![[a, m, o], [m, b, n], [o, n, c], [m, n, o]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec2;

    #[test]
    fn parts_cover_the_triangle_once_and_keep_its_side() {
        let places = [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        let area = |t: [u32; 3]| {
            let [a, b, c] = t.map(|v| places[v as usize]);
            0.5 * (b - a).perp_dot(c - a)
        };
        for which in 0..8u32 {
            let split = std::array::from_fn(|k| (which >> k & 1 == 1).then_some(3 + k as u32));
            let made = parts([0, 1, 2], split);
            assert_eq!(made.len() as u32, 1 + which.count_ones());
            assert!(made.iter().all(|t| area(*t) > 0.0), "{split:?}: {made:?}");
            assert_eq!(made.iter().map(|t| area(*t)).sum::<f64>(), 8.0, "{split:?}");
        }
    }
}

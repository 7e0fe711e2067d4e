//! Cast shadows of boxes and meshes, and shadows on them: straight rays towards the sun in the undisplaced scene. Those on molecules are in
//! `key_light`.

use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{LayerKind, Light, Scene};
use belvedere_sight::{Bundle, LayerPart, LightBuffer, Obstacles, Solids};
use std::cell::Cell;

/// Angular radius of the sun, radians.
const SUN_RADIUS: f64 = 0.004_65;
/// Offset of a ray's start from its surface, as a share of the side of the pixel's square and of the coordinates' size (rounding).
const OFF_PX: f64 = 0.02;
const OFF: f64 = 1e-9;
/// Rays that decide whether a pixel lies wholly in light or in shadow; only pixels on borders take the others.
const FIRST: usize = 4;

/// Positions within a pixel, -0.5..0.5 to the right and down, and on the sun's disc, -1..1 across; the first four lie in the corners.
const PATTERN: [[f64; 4]; 16] = pattern();

const fn pattern() -> [[f64; 4]; 16] {
    // Rows of a rotated 4 x 4 lattice, in an order that visits the corners first.
    const ORDER: [[u8; 2]; 16] = [
        [0, 0],
        [3, 0],
        [0, 3],
        [3, 3],
        [1, 1],
        [2, 2],
        [2, 1],
        [1, 2],
        [1, 0],
        [2, 3],
        [0, 2],
        [3, 1],
        [2, 0],
        [1, 3],
        [0, 1],
        [3, 2],
    ];
    let mut out = [[0.0; 4]; 16];
    let mut i = 0;
    while i < 16 {
        let [a, b] = [ORDER[i][0] as f64, ORDER[i][1] as f64];
        let (x, y) = (4.0 * a + b, 4.0 * b + 3.0 - a);
        // Opposite corners of the pixel see opposite sides of the sun half of the time.
        let (u, v) = (4.0 * ((ORDER[i][0] ^ 1) as f64) + b, 4.0 * ((ORDER[i][1] ^ 2) as f64) + a);
        out[i] = [(x + 0.5) / 16.0 - 0.5, (y + 0.5) / 16.0 - 0.5, (u + 0.5) / 8.0 - 1.0, (v + 0.5) / 8.0 - 1.0];
        i += 1;
    }
    out
}

/// Casters of shadows, except the ground on itself.
pub(crate) struct Casters<'a> {
    buffer: LightBuffer<'a>,
    /// Bounds of all boxes and meshes, and the largest height of everything.
    solid: Aabb,
    top: f64,
    sun: DVec3,
    /// Two directions across the sun's direction, as long as the sun's radius.
    across: [DVec3; 2],
}

impl<'a> Casters<'a> {
    /// `None` if shadows are off, the sun is down, or only the ground could cast any.
    /// * `casts`: whether a layer, by its index, casts shadows on anything that is drawn; `pixels`: of the picture.
    pub(crate) fn new(scene: &'a Scene, light: &Light, casts: &dyn Fn(usize) -> bool, pixels: usize) -> Option<Self> {
        let sun = light.direction();
        if !(light.shadows && sun.z > 0.01) {
            return None;
        }
        if !scene.layers.iter().any(|l| l.kind.boxes().is_some() || l.kind.triangles().is_some()) {
            return None;
        }
        // Molecules alone have shadows by a light of their own.
        let takes_sun = |kind: &LayerKind| {
            matches!(kind, LayerKind::Boxes(_) | LayerKind::Mesh(_) | LayerKind::Own(_) | LayerKind::Terrain(_))
        };
        if !scene.layers.iter().any(|l| takes_sun(&l.kind)) {
            return None;
        }
        // What something shines through casts its whole shadow. Rays end at the same heights whatever is left out.
        let is_idle = |i: &usize| {
            let kind = &scene.layers[*i].kind;
            kind.triangles().is_some() && Solids::Drawn.of(*i, kind) == LayerPart::Everything && !casts(*i)
        };
        let idle: Vec<usize> = (0..scene.layers.len()).filter(is_idle).collect();
        let bounds = idle.iter().filter_map(|i| Some(scene.layers[*i].kind.triangles()?.mesh.bounds()));
        let obstacles = Obstacles::of_solids_without(scene, Solids::Drawn, &idle);
        let solid = bounds.fold(obstacles.solid_bounds(), |all, mesh| all.union(mesh));
        if solid.is_empty() {
            return None;
        }
        let highest = obstacles.grounds().iter().map(|(_, g)| g.heightfield().z_range()[1]);
        let top = highest.fold(solid.max.z, f64::max);
        let (u, v) = sun.any_orthonormal_pair();
        let buffer = LightBuffer::new(obstacles, [u, v, sun], SUN_RADIUS, pixels);
        Some(Self { buffer, solid, top, sun, across: [SUN_RADIUS * u, SUN_RADIUS * v] })
    }

    /// Share of the sun's disc that boxes and meshes leave visible from a pixel on the ground, 0..=1.
    /// * `axes`: displacement on the map per pixel to the right and per pixel down.
    /// * `throws`: whether a layer, by its index, casts shadows here.
    pub(crate) fn on_ground(&self, p: DVec3, axes: [DVec2; 2], throws: &dyn Fn(usize) -> bool) -> f32 {
        // Early exit: the box of all rays touches no caster.
        let way = self.way(p.z, self.solid.max.z);
        let reach = (axes[0].length() + axes[1].length()) + 2.0 * SUN_RADIUS * way;
        let end = p + way * self.sun;
        let apart = p.min(end) - reach;
        if way <= 0.0 || apart.cmpgt(self.solid.max).any() || (p.max(end) + reach).cmplt(self.solid.min).any() {
            return 1.0;
        }
        let [right, down] = axes.map(|a| a.extend(0.0));
        self.share(p, [right, down], false, throws)
    }

    /// Share of the sun's disc that is visible from a pixel on a surface with a unit normal, 0..=1.
    /// * `side`: side of the square that the pixel covers, scene units; `throws`: see [`Self::on_ground`].
    pub(crate) fn on_surface(&self, p: DVec3, normal: DVec3, side: f64, throws: &dyn Fn(usize) -> bool) -> f32 {
        if normal.dot(self.sun) <= 0.0 {
            return 0.0;
        }
        let (u, v) = normal.any_orthonormal_pair();
        let off = OFF_PX * side + OFF * p.abs().max_element();
        self.share(p + off * normal, [side * u, side * v], true, throws)
    }

    fn share(&self, p: DVec3, axes: [DVec3; 2], over_ground: bool, throws: &dyn Fn(usize) -> bool) -> f32 {
        let throws = &remembered(throws);
        let half = axes.map(|axis| 0.5 * axis);
        let foot = p.z - half[0].z.abs() - half[1].z.abs();
        let length = self.way(foot, if over_ground { self.top } else { self.solid.max.z }).max(0.0);
        let Some(mut found) = self.buffer.around(&Bundle { center: p, half, length }) else {
            return self.share_by_trees(p, axes, over_ground, throws);
        };
        found.retain(|blocker| throws(self.buffer.layer_of(blocker)));
        let over_ground = over_ground && !found.is_over_ground;
        if found.blockers().is_empty() && !over_ground {
            return 1.0;
        }
        share_of(|ray| {
            let (p, sun) = self.ray(p, axes, ray);
            let end = self.end(p, sun, self.solid.max.z);
            // What hides the sun from one ray of a pixel mostly hides it from the next.
            if let Some(k) = found.blockers().iter().position(|blocker| self.buffer.is_met(*blocker, p, end)) {
                found.prefer(k);
                return false;
            }
            !over_ground || self.is_over_grounds(p, sun, throws)
        })
    }

    /// [`Self::share`] without the light buffer: its reference, and for pixels too large for it.
    fn share_by_trees(&self, p: DVec3, axes: [DVec3; 2], over_ground: bool, throws: &dyn Fn(usize) -> bool) -> f32 {
        share_of(|ray| {
            let (p, sun) = self.ray(p, axes, ray);
            let (end, obstacles) = (self.end(p, sun, self.solid.max.z), self.buffer.obstacles());
            obstacles.boxes().near(p, end, 0.0, &mut |shape, _| !throws(shape.layer))
                && obstacles.meshes().iter().all(|(i, tree)| !throws(*i) || !tree.is_crossed(p, end))
                && (!over_ground || self.is_over_grounds(p, sun, throws))
        })
    }

    /// Start and direction of a ray of [`PATTERN`].
    fn ray(&self, p: DVec3, [right, down]: [DVec3; 2], [x, y, u, v]: [f64; 4]) -> (DVec3, DVec3) {
        (p + x * right + y * down, self.sun + u * self.across[0] + v * self.across[1])
    }

    fn is_over_grounds(&self, p: DVec3, sun: DVec3, throws: &dyn Fn(usize) -> bool) -> bool {
        let end = self.end(p, sun, self.top);
        self.buffer.obstacles().grounds().iter().all(|(i, g)| !throws(*i) || g.sees(p, end))
    }

    /// Length of a ray towards the sun from a height to another.
    fn way(&self, z: f64, top: f64) -> f64 {
        (top - z) / self.sun.z
    }

    /// End of a ray at a height.
    fn end(&self, p: DVec3, sun: DVec3, top: f64) -> DVec3 {
        p + self.way(p.z, top).max(0.0) * sun
    }
}

/// Share of the rays of [`PATTERN`] that see the sun.
fn share_of(mut sees: impl FnMut([f64; 4]) -> bool) -> f32 {
    let mut lit = |ray: &[f64; 4]| u32::from(sees(*ray));
    let corners: u32 = PATTERN[..FIRST].iter().map(&mut lit).sum();
    if corners == 0 || corners as usize == FIRST {
        return (corners / FIRST as u32) as f32;
    }
    let rest: u32 = PATTERN[FIRST..].iter().map(&mut lit).sum();
    (corners + rest) as f32 / PATTERN.len() as f32
}

/// A function of the numbers of layers that is called once for each: styling sections take long to tell.
fn remembered(throws: &dyn Fn(usize) -> bool) -> impl Fn(usize) -> bool {
    let (known, held) = (Cell::new(0u64), Cell::new(0u64));
    move |layer| {
        let Some(bit) = 1u64.checked_shl(layer as u32) else { return throws(layer) };
        if known.get() & bit == 0 {
            known.set(known.get() | bit);
            held.set(held.get() | if throws(layer) { bit } else { 0 });
        }
        held.get() & bit != 0
    }
}

#[cfg(test)]
mod tests;

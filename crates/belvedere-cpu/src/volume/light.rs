//! Shading of samples by a headlight along the ray.

/// Ambient light, and diffuse light of a surface perpendicular to the ray.
const AMBIENT: f32 = 0.16;
const DIFFUSE: f32 = 0.84;
/// Light of a sample with a small gradient, where there is no surface.
const INSIDE: f32 = 0.80;
/// Difference in light between normals that point down and up.
const SKY: f32 = 0.12;
/// Highlight.
const SPECULAR: f32 = 0.20;
/// Gradient per voxel edge, as a share of the range of values, at which a sample counts as half a surface.
pub(super) const SURFACE: f32 = 0.012;

/// Factor of the colour, and white added to it.
/// * `cos`: cosine between gradient and ray; `solid`: weight of the surface, 0..=1; `up`: vertical component of the unit normal, -1..=1.
#[inline(always)]
pub(super) fn light(cos: f32, solid: f32, up: f32) -> [f32; 2] {
    let surface = (AMBIENT + DIFFUSE * cos) * (1.0 - SKY + SKY * up);
    let c2 = cos * cos;
    let c8 = c2 * c2 * c2 * c2;
    let c32 = c8 * c8 * c8 * c8;
    [INSIDE + solid * (surface - INSIDE), solid * SPECULAR * c32]
}

//! Shading of samples in light that comes from the eye along the ray.

/// Light that every sample gets, and what a surface across the ray gets besides.
const AMBIENT: f32 = 0.26;
const DIFFUSE: f32 = 0.74;
/// Light of a sample where values change so little that there is no surface.
const INSIDE: f32 = 0.80;
/// How much darker what looks down is than what looks up.
const SKY: f32 = 0.12;
/// Highlight.
const SPECULAR: f32 = 0.20;
/// Change per voxel edge, as a share of the range of values, that makes half a surface.
pub(super) const SURFACE: f32 = 0.012;

/// Factor of the colour, and white added to it.
/// * `cos`: cosine between gradient and ray; `solid`: how much of a surface it is, 0..=1; `up`: upward share of the normal, -1..=1.
#[inline(always)]
pub(super) fn light(cos: f32, solid: f32, up: f32) -> [f32; 2] {
    let surface = (AMBIENT + DIFFUSE * cos) * (1.0 - SKY + SKY * up);
    let c2 = cos * cos;
    let c8 = c2 * c2 * c2 * c2;
    let c32 = c8 * c8 * c8 * c8;
    [INSIDE + solid * (surface - INSIDE), solid * SPECULAR * c32]
}

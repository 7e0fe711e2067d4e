//! Colours as plain numbers, so that loops over nodes become vector instructions.

/// Linear red, green, blue.
pub(super) type Color = [f32; 3];

/// The colour `t` of the way from `a` to `b`.
#[inline(always)]
pub(super) fn mix(a: Color, b: Color, t: f32) -> Color {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])]
}

/// A colour of other lightness.
#[inline(always)]
pub(super) fn times(color: Color, by: f32) -> Color {
    [color[0] * by, color[1] * by, color[2] * by]
}

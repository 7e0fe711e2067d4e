//! Colours of ground before it is lit: hypsometric tints, or materials by rule.

mod canopy;
mod color;
mod fractal;
mod materials;
mod ramps;

use belvedere_core::DVec2;
use belvedere_scene::{Climate, Palette, PaletteName};
use color::Color;
use materials::Materials;
use ramps::RampTint;

/// Colours of the ground of a palette, as pictures show them before they are lit.
#[derive(Debug, Clone)]
pub struct GroundTint(Tint);

#[derive(Debug, Clone)]
enum Tint {
    Ramp(RampTint),
    Materials(Box<Materials>),
}

/// Nodes of ground, value by value.
#[derive(Debug, Clone, Copy)]
pub struct GroundNodes<'a, const N: usize> {
    /// True heights, metres.
    pub height_m: &'a [f32; N],
    /// Rise to the east and to the north, metres per metre.
    pub slope: [&'a [f32; N]; 2],
    /// The same of generalised ground.
    pub broad: [&'a [f32; N]; 2],
    /// Heights over the surroundings, metres.
    pub above_m: &'a [f32; N],
    /// Places on the map, metres east and south of its corner.
    pub at_m: [&'a [f32; N]; 2],
    /// Distance of the nodes, metres: what is smaller than two of them is left out.
    pub spacing_m: f32,
}

/// What covers nodes of ground, value by value.
#[derive(Debug, Clone)]
pub struct GroundCover<const N: usize> {
    /// Linear red, green and blue.
    pub color: [[f32; N]; 3],
    /// Shares of forest, of bare rock, and of snow, 0..=1; 0 in hypsometric tints.
    pub forest: [f32; N],
    /// See `forest`.
    pub bare: [f32; N],
    /// See `forest`.
    pub snow: [f32; N],
    /// Share of water, which is level.
    pub water: [f32; N],
    /// Rise of the crowns of trees to the east and to the north, metres per metre.
    pub crowns: [[f32; N]; 2],
}

impl<const N: usize> GroundCover<N> {
    /// Ground of these colours without forest, rock, snow and water.
    pub fn of_color(color: [[f32; N]; 3]) -> Self {
        Self { color, forest: [0.0; N], bare: [0.0; N], snow: [0.0; N], water: [0.0; N], crowns: [[0.0; N]; 2] }
    }

    #[inline(always)]
    fn at(&self, i: usize) -> Color {
        [self.color[0][i], self.color[1][i], self.color[2][i]]
    }

    #[inline(always)]
    fn put(&mut self, i: usize, color: Color) {
        (self.color[0][i], self.color[1][i], self.color[2][i]) = (color[0], color[1], color[2]);
    }
}

/// A spacing at which no detail is made, metres.
const COARSEST_M: f32 = 1e9;

impl GroundTint {
    /// The colours of a palette.
    ///
    /// * `z_range_m`: heights of the ground.
    pub fn new(palette: &Palette, z_range_m: [f64; 2]) -> Self {
        let materials = match palette {
            Palette::Placed(name, climate, cover) => {
                Materials::of(*name, climate, z_range_m).map(|made| made.over(cover.clone()))
            }
            Palette::Named(name @ (PaletteName::Winter | PaletteName::Autumn)) => {
                Materials::of(*name, &Climate::of_heights(z_range_m), z_range_m)
            }
            Palette::Named(_) | Palette::Ramp(_) => None,
        };
        let ramp = || Tint::Ramp(RampTint::new(palette, z_range_m));
        Self(materials.map_or_else(ramp, |m| Tint::Materials(Box::new(m))))
    }

    /// Whether the ground shows materials by rule, with detail that its data do not have.
    pub fn is_made(&self) -> bool {
        matches!(self.0, Tint::Materials(_))
    }

    /// The climate by which materials lie; `None` in hypsometric tints.
    pub fn climate(&self) -> Option<Climate> {
        match &self.0 {
            Tint::Materials(materials) => Some(materials.climate()),
            Tint::Ramp(_) => None,
        }
    }

    /// Colours and covers of nodes.
    #[inline(always)]
    pub fn cover<const N: usize>(&self, nodes: &GroundNodes<'_, N>) -> GroundCover<N> {
        match &self.0 {
            Tint::Ramp(ramp) => ramp.cover(nodes),
            Tint::Materials(materials) => materials.cover(nodes),
        }
    }

    /// The colour of one point without made detail, linear red, green and blue, 0..=1.
    ///
    /// * `height_m`: true height;
    /// * `slope`: rise to the east and to the north, metres per metre.
    pub fn color(&self, height_m: f64, slope: DVec2) -> [f32; 3] {
        let (height, [x, y]) = ([height_m as f32], slope.as_vec2().to_array().map(|v| [v]));
        let nodes = GroundNodes {
            height_m: &height,
            slope: [&x, &y],
            broad: [&x, &y],
            above_m: &[0.0],
            at_m: [&[0.0]; 2],
            spacing_m: COARSEST_M,
        };
        self.cover(&nodes).color.map(|[v]| v.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests;

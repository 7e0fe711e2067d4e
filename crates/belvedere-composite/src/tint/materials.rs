//! Materials of ground, by land cover where it is given, else by rule: forest, meadow, alpine grass, scree, rock, strata, snow, where a climate has them and the form of the ground
//! allows. What is drawn by rule is no data: pictures say so.
//!
//! The rules are those of panorama painters (Patterson, Niehues, Imhof), the figures ours: forest keeps to slopes under the tree line, to
//! gullies rather than ridges, and climbs higher on the shady side; valley floors are open; rock follows slope; snow follows height,
//! aspect and slope.

use super::canopy::Canopy;
use super::color::{Color, mix, times};
use super::fractal::{fractal, ramp, smooth, turned};
use super::{GroundCover, GroundNodes};
use crate::color::linear;
use crate::noise;
use belvedere_scene::{Climate, Cover, CoverMap, PaletteName};
use std::sync::Arc;

/// Sizes of the noise that frays the borders of materials, metres: the largest; and their number, each half of the one before.
const FRAY_M: f32 = 260.0;
const FRAYS: u32 = 7;
/// Largest size of the noise that frays the borders of land cover, cells.
const FRAYED_CELLS: f32 = 2.0;
/// Patches of wood and of farmland in gentle lowland, metres.
const PATCH_M: f32 = 2600.0;
/// Length of fields, metres, and how much longer they are than wide.
const FIELD_M: f32 = 520.0;
const FIELD_LONG: f32 = 1.6;
/// Share of open ground under the line of trees on which single trees stand.
const SCATTERED: f32 = 0.05;
/// Largest tufts of grass and stones, metres, and the number of sizes.
const TUFT_M: f32 = 22.0;
const TUFTS: u32 = 4;
/// Height over its surroundings that makes a ridge, metres.
const RIDGE_M: f32 = 28.0;
/// Heights between two layers of rock in walls of dry climates, metres.
const LAYERS_M: [f32; 2] = [95.0, 33.0];

/// Lightness that the darkest crowns keep.
const LEAST_TONE: f32 = 0.6;

/// Lightness of crowns, that of clumps, and a value of the crown's own, see [`Canopy`].
type Crown = [f32; 3];

/// Season of the vegetation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Season {
    Summer,
    Autumn,
    Winter,
}

/// Colours of the materials, linear.
#[derive(Debug, Clone)]
struct Colors {
    meadow: Color,
    alpine: Color,
    valley: Color,
    conifers: Color,
    broadleaves: Color,
    scree: Color,
    rock: Color,
    snow: Color,
    water: Color,
    town: Color,
    bog: Color,
    straw: Color,
    soil: [Color; 2],
    strata: [Color; 2],
}

impl Colors {
    fn of(season: Season) -> Self {
        let linear = |srgb| linear(srgb).to_array();
        let summer = Self {
            meadow: linear([136, 150, 94]),
            alpine: linear([170, 162, 122]),
            valley: linear([168, 178, 128]),
            conifers: linear([60, 92, 70]),
            broadleaves: linear([88, 116, 70]),
            scree: linear([188, 174, 152]),
            rock: linear([150, 136, 122]),
            snow: linear([232, 238, 246]),
            water: linear([152, 184, 206]),
            town: linear([172, 162, 156]),
            bog: linear([128, 134, 92]),
            straw: linear([184, 172, 126]),
            soil: [linear([190, 134, 96]), linear([212, 188, 150])],
            strata: [linear([150, 98, 74]), linear([212, 172, 136])],
        };
        match season {
            Season::Summer => summer,
            Season::Autumn => Self {
                meadow: linear([162, 150, 98]),
                alpine: linear([180, 158, 112]),
                valley: linear([176, 168, 120]),
                conifers: linear([64, 80, 56]),
                broadleaves: linear([164, 116, 80]),
                ..summer
            },
            Season::Winter => Self {
                meadow: linear([214, 224, 240]),
                alpine: linear([234, 238, 243]),
                valley: linear([206, 219, 238]),
                conifers: linear([36, 51, 48]),
                broadleaves: linear([62, 59, 56]),
                water: linear([150, 170, 184]),
                bog: linear([176, 172, 160]),
                straw: linear([212, 212, 216]),
                scree: linear([206, 208, 212]),
                rock: linear([118, 114, 114]),
                ..summer
            },
        }
    }
}

/// Materials of a palette at a place.
#[derive(Debug, Clone)]
pub(super) struct Materials {
    colors: Colors,
    climate: Climate,
    tree_line_m: f32,
    snow_line_m: f32,
    /// 0 = humid, 1 = desert.
    dry: f32,
    /// 1 where the sun stands in the south at noon, -1 where in the north, less between the tropics.
    north: f32,
    /// Lowest and highest ground, metres.
    range_m: [f32; 2],
    /// What covers the ground by data.
    land: Option<Arc<CoverMap>>,
}

impl Materials {
    /// The materials of a palette at a place; `None` for palettes that do not depend on it.
    /// * `z_range_m`: heights of the ground.
    pub(super) fn of(name: PaletteName, climate: &Climate, z_range_m: [f64; 2]) -> Option<Self> {
        let season = match name {
            PaletteName::Auto | PaletteName::Swiss => Season::Summer,
            PaletteName::Autumn => Season::Autumn,
            PaletteName::Winter => Season::Winter,
            _ => return None,
        };
        let dry = if name == PaletteName::Swiss { 0.0 } else { climate.dryness as f32 };
        let (tree, snow, winter) = (climate.tree_line_m as f32, climate.snow_line_m as f32, climate.winter() as f32);
        let snow_line_m = match season {
            Season::Summer => snow,
            Season::Autumn => (snow - 350.0 * winter).max(tree + 100.0),
            // Snow lies on all ground of a cold winter, and higher up where it is dry.
            Season::Winter => snow + winter * (tree - 2200.0 - snow) + 1400.0 * dry,
        };
        let sunny = if climate.latitude_deg < 0.0 { -1.0 } else { 1.0 };
        Some(Self {
            colors: Colors::of(season),
            climate: *climate,
            tree_line_m: tree,
            snow_line_m,
            dry,
            north: sunny * (climate.latitude_deg.abs() as f32 / 30.0).min(1.0),
            range_m: [z_range_m[0] as f32, (z_range_m[1] as f32).max(z_range_m[0] as f32 + 1.0)],
            land: None,
        })
    }

    /// The materials where the land cover is known.
    pub(super) fn over(self, land: Option<Arc<CoverMap>>) -> Self {
        Self { land, ..self }
    }

    /// The climate.
    pub(super) fn climate(&self) -> Climate {
        self.climate
    }

    /// Colours and covers of nodes.
    #[inline(always)]
    pub(super) fn cover<const N: usize>(&self, nodes: &GroundNodes<'_, N>) -> GroundCover<N> {
        let fray = fractal(nodes, FRAY_M, FRAYS, 101);
        let patch = fractal(nodes, PATCH_M, 3, 57);
        let fields = fields(nodes);
        let canopy = Canopy::new(nodes);
        let layers = self.layers(nodes, &fray);
        let tufts = fractal(nodes, TUFT_M, TUFTS, 733);
        let mut out = GroundCover::of_color([[0.0; N]; 3]);
        let form = |i: usize| {
            let [x, y] = nodes.slope.map(|s| s[i]);
            [nodes.height_m[i], (x * x + y * y).sqrt(), fray[i], patch[i], layers[i], fields[i]]
        };
        let crown = |i: usize| [canopy.tone[i], canopy.clump[i], canopy.own[i]];
        // One step of short loops after the other: compilers turn these into vector instructions.
        for i in 0..N {
            let [height, steep, ..] = form(i);
            let shady = self.shade(nodes.broad[1][i]);
            let ridge = (nodes.above_m[i] * (1.0 / RIDGE_M)).clamp(-2.0, 2.0);
            let forest = self.forest([height, steep, shady, ridge, fray[i], patch[i], fields[i]]);
            let single = self.single(height, steep, patch[i]);
            out.forest[i] = canopy.covered(i, if forest > single { forest } else { single });
            out.bare[i] = self.bare(height, steep, fray[i]);
            out.snow[i] = self.snow(height, steep, shady, fray[i]);
        }
        for i in 0..N {
            out.put(i, self.color(form(i), out.bare[i], out.forest[i], crown(i)));
        }
        if let Some(land) = &self.land {
            let border = border(land, nodes);
            for i in 0..N {
                match covered(land, nodes.at_m.map(|at| at[i]), [border[0][i], border[1][i]]) {
                    Cover::Unknown => {}
                    cover => self.put_known(cover, form(i), crown(i), i, &mut out),
                }
            }
        }
        for i in 0..N {
            let (forest, bare, snow) = (out.forest[i], out.bare[i], out.snow[i]);
            let tufts = 1.0 + 0.12 * tufts[i] * (1.0 - forest) * (1.0 - out.water[i]);
            out.put(i, times(mix(out.at(i), self.colors.snow, snow * (1.0 - 0.97 * forest)), tufts));
            out.bare[i] = bare * (1.0 - forest);
            out.crowns[0][i] = forest * canopy.rise[0][i];
            out.crowns[1][i] = forest * canopy.rise[1][i];
        }
        out
    }

    /// -1..=1: how much a slope with this rise to the north lies in the shade.
    #[inline(always)]
    fn shade(&self, north: f32) -> f32 {
        -self.north * north / (1.0 + north * north).sqrt()
    }

    /// Share of forest, 0..=1.
    #[inline(always)]
    fn forest(&self, [height, steep, shady, ridge, fray, patch, field]: [f32; 7]) -> f32 {
        let under = (self.tree_line_m - height) * (1.0 / 140.0) + 0.3;
        let under = if under < 1.35 { under } else { 1.35 };
        let likely =
            under - 0.55 * ridge + 1.4 * shady - 0.35 * self.dry * (2.2 - 2.0 * shady) + 0.9 * fray + 0.35 * patch;
        let likely = ramp(likely, 0.2, 0.82);
        // Cliffs carry none, gentle ground is mostly cleared, and so is the lowland.
        let cliff = ramp(steep, 0.95, 0.68);
        let gully = ramp(-ridge, 0.06, 0.4);
        let wood = ramp(patch + 0.3 * fray + 0.5 * gully + 0.3 * field, 0.34, 0.52);
        let slope = ramp(steep, 0.12, 0.26);
        let kept = wood + slope * (1.0 - wood);
        let low = ((height - self.tree_line_m + 1500.0) * (1.0 / 600.0)).clamp(0.0, 1.0);
        let low = low + (1.0 - low) * (0.15 + 0.85 * wood);
        let dry = 1.0 - 0.85 * self.dry * ramp(height, self.tree_line_m, self.tree_line_m - 900.0);
        smooth(likely * cliff * kept * low * dry)
    }

    /// Share of single trees on open ground, 0..=1.
    #[inline(always)]
    fn single(&self, height: f32, steep: f32, patch: f32) -> f32 {
        SCATTERED
            * ramp(height, self.tree_line_m + 60.0, self.tree_line_m - 300.0)
            * ramp(steep, 1.0, 0.7)
            * (1.0 + patch)
    }

    /// Share of rock, 0..=1.
    #[inline(always)]
    fn bare(&self, height: f32, steep: f32, fray: f32) -> f32 {
        let tree = self.tree_line_m;
        let by_slope = ramp(steep + 0.55 * fray + 0.16 * self.dry, 0.52, 0.80);
        let by_height = 0.9 * ramp(height + 400.0 * fray, tree + 600.0, tree + 950.0);
        let bare = if by_slope > by_height { by_slope } else { by_height };
        bare * (1.0 - 0.5 * (1.0 - self.dry) * ramp(height, tree + 200.0, tree - 100.0))
    }

    /// Share of snow, 0..=1.
    #[inline(always)]
    fn snow(&self, height: f32, steep: f32, shady: f32, fray: f32) -> f32 {
        let slides = steep - 0.74;
        let slides = if slides > 0.0 { slides } else { 0.0 };
        smooth(ramp(
            height + 380.0 * fray - 1100.0 * slides + 320.0 * shady,
            self.snow_line_m - 40.0,
            self.snow_line_m + 160.0,
        ))
    }

    /// Colour without snow, linear.
    #[inline(always)]
    fn color(
        &self,
        [height, steep, fray, patch, layer, field]: [f32; 6],
        bare: f32,
        forest: f32,
        [tone, clump, own]: Crown,
    ) -> Color {
        let (c, tree) = (&self.colors, self.tree_line_m);
        let grass = mix(c.meadow, c.alpine, ramp(height + 200.0 * fray, tree - 250.0, tree + 350.0));
        let floor = ramp(steep, 0.15, 0.05) * ramp(height, tree - 150.0, tree - 500.0);
        // Tufts, as trees but fainter.
        let grass = times(mix(grass, self.fields(field, patch), floor), 1.0 + 0.28 * fray + 0.26 * clump);
        let scree = times(c.scree, 1.0 + 0.25 * fray);
        let green = mix(grass, scree, 0.85 * ramp(height + 300.0 * fray, tree + 450.0, tree + 800.0));
        let [low, high] = self.range_m;
        let soil = mix(c.soil[0], c.soil[1], ramp(height, low, high));
        // High above trees dry ground is grey, too.
        let grey = 0.75 * ramp(height, tree - 400.0, tree + 500.0);
        let soil = mix(times(soil, 1.0 + 0.25 * fray + 0.10 * layer), scree, grey);
        let open = mix(green, soil, self.dry);
        let walls = mix(mix(c.strata[0], c.strata[1], 0.5 + 0.5 * layer), c.rock, grey);
        let rock = times(mix(c.rock, walls, self.dry), 1.0 + 0.35 * fray + 0.12 * layer * (1.0 - self.dry));
        let ground = mix(open, rock, bare);
        // Broadleaves below, conifers above, mixed between.
        let up = ramp(height + 380.0 * patch + 120.0 * fray, tree - 1000.0, tree - 350.0);
        let kind = (0.25 + 0.75 * up + 0.22 * own).clamp(0.0, 1.0);
        let tone = tone * (1.0 + 0.12 * own);
        let trees = times(mix(c.broadleaves, c.conifers, kind), if tone > LEAST_TONE { tone } else { LEAST_TONE });
        mix(ground, trees, 0.94 * forest)
    }

    /// Colour of farmland: meadows, green and dry crops, ploughed land, each field one of them.
    #[inline(always)]
    fn fields(&self, field: f32, patch: f32) -> Color {
        let c = &self.colors;
        let fields = mix(c.valley, c.meadow, ramp(field + 0.5 * patch, -0.6, 0.2));
        let fields = mix(fields, c.straw, 0.7 * ramp(field - 0.3 * patch, 0.42, 0.5));
        mix(fields, c.soil[1], 0.4 * ramp(field, -0.76, -0.84))
    }

    /// Puts the colour without snow and the shares of forest, rock, snow and water of a node whose land cover is known.
    ///
    /// * `out`: has these shares as the rules have them.
    fn put_known<const N: usize>(
        &self,
        cover: Cover,
        form: [f32; 6],
        crown: Crown,
        i: usize,
        out: &mut GroundCover<N>,
    ) {
        let (c, [_, _, fray, patch, _, field], [tone, ..]) = (&self.colors, form, crown);
        let (bare, snow) = (out.bare[i], out.snow[i]);
        let ground = |bare, forest| self.color(form, bare, forest, crown);
        let (color, [forest, bare, snow]) = match cover {
            Cover::Unknown => return,
            Cover::Forest => (ground(0.0, 1.0), [1.0, 0.0, snow]),
            Cover::Shrubs => {
                let shrubs = times(mix(c.meadow, c.broadleaves, 0.6), (0.3 + 0.7 * tone).max(LEAST_TONE));
                (mix(ground(0.5 * bare, 0.0), shrubs, 0.6), [0.3, 0.5 * bare, snow])
            }
            Cover::Grass => (ground(0.35 * bare, 0.0), [0.0, 0.35 * bare, snow]),
            Cover::Fields => (times(self.fields(field, patch), 1.0 + 0.14 * fray), [0.0, 0.0, snow]),
            Cover::BuiltUp => (times(c.town, 0.7 + 0.18 * fray + 0.3 * tone), [0.0, 0.0, snow]),
            Cover::Bare => {
                let rock = bare.max(0.25 + 0.5 * fray).clamp(0.0, 1.0);
                (mix(ground(1.0, 0.0), times(c.scree, 1.0 + 0.25 * fray), 1.0 - rock), [0.0, rock, snow])
            }
            Cover::Ice => (c.snow, [0.0, 0.0, 1.0]),
            Cover::Water => (c.water, [0.0; 3]),
            Cover::Wetland => (times(c.bog, 1.0 + 0.25 * fray), [0.0, 0.0, snow]),
        };
        out.put(i, color);
        (out.forest[i], out.bare[i], out.snow[i]) = (forest, bare, snow);
        out.water[i] = f32::from(u8::from(matches!(cover, Cover::Water)));
    }

    /// Layers of rock by height, -1..=1, left out where they would be thinner than two nodes.
    #[inline(always)]
    fn layers<const N: usize>(&self, nodes: &GroundNodes<'_, N>, fray: &[f32; N]) -> [f32; N] {
        let mut out = [0.0; N];
        for (k, size) in LAYERS_M.into_iter().enumerate() {
            for i in 0..N {
                let [x, y] = nodes.slope.map(|s| s[i]);
                let rise = (x * x + y * y).sqrt() * nodes.spacing_m;
                let shown = (size / (2.0 * rise + 1e-3) - 0.5).clamp(0.0, 1.0);
                let at = (nodes.height_m[i] + 14.0 * fray[i]) / size;
                let below = noise::floor(at);
                let share = at - below as f32;
                let (a, b) = (noise::hash(below, k as i32, 11), noise::hash(below.wrapping_add(1), k as i32, 11));
                // Steps with soft edges.
                out[i] += 0.55 * shown * (a + ramp(share, 0.35, 0.65) * (b - a));
            }
        }
        out
    }
}

/// A pseudo-random value of the field at nodes, -1..=1; 0 where fields would be of few nodes.
#[inline(always)]
fn fields<const N: usize>(nodes: &GroundNodes<'_, N>) -> [f32; N] {
    let shown = (FIELD_M / (3.0 * nodes.spacing_m) - 0.5).clamp(0.0, 1.0);
    if shown == 0.0 {
        return [0.0; N];
    }
    let [x, y] = turned(nodes, FIELD_M, 1);
    noise::domes([&x, &y.map(|v| FIELD_LONG * v)], 887).own.map(|own| shown * own)
}

/// Noise that frays the borders of cells, to the east and to the south. It is as fine as the cells, so that no lake moves as a whole.
#[inline(always)]
fn border<const N: usize>(land: &CoverMap, nodes: &GroundNodes<'_, N>) -> [[f32; N]; 2] {
    [0, 1].map(|axis| fractal(nodes, FRAYED_CELLS * land.spacing[axis], 2, 211 + 40 * axis as u32))
}

/// The class at a place, with borders that are frayed by half a cell, so that its cells do not show as stairs.
#[inline(always)]
fn covered(land: &CoverMap, at: [f32; 2], border: [f32; 2]) -> Cover {
    land.at([0, 1].map(|axis| at[axis] + border[axis].clamp(-0.6, 0.6) * land.spacing[axis]))
}

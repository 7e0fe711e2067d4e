//! Transfer functions by name, and the one that a volume's own values suggest.

use super::histogram::{BINS, counts, otsu, thin};
use super::{TransferFunction, TransferPoint, Volume};
use crate::Color;

/// Names that [`TransferFunction::named`] knows.
pub const TRANSFER_NAMES: &[&str] = &["auto", "solid", "engine", "ct-bone", "ct-soft", "vessels", "grey", SLICE];

/// Name of the function for cuts: grey levels, opaque, so that what the cut meets is seen.
pub const SLICE: &str = "slice";
/// Depth within which a cut absorbs all light, voxel edges.
const SLICE_DEPTH: f64 = 0.01;

/// Name of the function that draws the wall of a vessel alone, which a path preview fits to its path: [`TransferFunction::wall`].
pub const WALL: &str = "wall";
/// Its colour, and from the isovalue on the share of the step from lumen to wall over which it becomes opaque.
const WALL_COLOR: Color = Color::rgb(222, 152, 130);
const WALL_RAMP: f64 = 0.25;

/// Share of the range of values, colour, opacity per voxel edge.
type Stop = (f64, [u8; 3], f64);

/// Machined metal: everything that is dense, opaque.
const SOLID: &[Stop] = &[
    (0.0, [120, 128, 140], 0.0),
    (0.22, [120, 128, 140], 0.0),
    (0.32, [168, 176, 188], 0.55),
    (0.52, [196, 200, 206], 0.85),
    (0.66, [214, 150, 74], 0.95),
    (0.85, [240, 186, 96], 1.0),
    (1.0, [255, 232, 190], 1.0),
];
/// A translucent housing around denser, opaque parts.
const ENGINE: &[Stop] = &[
    (0.0, [130, 146, 168], 0.0),
    (0.24, [130, 146, 168], 0.0),
    (0.34, [150, 168, 192], 0.035),
    (0.52, [176, 190, 208], 0.05),
    (0.62, [206, 160, 104], 0.12),
    (0.72, [222, 128, 48], 0.7),
    (0.86, [246, 178, 78], 0.95),
    (1.0, [255, 236, 196], 1.0),
];
/// Bones, and faintly the vessels filled with contrast medium.
const CT_BONE: &[Stop] = &[
    (0.0, [0, 0, 0], 0.0),
    (0.42, [172, 96, 76], 0.0),
    (0.48, [196, 112, 88], 0.015),
    (0.54, [224, 178, 140], 0.12),
    (0.62, [240, 224, 196], 0.6),
    (0.85, [252, 246, 230], 0.9),
    (1.0, [255, 255, 250], 1.0),
];
/// Skin and organs.
const CT_SOFT: &[Stop] = &[
    (0.0, [0, 0, 0], 0.0),
    (0.14, [196, 124, 100], 0.0),
    (0.24, [214, 150, 124], 0.06),
    (0.36, [206, 110, 90], 0.16),
    (0.50, [186, 70, 60], 0.28),
    (0.66, [240, 218, 184], 0.7),
    (1.0, [255, 252, 240], 1.0),
];
/// Bright vessels in dark tissue, as angiograms show them.
const VESSELS: &[Stop] = &[
    (0.0, [40, 6, 10], 0.0),
    (0.13, [120, 20, 24], 0.0),
    (0.24, [176, 36, 34], 0.35),
    (0.45, [214, 66, 48], 0.8),
    (0.75, [244, 138, 92], 1.0),
    (1.0, [255, 214, 170], 1.0),
];
/// Grey levels: greater values are lighter and more opaque.
const GREY: &[Stop] =
    &[(0.0, [0, 0, 0], 0.0), (0.12, [50, 50, 50], 0.0), (0.5, [150, 150, 150], 0.05), (1.0, [255, 255, 255], 0.30)];

/// Grey levels, opaque.
const LEVELS: &[Stop] = &[(0.0, [0, 0, 0], 1.0), (1.0, [255, 255, 255], 1.0)];

/// Window of the CT functions over values in Hounsfield units (air -1000, water 0): that of bone.
const HOUNSFIELD: [f64; 2] = [-450.0, 1050.0];
/// A volume whose values reach below and above these is in Hounsfield units.
const AIR_TO_BONE: [f32; 2] = [-500.0, 500.0];

/// Share of light that matter of low values absorbs along a ray that meets as much of it as the mean one.
const VEIL: f64 = 0.4;
/// Its greatest opacity per voxel edge.
const LEAF: f64 = 0.4;
/// Colour of such matter.
const LEAF_COLOR: [u8; 3] = [156, 168, 150];
/// Share of light that a volume of one value absorbs along its shortest side.
const BLOCK: f64 = 0.5;

impl TransferFunction {
    /// A function by its name, fitted to the range of a volume's values, and those of CT to Hounsfield units where values are such;
    /// `None` if there is no such name, see [`TRANSFER_NAMES`].
    pub fn named(name: &str, volume: &Volume) -> Option<Self> {
        let stops = match name {
            "auto" => return Some(Self::auto(volume)),
            "solid" => SOLID,
            "engine" => ENGINE,
            "ct-bone" => CT_BONE,
            "ct-soft" => CT_SOFT,
            "vessels" => VESSELS,
            "grey" => GREY,
            SLICE => LEVELS,
            _ => return None,
        };
        if volume.is_constant() {
            return Some(Self::block(name, volume));
        }
        let [lo, hi] = volume.range();
        let is_hounsfield = lo < AIR_TO_BONE[0] && hi > AIR_TO_BONE[1];
        let range = if (name.starts_with("ct-") || name == SLICE) && is_hounsfield {
            HOUNSFIELD
        } else {
            [lo, hi].map(f64::from)
        };
        let made = of_stops(name, stops, range);
        Some(if name == SLICE { made.with_reference_step(SLICE_DEPTH) } else { made })
    }

    /// The wall of a vessel alone, as it is seen from within: values on the side of the lumen are clear, all others opaque, so that the
    /// wall hides everything behind it. The function has the name [`WALL`]. Ours.
    ///
    /// * `lumen`, `isovalue`, `wall`: values in the vessel, at its border and in the wall; ascending or descending, finite.
    pub fn wall(lumen: f64, isovalue: f64, wall: f64) -> Self {
        let point = |value, opacity| TransferPoint { value, color: WALL_COLOR, opacity };
        let (clear, dense) = (point(isovalue, 0.0), point(isovalue + WALL_RAMP * (wall - lumen), 1.0));
        Self::trusted(WALL, if wall > lumen { vec![clear, dense] } else { vec![dense, clear] })
    }

    /// A function derived from the histogram: the background is clear, all dense values are solid. Dense values begin at the threshold
    /// that parts all into two classes of the least variance within (Otsu 1979); denser parts differ in colour. Matter of lower values
    /// that is no border of dense matter, such as leaves beside stems, is shown as well: the more there is of it, the more light it lets
    /// through. A volume of one value is a translucent block.
    pub fn auto(volume: &Volume) -> Self {
        if volume.is_constant() {
            return Self::block("auto", volume);
        }
        let range = volume.range().map(f64::from);
        let counts = counts(volume);
        let dense = otsu(&counts.map(|n| n as f64));
        let threshold = dense as f64 / BINS as f64;
        let rest = 1.0 - threshold;
        let mut stops = vec![(0.0, [120, 128, 140], 0.0)];
        match thin(volume, &counts, dense) {
            Some(thin) => {
                let length = volume.dims().iter().sum::<usize>() as f64 / 3.0;
                // Rays meet about this much of it, voxel edges.
                let met = (thin.share * length).max(f64::MIN_POSITIVE);
                let opacity = (1.0 - (1.0 - VEIL).powf(1.0 / met)).min(LEAF);
                let from = thin.from as f64 / BINS as f64;
                let full = (from + 0.15 * (threshold - from)).min(threshold * 0.9);
                stops.extend([(from, LEAF_COLOR, 0.0), (full, LEAF_COLOR, opacity)]);
                stops.push((0.9 * threshold + 0.1 * full, LEAF_COLOR, opacity));
            }
            None => stops.push((threshold * 0.9, [120, 128, 140], 0.0)),
        }
        stops.extend([
            (threshold + 0.04 * rest, [166, 174, 186], 0.45),
            (threshold + 0.35 * rest, [206, 206, 204], 0.8),
            (threshold + 0.60 * rest, [226, 164, 88], 0.95),
            (1.0, [255, 232, 190], 1.0),
        ]);
        of_stops("auto", &stops, range)
    }

    /// A volume of one value as a translucent block.
    fn block(name: &str, volume: &Volume) -> Self {
        let shortest = volume.dims().into_iter().min().map_or(1, |n| n.max(2) - 1);
        let opacity = 1.0 - (1.0 - BLOCK).powf(1.0 / shortest as f64);
        let color = Color::rgb(168, 176, 188);
        Self::trusted(name, vec![TransferPoint { value: f64::from(volume.range()[0]), color, opacity }])
    }
}

/// The value that parts a volume's values into background and foreground (Otsu 1979).
pub fn threshold(volume: &Volume) -> f64 {
    let [lo, hi] = volume.range().map(f64::from);
    lo + threshold_share(volume) * (hi - lo)
}

fn threshold_share(volume: &Volume) -> f64 {
    otsu(&counts(volume).map(|n| n as f64)) as f64 / BINS as f64
}

fn of_stops(name: &str, stops: &[Stop], [lo, hi]: [f64; 2]) -> TransferFunction {
    let points = stops.iter().map(|&(share, [r, g, b], opacity)| TransferPoint {
        value: lo + share * (hi - lo),
        color: Color::rgb(r, g, b),
        opacity,
    });
    TransferFunction::trusted(name, points.collect())
}

#[cfg(test)]
mod tests;

//! Transfer functions by name, and the one that a volume's own values suggest.

use super::histogram::{BINS, counts, otsu, thin};
use super::{TransferFunction, TransferPoint, Volume};
use crate::Color;

/// Names that [`TransferFunction::named`] knows.
pub const TRANSFER_NAMES: &[&str] = &["auto", "solid", "engine", "ct-bone", "ct-soft", "vessels", "grey"];

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
            _ => return None,
        };
        if volume.is_constant() {
            return Some(Self::block(name, volume));
        }
        let [lo, hi] = volume.range();
        let is_hounsfield = lo < AIR_TO_BONE[0] && hi > AIR_TO_BONE[1];
        let range = if name.starts_with("ct-") && is_hounsfield { HOUNSFIELD } else { [lo, hi].map(f64::from) };
        Some(of_stops(name, stops, range))
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
mod tests {
    use super::*;
    use crate::VoxelValues;
    use belvedere_core::{DMat3, DVec3};

    fn volume(values: Vec<u8>) -> Volume {
        Volume::new([16, 16, 16], DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(values)).unwrap()
    }

    #[test]
    fn every_name_is_a_function_over_the_range() {
        let volume = volume((0..4096u32).map(|i| (20 + i % 100) as u8).collect());
        for name in TRANSFER_NAMES {
            let f = TransferFunction::named(name, &volume).unwrap();
            assert_eq!((f.name(), f.at(20.0)[3]), (*name, 0.0));
            assert!(f.at(119.0)[3] > 0.25, "{name}");
        }
        assert_eq!(TransferFunction::named("bone", &volume), None);
    }

    #[test]
    fn the_background_is_left_out() {
        // Noise around 30, a ball of about 140.
        let values = (0..4096i64).map(|i| {
            let [x, y, z] = [i % 16, i / 16 % 16, i / 256].map(|v| v - 8);
            let noise = i * 7919 % 13;
            (if x * x + y * y + z * z < 36 { 140 + noise } else { 24 + noise }) as u8
        });
        let f = TransferFunction::auto(&volume(values.collect()));
        assert!(f.at(36.0)[3] < 0.01 && f.at(140.0)[3] > 0.5, "{f:?}");
    }

    /// A dense stem, thin leaves of low values beside it, and noise.
    fn tree(leaves: bool) -> Volume {
        let n = 40usize;
        let value = |i: usize| {
            let [x, y, z] = [i % n, i / n % n, i / n / n].map(|v| v as f64 - 20.0);
            let noise = (i * 7919 % 13) as f64 - 6.0;
            let stem = x.hypot(y) < 4.0;
            let leaf = leaves && z.rem_euclid(10.0) < 2.0 && (x - 12.0).hypot(y) < 6.0;
            (12.0
                + noise
                + if stem {
                    180.0
                } else if leaf {
                    45.0
                } else {
                    0.0
                }) as u8
        };
        let values = VoxelValues::U8((0..n * n * n).map(value).collect());
        Volume::new([n; 3], DMat3::IDENTITY, DVec3::ZERO, values).unwrap()
    }

    #[test]
    fn leaves_are_shown_as_well_as_stems() {
        let f = TransferFunction::auto(&tree(true));
        assert!(f.at(18.0)[3] == 0.0 && f.at(57.0)[3] > 0.15 && f.at(190.0)[3] > 0.7, "{f:?}");
        // Without them, low values are borders of the stem, and stay clear.
        let f = TransferFunction::auto(&tree(false));
        assert!(f.at(57.0)[3] == 0.0 && f.at(190.0)[3] > 0.7, "{f:?}");
    }

    #[test]
    fn hounsfield_units_are_shown_as_such_however_far_they_reach() {
        let of = |most: i16| {
            let values = (0..4096).map(|i| if i == 0 { most } else { -1024 + (i % 2000) as i16 }).collect();
            let volume = Volume::new([16; 3], DMat3::IDENTITY, DVec3::ZERO, VoxelValues::I16(values)).unwrap();
            TransferFunction::named("ct-bone", &volume).unwrap()
        };
        // Muscle is clear, bone is not; metal changes nothing.
        assert!(of(1200).at(60.0)[3] == 0.0 && of(1200).at(500.0)[3] > 0.4);
        assert_eq!(of(1200), of(32000));
    }

    #[test]
    fn a_wall_is_opaque_and_its_lumen_clear_on_either_side() {
        for (lumen, wall) in [(-1000.0, 40.0), (300.0, 50.0)] {
            let f = TransferFunction::wall(lumen, 0.5 * (lumen + wall), wall);
            let at = |share: f64| f.at(lumen + share * (wall - lumen))[3];
            assert_eq!([at(-9.0), at(0.0), at(0.5), at(0.76), at(1.0), at(9.0)], [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
            assert!(at(0.55) > 0.1, "{f:?}");
        }
    }

    #[test]
    fn one_value_alone_is_a_translucent_block() {
        let block = volume(vec![9; 4096]);
        for name in TRANSFER_NAMES {
            let f = TransferFunction::named(name, &block).unwrap();
            assert!((1.0 - (1.0 - f.at(9.0)[3]).powi(15) - BLOCK).abs() < 1e-12 && f.name() == *name);
        }
    }
}

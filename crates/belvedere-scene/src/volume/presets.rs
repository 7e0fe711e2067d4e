//! Transfer functions by name, and the one that a volume's own values suggest.

use super::{TransferFunction, TransferPoint, Volume, VoxelValues};
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

/// Bins of the histogram.
const BINS: usize = 256;
/// About the largest number of voxels that are counted.
const COUNTED: usize = 1 << 21;

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

    /// A function derived from the histogram: the background is clear, all denser values are solid. The background ends at
    /// the threshold that parts the values into two classes of the least variance within (Otsu 1979); denser parts differ in colour.
    pub fn auto(volume: &Volume) -> Self {
        let range = volume.range().map(f64::from);
        let threshold = threshold_share(volume);
        let rest = 1.0 - threshold;
        let stops = [
            (0.0, [120, 128, 140], 0.0),
            (threshold * 0.9, [120, 128, 140], 0.0),
            (threshold + 0.04 * rest, [166, 174, 186], 0.45),
            (threshold + 0.35 * rest, [206, 206, 204], 0.8),
            (threshold + 0.60 * rest, [226, 164, 88], 0.95),
            (1.0, [255, 232, 190], 1.0),
        ];
        of_stops("auto", &stops, range)
    }
}

/// The value that parts a volume's values into background and foreground (Otsu 1979).
pub fn threshold(volume: &Volume) -> f64 {
    let [lo, hi] = volume.range().map(f64::from);
    lo + threshold_share(volume) * (hi - lo)
}

fn threshold_share(volume: &Volume) -> f64 {
    otsu(&histogram(volume)) as f64 / BINS as f64
}

fn of_stops(name: &str, stops: &[Stop], [lo, hi]: [f64; 2]) -> TransferFunction {
    let points = stops.iter().map(|&(share, [r, g, b], opacity)| TransferPoint {
        value: lo + share * (hi - lo),
        color: Color::rgb(r, g, b),
        opacity,
    });
    TransferFunction::trusted(name, points.collect())
}

/// Counts of values by equal shares of their range, of every n-th voxel.
fn histogram(volume: &Volume) -> [u64; BINS] {
    let [lo, hi] = volume.range();
    let scale = if hi > lo { BINS as f32 / (hi - lo) } else { 0.0 };
    // An odd stride does not stay on one column of voxels.
    let stride = (volume.values().len() / COUNTED).max(1) | 1;
    let mut counts = [0; BINS];
    let mut count = |v: f32| counts[(((v - lo) * scale) as usize).min(BINS - 1)] += 1;
    match volume.values() {
        VoxelValues::U8(v) => v.iter().step_by(stride).for_each(|v| count(f32::from(*v))),
        VoxelValues::U16(v) => v.iter().step_by(stride).for_each(|v| count(f32::from(*v))),
        VoxelValues::I16(v) => v.iter().step_by(stride).for_each(|v| count(f32::from(*v))),
        VoxelValues::F32(v) => v.iter().step_by(stride).for_each(|v| count(*v)),
    }
    counts
}

/// First bin of the upper class. Source: Otsu 1979, "A threshold selection method from gray-level histograms".
fn otsu(counts: &[u64; BINS]) -> usize {
    let total: f64 = counts.iter().sum::<u64>() as f64;
    let moment = |range: std::ops::Range<usize>| range.map(|i| i as f64 * counts[i] as f64).sum::<f64>();
    let all = moment(0..BINS);
    let (mut below, mut sum) = (0.0, 0.0);
    // Empty bins have equal variance: the middle of the best bins is taken.
    let (mut best, mut first, mut last) = (0.0, BINS / 2, BINS / 2);
    for (i, count) in counts.iter().enumerate().take(BINS - 1) {
        below += *count as f64;
        sum += i as f64 * *count as f64;
        let above = total - below;
        if below == 0.0 || above == 0.0 {
            continue;
        }
        let apart = sum / below - (all - sum) / above;
        let between = below * above * apart * apart;
        if between > best * (1.0 + 1e-12) {
            (best, first, last) = (between, i + 1, i + 1);
        } else if between >= best * (1.0 - 1e-12) {
            last = i + 1;
        }
    }
    (first + last) / 2
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn one_value_alone_is_no_failure() {
        for name in TRANSFER_NAMES {
            assert!(TransferFunction::named(name, &volume(vec![9; 4096])).is_some());
        }
    }
}

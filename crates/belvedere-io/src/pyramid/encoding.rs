//! Heights in the colours of a pixel: terrain-RGB and Terrarium.
//!
//! Sources: Mapbox, "Mapbox Terrain-RGB v1"; Mapzen, "Terrain Tiles, data formats".

use super::picture::Picture;
use belvedere_core::{Warning, WarningKind};

/// Heights, metres, that there are on the Earth, with the sea floor.
const HEIGHTS_M: [f32; 2] = [-12_000.0, 9_000.0];
/// Least share of the pixels with such a height; tiles are made of data with voids, too.
const LEAST_SHARE: f64 = 0.9;
/// Largest mean difference of pixels side by side, metres: coarser ground than that of one tile for the whole Earth has less.
const MOST_STEP_M: f64 = 1000.0;

/// How a colour stands for a height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Terrain-RGB of Mapbox: -10000 m + 0.1 m (65536 R + 256 G + B).
    Mapbox,
    /// Terrarium: 256 R + G + B / 256 - 32768 m.
    Terrarium,
}

/// What the pixels of some tiles are under an encoding.
struct Judged {
    /// Share of the pixels with a height that there is, 0..=1; of no pixels 1.
    share: f64,
    /// Mean difference of pixels side by side, metres.
    step_m: f64,
}

impl Judged {
    fn is_plausible(&self) -> bool {
        self.share >= LEAST_SHARE && self.step_m <= MOST_STEP_M
    }
}

impl Encoding {
    /// By the name in metadata.
    fn named(name: &str) -> Option<Self> {
        match name.trim().to_ascii_lowercase().as_str() {
            "mapbox" | "terrain-rgb" | "terrainrgb" | "mapbox-terrain-rgb" => Some(Self::Mapbox),
            "terrarium" => Some(Self::Terrarium),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Mapbox => "terrain-RGB (Mapbox)",
            Self::Terrarium => "Terrarium",
        }
    }

    /// Metres, NaN where a pixel is transparent, or black, which stands for no data, and for heights that there are not on the Earth.
    pub(super) fn height(self, [r, g, b, a]: [u8; 4]) -> f32 {
        let [r, g, b] = [r, g, b].map(f64::from);
        if a == 0 || r + g + b == 0.0 {
            return f32::NAN;
        }
        let height = match self {
            Self::Mapbox => 0.1 * (65_536.0 * r + 256.0 * g + b) - 10_000.0,
            Self::Terrarium => 256.0 * r + g + b / 256.0 - 32_768.0,
        };
        Some(height as f32).filter(|h| (HEIGHTS_M[0]..=HEIGHTS_M[1]).contains(h)).unwrap_or(f32::NAN)
    }

    fn judged(self, tiles: &[Picture]) -> Judged {
        let (mut known, mut there, mut steps, mut sum) = (0usize, 0usize, 0usize, 0.0);
        for tile in tiles {
            for row in tile.pixels.chunks(tile.side) {
                let heights: Vec<f32> = row.iter().map(|pixel| self.height(*pixel)).collect();
                known += row.iter().filter(|pixel| pixel[3] > 0 && pixel[..3] != [0; 3]).count();
                there += heights.iter().filter(|h| h.is_finite()).count();
                for step in heights.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| step.is_finite()) {
                    (steps, sum) = (steps + 1, sum + f64::from(step.abs()));
                }
            }
        }
        let share = if known == 0 { 1.0 } else { there as f64 / known as f64 };
        Judged { share, step_m: sum / steps.max(1) as f64 }
    }

    /// The encoding of some tiles, and what is said of it unless it is stated and fits: the stated one, or the one whose heights there
    /// are on the Earth, or the smoother of both.
    ///
    /// # Errors
    /// A predicate for pictures that are no heights.
    pub(super) fn of(stated: Option<&str>, tiles: &[Picture]) -> Result<(Self, Option<Warning>), String> {
        let named = stated.and_then(Self::named);
        let both = [Self::Mapbox, Self::Terrarium].map(|encoding| (encoding, encoding.judged(tiles)));
        let fitting = both.iter().filter(|(_, judged)| judged.is_plausible());
        let best = fitting.min_by(|a, b| a.1.step_m.total_cmp(&b.1.step_m));
        let agrees = |named: &Self| both.iter().any(|(one, judged)| one == named && judged.is_plausible());
        let why = match (named.filter(agrees), stated) {
            (Some(named), _) => return Ok((named, None)),
            (None, Some(stated)) => format!("its metadata state the encoding {stated:?}, which does not fit"),
            (None, None) => "nothing states how its tiles hold heights".to_owned(),
        };
        let Some((encoding, judged)) = best else {
            return Err("holds tiles of pictures, not of heights (neither terrain-RGB nor Terrarium fits); gdal_translate turns them into a GeoTIFF, which is drawn over terrain as a drape".into());
        };
        let text = format!(
            "{why}; they are read as {}, by which {:.1} % of the pixels lie between {} and {} m and neighbours differ by {:.1} m",
            encoding.name(),
            100.0 * judged.share,
            HEIGHTS_M[0],
            HEIGHTS_M[1],
            judged.step_m
        );
        let warning = Warning::new(WarningKind::Assumed, text).with("share", judged.share);
        Ok((*encoding, Some(warning.with("step_m", judged.step_m))))
    }
}

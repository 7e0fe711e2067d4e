//! Colours of categories and of numbers.

use crate::scene_file::ScaleName;
use belvedere_scene::Color;

/// Colours of categories that people with any usual colour vision tell apart (Okabe and Ito 2008), without black, which is left to texts.
pub const CATEGORIES: [Color; 7] = [
    Color::rgb(230, 159, 0),
    Color::rgb(86, 180, 233),
    Color::rgb(0, 158, 115),
    Color::rgb(213, 94, 0),
    Color::rgb(0, 114, 178),
    Color::rgb(204, 121, 167),
    Color::rgb(240, 228, 66),
];

/// Every scale with its name in scene files.
pub const SCALES: [(&str, ScaleName); 6] = [
    ("viridis", ScaleName::Viridis),
    ("cividis", ScaleName::Cividis),
    ("blues", ScaleName::Blues),
    ("greens", ScaleName::Greens),
    ("oranges", ScaleName::Oranges),
    ("blue_red", ScaleName::BlueRed),
];

impl ScaleName {
    /// The colour at a share of the scale, clamped to 0..=1. Sources: viridis and cividis (Smith, van der Walt; Nuñez, Anderton, Renslow)
    /// at five places, the others after ColorBrewer (Brewer); between the places linear in sRGB.
    pub fn color_at(self, share: f64) -> Color {
        let stops: [u32; 5] = match self {
            Self::Viridis => [0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725],
            Self::Cividis => [0x00224e, 0x434e6c, 0x7d7c78, 0xbcaf6f, 0xfee838],
            Self::Blues => [0xeff3ff, 0xbdd7e7, 0x6baed6, 0x3182bd, 0x08519c],
            Self::Greens => [0xedf8e9, 0xbae4b3, 0x74c476, 0x31a354, 0x006d2c],
            Self::Oranges => [0xfeedde, 0xfdbe85, 0xfd8d3c, 0xe6550d, 0xa63603],
            Self::BlueRed => [0x2166ac, 0x67a9cf, 0xf7f7f7, 0xef8a62, 0xb2182b],
        };
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        let at = share * (stops.len() - 1) as f64;
        let i = (at as usize).min(stops.len() - 2);
        let part = |shift: u32| {
            let [a, b] = [stops[i], stops[i + 1]].map(|stop| f64::from(stop >> shift & 255));
            (a + (at - i as f64) * (b - a)).round() as u8
        };
        Color::rgb(part(16), part(8), part(0))
    }
}

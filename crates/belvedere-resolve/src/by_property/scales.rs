//! Colours of categories and of numbers.

use belvedere_document::ScaleName;
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

#[cfg(test)]
mod tests;

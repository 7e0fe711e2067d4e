//! Colours of our own on the window's background, which is light or dark.

use eframe::egui::Color32;

/// An error, a finished action, a hint.
pub(crate) const PROBLEM: Color32 = Color32::from_rgb(180, 52, 34);
pub(crate) const DONE: Color32 = Color32::from_rgb(34, 110, 72);
pub(crate) const NOTE: Color32 = Color32::from_rgb(46, 104, 172);
/// The camera, and what is chosen.
pub(crate) const CAMERA: Color32 = Color32::from_rgb(30, 96, 170);
pub(crate) const CHOSEN: Color32 = Color32::from_rgb(176, 84, 4);
/// Share of white that makes these colours readable on a dark background.
const LIFT: f32 = 0.5;

/// A colour for a light background as it is read on the background that there is.
pub(crate) fn readable(color: Color32, is_dark: bool) -> Color32 {
    if is_dark { color.lerp_to_gamma(Color32::WHITE, LIFT) } else { color }
}

/// The place of a picture that is not there yet, under words in the colour of a button.
pub(crate) fn blank(is_dark: bool) -> Color32 {
    Color32::from_gray(if is_dark { 58 } else { 216 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Visuals;

    /// Luminance by the Web Content Accessibility Guidelines 2.
    fn luminance(color: Color32) -> f64 {
        let linear = |c: u8| match f64::from(c) / 255.0 {
            c if c <= 0.04045 => c / 12.92,
            c => ((c + 0.055) / 1.055).powf(2.4),
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn words_in_our_colours_are_read_on_light_and_on_dark() {
        for (is_dark, visuals) in [(false, Visuals::light()), (true, Visuals::dark())] {
            for color in [PROBLEM, DONE, NOTE, CAMERA, CHOSEN] {
                for background in [visuals.window_fill, visuals.panel_fill] {
                    let seen = contrast(readable(color, is_dark), background);
                    assert!(seen >= 4.5, "{color:?} on {background:?}: {seen:.1}");
                }
            }
            let words = visuals.widgets.inactive.fg_stroke.color;
            let seen = contrast(words, blank(is_dark));
            assert!(seen >= 4.5, "{words:?} on {:?}: {seen:.1}", blank(is_dark));
        }
    }
}

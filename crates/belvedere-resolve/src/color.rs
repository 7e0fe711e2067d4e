//! Colours as scene files write them.

/// A key and the reason why its value is refused.
pub type Complaint = (&'static str, String);

/// Parses `#rrggbb` or `#rrggbbaa`.
pub(super) fn color(key: &'static str, text: &str) -> Result<belvedere_scene::Color, Complaint> {
    let digits = text.strip_prefix('#').filter(|d| d.is_ascii() && (d.len() == 6 || d.len() == 8));
    let byte = |i: usize| digits.and_then(|d| d.get(2 * i..2 * i + 2)).and_then(|d| u8::from_str_radix(d, 16).ok());
    let alpha = if digits.is_some_and(|d| d.len() == 6) { Some(255) } else { byte(3) };
    match (byte(0), byte(1), byte(2), alpha) {
        (Some(r), Some(g), Some(b), Some(a)) if digits.is_some_and(|d| d.bytes().all(|c| c.is_ascii_hexdigit())) => {
            Ok(belvedere_scene::Color { r, g, b, a })
        }
        _ => Err((
            key,
            format!("{key} \"{}\" is no colour; write #rrggbb or #rrggbbaa", text.chars().take(40).collect::<String>()),
        )),
    }
}

/// Like [`color`]; `none` means no colour.
pub(super) fn optional_color(key: &'static str, text: &str) -> Result<Option<belvedere_scene::Color>, Complaint> {
    if text.eq_ignore_ascii_case("none") { Ok(None) } else { color(key, text).map(Some) }
}

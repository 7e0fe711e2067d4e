//! Text for people: numbers that are not longer than needed, and texts from files that cannot steer a terminal.

use std::borrow::Cow;
use std::fmt::Write;

/// Longest number that is written out.
const LONGEST: usize = 14;

/// A number as short as it can be told: all of its digits if they are few, else six digits, with an exponent where it is tiny or huge.
pub fn number(value: f64) -> String {
    let whole = value.to_string();
    if whole.len() <= LONGEST {
        return if value == 0.0 { "0".into() } else { whole };
    }
    if (1e-4..1e12).contains(&value.abs()) {
        let decimals = (5 - value.abs().log10().floor() as i32).max(0) as usize;
        return format!("{value:.decimals$}").parse().map_or(whole, |rounded: f64| rounded.to_string());
    }
    format!("{value:.3e}")
}

/// Whether a character breaks lines, moves the cursor or turns the direction of reading.
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{2028}' | '\u{2029}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text on one line in which characters that steer a terminal are escaped, as `\n` or `\u{1b}`: names come from files.
pub fn escaped(text: &str) -> Cow<'_, str> {
    without(text, &steers)
}

/// The same for a text of several lines: line breaks and tabs stay.
pub fn escaped_lines(text: &str) -> Cow<'_, str> {
    without(text, &|c| steers(c) && !matches!(c, '\n' | '\t'))
}

fn without<'t>(text: &'t str, bad: &dyn Fn(char) -> bool) -> Cow<'t, str> {
    if !text.contains(bad) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            c if !bad(c) => out.push(c),
            c if c.is_control() => out.extend(c.escape_default()),
            c => {
                let _ = write!(out, "\\u{{{:x}}}", u32::from(c));
            }
        }
    }
    out.into()
}

/// A text of at most `most` characters: where it is longer, its middle is left out.
pub fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    let count = text.chars().count();
    if count <= most {
        return text.into();
    }
    let kept = most.saturating_sub(5);
    let (head, tail) = (kept - kept / 3, kept / 3);
    let start: String = text.chars().take(head).collect();
    let end: String = text.chars().skip(count - tail).collect();
    format!("{start} ... {end}").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.25, "0.25"),
            (-5.0, "-5"),
            (4_700_500.25, "4700500.25"),
            (1.0 / 3.0, "0.333333"),
            (1e300, "1.000e300"),
            (5.099019513592785e-7, "5.099e-7"),
            (f64::INFINITY, "inf"),
            (123_456.789_012_345, "123457"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn characters_that_steer_a_terminal_are_escaped() {
        assert_eq!(escaped("a\u{1b}[31mb\r\n\tc\u{7f}\u{9b}"), "a\\u{1b}[31mb\\r\\n\\tc\\u{7f}\\u{9b}");
        assert_eq!(escaped("x\u{202e}y\u{2028}"), "x\\u{202e}y\\u{2028}");
        assert_eq!(escaped_lines("a\n\tb\u{1b}"), "a\n\tb\\u{1b}");
        assert!(matches!(escaped("Großglockner 富士山"), Cow::Borrowed(_)));
    }

    #[test]
    fn long_texts_lose_their_middle() {
        assert_eq!(shortened("short", 10), "short");
        let long: String = (0..200).map(|i| char::from(b'a' + (i % 26) as u8)).collect();
        let cut = shortened(&long, 50);
        assert_eq!(cut.chars().count(), 50);
        assert!(cut.contains(" ... ") && cut.starts_with("abc"));
    }
}

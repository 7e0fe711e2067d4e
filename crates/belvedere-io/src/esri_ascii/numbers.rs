//! Numbers of text grids as locales and programs write them: decimal commas, separators of thousands, commas or semicolons between
//! numbers, words for "no number", text of two bytes.

use crate::text::text_of;
use std::borrow::Cow;

/// How the numbers of a text are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Style {
    /// `1027,8`
    DecimalCommas,
    /// `1,027.8`
    CommaThousands,
    /// `1.027,8`
    PointThousands,
    /// `950.00,989.73`
    Separators,
}

/// The text with blanks between numbers and decimal points in them, and one sentence if it is written otherwise.
pub(crate) fn plain(bytes: &[u8]) -> (Cow<'_, [u8]>, Option<String>) {
    let text = match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [0, ..] | [_, 0, ..] => {
            Cow::Owned(text_of(bytes, &mut Vec::new()).into_bytes())
        }
        _ => Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
    };
    let text =
        if text.contains(&b';') { mapped(&text, |b| if b == b';' { Some(b' ') } else { Some(b) }) } else { text };
    if !text.contains(&b',') {
        return (text, None);
    }
    let style = style(&text);
    let said = match style {
        Style::Separators => None,
        Style::DecimalCommas => Some("its numbers have decimal commas; they are read as points".to_owned()),
        Style::CommaThousands => Some("commas in its numbers are read as separators of thousands".to_owned()),
        Style::PointThousands => {
            Some("points in its numbers are read as separators of thousands, and commas as decimal points".to_owned())
        }
    };
    let text = match style {
        Style::DecimalCommas => decimal(&text),
        Style::CommaThousands => mapped(&text, |b| (b != b',').then_some(b)),
        Style::PointThousands => mapped(&text, |b| match b {
            b'.' => None,
            b',' => Some(b'.'),
            b => Some(b),
        }),
        Style::Separators => mapped(&text, |b| Some(if b == b',' { b' ' } else { b })),
    };
    (text, said)
}

fn mapped(text: &[u8], map: impl Fn(u8) -> Option<u8>) -> Cow<'static, [u8]> {
    Cow::Owned(text.iter().filter_map(|b| map(*b)).collect())
}

/// Commas beside a digit become points.
fn decimal(text: &[u8]) -> Cow<'static, [u8]> {
    let digit = |at: Option<usize>| at.and_then(|at| text.get(at)).is_some_and(u8::is_ascii_digit);
    let is_decimal = |at: usize| text[at] == b',' && (digit(at.checked_sub(1)) || digit(Some(at + 1)));
    Cow::Owned((0..text.len()).map(|at| if is_decimal(at) { b'.' } else { text[at] }).collect())
}

/// The style of all words with a comma; words that contradict each other mean that commas stand between numbers.
fn style(text: &[u8]) -> Style {
    // The end of the file may have cut the last word.
    let end = text.iter().rposition(u8::is_ascii_whitespace).unwrap_or(text.len());
    let text = &text[..end];
    let words = || text.split(u8::is_ascii_whitespace).filter(|w| w.contains(&b','));
    let both = || words().filter(|w| w.contains(&b'.'));
    if both().next().is_none() {
        let separates = words().any(|w| w.ends_with(b",") || w.iter().filter(|b| **b == b',').count() > 1);
        return if separates { Style::Separators } else { Style::DecimalCommas };
    }
    if both().all(|w| in_thousands(w, b',', b'.')) {
        Style::CommaThousands
    } else if both().all(|w| in_thousands(w, b'.', b',')) {
        Style::PointThousands
    } else {
        Style::Separators
    }
}

/// Whether a word is a number with groups of three digits before its only decimal mark.
fn in_thousands(word: &[u8], group: u8, decimal: u8) -> bool {
    let word = word.strip_prefix(b"-").unwrap_or(word);
    let mut halves = word.split(|b| *b == decimal);
    let (Some(whole), Some(part), None) = (halves.next(), halves.next(), halves.next()) else { return false };
    let groups: Vec<&[u8]> = whole.split(|b| *b == group).collect();
    let digits = |g: &[u8]| g.iter().all(u8::is_ascii_digit);
    !part.is_empty()
        && part.iter().all(|b| b.is_ascii_digit())
        && groups.len() > 1
        && groups
            .iter()
            .enumerate()
            .all(|(k, g)| digits(g) && if k == 0 { (1..4).contains(&g.len()) } else { g.len() == 3 })
}

pub(super) fn parse(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok().and_then(|w| w.parse::<f32>().ok())
}

/// Whether a word says that there is no number: `1.#QNAN` and the like of older compilers, `NA`, `null`, `*`, `-`.
pub(super) fn is_no_number(word: &[u8]) -> bool {
    let unsigned = word.strip_prefix(b"-").unwrap_or(word);
    unsigned.starts_with(b"1.#")
        || unsigned.starts_with(b"1#")
        || [&b"na"[..], b"n/a", b"null", b"nodata", b"*", b"-", b"--"].iter().any(|w| word.eq_ignore_ascii_case(w))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn styles_of_numbers() {
        for (text, want, said) in [
            ("a 1\n950.5 -1027.25\n", "a 1\n950.5 -1027.25\n", None),
            ("950,5 -1027,25 3", "950.5 -1027.25 3", Some("decimal commas")),
            ("1,95e3 -,5", "1.95e3 -.5", Some("decimal commas")),
            ("950.5,-1027.25", "950.5 -1027.25", None),
            ("950.5, -1027.25,", "950.5  -1027.25 ", None),
            ("950,1027,3", "950 1027 3", None),
            ("950,5;1027,2", "950.5 1027.2", Some("decimal commas")),
            ("950.5;1027.2", "950.5 1027.2", None),
            ("5,196,000.00 950.5 -1,027.2", "5196000.00 950.5 -1027.2", Some("thousands")),
            ("5.196.000,00 950,5 -1.027,2", "5196000.00 950.5 -1027.2", Some("thousands")),
        ] {
            let (found, note) = plain(text.as_bytes());
            assert_eq!(std::str::from_utf8(&found).expect("text"), want);
            assert_eq!(note.is_some(), said.is_some(), "{text}: {note:?}");
            assert!(note.is_none_or(|n| n.contains(said.unwrap_or_default())), "{text}");
        }
        let wide: Vec<u8> = "ncols 2".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(&*plain(&wide).0, b"ncols 2");
        assert!([&b"1.#QNAN"[..], b"-1.#IND", b"NA", b"*"].iter().all(|w| is_no_number(w)));
        assert!([&b"1.5"[..], b"nan", b"-1", b"1.2"].iter().all(|w| !is_no_number(w)));
    }
}

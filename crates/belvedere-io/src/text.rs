//! Text of files in whatever encoding they declare.

use belvedere_core::{Warning, WarningKind};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Number of first bytes in which an XML declaration is searched.
const HEAD: usize = 200;

/// The text of a file: by its byte order mark, else as its XML declaration says, else UTF-8, else Windows-1252 (which holds Latin-1)
/// with a warning.
pub(crate) fn text_of(bytes: &[u8], warnings: &mut Vec<Warning>) -> String {
    if let Some(text) = four_bytes(bytes) {
        return text;
    }
    if let Some((encoding, mark)) = Encoding::for_bom(bytes) {
        return encoding.decode_without_bom_handling(&bytes[mark..]).0.into_owned();
    }
    // Two-byte text without a mark: the first character is ASCII in every format that is read.
    match bytes {
        [0, c, ..] if *c != 0 => return UTF_16BE.decode_without_bom_handling(bytes).0.into_owned(),
        [c, 0, ..] if *c != 0 => return UTF_16LE.decode_without_bom_handling(bytes).0.into_owned(),
        _ => {}
    }
    let declared = declared(bytes);
    if let Some(label) = &declared {
        match Encoding::for_label(label.as_bytes()) {
            Some(encoding) if encoding != UTF_8 && encoding != UTF_16LE && encoding != UTF_16BE => {
                let (text, _, odd) = encoding.decode(bytes);
                if odd {
                    let text = format!("text is not wholly {label}, as it declares; names may look odd");
                    warnings.push(Warning::new(WarningKind::Suspect, text));
                }
                return text.into_owned();
            }
            Some(_) => {}
            None => {
                let text = format!("text declares the encoding {label:.40}, which is not known");
                warnings.push(Warning::new(WarningKind::Assumed, text));
            }
        }
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(e) => {
            let at = e.valid_up_to();
            let text = format!("text is not UTF-8 (byte {at}); read as Windows-1252, so names may look odd");
            warnings.push(Warning::new(WarningKind::Assumed, text).with("at_byte", at as f64));
            WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned()
        }
    }
}

/// Text in UTF-32, by its byte order mark.
fn four_bytes(bytes: &[u8]) -> Option<String> {
    let unit: fn([u8; 4]) -> u32 = match bytes {
        [0xff, 0xfe, 0, 0, ..] => u32::from_le_bytes,
        [0, 0, 0xfe, 0xff, ..] => u32::from_be_bytes,
        _ => return None,
    };
    let units = bytes[4..].as_chunks::<4>().0.iter();
    Some(units.map(|b| char::from_u32(unit(*b)).unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
}

/// The encoding that an XML declaration names.
fn declared(bytes: &[u8]) -> Option<String> {
    let head: String = bytes.iter().take(HEAD).map(|&b| char::from(b)).collect();
    let declaration = head.trim_start().strip_prefix("<?xml")?.split("?>").next()?.to_owned();
    let (_, value) = declaration.split_once("encoding")?;
    let value = value.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    value[1..].split(quote).next().map(|label| label.trim().to_owned()).filter(|label| !label.is_empty())
}

/// The encoding of a dBASE table: as the `.cpg` file beside it says, else by the language in its header. `None` = not stated.
pub(crate) fn table_encoding(cpg: Option<&str>, language: u8) -> Option<&'static Encoding> {
    if let Some(encoding) = cpg.and_then(code_page) {
        return Some(encoding);
    }
    // dBASE language drivers that writers of shapefiles use, by their Windows code pages.
    let page = match language {
        0x03 | 0x57 | 0x58 | 0x59 => "1252",
        0x13 | 0x7b => "932",
        0x4d | 0x7a => "936",
        0x4e | 0x79 => "949",
        0x4f | 0x78 => "950",
        0xc8 => "1250",
        0xc9 => "1251",
        0xca => "1254",
        0xcb => "1253",
        0xcc => "1257",
        0x26 | 0x65 => "866",
        0x50 | 0x7c => "874",
        0x7d => "1255",
        0x7e => "1256",
        _ => return None,
    };
    code_page(page)
}

/// The encoding that a `.cpg` file names: `UTF-8`, `ISO-8859-2`, `1250`, `CP936`, `ISO 8859-1` and the like.
fn code_page(text: &str) -> Option<&'static Encoding> {
    let label = text.trim().trim_start_matches('\u{feff}').to_ascii_lowercase().replace('_', "-");
    let digits = label.trim_start_matches("windows-").trim_start_matches("ansi ").trim_start_matches("cp");
    let known = match digits {
        "932" => "shift_jis",
        "936" => "gbk",
        "949" => "euc-kr",
        "950" | "big5" => "big5",
        "866" => "ibm866",
        "874" => "windows-874",
        "65001" | "utf8" => "utf-8",
        "88591" | "8859-1" | "iso 8859-1" | "iso-88591" => "iso-8859-1",
        _ => "",
    };
    let windows = format!("windows-{digits}");
    [known, label.as_str(), windows.as_str()].iter().find_map(|l| Encoding::for_label(l.as_bytes()))
}

#[cfg(test)]
mod tests;

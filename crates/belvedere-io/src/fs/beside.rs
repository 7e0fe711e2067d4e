//! Files that another file names.

use std::path::{Path, PathBuf};

/// The file that stands beside `path` under the same name with another ending, in small or capital letters, with the ending of `path` or
/// without (`dem.prj`, `dem.PRJ`, `dem.Prj`, `dem.asc.prj`).
pub(crate) fn sidecar(path: &Path, ending: &str) -> Option<PathBuf> {
    let capital = ending.to_ascii_uppercase();
    let title: String = capital.chars().take(1).chain(ending.chars().skip(1)).collect();
    let endings = [ending, &capital, &title];
    let longer = |e: &&str| {
        let mut name = path.file_name().unwrap_or_default().to_os_string();
        name.push(".");
        name.push(e);
        path.with_file_name(name)
    };
    let named = endings.iter().map(|e| path.with_extension(e)).chain(endings.iter().map(longer));
    named.into_iter().find(|p| super::metadata(p).is_ok_and(|m| m.is_file()))
}

/// Path of a file that the file `path` names; refused if it is remote, absolute or leads out of the folder.
pub(crate) fn beside(path: &Path, name: &str) -> Result<PathBuf, String> {
    let relative = Path::new(name);
    let stays =
        relative.components().all(|c| matches!(c, std::path::Component::Normal(_) | std::path::Component::CurDir));
    if name.is_empty() || name.contains(':') || name.contains('\\') || !stays {
        let shown: String = name.chars().take(60).collect();
        return Err(format!("it names {shown:?}, which is not a file below its own folder; put the file beside it"));
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(relative))
}

/// Other spellings of the name of a file that another file names: without quotes, with percent signs decoded, with slashes for backslashes,
/// and of an absolute path, which is of the machine on which it was written, the last part.
pub(crate) fn spellings(name: &str) -> Vec<String> {
    let plain = name.trim().trim_matches(['"', '\'']).replace('\\', "/");
    let decoded = percent_decoded(&plain);
    let mut out = vec![plain, decoded];
    if out[0].starts_with('/') || out[0].contains(':') {
        out = out.iter().map(|name| name.rsplit('/').next().unwrap_or(name).to_owned()).collect();
    }
    out.dedup();
    out
}

/// A text with its percent signs decoded; those that stand for nothing stay.
pub(crate) fn percent_decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).and_then(|c| std::str::from_utf8(c).ok());
        let code =
            code.filter(|c| c.bytes().all(|b| b.is_ascii_hexdigit())).and_then(|c| u8::from_str_radix(c, 16).ok());
        match (bytes[at], code) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8(out).unwrap_or_else(|_| text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_have_several_spellings() {
        for (name, want) in [
            ("\"a b.mtl\"", "a b.mtl"),
            ("a%20b.mtl", "a b.mtl"),
            ("C:\\models\\T%C3%BCr.png", "Tür.png"),
            (".\\maps\\a.png", "./maps/a.png"),
            ("/home/me/a.mtl", "a.mtl"),
        ] {
            assert!(spellings(name).iter().any(|s| s == want), "{name}: {:?}", spellings(name));
        }
        for (uri, want) in [
            ("a%20b.bin", "a b.bin"),
            ("W%C3%BCrfel.bin", "Würfel.bin"),
            ("100%.bin", "100%.bin"),
            ("%zz%4", "%zz%4"),
            ("%ff.bin", "%ff.bin"),
        ] {
            assert_eq!(percent_decoded(uri), want, "{uri}");
        }
    }
}

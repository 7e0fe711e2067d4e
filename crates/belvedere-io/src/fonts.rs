//! Fonts of the system: which files there are, the likeliest first.

use std::path::{Path, PathBuf};

/// Most files that are listed.
const MOST_FILES: usize = 4000;
/// Deepest folder below those of the system.
const DEPTH: usize = 5;
/// Beginnings of names of files, without signs between their letters, in the order in which fontconfig takes families of sans-serif
/// letters (its files 60-latin, 65-nonlatin, 69-unifont and those that come with the fonts), and those of other systems between.
const GOOD: [&str; 30] = [
    "dejavusans",
    "notosanscjk",
    "notosans",
    "verdana",
    "arialuni",
    "nimbussans",
    "tahoma",
    "nachlieli",
    "waree",
    "loma",
    "garuda",
    "umpush",
    "msyh",
    "yugoth",
    "meiryo",
    "malgun",
    "nirmala",
    "hiragino",
    "pingfang",
    "sourcehansans",
    "wqyzenhei",
    "wqymicrohei",
    "droidsansfallback",
    "vlgothic",
    "ipagothic",
    "nanumgothic",
    "lohit",
    "meera",
    "lklug",
    "freesans",
];
/// Fonts whose letters are drawn of pixels: taken only where no other font has a letter.
const PIXELS: [&str; 3] = ["unifont", "wenquanyibitmapsong", "fixedsys"];
/// Words in names of files whose letters are of a special cut, or whose signs are no letters.
const SPECIAL: [&str; 22] = [
    "bold",
    "italic",
    "oblique",
    "serif",
    "mono",
    "thin",
    "light",
    "black",
    "condensed",
    "display",
    "symbol",
    "emoji",
    "looped",
    "nastaliq",
    "kufi",
    "medium",
    "rashi",
    "math",
    "music",
    "supplement",
    "last",
    "braille",
];

/// Files of fonts in the folders of the system and of the user, plain ones of large families first, then by name: the same order wherever
/// the same files are. None in a browser.
pub fn system_fonts() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in folders() {
        walk(&folder, DEPTH, &mut found);
    }
    sorted(found)
}

fn sorted(mut found: Vec<PathBuf>) -> Vec<PathBuf> {
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    found.sort_by_cached_key(|path| {
        let name = name(path);
        let letters: String = name.chars().filter(|c| c.is_alphanumeric()).collect();
        let pixels = PIXELS.iter().any(|word| letters.starts_with(word));
        let special = SPECIAL.iter().any(|word| name.contains(word));
        let good = GOOD.iter().position(|word| letters.starts_with(word)).unwrap_or(GOOD.len());
        (pixels, special, good, !name.contains("regular"), name, path.clone())
    });
    found.dedup();
    found
}

#[cfg(target_family = "wasm")]
fn folders() -> Vec<PathBuf> {
    Vec::new()
}

#[cfg(not(target_family = "wasm"))]
fn folders() -> Vec<PathBuf> {
    let under = |variable: &str, below: &str| std::env::var_os(variable).map(|home| Path::new(&home).join(below));
    let own = [
        under("XDG_DATA_HOME", "fonts"),
        under("HOME", ".local/share/fonts"),
        under("HOME", ".fonts"),
        under("HOME", "Library/Fonts"),
        under("WINDIR", "Fonts"),
        under("LOCALAPPDATA", "Microsoft/Windows/Fonts"),
    ];
    let shared = ["/usr/share/fonts", "/usr/local/share/fonts", "/System/Library/Fonts", "/Library/Fonts"];
    shared.into_iter().map(PathBuf::from).chain(own.into_iter().flatten()).filter(|path| path.is_absolute()).collect()
}

fn walk(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(Result::ok).map(|entry| entry.path()) {
        if found.len() >= MOST_FILES {
            return;
        }
        let is = |ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
        if ["ttf", "otf", "ttc", "otc"].into_iter().any(is) {
            found.push(path);
        } else if depth > 0 && path.is_dir() {
            walk(&path, depth - 1, found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_fonts_of_large_families_come_first_and_other_files_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("deep")).expect("made");
        for name in ["deep/NotoSansArabic-Regular.ttf", "Zebra.otf", "NotoSansArabic-Bold.ttf", "readme.txt", "a.TTC"] {
            std::fs::write(folder.path().join(name), b"-").expect("written");
        }
        let mut found = Vec::new();
        walk(folder.path(), DEPTH, &mut found);
        let names: Vec<String> =
            sorted(found).iter().filter_map(|p| Some(p.file_name()?.to_string_lossy().into_owned())).collect();
        let order = |names: &[&str]| -> Vec<String> {
            let files = names.iter().map(PathBuf::from).collect();
            sorted(files).iter().map(|p| p.to_string_lossy().into_owned()).collect()
        };
        let files =
            ["unifont.otf", "FreeSans.ttf", "Abc.ttf", "Lohit-Devanagari.ttf", "DejaVuSans.ttf", "FreeSansBold.ttf"];
        let right =
            ["DejaVuSans.ttf", "Lohit-Devanagari.ttf", "FreeSans.ttf", "Abc.ttf", "FreeSansBold.ttf", "unifont.otf"];
        assert_eq!(order(&files), right, "a text font before a font of pixels");
        assert_eq!(names, ["NotoSansArabic-Regular.ttf", "a.TTC", "Zebra.otf", "NotoSansArabic-Bold.ttf"]);
        walk(&folder.path().join("absent"), DEPTH, &mut Vec::new());
    }
}

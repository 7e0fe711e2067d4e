//! Folders that are one volume: slices as pictures, or a series of DICOM.

use super::{VolumeFile, VolumeRequest, odd_values};
use super::{dicom, pile::Pile, slice_picture, unspaced};
use crate::formats::{self, Reader, ends};
use crate::fs::beside;
use crate::geotiff::Pages;
use crate::{Fault, IoError, Limits, Loaded, budget};
use belvedere_core::{Warning, WarningKind};
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::path::{Path, PathBuf};

/// Endings of pictures that may be slices; a folder of several kinds is that of most files.
const PICTURES: [&[&str]; 3] = [&[".png"], &[".tif", ".tiff"], &[".jpg", ".jpeg"]];
/// Endings of files that give a picture its place on the earth.
const PLACES: [&str; 8] = [".pgw", ".pngw", ".wld", ".tfw", ".tifw", ".jgw", ".jpgw", ".jpegw"];
/// Most files of a volume.
const MAX_FILES: usize = 65_536;
/// Missing numbers that a warning names.
const LISTED: usize = 8;

/// What a folder holds as a volume.
enum Held {
    /// Pictures without a place, by the numbers in their names, and other pictures beside them.
    Pictures(Vec<String>, usize),
    Dicom(Vec<String>),
}

/// Whether a folder is a volume: it has pictures of slices, or DICOM, and no elevation models.
pub(crate) fn is_volume_folder(folder: &Path) -> bool {
    held(folder).is_ok_and(|held| held.is_some())
}

/// Names of the files of a folder that are not hidden.
fn names_of(folder: &Path) -> Result<Vec<String>, IoError> {
    let os = |e| IoError::os(folder, e);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(os)? {
        let path = entry.map_err(os)?.path();
        if let Some(name) = path.file_name().and_then(|n| n.to_str()).filter(|n| !n.starts_with('.'))
            && path.is_file()
        {
            names.push(name.to_owned());
        }
    }
    if names.len() > MAX_FILES {
        let count = names.len();
        return Err(IoError::format(folder, format!("has {count} files, at most {MAX_FILES} are slices of a volume")));
    }
    names.sort_by(|a, b| by_numbers(a, b));
    Ok(names)
}

/// The path of a file of a folder, which is looked into only as a file beside it would name it: links may not lead out.
fn path_in(folder: &Path, name: &str) -> Result<PathBuf, IoError> {
    beside(&folder.join("a"), name).map_err(|reason| IoError::format(folder, reason))
}

fn held(folder: &Path) -> Result<Option<Held>, IoError> {
    let names = names_of(folder)?;
    let is_dicom = |name: &&String| {
        let known = formats::of_name(Path::new(name)).map(|format| format.name);
        let has_mark = || path_in(folder, name).is_ok_and(|path| dicom::has_mark(&path));
        known == Some(dicom::NAME) || (known.is_none() && has_mark())
    };
    let series: Vec<String> = names.iter().filter(is_dicom).cloned().collect();
    if !series.is_empty() {
        return Ok(Some(Held::Dicom(series)));
    }
    let is = |name: &String, endings: &[&str]| ends(Path::new(name), endings);
    let is_ground = |name: &String| Reader::Terrain.reads(Path::new(name)) && !is(name, &[".tif", ".tiff", ".txt"]);
    if names.iter().any(|name| is_ground(name) || is(name, &PLACES)) {
        return Ok(None);
    }
    let of_kind = |endings: &[&str]| names.iter().filter(|name| is(name, endings)).cloned().collect::<Vec<_>>();
    let kinds = PICTURES.map(of_kind);
    let all: usize = kinds.iter().map(Vec::len).sum();
    let pictures = kinds.into_iter().max_by_key(Vec::len).filter(|pictures| pictures.len() > 1);
    let Some(pictures) = pictures else { return Ok(None) };
    if is(&pictures[0], PICTURES[1]) {
        // Tiles of a map have places, and files of several pages are volumes themselves.
        let first = path_in(folder, &pictures[0]).and_then(|path| Pages::open(&path, Limits::default()));
        if first.is_ok_and(|pages| pages.is_placed || pages.count() > 1) {
            return Ok(None);
        }
    }
    let others = all - pictures.len();
    Ok(Some(Held::Pictures(pictures, others)))
}

/// Reads the volume of a folder.
pub(super) fn read(folder: &Path, request: &VolumeRequest) -> Result<Loaded<VolumeFile>, IoError> {
    let path_of = |name: &String| path_in(folder, name);
    match held(folder)? {
        Some(Held::Dicom(names)) => {
            dicom::read(folder, &names.iter().map(path_of).collect::<Result<Vec<_>, _>>()?, request)
        }
        Some(Held::Pictures(names, others)) => {
            let files = names.iter().map(path_of).collect::<Result<Vec<_>, _>>()?;
            let mut loaded = slices(folder, &files, request)?;
            let (first, last, count) = (&names[0], &names[names.len() - 1], names.len());
            let mut said =
                vec![format!("{count} slices from {first} to {last} lie in the order of the numbers in their names")];
            said.extend(missing(&names));
            let mut warnings: Vec<Warning> = said
                .into_iter()
                .map(|text| Warning::new(WarningKind::Assumed, text).with("slices", count as f64))
                .collect();
            let other = "other pictures of the folder are left out";
            warnings.extend(Warning::counted(WarningKind::Ignored, others, other));
            loaded.warnings.extend(warnings.into_iter().map(|w| w.in_file(folder)));
            Ok(loaded)
        }
        None => {
            let reason = "is a folder without slices of a volume (at least 2 PNG, TIFF or JPEG without a place, or DICOM); name such a folder, or a file";
            Err(IoError::format(folder, reason))
        }
    }
}

/// The volume of pictures, in this order.
fn slices(folder: &Path, files: &[PathBuf], request: &VolumeRequest) -> Result<Loaded<VolumeFile>, IoError> {
    let _work = budget::work_on(folder);
    let mut pile: Option<Pile> = None;
    let mut records = Vec::with_capacity(files.len());
    for group in files.chunks(rayon::current_num_threads().max(1)) {
        let decoded: Vec<_> = group.par_iter().map(|file| slice_picture::read(file, &request.limits)).collect();
        for (file, decoded) in group.iter().zip(decoded) {
            let (slice, record) = decoded?;
            let bad = |fault: Fault| IoError::format(file, fault);
            let pile = match &mut pile {
                Some(pile) => pile,
                none => none.insert(Pile::new(&slice.info, files.len(), &request.limits).map_err(bad)?),
            };
            pile.push(&slice).map_err(|reason| bad(reason.into()))?;
            records.push(record);
        }
    }
    let pile = pile.ok_or_else(|| IoError::format(folder, "holds no slices"))?;
    let (axes, unspaced) = unspaced(request);
    let mut warnings: Vec<Warning> = pile.warning().into_iter().chain(unspaced).map(|w| w.in_file(folder)).collect();
    let (dims, stored, values, changed) = pile.finish();
    warnings.extend(odd_values(folder, &changed));
    let file = VolumeFile { format: "slices", array: None, stored, dims, axes, origin: DVec3::ZERO, values };
    Ok(Loaded { value: file, warnings, files: records })
}

/// A name as stretches of digits and of other characters.
fn parts(name: &str) -> impl Iterator<Item = &str> {
    let mut rest = name;
    std::iter::from_fn(move || {
        let is_digit = rest.chars().next()?.is_ascii_digit();
        let end = rest.find(|c: char| c.is_ascii_digit() != is_digit).unwrap_or(rest.len());
        let (part, after) = rest.split_at(end);
        rest = after;
        Some(part)
    })
}

/// Order of names in which 9 comes before 10.
fn by_numbers(a: &str, b: &str) -> Ordering {
    let value = |part: &str| {
        let digits = part.trim_start_matches('0');
        part.starts_with(|c: char| c.is_ascii_digit()).then(|| (digits.len(), digits.to_owned()))
    };
    let pairs = parts(a).zip(parts(b)).map(|(a, b)| match (value(a), value(b)) {
        (Some(a), Some(b)) => a.cmp(&b),
        _ => a.cmp(b),
    });
    let parts = || parts(a).count().cmp(&parts(b).count());
    pairs.into_iter().find(|order| order.is_ne()).unwrap_or_else(|| parts().then_with(|| a.cmp(b)))
}

/// Says which numbers are missing in names that differ in one number alone, in order.
fn missing(names: &[String]) -> Option<String> {
    let split: Vec<Vec<&str>> = names.iter().map(|name| parts(name).collect()).collect();
    let (first, last) = (split.first()?, split.last()?);
    let place = (0..first.len().min(last.len())).find(|i| first[*i].parse::<u64>().is_ok() && first[*i] != last[*i])?;
    let numbers: Option<Vec<u64>> = split.iter().map(|parts| parts.get(place)?.parse().ok()).collect();
    let numbers = numbers?;
    let steps = || numbers.windows(2).filter_map(|pair| pair[1].checked_sub(pair[0]));
    let step = steps().min().filter(|step| *step > 0)?;
    let gaps =
        || numbers.windows(2).flat_map(|pair| (1..=(pair[1] - pair[0]) / step - 1).map(move |k| pair[0] + k * step));
    if steps().count() + 1 != numbers.len() || steps().any(|s| s % step != 0) {
        return None;
    }
    let count: u64 = steps().map(|s| s / step - 1).sum();
    let named: Vec<String> = gaps().take(LISTED).map(|n| n.to_string()).collect();
    let more = if count > LISTED as u64 { ", ..." } else { "" };
    let named = named.join(", ");
    (count > 0).then(|| format!("{count} numbers are missing in the names of its slices ({named}{more}); slices are laid one after the other without gaps"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_comes_before_ten() {
        let mut names =
            ["s10.png", "s9.png", "s009b.png", "S1.png", "s100.png", "s1.png", "s01.png"].map(str::to_owned);
        names.sort_by(|a, b| by_numbers(a, b));
        assert_eq!(names, ["S1.png", "s01.png", "s1.png", "s9.png", "s009b.png", "s10.png", "s100.png"]);
    }

    #[test]
    fn missing_numbers_are_named() {
        let of = |numbers: &[u32]| missing(&numbers.iter().map(|n| format!("ct2_{n:03}.png")).collect::<Vec<_>>());
        assert_eq!(of(&[1, 2, 3, 4]), None);
        assert_eq!(of(&[10, 20, 30]), None);
        assert!(
            of(&[1, 2, 5, 6, 8])
                .is_some_and(|text| text.starts_with("3 numbers are missing") && text.contains("(3, 4, 7)"))
        );
        assert!(
            of(&[0, 1, 4_000_000_000]).is_some_and(|text| text.contains("3999999998 numbers") && text.contains("..."))
        );
        assert_eq!(missing(&["a.png".into(), "b.png".into()]), None);
    }
}

//! DICOM: a series of single images in a folder, or one file of several frames.
//!
//! Read are uncompressed pixels, run lengths and JPEG of 8 bits. Coordinates are those of the patient (left, posterior, superior), mm.

mod data_set;
mod image;
mod packing;
mod pixels;
mod values;

use super::{VolumeFile, VolumeRequest};
use crate::{Fault, InputFile, IoError, Loaded, budget, fs};
use belvedere_core::{Warning, WarningKind};
use glam::{DMat3, DVec3};
use image::{Frame, Image};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use values::Values;

/// Name of the format.
pub(super) const NAME: &str = "DICOM";
/// Share of the distance of slices by which one may differ before it is said.
const UNEVEN: f64 = 0.01;
/// Other series that a warning names.
const LISTED: usize = 4;

/// A frame of a file.
struct Slice {
    /// Index of the file.
    file: usize,
    frame: Frame,
}

/// Whether a file has the mark of DICOM.
pub(super) fn has_mark(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(132).read_to_end(&mut head));
    read.is_ok() && head.get(128..) == Some(b"DICM")
}

/// Reads the volume of these files.
///
/// * `named`: the file or the folder, for messages.
pub(super) fn read(named: &Path, files: &[PathBuf], request: &VolumeRequest) -> Result<Loaded<VolumeFile>, IoError> {
    let _work = budget::work_on(named);
    let mut warnings = Vec::new();
    let (mut images, mut records) = (Vec::with_capacity(files.len()), Vec::with_capacity(files.len()));
    let mut without = 0;
    for (i, path) in files.iter().enumerate() {
        let (bytes, record) = bytes_of(path, request)?;
        match Image::of(&bytes).map_err(|e| IoError::format(path, e))? {
            Some(image) => images.push((i, image)),
            None => without += 1,
        }
        records.push(record);
    }
    warnings.extend(Warning::counted(WarningKind::Ignored, without, "files without pixels are left out"));
    let images = largest(images, &mut warnings);
    let bad = |fault: Fault| IoError::format(named, fault);
    let Some((_, first)) = images.first() else { return Err(bad("holds no image of DICOM".into())) };
    if let Some(reason) = first.packing.refusal() {
        return Err(bad(reason.into()));
    }
    let slices = ordered(&images, &mut warnings).map_err(|e| bad(e.into()))?;
    let (axes, origin) = place(&slices, &mut warnings);
    let mut values = Values::new(&first.layout, &slices, &request.limits).map_err(bad)?;
    let mut open: Option<(usize, Vec<u8>)> = None;
    for slice in &slices {
        let (index, image) = &images[slice.file];
        let path = &files[*index];
        if open.as_ref().is_none_or(|(file, _)| file != index) {
            let bytes = fs::read(path).map_err(|e| IoError::os(path, e))?;
            let bytes = image::unpacked(&bytes).map_err(|e| IoError::format(path, e))?.0.into_owned();
            open = Some((*index, bytes));
        }
        let bytes = open.as_ref().map_or(&[][..], |(_, bytes)| bytes);
        let frame = pixels::frame(image, bytes, slice.frame.index, path, &request.limits);
        values.push(&frame.map_err(|e| IoError::format(path, e))?, slice.frame.rescale);
    }
    let used: Vec<InputFile> = images.iter().map(|(i, _)| records[*i].clone()).collect();
    warnings.extend(values.warning());
    let (stored, dims) = (values.number(), [first.layout.columns, first.layout.rows, slices.len()]);
    let file = VolumeFile { format: NAME, array: None, stored, dims, axes, origin, values: values.finish() };
    let warnings = warnings.into_iter().map(|w| w.in_file(named)).collect();
    Ok(Loaded { value: file, warnings, files: used })
}

fn bytes_of(path: &Path, request: &VolumeRequest) -> Result<(Vec<u8>, InputFile), IoError> {
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    request.limits.ask("the file", length).map_err(|e| IoError::format(path, e))?;
    InputFile::read(path)
}

/// The images of the series with most frames; others are said. Images of one series that differ in size, samples or orientation are told
/// apart.
fn largest(images: Vec<(usize, Image)>, warnings: &mut Vec<Warning>) -> Vec<(usize, Image)> {
    let mut groups: BTreeMap<_, Vec<(usize, Image)>> = BTreeMap::new();
    for (i, image) in images {
        let turn = image.frames.first().and_then(|frame| frame.axes);
        let turn = turn.map(|axes| axes.map(|a| (1000.0 * a).round().as_i64vec3().to_array()));
        groups.entry((image.series.clone(), image.layout.clone(), turn)).or_default().push((i, image));
    }
    let frames = |group: &[(usize, Image)]| group.iter().map(|(_, image)| image.frames.len()).sum::<usize>();
    let mut groups: Vec<_> = groups.into_values().collect();
    groups.sort_by_key(|group| std::cmp::Reverse(frames(group)));
    let mut groups = groups.into_iter();
    let Some(taken) = groups.next() else { return Vec::new() };
    let others: Vec<String> = groups
        .map(|group| {
            let title: String = group[0].1.title.chars().take(40).collect();
            format!("{title:?} with {}", frames(&group))
        })
        .collect();
    if !others.is_empty() {
        let more = if others.len() > LISTED { ", ..." } else { "" };
        let text = format!(
            "it holds {} series; that of most images is taken ({}), left out are {}{more}",
            others.len() + 1,
            frames(&taken),
            others[..others.len().min(LISTED)].join(", ")
        );
        warnings.push(Warning::new(WarningKind::Ignored, text).with("series", others.len() as f64 + 1.0));
    }
    taken
}

/// Slices along the normal of their plane, or by their numbers where positions are missing.
fn ordered(images: &[(usize, Image)], warnings: &mut Vec<Warning>) -> Result<Vec<Slice>, String> {
    let of = |(file, (_, image)): (usize, &(usize, Image))| {
        image.frames.iter().map(move |frame| Slice { file, frame: frame.clone() }).collect::<Vec<_>>()
    };
    let mut slices: Vec<Slice> = images.iter().enumerate().flat_map(of).collect();
    slices.sort_by(|a, b| a.frame.number.total_cmp(&b.frame.number));
    let normal = slices.first().and_then(|slice| slice.frame.axes).map(|[a, b]| a.cross(b).normalize());
    let along = |slice: &Slice| Some(slice.frame.position?.dot(normal?));
    if slices.iter().all(|slice| along(slice).is_some()) {
        slices.sort_by(|a, b| along(a).unwrap_or(0.0).total_cmp(&along(b).unwrap_or(0.0)));
        let before = slices.len();
        slices.dedup_by(|b, a| along(a).zip(along(b)).is_some_and(|(a, b)| (a - b).abs() < 1e-4));
        let twice = "images at a position of another are left out";
        warnings.extend(Warning::counted(WarningKind::Ignored, before - slices.len(), twice));
    } else if slices.len() > 1 {
        let text = "it does not state the position of all its images; they lie in the order of their numbers";
        warnings.push(Warning::new(WarningKind::Assumed, text));
        slices.iter_mut().for_each(|slice| slice.frame.position = None);
    }
    match slices.len() {
        0 | 1 => {
            Err("it holds one image at one position, a volume needs 2 or more; give the folder of its series".into())
        }
        _ => Ok(slices),
    }
}

/// Axes and origin of slices in order, mm.
fn place(slices: &[Slice], warnings: &mut Vec<Warning>) -> (DMat3, DVec3) {
    let first = &slices[0].frame;
    let mut assumed = |text: &str| warnings.push(Warning::new(WarningKind::Assumed, text));
    let [between_rows, between_columns] = first.spacing.unwrap_or_else(|| {
        assumed("it states no spacing of pixels; 1 mm is assumed");
        [1.0; 2]
    });
    let [row, column] = first.axes.unwrap_or([DVec3::X, DVec3::Y]);
    let last = slices[slices.len() - 1].frame.position;
    let (Some(start), Some(end)) = (first.position, last) else {
        let step = first.step.unwrap_or_else(|| {
            assumed("it states no spacing of slices; 1 mm is assumed");
            1.0
        });
        let normal = row.cross(column).normalize();
        return (DMat3::from_cols(between_columns * row, between_rows * column, step * normal), DVec3::ZERO);
    };
    let step = (end - start) / (slices.len() - 1) as f64;
    warnings.extend(unevenness(slices, step));
    (DMat3::from_cols(between_columns * row, between_rows * column, step), start)
}

/// A warning where slices do not lie at equal distances.
fn unevenness(slices: &[Slice], step: DVec3) -> Option<Warning> {
    let positions: Vec<DVec3> = slices.iter().filter_map(|slice| slice.frame.position).collect();
    let distances: Vec<f64> = positions.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
    let mut sorted = distances.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = *sorted.get(sorted.len() / 2)?;
    let (least, most) = (*sorted.first()?, *sorted.last()?);
    if most - least <= UNEVEN * usual {
        return None;
    }
    let missing: f64 = distances.iter().map(|d| ((d / usual).round() - 1.0).max(0.0)).sum();
    let gaps = if missing > 0.0 { format!(", as if {missing} slices were missing") } else { String::new() };
    let text = format!(
        "its slices lie {least:.4} to {most:.4} mm apart, usually {usual:.4}{gaps}; they are laid at the mean distance of {:.4} mm, so that parts of it are stretched",
        step.length()
    );
    let warning = Warning::new(WarningKind::Inexact, text).with("least_mm", least).with("most_mm", most);
    Some(warning.with("missing_slices", missing))
}

//! Transfer functions: by name, from a file of ours, or from a colour map that ParaView exported.

use super::color::color;
use super::loader::Loader;
use crate::BelvedereError;
use belvedere_document::{DocError, Node, suggestion};
use belvedere_io::InputFile;
use belvedere_scene::volume::{TRANSFER_NAMES, WALL};
use belvedere_scene::{Color, TransferFunction, TransferPoint, Volume};
use serde::Deserialize;
use std::path::Path;

/// A transfer function file of our own, TOML or JSON.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TransferDoc {
    /// Distance to which opacities refer, voxel edges.
    #[serde(default = "one")]
    reference_step: f64,
    points: Vec<PointDoc>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PointDoc {
    value: f64,
    color: String,
    opacity: f64,
}

/// A colour map as exported by ParaView: a list with one entry. Colours are value, red, green, blue in 0..=1; opacities are value, opacity,
/// midpoint, sharpness. Midpoints and sharpness are not used.
#[derive(Debug, Deserialize)]
struct ParaViewDoc {
    #[serde(rename = "RGBPoints")]
    rgb_points: Vec<f64>,
    #[serde(rename = "Points")]
    points: Option<Vec<f64>>,
}

fn one() -> f64 {
    1.0
}

/// Beginning of a function whose points stand in its name.
const POINTS: &str = "points ";

/// The points of a function that states them: `VALUE:#rrggbb:OPACITY`, separated by spaces.
fn listed(list: &str) -> Result<Vec<TransferPoint>, String> {
    let one = |text: &str| {
        let parts: Vec<&str> = text.split(':').collect();
        let (value, opacity) = match parts.as_slice() {
            [value, _, opacity] => (value.parse().ok(), opacity.parse().ok()),
            _ => (None, None),
        };
        let (Some(value), Some(opacity)) = (value, opacity) else {
            return Err(format!("transfer point \"{text}\" is not VALUE:#rrggbb:OPACITY, such as 120:#ffcc88:0.4"));
        };
        let color = color("color", parts[1]).map_err(|(_, reason)| reason)?;
        Ok(TransferPoint { value, color, opacity })
    };
    list.split_whitespace().map(one).collect()
}

/// The function that a layer names, fitted to its volume.
pub(super) fn find(
    loader: &mut Loader<'_>,
    index: usize,
    name: &str,
    volume: &Volume,
) -> Result<TransferFunction, BelvedereError> {
    if let Some(found) = TransferFunction::named(name, volume) {
        return Ok(found);
    }
    if name == WALL {
        // Used until the path is known.
        return Ok(TransferFunction::auto(volume));
    }
    if let Some(list) = name.strip_prefix(POINTS) {
        let made = listed(list).and_then(|points| TransferFunction::new(name, points, 1.0).map_err(|e| e.to_string()));
        return made.map_err(|reason| loader.fail(index, "transfer", reason));
    }
    let is_file = [".toml", ".json"].iter().any(|e| name.to_ascii_lowercase().ends_with(e));
    if !is_file {
        let hint = suggestion(name, &[TRANSFER_NAMES, &[WALL]].concat());
        let reason = format!("transfer \"{name}\" is neither a name that exists nor a .toml or .json file; {hint}");
        return Err(loader.fail(index, "transfer", reason));
    }
    let path = loader.file(index, "transfer", name)?;
    let (function, file) = read(&path, name, volume)?;
    loader.inputs.push(file);
    Ok(function)
}

fn read(path: &Path, name: &str, volume: &Volume) -> Result<(TransferFunction, InputFile), BelvedereError> {
    let (text, file) = belvedere_document::read_text(path)?;
    let root = belvedere_document::tree(path, &text).map_err(|e| e.in_file(path))?;
    let (points, step) = points(&root, volume).map_err(|e| e.in_file(path))?;
    let function = TransferFunction::new(name, points, step);
    let function = function.map_err(|e| belvedere_io::IoError::format(path, e.to_string()))?;
    Ok((function, file))
}

fn points(root: &Node, volume: &Volume) -> Result<(Vec<TransferPoint>, f64), DocError> {
    let exported = root.list().and_then(<[Node]>::first).unwrap_or(root);
    if exported.get("RGBPoints").is_some() {
        let doc: ParaViewDoc = belvedere_document::decode(exported)?;
        return paraview(&doc, volume).map(|points| (points, 1.0)).map_err(DocError::whole);
    }
    let doc: TransferDoc = belvedere_document::decode(root)?;
    let points = doc.points.iter().map(|p| {
        let color = color("color", &p.color).map_err(|(_, reason)| DocError::whole(reason))?;
        Ok(TransferPoint { value: p.value, color, opacity: p.opacity })
    });
    Ok((points.collect::<Result<_, DocError>>()?, doc.reference_step))
}

/// Points at every value with a colour or an opacity. Without opacities, opacity rises with the value over the range of the volume.
fn paraview(doc: &ParaViewDoc, volume: &Volume) -> Result<Vec<TransferPoint>, String> {
    let colors: Vec<[f64; 4]> = doc.rgb_points.as_chunks().0.to_vec();
    let [lo, hi] = volume.range().map(f64::from);
    let ramp = vec![[lo, 0.0, 0.5, 0.0], [hi, 0.5, 0.5, 0.0]];
    let opacities: Vec<[f64; 4]> = doc.points.as_ref().map_or(ramp, |p| p.as_chunks().0.to_vec());
    let whole = doc.rgb_points.len().is_multiple_of(4) && doc.points.as_ref().is_none_or(|p| p.len().is_multiple_of(4));
    if colors.is_empty() || opacities.is_empty() || !whole {
        return Err(
            "RGBPoints and Points need groups of four numbers, at least one each; export the colour map again".into()
        );
    }
    let mut values: Vec<f64> = colors.iter().chain(&opacities).map(|p| p[0]).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let made = values.into_iter().map(|value| {
        let [_, r, g, b] = between(&colors, value);
        let [r, g, b] = [r, g, b].map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
        TransferPoint { value, color: Color::rgb(r, g, b), opacity: between(&opacities, value)[1].clamp(0.0, 1.0) }
    });
    Ok(made.collect())
}

/// Linear interpolation of entries that begin with their value.
fn between(list: &[[f64; 4]], value: f64) -> [f64; 4] {
    let above = list.partition_point(|p| p[0] <= value);
    match (above.checked_sub(1).and_then(|i| list.get(i)), list.get(above)) {
        (Some(a), Some(b)) => {
            let t = (value - a[0]) / (b[0] - a[0]);
            std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
        }
        (Some(p), None) | (None, Some(p)) => *p,
        (None, None) => [0.0; 4],
    }
}

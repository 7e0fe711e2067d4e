//! Layers of boxes: inline, from JSON or CSV, or built in.

use super::builtin;
use super::color::color;
use super::loader::Loader;
use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_document::{BoxDoc, BoxesDoc, DocError, Paths, TransformDoc};
use belvedere_io::InputFile;
use belvedere_scene::{BoxLayer, BoxShape, Color, LayerKind};
use std::path::Path;

/// The layer.
pub(super) fn layer(loader: &mut Loader<'_>, index: usize, doc: &BoxesDoc) -> Result<LayerKind, BelvedereError> {
    let default = loader.color(index, &doc.style.color)?;
    let mut boxes = match (&doc.source, &doc.boxes) {
        (Some(name), _) if builtin::is_name(name) => {
            loader.builtin(index, name, |kind| kind.boxes().map(|layer| layer.boxes.clone()))?
        }
        (Some(name), _) => {
            let path = loader.files(index, "source", &Paths::One(name.clone()))?.remove(0);
            let (docs, file) = read(&path)?;
            loader.inputs.push(file);
            shapes(&docs, default).map_err(|reason| belvedere_io::IoError::format(path, reason))?
        }
        (None, Some(docs)) => shapes(docs, default).map_err(|reason| loader.fail(index, "boxes", reason))?,
        (None, None) => Vec::new(),
    };
    if let Some(transform) = &doc.transform {
        check(transform).map_err(|reason| loader.fail(index, "transform", reason))?;
        boxes.iter_mut().for_each(|b| apply(b, transform));
    }
    Ok(BoxLayer { rigid: doc.rigid, ..BoxLayer::new(boxes) }.into())
}

fn shapes(docs: &[BoxDoc], default: Color) -> Result<Vec<BoxShape>, String> {
    docs.iter().enumerate().map(|(i, doc)| shape(doc, default).map_err(|e| format!("box {i}: {e}"))).collect()
}

fn shape(doc: &BoxDoc, default: Color) -> Result<BoxShape, String> {
    let size = DVec3::from_array(doc.size);
    if !(size.min_element() > 0.0) {
        return Err(format!("size is {:?}, every extent must be greater than 0", doc.size));
    }
    let color = doc.color.as_ref().map_or(Ok(default), |text| color("color", text).map_err(|(_, reason)| reason))?;
    Ok(BoxShape { base: DVec3::from_array(doc.base), size, yaw: doc.yaw_deg.to_radians(), color })
}

fn check(transform: &TransformDoc) -> Result<(), String> {
    if transform.rotate_deg[0] != 0.0 || transform.rotate_deg[1] != 0.0 {
        return Err(format!("boxes stay upright, rotate_deg is {:?}; rotate about z only", transform.rotate_deg));
    }
    if !(transform.scale > 0.0) {
        return Err(format!("scale is {}, it must be greater than 0", transform.scale));
    }
    Ok(())
}

fn apply(shape: &mut BoxShape, transform: &TransformDoc) {
    let yaw = transform.rotate_deg[2].to_radians();
    let (sin, cos) = yaw.sin_cos();
    let p = transform.scale * shape.base;
    shape.base = DVec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z) + DVec3::from_array(transform.translate);
    shape.size *= transform.scale;
    shape.yaw += yaw;
}

fn read(path: &Path) -> Result<(Vec<BoxDoc>, InputFile), BelvedereError> {
    let (text, file) = belvedere_document::read_text(path)?;
    let boxes = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
        csv(&text)
    } else {
        belvedere_document::tree(path, &text).and_then(|root| belvedere_document::decode(&root))
    };
    Ok((boxes.map_err(|e| e.in_file(path))?, file))
}

/// `x,y,z,size_x,size_y,size_z[,yaw_deg[,color]]`; a first line of names is skipped.
fn csv(text: &str) -> Result<Vec<BoxDoc>, DocError> {
    let mut boxes = Vec::new();
    for (i, row) in text.lines().enumerate() {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if row.trim().is_empty() || (i == 0 && cells[0].parse::<f64>().is_err()) {
            continue;
        }
        let number = |k: usize| cells.get(k).and_then(|c| c.parse::<f64>().ok()).filter(|v| v.is_finite());
        let numbers: Option<Vec<f64>> = (0..6).map(number).collect();
        let bad =
            || DocError::at(i + 1, "x,y,z,size_x,size_y,size_z[,yaw_deg[,color]] was expected; give finite numbers");
        let n = numbers.filter(|_| cells.len() <= 8).ok_or_else(bad)?;
        let yaw_deg = if cells.get(6).is_some_and(|c| !c.is_empty()) { number(6).ok_or_else(bad)? } else { 0.0 };
        let color = cells.get(7).filter(|c| !c.is_empty()).map(|c| (*c).to_owned());
        boxes.push(BoxDoc { base: [n[0], n[1], n[2]], size: [n[3], n[4], n[5]], yaw_deg, color });
    }
    Ok(boxes)
}

//! Mesh layers: files or built in, placed in the scene.

use super::builtin;
use super::ground::{Ground, epsg};
use super::loader::Loader;
use crate::BelvedereError;
use belvedere_core::{DVec2, DVec3, Warning, WarningKind};
use belvedere_document::{MeshDoc, Paths, TransformDoc};
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::{MeshFile, load_mesh};
use belvedere_scene::{Crs, LayerKind, Mesh, MeshColors, MeshLayer, RigidParts, Texturing};
use belvedere_sight::{GroundHeight, Occluded, OpennessSettings};
use glam::{DMat3, EulerRot};

/// The layer.
pub(super) fn layer(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &MeshDoc,
    ground: &Ground<'_>,
) -> Result<LayerKind, BelvedereError> {
    let color = loader.color(index, &doc.style.color)?;
    let mut file = source(loader, index, doc)?;
    match (&doc.transform, &doc.crs) {
        (Some(_), Some(_)) => {
            return Err(loader.fail(index, "crs", "a mesh has either transform or crs; remove one of them"));
        }
        (Some(transform), None) => apply(&mut file, transform).map_err(|e| loader.fail(index, "transform", e))?,
        (None, Some(crs)) => reproject(&mut file, crs, ground.crs).map_err(|e| loader.fail(index, "crs", e))?,
        (None, None) => {}
    }
    let MeshFile { positions, triangles, normals, colors, parts, names, texturing, .. } = file;
    let mesh = Mesh::textured(&positions, triangles, colors, parts, texturing);
    let mesh = mesh.and_then(|mesh| match normals.filter(|_| doc.style.smooth) {
        Some(normals) => mesh.with_normals(&normals),
        None => Ok(mesh),
    });
    let mesh = mesh.map_err(|e| loader.fail(index, "source", e))?;
    let mesh = with_ambient_occlusion(loader, index, mesh, doc.style.ambient_occlusion, ground)?;
    let rigid = if doc.rigid { RigidParts::All } else { RigidParts::None };
    let mut layer = MeshLayer { names, rigid, ..MeshLayer::new(mesh, color) };
    if let Some(select) = &doc.select {
        layer.wanted = Some(wanted(&layer, select).map_err(|e| loader.fail(index, "select", e))?);
    }
    Ok(layer.into())
}

/// The mesh with ambient occlusion, if that is asked for and something is drawn.
pub(super) fn with_ambient_occlusion(
    loader: &mut Loader<'_>,
    index: usize,
    mesh: Mesh,
    reach: Option<f64>,
    ground: &Ground<'_>,
) -> Result<Mesh, BelvedereError> {
    let Some(reach) = reach else { return Ok(mesh) };
    if !(reach > 0.0 && reach.is_finite()) {
        let reason =
            format!("ambient_occlusion is {reach}; give the distance within which things take light, more than 0");
        return Err(loader.fail(index, "style", reason));
    }
    let height = |xy: DVec2| ground.terrain.and_then(|terrain| terrain.surface_at(xy));
    let ground: Option<&GroundHeight<'_>> = if ground.terrain.is_some() { Some(&height) } else { None };
    let settings = OpennessSettings::reaching(reach);
    if loader.options.undrawn {
        return Ok(mesh);
    }
    let triangles = mesh.triangles().len();
    let Occluded { mesh, step, left_out } =
        belvedere_sight::with_ambient_occlusion(mesh, ground, &settings, &loader.options.progress)?;
    if step > settings.step {
        // Two digits, whatever the unit.
        let short = |v: f64| {
            let scale = 10f64.powf(1.0 - v.log10().floor());
            (v * scale).round() / scale
        };
        let text = format!(
            "ambient_occlusion = {reach} asks for points {} apart, which are too many for {triangles} triangles; they lie {} apart, so \
             that shade of that reach is coarse: a greater distance shows more",
            short(settings.step),
            short(step)
        );
        let warning = Warning::new(WarningKind::Reduced, text);
        loader.note(index, [warning.with("asked", settings.step).with("step", step)]);
    }
    if left_out > 0 {
        let text = format!(
            "ambient_occlusion: time was up before {left_out} of {triangles} triangles, which are drawn without it"
        );
        let warning = Warning::new(WarningKind::Limited, text);
        loader.note(index, [warning.with("left_out", left_out as f64).with("of", triangles as f64)]);
    }
    Ok(mesh)
}

/// All files and arrays of the layer joined into one.
fn source(loader: &mut Loader<'_>, index: usize, doc: &MeshDoc) -> Result<MeshFile, BelvedereError> {
    if let Paths::One(name) = &doc.source
        && builtin::is_name(name)
    {
        return loader.builtin(index, name, |kind| kind.mesh().map(|layer| of_mesh(&layer.mesh)));
    }
    let mut all: Option<MeshFile> = None;
    let options = loader.options;
    for path in loader.sources(index, &doc.source)? {
        options.progress.tick("reading meshes", 0.0)?;
        let file = match options.arrays.find(&path)? {
            Some(array) => loader.of_array(index, array, array.triangles()?.mesh(&path, &options.limits())?),
            None => loader.take(index, load_mesh(&path, &options.limits())?),
        };
        match &mut all {
            Some(all) => join(all, file),
            None => all = Some(file),
        }
    }
    Ok(all.unwrap_or_default())
}

/// Numbers of the parts of these names, separated by commas.
pub(super) fn wanted(layer: &MeshLayer, names: &str) -> Result<Vec<u32>, String> {
    let mut out = Vec::new();
    for name in names.split(',').map(str::trim) {
        let found = layer.parts_named(name);
        if found.is_empty() {
            let known: Vec<&str> = layer.names.iter().map(String::as_str).filter(|n| !n.is_empty()).collect();
            let shown: Vec<&str> = known.iter().copied().take(12).collect();
            return Err(match known.len() {
                0 => format!("select is \"{name}\", but the file names no parts; remove select"),
                n => format!(
                    "no part is called \"{name}\"; the {n} parts are {}{}",
                    shown.join(", "),
                    if n > 12 { ", ..." } else { "" }
                ),
            });
        }
        out.extend(found);
    }
    Ok(out)
}

fn of_mesh(mesh: &Mesh) -> MeshFile {
    let triangles = mesh.triangles().to_vec();
    let colors = (0..triangles.len()).map(|t| mesh.color_at(t, [1.0, 0.0, 0.0])).collect::<Option<Vec<_>>>();
    MeshFile {
        format: "builtin",
        positions: (0..mesh.vertex_count() as u32).map(|v| mesh.vertex(v)).collect(),
        triangles,
        normals: None,
        colors: colors.map_or(MeshColors::Layer, MeshColors::PerTriangle),
        ..MeshFile::default()
    }
}

/// Adds a file to others; colours are kept if both have them in the same form.
fn join(all: &mut MeshFile, other: MeshFile) {
    let first = all.positions.len() as u32;
    join_parts(all, &other);
    join_pictures(all, &other);
    all.positions.extend(other.positions);
    all.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    all.normals = match (all.normals.take(), other.normals) {
        (Some(mut a), Some(b)) => {
            a.extend(b);
            Some(a)
        }
        _ => None,
    };
    all.colors = match (std::mem::take(&mut all.colors), other.colors) {
        (MeshColors::PerVertex(mut a), MeshColors::PerVertex(b)) => {
            a.extend(b);
            MeshColors::PerVertex(a)
        }
        (MeshColors::PerTriangle(mut a), MeshColors::PerTriangle(b)) => {
            a.extend(b);
            MeshColors::PerTriangle(a)
        }
        _ => MeshColors::Layer,
    };
}

/// Appends the parts of a file to those of others.
fn join_parts(all: &mut MeshFile, other: &MeshFile) {
    if all.names.is_empty() && other.names.is_empty() {
        return;
    }
    if all.names.is_empty() {
        all.names.push(String::new());
        all.parts = vec![0; all.triangles.len()];
    }
    let next = all.names.len() as u32;
    if other.names.is_empty() {
        all.names.push(String::new());
        all.parts.extend(std::iter::repeat_n(next, other.triangles.len()));
    } else {
        all.names.extend(other.names.iter().cloned());
        all.parts.extend(other.parts.iter().map(|p| p + next));
    }
}

/// Appends the pictures of a file to those of others.
fn join_pictures(all: &mut MeshFile, other: &MeshFile) {
    if all.texturing.is_none() && other.texturing.is_none() {
        return;
    }
    let bare = |n: usize| Texturing {
        of_triangle: vec![Texturing::NONE; n],
        corners: vec![Default::default(); n],
        ..Texturing::default()
    };
    let mut both = all.texturing.take().unwrap_or_else(|| bare(all.triangles.len()));
    let next = other.texturing.clone().unwrap_or_else(|| bare(other.triangles.len()));
    let first = both.textures.len() as u32;
    both.textures.extend(next.textures);
    both.of_triangle.extend(next.of_triangle.iter().map(|&t| if t == Texturing::NONE { t } else { t + first }));
    both.corners.extend(next.corners);
    all.texturing = Some(both);
}

/// Scales, rotates about x, then y, then z, and translates.
fn apply(file: &mut MeshFile, transform: &TransformDoc) -> Result<(), String> {
    if !(transform.scale > 0.0) {
        return Err(format!("scale is {}, it must be greater than 0", transform.scale));
    }
    let turn = turn(transform);
    let to = DVec3::from_array(transform.translate);
    file.positions.iter_mut().for_each(|p| *p = turn * (transform.scale * *p) + to);
    if let Some(normals) = &mut file.normals {
        normals.iter_mut().for_each(|n| *n = turn * *n);
    }
    Ok(())
}

/// Rotation about x, then y, then z.
pub(super) fn turn(transform: &TransformDoc) -> DMat3 {
    let [x, y, z] = transform.rotate_deg.map(f64::to_radians);
    DMat3::from_euler(EulerRot::ZYX, z, y, x)
}

/// Converts x and y from the file's coordinate system to the scene's; heights are unchanged.
fn reproject(file: &mut MeshFile, from: &str, to: Crs) -> Result<(), String> {
    let code = epsg(from).ok_or_else(|| format!("crs \"{from}\" is not known; give \"EPSG:n\""))?;
    let from = CoordinateSystem::from_epsg(code).map_err(|e| e.to_string())?;
    let to = CoordinateSystem::from_scene(to).map_err(|e| e.to_string())?;
    let transform = Transform::new(&from, &to).map_err(|e| e.to_string())?;
    let flat: Vec<DVec2> = file.positions.iter().map(|p| p.truncate()).collect();
    for (p, xy) in file.positions.iter_mut().zip(transform.forward(&flat)) {
        let xy = xy.ok_or_else(|| format!("({}, {}) lies outside the domain of {}; check crs", p.x, p.y, to.name()))?;
        *p = xy.extend(p.z);
    }
    Ok(())
}

//! Mesh layers: files or built in, placed in the scene.

use super::builtin;
use super::ground::{Ground, epsg};
use super::loader::Loader;
use crate::BelvedereError;
use crate::scene_file::{MeshDoc, Paths, TransformDoc};
use belvedere_core::{DVec2, DVec3};
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::{MeshFile, load_mesh};
use belvedere_scene::{Crs, LayerKind, Mesh, MeshColors, MeshLayer};
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
    let mesh = Mesh::new(&file.positions, file.triangles, file.colors);
    let mesh = mesh.and_then(|mesh| match file.normals.filter(|_| doc.style.smooth) {
        Some(normals) => mesh.with_normals(&normals),
        None => Ok(mesh),
    });
    Ok(LayerKind::Mesh(MeshLayer { mesh: mesh.map_err(|e| loader.fail(index, "source", e))?, color }))
}

/// All files of the layer as one.
fn source(loader: &mut Loader<'_>, index: usize, doc: &MeshDoc) -> Result<MeshFile, BelvedereError> {
    if let Paths::One(name) = &doc.source
        && builtin::is_name(name)
    {
        return loader.builtin(index, name, |kind| match kind {
            LayerKind::Mesh(layer) => Some(of_mesh(&layer.mesh)),
            _ => None,
        });
    }
    let mut all: Option<MeshFile> = None;
    for path in loader.files(index, "source", &doc.source)? {
        loader.options.progress.tick("reading meshes", 0.0)?;
        let loaded = load_mesh(&path, &loader.options.limits())?;
        let file = loader.take(index, loaded);
        match &mut all {
            Some(all) => join(all, file),
            None => all = Some(file),
        }
    }
    Ok(all.unwrap_or_default())
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
    }
}

/// Adds a file to others; colours survive where both have them in the same way.
fn join(all: &mut MeshFile, other: MeshFile) {
    let first = all.positions.len() as u32;
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

/// Scales, turns about x, then y, then z, and moves.
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

/// Takes x and y from the file's system to the scene's; heights stay.
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

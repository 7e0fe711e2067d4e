//! Lines, areas, points from files, laid on the terrain.

use super::ground::Ground;
use super::loader::Loader;
use crate::BelvedereError;
use crate::scene_file::Paths;
use belvedere_io::vector::{
    AreaKind, Geometry, Vectors, area_kind, areas_on_terrain, lines_on_terrain, load_vectors, points_on_terrain,
};
use belvedere_io::{IoError, Loaded};
use belvedere_scene::{AreaFeature, AreaSurface, Crs, Heightfield, LineFeature, PointFeature};

/// What a file of features is mostly about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FeatureKind {
    /// It has lines.
    Lines,
    /// It has areas and no lines.
    Areas,
    /// It has points alone.
    Points,
}

/// Lines if a file has any, else areas, else points.
pub(crate) fn kind_of(vectors: &Vectors) -> FeatureKind {
    let has = |wanted: fn(&Geometry) -> bool| vectors.features.iter().any(|f| wanted(&f.geometry));
    if has(|g| matches!(g, Geometry::Lines(_))) {
        FeatureKind::Lines
    } else if has(|g| matches!(g, Geometry::Polygons(_))) {
        FeatureKind::Areas
    } else {
        FeatureKind::Points
    }
}

type OnTerrain<T> = fn(&Vectors, Crs, Option<&Heightfield>) -> Result<Loaded<Vec<T>>, IoError>;

fn all<T>(
    loader: &mut Loader<'_>,
    index: usize,
    paths: &Paths,
    ground: &Ground<'_>,
    on_terrain: OnTerrain<T>,
    mut inspect: impl FnMut(&Vectors),
) -> Result<Vec<T>, BelvedereError> {
    let mut features = Vec::new();
    for file in loader.files(index, "source", paths)? {
        loader.options.progress.tick("reading features", 0.0)?;
        let vectors = loader.vectors.remove(&file).map_or_else(|| load_vectors(&file), Ok)?;
        let mut vectors = loader.take(index, vectors);
        inspect(&vectors);
        stand(loader, index, &mut vectors);
        let found = on_terrain(&vectors, ground.crs, ground.terrain)?;
        features.extend(loader.take(index, found));
    }
    Ok(features)
}

/// Lays lines and points without heights on the ground of the cities, where there is no terrain.
fn stand(loader: &mut Loader<'_>, index: usize, vectors: &mut Vectors) {
    let Some(floor) = loader.floor else { return };
    let flat = |g: &&mut Geometry| !matches!(g, Geometry::Polygons(_));
    let vertices = vectors.features.iter_mut().map(|f| &mut f.geometry).filter(flat).flat_map(Geometry::vertices_mut);
    let mut count = 0;
    for v in vertices.filter(|v| v.z.is_none()) {
        (v.z, count) = (Some(floor), count + 1);
    }
    if count > 0 {
        let path = vectors.path.display();
        let note = format!("{path}: {count} positions without height lie at {floor:.1} m, the ground of the city");
        loader.note(index, vec![note]);
    }
}

/// Lines of files, draped.
pub(super) fn lines(
    loader: &mut Loader<'_>,
    index: usize,
    paths: &Paths,
    ground: &Ground<'_>,
) -> Result<Vec<LineFeature>, BelvedereError> {
    all(loader, index, paths, ground, lines_on_terrain, |_| ())
}

/// Areas of files, and what they are: what the first file says that knows.
pub(super) fn areas(
    loader: &mut Loader<'_>,
    index: usize,
    id: &str,
    paths: &Paths,
    ground: &Ground<'_>,
) -> Result<(Vec<AreaFeature>, AreaKind), BelvedereError> {
    let mut kinds: Vec<AreaKind> = Vec::new();
    let features = all(loader, index, paths, ground, areas_on_terrain, |v| kinds.push(area_kind(v, &[id])))?;
    let known = kinds.iter().position(|k| k.surface != AreaSurface::Outline).unwrap_or(0);
    let nothing = || AreaKind { surface: AreaSurface::Outline, why: "there are none".into() };
    Ok((features, kinds.into_iter().nth(known).unwrap_or_else(nothing)))
}

/// Points of files, on the ground.
pub(super) fn points(
    loader: &mut Loader<'_>,
    index: usize,
    paths: &Paths,
    ground: &Ground<'_>,
) -> Result<Vec<PointFeature>, BelvedereError> {
    all(loader, index, paths, ground, points_on_terrain, |_| ())
}

//! Lines, areas and points from files, draped on the terrain.

use super::ground::Ground;
use super::loader::Loader;
use super::{by_property, line_classes, named};
use crate::BelvedereError;
use crate::city_ground::OwnGround;
use belvedere_core::{DVec2, Warning, WarningKind};
use belvedere_document::{LayerDoc, Paths};
use belvedere_io::city::is_meant;
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::load_vectors;
use belvedere_io::vector::{
    AreaKind, Geometry, OnGround, Vectors, Vertex, area_kind, areas_on_terrain, lines_on_terrain, points_on_terrain,
};
use belvedere_io::{Arrays, IoError, Loaded};
use belvedere_scene::{AreaFeature, AreaSurface, Crs, Heightfield, LineFeature, PointFeature};
use std::mem::take;
use std::path::Path;

/// Main kind of the features of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeatureKind {
    /// It has lines.
    Lines,
    /// It has areas and no lines.
    Areas,
    /// It has points alone.
    Points,
}

/// Lines if a file has any, else areas, else points.
pub fn kind_of(vectors: &Vectors) -> FeatureKind {
    let has = |wanted: fn(&Geometry) -> bool| vectors.features.iter().any(|f| wanted(&f.geometry));
    if has(|g| matches!(g, Geometry::Lines(_))) {
        FeatureKind::Lines
    } else if has(|g| matches!(g, Geometry::Polygons(_))) {
        FeatureKind::Areas
    } else {
        FeatureKind::Points
    }
}

impl FeatureKind {
    /// Plural of its name.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Lines => "lines",
            Self::Areas => "areas",
            Self::Points => "points",
        }
    }

    fn is(self, geometry: &Geometry) -> bool {
        match self {
            Self::Lines => matches!(geometry, Geometry::Lines(_)),
            Self::Areas => matches!(geometry, Geometry::Polygons(_)),
            Self::Points => matches!(geometry, Geometry::Points(_)),
        }
    }
}

/// All kinds of features in a file, the main one first.
pub fn kinds_of(vectors: &Vectors) -> Vec<FeatureKind> {
    let kinds = [FeatureKind::Lines, FeatureKind::Areas, FeatureKind::Points];
    let has = |kind: &FeatureKind| vectors.features.iter().any(|f| kind.is(&f.geometry));
    kinds.into_iter().filter(has).collect()
}

/// Warning about features of a file that no layer of the scene draws, if there are any.
fn left_out(loader: &Loader<'_>, index: usize, file: &str, vectors: &Vectors) -> Option<Warning> {
    // Outlines of areas are also lines.
    let drawn = |layer: &LayerDoc, kind: FeatureKind| match layer {
        LayerDoc::Line(l) => l.source.as_ref().is_some_and(|s| names(s, file)) && kind != FeatureKind::Points,
        LayerDoc::Area(l) => names(&l.source, file) && kind == FeatureKind::Areas,
        LayerDoc::Point(l) => names(&l.source, file) && kind == FeatureKind::Points,
        LayerDoc::City(l) => names(&l.source, file),
        _ => false,
    };
    let first = loader.layers.iter().position(|l| kinds_of(vectors).iter().any(|kind| drawn(l, *kind)));
    if first != Some(index) {
        return None; // The warning is given once.
    }
    let count = |kind: FeatureKind| vectors.features.iter().filter(|f| kind.is(&f.geometry)).count();
    let undrawn_kinds: Vec<FeatureKind> =
        kinds_of(vectors).into_iter().filter(|kind| !loader.layers.iter().any(|l| drawn(l, *kind))).collect();
    let undrawn: usize = undrawn_kinds.iter().map(|kind| count(*kind)).sum();
    let lost: Vec<String> =
        undrawn_kinds.into_iter().map(|kind| format!("{} features that are {}", count(kind), kind.plural())).collect();
    (!lost.is_empty()).then(|| {
        let path = vectors.path.display();
        let text = format!(
            "{path}: {} are drawn by no layer; add layers of kind line, area or point of the same file",
            lost.join(" and ")
        );
        Warning::new(WarningKind::Ignored, text).with("count", undrawn as f64)
    })
}

/// The property that a layer takes names from, if it says one.
fn name_field(layer: &LayerDoc) -> Option<&str> {
    match layer {
        LayerDoc::Line(l) => l.name_field.as_deref(),
        LayerDoc::Area(l) => l.name_field.as_deref(),
        LayerDoc::Point(l) => l.name_field.as_deref(),
        _ => None,
    }
}

/// The features that a layer means, if it says which.
fn select<'l>(loader: &Loader<'l>, index: usize) -> Option<&'l str> {
    match loader.layers.get(index)? {
        LayerDoc::Line(l) => l.select.as_deref(),
        _ => None,
    }
}

/// Keeps the features that `select` means.
fn kept(vectors: &mut Vectors, select: &str) -> Result<(), String> {
    let before = vectors.features.len();
    vectors.features.retain(|f| is_meant(select, &f.name, &f.properties));
    match vectors.features.is_empty() {
        true => Err(format!(
            "none of its {before} features is meant by \"{select}\"; give a name, an id or key=value, `info` lists them"
        )),
        false => Ok(()),
    }
}

fn names(paths: &Paths, file: &str) -> bool {
    paths.as_slice().iter().any(|name| name == file)
}

/// The features of a file or of an array.
pub fn read(path: &Path, arrays: &Arrays) -> Result<Loaded<Vectors>, IoError> {
    match arrays.find(path)? {
        Some(array) => Ok(array.features()?.with_file(array.record().clone())),
        None => load_vectors(path),
    }
}

type OnTerrain<T> = fn(&Vectors, Crs, Option<&Heightfield>) -> Result<Loaded<OnGround<T>>, IoError>;

fn all<T>(
    loader: &mut Loader<'_>,
    index: usize,
    paths: &Paths,
    ground: &Ground<'_>,
    on_terrain: OnTerrain<T>,
    mut inspect: impl FnMut(&Vectors),
) -> Result<OnGround<T>, BelvedereError> {
    let mut all = Vec::new();
    for (name, file) in paths.as_slice().iter().zip(loader.sources(index, paths)?) {
        loader.options.progress.tick("reading features", 0.0)?;
        let known = loader.vectors.get_mut(&file).map(|known| {
            // Warnings are given once.
            Loaded { value: known.value.clone(), warnings: take(&mut known.warnings), files: take(&mut known.files) }
        });
        let vectors = known.map_or_else(|| read(&file, &loader.options.arrays), Ok)?;
        let mut vectors = loader.take(index, vectors);
        loader.note(index, left_out(loader, index, name, &vectors));
        inspect(&vectors);
        if let Some(field) = loader.layers.get(index).and_then(name_field) {
            vectors.name_by(field).map_err(|reason| loader.fail(index, "name_field", reason))?;
        }
        if let Some(select) = select(loader, index) {
            let select = select.to_owned();
            kept(&mut vectors, &select).map_err(|reason| loader.fail(index, "select", reason))?;
        }
        stand(loader, index, &mut vectors, ground.crs);
        all.push(vectors);
    }
    named::tell(loader, index, &mut all)?;
    if let Some(LayerDoc::Line(line)) = loader.layers.get(index) {
        all.iter_mut().for_each(|file| line_classes::tell(line, file));
    }
    // Classes are those of all files together.
    by_property::style(loader, index, &mut all)?;
    let mut out = OnGround { features: Vec::new(), beyond: 0.0 };
    for vectors in all {
        let found = loader.take(index, on_terrain(&vectors, ground.crs, ground.terrain)?);
        out.features.extend(found.features);
        out.beyond += found.beyond;
    }
    Ok(out)
}

/// Places lines and points without heights on the ground of the cities if there is no terrain. Lines follow a sloping ground.
fn stand(loader: &mut Loader<'_>, index: usize, vectors: &mut Vectors, crs: Crs) {
    let Some(ground) = loader.own_ground.clone() else { return };
    // Files whose positions cannot be placed are refused later.
    let to = CoordinateSystem::from_scene(crs);
    let transform = to.and_then(|to| Transform::new(&vectors.crs, &to)).ok();
    let metres = |xy: DVec2| transform.as_ref().map_or(Some(xy), |t| t.forward_one(xy));
    let mut count = 0;
    for geometry in vectors.features.iter_mut().map(|f| &mut f.geometry) {
        if let (OwnGround::Sloping(field), Geometry::Lines(lines)) = (&ground, &mut *geometry) {
            let step = field.spacing().x;
            lines.iter_mut().for_each(|line| *line = divided(line, step, &metres));
        }
        if matches!(geometry, Geometry::Polygons(_)) {
            continue;
        }
        for v in geometry.vertices_mut().filter(|v| v.z.is_none()) {
            (v.z, count) = (metres(v.xy).map(|xy| ground.at(xy)), count + 1);
        }
    }
    if count > 0 {
        let path = vectors.path.display();
        let warning = |at: &str| {
            let note = format!("{path}: {count} positions without height lie {at}the ground of the city");
            Warning::new(WarningKind::Assumed, note).with("count", f64::from(count))
        };
        let said = match ground {
            OwnGround::Level(z) => warning(&format!("at {z:.1} m, ")).with("height_m", z),
            OwnGround::Sloping(_) => warning("on "),
        };
        loader.note(index, [said]);
    }
}

/// A line whose stretches without heights are at most `step` metres long.
fn divided(line: &[Vertex], step: f64, metres: &dyn Fn(DVec2) -> Option<DVec2>) -> Vec<Vertex> {
    const MOST_PARTS: f64 = 1000.0;
    let mut out = Vec::with_capacity(line.len());
    for pair in line.windows(2) {
        let length = metres(pair[0].xy).zip(metres(pair[1].xy)).map_or(0.0, |(a, b)| a.distance(b));
        let open = pair.iter().all(|v| v.z.is_none());
        let parts = if open { (length / step).ceil().clamp(1.0, MOST_PARTS) } else { 1.0 };
        out.push(pair[0]);
        let at = |k: usize| Vertex { xy: pair[0].xy.lerp(pair[1].xy, k as f64 / parts), z: None };
        out.extend((1..parts as usize).map(at));
    }
    out.extend(line.last());
    out
}

/// Lines of files, draped.
pub(super) fn lines(
    loader: &mut Loader<'_>,
    index: usize,
    paths: &Paths,
    ground: &Ground<'_>,
) -> Result<OnGround<LineFeature>, BelvedereError> {
    all(loader, index, paths, ground, lines_on_terrain, |_| ())
}

/// Areas of files, and their surface: that of the first file that gives one.
pub(super) fn areas(
    loader: &mut Loader<'_>,
    index: usize,
    id: &str,
    paths: &Paths,
    ground: &Ground<'_>,
) -> Result<(OnGround<AreaFeature>, AreaKind), BelvedereError> {
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
) -> Result<OnGround<PointFeature>, BelvedereError> {
    all(loader, index, paths, ground, points_on_terrain, |_| ())
}

//! City layers: files placed in the scene, on its terrain where there is one.

use super::builtin;
use super::city_mesh::{Stand, mesh};
use super::ground::{Ground, epsg};
use super::loader::Loader;
use super::mesh::{wanted, with_ambient_occlusion};
use crate::BelvedereError;
use crate::by_property;
use crate::city_blocks;
use crate::city_colors::{self, Values};
use crate::city_ground::{Bases, OwnGround};
use belvedere_construct::generalise::{GeneraliseSettings, LevelReport, generalise};
use belvedere_core::DVec2;
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{CityDoc, LayerDoc, Paths};
use belvedere_io::city::{CityAbout, CityColors, plate_extent, reproject};
use belvedere_io::crs::CoordinateSystem;
use belvedere_io::{CityFile, load_city};
use belvedere_scene::{City, Color, Crs, HeightSource, LayerKind, RigidParts, Surface};
use std::collections::HashSet;

/// Widest city, with its rim, metres.
const WIDEST_M: f64 = 1.5e6;
/// Format of cities that no file holds.
const BUILT_IN: &str = "built in";
/// Difference between city ground and terrain above which a warning is given, metres.
const NOTED_M: f64 = 1.0;

/// The files of a layer, each read once.
pub(super) fn files(loader: &mut Loader<'_>, index: usize, doc: &CityDoc) -> Result<Vec<CityFile>, BelvedereError> {
    if let Some(files) = loader.cities.get(&index) {
        return Ok(files.clone());
    }
    let mut files = Vec::new();
    for name in doc.source.as_slice() {
        if builtin::is_name(name) {
            let city = builtin::city(name, loader.options.seed).map_err(|e| loader.fail(index, "source", e))?;
            files.push(built_in(name, city));
            continue;
        }
        let path = loader.files(index, "source", &Paths::One(name.clone()))?.remove(0);
        loader.options.progress.tick("reading cities", 0.0)?;
        let loaded = load_city(&path, doc.lod.as_deref(), &loader.options.limits())
            .map_err(|e| loader.in_layer(index, e.into()))?;
        files.push(loader.take(index, loaded));
    }
    if files.is_empty() {
        return Err(loader.fail(index, "source", "source is an empty list; name at least one file"));
    }
    loader.cities.insert(index, files.clone());
    Ok(files)
}

fn built_in(name: &str, city: City) -> CityFile {
    let (path, format) = (name.into(), BUILT_IN.into());
    CityFile { path, format, crs: None, reference: String::new(), lods: Vec::new(), city, about: Vec::new() }
}

/// The coordinate system of a scene with this city alone: the city's own if scenes support it, else the UTM zone of its middle.
pub(super) fn crs(loader: &mut Loader<'_>, index: usize, doc: &CityDoc) -> Result<Option<Crs>, BelvedereError> {
    let files = files(loader, index, doc)?;
    let Some(file) = files.first() else { return Ok(None) };
    let stated = stated(loader, index, doc)?;
    let system = file.metric_system(stated.as_ref()).map_err(|e| loader.fail(index, "crs", e))?;
    Ok(system.and_then(|s| s.epsg()).map(Crs::Epsg))
}

/// The ground of all cities, in a scene without terrain; `None` if the files give no such heights.
pub(super) fn own_ground(loader: &mut Loader<'_>, crs: Crs) -> Result<Option<OwnGround>, BelvedereError> {
    let mut bases = Bases::default();
    let docs = loader.layers;
    for (index, doc) in docs.iter().enumerate() {
        if let LayerDoc::City(doc) = doc {
            let stated = stated(loader, index, doc)?;
            for file in files(loader, index, doc)? {
                let mut city = file.city;
                if let (Some(from), Crs::Epsg(_)) = (stated.as_ref().or(file.crs.as_ref()), crs) {
                    let to = CoordinateSystem::from_scene(crs).map_err(|e| loader.fail(index, "crs", e))?;
                    reproject(&mut city, from, &to).map_err(|e| loader.fail(index, "crs", e))?;
                }
                bases.add(&city, doc.height_offset_m);
            }
        }
    }
    Ok(bases.ground())
}

/// The coordinate system that the document gives for the files.
fn stated(loader: &Loader<'_>, index: usize, doc: &CityDoc) -> Result<Option<CoordinateSystem>, BelvedereError> {
    let Some(stated) = &doc.crs else { return Ok(None) };
    let unknown = || loader.fail(index, "crs", format!("crs \"{stated}\" is not known; give \"EPSG:n\""));
    let code = epsg(stated).ok_or_else(unknown)?;
    CoordinateSystem::from_epsg(code).map(Some).map_err(|e| loader.fail(index, "crs", e))
}

/// The layer.
pub(super) fn layer(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &CityDoc,
    ground: &Ground<'_>,
) -> Result<LayerKind, BelvedereError> {
    let style = &doc.style;
    let mut colors = CityColors {
        roof: loader.color(index, &style.roof)?,
        wall: loader.color(index, &style.wall)?,
        ground: loader.color(index, &style.ground)?,
        buildings: Vec::new(),
    };
    let (mut city, mut about) = (City::default(), Vec::new());
    let stated = stated(loader, index, doc)?;
    for file in files(loader, index, doc)? {
        let mut part = file.city;
        about.extend(file.about);
        if let (Some(from), Crs::Epsg(_)) = (stated.as_ref().or(file.crs.as_ref()), ground.crs) {
            let to = CoordinateSystem::from_scene(ground.crs).map_err(|e| loader.fail(index, "crs", e))?;
            let lost = reproject(&mut part, from, &to).map_err(|e| loader.fail(index, "crs", e))?;
            let what = format!("shapes lie outside the domain of {} and are left out", to.name());
            loader.note(index, Warning::counted(WarningKind::Ignored, lost, &what));
        } else if let (true, Crs::Epsg(_)) = (file.format != BUILT_IN, ground.crs) {
            let (path, scene) = (file.path.display(), ground.crs);
            let said = format!(
                "{path}: names no system that is known and is taken as in {scene}, as the scene is; set crs if it is not"
            );
            loader.note(index, [Warning::new(WarningKind::Assumed, said)]);
        }
        renumber(&mut part, city.pictures.len() as u32);
        city.pictures.extend(part.pictures);
        city.buildings.extend(part.buildings);
        city.structures.extend(part.structures);
        city.ways.extend(part.ways);
        city.areas.extend(part.areas);
    }
    lift(&mut city, doc.height_offset_m);
    loader.note(index, without_height(&city));
    // Levels of abstraction of one city have one ground, and end alike.
    let extent = plate_extent(&city);
    let terrain = |xy: DVec2| ground.terrain.and_then(|t| t.surface_at(xy));
    let own = loader.own_ground.clone().unwrap_or(OwnGround::Level(0.0));
    let stand = if ground.terrain.is_some() { Stand::Terrain(&terrain) } else { Stand::Own(&own, extent) };
    if let Stand::Terrain(terrain) = stand {
        loader.note(index, datum(&city, terrain));
    }
    let mut values = match &style.color_by {
        Some(by) => {
            Some(Values::of(by, &city, &about).map_err(|c| by_property::complain(loader, index, "color_by", c))?)
        }
        None => None,
    };
    if doc.loa > 0 {
        let sizes = values.as_ref().map(|_| city_colors::sizes(&city.buildings)).unwrap_or_default();
        let (level, members) = abstraction(loader, index, &city, doc, &stand)?;
        values = values.map(|values| values.joined(&members, &sizes));
        city = level;
    }
    if let (Some(values), Some(by)) = (&values, &style.color_by) {
        let found = values.colors(by, loader.id(index));
        let (of, note) = found.map_err(|c| by_property::complain(loader, index, "color_by", c))?;
        colors.buildings = of;
        loader.notes.classes.push(note);
    }
    if let Stand::Terrain(terrain) = stand {
        let lost =
            leave_out_beyond(&mut city, &mut colors.buildings, terrain).map_err(|e| loader.fail(index, "source", e))?;
        let undrawn = "areas of land cover are not drawn on terrain; use layers of kind area";
        let undrawn = Warning::counted(WarningKind::Ignored, city.areas.len(), undrawn);
        loader.note(index, lost.into_iter().chain(undrawn));
    }
    compact(&city).map_err(|e| loader.fail(index, "source", e))?;
    // Part 0 is the space between buildings; bridges and trees follow the buildings.
    let buildings = (1..=city.buildings.len() as u32).collect();
    let chosen = doc.select.as_deref().map(|select| meant(&city, &about, select));
    let mut layer = mesh(city, &colors, &stand).map_err(|e| loader.fail(index, "source", e))?;
    layer.mesh = with_ambient_occlusion(loader, index, layer.mesh, style.ambient_occlusion, ground)?;
    if doc.rigid {
        layer.rigid = RigidParts::Only(buildings);
    }
    layer.wanted = match (chosen, &doc.select) {
        (Some(parts), _) if !parts.is_empty() => Some(parts),
        (_, Some(select)) => Some(wanted(&layer, select).map_err(|e| loader.fail(index, "select", e))?),
        _ => None,
    };
    Ok(layer.into())
}

/// Numbers of the parts of the buildings and other solids that a text means: as a whole, or else separated by commas.
fn meant(city: &City, about: &[CityAbout], select: &str) -> Vec<u32> {
    let of = |by: &str| {
        let ids: HashSet<&str> = about.iter().filter(|a| a.is_meant(by)).map(|a| a.id.as_str()).collect();
        let solids = city.buildings.iter().map(|b| &b.id).chain(city.structures.iter().map(|s| &s.id));
        let named = solids.enumerate().filter(|(_, id)| ids.contains(id.as_str()));
        named.map(|(k, _)| k as u32 + 1).collect::<Vec<_>>()
    };
    let whole = of(select);
    if whole.is_empty() { select.split(',').flat_map(of).collect() } else { whole }
}

/// A city at a level of abstraction, and for each of its buildings those of `city` that it stands for.
fn abstraction(
    loader: &mut Loader<'_>,
    index: usize,
    city: &City,
    doc: &CityDoc,
    stand: &Stand<'_>,
) -> Result<(City, Vec<Vec<usize>>), BelvedereError> {
    let progress = &loader.options.progress;
    let settings = GeneraliseSettings { keep: doc.keep, ..GeneraliseSettings::default() };
    let mut found = generalise(city, &settings, progress).map_err(|e| loader.fail(index, "loa", e))?;
    let chosen = usize::from(doc.loa > 1);
    let level = &mut found.levels[chosen];
    match stand {
        // Volumes are those over the ground: without the feet of the walls.
        Stand::Terrain(terrain) => city_blocks::stand_on_terrain(level, city, terrain, 0.0),
        Stand::Own(ground, _) => city_blocks::stand(level, ground),
    }
    found.measure(city);
    let [fine, coarse] = found.levels;
    let mut level = if doc.loa == 1 { fine } else { coarse };
    if let Stand::Terrain(terrain) = stand {
        city_blocks::stand_on_terrain(&mut level, city, terrain, city_blocks::FOOT_M);
        // Floors are hidden in the ground, so they are removed.
        let blocks = level.city.buildings.iter_mut().take(level.blocks.len());
        blocks.for_each(|b| b.faces.retain(|f| f.surface != Surface::Ground));
    }
    // Notes on both levels tell how the city was generalised; of them only what is wrong with its outlines matters here.
    let matters = |note: &Warning| match note.subject() {
        Some(subject) => subject == level.name,
        None => note.kind() == WarningKind::Repaired,
    };
    loader.note(index, found.report.notes.into_iter().filter(matters));
    let report = found.report.levels.iter().find(|l| l.name == level.name);
    loader.note(index, report.map(LevelReport::failing).unwrap_or_default());
    let missed = report.and_then(|l| Some((l, l.missed()?)));
    loader.note(
        index,
        missed.map(|(l, text)| Warning::new(WarningKind::Inexact, text).with("volume_share", l.volume_share)),
    );
    // Areas of the city stay on the ground, with green cells over them.
    let areas = city.areas.iter().cloned().chain(level.city.areas).collect();
    Ok((City { areas, ..level.city }, level.members))
}

/// Adds `first` to the picture numbers of faces.
fn renumber(city: &mut City, first: u32) {
    let faces = city.buildings.iter_mut().flat_map(|b| &mut b.faces);
    let faces = faces.chain(city.structures.iter_mut().flat_map(|s| &mut s.faces));
    faces.filter_map(|f| f.picture.as_mut()).for_each(|picture| picture.number += first);
}

/// Number of buildings without a known height, in words.
fn without_height(city: &City) -> Option<Warning> {
    let (all, assumed) =
        (city.buildings.len(), city.buildings.iter().filter(|b| b.height_source == HeightSource::Assumed).count());
    let height = city.buildings.iter().find(|b| b.height_source == HeightSource::Assumed).map(|b| b.height_m);
    height.map(|height| {
        let text = format!("{assumed} of {all} buildings have no height and are drawn {height} m high; give them an attribute height or levels");
        let warning = Warning::new(WarningKind::Assumed, text).with("count", assumed as f64).with("of", all as f64);
        warning.with("height_m", height)
    })
}

/// Removes buildings that have neither a ground height of their own nor terrain under them, and their `colors`; returns a warning.
///
/// # Errors
/// If no building is left.
fn leave_out_beyond(
    city: &mut City,
    colors: &mut Vec<Option<Color>>,
    terrain: &dyn Fn(DVec2) -> Option<f64>,
) -> Result<Option<Warning>, String> {
    let under =
        |b: &belvedere_scene::Building| b.footprint.iter().flat_map(|p| &p.outer).any(|xy| terrain(*xy).is_some());
    let before = city.buildings.len();
    let stays: Vec<bool> = city.buildings.iter().map(|b| b.base_m.is_some() || under(b)).collect();
    let mut each = stays.iter();
    city.buildings.retain(|_| each.next() == Some(&true));
    let mut each = stays.iter();
    colors.retain(|_| each.next() == Some(&true));
    let lost = before - city.buildings.len();
    if lost > 0 && city.buildings.is_empty() && city.structures.is_empty() {
        return Err(format!(
            "none of its {before} buildings lies on the terrain; check the systems of both, and whether latitudes come before longitudes"
        ));
    }
    Ok((lost > 0).then(|| {
        let text = format!("{lost} of {before} buildings lie outside the terrain and are left out");
        Warning::new(WarningKind::Ignored, text).with("count", lost as f64).with("of", before as f64)
    }))
}

/// Refuses cities wider than the limit, in which some coordinates must be wrong.
fn compact(city: &City) -> Result<(), String> {
    let width_m = plate_extent(city).map_or(0.0, |[low, high]| (high - low).max_element());
    if width_m <= WIDEST_M {
        return Ok(());
    }
    Err(format!(
        "its shapes lie over {:.0} km, {:.0} km are possible; look for some far away from the others, such as with latitudes before longitudes",
        width_m / 1000.0,
        WIDEST_M / 1000.0
    ))
}

/// A warning where the ground of the buildings differs from the terrain.
fn datum(city: &City, terrain: &dyn Fn(DVec2) -> Option<f64>) -> Option<Warning> {
    let offset = |b: &belvedere_scene::Building| Some(b.base_m? - terrain(*b.footprint.first()?.outer.first()?)?);
    let mut offsets: Vec<f64> = city.buildings.iter().filter_map(offset).collect();
    let middle = offsets.len() / 2;
    let median = if offsets.is_empty() { 0.0 } else { *offsets.select_nth_unstable_by(middle, f64::total_cmp).1 };
    (median.abs() > NOTED_M).then(|| {
        let text = format!(
            "its buildings stand {:.1} m {} the terrain (median of {}); set height_offset_m = {:.1} if the datums differ",
            median.abs(),
            if median > 0.0 { "above" } else { "below" },
            offsets.len(),
            -median
        );
        let warning = Warning::new(WarningKind::Suspect, text).with("median_m", median);
        warning.with("count", offsets.len() as f64)
    })
}

/// Adds `by` to all heights, metres.
fn lift(city: &mut City, by: f64) {
    city.buildings.iter_mut().filter_map(|b| b.base_m.as_mut()).for_each(|z| *z += by);
    let faces = city.buildings.iter_mut().filter(|b| b.base_m.is_some()).flat_map(|b| &mut b.faces);
    let faces = faces.chain(city.structures.iter_mut().flat_map(|s| &mut s.faces));
    faces.flat_map(|f| &mut f.rings).flatten().for_each(|p| p.z += by);
}

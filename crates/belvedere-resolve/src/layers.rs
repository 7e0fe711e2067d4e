//! Reads the layers of a document into layers of a scene.

use super::ground::{Ground, epsg};
use super::line_classes;
use super::loader::Loader;
use super::{
    areas, boxes, builtin, by_property, city, dem, edge, fonts, land_cover, mesh, molecule, named, sea, vectors, volume,
};
use crate::record::AreaRecord;
use crate::{BelvedereError, Needs, OpenOptions};
use belvedere_builtin::{RouteCost, least_cost_route, valley_route};
use belvedere_core::DVec2;
use belvedere_core::Warning;
use belvedere_document::paths::Roots;
use belvedere_document::{
    AutoOrLength, HeightUnit, LayerDoc, LineDoc, Origin, PaletteDoc, Paths, PointLayerDoc, PositionDoc, RouteDoc,
    SwitchOrLength, SymbolDoc, TerrainDoc, TextDoc,
};
use belvedere_io::OnGround;
use belvedere_io::crs::CoordinateSystem;
use belvedere_io::terrain::OriginalTerrain;
use belvedere_io::vector::Vectors;
use belvedere_io::{DrapeRequest, split_table};
use belvedere_io::{InputFile, Loaded};
use belvedere_overlay::notes::LayerNotes;
use belvedere_scene::{
    Climate, Contours, CoverMap, Crs, DistanceMarkers, Drape, Drawing, FontFile, Heightfield, Layer, LayerKind,
    LineFeature, LineLayer, Palette, PaletteName, PointLayer, PointStyle, Symbol, TerrainLayer, drape_polyline,
};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Request for layers.
pub struct LayerRequest<'a> {
    /// Where the document comes from.
    pub origin: &'a Origin,
    /// The layers, in order.
    pub layers: &'a [LayerDoc],
    /// `auto`, `local` or `EPSG:n`.
    pub crs: &'a str,
    /// The coordinate system if `crs` is automatic and there is no terrain.
    pub fallback_crs: Option<Crs>,
    /// Layers to read: none, the terrain, or all.
    pub needs: Needs,
    /// Folders and files that may be read.
    pub roots: &'a Roots,
    /// Vector files that were read already.
    pub vectors: BTreeMap<PathBuf, Loaded<Vectors>>,
    /// Whether to keep the unchanged samples of the terrain's file.
    pub keep_original: bool,
    /// Fonts of the scene.
    pub text: Option<&'a TextDoc>,
    /// Further texts that fonts are needed for, such as the title.
    pub words: &'a str,
}

impl<'a> LayerRequest<'a> {
    /// A request for every layer.
    pub fn new(origin: &'a Origin, layers: &'a [LayerDoc], crs: &'a str, roots: &'a Roots) -> Self {
        let (fallback_crs, needs, vectors) = (None, Needs::Everything, BTreeMap::new());
        let (keep_original, text, words) = (false, None, "");
        Self { origin, layers, crs, fallback_crs, needs, roots, vectors, keep_original, text, words }
    }
}

/// Layers, with records and warnings of reading them.
pub struct LoadedLayers {
    pub layers: Vec<Layer>,
    /// Fonts that their names need.
    pub fonts: Vec<FontFile>,
    /// Symbols of the scene's own.
    pub drawings: Vec<Arc<Drawing>>,
    pub crs: Crs,
    pub inputs: Vec<InputFile>,
    pub warnings: Vec<Warning>,
    /// Surfaces found for the areas.
    pub areas: Vec<AreaRecord>,
    /// What furniture tells of the layers.
    pub notes: LayerNotes,
    pub original: Option<OriginalTerrain>,
}

/// The layers that are needed, in file order.
pub fn load(request: LayerRequest<'_>, options: &OpenOptions) -> Result<LoadedLayers, BelvedereError> {
    let LayerRequest { origin, layers: docs, fallback_crs, needs, roots, vectors, keep_original, .. } = request;
    let (text, words) = (request.text, request.words);
    let mut crs = stated_crs(origin, request.crs)?;
    let mut loader = Loader {
        origin,
        layers: docs,
        roots,
        options,
        builtins: builtin::Builtins::default(),
        inputs: Vec::new(),
        warnings: Vec::new(),
        areas: Vec::new(),
        notes: LayerNotes::default(),
        vectors,
        cities: BTreeMap::new(),
        own_ground: None,
        keep_original,
        original: None,
        drawings: Vec::new(),
        in_feet: text.is_some_and(|text| text.heights == HeightUnit::Foot),
    };
    let mut layers: Vec<Option<Layer>> = docs.iter().map(|_| None).collect();
    for (i, doc) in docs.iter().enumerate().filter(|_| needs != Needs::View) {
        if let LayerDoc::Terrain(doc) = doc {
            let (layer, found) = terrain(&mut loader, i, doc, crs).map_err(|e| loader.in_layer(i, e))?;
            crs.get_or_insert(found);
            layers[i] = Some(Layer { id: doc.id.clone(), must_see: false, kind: layer.into() });
        }
    }
    for (i, doc) in docs.iter().enumerate().filter(|_| needs != Needs::View) {
        if let (None, LayerDoc::City(doc)) = (crs, doc) {
            crs = city::crs(&mut loader, i, doc).map_err(|e| loader.in_layer(i, e))?;
        }
    }
    let crs = crs.or(fallback_crs).unwrap_or_default();
    if needs == Needs::Everything && first_terrain(&layers).is_none() {
        loader.own_ground = city::own_ground(&mut loader, crs)?;
    }
    for (i, doc) in docs.iter().enumerate().filter(|_| needs == Needs::Everything) {
        let ground = Ground { crs, terrain: first_terrain(&layers) };
        if let LayerDoc::Terrain(doc) = doc {
            let drapes = drapes(&mut loader, i, doc, &ground)?;
            if let Some(Layer { kind: LayerKind::Terrain(t), .. }) = &mut layers[i] {
                t.drapes = drapes;
            }
        } else {
            layers[i] = layer(&mut loader, i, doc, &ground).map_err(|e| loader.in_layer(i, e))?;
        }
    }
    // Layers keep their numbers: the sea comes last, but is drawn below all other areas.
    if needs == Needs::Everything {
        for (i, doc) in docs.iter().enumerate() {
            if let (LayerDoc::Terrain(doc), Some(Layer { kind: LayerKind::Terrain(t), .. })) = (doc, &layers[i]) {
                let (sea, edge) = (sea::layer(&mut loader, doc, t), edge::layer(&loader, doc, t));
                layers.extend([sea, edge]);
            }
        }
    }
    let fonts = match needs {
        Needs::Everything => fonts::choose(&mut loader, &layers[..docs.len()], text, words)?,
        Needs::View | Needs::Ground => Vec::new(),
    };
    loader.notes.credits = credits(&loader);
    let Loader { inputs, warnings, areas, notes, original, drawings, .. } = loader;
    let mut layers: Vec<Layer> = layers.into_iter().flatten().collect();
    share_surfaces(&mut layers);
    Ok(LoadedLayers { layers, fonts, drawings, crs, inputs, warnings, areas, notes, original })
}

/// Ids of layers and whom their files ask to be named, each once.
fn credits(loader: &Loader<'_>) -> Vec<(String, String)> {
    let mut credits = Vec::new();
    for doc in loader.layers {
        for name in doc.files().into_iter().filter(|name| !builtin::is_name(name)) {
            let Ok(path) = loader.roots.resolve(name) else { continue };
            let credit = belvedere_io::credit::of_file(split_table(&path).0).map(|text| (doc.id().to_owned(), text));
            credits.extend(credit.filter(|credit| !credits.contains(credit)));
        }
    }
    credits
}

/// Marks layers that were read from the same source as one surface.
fn share_surfaces(layers: &mut [Layer]) {
    for i in 1..layers.len() {
        let (before, [layer, ..]) = layers.split_at_mut(i) else { return };
        for other in before {
            layer.kind.share_surface(&other.kind);
        }
    }
}

fn first_terrain(layers: &[Option<Layer>]) -> Option<&Heightfield> {
    layers.iter().flatten().find_map(|l| l.kind.terrain().map(|t| &*t.heightfield))
}

/// The coordinate system that the document names; `None`: automatic.
pub(super) fn stated_crs(origin: &Origin, text: &str) -> Result<Option<Crs>, BelvedereError> {
    let text = text.trim();
    if text.eq_ignore_ascii_case("auto") {
        return Ok(None);
    }
    if text.eq_ignore_ascii_case("local") {
        return Ok(Some(Crs::Local));
    }
    let fail = |reason: String| origin.error(&["crs"], reason);
    let Some(code) = epsg(text) else {
        return Err(fail(format!("crs \"{text}\" is not known; give \"auto\", \"local\" or \"EPSG:n\"")).into());
    };
    let system = CoordinateSystem::from_epsg(code).map_err(|e| fail(format!("crs {e}")))?;
    if !system.suits_scenes() {
        return Err(fail(format!(
            "crs EPSG:{code} is not projected in metres with x east and y north; give a UTM zone or another metric system, or \"auto\""
        )).into());
    }
    Ok(Some(Crs::Epsg(code)))
}

/// The terrain of a layer and its coordinate system.
fn terrain(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    wanted: Option<Crs>,
) -> Result<(TerrainLayer, Crs), BelvedereError> {
    let style = &doc.style;
    let (heightfield, crs) = match doc.source.as_slice() {
        [name] if builtin::is_name(name) => {
            let heightfield =
                loader.builtin(index, name, |kind| kind.terrain().map(|layer| layer.heightfield.clone()))?;
            (heightfield, wanted.unwrap_or_default())
        }
        _ => {
            let (heightfield, crs) = dem::load(loader, index, doc, wanted)?;
            (heightfield.into(), crs)
        }
    };
    let palette = palette(loader, index, &style.palette)?;
    let cover = land_cover::load(loader, index, doc, &palette, &heightfield, crs)?;
    let palette = placed(palette, &heightfield, crs, cover);
    let palette = if style.materials { palette } else { without_materials(palette) };
    let layer = TerrainLayer {
        heightfield,
        drapes: Vec::new(),
        relief: style.relief,
        shading: style.shading,
        exaggeration: style.exaggeration,
        contours: contours(&style.contours).map(|interval| Contours::new(interval, &palette)),
        palette,
        edge: style.edge,
    };
    Ok((layer, crs))
}

/// The interval of the lines of equal height that a style asks for, if it does.
fn contours(stated: &Option<SwitchOrLength>) -> Option<Option<f64>> {
    match stated.as_ref()? {
        SwitchOrLength::Switch(on) => on.then_some(None),
        SwitchOrLength::Length(interval) => Some(Some(*interval)),
    }
}

/// A palette that depends on the place, with the climate in the middle of the ground, or one guessed from its heights.
fn placed(palette: Palette, ground: &Heightfield, crs: Crs, cover: Option<Arc<CoverMap>>) -> Palette {
    let Palette::Named(name) = palette else { return palette };
    if !name.has_materials() {
        return palette;
    }
    let bounds = ground.bounds();
    let middle = (0.5 * (bounds.min + bounds.max)).truncate();
    match (Ground { crs, terrain: None }).lon_lat(middle) {
        Some(at) => Palette::Placed(name, Climate::at(at.x, at.y), cover),
        // Ground without a place that is very high is rock and ice.
        None if bounds.max.z > 5000.0 && name == PaletteName::Auto && cover.is_none() => palette,
        None => Palette::Placed(name, Climate::of_heights([bounds.min.z, bounds.max.z]), cover),
    }
}

/// Tints by height alone that fit a palette of materials.
fn without_materials(palette: Palette) -> Palette {
    let (name, dry) = match &palette {
        Palette::Named(name) => (*name, false),
        Palette::Placed(name, climate, _) => (*name, climate.dryness > 0.5),
        Palette::Ramp(_) => return palette,
    };
    match name {
        PaletteName::Auto if dry => PaletteName::Desert.into(),
        PaletteName::Auto | PaletteName::Swiss | PaletteName::Autumn => PaletteName::Alpine.into(),
        PaletteName::Winter => PaletteName::Glacial.into(),
        other => other.into(),
    }
}

/// A palette by name or from its file.
fn palette(loader: &mut Loader<'_>, index: usize, doc: &PaletteDoc) -> Result<Palette, BelvedereError> {
    let name = match doc {
        PaletteDoc::Named(name) => return Ok((*name).into()),
        PaletteDoc::File(name) => name,
    };
    let fail = |e: String| {
        let reason = format!("layer \"{}\": {e}", loader.id(index));
        loader.origin.error(&["layer", &index.to_string(), "style", "palette"], reason)
    };
    let has_ending = std::path::Path::new(name).extension().is_some();
    let file = loader.roots.resolve(name).map_err(|e| {
        let reason = if has_ending { format!("palette: {e}") } else { PaletteDoc::unknown(name) };
        fail(reason)
    })?;
    let loaded = belvedere_io::load_ramp(&file).map_err(|e| fail(format!("palette: {}", loader.shown(&e))))?;
    Ok(Palette::Ramp(Arc::new(loader.take(index, loaded))))
}

/// Drapes for a terrain that is already loaded.
fn drapes(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    ground: &Ground<'_>,
) -> Result<Vec<Drape>, BelvedereError> {
    let Some(paths) = &doc.drape else { return Ok(Vec::new()) };
    let files = loader.files(index, "drape", paths)?;
    let Some(terrain) = ground.terrain else { return Ok(Vec::new()) };
    let request = DrapeRequest { limits: loader.options.limits(), ..DrapeRequest::default() };
    let mut drapes = Vec::new();
    for file in files {
        let loaded = belvedere_io::load_drape(&file, ground.crs, terrain, &request, &loader.options.progress);
        let loaded = loaded.map_err(|e| loader.fail(index, "drape", e))?;
        drapes.push(loader.take(index, loaded));
    }
    Ok(drapes)
}

/// A line layer.
fn line(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &LineDoc,
    ground: &Ground<'_>,
) -> Result<LayerKind, BelvedereError> {
    let whole = |features| OnGround { features, beyond: 0.0 };
    let OnGround { mut features, beyond } = match (&doc.source, &doc.route) {
        (_, Some(doc)) => whole(vec![route(loader, index, doc, ground)?]),
        (Some(Paths::One(name)), None) if builtin::is_name(name) => {
            whole(loader.builtin(index, name, |kind| kind.lines().map(|layer| layer.features.clone()))?)
        }
        (Some(paths), None) => vectors::lines(loader, index, paths, ground)?,
        (None, None) => whole(Vec::new()),
    };
    if features.is_empty() {
        return Err(loader.fail(index, "source", "no line lies on the terrain; check that the source covers it"));
    }
    let style = &doc.style;
    let is_of_files = matches!(&doc.source, Some(paths) if !paths.as_slice().iter().any(|name| builtin::is_name(name)));
    if !is_of_files || doc.route.is_some() {
        line_classes::tell_stated(doc, &mut features);
    }
    if ground.terrain.is_some() {
        line_classes::stretch_cables(&mut features);
    }
    let color = loader.color(index, &style.color)?;
    features.iter_mut().for_each(|f| f.style = by_property::as_opaque_as(color, f.style));
    Ok(LayerKind::Line(LineLayer {
        features,
        color,
        width_px: style.width_px,
        casing: loader.optional_color(index, &style.casing)?,
        hidden: style.hidden,
        lift_m: style.lift_m,
        markers: style.distance_markers_m.map(|m| match m {
            AutoOrLength::Auto(_) => DistanceMarkers::Auto,
            AutoOrLength::Length(every) => DistanceMarkers::Every(every),
        }),
        label_px: (style.labels || style.label.is_some()).then_some(style.label_px),
        marker_px: belvedere_scene::SMALL_LETTERS_PX,
        beyond,
    }))
}

fn route(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &RouteDoc,
    ground: &Ground<'_>,
) -> Result<LineFeature, BelvedereError> {
    let Some(terrain) = ground.terrain else {
        return Err(loader.fail(index, "route", "a generated route needs a terrain layer; add one"));
    };
    let seed = loader.options.seed.unwrap_or(doc.seed);
    let found = match (doc.from, doc.to) {
        (Some(from), Some(to)) => {
            let from = position(ground, from).map_err(|e| loader.fail(index, "route", e))?;
            let to = position(ground, to).map_err(|e| loader.fail(index, "route", e))?;
            least_cost_route(terrain, from, to, &RouteCost { wander: 1.5, seed, ..RouteCost::default() })
        }
        (None, None) => valley_route(terrain, seed),
        _ => {
            return Err(loader.fail(
                index,
                "route",
                "a route needs both from and to, or neither for a valley of its own",
            ));
        }
    };
    let path = found.map_err(|e| loader.fail(index, "route", e))?;
    let points = drape_polyline(terrain, &path).parts.into_iter().max_by_key(Vec::len).unwrap_or_default();
    if points.len() < 2 {
        return Err(loader.fail(index, "route", "the route has no length; move from and to apart"));
    }
    Ok(LineFeature { style: None, name: "generated route".into(), points })
}

/// A point layer.
fn point(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &PointLayerDoc,
    ground: &Ground<'_>,
) -> Result<LayerKind, BelvedereError> {
    // A wrong name is told before the file is read.
    let symbol = symbol(loader, index, &doc.style.symbol)?;
    let OnGround { mut features, beyond } = vectors::points(loader, index, &doc.source, ground)?;
    if features.is_empty() {
        return Err(loader.fail(index, "source", "no point lies on the terrain; check that the source covers it"));
    }
    let style = &doc.style;
    named::stand_out(style, &mut features, ground.terrain, loader.in_feet);
    let color = loader.color(index, &style.color)?;
    features.iter_mut().for_each(|f| f.style = by_property::as_opaque_as(color, f.style));
    Ok(LayerKind::Point(PointLayer {
        features,
        color,
        size_px: style.size_px,
        style: PointStyle {
            symbol,
            casing: loader.optional_color(index, &style.casing)?,
            label_px: (style.labels || style.label.is_some()).then_some(style.label_px),
        },
        hidden: style.hidden,
        lift_m: style.lift_m,
        beyond,
    }))
}

/// A symbol by name or from its file.
fn symbol(loader: &mut Loader<'_>, index: usize, doc: &SymbolDoc) -> Result<Symbol, BelvedereError> {
    let name = match doc {
        SymbolDoc::Auto => return Ok(Symbol::Dot),
        SymbolDoc::Named(symbol) => return Ok(*symbol),
        SymbolDoc::File(name) => name,
    };
    let fail = |loader: &Loader<'_>, e: String| {
        let reason = format!("layer \"{}\": {e}", loader.id(index));
        loader.origin.error(&["layer", &index.to_string(), "style", "symbol"], reason)
    };
    let has_ending = std::path::Path::new(name).extension().is_some();
    let file = loader.roots.resolve(name).map_err(|e| {
        let reason = if has_ending { format!("symbol: {e}") } else { SymbolDoc::unknown(name) };
        fail(loader, reason)
    })?;
    let loaded = belvedere_io::load_symbol(&file);
    let loaded = loaded.map_err(|e| fail(loader, format!("symbol: {}", loader.shown(&e))))?;
    let drawing = loader.take(index, loaded);
    loader.drawings.push(Arc::new(drawing));
    Ok(Symbol::Own((loader.drawings.len() - 1) as u16))
}

/// Any layer but terrain.
fn layer(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &LayerDoc,
    ground: &Ground<'_>,
) -> Result<Option<Layer>, BelvedereError> {
    let mut kind = match doc {
        LayerDoc::Terrain(_) => return Ok(None),
        LayerDoc::Line(doc) => line(loader, index, doc, ground)?,
        LayerDoc::Area(doc) => areas::layer(loader, index, doc, ground)?,
        LayerDoc::Point(doc) => point(loader, index, doc, ground)?,
        LayerDoc::Boxes(doc) => boxes::layer(loader, index, doc)?,
        LayerDoc::Mesh(doc) => mesh::layer(loader, index, doc, ground)?,
        LayerDoc::Molecule(doc) => molecule::layer(loader, index, doc)?,
        LayerDoc::Volume(doc) => volume::layer(loader, index, doc)?,
        LayerDoc::City(doc) => city::layer(loader, index, doc, ground)?,
    };
    kind.set_opacity(doc.opacity().unwrap_or(1.0) as f32);
    Ok(Some(Layer { id: doc.id().to_owned(), must_see: doc.must_see(), kind }))
}

fn position(ground: &Ground<'_>, position: PositionDoc) -> Result<DVec2, String> {
    match position {
        PositionDoc::Scene(xy) => Ok(DVec2::from_array(xy)),
        PositionDoc::Geographic(p) => ground.position_of(p.lon, p.lat),
    }
}

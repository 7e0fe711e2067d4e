//! `reveal --see`: the files of a request as one scene, and what is meant in it.

use super::given::Given;
use super::request::Request;
use crate::data::{features_of, text_of};
use crate::places::Place;
use crate::scene_file::{CityDoc, Document, LayerDoc, LineDoc, LineStyleDoc, Paths, SourceDocument};
use crate::verbs::city_names::{is_building, known_names};
use crate::verbs::found_view::provisional_camera;
use crate::verbs::model_layers::{ground, layer, set_transfer, unit_of};
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_construct::rays::Target;
use belvedere_construct::reveal::thresholds;
use belvedere_construct::sample_features;
use belvedere_core::{DVec2, DVec3};
use belvedere_io::city::is_meant;
use belvedere_io::formats::Reader;
use belvedere_io::{Known, Limits, arrays, load_city, split_table};
use belvedere_resolve::targets;
use belvedere_resolve::vectors::{FeatureKind, kinds_of};
use belvedere_scene::molecule::Selection;
use belvedere_scene::{LayerKind, Scene};
use std::mem::take;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of the part of a city that is its level ground.
const GROUND: u32 = 0;
/// Streets of a map beside what must be seen.
const STREETS: &str = "#b9b2a6";
const STREETS_PX: f64 = 1.6;

/// What must be seen in a scene.
#[derive(Debug, Clone)]
pub(super) enum Meant {
    /// A target by its name.
    Named(String),
    /// A layer that must be seen, or the chosen buildings of it.
    Solid(String),
    /// All lines and points that must be seen.
    Features,
}

/// A target three times.
pub(super) struct Targets {
    /// By few points, for the search of a bend.
    pub(super) search: Target,
    /// By many points, for shares.
    pub(super) judge: Target,
    /// As it is drawn, without the level ground of a city, which hides the feet of walls and no more.
    pub(super) shape: Target,
}

impl Targets {
    fn of(shape: Target, target: Target) -> Self {
        Self { search: target.clone(), judge: target, shape }
    }
}

impl Meant {
    pub(super) fn targets(&self, scene: &Scene) -> Result<Targets, BelvedereError> {
        match self {
            Self::Named(see) => targets::target(scene, see).map(|target| Targets::of(target.clone(), target)),
            Self::Solid(id) => {
                let shape = targets::target(scene, id)?;
                let mut target = shape.clone();
                if let Some((_, parts)) = target.own_parts.as_mut().filter(|(_, parts)| !parts.contains(&GROUND)) {
                    parts.insert(0, GROUND);
                }
                Ok(Targets::of(shape, target))
            }
            Self::Features => {
                let length: f64 = scene.must_see().map(|(_, layer)| length(&layer.kind)).sum();
                let features = sample_features(scene, (length / thresholds::SAMPLES_TO_JUDGE).max(1e-3));
                let points: Vec<DVec3> = features.iter().flat_map(|f| &f.samples).map(|s| s.p_world).collect();
                if points.is_empty() {
                    let reason = "the features that must be seen lie outside the ground, or hold no position";
                    return Err(BelvedereError::Target(reason.into()));
                }
                let every = points.len().div_ceil(thresholds::SAMPLES_IN_A_CITY).max(1);
                let search = Target::points(points.iter().skip(every / 2).step_by(every).copied());
                let judge = Target::points(points);
                Ok(Targets { search, shape: judge.clone(), judge })
            }
        }
    }

    /// Whether it is lines or points on the ground.
    pub(super) fn is_features(&self) -> bool {
        matches!(self, Self::Features)
    }

    /// Its name for the constructor of a scene file.
    pub(super) fn name(&self) -> Option<&str> {
        match self {
            Self::Named(name) | Self::Solid(name) => Some(name),
            Self::Features => None,
        }
    }
}

fn length(kind: &LayerKind) -> f64 {
    let flat =
        |points: &[DVec3]| points.windows(2).map(|w| DVec2::distance(w[0].truncate(), w[1].truncate())).sum::<f64>();
    kind.lines().map_or(0.0, |l| l.features.iter().map(|f| flat(&f.points)).filter(|length| length.is_finite()).sum())
}

/// Opens the files with a provisional camera.
pub(super) fn open(request: &Request<'_>) -> Result<(Session, Meant), BelvedereError> {
    let (see, options) = (request.see(), &request.open);
    let named = || Meant::Named(see.to_owned());
    if let [Given::Known(file)] = &request.given[..]
        && file.may_be_scene()
    {
        if request.asked.transfer.is_some() {
            let text = "a scene file states its transfer functions itself; leave {} out";
            return Err(BelvedereError::Argument(Advice::new(text, &["transfer"])));
        }
        let options = OpenOptions { image: request.image.or(options.image), ..options.clone() };
        return Ok((Session::open(&file.name, &options)?, named()));
    }
    let mut options = options.clone();
    let mut map = Map { see: see.to_owned(), ..Map::default() };
    let mut models: Vec<LayerDoc> = Vec::new();
    // A file that is given as data, too, is read once.
    let is_given = |seen: &Given| request.given.iter().any(|given| given.is_same(seen));
    let seen = seen_file(see).map(|file| Given::of(file, &options.arrays)).filter(|seen| !is_given(seen));
    for given in request.given.iter().chain(seen.as_ref()) {
        let known = match given {
            Given::Builtin(name) => {
                models.push(layer(name, None, &models)?);
                continue;
            }
            Given::Known(known) => known.clone(),
            Given::Unknown(name) => Arc::new(Known::of(name, &options.arrays)?),
        };
        options.allow_roots.extend(split_table(&known.path).0.parent().map(Path::to_owned));
        match known.reader {
            Some(Reader::City) => map.cities.push(known),
            Some(Reader::Terrain) => map.grounds.push(known),
            Some(Reader::Features) => map.features.push(known),
            Some(Reader::Mesh | Reader::Molecule | Reader::Volume) | None => {
                models.push(layer(&known.path, known.reader, &models)?);
            }
        }
    }
    map.take_footprints(&models)?;
    let is_city = !map.cities.is_empty() || matches!(models[..], [LayerDoc::City(_), ..]);
    if !is_city && let Some(known) = map.grounds.iter().chain(&map.features).next() {
        // The error names what can be looked into.
        layer(&known.path, None, &models)?;
    }
    let (layers, meant, crs) = match is_city {
        true => {
            let (layers, meant) = map.layers(models)?;
            (layers, meant, "auto")
        }
        false => {
            for layer in &mut models {
                if let LayerDoc::Molecule(molecule) = layer
                    && Selection::parse(see).is_ok()
                {
                    molecule.select = Some(see.to_owned());
                }
            }
            (models, named(), "local")
        }
    };
    let mut layers = layers;
    if let Some(transfer) = &request.asked.transfer {
        set_transfer(&mut layers, transfer, &mut options)?;
    }
    let unit = unit_of(&layers);
    let camera = provisional_camera();
    let title = match shown_name(see) {
        "" => "Revealed".into(),
        see => format!("{see} revealed"),
    };
    let text = text_of(take(&mut options.fonts), &mut options.allow_files)?;
    let document = Document { title, crs: crs.into(), unit, layer: layers, text, ..Document::seen_by(camera) };
    Ok((Session::from_document(SourceDocument::new(document), &options)?, meant))
}

/// What must be seen as titles and reports name it: a file by its name alone.
pub(super) fn shown_name(see: &str) -> &str {
    let file = seen_file(see).is_some().then(|| Path::new(see).file_name().and_then(|name| name.to_str()));
    file.flatten().unwrap_or(see)
}

/// The file that `--see` names, if it names one.
fn seen_file(see: &str) -> Option<PathBuf> {
    let is_file = !see.is_empty() && split_table(Path::new(see)).0.is_file();
    is_file.then(|| PathBuf::from(see))
}

/// The files of a scene with a city.
#[derive(Default)]
struct Map {
    see: String,
    cities: Vec<Arc<Known>>,
    grounds: Vec<Arc<Known>>,
    features: Vec<Arc<Known>>,
}

fn text(path: &Path) -> Result<String, BelvedereError> {
    path.to_str().map(str::to_owned).ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))
}

impl Map {
    /// Without a city model the polygons of the first file of features are footprints.
    fn take_footprints(&mut self, models: &[LayerDoc]) -> Result<(), BelvedereError> {
        if !(self.cities.is_empty() && self.grounds.is_empty() && models.is_empty()) {
            return Ok(());
        }
        if let Some(first) = self.features.first()
            && kinds_of(first.features()?).contains(&FeatureKind::Areas)
        {
            self.cities.push(self.features.remove(0));
        }
        Ok(())
    }

    /// The layers, with what must be seen.
    fn layers(self, models: Vec<LayerDoc>) -> Result<(Vec<LayerDoc>, Meant), BelvedereError> {
        let mut layers: Vec<LayerDoc> = Vec::new();
        if !self.grounds.is_empty() {
            layers.push(ground(self.grounds.iter().map(|known| text(&known.path)).collect::<Result<_, _>>()?));
        }
        layers.extend(models);
        for city in &self.cities {
            let (id, path) = (layer_id(&city.path, &layers), &city.path);
            layers.push(LayerDoc::City(CityDoc::of(id, &text(path)?)));
            if city.reader == Some(Reader::City) && holds_streets(city) {
                let id = format!("{}-streets", layers.last().map_or("", LayerDoc::id));
                let style = LineStyleDoc {
                    color: STREETS.into(),
                    width_px: STREETS_PX,
                    casing: "none".into(),
                    hidden: belvedere_scene::Hidden::Cut,
                    lift_m: 0.1,
                    ..LineStyleDoc::default()
                };
                layers.push(lines(id, &text(path)?, (Some("highway=*"), false), style));
            }
        }
        let first = layers.len();
        for known in &self.features {
            for kind in kinds_of(known.features()?) {
                let (id, source) = (layer_id(&known.path, &layers), text(&known.path)?);
                // In a city areas are drawn by their outlines, which lines of the same file hold already.
                match kind {
                    FeatureKind::Points => layers.push(features_of(known, &layers)?),
                    _ if layers[first..].iter().any(|l| draws(l, &source)) => {}
                    _ => layers.push(lines(id, &source, (None, true), LineStyleDoc::default())),
                }
            }
        }
        let meant = self.meant(&mut layers, first)?;
        Ok((layers, meant))
    }

    /// What must be seen; the layers from `first` on are those of features.
    fn meant(&self, layers: &mut Vec<LayerDoc>, first: usize) -> Result<Meant, BelvedereError> {
        let see = self.see.as_str();
        let cities: Vec<&Path> = self.cities.iter().map(|city| city.path.as_path()).collect();
        if see.is_empty() {
            return match layers.len() > first {
                true => Ok(Meant::Features),
                false => {
                    let text = "nothing is named that must be seen; give {} WHAT or a file of routes: ";
                    let advice = Advice::new(text, &["see"]).then(known_names(&cities, "")?);
                    Err(BelvedereError::Argument(advice))
                }
            };
        }
        if see.parse::<Place>().is_ok_and(|place| place.has_height()) {
            return Ok(Meant::Named(see.to_owned()));
        }
        let file = seen_file(see).and_then(|file| belvedere_io::fs::canonicalize(split_table(&file).0).ok());
        let is_file = |known: &&Arc<Known>| file.as_ref().is_some_and(|file| split_table(&known.path).0 == file);
        let of_file = self.features.iter().find(is_file).map(|known| text(&known.path)).transpose()?;
        let chosen = |l: &LayerDoc| l.id() == see || of_file.as_ref().is_some_and(|source| draws(l, source));
        if let Some(k) = layers.iter().position(chosen) {
            layers.iter_mut().for_each(|l| l.set_must_see(false));
            let is_features = matches!(layers[k], LayerDoc::Line(_) | LayerDoc::Point(_));
            for l in layers.iter_mut().filter(|l| l.id() == see || of_file.as_ref().is_some_and(|f| draws(l, f))) {
                l.set_must_see(true);
            }
            return Ok(if is_features { Meant::Features } else { Meant::Solid(layers[k].id().to_owned()) });
        }
        layers.iter_mut().for_each(|l| l.set_must_see(false));
        for path in self.cities.iter().map(|city| &city.path) {
            let file = load_city(path, None, &Limits::default())?.value;
            let drawn = |id: &str| {
                file.city.buildings.iter().any(|b| b.id == id) || file.city.structures.iter().any(|s| s.id == id)
            };
            if file.about.iter().any(|about| about.is_meant(see) && drawn(&about.id)) {
                let source = text(path)?;
                for l in layers.iter_mut() {
                    if let LayerDoc::City(city) = l
                        && city.source.as_slice().contains(&source)
                    {
                        (city.select, city.must_see) = (Some(see.to_owned()), true);
                        return Ok(Meant::Solid(city.id.clone()));
                    }
                }
            }
        }
        for known in &self.features {
            if known.features()?.features.iter().any(|f| is_meant(see, &f.name, &f.properties)) {
                let source = text(&known.path)?;
                for l in layers.iter_mut().filter(|l| draws(l, &source)) {
                    if let LayerDoc::Line(line) = l {
                        (line.select, line.must_see) = (Some(see.to_owned()), true);
                    }
                }
                return Ok(Meant::Features);
            }
        }
        for city in &self.cities {
            let Ok(vectors) = city.features() else { continue };
            let of_map = vectors.features.iter().filter(|f| !is_building(&f.properties));
            if of_map.into_iter().any(|f| is_meant(see, &f.name, &f.properties)) {
                let style = LineStyleDoc { width_px: 4.0, ..LineStyleDoc::default() };
                layers.push(lines("seen".into(), &text(&city.path)?, (Some(see), true), style));
                return Ok(Meant::Features);
            }
        }
        if layers.iter().any(|l| matches!(l, LayerDoc::Mesh(_))) || self.cities.is_empty() {
            return Ok(Meant::Named(see.to_owned()));
        }
        Err(BelvedereError::Target(format!(
            "\"{see}\" is no building, street or area of these files; {}",
            known_names(&cities, see)?
        )))
    }
}

fn draws(layer: &LayerDoc, source: &str) -> bool {
    match layer {
        LayerDoc::Line(l) => l.source.as_ref().is_some_and(|s| s.as_slice().iter().any(|name| name == source)),
        LayerDoc::Point(l) => l.source.as_slice().iter().any(|name| name == source),
        _ => false,
    }
}

fn lines(id: String, source: &str, (select, must_see): (Option<&str>, bool), style: LineStyleDoc) -> LayerDoc {
    let (source, select) = (Some(Paths::One(source.to_owned())), select.map(str::to_owned));
    LayerDoc::Line(LineDoc { id, source, select, route: None, name_field: None, must_see, style })
}

/// An id from the name of a file that no other layer has.
fn layer_id(path: &Path, others: &[LayerDoc]) -> String {
    let name = split_table(path).0.file_name().and_then(|name| name.to_str()).unwrap_or("city");
    let stem = name.strip_prefix(arrays::SCHEME).unwrap_or(name).split('.').next();
    let stem = stem.filter(|stem| !stem.is_empty()).unwrap_or("city");
    let taken = |id: &str| others.iter().any(|l| l.id() == id);
    let id = (1..).map(|k| if k == 1 { stem.to_owned() } else { format!("{stem}-{k}") }).find(|id| !taken(id));
    id.unwrap_or_default()
}

/// Whether a map holds streets.
fn holds_streets(map: &Known) -> bool {
    map.features().is_ok_and(|map| map.features.iter().any(|feature| feature.properties.contains_key("highway")))
}

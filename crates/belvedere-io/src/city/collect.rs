//! The objects of city models as a city: one level of detail of each, cleaned and sorted by kind.

use super::attributes::{self, Attributes};
use super::pictures::PictureList;
use super::plan::{self, Repairs};
use super::reference::Reference;
use super::{CityAbout, CityFile, IoError, Loaded};
use crate::Limits;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Building, City, CityArea, CityFace, HeightSource, LandCover, Structure, StructureKind};
use glam::{DVec3, Vec2};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Faces of one object with all of its parts, by level of detail.
#[derive(Default)]
pub(super) struct Shown {
    pub(super) faces: BTreeMap<Lod, Vec<CityFace>>,
    /// References to surfaces that lead nowhere.
    pub(super) lost: usize,
}

/// A level of detail, in the order of its numbers.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Lod(u32, String);

impl Lod {
    /// The level of a number such as `2` or `1.3`.
    pub(super) fn of_text(text: &str) -> Self {
        Self((1000.0 * text.parse::<f64>().unwrap_or(0.0).clamp(0.0, 1000.0)) as u32, text.to_owned())
    }
}

/// Builder of a city.
#[derive(Default)]
pub(super) struct Collector<'l> {
    city: City,
    about: Vec<CityAbout>,
    repairs: Repairs,
    lods: BTreeSet<Lod>,
    wanted: Option<&'l str>,
    left_out: BTreeMap<String, usize>,
    pub(super) pictures: PictureList,
    without_faces: usize,
    /// What the end of the file cuts off, in a sentence.
    pub(super) cut: Option<String>,
    /// Why positions had latitude first and were exchanged.
    pub(super) exchanged: Option<String>,
    /// Number of unreadable geometries of objects that have others.
    pub(super) unread: usize,
}

impl<'l> Collector<'l> {
    /// * `lod`: level of detail to take where there is a choice; by default the highest of each object.
    pub(super) fn new(lod: Option<&'l str>) -> Self {
        Self { wanted: lod, ..Self::default() }
    }

    /// Adds an object with all of its parts.
    ///
    /// * `kind`: as CityJSON names it.
    pub(super) fn add(&mut self, id: &str, kind: &str, about: &impl Attributes, shown: Shown) {
        self.repairs.lost += shown.lost;
        for lod in shown.faces.keys() {
            self.lods.insert(lod.clone());
        }
        let (id, name) = (id.to_owned(), attributes::name(about));
        let Some(mut faces) = self.chosen(shown) else {
            self.without_faces += usize::from(kind != "CityObjectGroup");
            return;
        };
        self.clean(&mut faces);
        self.about.push(CityAbout { id: id.clone(), name: name.clone(), attributes: about.all() });
        let structure = match kind {
            "Building" | "BuildingPart" | "BuildingUnit" => return self.building(id, name, about, faces),
            "Bridge" | "BridgePart" => StructureKind::Bridge,
            "SolitaryVegetationObject" => StructureKind::Vegetation,
            "TINRelief" => return *self.left_out.entry(kind.to_owned()).or_default() += 1,
            _ => match cover(kind, about) {
                Some(cover) => return self.area(name, cover, &faces),
                None => StructureKind::Other,
            },
        };
        if !faces.is_empty() {
            self.city.structures.push(Structure { id, name, kind: structure, faces });
        }
    }

    /// The finished city, with warnings.
    pub(super) fn finish(
        self,
        path: &Path,
        format: String,
        reference: Reference,
        limits: &Limits,
    ) -> Result<Loaded<CityFile>, IoError> {
        let fail = |reason: String| IoError::format(path, reason);
        let Self { mut city, about, repairs, lods, wanted, left_out, pictures, without_faces, unread, cut, exchanged } =
            self;
        let lods: Vec<String> = lods.into_iter().map(|lod| lod.1).collect();
        if let Some(wanted) = wanted.filter(|w| !lods.iter().any(|lod| lod == w)) {
            return Err(fail(format!("has no level of detail {wanted}; it has {}", lods.join(", "))));
        }
        if city == City::default() {
            return Err(fail(format!("{format} holds no geometry that is read; choose another file")));
        }
        city.buildings.sort_by(|a, b| a.id.cmp(&b.id));
        let mut warnings: Vec<Warning> = reference.warning.into_iter().chain(repairs.warnings()).collect();
        warnings.extend(cut.map(|text| Warning::new(WarningKind::Repaired, text)));
        let exchanged = exchanged.map(|reason| Warning::new(WarningKind::Assumed, crate::exchanged::said(&reason)));
        warnings.extend(exchanged);
        let unread_words = "geometries cannot be read; their objects are drawn at another level of detail";
        warnings.extend(Warning::counted(WarningKind::Fallback, unread, unread_words));
        let without_words = "objects have no geometry that is read and were left out";
        warnings.extend(Warning::counted(WarningKind::Ignored, without_faces, without_words));
        if !left_out.is_empty() {
            let kinds: Vec<String> = left_out.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
            let text = format!("of kinds that are not drawn: {}", kinds.join(", "));
            let count = left_out.values().sum::<usize>() as f64;
            warnings.push(Warning::new(WarningKind::Ignored, text).with("count", count));
        }
        let (files, said) = pictures.load(&mut city, path, limits).map_err(|e| IoError::format(path, e))?;
        warnings.extend(said);
        let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
        let (crs, reference) = (reference.crs, reference.said);
        Ok(Loaded {
            files,
            ..Loaded::new(CityFile { path: path.into(), format, crs, reference, lods, city, about }, warnings)
        })
    }

    /// The faces of the level of detail that is wanted, else of the highest that has any.
    fn chosen(&self, mut shown: Shown) -> Option<Vec<CityFace>> {
        let of_wanted = |wanted: &str| shown.faces.keys().find(|lod| lod.1 == wanted).cloned();
        let wanted = self.wanted.and_then(of_wanted).and_then(|lod| shown.faces.remove(&lod));
        // Levels without surfaces, of points or lines, do not count.
        let shows = |faces: &Vec<CityFace>| faces.iter().any(|f| f.rings.first().is_some_and(|r| r.len() >= 3));
        let mut levels: Vec<Vec<CityFace>> =
            wanted.into_iter().chain(shown.faces.into_values().rev()).filter(|faces| !faces.is_empty()).collect();
        let best = levels.iter().position(shows).unwrap_or(0);
        (!levels.is_empty()).then(|| levels.swap_remove(best))
    }

    /// Drops rings with less than three corners.
    fn clean(&mut self, faces: &mut Vec<CityFace>) {
        let repairs = &mut self.repairs;
        faces.retain_mut(|face| {
            // Holes of a face without an outline do not count.
            let mut has_outline = None;
            let mut places =
                face.picture.as_mut().map(|p| std::mem::take(&mut p.rings)).unwrap_or_default().into_iter();
            let mut kept = Vec::new();
            face.rings.retain_mut(|ring| {
                let places = places.next().unwrap_or_default();
                let places = without_repeats(ring, places);
                let (short, flat) = (ring.len() < 3, plan::normal(ring).length() < 1e-9);
                repairs.short_rings += usize::from(short);
                repairs.flat_rings += usize::from(!short && flat);
                let fine = !short && !flat;
                has_outline.get_or_insert(fine);
                kept.extend(fine.then_some(places));
                fine
            });
            if let Some(picture) = &mut face.picture {
                picture.rings = kept;
            }
            has_outline == Some(true)
        });
    }

    fn building(&mut self, id: String, name: String, about: &impl Attributes, mut faces: Vec<CityFace>) {
        self.repairs.inside_out += usize::from(plan::turn_outwards(&mut faces));
        let (footprint, base, height) = plan::of_solid(&faces, &mut self.repairs);
        // A plan without height: its height comes from attributes.
        let (height_m, height_source, faces) = if height > 0.1 {
            (height, HeightSource::Shape, faces)
        } else {
            let (height, source) = attributes::height(about, &mut self.repairs);
            (height, source, Vec::new())
        };
        if footprint.is_empty() && faces.is_empty() {
            self.without_faces += 1;
            return;
        }
        let landmark = attributes::is_landmark(about);
        let base_m = base.is_finite().then_some(base);
        self.city.buildings.push(Building { id, name, landmark, footprint, base_m, height_m, height_source, faces });
    }

    fn area(&mut self, name: String, cover: LandCover, faces: &[CityFace]) {
        let flat = |f: &CityFace| {
            let rings = f.rings.iter().map(|ring| ring.iter().map(|p| p.truncate()).collect());
            plan::polygon(rings, &mut Repairs::default())
        };
        let polygons: Vec<_> = faces.iter().filter_map(flat).collect();
        if !polygons.is_empty() {
            self.city.areas.push(CityArea { name, cover, polygons });
        }
    }
}

/// Drops vertices of a ring that repeat the one before, and the last ones that repeat the first, and their texture positions.
fn without_repeats(ring: &mut Vec<DVec3>, mut places: Vec<Vec2>) -> Vec<Vec2> {
    let mut keep: Vec<bool> = (0..ring.len()).map(|i| i == 0 || ring[i] != ring[i - 1]).collect();
    let first = ring.first().copied();
    let closing = (1..ring.len()).rev().take_while(|i| Some(ring[*i]) == first || !keep[*i]).count();
    let from = ring.len() - closing;
    keep[from..].fill(false);
    let mut kept = keep.iter();
    ring.retain(|_| kept.next() == Some(&true));
    let mut kept = keep.iter();
    places.retain(|_| kept.next() == Some(&true));
    places
}

/// Land cover of a surface on the ground; `None` for solids.
fn cover(kind: &str, about: &impl Attributes) -> Option<LandCover> {
    Some(match kind {
        "Road" | "TransportSquare" | "Square" | "Track" => LandCover::Road,
        "Railway" => LandCover::Rail,
        "WaterBody" | "Waterway" | "WaterWay" => LandCover::Water,
        "PlantCover" => match words(about) {
            Some(text) if ["forest", "bos", "wood", "wald"].iter().any(|w| text.contains(w)) => LandCover::Forest,
            _ => LandCover::Green,
        },
        "LandUse" => match words(about) {
            Some(text) if ["park", "gras", "green", "garden", "groen"].iter().any(|w| text.contains(w)) => {
                LandCover::Green
            }
            _ => LandCover::Other,
        },
        _ => return None,
    })
}

fn words(about: &impl Attributes) -> Option<String> {
    let said = ["function", "class", "usage", "plus_functie", "bgt_functie", "fysiek_voorkomen", "bgt_fysiekvoorkomen"];
    let text: Vec<String> = said.iter().filter_map(|key| about.text(key)).collect();
    (!text.is_empty()).then(|| text.join(" ").to_lowercase())
}

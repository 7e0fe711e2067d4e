//! Things of a scene by their names: an index that is made once and searched as the user types.

use super::residues::name;
use belvedere::core::{Aabb, DVec2, DVec3};
use belvedere::places::Place;
use belvedere::scene::{Heightfield, Layer, LayerKind, MeshLayer, MoleculeLayer, OwnLayer, Scene};
use belvedere::{BelvedereError, Session, targets};
use std::collections::HashMap;

/// A thing with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// The name, as the scene gives it; of residues `A:12 ALA`, of chains `chain A`, of boxes `LAYER/NUMBER`.
    pub name: String,
    /// Index of its layer.
    pub layer: usize,
    /// The box around it, scene coordinates; a single point for a point.
    pub bounds: Aabb,
}

/// The names of a scene, ready to be searched.
#[derive(Debug, Clone, Default)]
pub struct NameIndex {
    things: Vec<Named>,
    /// The names as [`folded`] makes them.
    folded: Vec<String>,
    layers: Vec<String>,
}

/// Answer of [`NameIndex::search`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Matches {
    /// Indices of the best matches, best first.
    pub best: Vec<usize>,
    /// Number of all matches.
    pub total: usize,
}

impl NameIndex {
    /// Reads the names of layers and of everything in them: features of lines, areas and points, parts of meshes, boxes, chains and
    /// residues. Pieces of one line layer with the same name are one thing, so are parts of one mesh.
    pub fn of(scene: &Scene) -> Self {
        let mut things = Vec::new();
        for (index, layer) in scene.layers.iter().enumerate() {
            let bounds = match &layer.kind {
                LayerKind::Area(area) => {
                    area.features.iter().fold(Aabb::EMPTY, |all, f| all.union(on(scene, &f.rings)))
                }
                _ => layer.bounds(),
            };
            let named = |(name, bounds)| Named { name, layer: index, bounds };
            things.push(named((layer.id.clone(), bounds)));
            things.extend(within(scene, layer).into_iter().map(named));
        }
        things.retain(|thing| !thing.name.is_empty() && !thing.bounds.is_empty() && thing.bounds.max.is_finite());
        let folded = things.iter().map(|thing| folded(&thing.name)).collect();
        Self { things, folded, layers: scene.layers.iter().map(|layer| layer.id.clone()).collect() }
    }

    /// Number of names.
    pub fn len(&self) -> usize {
        self.things.len()
    }

    /// Whether there is no name.
    pub fn is_empty(&self) -> bool {
        self.things.is_empty()
    }

    /// A thing by its index.
    pub fn get(&self, index: usize) -> Option<&Named> {
        self.things.get(index)
    }

    /// Id of the layer of a thing.
    pub fn layer_of(&self, thing: &Named) -> &str {
        self.layers.get(thing.layer).map_or("", String::as_str)
    }

    /// The best `most` names for a text, case and accents aside: equal ones, then those that begin with it, those with a word that begins
    /// with it, those that hold it, those with words that begin with each of its words; shorter names first.
    pub fn search(&self, text: &str, most: usize) -> Matches {
        let wanted = Wanted::of(text);
        let rank = |(i, name): (usize, &String)| Some((wanted.rank(name)?, name.len(), i));
        let mut found: Vec<_> = self.folded.iter().enumerate().filter_map(rank).collect();
        let total = found.len();
        if most < total {
            found.select_nth_unstable(most);
            found.truncate(most);
        }
        found.sort_unstable();
        Matches { best: found.into_iter().map(|(.., i)| i).collect(), total }
    }
}

/// A text that is looked for.
#[derive(Debug, Clone)]
pub struct Wanted(String);

impl Wanted {
    /// The text without case, accents and blanks at its ends.
    pub fn of(text: &str) -> Self {
        Self(folded(text.trim()))
    }

    /// How well a name fits that [`folded`] has made, 0 best; `None` if it does not, or if nothing is looked for.
    pub fn rank(&self, name: &str) -> Option<u8> {
        let wanted = self.0.as_str();
        if wanted.is_empty() {
            return None;
        }
        if let Some(rest) = name.strip_prefix(wanted) {
            return Some(match rest.chars().next() {
                None => 0,
                Some(c) if !c.is_alphanumeric() => 1,
                Some(_) => 2,
            });
        }
        if let Some(at) = name.find(wanted) {
            let starts = |at: usize| name[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric());
            let is_word = starts(at) || name.match_indices(wanted).any(|(at, _)| starts(at));
            return Some(if is_word { 3 } else { 4 });
        }
        let begins = |word: &str| name.split(|c: char| !c.is_alphanumeric()).any(|own| own.starts_with(word));
        let has_words = wanted.contains(' ') && wanted.split_whitespace().all(begins);
        has_words.then_some(5)
    }
}

/// Names and boxes of what is in a layer.
fn within(scene: &Scene, layer: &Layer) -> Vec<(String, Aabb)> {
    match &layer.kind {
        LayerKind::Line(line) => {
            let pieces = line.features.iter().filter(|f| !f.name.is_empty());
            joined(pieces.map(|f| (f.name.as_str(), Aabb::of(f.points.iter().copied()))))
        }
        LayerKind::Area(area) => {
            let named = area.features.iter().filter(|f| !f.name.is_empty());
            named.map(|f| (f.name.clone(), on(scene, &f.rings))).collect()
        }
        LayerKind::Point(point) => {
            let named = point.features.iter().filter(|f| !f.name.is_empty());
            named.map(|f| (f.name.clone(), Aabb::of([f.position]))).collect()
        }
        LayerKind::Mesh(mesh) | LayerKind::Own(OwnLayer { surface: mesh, .. }) => parts(mesh),
        LayerKind::Molecule(molecule) => residues(molecule),
        LayerKind::Boxes(boxes) => {
            let name = |i: usize| format!("{}/{}", layer.id, i + 1);
            boxes.boxes.iter().enumerate().map(|(i, shape)| (name(i), Aabb::of(shape.corners()))).collect()
        }
        LayerKind::Terrain(_) | LayerKind::Volume(_) => Vec::new(),
    }
}

/// One box for each name, in the order of first appearance.
fn joined<'n>(pieces: impl Iterator<Item = (&'n str, Aabb)>) -> Vec<(String, Aabb)> {
    let (mut out, mut at): (Vec<(String, Aabb)>, HashMap<&str, usize>) = Default::default();
    for (name, bounds) in pieces {
        match at.get(name) {
            Some(&i) => out[i].1 = out[i].1.union(bounds),
            None => {
                at.insert(name, out.len());
                out.push((name.to_owned(), bounds));
            }
        }
    }
    out
}

/// The box around rings on the ground.
fn on(scene: &Scene, rings: &[Vec<DVec2>]) -> Aabb {
    let height = |xy: DVec2| scene.terrain().and_then(|ground: &Heightfield| ground.surface_at(xy)).unwrap_or(0.0);
    Aabb::of(rings.iter().flatten().map(|&xy| xy.extend(height(xy))))
}

fn parts(layer: &MeshLayer) -> Vec<(String, Aabb)> {
    if layer.names.iter().all(String::is_empty) {
        return Vec::new();
    }
    let mut boxes = vec![Aabb::EMPTY; layer.names.len()];
    for triangle in 0..layer.mesh.triangles().len() {
        if let Some(bounds) = layer.mesh.part(triangle).and_then(|part| boxes.get_mut(part as usize)) {
            *bounds = bounds.union(Aabb::of(layer.mesh.corners(triangle)));
        }
    }
    let named = layer.names.iter().map(String::as_str).zip(boxes);
    joined(named.filter(|(name, bounds)| !name.is_empty() && !bounds.is_empty()))
}

fn residues(layer: &MoleculeLayer) -> Vec<(String, Aabb)> {
    let molecule = &layer.molecule;
    let mut boxes = vec![Aabb::EMPTY; molecule.residues().len()];
    for (i, atom) in molecule.atoms().iter().enumerate() {
        let (center, reach) = (layer.center(i), DVec3::splat(layer.radius(i)));
        let bounds = &mut boxes[atom.residue as usize];
        *bounds = bounds.union(Aabb::of([center - reach, center + reach]));
    }
    let with_boxes = molecule.residues().iter().zip(&boxes);
    let chains = with_boxes.clone().filter(|(residue, _)| !residue.chain.is_empty());
    let mut out = joined(chains.map(|(residue, bounds)| (residue.chain.as_str(), *bounds)));
    out.iter_mut().for_each(|(name, _)| *name = format!("chain {name}"));
    out.extend(with_boxes.map(|(residue, bounds)| (name(residue), *bounds)));
    out
}

/// A text in small letters without accents; letters of other scripts are kept.
pub fn folded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars().flat_map(char::to_lowercase) {
        match c {
            c if c.is_ascii() => out.push(c),
            // Accents that are characters of their own.
            '\u{300}'..='\u{36f}' => {}
            c => match plain(c) {
                Some(letters) => out.push_str(letters),
                None => out.push(c),
            },
        }
    }
    out
}

/// The letters without an accent.
fn plain(c: char) -> Option<&'static str> {
    const PLAIN: [(&str, &str); 38] = [
        ("àáâãäåāăąǎȁȃȧạảấầẩẫậắằẳẵặ", "a"),
        ("æ", "ae"),
        ("ḃ", "b"),
        ("çćĉċč", "c"),
        ("ďđḍð", "d"),
        ("èéêëēĕėęěȅȇẹẻẽếềểễệ", "e"),
        ("ḟ", "f"),
        ("ĝğġģǧ", "g"),
        ("ĥħḥ", "h"),
        ("ìíîïĩīĭįıǐȉȋịỉ", "i"),
        ("ĵ", "j"),
        ("ķǩ", "k"),
        ("ĺļľŀłḷ", "l"),
        ("ṁṃ", "m"),
        ("ñńņňŉṇŋ", "n"),
        ("òóôõöøōŏőǒȍȏọỏốồổỗộơớờởỡợ", "o"),
        ("œ", "oe"),
        ("ṗ", "p"),
        ("ŕŗřṛ", "r"),
        ("śŝşšșṣ", "s"),
        ("ß", "ss"),
        ("ţťŧțṭ", "t"),
        ("þ", "th"),
        ("ùúûüũūŭůűųǔȕȗụủưứừửữự", "u"),
        ("ŵẁẃẅ", "w"),
        ("ýÿŷỳỵỷỹ", "y"),
        ("źżžẓ", "z"),
        ("ά", "α"),
        ("έ", "ε"),
        ("ή", "η"),
        ("ίϊΐ", "ι"),
        ("ό", "ο"),
        ("ύϋΰ", "υ"),
        ("ώ", "ω"),
        ("ς", "σ"),
        ("ё", "е"),
        ("й", "и"),
        ("’ʼ‘", "'"),
    ];
    PLAIN.iter().find(|(accented, _)| accented.contains(c)).map(|(_, letters)| *letters)
}

/// The position of a place as [`Place`] reads it, and a sentence if it was not read as it is written; `None` for a text that is no place.
///
/// # Errors
/// [`BelvedereError::Position`] for a place that is not on the map.
pub fn place_in(session: &Session, text: &str) -> Option<Result<(DVec3, Option<String>), BelvedereError>> {
    let place: Place = text.trim().parse().ok()?;
    let found = session.find_place(&place, "place");
    Some(found.map(|(point, said)| (point, said.map(|warning| warning.text().to_owned()))))
}

/// The box around the atoms that a selection such as `chain B and resi 12-18` means in a molecule of the scene; `None` for other texts
/// and without such atoms.
pub fn atoms_in(scene: &Scene, text: &str) -> Option<Aabb> {
    let has_atoms = scene.layers.iter().any(|layer| layer.kind.molecule().is_some());
    if !has_atoms || text.trim().is_empty() || targets::point(text).is_some() {
        return None;
    }
    let target = targets::target(scene, text.trim()).ok()?;
    let reach = DVec3::splat(target.radius());
    Some(Aabb { min: target.bounds.min - reach, max: target.bounds.max + reach })
}

#[cfg(test)]
mod tests;

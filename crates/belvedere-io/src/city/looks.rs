//! Textures of CityGML: pictures and their positions on rings.

use super::gml::Node;
use super::pictures::{PictureList, wrap};
use belvedere_scene::CityFace;
use glam::Vec2;
use std::collections::{BTreeMap, HashMap};

/// The textures of one theme by the ids of rings.
#[derive(Debug, Default)]
pub(super) struct Looks<'n> {
    rings: HashMap<&'n str, (u32, Vec<Vec2>)>,
}

impl<'n> Looks<'n> {
    /// The textures of the theme with the most rings; textures by a matrix are counted as not understood.
    pub(super) fn of(root: &'n Node, pictures: &mut PictureList) -> Self {
        let mut themes = BTreeMap::<&str, Vec<&'n Node>>::new();
        root.walk(&mut |node| {
            if node.name == "Appearance" {
                let theme = node.child("theme").map_or("", |theme| theme.text.as_str());
                themes.entry(theme).or_default().push(node);
            }
        });
        let lists = |appearances: &Vec<&Node>| {
            let mut count = 0;
            appearances.iter().for_each(|a| a.walk(&mut |n| count += usize::from(n.name == "textureCoordinates")));
            count
        };
        // Of equal themes the first by name.
        let chosen = themes.into_values().rev().max_by_key(lists);
        let mut looks = Self::default();
        for appearance in chosen.into_iter().flatten() {
            let data = appearance.children.iter().filter(|c| c.name == "surfaceDataMember").flat_map(|m| &m.children);
            for texture in data.filter(|t| t.name == "ParameterizedTexture") {
                looks.add(texture, pictures);
            }
        }
        looks
    }

    fn add(&mut self, texture: &'n Node, pictures: &mut PictureList) {
        let text = |name: &str| texture.child(name).map_or("", |child| child.text.as_str());
        let number = pictures.number(text("imageURI"), wrap(text("wrapMode")));
        for target in texture.children.iter().filter(|c| c.name == "target") {
            let lists: Vec<&Node> = target.children.iter().filter(|c| c.name == "TexCoordList").collect();
            pictures.odd += usize::from(lists.is_empty());
            for places in lists.iter().flat_map(|l| &l.children).filter(|c| c.name == "textureCoordinates") {
                let numbers = places.text.split_whitespace().map(|w| w.parse::<f32>().unwrap_or(f32::NAN));
                let numbers: Vec<f32> = numbers.collect();
                let places_there = numbers.chunks(2).map(|p| Vec2::new(p[0], p.get(1).copied().unwrap_or(f32::NAN)));
                self.rings.insert(places.href.as_str(), (number, places_there.collect()));
            }
        }
    }

    /// Gives a face the picture of its rings.
    ///
    /// * `rings`: their ids, and whether they were reversed.
    pub(super) fn dress(&self, rings: &[(&'n str, bool)], face: &mut CityFace, pictures: &mut PictureList) {
        let Some((number, _)) = rings.first().and_then(|(id, _)| self.rings.get(id)) else { return };
        let places = rings.iter().zip(&face.rings).map(|((id, reversed), ring)| {
            let mut places = self.rings.get(id).map_or_else(Vec::new, |(_, places)| places.clone());
            // Some files leave out the last position, which repeats the first.
            if places.len() + 1 == ring.len() && ring.first() == ring.last() {
                places.extend(places.first().copied());
            }
            if *reversed {
                places.reverse();
            }
            places
        });
        let places = places.collect();
        face.picture = pictures.on(*number, places, face);
    }
}

//! Representations: which layers show a place in which way.

use crate::Scene;

/// One way to show what there is: a set of layers that the styling sections of a preset name.
///
/// Layers of no representation are shown everywhere. Source: Pasewaldt et al. 2011, section 4.4 ("geometries" of a section).
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Representation {
    /// Name that sections use.
    pub id: String,
    /// Ids of its layers; a layer may belong to several representations.
    pub layers: Vec<String>,
}

impl Scene {
    /// For each layer the numbers, in `ids`, of the representations that show it, as bits; all bits for layers of no representation.
    ///
    /// An id that is no representation of the scene stands for the first one, so that presets without sections of their own show one
    /// representation and not all on top of each other.
    pub fn shown_by(&self, ids: &[&str]) -> Vec<u32> {
        let known = |id: &str| self.representations.iter().find(|r| r.id == id).or(self.representations.first());
        let layers = self.layers.iter().map(|layer| {
            let holds = |r: &Representation| r.layers.contains(&layer.id);
            if !self.representations.iter().any(holds) {
                return u32::MAX;
            }
            let bit = |(i, id): (usize, &&str)| known(id).is_some_and(holds).then_some(1 << i);
            ids.iter().enumerate().take(u32::BITS as usize).filter_map(bit).fold(0, |all, bit: u32| all | bit)
        });
        layers.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BoxLayer, LayerKind};

    #[test]
    fn layers_are_shown_by_their_representations_and_common_ones_by_all() {
        let of = |id: &str, layers: &[&str]| Representation {
            id: id.into(),
            layers: layers.iter().map(|l| (*l).to_owned()).collect(),
        };
        let layer = |scene: Scene, id: &str| scene.with_layer(id, LayerKind::Boxes(BoxLayer::default()));
        let scene = ["ground", "houses", "blocks", "church"].into_iter().fold(Scene::default(), layer);
        let representations = vec![of("loa0", &["houses", "church"]), of("loa1", &["blocks", "church"])];
        let scene = Scene { representations, ..scene };
        assert_eq!(scene.shown_by(&["loa1", "loa0"]), [u32::MAX, 0b10, 0b01, 0b11]);
        // What no scene knows is the first representation.
        assert_eq!(scene.shown_by(&["all"]), [u32::MAX, 0b1, 0b0, 0b1]);
        assert_eq!(Scene { representations: vec![], ..scene }.shown_by(&["all"]), [u32::MAX; 4]);
    }
}

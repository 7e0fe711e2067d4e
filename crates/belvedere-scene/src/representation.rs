//! Representations: alternative sets of layers.

/// An alternative form of the scene: a set of layers that the styling sections of a preset name.
///
/// Layers of no representation are shown everywhere. Source: Pasewaldt et al. 2011, section 4.4 ("geometries" of a section).
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Representation {
    /// Name that sections use.
    pub id: String,
    /// Ids of its layers; a layer may belong to several representations.
    pub layers: Vec<String>,
}

//! Opacity of solid layers in the scene document.

use super::layers::LayerDoc;

impl LayerDoc {
    /// Opacity of boxes, meshes, cities and molecules, 0..=1; `None` for kinds that have none.
    pub fn opacity(&self) -> Option<f64> {
        match self {
            Self::Boxes(l) => Some(l.style.opacity),
            Self::Mesh(l) => Some(l.style.opacity),
            Self::City(l) => Some(l.style.opacity),
            Self::Molecule(l) => Some(l.style.opacity),
            _ => None,
        }
    }

    /// The opacity itself, to be changed.
    pub fn opacity_mut(&mut self) -> Option<&mut f64> {
        match self {
            Self::Boxes(l) => Some(&mut l.style.opacity),
            Self::Mesh(l) => Some(&mut l.style.opacity),
            Self::City(l) => Some(&mut l.style.opacity),
            Self::Molecule(l) => Some(&mut l.style.opacity),
            _ => None,
        }
    }

    /// The layer with another opacity; as it is if its kind has none.
    pub fn with_opacity(&self, opacity: Option<f64>) -> Self {
        let mut layer = self.clone();
        if let (Some(own), Some(opacity)) = (layer.opacity_mut(), opacity) {
            *own = opacity;
        }
        layer
    }
}

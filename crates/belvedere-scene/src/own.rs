//! Layers of a kind of one's own.

use crate::MeshLayer;
use std::fmt;
use std::sync::Arc;

/// A kind of layer that a program brings along.
///
/// Its surface is all that is asked of it: renderers draw it, lines of sight meet it, it is picked, measured and exported, it can be a target,
/// and what hides a target can be cut away or moved apart. Scene files do not hold such layers.
///
/// ```
/// use belvedere_core::DVec3;
/// use belvedere_scene::{Color, LayerContent, LayerKind, Mesh, MeshColors, MeshLayer, OwnLayer, Scene};
///
/// #[derive(Debug)]
/// struct Sail([DVec3; 3]);
///
/// impl LayerContent for Sail {
///     fn kind(&self) -> &'static str {
///         "sail"
///     }
///     fn surface(&self) -> MeshLayer {
///         let mesh = Mesh::new(&self.0, vec![[0, 1, 2]], MeshColors::Layer);
///         MeshLayer::new(mesh.expect("three finite corners"), Color::rgb(250, 240, 220))
///     }
/// }
///
/// let sail = Sail([DVec3::ZERO, 4.0 * DVec3::X, 6.0 * DVec3::Z]);
/// let scene = Scene::default().with_layer("sail", OwnLayer::new(sail));
/// assert_eq!((scene.layers[0].kind.name(), scene.bounds().max.z), ("sail", 6.0));
/// ```
pub trait LayerContent: fmt::Debug + Send + Sync {
    /// The word for the kind in records and refusals, such as `glacier`.
    fn kind(&self) -> &'static str;

    /// The surface, scene coordinates, with its colours, the names of its parts, its opacity, and the parts that bends carry as rigid bodies.
    /// It is asked for once, by [`OwnLayer::new`].
    fn surface(&self) -> MeshLayer;

    /// How many things the layer holds, as reports count them; by default its triangles.
    fn count(&self) -> Option<usize> {
        None
    }
}

/// A layer of a kind of one's own, with its surface.
#[derive(Debug, Clone)]
pub struct OwnLayer {
    /// What it is.
    pub content: Arc<dyn LayerContent>,
    /// Its surface, as the content made it or as verbs changed it since.
    pub surface: MeshLayer,
}

impl OwnLayer {
    /// A layer of a content.
    pub fn new(content: impl LayerContent + 'static) -> Self {
        Self { surface: content.surface(), content: Arc::new(content) }
    }
}

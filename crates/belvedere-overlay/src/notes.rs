//! What is known of layers beside their styles.

use belvedere_scene::Color;

/// What furniture tells of layers beside their styles.
#[derive(Debug, Clone, Default)]
pub struct LayerNotes {
    /// Classes of layers whose features are coloured by a property.
    pub classes: Vec<ClassNote>,
    /// Ids of layers and whom their files ask to be named.
    pub credits: Vec<(String, String)>,
}

/// Classes of a layer.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassNote {
    /// Id of the layer.
    pub layer: String,
    /// The property.
    pub property: String,
    /// Names and colours of the classes, those that no feature has left out.
    pub classes: Vec<(String, Color)>,
    /// Whether the colours run into each other between the classes.
    pub smooth: bool,
    /// Colour of other features, if there are any; `None` within it = that of the layer.
    pub others: Option<Option<Color>>,
}

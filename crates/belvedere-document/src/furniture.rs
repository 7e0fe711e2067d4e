//! Furniture of a picture in scene files: title, legend, attribution, compass, scale.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What stands over the picture so that it can be read as a map; everything is left out unless it is asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FurnitureDoc {
    /// Title: `true` for that of the scene, or a text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<SwitchOrText>,
    /// Legend: layers with colour, width and symbol, classes of `color_by`, heights of palettes that follow height alone, colours
    /// and opacities of volumes.
    pub legend: bool,
    /// Whom the data ask to be named: `true` for what their files say (and `credits`), or a text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attribution: Option<SwitchOrText>,
    /// Sources: `true` for the names of the files of the data, or a text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<SwitchOrText>,
    /// Date: `true` for the day of drawing (UTC; that of `SOURCE_DATE_EPOCH` where it is set), or a text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<SwitchOrText>,
    /// Compass: `true` or `ground` for a rose that lies on the ground in the foreground, with the directions of that place; `corner` for a small
    /// one in a corner, whose north is that at the bottom in the middle of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compass: Option<CompassDoc>,
    /// Local scale: bars that lie on the ground along the picture's horizontal, of round lengths: `true` at three depths, or the places
    /// `[[x, y], ...]` in scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<ScaleDoc>,
    /// Distances along lines that must be seen and state no `distance_markers_m`.
    pub distances: bool,
    /// Names of layers in the legend, by their ids; empty leaves a layer out.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub names: BTreeMap<String, String>,
    /// Whom the data of layers ask to be named, by their ids, in place of what their files say; empty names nobody.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub credits: BTreeMap<String, String>,
    /// Place of the title.
    pub title_at: Corner,
    /// Place of the legend.
    pub legend_at: Corner,
    /// Place of attribution, source and date.
    pub notes_at: Corner,
    /// Place of a compass in a corner.
    pub compass_at: Corner,
}

impl Default for FurnitureDoc {
    fn default() -> Self {
        Self {
            title: None,
            legend: false,
            attribution: None,
            source: None,
            date: None,
            compass: None,
            scale: None,
            distances: false,
            names: BTreeMap::new(),
            credits: BTreeMap::new(),
            title_at: Corner::Top,
            legend_at: Corner::TopRight,
            notes_at: Corner::BottomLeft,
            compass_at: Corner::TopLeft,
        }
    }
}

/// A place at the rim of the picture; what stands at the same one is stacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Corner {
    /// Upper left.
    TopLeft,
    /// Above, in the middle.
    Top,
    /// Upper right.
    TopRight,
    /// Lower left.
    BottomLeft,
    /// Below, in the middle.
    Bottom,
    /// Lower right.
    BottomRight,
}

/// On or off, or a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, false or a text was expected")]
pub enum SwitchOrText {
    /// On or off.
    Switch(bool),
    /// The text.
    Text(String),
}

/// A compass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, false, \"ground\" or \"corner\" was expected")]
pub enum CompassDoc {
    /// On or off.
    Switch(bool),
    /// Its place.
    At(CompassPlace),
}

/// Place of a compass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CompassPlace {
    /// On the ground in the foreground.
    Ground,
    /// In a corner.
    Corner,
}

/// Bars of the local scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, false or places [[x, y], ...] were expected")]
pub enum ScaleDoc {
    /// On, at three depths, or off.
    Switch(bool),
    /// Places, scene coordinates.
    At(Vec<[f64; 2]>),
}

/// A piece of furniture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FurnitureItem {
    /// The title.
    Title,
    /// The legend.
    Legend,
    /// Whom the data ask to be named.
    Attribution,
    /// The files of the data.
    Source,
    /// The day.
    Date,
    /// The compass.
    Compass,
    /// The local scale.
    Scale,
    /// Distances along lines.
    Distances,
}

impl FurnitureItem {
    /// All of them with their names.
    pub const ALL: [(&'static str, Self); 8] = [
        ("title", Self::Title),
        ("legend", Self::Legend),
        ("attribution", Self::Attribution),
        ("source", Self::Source),
        ("date", Self::Date),
        ("compass", Self::Compass),
        ("scale", Self::Scale),
        ("distances", Self::Distances),
    ];

    /// The pieces of a list of names, which may be `all` or `none`.
    ///
    /// # Errors
    /// A sentence that names the possible names.
    pub fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> Result<Vec<Self>, String> {
        let mut items = Vec::new();
        for name in names {
            match name.trim() {
                "all" => items.extend(Self::ALL.map(|(_, item)| item)),
                "none" => {}
                name => match Self::ALL.into_iter().find(|(known, _)| *known == name) {
                    Some((_, item)) => items.push(item),
                    None => {
                        let known = Self::ALL.map(|(known, _)| known).join(", ");
                        let shown: String = name.chars().take(40).collect();
                        return Err(format!("\"{shown}\" is no furniture; possible: {known}, all, none"));
                    }
                },
            }
        }
        Ok(items)
    }
}

/// Furniture as the command line asks for it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FurnitureWish {
    /// What is drawn; everything else is left out. `None` = as the scene says.
    pub items: Option<Vec<FurnitureItem>>,
    /// Text of the title, which is then drawn.
    pub title: Option<String>,
}

impl FurnitureWish {
    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Writes the wish into the furniture of a document. Texts and places that it states already stay.
    pub fn put_into(&self, furniture: &mut Option<FurnitureDoc>) {
        if self.is_empty() {
            return;
        }
        let doc = furniture.get_or_insert_default();
        if let Some(items) = &self.items {
            let wants = |item| items.contains(&item);
            for (item, part) in [
                (FurnitureItem::Title, &mut doc.title),
                (FurnitureItem::Attribution, &mut doc.attribution),
                (FurnitureItem::Source, &mut doc.source),
                (FurnitureItem::Date, &mut doc.date),
            ] {
                let stated = part.take().filter(|part| matches!(part, SwitchOrText::Text(_)));
                *part = wants(item).then(|| stated.unwrap_or(SwitchOrText::Switch(true)));
            }
            doc.legend = wants(FurnitureItem::Legend);
            doc.distances = wants(FurnitureItem::Distances);
            let compass = doc.compass.filter(|compass| matches!(compass, CompassDoc::At(_)));
            doc.compass = wants(FurnitureItem::Compass).then(|| compass.unwrap_or(CompassDoc::Switch(true)));
            let scale = doc.scale.take().filter(|scale| matches!(scale, ScaleDoc::At(_)));
            doc.scale = wants(FurnitureItem::Scale).then(|| scale.unwrap_or(ScaleDoc::Switch(true)));
        }
        if let Some(title) = &self.title {
            doc.title = Some(SwitchOrText::Text(title.clone()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_furniture_are_read_and_unknown_ones_refused() {
        let read = |text: &'static str| FurnitureItem::listed(text.split(','));
        assert_eq!(read("scale, title"), Ok(vec![FurnitureItem::Scale, FurnitureItem::Title]));
        assert_eq!(read("all").map(|items| items.len()), Ok(FurnitureItem::ALL.len()));
        assert_eq!(read("none"), Ok(Vec::new()));
        let refused = read("legend,north arrow").expect_err("unknown");
        assert!(
            refused.contains("north arrow") && refused.contains("compass") && refused.ends_with("none"),
            "{refused}"
        );
    }

    #[test]
    fn a_wish_changes_what_is_drawn_and_keeps_what_is_stated() {
        let said = || Some(SwitchOrText::Text("© me".into()));
        let mut doc = Some(FurnitureDoc { attribution: said(), legend: true, ..FurnitureDoc::default() });
        let items = Some(vec![FurnitureItem::Attribution, FurnitureItem::Scale]);
        FurnitureWish { items, title: Some("Alps".into()) }.put_into(&mut doc);
        let found = doc.clone().expect("furniture");
        assert_eq!((found.attribution, found.legend, found.date), (said(), false, None));
        assert_eq!(found.scale, Some(ScaleDoc::Switch(true)));
        assert_eq!(found.title, Some(SwitchOrText::Text("Alps".into())));
        FurnitureWish { items: Some(Vec::new()), title: None }.put_into(&mut doc);
        let found = doc.expect("furniture");
        assert!(found.title.is_none() && found.attribution.is_none() && found.scale.is_none() && !found.legend);
        let mut none = None;
        FurnitureWish::default().put_into(&mut none);
        assert!(none.is_none());
    }
}

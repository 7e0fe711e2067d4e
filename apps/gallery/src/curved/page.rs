//! The page that shows the figures.

use super::{Entry, Figure};
use crate::html::{self, escape};
use serde::Serialize;

/// A figure, as kept beside its picture.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FigureRecord {
    name: &'static str,
    title: &'static str,
    says: &'static str,
    picture: String,
    panels: Vec<PanelRecord>,
    /// How much of what matters each panel shows, in the unit of its note.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    seen: Vec<f64>,
}

/// What stands under a panel.
#[derive(Debug, Clone, Serialize)]
struct PanelRecord {
    title: String,
    note: String,
}

impl FigureRecord {
    pub(super) fn new(entry: &Entry, picture: String, figure: &Figure) -> Self {
        let panels = figure.panels.iter().map(|p| PanelRecord { title: p.title.clone(), note: p.note.clone() });
        Self {
            name: entry.name,
            title: entry.title,
            says: entry.says,
            picture,
            panels: panels.collect(),
            seen: figure.seen.clone(),
        }
    }
}

pub(super) fn page(records: &[FigureRecord]) -> String {
    let section = |r: &FigureRecord| {
        let picture = html::picture(&r.picture, &escape(r.title));
        format!(
            "<section>\n<h2>{}</h2>\n<p>{}</p>\n<figure>{picture}</figure>\n</section>\n",
            escape(r.title),
            escape(r.says)
        )
    };
    let sections: String = records.iter().map(section).collect();
    let body = format!(
        "<h1>Rays that bend</h1>\n\
         <p>The figures of Cui et al. 2010, <i>A curved ray camera for handling occlusions through continuous multiperspective \
         visualization</i>, on generated scenes; the paper's own models are not public, so what the figures show can be compared, not \
         single pixels. Bent pictures are not to scale and not for navigation.</p>\n\
         {sections}<p class=\"small\">belvedere {} · <a href=\"curved.json\">record</a></p>\n",
        belvedere::VERSION
    );
    html::page("Belvedere: rays that bend", "", &body)
}

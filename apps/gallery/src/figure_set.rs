//! Figures of one paper: sheets of panels, a page that shows them, and a record of the captions.

use crate::easel::Easel;
use crate::html::{self, escape};
use crate::sheet::{self, Panel};
use anyhow::{Context, Result};
use belvedere::OpenOptions;
use belvedere::output::{self, pretty};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A figure: panels of one size in rows.
#[derive(Default)]
pub(crate) struct Figure {
    pub(crate) panels: Vec<Panel>,
    pub(crate) columns: usize,
    /// Measured visibility of each panel, in the unit of its note; empty where the figure does not measure it.
    pub(crate) seen: Vec<f64>,
    /// Measured values of the figure by name.
    pub(crate) facts: Facts,
    /// A table under the picture.
    pub(crate) table: Option<Table>,
}

/// Measured values by name.
pub(crate) type Facts = BTreeMap<&'static str, f64>;

/// A table of texts.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Table {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    fn html(&self) -> String {
        let row = |cells: &[String], tag: &str| {
            let cells: String = cells.iter().map(|c| format!("<{tag}>{}</{tag}>", escape(c))).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let rows: String = self.rows.iter().map(|r| row(r, "td")).collect();
        format!("<table>\n{}{rows}</table>\n", row(&self.head, "th"))
    }
}

/// A figure that can be drawn.
pub(crate) struct Entry {
    /// The file is `SET_NAME.png`.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// Description for the page.
    pub(crate) says: &'static str,
    pub(crate) draw: fn(&Easel<'_>) -> Result<Figure>,
}

/// The figures of a paper.
pub(crate) struct FigureSet<'a> {
    /// Beginning of all file names.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// HTML under the title.
    pub(crate) intro: &'static str,
    /// Comment in the metadata of every picture.
    pub(crate) comment: &'static str,
    /// In the order of the page.
    pub(crate) entries: &'a [Entry],
}

impl FigureSet<'_> {
    /// Draws the figures into `folder`, which is made if need be: `SET_NAME.png`, `SET.json` with the captions, and
    /// `SET.html`. Returns the files.
    ///
    /// * `scale`: factor of the width and height of the pictures, in (0, 1].
    ///
    /// # Errors
    /// A file that exists if `overwrite` is false; those of drawing a scene.
    pub(crate) fn draw(
        &self,
        folder: &Path,
        options: &OpenOptions,
        scale: f64,
        overwrite: bool,
    ) -> Result<Vec<PathBuf>> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        let picture = |entry: &Entry| format!("{}_{}.png", self.name, entry.name);
        let [page, record] = ["html", "json"].map(|ending| folder.join(format!("{}.{ending}", self.name)));
        for path in self.entries.iter().map(|e| folder.join(picture(e))).chain([page.clone(), record.clone()]) {
            output::check(&path, &[], overwrite)?;
        }
        let easel = Easel::new(options, scale);
        let (mut written, mut records) = (Vec::new(), Vec::new());
        for (k, entry) in self.entries.iter().enumerate() {
            options.progress.tick(&format!("figures {}", self.name), k as f64 / self.entries.len() as f64)?;
            let figure = (entry.draw)(&easel)?;
            let path = folder.join(picture(entry));
            sheet::write(&path, sheet::sheet(&figure.panels, figure.columns), self.comment, overwrite)?;
            records.push(FigureRecord::new(entry, picture(entry), &figure));
            written.push(path);
        }
        output::write_text(&record, &pretty(&records)?, overwrite)?;
        output::write_text(&page, &self.page(&records), overwrite)?;
        written.extend([record, page]);
        Ok(written)
    }

    fn page(&self, records: &[FigureRecord]) -> String {
        let section = |r: &FigureRecord| {
            let picture = html::picture(&r.picture, &escape(r.title));
            format!(
                "<section>\n<h2>{}</h2>\n<p>{}</p>\n<figure>{picture}</figure>\n{}</section>\n",
                escape(r.title),
                escape(r.says),
                r.table.as_ref().map_or_else(String::new, Table::html)
            )
        };
        let sections: String = records.iter().map(section).collect();
        let body = format!(
            "<h1>{}</h1>\n<p>{}</p>\n{sections}<p class=\"small\">belvedere {} · <a href=\"{}.json\">record</a></p>\n",
            self.title,
            self.intro,
            belvedere::VERSION,
            self.name
        );
        html::page(&format!("Belvedere: {}", self.title.to_lowercase()), html::TABLES, &body)
    }
}

/// A figure in the record `SET.json`.
#[derive(Debug, Clone, Serialize)]
struct FigureRecord {
    name: &'static str,
    title: &'static str,
    says: &'static str,
    picture: String,
    panels: Vec<PanelRecord>,
    /// Measured visibility of each panel, in the unit of its note.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    seen: Vec<f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    facts: Facts,
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<Table>,
}

/// Caption of a panel.
#[derive(Debug, Clone, Serialize)]
struct PanelRecord {
    title: String,
    note: String,
}

impl FigureRecord {
    fn new(entry: &Entry, picture: String, figure: &Figure) -> Self {
        let panels = figure.panels.iter().map(|p| PanelRecord { title: p.title.clone(), note: p.note.clone() });
        Self {
            name: entry.name,
            title: entry.title,
            says: entry.says,
            picture,
            panels: panels.collect(),
            seen: figure.seen.clone(),
            facts: figure.facts.clone(),
            table: figure.table.clone(),
        }
    }
}

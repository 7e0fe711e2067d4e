//! Furniture of a picture: title, legend, attribution, compass, local scale. It is planned before the picture is drawn, so that names stay
//! out of it, and recorded as shapes, which are drawn on pixels or written as vectors.

mod block;
mod compass;
mod legend;
mod record;
mod scale;
mod sighted;

pub use record::{CompassRecord, FurnitureRecord, ScaleRecord};

use crate::notes::LayerNotes;
use belvedere_composite::canvas::{Canvas, CanvasShape};
use belvedere_core::{DVec2, View};
use belvedere_document::{CompassDoc, CompassPlace, Corner, FurnitureDoc, ScaleDoc, SwitchOrText};
use belvedere_scene::{DistanceMarkers, Scene};
use block::Block;
use sighted::Sighted;
use std::borrow::Cow;

/// Distance of furniture from the rim of the picture and from each other.
const MARGIN: f64 = 10.0;
const GAP: f64 = 6.0;

type Rect = [DVec2; 2];

/// What furniture is planned for. Lengths are pixels of a screen, `density` pixels of the picture each.
pub struct Subject<'a> {
    /// What is asked for.
    pub doc: &'a FurnitureDoc,
    /// What is drawn.
    pub scene: &'a Scene,
    /// How it is seen.
    pub view: &'a View,
    /// What is known of its layers.
    pub notes: &'a LayerNotes,
    /// Names of the files of the data.
    pub files: Vec<String>,
    /// Pixels per unit.
    pub density: f64,
    /// Sizes of other marks that stand in corners.
    pub reserved: Vec<(Corner, DVec2)>,
    /// Direction of true north at a place, a unit vector.
    pub north: &'a (dyn Fn(DVec2) -> DVec2 + Sync),
    /// The day of drawing.
    pub today: Option<String>,
}

/// Planned furniture.
#[derive(Debug, Default)]
pub struct Plan {
    /// Kinds with their shapes, in the order of drawing.
    pub kinds: Vec<(&'static str, Vec<CanvasShape>)>,
    /// Rectangles that names stay out of, pixels.
    pub keep_clear: Vec<Rect>,
    /// What was drawn.
    pub record: FurnitureRecord,
}

impl Subject<'_> {
    /// Size of the picture.
    fn size(&self) -> DVec2 {
        let [w, h] = self.view.pinhole().image.map(f64::from);
        DVec2::new(w, h) / self.density
    }
}

/// Whether anything is asked for.
fn wants_any(doc: &FurnitureDoc) -> bool {
    let on = |part: &Option<SwitchOrText>| part.as_ref().is_some_and(|p| *p != SwitchOrText::Switch(false));
    [&doc.title, &doc.attribution, &doc.source, &doc.date].into_iter().any(on)
        || doc.legend
        || compass_place(doc).is_some()
        || doc.scale.as_ref().is_some_and(|s| *s != ScaleDoc::Switch(false))
}

fn compass_place(doc: &FurnitureDoc) -> Option<CompassPlace> {
    match doc.compass? {
        CompassDoc::Switch(on) => on.then_some(CompassPlace::Ground),
        CompassDoc::At(place) => Some(place),
    }
}

/// The text of a part: its own, or what `usual` gives.
fn text_of(part: Option<&SwitchOrText>, usual: impl FnOnce() -> String) -> Option<String> {
    let text = match part? {
        SwitchOrText::Switch(false) => return None,
        SwitchOrText::Switch(true) => usual(),
        SwitchOrText::Text(text) => text.clone(),
    };
    let text = text.trim().to_owned();
    (!text.is_empty()).then_some(text)
}

/// The scene with distances along the lines that must be seen, where they are asked for.
pub fn with_distances<'s>(scene: &'s Scene, doc: &FurnitureDoc) -> Cow<'s, Scene> {
    if !doc.distances {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    for layer in scene.layers.iter_mut().filter(|layer| layer.must_see) {
        if let Some(line) = layer.kind.lines_mut() {
            line.markers.get_or_insert(DistanceMarkers::Auto);
        }
    }
    Cow::Owned(scene)
}

/// Whom the data ask to be named, each once: what the scene states of layers before what their files say.
pub fn credits(doc: &FurnitureDoc, notes: &LayerNotes, scene: &Scene) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for id in scene.layers.iter().map(|layer| &layer.id) {
        let found: Vec<&String> = match doc.credits.get(id) {
            Some(stated) => vec![stated],
            None => notes.credits.iter().filter(|(layer, _)| layer == id).map(|(_, text)| text).collect(),
        };
        for text in found.into_iter().map(|text| text.trim()).filter(|text| !text.is_empty()) {
            if !all.iter().any(|known| known == text) {
                all.push(text.to_owned());
            }
        }
    }
    all
}

impl Plan {
    /// Plans the furniture of a picture; nothing if none is asked for.
    pub fn new(subject: &Subject<'_>) -> Self {
        let mut plan = Self::default();
        let doc = subject.doc;
        let mut stacks = Stacks { placed: Vec::new(), size: subject.size() };
        for (corner, size) in &subject.reserved {
            let at = stacks.place(*corner, *size);
            plan.keep_clear.extend(at.map(|at| [at, at + *size].map(|p| p * subject.density)));
        }
        if !wants_any(doc) {
            return plan;
        }
        plan.title(subject, &mut stacks);
        plan.notes(subject, &mut stacks);
        if doc.legend {
            let rows = legend::rows(subject);
            match stacks.legend(doc.legend_at, &rows) {
                Some((block, at, cut)) => {
                    plan.record.legend = Some(rows.len() - cut);
                    plan.put("map-legend", subject.density, |canvas| block.draw(canvas, at), Some((&block, at)));
                }
                None => plan.record.left_out.push("legend"),
            }
        }
        let ground = compass_place(doc).is_some() || doc.scale.is_some();
        if ground {
            let sighted = Sighted::new(subject.scene, subject.view);
            plan.compass(subject, &sighted, &mut stacks);
            plan.scale(subject, &sighted, &stacks);
        }
        plan
    }

    /// Records a kind of furniture and keeps names out of it.
    fn put(
        &mut self,
        name: &'static str,
        density: f64,
        draw: impl FnOnce(&mut Canvas<'_>),
        boxed: Option<(&Block, DVec2)>,
    ) {
        let mut shapes = Vec::new();
        draw(&mut Canvas::recording(&mut shapes, [0, 0]).scaled(density));
        self.kinds.push((name, shapes));
        self.keep_clear.extend(boxed.map(|(block, at)| [at, at + block.size()].map(|p| p * density)));
    }

    fn title(&mut self, subject: &Subject<'_>, stacks: &mut Stacks) {
        let Some(text) = text_of(subject.doc.title.as_ref(), || subject.scene.title.clone()) else {
            // Asked for, and nothing is named.
            if subject.doc.title == Some(SwitchOrText::Switch(true)) {
                self.record.left_out.push("title");
            }
            return;
        };
        let block = Block::title(&text, subject.size());
        match stacks.place(subject.doc.title_at, block.size()) {
            Some(at) => {
                self.record.title = Some(text);
                self.put("title", subject.density, |canvas| block.draw(canvas, at), Some((&block, at)));
            }
            None => self.record.left_out.push("title"),
        }
    }

    /// Attribution, source and date.
    fn notes(&mut self, subject: &Subject<'_>, stacks: &mut Stacks) {
        let doc = subject.doc;
        let attribution = text_of(doc.attribution.as_ref(), || credits(doc, subject.notes, subject.scene).join("; "));
        let source = text_of(doc.source.as_ref(), || block::listed("Data: ", &subject.files));
        let date = text_of(doc.date.as_ref(), || subject.today.clone().unwrap_or_default());
        let texts: Vec<String> = [&attribution, &source, &date].into_iter().flatten().cloned().collect();
        if texts.is_empty() {
            return;
        }
        let block = Block::notes(&texts, 0.6 * subject.size().x);
        match stacks.place(doc.notes_at, block.size()) {
            Some(at) => {
                (self.record.attribution, self.record.source, self.record.date) = (attribution, source, date);
                self.put("attribution", subject.density, |canvas| block.draw(canvas, at), Some((&block, at)));
            }
            None => self.record.left_out.push("attribution"),
        }
    }

    fn compass(&mut self, subject: &Subject<'_>, sighted: &Sighted<'_>, stacks: &mut Stacks) {
        let Some(place) = compass_place(subject.doc) else { return };
        let density = subject.density;
        let on_ground = (place == CompassPlace::Ground)
            .then(|| compass::on_ground(subject, sighted, &self.taken(density, stacks)))
            .flatten();
        if let Some(rose) = on_ground {
            self.keep_clear.push(rose.bounds());
            self.record.compass = Some(rose.record());
            return self.put("compass", 1.0, |canvas| rose.draw(canvas, density), None);
        }
        let side = compass::corner_side(subject.size());
        let small = compass::in_corner(subject, sighted)
            .and_then(|small| Some((small, stacks.place(subject.doc.compass_at, DVec2::splat(side))?)));
        match small {
            Some((small, at)) => {
                self.keep_clear.push([at, at + side].map(|p| p * density));
                self.record.compass = Some(small.record());
                self.put("compass", density, |canvas| small.draw(canvas, at, side), None);
            }
            None => self.record.left_out.push("compass"),
        }
    }

    /// Rectangles of everything that is placed already, pixels.
    fn taken(&self, density: f64, stacks: &Stacks) -> Vec<Rect> {
        let stacked = stacks.placed.iter().map(|rect| rect.map(|p| p * density));
        self.keep_clear.iter().copied().chain(stacked).collect()
    }

    fn scale(&mut self, subject: &Subject<'_>, sighted: &Sighted<'_>, stacks: &Stacks) {
        let bars = match &subject.doc.scale {
            None | Some(ScaleDoc::Switch(false)) => return,
            Some(ScaleDoc::Switch(true)) => {
                scale::at_three_depths(subject, sighted, &self.taken(subject.density, stacks))
            }
            Some(ScaleDoc::At(places)) => {
                places.iter().filter_map(|xy| scale::at_place(subject, sighted, DVec2::from_array(*xy))).collect()
            }
        };
        if bars.is_empty() {
            return self.record.left_out.push("scale");
        }
        let density = subject.density;
        self.keep_clear.extend(bars.iter().map(|bar| bar.bounds(density)));
        self.record.scale = bars.iter().map(scale::Bar::record).collect();
        self.put("scale", 1.0, |canvas| bars.iter().for_each(|bar| bar.draw(canvas, density)), None);
    }
}

/// What is stacked at the rim of a picture.
struct Stacks {
    placed: Vec<Rect>,
    size: DVec2,
}

impl Stacks {
    /// Left side of a box of some width at a place, and the upper and lower end of the room there.
    fn room(&self, corner: Corner, width: f64) -> [f64; 3] {
        let left = match corner {
            Corner::TopLeft | Corner::BottomLeft => MARGIN,
            Corner::Top | Corner::Bottom => 0.5 * (self.size.x - width),
            Corner::TopRight | Corner::BottomRight => self.size.x - MARGIN - width,
        };
        let (mut top, mut bottom) = (MARGIN, self.size.y - MARGIN);
        let beside = |r: &&Rect| r[1].x + GAP > left && r[0].x - GAP < left + width;
        for rect in self.placed.iter().filter(beside) {
            match 0.5 * (rect[0].y + rect[1].y) < 0.5 * self.size.y {
                true => top = top.max(rect[1].y + GAP),
                false => bottom = bottom.min(rect[0].y - GAP),
            }
        }
        [left, top, bottom]
    }

    /// Upper left corner of a box; `None` where it does not fit.
    fn place(&mut self, corner: Corner, size: DVec2) -> Option<DVec2> {
        let [left, top, bottom] = self.room(corner, size.x);
        if size.x > self.size.x - 2.0 * MARGIN || size.y > bottom - top {
            return None;
        }
        let at = match corner {
            Corner::TopLeft | Corner::Top | Corner::TopRight => DVec2::new(left, top),
            _ => DVec2::new(left, bottom - size.y),
        };
        self.placed.push([at, at + size]);
        Some(at)
    }

    /// A legend of as many rows as fit, its place, and the number of rows that are cut.
    fn legend(&mut self, corner: Corner, rows: &[block::Row]) -> Option<(Block, DVec2, usize)> {
        let width = (0.32 * self.size.x).clamp(96.0, 230.0);
        let [_, top, bottom] = self.room(corner, width);
        let (block, cut) = Block::legend(rows, width, bottom - top)?;
        let at = self.place(corner, block.size())?;
        Some((block, at, cut))
    }
}

#[cfg(test)]
mod tests;

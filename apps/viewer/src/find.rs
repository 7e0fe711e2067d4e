//! Finding things by their names, places by their coordinates, and bookmarks.

use crate::language::{fill, tr};
use crate::menu::Bookmark;
use crate::model::Model;
use crate::points::has_same_layers;
use crate::wake::Wake;
use belvedere::core::{Aabb, DVec3};
use belvedere::scene_file::Document;
use belvedere_studio::{NameIndex, Wanted, atoms_in, beside, folded, place_in};
use eframe::egui::{
    Align2, Area, Button, Context, Frame, Id, Key, Modifiers, Order, Pos2, RichText, Role, ScrollArea, TextEdit, Ui,
    WidgetInfo, vec2,
};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

/// Most results that are listed.
const MOST_RESULTS: usize = 40;
/// Width of the list, points.
const WIDTH: f32 = 380.0;

/// Something that was found.
#[derive(Debug, Clone, PartialEq)]
enum Hit {
    Place(DVec3),
    Atoms(Aabb),
    Bookmark(usize),
    Thing(usize),
}

/// Where to go.
pub(crate) enum Going {
    To(Aabb),
    Bookmark(usize),
}

/// The field and its list.
#[derive(Default)]
pub(crate) struct Find {
    pub(crate) open: bool,
    text: String,
    has_focus: bool,
    /// The field, once it was shown.
    field: Option<Id>,
    chosen: usize,
    /// Names of the scene of a document.
    index: Option<(Arc<Document>, NameIndex)>,
    coming: Option<(Arc<Document>, Receiver<NameIndex>)>,
    answer: Option<Answer>,
}

/// Results for a text.
struct Answer {
    text: String,
    hits: Vec<Hit>,
    total: usize,
    /// Why a place is not on the map, or how it was read.
    said: Option<String>,
}

impl Find {
    /// Opens the field, or takes the keyboard to it.
    pub(crate) fn begin(&mut self) {
        (self.open, self.has_focus) = (true, false);
    }

    /// Keeps the names of the shown scene: they are read once, in the background, and again when layers change.
    fn keep_index(&mut self, model: &Model, ctx: &Context) {
        if let Some((of, inbox)) = &self.coming
            && let Ok(index) = inbox.try_recv()
        {
            self.index = Some((of.clone(), index));
            (self.coming, self.answer) = (None, None);
        }
        let Some(shown) = &model.shown else { return };
        let same = |of: &Arc<Document>| has_same_layers(of, &shown.document);
        let known = self.index.as_ref().map(|(of, _)| of).filter(|of| same(of));
        let comes = self.coming.as_ref().map(|(of, _)| of).filter(|of| same(of));
        if known.is_some() || comes.is_some() {
            return;
        }
        let (outbox, inbox) = channel();
        let (session, wake) = (shown.session.clone(), Wake::new(ctx));
        let work = move || {
            let _ = outbox.send(NameIndex::of(session.scene()));
            wake.call();
        };
        if beside(work).is_ok() {
            self.coming = Some((shown.document.clone(), inbox));
        }
    }

    /// Looks for the text.
    fn look(&mut self, model: &Model, bookmarks: &[Bookmark]) {
        if self.answer.as_ref().is_some_and(|answer| answer.text == self.text) {
            return;
        }
        let (mut hits, mut said) = (Vec::new(), None);
        let session = model.shown.as_ref().map(|shown| &shown.session);
        match session.and_then(|session| place_in(session, &self.text)) {
            Some(Ok((point, words))) => {
                hits.push(Hit::Place(point));
                said = words;
            }
            Some(Err(e)) => said = Some(e.to_string()),
            None => {}
        }
        let wanted = Wanted::of(&self.text);
        let known = bookmarks.iter().enumerate().filter(|(_, one)| wanted.rank(&folded(&one.name)).is_some());
        hits.extend(known.map(|(i, _)| Hit::Bookmark(i)));
        let others = hits.len();
        let mut total = others;
        if let Some((_, index)) = &self.index {
            let found = index.search(&self.text, MOST_RESULTS.saturating_sub(others));
            total += found.total;
            hits.extend(found.best.into_iter().map(Hit::Thing));
        }
        if total == 0
            && let Some(bounds) = session.and_then(|session| atoms_in(session.scene(), &self.text))
        {
            hits.push(Hit::Atoms(bounds));
            total = 1;
        }
        self.answer = Some(Answer { text: self.text.clone(), hits, total, said });
        self.chosen = 0;
    }

    /// Shows field and list below a point of the window; where to go once something is chosen.
    ///
    /// * `room`: width and height that they may take, points.
    pub(crate) fn show(
        &mut self,
        ctx: &Context,
        (at, room): (Pos2, eframe::egui::Vec2),
        model: &Model,
        bookmarks: &[Bookmark],
    ) -> Option<Going> {
        if !self.open {
            return None;
        }
        self.keep_index(model, ctx);
        self.look(model, bookmarks);
        // Other controls and windows have these keys, too.
        let focused = ctx.memory(|memory| memory.focused());
        let is_typing = self.field.is_some() && focused == self.field;
        // Escape takes the focus from the field before it gets here.
        let hears = |key: Key| is_typing || (key == Key::Escape && focused.is_none());
        let pressed = |key: Key| hears(key) && ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let (up, down, enter, escape) =
            (pressed(Key::ArrowUp), pressed(Key::ArrowDown), pressed(Key::Enter), pressed(Key::Escape));
        let last = self.answer.as_ref().map_or(0, |answer| answer.hits.len().saturating_sub(1));
        self.chosen = match (up, down) {
            (true, false) => self.chosen.saturating_sub(1),
            (false, true) => self.chosen + 1,
            _ => self.chosen,
        };
        self.chosen = self.chosen.min(last);
        let area = Area::new(Id::unique("find")).order(Order::Foreground).pivot(Align2::CENTER_TOP).fixed_pos(at);
        let width = WIDTH.min(room.x - 30.0);
        let clicked = area.show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(width);
                self.field(ui);
                // What was typed just now is looked for in the same frame.
                self.look(model, bookmarks);
                self.list(ui, bookmarks, (up || down, room.y - 90.0))
            })
        });
        let hit = clicked.inner.inner.or_else(|| enter.then_some(self.chosen));
        let hit = hit.and_then(|i| self.answer.as_ref()?.hits.get(i).cloned());
        let going = hit.and_then(|hit| match hit {
            Hit::Place(point) => Some(Going::To(Aabb::of([point]))),
            Hit::Atoms(bounds) => Some(Going::To(bounds)),
            Hit::Bookmark(i) => Some(Going::Bookmark(i)),
            Hit::Thing(i) => self.index.as_ref()?.1.get(i).map(|thing| Going::To(thing.bounds)),
        });
        if going.is_some() || escape {
            self.open = false;
            ctx.memory_mut(|memory| memory.stop_text_input());
        }
        going
    }

    fn field(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let close = ui.spacing().interact_size.x + 26.0;
            let hint = tr("name, or place as 46.5N,11.3E");
            let width = (ui.available_width() - close).max(80.0);
            let field = ui.add(TextEdit::singleline(&mut self.text).hint_text(hint).desired_width(width));
            self.field = Some(field.id);
            let text = &self.text;
            let label = || Some(tr("Find").to_owned());
            field.widget_info(|| WidgetInfo { label: label(), ..WidgetInfo::text_edit(true, text, text, hint) });
            if !std::mem::replace(&mut self.has_focus, true) {
                field.request_focus();
            }
            if ui.button(tr("Close")).clicked() {
                self.open = false;
            }
        });
    }

    /// The list. Returns the row that was clicked.
    fn list(&self, ui: &mut Ui, bookmarks: &[Bookmark], (moved, height): (bool, f32)) -> Option<usize> {
        let answer = self.answer.as_ref()?;
        let mut clicked = None;
        // The rows keep their identities when the names have come.
        ui.scope(|ui| self.coming.is_some().then(|| ui.weak(tr("reading the names"))));
        ScrollArea::vertical().max_height(height.clamp(60.0, 360.0)).show(ui, |ui| {
            for (i, hit) in answer.hits.iter().enumerate() {
                let (name, kind) = self.words(hit, bookmarks);
                let button =
                    Button::selectable(i == self.chosen, name.as_str()).right_text(RichText::new(&kind).weak());
                let response = ui.add(button.truncate().min_size(vec2(ui.available_width(), 0.0)));
                let label = if kind.is_empty() { name } else { format!("{name}, {kind}") };
                response.widget_info(|| WidgetInfo::selected(Role::Button, true, i == self.chosen, &label));
                if moved && i == self.chosen {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    clicked = Some(i);
                }
            }
        });
        if let Some(said) = &answer.said {
            ui.label(said);
        }
        if answer.total > answer.hits.len() {
            ui.weak(fill(tr("{0} of {1}"), &[&answer.hits.len(), &answer.total]));
        } else if answer.hits.is_empty()
            && !answer.text.trim().is_empty()
            && answer.said.is_none()
            && self.index.is_some()
        {
            ui.weak(tr("nothing has that name"));
        }
        clicked
    }

    /// Name of a hit, and what it is.
    fn words(&self, hit: &Hit, bookmarks: &[Bookmark]) -> (String, String) {
        match hit {
            Hit::Place(_) => (self.text.trim().to_owned(), tr("place").to_owned()),
            Hit::Atoms(_) => (self.text.trim().to_owned(), tr("atoms").to_owned()),
            Hit::Bookmark(i) => {
                (bookmarks.get(*i).map_or_else(String::new, |one| one.name.clone()), tr("bookmark").to_owned())
            }
            Hit::Thing(i) => {
                let Some((index, thing)) = self.index.as_ref().and_then(|(_, index)| Some((index, index.get(*i)?)))
                else {
                    return Default::default();
                };
                let layer = index.layer_of(thing);
                let kind = if layer == thing.name { tr("layer") } else { layer };
                (thing.name.clone(), kind.to_owned())
            }
        }
    }
}

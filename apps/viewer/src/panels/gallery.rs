//! Built-in presets as small pictures of the present scene, drawn beside the window while it rests.

use crate::language::{fill, tr};
use crate::model::Model;
use belvedere::core::presets::{BUILTINS, Builtin};
use belvedere::live::Thumbnails;
use belvedere::scene::{Frame, Progress};
use belvedere::scene_file::{Document, LayerDoc, PresetsDoc, SplineStageDoc, StageDoc};
use belvedere_studio::beside;
use eframe::egui::{
    Align2, Color32, ColorImage, Context, FontId, Pos2, Rect, Role, Sense, Stroke, StrokeKind, TextureHandle,
    TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver};

/// Size of a picture, pixels.
const PICTURE: [u32; 2] = [192, 108];
/// Least width of a card, and height of its name, points.
const LEAST: f32 = 86.0;
const NAME: f32 = 18.0;
/// Room for the bar of the panel, points.
const BAR: f32 = 10.0;
/// Galleries that are kept, for steps back.
const KEPT: usize = 4;
/// Step of the camera, in its distance from what it looks at, within which the pictures hold.
const COARSE: f64 = 0.05;
/// Time after which the window looks for the next picture, seconds.
const AGAIN: f32 = 0.03;

/// A picture, or why there is none.
type Card = Result<TextureHandle, String>;

/// The pictures of the presets over one state of the scene.
struct Gallery {
    of: u64,
    cards: Vec<Option<Card>>,
}

/// Pictures of all presets.
#[derive(Default)]
pub(crate) struct Galleries {
    /// The newest last.
    kept: Vec<Gallery>,
    drawing: Option<Drawing>,
    /// Whether the panel showed them in the last frame.
    is_open: bool,
    /// The last document at rest, and its key.
    last: Option<(Arc<Document>, u64)>,
}

/// A picture that is being drawn.
struct Drawing {
    of: u64,
    card: usize,
    progress: Progress,
    inbox: Receiver<Result<Frame, String>>,
}

impl std::fmt::Debug for Galleries {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Galleries").field("kept", &self.kept.len()).finish()
    }
}

impl Drop for Galleries {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Galleries {
    /// Shows the presets, and returns the one that is chosen.
    ///
    /// * `present`: name of the present one.
    pub(crate) fn show(&mut self, ui: &mut Ui, present: Option<&str>) -> Option<&'static Builtin> {
        self.is_open = true;
        let mut chosen = None;
        let gap = ui.spacing().item_spacing.x;
        let room = (ui.available_width() - BAR).max(LEAST);
        let columns = ((room + gap) / (LEAST + gap)).floor().clamp(1.0, 4.0);
        let width = ((room + gap) / columns - gap).floor();
        let [w, h] = PICTURE.map(|n| n as f32);
        for row in BUILTINS.chunks(columns as usize) {
            ui.horizontal(|ui| {
                for builtin in row {
                    let size = vec2(width, (width * h / w).round() + NAME);
                    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
                    let is_present = present == Some(builtin.name);
                    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_present, builtin.name));
                    let card = BUILTINS.iter().position(|b| b.name == builtin.name).and_then(|i| self.card(i));
                    let look = [is_present, response.hovered(), response.has_focus()];
                    paint(ui, rect, builtin.name, (card, look));
                    let mut words = fill(tr("{0}: {1}"), &[&builtin.name, &builtin.effect]);
                    if let Some(Err(reason)) = card {
                        words = fill(tr("{0} It cannot be drawn here: {1}"), &[&words, reason]);
                    }
                    if response.on_hover_text(words).clicked() {
                        chosen = Some(builtin);
                    }
                }
            });
        }
        chosen
    }

    /// The newest picture of a preset; an old one stands until the new one is drawn.
    fn card(&self, i: usize) -> Option<&Card> {
        self.kept.iter().rev().find_map(|gallery| gallery.cards.get(i)?.as_ref())
    }

    /// Draws what is missing, one picture after the other, while the window rests; stops when something moves.
    pub(crate) fn draw(&mut self, ctx: &Context, model: &Model) {
        let is_open = std::mem::take(&mut self.is_open);
        let of = Some(model).filter(|model| is_open && model.rests()).and_then(|model| self.key(model));
        if self.drawing.as_ref().is_some_and(|drawing| Some(drawing.of) != of) {
            self.stop();
        }
        let Some(of) = of else { return };
        self.take(ctx, model);
        if self.drawing.is_some() {
            ctx.request_repaint_after_secs(AGAIN);
            return;
        }
        match self.kept.iter().position(|gallery| gallery.of == of) {
            Some(known) => {
                let gallery = self.kept.remove(known);
                self.kept.push(gallery);
            }
            None => self.kept.push(Gallery { of, cards: BUILTINS.iter().map(|_| None).collect() }),
        }
        let extra = self.kept.len().saturating_sub(KEPT);
        self.kept.drain(..extra);
        let missing = self.kept.last().and_then(|gallery| gallery.cards.iter().position(Option::is_none));
        if let Some(card) = missing {
            self.begin(of, card, model);
            ctx.request_repaint_after_secs(AGAIN);
        }
    }

    fn key(&mut self, model: &Model) -> Option<u64> {
        let known = self.last.as_ref().filter(|(document, _)| Arc::ptr_eq(document, model.document()));
        if let Some((_, key)) = known {
            return Some(*key);
        }
        let key = key(model)?;
        self.last = Some((model.document().clone(), key));
        Some(key)
    }

    /// Whether pictures are missing that will be drawn.
    pub(crate) fn is_drawing(&self) -> bool {
        self.drawing.is_some() || self.kept.last().is_none_or(|gallery| gallery.cards.iter().any(Option::is_none))
    }

    fn begin(&mut self, of: u64, card: usize, model: &Model) {
        let Some(shown) = &model.shown else { return };
        let document = variant(model.document(), BUILTINS[card].name);
        let width = model.screen_size().map_or(PICTURE[0], |[width, _]| width);
        let scale = model.density * f64::from(PICTURE[0]) / f64::from(width.max(1));
        let thumbnails = Thumbnails::new(&shown.session, &model.editor.place, scale);
        let (outbox, inbox) = mpsc::channel();
        let progress = Progress::silent();
        let own = progress.clone();
        let work = move || {
            let drawn = thumbnails.draw(&document, PICTURE, &own).map_err(|e| e.to_string());
            let _ = outbox.send(drawn);
        };
        match beside(work) {
            Ok(()) => self.drawing = Some(Drawing { of, card, progress, inbox }),
            Err(reason) => {
                if let Some(gallery) = self.kept.iter_mut().find(|gallery| gallery.of == of) {
                    gallery.cards[card] = Some(Err(reason));
                }
            }
        }
    }

    fn take(&mut self, ctx: &Context, model: &Model) {
        let Some(drawing) = &self.drawing else { return };
        let drawn = match drawing.inbox.try_recv() {
            Ok(drawn) => drawn,
            Err(mpsc::TryRecvError::Empty) => return,
            Err(mpsc::TryRecvError::Disconnected) => Err(tr("internal error while drawing").to_owned()),
        };
        let own: Vec<&str> = model.document().layer.iter().map(LayerDoc::id).collect();
        let card = drawn
            .map(|frame| {
                let image = ColorImage::from_rgb([frame.width, frame.height], frame.color.as_flattened());
                ctx.load_texture("preset", image, TextureOptions::LINEAR)
            })
            .map_err(|reason| crate::words::in_window_words(&reason, &own));
        if let Some(gallery) = self.kept.iter_mut().find(|gallery| gallery.of == drawing.of) {
            gallery.cards[drawing.card] = Some(card);
        }
        self.drawing = None;
    }

    fn stop(&mut self) {
        if let Some(drawing) = self.drawing.take() {
            drawing.progress.cancel_flag().store(true, Ordering::Relaxed);
        }
    }
}

/// The document with a built-in preset.
pub(super) fn variant(document: &Document, name: &str) -> Document {
    let mut next = document.clone();
    let presets = PresetsDoc::Named(name.to_owned());
    let stage = document.stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(stage) => Some(SplineStageDoc { presets: presets.clone(), ..stage.clone() }),
        _ => None,
    });
    let stage = stage.unwrap_or(SplineStageDoc { presets, pivot: None, plane: None });
    super::set_stage(&mut next, StageDoc::SplineBend(stage));
    next
}

/// What the pictures depend on: the document without presets, and the camera in steps.
fn key(model: &Model) -> Option<u64> {
    let camera = model.camera()?;
    let mut document = serde_json::to_value(variant(model.document(), "identity")).ok()?;
    for part in ["camera", "title", "animation", "constructor"] {
        document.as_object_mut()?.remove(part);
    }
    let mut hasher = DefaultHasher::new();
    document.to_string().hash(&mut hasher);
    model.editor.place.roots.scene_dir.hash(&mut hasher);
    let pinhole = &camera.pinhole;
    let distance = pinhole.eye.distance(camera.target);
    let step = COARSE * distance.log2().floor().exp2();
    for point in [pinhole.eye, camera.target] {
        (point / step).to_array().map(|v| v.round() as i64).hash(&mut hasher);
    }
    format!("{:?}", pinhole.projection).hash(&mut hasher);
    Some(hasher.finish())
}

/// Draws a card.
fn paint(ui: &Ui, rect: Rect, name: &str, (card, [is_present, hovered, focused]): (Option<&Card>, [bool; 3])) {
    let picture = rect.with_max_y(rect.bottom() - NAME);
    let painter = ui.painter_at(rect.expand(2.0));
    let visuals = ui.visuals();
    painter.rect_filled(picture, 3.0, visuals.extreme_bg_color);
    match card {
        Some(Ok(texture)) => {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(texture.id(), picture, whole, Color32::WHITE);
        }
        Some(Err(reason)) => {
            let room = picture.shrink(4.0);
            let galley =
                painter.layout(reason.clone(), FontId::proportional(9.5), visuals.weak_text_color(), room.width());
            painter.with_clip_rect(room).galley(room.min, galley, visuals.weak_text_color());
        }
        None => {
            let font = FontId::proportional(11.0);
            painter.text(picture.center(), Align2::CENTER_CENTER, tr("drawing"), font, visuals.weak_text_color());
        }
    }
    let (width, color) = match (is_present, focused, hovered) {
        (true, ..) => (2.5, visuals.selection.bg_fill),
        (_, true, _) => (2.0, visuals.selection.stroke.color),
        (_, _, true) => (1.5, visuals.strong_text_color()),
        _ => (1.0, visuals.widgets.noninteractive.bg_stroke.color),
    };
    painter.rect_stroke(picture, 3.0, Stroke::new(width, color), StrokeKind::Outside);
    let color = if is_present { visuals.strong_text_color() } else { visuals.text_color() };
    let mut font = FontId::proportional(12.0);
    let mut galley = painter.layout_no_wrap(name.to_owned(), font.clone(), color);
    if galley.size().x > rect.width() {
        font.size *= rect.width() / galley.size().x;
        galley = painter.layout_no_wrap(name.to_owned(), font, color);
    }
    let at = pos2(rect.center().x - 0.5 * galley.size().x, picture.bottom() + 2.0);
    painter.galley(at, galley, color);
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere::placed::Place;
    use belvedere_studio::Editor;

    #[test]
    fn a_variant_keeps_the_pivot_and_everything_else() {
        let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n\
            [[stage]]\nkind = 'spline_bend'\npresets = 'map'\npivot = [1, 2, 3]\n";
        let source = belvedere::scene_file::parse(std::path::Path::new("s.toml"), text).expect("scene");
        let document: Arc<Document> = Editor::new(source.document, Place::default()).document().clone();
        let next = variant(&document, "progressive");
        let StageDoc::SplineBend(stage) = &next.stage[0] else { panic!("no spline") };
        assert_eq!((stage.pivot, &stage.presets), (Some([1.0, 2.0, 3.0]), &PresetsDoc::Named("progressive".into())));
        assert_eq!(variant(&next, "map"), *document);
    }
}

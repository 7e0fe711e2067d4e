//! The first minute: what to do with an empty window, five examples to open, a short tour.

use super::Viewer;
use crate::builtin::BUILTIN;
use crate::language::{fill, later, tr};
use crate::theme;
use crate::wake::Wake;
use belvedere::picture::PictureOptions;
use belvedere::placed::Place;
use belvedere::scene::{Progress, RenderOptions};
use belvedere::scene_file::{self, OverlayDoc};
use belvedere_studio::{THREADS, beside};
use eframe::egui::{
    self, Align2, Button, ColorImage, Context, Id, Image, TextureHandle, TextureOptions, Ui, Vec2, Window, vec2,
};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver};

/// Examples: number of the built-in scene, and what it shows.
const CARDS: [(usize, &str, &str); 5] = [
    (0, later("A panorama"), later("near from above, far upright")),
    (3, later("Behind a pass"), later("rays bend down into the valley")),
    (4, later("Two side streets"), later("rays turn round the corners")),
    (6, later("A canyon ahead"), later("the river round its bends")),
    (8, later("Inside an engine"), later("rays bend over its wall")),
];
/// Size of a card's picture, pixels.
const PICTURE: [usize; 2] = [240, 136];
/// Size of a card's picture on the screen, points.
const CARD: Vec2 = vec2(132.0, 75.0);

/// Steps of the tour.
const TOUR: [(&str, &str); 5] = [
    (
        later("Move"),
        later(
            "Drag the ground to move over it, right-drag to turn and tilt, turn the wheel to come nearer. Arrow keys and Shift do the same.",
        ),
    ),
    (
        later("Straight and bent"),
        later("Space changes between the straight view and the bent one. C compares both side by side."),
    ),
    (
        later("What must be seen"),
        later("In the panel Layers each layer says how much of it the picture shows. Mark what must be seen."),
    ),
    (
        later("Three ways to bend"),
        later(
            "Terrain lets the ground make way, Spline bends it like a panorama, Curved rays leads the view round corners.",
        ),
    ),
    (
        later("Keep it"),
        later(
            "Ctrl S saves the scene, Export writes pictures and films. Edit lists all steps, and each can be undone.",
        ),
    ),
];

/// Number of a card, and the bytes of its picture.
type Drawn = (usize, Vec<u8>);

/// The welcome and its pictures.
#[derive(Default)]
pub(super) struct Welcome {
    pub(super) open: bool,
    /// Step of the tour.
    pub(super) tour: Option<usize>,
    pictures: [Option<TextureHandle>; CARDS.len()],
    drawing: Option<(Receiver<Drawn>, Progress)>,
    is_drawn: bool,
}

impl Drop for Welcome {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Welcome {
    /// Stops drawing the pictures; those that are there stay.
    fn stop(&mut self) {
        if let Some((_, progress)) = self.drawing.take() {
            progress.cancel_flag().store(true, Ordering::Relaxed);
        }
    }

    /// Draws the pictures of the cards in the background, once; they are kept in `folder`.
    fn draw(&mut self, folder: Option<PathBuf>, wake: Wake) {
        if std::mem::replace(&mut self.is_drawn, true) || !THREADS {
            return;
        }
        let (outbox, inbox) = mpsc::channel();
        let progress = Progress::silent();
        let own = progress.clone();
        let work = move || {
            for (card, (scene, ..)) in CARDS.iter().enumerate() {
                let Some(bytes) = picture(*scene, folder.as_deref(), &own) else { continue };
                if own.is_cancelled() || outbox.send((card, bytes)).is_err() {
                    return;
                }
                wake.call();
            }
        };
        // Without a thread the cards have no pictures.
        if beside(work).is_ok() {
            self.drawing = Some((inbox, progress));
        }
    }

    /// Shows the cards; returns the number of the built-in scene that was clicked.
    fn cards(&self, ui: &mut Ui, columns: usize) -> Option<usize> {
        let mut chosen = None;
        egui::Grid::new("cards").num_columns(columns).spacing([8.0, 8.0]).show(ui, |ui| {
            for (card, (scene, name, what)) in CARDS.iter().enumerate() {
                ui.vertical(|ui| {
                    ui.set_width(CARD.x);
                    let button = match &self.pictures[card] {
                        Some(texture) => Button::image(Image::new((texture.id(), CARD)).alt_text(tr(name))),
                        None => Button::new(tr(name)).fill(theme::blank(ui.visuals().dark_mode)),
                    };
                    let response = ui.add(button.min_size(CARD).frame_when_inactive(false));
                    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, tr(name)));
                    if response.clicked() {
                        chosen = Some(*scene);
                    }
                    ui.strong(tr(name));
                    ui.label(tr(what));
                });
                if (card + 1) % columns == 0 {
                    ui.end_row();
                }
            }
        });
        chosen
    }

    fn take(&mut self, ctx: &Context) {
        let Some((inbox, _)) = &self.drawing else { return };
        for (card, bytes) in inbox.try_iter() {
            let image = ColorImage::from_rgb(PICTURE, &bytes);
            self.pictures[card] = Some(ctx.load_texture("card", image, TextureOptions::LINEAR));
        }
    }
}

/// The picture of a built-in scene, from its file in `folder` if that was drawn of the same text; `None` if it cannot be drawn.
fn picture(scene: usize, folder: Option<&Path>, progress: &Progress) -> Option<Vec<u8>> {
    let (_, text) = BUILTIN.get(scene)?;
    let bytes = text.bytes().chain(env!("CARGO_PKG_VERSION").bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325u64, |hash, b| (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    let file = folder.map(|folder| folder.join(format!("card-{hash:016x}.rgb")));
    let [w, h] = PICTURE;
    let kept = file.as_ref().and_then(|file| std::fs::read(file).ok()).filter(|bytes| bytes.len() == 3 * w * h);
    if kept.is_some() {
        return kept;
    }
    // Coarser ground is enough for a small picture.
    let text = text.replace("builtin:massif?seed=7\"", "builtin:massif?seed=7&size=257\"");
    let mut document = scene_file::parse(Path::new("built-in.toml"), &text).ok()?.document;
    document.camera.image = PICTURE.map(|n| n as u32);
    document.overlay = Some(OverlayDoc { mark: false, ..document.overlay.unwrap_or_default() });
    let session = Place::default().session(document, progress).ok()?;
    let quality = RenderOptions { samples: 4, ..RenderOptions::default() };
    let options = PictureOptions { quality, progress: progress.clone(), ..PictureOptions::default() };
    let frame = session.render(&options).ok()?.frame;
    let bytes = frame.color.as_flattened().to_vec();
    if let Some(file) = file {
        // It is drawn again where it cannot be kept.
        let _ = std::fs::write(file, &bytes);
    }
    Some(bytes)
}

impl Viewer {
    /// Shows the welcome until something is opened or edited.
    pub(super) fn welcome(&mut self, ctx: &Context) {
        self.tour(ctx);
        if !self.welcome.open {
            return;
        }
        if self.model.editor.can_undo() || self.pending.is_some() {
            self.welcome.open = false;
        }
        if !self.welcome.open {
            self.welcome.stop();
            return;
        }
        if self.model.rests() {
            self.welcome.draw(self.state.clone(), self.wake.clone());
        }
        self.welcome.take(ctx);
        let (mut open, mut chosen, mut asks, mut tours) = (true, None, false, false);
        let small = ctx.content_rect().width() < super::SMALL;
        let columns = if small { 2 } else { CARDS.len() };
        let middle = if small { ctx.content_rect().center() } else { self.picture.middle };
        let window = Window::new(tr("Welcome")).open(&mut open).collapsible(false).resizable(false);
        let window = window.pivot(Align2::CENTER_CENTER).default_pos(middle);
        let window = if small { window.fixed_pos(middle) } else { window };
        window.show(ctx, |ui| {
            ui.vertical_centered(|ui| {
                ui.heading(tr("Drop an elevation model and a track"));
                ui.label(tr("on the window: it finds a view in which the track is seen."));
                ui.horizontal(|ui| {
                    asks = ui.button(tr("Open files…")).clicked();
                    let name = tr(if self.remembered.toured { "Tour" } else { "Take the tour, one minute" });
                    tours = ui.button(name).clicked();
                });
            });
            ui.separator();
            ui.label(tr("Or begin with an example:"));
            chosen = self.welcome.cards(ui, columns);
        });
        self.welcome.open = open;
        if let Some(scene) = chosen {
            self.welcome.open = false;
            self.choose(ctx, crate::menu::Choice::Builtin(scene));
        }
        if asks {
            self.command(ctx, crate::keys::Command::Open);
        }
        if tours {
            self.welcome.open = false;
            self.welcome.tour = Some(0);
        }
        if !self.welcome.open {
            self.welcome.stop();
        }
    }

    /// Shows the step of the tour.
    fn tour(&mut self, ctx: &Context) {
        let Some(step) = self.welcome.tour else { return };
        let Some((title, text)) = TOUR.get(step) else { return };
        let mut next = Some(step);
        Window::new(tr("Tour"))
            .id(Id::unique("tour"))
            .collapsible(false)
            .resizable(false)
            .anchor(Align2::RIGHT_BOTTOM, [-16.0, -60.0])
            .show(ctx, |ui| {
                ui.set_max_width(300.0);
                ui.strong(fill(tr("{0} of {1}: {2}"), &[&(step + 1), &TOUR.len(), &tr(title)]));
                ui.label(tr(text));
                ui.horizontal(|ui| {
                    if ui.button(tr(if step + 1 < TOUR.len() { "Next" } else { "Done" })).clicked() {
                        next = (step + 1 < TOUR.len()).then_some(step + 1);
                    }
                    if step + 1 < TOUR.len() && ui.button(tr("Skip the tour")).clicked() {
                        next = None;
                    }
                });
            });
        self.welcome.tour = next;
        if next.is_none() {
            self.remembered.toured = true;
            self.write_remembered();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_drawn_once_and_read_after_that() {
        let folder = tempfile::tempdir().expect("folder");
        let drawn = picture(0, Some(folder.path()), &Progress::silent()).expect("a picture");
        let [w, h] = PICTURE;
        assert_eq!(drawn.len(), 3 * w * h);
        assert!(drawn.iter().any(|byte| *byte != drawn[0]), "it is empty");
        let file = std::fs::read_dir(folder.path()).expect("folder").flatten().next().expect("a file").path();
        std::fs::write(&file, vec![7; drawn.len()]).expect("written");
        assert_eq!(picture(0, Some(folder.path()), &Progress::silent()), Some(vec![7; drawn.len()]));
        std::fs::write(&file, "cut short").expect("written");
        assert_eq!(picture(0, Some(folder.path()), &Progress::silent()), Some(drawn));
    }
}

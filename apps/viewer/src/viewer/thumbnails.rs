//! Small pictures of the bookmarks, drawn beside the window while it rests and the list is open.

use super::Viewer;
use crate::menu::Bookmark;
use crate::model::Model;
use crate::wake::Wake;
use belvedere::live::Thumbnails;
use belvedere::scene::{Frame, Progress};
use belvedere::scene_file::Document;
use belvedere_studio::beside;
use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver, TryRecvError};

/// Size of a picture, pixels.
const PICTURE: [u32; 2] = [128, 72];

/// The last picture of a camera.
#[derive(Default)]
struct Card {
    /// Key of the scene that it shows.
    of: u64,
    /// `None`: the scene cannot be drawn from there.
    texture: Option<TextureHandle>,
}

/// A picture that is being drawn.
struct Drawing {
    camera: u64,
    of: u64,
    progress: Progress,
    inbox: Receiver<Option<Frame>>,
}

/// The pictures of the bookmarks, by the keys of their cameras.
#[derive(Default)]
pub(super) struct BookmarkPictures {
    cards: HashMap<u64, Card>,
    drawing: Option<Drawing>,
    /// The last document, and the key of what it shows whatever the camera.
    scene: Option<(Arc<Document>, u64)>,
}

impl Drop for BookmarkPictures {
    fn drop(&mut self) {
        self.stop();
    }
}

impl BookmarkPictures {
    /// The newest picture of a bookmark; an old one stands until the new one is drawn.
    pub(super) fn of(&self, bookmark: &Bookmark) -> Option<&TextureHandle> {
        self.cards.get(&key_of_camera(bookmark)?)?.texture.as_ref()
    }

    /// Gives up the picture in work.
    pub(super) fn stop(&mut self) {
        if let Some(drawing) = self.drawing.take() {
            drawing.progress.cancel_flag().store(true, Ordering::Relaxed);
        }
    }

    /// Draws what is missing, one picture after the other, while the window rests; stops when something moves.
    fn draw(&mut self, ctx: &Context, model: &Model, bookmarks: &[Bookmark]) {
        let Some(of) = model.rests().then(|| self.key(model)).flatten() else { return self.stop() };
        if self.drawing.as_ref().is_some_and(|drawing| drawing.of != of) {
            self.stop();
        }
        self.take(ctx);
        if self.drawing.is_some() {
            return;
        }
        let cameras: Vec<Option<u64>> = bookmarks.iter().map(key_of_camera).collect();
        self.cards.retain(|camera, _| cameras.contains(&Some(*camera)));
        let is_missing = |camera: u64| self.cards.get(&camera).is_none_or(|card| card.of != of);
        let missing = cameras.iter().zip(bookmarks).find_map(|(camera, bookmark)| {
            let camera = camera.filter(|camera| is_missing(*camera))?;
            Some((camera, bookmark))
        });
        if let Some((camera, bookmark)) = missing {
            self.begin(ctx, model, (camera, of), bookmark);
        }
    }

    fn begin(&mut self, ctx: &Context, model: &Model, (camera, of): (u64, u64), bookmark: &Bookmark) {
        let Some(shown) = &model.shown else { return };
        let document = Document { camera: bookmark.camera.clone(), ..(**model.document()).clone() };
        let width = model.screen_size().map_or(PICTURE[0], |[width, _]| width);
        let scale = model.density * f64::from(PICTURE[0]) / f64::from(width.max(1));
        let thumbnails = Thumbnails::new(&shown.session, &model.editor.place, scale);
        let (outbox, inbox) = mpsc::channel();
        let (progress, wake) = (Progress::silent(), Wake::new(ctx));
        let own = progress.clone();
        let work = move || {
            let _ = outbox.send(thumbnails.draw(&document, PICTURE, &own).ok());
            wake.call();
        };
        match beside(work) {
            Ok(()) => self.drawing = Some(Drawing { camera, of, progress, inbox }),
            Err(_) => drop(self.cards.insert(camera, Card { of, texture: None })),
        }
    }

    fn take(&mut self, ctx: &Context) {
        let Some(drawing) = &self.drawing else { return };
        let frame = match drawing.inbox.try_recv() {
            Ok(frame) => frame,
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => None,
        };
        let texture = frame.map(|frame| {
            let image = ColorImage::from_rgb([frame.width, frame.height], frame.color.as_flattened());
            ctx.load_texture("bookmark", image, TextureOptions::LINEAR)
        });
        self.cards.insert(drawing.camera, Card { of: drawing.of, texture });
        self.drawing = None;
        // The next one is begun in the next frame.
        ctx.request_repaint();
    }

    /// What all pictures depend on: the document without its camera.
    fn key(&mut self, model: &Model) -> Option<u64> {
        let known = self.scene.as_ref().filter(|(document, _)| Arc::ptr_eq(document, model.document()));
        if let Some((_, key)) = known {
            return Some(*key);
        }
        let mut document = serde_json::to_value(&**model.document()).ok()?;
        for part in ["camera", "title", "animation", "constructor"] {
            document.as_object_mut()?.remove(part);
        }
        let mut hasher = DefaultHasher::new();
        (document.to_string(), model.scenes).hash(&mut hasher);
        let key = hasher.finish();
        self.scene = Some((model.document().clone(), key));
        Some(key)
    }
}

fn key_of_camera(bookmark: &Bookmark) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    serde_json::to_string(&bookmark.camera).ok()?.hash(&mut hasher);
    Some(hasher.finish())
}

impl Viewer {
    /// Draws the missing pictures of the bookmarks while their list is open.
    pub(super) fn draw_bookmarks(&mut self, ctx: &Context) {
        match self.lists_bookmarks && !self.bookmarks.is_empty() {
            true => self.bookmark_pictures.draw(ctx, &self.model, &self.bookmarks),
            false => self.bookmark_pictures.stop(),
        }
    }
}

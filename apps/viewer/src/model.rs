//! State of the application without its window: the document, the last pictures, and how they are viewed.

mod gestures;

use crate::flight::{Flying, Ring};
use crate::handles::Handles;
use crate::language::tr;
pub(crate) use crate::look::{Compare, Look, Tool};
use crate::notices::Notices;
use belvedere::core::{DVec2, DVec3, Navigation};
use belvedere::live::{Judged, Order, Pace, Quality, Shown, Sides};
use belvedere::scene::Frame;
use belvedere::scene::Instant as Clock;
use belvedere::scene_file::camera::{frame_factor, navigation, set_camera};
use belvedere::scene_file::{CameraDoc, Document, LayerDoc, StageDoc};
use belvedere_studio::{Answer, Editor, Painter, above_ground, object_at};
use eframe::egui::Id;
use std::sync::Arc;

/// Number of kept times.
const LATENCIES: usize = 600;
/// Time without motion after which the picture is drawn in full, seconds; longer in a browser, where drawing cannot be interrupted.
const REST_AFTER: f64 = if cfg!(target_family = "wasm") { 0.09 } else { 0.06 };
/// Time in which a straight picture becomes a bent one, seconds.
const EASE: f64 = 0.6;

/// A picture to be ordered.
#[derive(Debug, Clone)]
struct Wanted {
    document: Arc<Document>,
    image: [u32; 2],
    /// Pixels per point of the window.
    density: f64,
    sides: Sides,
    /// Share of the bend, 0..=1.
    bend: f64,
    overhead: bool,
}

impl PartialEq for Wanted {
    fn eq(&self, other: &Self) -> bool {
        let of = |wanted: &Self| (wanted.image, wanted.density, wanted.sides, wanted.bend, wanted.overhead);
        Arc::ptr_eq(&self.document, &other.document) && of(self) == of(other)
    }
}

/// What was there before a scene that has no picture yet.
struct Before {
    editor: Editor,
    shown: Option<Box<Shown>>,
    overhead: Option<(Frame, belvedere::core::View)>,
    judged: Option<Box<Judged>>,
}

/// The application without its window.
pub(crate) struct Model {
    pub(crate) editor: Editor,
    pub(crate) look: Look,
    pub(crate) notices: Notices,
    painter: Painter,
    /// The last picture.
    pub(crate) shown: Option<Box<Shown>>,
    /// Counts pictures, so that textures know when they are old.
    pub(crate) pictures: u64,
    /// The last camera from above.
    pub(crate) overhead: Option<(Frame, belvedere::core::View)>,
    /// Measured visibility of the last picture that was judged.
    pub(crate) judged: Option<Box<Judged>>,
    /// What the open panel edits in the picture; forgotten with every frame.
    pub(crate) handles: Option<Handles>,
    /// Why the current document cannot be drawn.
    pub(crate) violated: Option<String>,
    ordered: Option<Wanted>,
    /// Pace of the last order that is still unanswered.
    waiting: Option<Pace>,
    /// Documents of moving pictures that are still to arrive, and when they were ordered.
    awaited: Vec<(Arc<Document>, Clock)>,
    /// Times from input to picture of the last moving pictures, milliseconds.
    pub(crate) latencies: Vec<f64>,
    /// Times from the last change to the picture in full of the last pictures at rest, milliseconds.
    pub(crate) rests_after: Vec<f64>,
    changed: Clock,
    rested: bool,
    changed_at: f64,
    /// Share of the transition from straight to bent, 0..=1, and the time of its last step, seconds.
    way: f64,
    moved_on_at: f64,
    /// Quality of moving pictures; `None` = as good as is drawn in time.
    pub(crate) quality: Option<Quality>,
    /// Number of the gesture under way, and what edits in its course.
    gesture: u64,
    by: Option<Id>,
    /// The control that had the keyboard in the last frame.
    focus: Option<Id>,
    /// Pixels of the picture per point of the window: lines, marks and names are that many times as large.
    pub(crate) density: f64,
    /// Whether files are chosen in windows of the system.
    pub(crate) system_dialogs: bool,
    /// Progress of opening files, in words; nothing is drawn before the first picture.
    pub(crate) opening: Option<String>,
    before: Option<Before>,
    /// The document whose picture was given up.
    stopped: Option<Arc<Document>>,
    /// Whether the scene of before has come back since a new one could not be drawn.
    pub(crate) came_back: bool,
    /// Counts scenes, so that what belongs to one knows when it is gone.
    pub(crate) scenes: u64,
    /// The flight under way, and the ring around what was found.
    pub(crate) flying: Option<Flying>,
    pub(crate) ring: Option<Ring>,
}

impl Model {
    /// * `wake`: called from another thread when an answer has arrived.
    pub(crate) fn new(editor: Editor, wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            editor,
            look: Look::default(),
            notices: Notices::default(),
            painter: Painter::new(wake),
            shown: None,
            pictures: 0,
            overhead: None,
            judged: None,
            handles: None,
            violated: None,
            ordered: None,
            waiting: None,
            awaited: Vec::new(),
            latencies: Vec::new(),
            rests_after: Vec::new(),
            changed: Clock::now(),
            rested: false,
            changed_at: f64::NEG_INFINITY,
            way: 1.0,
            moved_on_at: f64::NEG_INFINITY,
            quality: None,
            gesture: 0,
            by: None,
            focus: None,
            density: 1.0,
            system_dialogs: false,
            opening: None,
            before: None,
            stopped: None,
            came_back: false,
            scenes: 0,
            flying: None,
            ring: None,
        }
    }

    /// The document.
    pub(crate) fn document(&self) -> &Arc<Document> {
        self.editor.document()
    }

    /// Another document in place of this one, which comes back if the other cannot be drawn.
    pub(crate) fn replace(&mut self, editor: Editor) {
        let editor = std::mem::replace(&mut self.editor, editor);
        let (shown, overhead, judged) = (self.shown.take(), self.overhead.take(), self.judged.take());
        // A scene that was never drawn is not worth coming back to.
        if self.before.is_none() {
            self.before = Some(Before { editor, shown, overhead, judged });
        }
        (self.violated, self.ordered) = (None, None);
        (self.flying, self.ring) = (None, None);
        self.scenes += 1;
    }

    /// Keeps the scene although it may not be drawn: it is all that is left of an earlier session.
    pub(crate) fn stay(&mut self) {
        self.before = None;
    }

    /// Whether a new scene waits for its first picture; until then nothing edits it.
    pub(crate) fn is_opening(&self) -> bool {
        self.shown.is_none() && (self.opening.is_some() || self.before.is_some())
    }

    /// Takes the scene of before again.
    fn come_back(&mut self, before: Before) {
        self.editor = before.editor;
        (self.shown, self.overhead, self.judged) = (before.shown, before.overhead, before.judged);
        (self.violated, self.ordered) = (None, None);
        self.pictures += 1;
        self.scenes += 1;
        self.came_back = true;
    }

    /// The current camera; `None` before the first picture.
    pub(crate) fn camera(&self) -> Option<Navigation> {
        let shown = self.shown.as_ref()?;
        let (written, resolved) = (&self.document().camera, &shown.session.resolved()?.camera);
        let image = self.image()?;
        let factor = frame_factor(self.document(), image);
        Some(navigation(written, resolved, shown.session.view(), shown.session.scene(), (image, factor)))
    }

    /// The current camera as a document has it; `None` before the first picture.
    pub(crate) fn camera_doc(&self) -> Option<CameraDoc> {
        let mut document = (**self.document()).clone();
        set_camera(&mut document, &self.camera()?);
        Some(document.camera)
    }

    /// Size of the picture on the screen, pixels.
    pub(crate) fn screen_size(&self) -> Option<[u32; 2]> {
        self.image()
    }

    /// The document's frame on the picture, as shares of its width and height about the middle; more than 1 where it is cut off.
    pub(crate) fn frame_shares(&self) -> Option<[f64; 2]> {
        let image = self.image()?;
        let shape = |[w, h]: [u32; 2]| f64::from(w) / f64::from(h);
        let height = 1.0 / frame_factor(self.document(), image);
        Some([height * shape(self.document().camera.image) / shape(image), height])
    }

    /// Size of the picture that is shown, pixels.
    fn image(&self) -> Option<[u32; 2]> {
        self.ordered.as_ref().map(|ordered| ordered.image)
    }

    /// Moves the camera within a gesture of `by`, never below the ground; a move that fails is ignored.
    pub(crate) fn move_camera<E>(&mut self, by: Id, change: impl FnOnce(&Navigation) -> Result<Navigation, E>) {
        if self.has_own_camera() {
            self.notices.note(
                tr("The preview along a path has a camera of its own; bend rays by hand to move it."),
                self.moved_on_at,
            );
            return;
        }
        let next = self.camera().and_then(|camera| change(&camera).ok());
        let scene = self.shown.as_ref().map(|shown| shown.session.scene());
        if let (Some(next), Some(scene)) = (next, scene) {
            let next = above_ground(next, scene);
            self.edit_on(by, |document| set_camera(document, &next));
        }
    }

    /// World point that the picture shows at a position, given as shares of its width and height.
    pub(crate) fn world_at(&self, share: DVec2) -> Option<DVec3> {
        let shown = self.shown.as_ref().filter(|_| !self.is_easing())?;
        let frame = if self.look.bent { shown.bent.as_ref() } else { shown.straight.as_ref() }?;
        let at = share * DVec2::new(frame.width as f64, frame.height as f64);
        let inside = at.min_element() >= 0.0 && (at.x as usize) < frame.width && (at.y as usize) < frame.height;
        let depth = f64::from(*frame.depth.get(at.y as usize * frame.width + at.x as usize).filter(|_| inside)?);
        if !depth.is_finite() {
            return None;
        }
        let mut view = shown.session.view().clone();
        if !self.look.bent {
            view = view.straightened();
        }
        let [w, h] = view.pinhole().image.map(f64::from);
        view.ray(share * DVec2::new(w, h)).at(depth).ok().map(|seen| seen.point)
    }

    /// The object of a layer that the picture shows at a position (shares of width and height): a target for constructors.
    pub(crate) fn object_at(&self, share: DVec2, layer: &str, point: Option<DVec3>) -> Option<String> {
        let session = &self.shown.as_ref()?.session;
        let [w, h] = session.view().pinhole().image.map(f64::from);
        object_at(session, layer, share * DVec2::new(w, h), point)
    }

    /// Time for which the picture at rest has been in work, seconds; `None` if none is in work.
    pub(crate) fn works_since(&self) -> Option<f64> {
        (self.waiting == Some(Pace::Resting)).then(|| self.changed.elapsed().as_secs_f64())
    }

    /// What the picture at rest is at, and its share done, 0..=1.
    pub(crate) fn progress(&self) -> Option<(String, f64)> {
        self.painter.progress()
    }

    /// Gives up the picture at rest that is in work; the last one stays.
    pub(crate) fn stop(&mut self) {
        if self.waiting == Some(Pace::Resting) {
            self.painter.cancel();
            self.waiting = None;
            self.stopped = self.ordered.as_ref().map(|ordered| ordered.document.clone());
            if let Some(before) = self.before.take() {
                self.come_back(before);
            }
        }
    }

    /// Whether the picture of the current document was given up.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.as_ref().is_some_and(|document| Arc::ptr_eq(document, self.document())) && self.waiting.is_none()
    }

    /// Orders the picture that was given up.
    pub(crate) fn draw_again(&mut self) {
        self.stopped = None;
        self.ordered = None;
    }

    /// Id of the layer that the picture shows at a position, given as shares of its width and height.
    pub(crate) fn layer_at(&self, share: DVec2) -> Option<String> {
        let shown = self.shown.as_ref()?;
        let frame = if self.look.bent { shown.bent.as_ref() } else { shown.straight.as_ref() }?;
        let at = share * DVec2::new(frame.width as f64, frame.height as f64);
        let id = *frame.id.get(at.y as usize * frame.width + at.x as usize)? as usize;
        Some(shown.session.scene().layers.get(id.checked_sub(1)?)?.id.clone())
    }

    /// Whether two pictures are compared.
    fn compares(&self) -> bool {
        self.look.compare != Compare::Off || self.look.inset
    }

    /// Whether the picture is in transition between straight and bent.
    pub(crate) fn is_easing(&self) -> bool {
        !self.compares() && self.way != f64::from(u8::from(self.look.bent))
    }

    /// Advances the transition between straight and bent; compared pictures skip it.
    fn ease(&mut self, now: f64) {
        let end = f64::from(u8::from(self.look.bent));
        let step = (now - self.moved_on_at).min(0.1) / EASE;
        self.moved_on_at = now;
        self.way = if self.compares() { end } else { self.way + (end - self.way).clamp(-step, step) };
    }

    /// Which pictures to order, and the share of the bend, eased.
    fn sides(&self) -> (Sides, f64) {
        match self.way {
            _ if self.compares() => (Sides::Both, 1.0),
            way if way > 0.0 => (Sides::Bent, way * way * (3.0 - 2.0 * way)),
            _ => (Sides::Straight, 1.0),
        }
    }

    /// Orders a picture if the document, the size or the view changed.
    ///
    /// * `image`: size of the picture on the screen, pixels. `now`: time of the window, seconds.
    ///
    /// Returns the time after which to call it again, seconds.
    pub(crate) fn order(&mut self, image: [u32; 2], now: f64) -> Option<f64> {
        if self.shown.is_none() && self.opening.is_some() {
            return None;
        }
        self.ease(now);
        let (sides, bend) = self.sides();
        let (document, density, overhead) = (self.document().clone(), self.density, self.look.overhead);
        let wanted = Wanted { document, image, density, sides, bend, overhead };
        if self.ordered.as_ref() != Some(&wanted) {
            (self.changed_at, self.changed) = (now, Clock::now());
            self.rested = false;
            self.ordered = Some(wanted.clone());
            let takes_long = self.document().solves_terrain() || self.document().constructor.is_some();
            if self.shown.is_some() || takes_long {
                self.awaited.push((wanted.document.clone(), Clock::now()));
                self.send(wanted, image, Pace::Moving { quality: self.quality });
                return Some(if self.is_easing() { 0.0 } else { REST_AFTER });
            }
        }
        if self.is_easing() {
            return Some(0.0);
        }
        if self.rested {
            // A waiting user sees the elapsed time.
            return self.works_since().map(|_| 0.5);
        }
        let due = self.changed_at + REST_AFTER;
        if self.shown.is_some() && now < due {
            return Some(due - now);
        }
        self.rested = true;
        self.send(wanted, image, Pace::Resting);
        None
    }

    /// Whether the measured visibility belongs to the picture in full of the current document.
    pub(crate) fn is_judged(&self) -> bool {
        let is_it = |judged: &Judged| judged.pace == Pace::Resting && Arc::ptr_eq(&judged.document, self.document());
        self.judged.as_deref().is_some_and(is_it)
    }

    fn send(&mut self, wanted: Wanted, image: [u32; 2], pace: Pace) {
        let Wanted { document, density, sides, bend, overhead, .. } = wanted;
        self.painter.set_density(density);
        let place = self.editor.place.clone();
        self.waiting = Some(pace);
        self.painter.order(Order { document, place, image, pace, sides, bend, overhead });
    }

    /// Takes the painter's answers.
    pub(crate) fn take_answers(&mut self) {
        while let Some(answer) = self.painter.answer() {
            self.take(answer);
        }
    }

    fn take(&mut self, answer: Answer) {
        match answer {
            // The last picture of a scene that has been replaced.
            Answer::Shown(shown) if self.before.is_some() && !Arc::ptr_eq(&shown.document, self.document()) => {}
            Answer::Shown(mut shown) => {
                self.before = None;
                self.waiting = self.waiting.filter(|pace| *pace != shown.pace);
                if let Pace::Moving { .. } = shown.pace {
                    self.arrived(&shown.document);
                } else {
                    note(&mut self.rests_after, self.changed.elapsed().as_secs_f64() * 1e3);
                }
                self.overhead = shown.overhead.take().or(self.overhead.take());
                self.violated = None;
                self.pictures += 1;
                self.shown = Some(shown);
            }
            Answer::Judged(judged) => self.judged = Some(judged),
            Answer::Failed(document, reason) => {
                if self.before.is_some() && !Arc::ptr_eq(&document, self.document()) {
                    return;
                }
                self.waiting = None;
                if self.shown.is_none() {
                    // The words of its file, since that is where it can be mended.
                    self.notices.error(reason.clone());
                    if let Some(before) = self.before.take() {
                        return self.come_back(before);
                    }
                }
                let own: Vec<&str> = document.layer.iter().map(LayerDoc::id).collect();
                self.violated = Some(crate::words::in_window_words(&reason, &own));
            }
        }
    }

    /// Notes the time from input to a moving picture, and drops the documents ordered before it, which were overtaken.
    fn arrived(&mut self, document: &Arc<Document>) {
        let Some(at) = self.awaited.iter().position(|(awaited, _)| Arc::ptr_eq(awaited, document)) else { return };
        let (_, since) = self.awaited.drain(..=at).next_back().unwrap_or_else(|| (document.clone(), Clock::now()));
        note(&mut self.latencies, since.elapsed().as_secs_f64() * 1e3);
    }

    /// Median time from input to picture, milliseconds.
    pub(crate) fn latency(&self) -> Option<f64> {
        let mut sorted = self.latencies.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// Whether the picture shows the current document, in full.
    pub(crate) fn rests(&self) -> bool {
        let is_it = |shown: &Shown| shown.pace == Pace::Resting && Arc::ptr_eq(&shown.document, self.document());
        self.rested && self.waiting.is_none() && self.flying.is_none() && self.shown.as_deref().is_some_and(is_it)
    }

    /// The stage of a kind, if the document has one.
    pub(crate) fn stage(&self, kind: &str) -> Option<&StageDoc> {
        self.document().stage.iter().find(|stage| stage.kind() == kind)
    }

    /// Ids of the layers that pass a test.
    pub(crate) fn layer_ids(&self, passes: impl Fn(&LayerDoc) -> bool) -> Vec<String> {
        self.document().layer.iter().filter(|layer| passes(layer)).map(|layer| layer.id().to_owned()).collect()
    }
}

/// Notes a time, and forgets the oldest.
fn note(times: &mut Vec<f64>, milliseconds: f64) {
    times.push(milliseconds);
    let extra = times.len().saturating_sub(LATENCIES);
    times.drain(..extra);
}

#[cfg(test)]
mod tests;

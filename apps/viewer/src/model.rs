//! Everything that panels look at and change: the document, what is shown of it, how it is looked at.

use crate::notices::Notices;
use belvedere::core::{DVec2, DVec3, Navigation};
use belvedere::editor::{Answer, Editor, Judged, Order, Pace, Painter, Shown, Sides, navigation, set_camera};
use belvedere::scene::Frame;
use belvedere::scene::Instant as Clock;
use belvedere::scene_file::{Document, LayerDoc, StageDoc};
use std::sync::Arc;

/// How two pictures are compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Compare {
    /// One is shown.
    #[default]
    Off,
    /// Straight on the left of a bar, bent on the right.
    Split,
    /// In turn.
    Flicker,
}

/// What the pointer does in the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Tool {
    /// Drags the map.
    #[default]
    Map,
    /// Turns about the middle.
    Orbit,
    /// Picks what has to stay in sight.
    Track,
}

/// How the scene is looked at; no part of the document.
#[derive(Debug, Clone)]
pub(crate) struct Look {
    /// Bent or straight.
    pub(crate) bent: bool,
    pub(crate) compare: Compare,
    /// Where the bar of a split picture stands, share of the width.
    pub(crate) split: f32,
    /// The straight picture in a corner.
    pub(crate) inset: bool,
    /// The camera from above.
    pub(crate) overhead: bool,
    /// Renderer and times.
    pub(crate) statistics: bool,
    pub(crate) tool: Tool,
}

impl Default for Look {
    fn default() -> Self {
        let (compare, tool) = (Compare::default(), Tool::default());
        Self { bent: true, compare, split: 0.5, inset: false, overhead: false, statistics: false, tool }
    }
}

/// Longest that a moving picture may take before it is made coarser, milliseconds; shortest before it is made finer.
const PACE_MS: [f64; 2] = [32.0, 16.0];
/// Least share of the pixels' width of a moving picture.
const COARSEST: f64 = 0.35;
/// Moving pictures whose times are remembered.
const LATENCIES: usize = 600;
/// How long nothing moves before the picture is drawn in full, seconds.
const REST_AFTER: f64 = 0.09;

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
    /// What the last picture at rest shows.
    pub(crate) judged: Option<Box<Judged>>,
    /// Why the document as it is cannot be drawn.
    pub(crate) violated: Option<String>,
    ordered: Option<(Arc<Document>, [u32; 2], Sides, bool)>,
    /// Documents of moving pictures that are not there yet, and when they were ordered.
    awaited: Vec<(Arc<Document>, Clock)>,
    /// Times from input to picture of the last moving pictures, milliseconds.
    pub(crate) latencies: Vec<f64>,
    rested: bool,
    changed_at: f64,
    /// Share of the pixels' width that moving pictures have.
    pub(crate) coarseness: f64,
    gesture: u64,
}

impl Model {
    /// * `wake`: called from another thread when there is something new.
    pub(crate) fn new(editor: Editor, wake: impl Fn() + Send + 'static) -> Self {
        Self {
            editor,
            look: Look::default(),
            notices: Notices::default(),
            painter: Painter::new(Box::new(wake)),
            shown: None,
            pictures: 0,
            overhead: None,
            judged: None,
            violated: None,
            ordered: None,
            awaited: Vec::new(),
            latencies: Vec::new(),
            rested: false,
            changed_at: f64::NEG_INFINITY,
            coarseness: 1.0,
            gesture: 0,
        }
    }

    /// The document.
    pub(crate) fn document(&self) -> &Arc<Document> {
        self.editor.document()
    }

    /// Edits the document; one step of undo.
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut Document)) {
        self.editor.edit(change);
    }

    /// A new gesture: edits within it are one step of undo.
    pub(crate) fn begin_gesture(&mut self) {
        self.gesture += 1;
    }

    /// Edits the document in the course of the gesture.
    pub(crate) fn edit_on(&mut self, change: impl FnOnce(&mut Document)) {
        self.editor.edit_within(self.gesture, change);
    }

    /// Another document in place of this one.
    pub(crate) fn replace(&mut self, editor: Editor) {
        self.editor = editor;
        (self.shown, self.overhead, self.judged, self.violated) = (None, None, None, None);
        self.ordered = None;
    }

    /// The camera in the hand; `None` before the first picture.
    pub(crate) fn camera(&self) -> Option<Navigation> {
        let shown = self.shown.as_ref()?;
        let (written, resolved) = (&self.document().camera, &shown.session.resolved()?.camera);
        Some(navigation(written, resolved, shown.session.view(), shown.session.scene(), self.image()?))
    }

    /// Size of the picture that is shown, pixels.
    fn image(&self) -> Option<[u32; 2]> {
        self.ordered.as_ref().map(|ordered| ordered.1)
    }

    /// Moves the camera in the course of the gesture; what cannot be is not.
    pub(crate) fn move_camera<E>(&mut self, change: impl FnOnce(&Navigation) -> Result<Navigation, E>) {
        if let Some(next) = self.camera().and_then(|camera| change(&camera).ok()) {
            self.edit_on(|document| set_camera(document, &next));
        }
    }

    /// World point that the picture shows at a pixel of itself.
    pub(crate) fn world_at(&self, share: DVec2) -> Option<DVec3> {
        let shown = self.shown.as_ref()?;
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

    /// Id of the layer that the picture shows at a share of it.
    pub(crate) fn layer_at(&self, share: DVec2) -> Option<String> {
        let shown = self.shown.as_ref()?;
        let frame = if self.look.bent { shown.bent.as_ref() } else { shown.straight.as_ref() }?;
        let at = share * DVec2::new(frame.width as f64, frame.height as f64);
        let id = *frame.id.get(at.y as usize * frame.width + at.x as usize)? as usize;
        Some(shown.session.scene().layers.get(id.checked_sub(1)?)?.id.clone())
    }

    /// Which pictures are wanted.
    fn sides(&self) -> Sides {
        let both = self.look.compare != Compare::Off || self.look.inset;
        match (both, self.look.bent) {
            (true, _) => Sides::Both,
            (false, true) => Sides::Bent,
            (false, false) => Sides::Straight,
        }
    }

    /// Orders what is not there yet.
    ///
    /// * `image`: size of the picture on the screen, pixels. `now`: time of the window, seconds.
    ///
    /// Returns the time after which it wants to be asked again.
    pub(crate) fn order(&mut self, image: [u32; 2], now: f64) -> Option<f64> {
        let wanted = (self.document().clone(), image, self.sides(), self.look.overhead);
        let is_new = self.ordered.as_ref().is_none_or(|old| {
            !Arc::ptr_eq(&old.0, &wanted.0) || (old.1, old.2, old.3) != (wanted.1, wanted.2, wanted.3)
        });
        if is_new {
            self.changed_at = now;
            self.rested = false;
            self.ordered = Some(wanted.clone());
            if self.shown.is_some() {
                let size = image.map(|n| ((f64::from(n) * self.coarseness) as u32).max(16));
                let detail_px = 1.0 / self.coarseness;
                self.send(&wanted, size, Pace::Moving { detail_px });
                self.awaited.push((wanted.0, Clock::now()));
                return Some(REST_AFTER);
            }
        }
        if self.rested {
            return None;
        }
        let due = self.changed_at + REST_AFTER;
        if self.shown.is_some() && now < due {
            return Some(due - now);
        }
        self.rested = true;
        self.send(&wanted, image, Pace::Resting);
        None
    }

    fn send(&mut self, wanted: &(Arc<Document>, [u32; 2], Sides, bool), image: [u32; 2], pace: Pace) {
        let (document, _, sides, overhead) = wanted.clone();
        let place = self.editor.place.clone();
        self.painter.order(Order { document, place, image, pace, sides, overhead });
    }

    /// Takes what the painter has made.
    pub(crate) fn take_answers(&mut self) {
        while let Some(answer) = self.painter.answer() {
            self.take(answer);
        }
    }

    fn take(&mut self, answer: Answer) {
        match answer {
            Answer::Shown(mut shown) => {
                if let Pace::Moving { .. } = shown.pace {
                    self.arrived(&shown.document);
                    let factor = match shown.milliseconds {
                        ms if ms > PACE_MS[0] => 0.85,
                        ms if ms < PACE_MS[1] => 1.1,
                        _ => 1.0,
                    };
                    self.coarseness = (self.coarseness * factor).clamp(COARSEST, 1.0);
                }
                self.overhead = shown.overhead.take().or(self.overhead.take());
                self.violated = None;
                self.pictures += 1;
                self.shown = Some(shown);
            }
            Answer::Judged(judged) => self.judged = Some(judged),
            Answer::Failed(reason) => {
                if self.shown.is_none() {
                    self.notices.error(reason.clone());
                }
                self.violated = Some(reason);
            }
        }
    }

    /// Notes how long a moving picture took from the input on; those before it were overtaken.
    fn arrived(&mut self, document: &Arc<Document>) {
        let Some(at) = self.awaited.iter().position(|(awaited, _)| Arc::ptr_eq(awaited, document)) else { return };
        let (_, since) = self.awaited.drain(..=at).next_back().unwrap_or_else(|| (document.clone(), Clock::now()));
        self.latencies.push(since.elapsed().as_secs_f64() * 1e3);
        let extra = self.latencies.len().saturating_sub(LATENCIES);
        self.latencies.drain(..extra);
    }

    /// Median time from input to picture, milliseconds.
    pub(crate) fn latency(&self) -> Option<f64> {
        let mut sorted = self.latencies.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// Whether the picture is that of the document, in full.
    pub(crate) fn rests(&self) -> bool {
        let is_it = |shown: &Shown| shown.pace == Pace::Resting && Arc::ptr_eq(&shown.document, self.document());
        self.rested && self.shown.as_deref().is_some_and(is_it)
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

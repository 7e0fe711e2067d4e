//! A session that follows a document: everything is resolved again, but unchanged layers are not read again.

mod coarse;
mod ground;
mod moving;
mod named;
mod rate;
mod sun;
mod thin;
mod thumbnail;

pub use rate::Quality;
pub use thumbnail::Thumbnails;

use crate::fallback;
use crate::picture::{self, DisplacementReport, PictureOptions};
use crate::placed::Place;
use crate::scene_file::camera;
use crate::scene_file::paths::Roots;
use crate::scene_file::{ConstructorKind, Document, LayerDoc, SourceDocument, StageDoc};
use crate::session::Loaded;
use crate::{BelvedereError, CameraPicture, OpenOptions, Session};
use belvedere_construct::measure::HiddenRun;
use belvedere_construct::{MeasureOptions, Measures};
use belvedere_core::{View, Warning};
use belvedere_resolve::hidden;
use belvedere_resolve::solving::Memory;
use belvedere_scene::Instant;
use belvedere_scene::{Frame, Progress, RenderJob, RenderOptions, Scene};
use ground::{Ground, with_ground};
use moving::{quick, within};
use named::NamedSections;
use rate::{Rate, TARGET_MS};
use std::sync::Arc;
use std::time::Duration;
use sun::HeldSun;
use thin::Thin;

/// An order for a picture of a document.
#[derive(Debug, Clone)]
pub struct Order {
    /// The document.
    pub document: Arc<Document>,
    /// Folders of its files.
    pub place: Place,
    /// Size of the picture on the screen, pixels.
    pub image: [u32; 2],
    /// Time that the picture may take.
    pub pace: Pace,
    /// Which pictures.
    pub sides: Sides,
    /// Share of the bend while the camera moves, 0..=1; at rest the bend is full.
    pub bend: f64,
    /// Whether to draw the camera from above as well; at rest only.
    pub overhead: bool,
}

/// Pictures of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// As the stages bend it.
    Bent,
    /// Without them.
    Straight,
    /// Both.
    Both,
}

/// Time that a picture may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// As little as possible, during a motion; slow solvers are postponed.
    Moving {
        /// Quality of the picture; `None` = as good as is drawn in time.
        quality: Option<Quality>,
    },
    /// As much as needed: the same picture that the command line draws.
    Resting,
}

/// A picture with its inputs.
#[derive(Debug, Clone)]
pub struct Shown {
    /// The document of the order.
    pub document: Arc<Document>,
    /// Scene, view, light and reports.
    pub session: Session,
    /// The bent picture, if it was ordered.
    pub bent: Option<Frame>,
    /// The straight picture, if it was ordered.
    pub straight: Option<Frame>,
    /// The camera from above and the view of that picture, if it was ordered.
    pub overhead: Option<(Frame, View)>,
    /// Displacement of the points in the picture; `None` if it is straight or was not measured.
    pub displacement: Option<DisplacementReport>,
    /// Pace of the order.
    pub pace: Pace,
    /// Quality of a moving picture; [`Quality::FULL`] at rest.
    pub quality: Quality,
    /// What was postponed because it takes long; one sentence.
    pub waits: Option<&'static str>,
    /// Wall time of all steps, milliseconds.
    pub milliseconds: f64,
}

/// Visibility of the required features in a picture.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The document.
    pub document: Arc<Document>,
    /// Pace of the picture's order.
    pub pace: Pace,
    /// Visible shares by lines of sight, of the document's frame.
    pub measures: Measures,
    /// Hidden stretches of the features.
    pub hidden: Vec<HiddenRun>,
    /// Share of the tracked target that the bent picture at rest shows, by its pixels, 0..=1; `None` during a motion or without a
    /// tracked target.
    pub target_seen: Option<f64>,
}

/// Longest judgement that is made after every moving picture.
const JUDGE_WITHIN: Duration = Duration::from_millis(8);
/// Longest judgement that is made between moving pictures at all, and the pause after it in multiples of its duration.
const JUDGE_AT_MOST: Duration = Duration::from_millis(120);
const JUDGE_SHARE: u32 = 12;
/// Longest solution that is made during a motion.
const SOLVE_WITHIN: Duration = Duration::from_millis(120);
/// Time after which a moving picture is broken off and drawn coarser, and how often.
const BREAK_OFF: Duration = Duration::from_millis(2 * TARGET_MS as u64);
const BROKEN_OFF: usize = 2;

/// A session that follows a document.
#[derive(Debug, Default)]
pub struct LiveSession {
    session: Option<Session>,
    named: NamedSections,
    /// The document by which its layers were read.
    opened: Option<Document>,
    /// Duration of the last construction.
    constructing: Duration,
    /// Memory of the constructors after the last picture at rest.
    memory: Memory,
    /// Session of the last picture.
    shown: Option<Session>,
    /// Duration of the last judgement, and the time of its end.
    judging: Duration,
    judged_at: Option<Instant>,
    ground: Ground,
    sun: HeldSun,
    thin: Thin,
    /// Pixels per point of the screen; `None`: 1.
    density: Option<f64>,
    rate: Rate,
    /// Layers of the last moving picture: what can be computed once has been.
    drawn: Option<Arc<Scene>>,
}

impl LiveSession {
    /// Draws lines, marks and names that many times as large from now on.
    ///
    /// * `density`: pixels of the picture per point of the screen, more than 0.
    pub fn set_density(&mut self, density: f64) {
        self.density = Some(density).filter(|density| density.is_finite() && *density > 0.0);
    }

    /// Resolves the order's document and draws it.
    ///
    /// # Errors
    /// As [`Session::open`] and [`Session::render`]; the session stays as it was.
    pub fn show(&mut self, order: &Order, progress: &Progress) -> Result<Shown, BelvedereError> {
        let began = Instant::now();
        let mut shown = match order.pace {
            Pace::Moving { quality } => self.in_motion(order, quality, progress)?,
            Pace::Resting => self.at_rest(order, progress)?,
        };
        shown.milliseconds = began.elapsed().as_secs_f64() * 1e3;
        Ok(shown)
    }

    /// Pixels of the picture per point of the screen.
    fn density(&self) -> f64 {
        self.density.unwrap_or(1.0)
    }

    fn at_rest(&mut self, order: &Order, progress: &Progress) -> Result<Shown, BelvedereError> {
        let mut document = (*order.document).clone();
        camera::fit(&mut document, order.image);
        let session = self.resting(document, order, progress)?;
        session.check_drawable()?;
        self.shown = Some(session.clone());
        let density = self.density();
        let mut displacement = None;
        let mut side = |plain: bool| {
            let request = PictureOptions { straight: plain, density, ..PictureOptions::default() };
            let drawn = picture::draw_view(&session, &request, progress)?;
            displacement = displacement.or(drawn.displacement);
            Ok::<_, BelvedereError>(Some(drawn.frame))
        };
        let bent = if order.sides == Sides::Straight { None } else { side(false)? };
        let straight = if order.sides == Sides::Bent { None } else { side(true)? };
        let overhead = if order.overhead { Some(overhead(&session, progress)?) } else { None };
        Ok(Shown { overhead, displacement, ..shown(order, session, Quality::FULL, [bent, straight]) })
    }

    /// A moving picture; one that takes too long is broken off and drawn coarser.
    ///
    /// * `fixed`: its quality, if it is not to be chosen.
    fn in_motion(
        &mut self,
        order: &Order,
        fixed: Option<Quality>,
        progress: &Progress,
    ) -> Result<Shown, BelvedereError> {
        let mut broken_off = 0;
        loop {
            let began = Instant::now();
            let quality = fixed.unwrap_or(self.rate.quality());
            let image = quality.size(order.image);
            let mut document = (*order.document).clone();
            camera::fit(&mut document, image);
            let (session, waits) = self.moving(document, image, order, progress)?;
            session.check_drawable()?;
            self.shown = Some(session.clone());
            let density = self.density();
            let resolving = began.elapsed();
            let scene = self.thin.scene(session.loaded.scene.clone(), quality, density);
            // The first picture of a scene prepares it.
            let of = self.session.as_ref().map(|session| session.loaded.scene.clone());
            let is_known = self.drawn.as_ref().zip(of.as_ref()).is_some_and(|(drawn, of)| Arc::ptr_eq(drawn, of));
            let drawing = Instant::now();
            let hurries = fixed.is_none() && is_known && broken_off < BROKEN_OFF;
            let limited = if hurries { within(BREAK_OFF, progress) } else { progress.unheard() };
            let pictures = sides(&session, &scene, (quality, density), order, &limited);
            let milliseconds = (resolving + drawing.elapsed()).as_secs_f64() * 1e3;
            match pictures {
                Err(e) if e.is_cancelled() && hurries && !progress.is_cancelled() => {
                    self.rate.broken_off(milliseconds);
                    broken_off += 1;
                }
                Err(e) => return Err(e),
                Ok(pictures) => {
                    if fixed.is_none() && is_known {
                        self.rate.note(milliseconds);
                    }
                    self.drawn = of;
                    return Ok(Shown { waits, ..shown(order, session, quality, pictures) });
                }
            }
        }
    }

    /// Whether there is time to judge a picture: always at rest; during a motion if the last judgement was short, or long enough ago.
    pub fn has_time_to_judge(&self, pace: Pace) -> bool {
        let waited = || self.judged_at.is_none_or(|at| at.elapsed() >= JUDGE_SHARE * self.judging);
        let in_time = || self.judging <= JUDGE_WITHIN || (self.judging <= JUDGE_AT_MOST && waited());
        pace == Pace::Resting || in_time()
    }

    /// Visibility of the required features in the view of the last picture; `None` if there are none.
    ///
    /// # Errors
    /// [`BelvedereError::Construct`], [`BelvedereError::Cancelled`].
    pub fn judge(&mut self, order: &Order, progress: &Progress) -> Result<Option<Judged>, BelvedereError> {
        if order.pace == Pace::Resting
            && let Some(session) = &self.session
        {
            // So that a motion need not wait for coarse models.
            self.thin.scene(session.loaded.scene.clone(), self.rate.quality(), self.density());
        }
        let began = Instant::now();
        let judged = self.judged(order, progress);
        // How long one would have taken that was broken off is not known.
        let least = if progress.is_cancelled() { self.judging } else { Duration::ZERO };
        self.judging = began.elapsed().max(least);
        self.judged_at = Some(Instant::now());
        judged
    }

    fn judged(&self, order: &Order, progress: &Progress) -> Result<Option<Judged>, BelvedereError> {
        let Some(session) = &self.shown else { return Ok(None) };
        let scene = session.scene();
        let view = &camera::cut_to_frame(session.view(), &order.document, order.image);
        let target_seen = if order.pace == Pace::Resting { target_seen(session, progress)? } else { None };
        let requires = scene.layers.iter().any(|layer| layer.must_see);
        if target_seen.is_none() && !requires {
            return Ok(None);
        }
        let options = MeasureOptions::default();
        let (measures, hidden) = if requires {
            belvedere_construct::measure::measure_and_hidden(scene, view, None, &options, progress)?
        } else {
            Default::default()
        };
        Ok(Some(Judged { document: order.document.clone(), pace: order.pace, measures, hidden, target_seen }))
    }

    /// Resolves a document with all solvers.
    fn resting(&mut self, document: Document, order: &Order, progress: &Progress) -> Result<Session, BelvedereError> {
        let options = order.place.options(progress);
        let session = match self.open(&document, &options)? {
            Some(session) => {
                let (began, mut memory) = (Instant::now(), self.memory.of_path());
                let session = session.edited(document.clone(), &options, &mut memory)?;
                (self.constructing, self.memory) = (began.elapsed(), memory);
                session
            }
            None => self.reopened(&document, &options)?,
        };
        self.sun.rest(order.document.light.as_ref(), *session.light());
        self.ground.last = session.view().ground().cloned().map(belvedere_core::Stage::TerrainDisocclusion);
        self.session = Some(session.clone());
        Ok(session)
    }

    /// Resolves a document for a moving picture: slow results are left out or reused.
    ///
    /// * `image`: size of the picture, pixels.
    fn moving(
        &mut self,
        document: Document,
        image: [u32; 2],
        order: &Order,
        progress: &Progress,
    ) -> Result<(Session, Option<&'static str>), BelvedereError> {
        const GROUND: &str = "the ground makes way when the view rests";
        const RAYS: &str = "rays are bent when the view rests";
        let (solves, constructs) = (document.solves_terrain(), document.constructor.is_some());
        // A preview has a camera of its own, so its picture is not drawn without it.
        let is_preview = document.constructor.as_ref().is_some_and(|doc| doc.kind == ConstructorKind::PathPreview);
        let in_time = constructs && !solves && (is_preview || self.constructing <= SOLVE_WITHIN);
        let options = OpenOptions { unsolved: !in_time, unchecked: true, ..order.place.options(progress) };
        let Some(session) = self.open(&document, &options)? else {
            let session = self.reopened(&document, &options)?;
            self.session = Some(session.clone());
            return Ok((session, solves.then_some(GROUND).or((constructs && !in_time).then_some(RAYS))));
        };
        let document = with_known_planes(document, &session);
        let mut memory = self.memory.of_path_sized(image);
        let mut session = session.edited(document, &options, &mut memory)?;
        session.resolved.light = self.sun.moving(order.document.light.as_ref(), *session.light());
        // What only a picture at rest warns of holds until the next one.
        if let Some(rested) = &self.session {
            let new = |warning: &Warning| !session.resolved.warnings.contains(warning);
            let old: Vec<Warning> = rested.resolved.warnings.iter().filter(|w| new(w)).cloned().collect();
            session.resolved.warnings.extend(old);
        }
        if solves {
            return match self.ground.under(&session)? {
                Some(stage) => Ok((with_ground(session, stage)?, constructs.then_some(RAYS))),
                None => Ok((session, Some(GROUND))),
            };
        }
        Ok((session, (constructs && !in_time).then_some(RAYS)))
    }

    /// The session, if it has the layers of a document, with the representations that its sections name.
    fn open(&mut self, document: &Document, options: &OpenOptions) -> Result<Option<Session>, BelvedereError> {
        let Some(session) = self.with_layers(document) else { return Ok(None) };
        // Sections name layers, too: each such name is a representation.
        let roots =
            Roots { allowed: options.allow_roots.clone(), files: options.allow_files.clone(), ..Roots::default() };
        let mut named = Scene { representations: self.named.of(document, &roots)?, ..Scene::default() };
        hidden::apply(&mut named, document);
        if named.representations == session.scene().representations {
            return Ok(Some(session));
        }
        let scene = Scene { representations: named.representations, ..session.scene().clone() };
        let loaded = Loaded { scene: Arc::new(scene), ..session.loaded.clone() };
        let session = Session { loaded, ..session };
        self.session = Some(session.clone());
        Ok(Some(session))
    }

    /// The session, if it has the layers of a document.
    fn with_layers(&mut self, document: &Document) -> Option<Session> {
        let (opened, session) = (self.opened.as_ref()?, self.session.as_ref()?);
        let is_hidden = |layer: &LayerDoc| document.hidden.iter().any(|id| id == layer.id());
        let must_see: Vec<bool> = document.layer.iter().map(|l| l.must_see() && !is_hidden(l)).collect();
        let layers = session.scene().layers.iter();
        // A file of lines and points makes several layers; then they are known by the document that was read.
        let one_each = session.scene().layers.len() == document.layer.len();
        let alike = |a: &LayerDoc, b: &LayerDoc| match one_each {
            true => a.with_must_see(b.must_see()).with_opacity(b.opacity()) == *b,
            false => a == b,
        };
        let opacities =
            document.layer.iter().map(|l| l.opacity().filter(|o| (0.0..=1.0).contains(o)).unwrap_or(1.0) as f32);
        let opacities: Vec<f32> = opacities.collect();
        let same = opened.crs == document.crs
            && opened.unit == document.unit
            && opened.text == document.text
            && opened.representations == document.representations
            && opened.hidden == document.hidden
            && (document.hidden.is_empty()
                || (opened.constructor == document.constructor && opened.animation == document.animation))
            && opened.layer.len() == document.layer.len()
            && (one_each || opened.title == document.title)
            && opened.layer.iter().zip(&document.layer).all(|(a, b)| alike(a, b));
        let is_current = !one_each
            || (session.scene().title == document.title
                && layers.clone().zip(&must_see).all(|(layer, must)| layer.must_see == *must)
                && layers.zip(&opacities).all(|(layer, opacity)| layer.kind.opacity() == *opacity));
        match (same, is_current) {
            (false, _) => None,
            (true, true) => Some(session.clone()),
            (true, false) => {
                let mut scene = Scene { title: document.title.clone(), ..session.scene().clone() };
                scene.layers.iter_mut().zip(must_see).for_each(|(layer, must)| layer.must_see = must);
                let kinds = scene.layers.iter_mut().map(|layer| &mut layer.kind);
                kinds.zip(opacities).for_each(|(kind, opacity)| kind.set_opacity(opacity));
                let loaded = Loaded { scene: Arc::new(scene), ..session.loaded.clone() };
                let session = Session { loaded, ..session.clone() };
                self.session = Some(session.clone());
                Some(session)
            }
        }
    }

    fn reopened(&mut self, document: &Document, options: &OpenOptions) -> Result<Session, BelvedereError> {
        let session = Session::from_document(SourceDocument::new(document.clone()), options)?;
        self.opened = Some(document.clone());
        (self.ground, self.memory, self.constructing) = (Ground::default(), Memory::default(), Duration::ZERO);
        Ok(session)
    }
}

/// The document with the reference planes of the last picture at rest, so that the median of the terrain is not computed for every
/// picture.
fn with_known_planes(mut document: Document, session: &Session) -> Document {
    let Some(resolved) = session.resolved().filter(|_| session.scene().terrain().is_some()) else { return document };
    for (stage, known) in document.stage.iter_mut().zip(&resolved.stage) {
        let (plane, known) = match (stage, known) {
            (StageDoc::SplineBend(stage), StageDoc::SplineBend(known)) => (&mut stage.plane, &known.plane),
            (StageDoc::Relief(stage), StageDoc::Relief(known)) => (&mut stage.plane, &known.plane),
            _ => continue,
        };
        // A plane over level ground does not depend on the camera.
        let Some(known) = known.as_ref().filter(|known| known.normal == [0.0, 0.0, 1.0]) else { continue };
        let stated = plane.get_or_insert_with(|| known.clone());
        if stated.normal == known.normal {
            stated.height_m = stated.height_m.or(known.height_m);
        }
    }
    document
}

/// The view at a share of the transition from straight to bent; straight or bent where there is no transition.
fn eased(view: &View, share: f64) -> View {
    view.eased(share).unwrap_or_else(|| if share < 0.5 { view.straightened() } else { view.clone() })
}

/// What a session shows, without what is made at rest alone.
fn shown(order: &Order, session: Session, quality: Quality, [bent, straight]: [Option<Frame>; 2]) -> Shown {
    let (document, pace) = (order.document.clone(), order.pace);
    let (overhead, displacement, waits, milliseconds) = (None, None, None, 0.0);
    Shown { document, session, bent, straight, overhead, displacement, pace, quality, waits, milliseconds }
}

/// The bent and the straight moving picture, as ordered.
///
/// * `scene`: the session's scene for pictures of this quality.
fn sides(
    session: &Session,
    scene: &Scene,
    (quality, density): (Quality, f64),
    order: &Order,
    progress: &Progress,
) -> Result<[Option<Frame>; 2], BelvedereError> {
    let (mut bent, mut straight) = (None, None);
    if order.sides != Sides::Straight {
        bent = Some(quick(session, scene, &eased(session.view(), order.bend), (quality, density), progress)?);
    }
    if order.sides != Sides::Bent {
        straight = Some(quick(session, scene, &session.view().straightened(), (quality, density), progress)?);
    }
    Ok([bent, straight])
}

/// Share of the tracked target that the session's view shows.
fn target_seen(session: &Session, progress: &Progress) -> Result<Option<f64>, BelvedereError> {
    if !session.tracks() {
        return Ok(None);
    }
    let view = session.view();
    let frame = quick(session, session.scene(), view, (Quality::FULL, 1.0), progress)?;
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let draw = |scene: &Scene, view: &View| {
        let job = RenderJob { scene, view, light: session.light(), options: &options, progress };
        Ok::<_, BelvedereError>(session.renderer(&crate::RendererName::AUTO)?.render(&job)?)
    };
    fallback::in_sight::of_session(session, (view, &frame), &draw)
}

/// Draws the camera from above, with its rays, planes and legend.
fn overhead(session: &Session, progress: &Progress) -> Result<(Frame, View), BelvedereError> {
    let quality = RenderOptions { samples: 1, ..RenderOptions::default() };
    let request = PictureOptions { quality, ..PictureOptions::default() };
    let drawn = picture::draw_camera(session, &request, CameraPicture::Overhead, progress)?;
    Ok((drawn.frame, drawn.view))
}

#[cfg(test)]
mod tests;

//! A session that follows a document: everything is resolved again, but unchanged layers are not read again.

use super::thin::{self, Thin};
use super::{Place, THREADS, camera};
use crate::fallback;
use crate::overlays::grid;
use crate::picture::{self, DisplacementReport, PictureOptions};
use crate::resolve::solving::Memory;
use crate::resolve::{hidden, representations};
use crate::scene_file::paths::Roots;
use crate::scene_file::{ConstructorKind, Document, LayerDoc, SourceDocument, StageDoc};
use crate::session::{Loaded, Resolved};
use crate::{BelvedereError, CameraPicture, OpenOptions, Session};
use belvedere_construct::measure::HiddenRun;
use belvedere_construct::{MeasureOptions, Measures};
use belvedere_core::{Stage, View};
use belvedere_scene::Instant;
use belvedere_scene::{Frame, Progress, RenderJob, RenderOptions, Scene};
use std::sync::Arc;
use std::time::Duration;

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
        /// Worst error of terrain drawn with level of detail, pixels.
        detail_px: f64,
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
const JUDGE_WITHIN: Duration = Duration::from_millis(40);
/// Longest judgement that is made between moving pictures at all, and the pause after it in multiples of its duration.
const JUDGE_AT_MOST: Duration = Duration::from_millis(250);
const JUDGE_SHARE: u32 = 6;
/// Longest solution that is made during a motion.
const SOLVE_WITHIN: Duration = Duration::from_millis(120);

/// A session that follows a document.
#[derive(Debug, Default)]
pub struct LiveSession {
    session: Option<Session>,
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
    thin: Thin,
    /// Pixels per point of the screen; `None`: 1.
    density: Option<f64>,
}

/// Displaced ground during a motion.
#[derive(Debug, Default)]
struct Ground {
    #[cfg(not(target_family = "wasm"))]
    live: Option<(crate::scene_file::TerrainStageDoc, Arc<Scene>, belvedere_disocclusion::LiveTerrain)>,
    last: Option<Stage>,
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
        let mut document = (*order.document).clone();
        camera::fit(&mut document, order.image);
        let (session, waits) = match order.pace {
            Pace::Moving { .. } => self.moving(document, order, progress)?,
            Pace::Resting => (self.resting(document, order, progress)?, None),
        };
        session.check_drawable()?;
        self.shown = Some(session.clone());
        let (mut bent, mut straight, mut displacement) = (None, None, None);
        let density = self.density.unwrap_or(1.0);
        match order.pace {
            Pace::Moving { detail_px } => {
                let scene = self.thin.scene(session.loaded.scene.clone(), density / detail_px);
                if order.sides != Sides::Straight {
                    bent = Some(quick(
                        &session,
                        &scene,
                        &eased(session.view(), order.bend),
                        [detail_px, density],
                        progress,
                    )?);
                }
                if order.sides != Sides::Bent {
                    straight =
                        Some(quick(&session, &scene, &session.view().straightened(), [detail_px, density], progress)?);
                }
            }
            Pace::Resting => {
                let mut side = |plain: bool| {
                    let request = PictureOptions { straight: plain, density, ..PictureOptions::default() };
                    let drawn = picture::draw_view(&session, &request, progress)?;
                    displacement = displacement.or(drawn.displacement);
                    Ok::<_, BelvedereError>(Some(drawn.frame))
                };
                bent = if order.sides == Sides::Straight { None } else { side(false)? };
                straight = if order.sides == Sides::Bent { None } else { side(true)? };
            }
        }
        let overhead = match order.overhead && order.pace == Pace::Resting {
            true => Some(overhead(&session, progress)?),
            false => None,
        };
        let milliseconds = began.elapsed().as_secs_f64() * 1e3;
        let document = order.document.clone();
        Ok(Shown { document, session, bent, straight, overhead, displacement, pace: order.pace, waits, milliseconds })
    }

    /// Whether there is time to judge a picture: always at rest; during a motion only in the background, and if the last judgement was
    /// short, or long enough ago.
    pub fn has_time_to_judge(&self, pace: Pace) -> bool {
        let waited = || self.judged_at.is_none_or(|at| at.elapsed() >= JUDGE_SHARE * self.judging);
        let in_time = || self.judging <= JUDGE_WITHIN || (self.judging <= JUDGE_AT_MOST && waited());
        pace == Pace::Resting || (THREADS && in_time())
    }

    /// Visibility of the required features in the view of the last picture; `None` if there are none.
    ///
    /// # Errors
    /// [`BelvedereError::Construct`], [`BelvedereError::Cancelled`].
    pub fn judge(&mut self, order: &Order, progress: &Progress) -> Result<Option<Judged>, BelvedereError> {
        let began = Instant::now();
        let judged = self.judged(order, progress);
        self.judging = began.elapsed();
        self.judged_at = Some(Instant::now());
        judged
    }

    fn judged(&self, order: &Order, progress: &Progress) -> Result<Option<Judged>, BelvedereError> {
        let Some(session) = &self.shown else { return Ok(None) };
        let scene = session.scene();
        let view = &camera::cut_to_frame(session.view(), &order.document, order.image);
        let target_seen = if order.pace == Pace::Resting { target_seen(session, progress)? } else { None };
        if target_seen.is_none() && !scene.layers.iter().any(|layer| layer.must_see) {
            return Ok(None);
        }
        let options = MeasureOptions::default();
        let measures = belvedere_construct::measure(scene, view, None, &options, progress)?;
        let hidden = belvedere_construct::measure::hidden(scene, view, &options, progress)?;
        Ok(Some(Judged { document: order.document.clone(), pace: order.pace, measures, hidden, target_seen }))
    }

    /// Resolves a document with all solvers.
    fn resting(&mut self, document: Document, order: &Order, progress: &Progress) -> Result<Session, BelvedereError> {
        let options = options(order, progress);
        let session = match self.open(&document, &options)? {
            Some(session) => {
                let (began, mut memory) = (Instant::now(), self.memory.of_path());
                let session = session.edited(document.clone(), &options, &mut memory)?;
                (self.constructing, self.memory) = (began.elapsed(), memory);
                session
            }
            None => self.reopened(&document, &options)?,
        };
        self.ground.last = session.view().stages().iter().find(|stage| stage.moves_ground()).cloned();
        self.session = Some(session.clone());
        Ok(session)
    }

    /// Resolves a document for a moving picture: slow results are left out or reused.
    fn moving(
        &mut self,
        document: Document,
        order: &Order,
        progress: &Progress,
    ) -> Result<(Session, Option<&'static str>), BelvedereError> {
        const GROUND: &str = "the ground makes way when the view rests";
        const RAYS: &str = "rays are bent when the view rests";
        let (solves, constructs) = (document.solves_terrain(), document.constructor.is_some());
        // A preview has a camera of its own, so its picture is not drawn without it.
        let is_preview = document.constructor.as_ref().is_some_and(|doc| doc.kind == ConstructorKind::PathPreview);
        let in_time = constructs && !solves && (is_preview || self.constructing <= SOLVE_WITHIN);
        let options = OpenOptions { unsolved: !in_time, ..options(order, progress) };
        let Some(session) = self.open(&document, &options)? else {
            let session = self.reopened(&document, &options)?;
            self.session = Some(session.clone());
            return Ok((session, solves.then_some(GROUND).or((constructs && !in_time).then_some(RAYS))));
        };
        let document = with_known_planes(document, &session);
        let mut memory = self.memory.of_path_sized(order.image);
        let session = session.edited(document, &options, &mut memory)?;
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
        let mut named = Scene {
            representations: representations::of(&SourceDocument::new(document.clone()), &roots)?,
            ..Scene::default()
        };
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
        let same = opened.crs == document.crs
            && opened.unit == document.unit
            && opened.representations == document.representations
            && opened.hidden == document.hidden
            && (document.hidden.is_empty()
                || (opened.constructor == document.constructor && opened.animation == document.animation))
            && opened.layer.len() == document.layer.len()
            && session.scene().layers.len() == document.layer.len()
            && opened.layer.iter().zip(&document.layer).all(|(a, b)| a.with_must_see(b.must_see()) == *b);
        let is_current = session.scene().title == document.title
            && layers.clone().zip(&must_see).all(|(layer, must)| layer.must_see == *must);
        match (same, is_current) {
            (false, _) => None,
            (true, true) => Some(session.clone()),
            (true, false) => {
                let mut scene = Scene { title: document.title.clone(), ..session.scene().clone() };
                scene.layers.iter_mut().zip(must_see).for_each(|(layer, must)| layer.must_see = must);
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

impl Ground {
    /// The newest solved ground for the view of a session without displaced ground; before the first one that of the last picture
    /// at rest.
    #[cfg(not(target_family = "wasm"))]
    fn under(&mut self, session: &Session) -> Result<Option<Stage>, BelvedereError> {
        use belvedere_disocclusion::{LiveTerrain, TerrainSolver};
        let Some(stated) = session.stated_terrain() else { return Ok(None) };
        let fits = |(doc, scene, _): &(_, Arc<Scene>, _)| *doc == stated && Arc::ptr_eq(scene, &session.loaded.scene);
        if !self.live.as_ref().is_some_and(fits) {
            let solver = TerrainSolver::new(session.terrain_settings()?)?;
            self.live =
                Some((stated, session.loaded.scene.clone(), LiveTerrain::new(solver, session.loaded.scene.clone())));
        }
        let Some((.., live)) = &mut self.live else { return Ok(None) };
        Ok(live.newest(session.view())?.map(Stage::TerrainDisocclusion).or_else(|| self.last.clone()))
    }

    /// The ground of the last picture at rest: there is no thread to solve in the background.
    #[cfg(target_family = "wasm")]
    fn under(&mut self, _: &Session) -> Result<Option<Stage>, BelvedereError> {
        Ok(self.last.clone())
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

/// The session with a stage of displaced ground in its chain.
fn with_ground(session: Session, ground: Stage) -> Result<Session, BelvedereError> {
    let (pinhole, mut stages) = (session.view().pinhole().clone(), session.view().stages().to_vec());
    let at = stages.iter().take_while(|stage| stage.rank() < ground.rank()).count();
    stages.insert(at, ground);
    let view = View::new(pinhole, stages).map_err(|e| BelvedereError::Setting(e.to_string()))?;
    Ok(Session { resolved: Resolved { view, ..session.resolved }, ..session })
}

fn options(order: &Order, progress: &Progress) -> OpenOptions {
    options_for(&order.place, progress)
}

/// Options that open a document as the application does.
pub(super) fn options_for(place: &Place, progress: &Progress) -> OpenOptions {
    let roots = &place.roots;
    let folder = Some(&roots.scene_dir).filter(|dir| !dir.as_os_str().is_empty());
    OpenOptions {
        allow_roots: folder.into_iter().chain(&roots.allowed).cloned().collect(),
        allow_files: roots.files.clone(),
        progress: progress.clone(),
        ..OpenOptions::default()
    }
}

/// The view at a share of the transition from straight to bent; straight or bent where there is no transition.
fn eased(view: &View, share: f64) -> View {
    view.eased(share).unwrap_or_else(|| if share < 0.5 { view.straightened() } else { view.clone() })
}

/// Draws with one sample per pixel, level of detail, and no marks that need further pictures.
///
/// * `scene`: the session's scene with thinner lines for the coarse picture.
pub(super) fn quick(
    session: &Session,
    scene: &Scene,
    view: &View,
    [detail_px, density]: [f64; 2],
    progress: &Progress,
) -> Result<Frame, BelvedereError> {
    let mut options = RenderOptions {
        samples: 1,
        lod_px: detail_px,
        stylisation: session.resolved.stylisation,
        ..RenderOptions::default()
    };
    let plan = if view.is_bent() { fallback::of_session(session, view)? } else { None };
    let scene = plan.as_ref().map_or(scene, |plan| plan.scene());
    let grid = grid::wanted(scene, grid::stated(&session.resolved.overlay));
    options.overlay.under.extend(grid.into_iter().map(|line| thin::line(line, density / detail_px)));
    let draw = |scene: &Scene, view: &View| {
        let job = RenderJob { scene, view, light: session.light(), options: &options, progress };
        Ok::<_, BelvedereError>(session.renderer.render(&job)?)
    };
    match &plan {
        Some(plan) => plan.draw(view, &draw),
        None => draw(scene, view),
    }
}

/// Share of the tracked target that the session's view shows.
fn target_seen(session: &Session, progress: &Progress) -> Result<Option<f64>, BelvedereError> {
    if !session.tracks() {
        return Ok(None);
    }
    let view = session.view();
    let frame = quick(session, session.scene(), view, [1.0, 1.0], progress)?;
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let draw = |scene: &Scene, view: &View| {
        let job = RenderJob { scene, view, light: session.light(), options: &options, progress };
        Ok::<_, BelvedereError>(session.renderer.render(&job)?)
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
mod tests {
    use super::*;
    use crate::scene_file::parse;
    use std::path::Path;

    fn order(text: &str, pace: Pace) -> Order {
        let document = Arc::new(parse(Path::new("s.toml"), text).expect("scene").document);
        let (place, image) = (Place::default(), [160, 90]);
        Order { document, place, image, pace, sides: Sides::Bent, bend: 1.0, overhead: false }
    }

    const MOVING: Pace = Pace::Moving { detail_px: 2.0 };

    #[test]
    fn a_preview_goes_along_its_path_while_it_is_played() {
        let text = |position: f64| {
            format!(
                "{}position_m = {position}\n",
                include_str!("../../../../scenes/canyon_preview.toml").replace("position_m = 4500.0\n", "")
            )
        };
        let mut live = LiveSession::default();
        let progress = Progress::silent();
        let rest = live.show(&order(&text(4500.0), Pace::Resting), &progress).expect("picture");
        let eye = |shown: &Shown| shown.session.view().pinhole().eye;
        let mut last = eye(&rest);
        for position in [4700.0, 4900.0] {
            let shown = live.show(&order(&text(position), MOVING), &progress).expect("picture");
            assert!(shown.session.view().is_bent() && shown.waits.is_none());
            assert!(eye(&shown).distance(last) > 10.0, "the camera stands still");
            last = eye(&shown);
        }
        // A picture at rest equals that of a session without memory.
        let settled = live.show(&order(&text(4900.0), Pace::Resting), &progress).expect("picture");
        let alone = LiveSession::default().show(&order(&text(4900.0), Pace::Resting), &progress).expect("picture");
        let color = |shown: &Shown| shown.bent.as_ref().map(|frame| frame.color.clone());
        assert!(color(&settled) == color(&alone), "what was remembered changes the picture");
    }

    #[test]
    fn a_section_that_names_another_layer_is_drawn_as_in_a_new_session() {
        let text = |section: &str| {
            format!(
                "format = 1\n[camera]\neye = [-120.0, -900.0, 330.0]\nlook_at = [0.0, -100.0, 0.0]\n\
                 [[layer]]\nid = 'town'\nkind = 'city'\nsource = 'builtin:town?seed=7&size=800'\n\
                 [[layer]]\nid = 'blocks'\nkind = 'city'\nloa = 1\nsource = 'builtin:town?seed=7&size=800'\n\
                 [[stage]]\nkind = 'spline_bend'\npresets = {{ version = 1, units = 'distance', presets = [{{ phi = 40, s = -0.5, e = 2, \
                 control = [[0, 0], [0.3, 0], [0.7, 0], [1, 0]], tags = [{{ u = 0.5, delta = 0.05 }}], \
                 sections = ['{section}', 'blocks'] }}] }}\n"
            )
        };
        let progress = Progress::silent();
        let mut live = LiveSession::default();
        let color = |shown: Shown| shown.bent.map(|frame| frame.color);
        let first = color(live.show(&order(&text("blocks"), Pace::Resting), &progress).expect("picture"));
        let edited = color(live.show(&order(&text("town"), Pace::Resting), &progress).expect("picture"));
        let alone = LiveSession::default().show(&order(&text("town"), Pace::Resting), &progress).expect("picture");
        assert!(edited == color(alone) && edited != first, "the section still shows what it showed before");
    }

    #[test]
    fn a_moving_picture_does_not_wait_for_the_ground() {
        let text = |x: f64| {
            format!(
                "format = 1\n[camera]\neye = [{x}, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\n\
                 [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=257'\n\
                 [[layer]]\nkind = 'line'\nid = 'trail'\nsource = 'builtin:massif?seed=7&size=257'\nmust_see = true\n\
                 [[stage]]\nkind = 'terrain_disocclusion'\n"
            )
        };
        let mut live = LiveSession::default();
        let progress = Progress::silent();
        let first = live.show(&order(&text(6000.0), MOVING), &progress).expect("picture");
        let second = live.show(&order(&text(6010.0), MOVING), &progress).expect("picture");
        assert!(first.waits.is_some() && second.waits.is_some(), "somebody waited for the solver");
        let rest = live.show(&order(&text(6010.0), Pace::Resting), &progress).expect("picture");
        assert!(rest.session.view().is_bent());
        let moved = live.show(&order(&text(6020.0), MOVING), &progress).expect("picture");
        assert!(moved.waits.is_none() && moved.session.view().is_bent(), "the ground that there is is left out");
    }
}

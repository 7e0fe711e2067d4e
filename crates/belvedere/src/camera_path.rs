//! Cameras of the frames of an animation.

use crate::film::{Adjustment, Following, FollowingBends, RouteLine, followed};
use crate::scene_file::{
    self, AnimationDoc, CameraDoc, Document, PointDoc, PresetsDoc, RaysStageDoc, SplitDoc, StageDoc, SweepDoc, TurnDoc,
    TurntableDoc,
};
use crate::session::Description;
use crate::{BelvedereError, Session};
use belvedere_construct::{Flight, FlightOptions};
use belvedere_core::presets::BendFrame;
use belvedere_core::{DVec2, DVec3};
use belvedere_resolve::constructor;
use belvedere_resolve::solving::Memory;
use belvedere_resolve::solving::Solving;
use belvedere_resolve::{stages, validate};
use belvedere_scene::{LayerKind, Progress, Scene};
use glam::DQuat;
use serde::Deserialize;
use std::path::Path;

/// Frames per second unless stated.
const FPS: f64 = 25.0;
/// Number of frames if neither the animation nor its motion gives one.
const FRAMES: u32 = 250;

/// The camera of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pose {
    eye: DVec3,
    look_at: DVec3,
    up: DVec3,
    fov_y_deg: f64,
    /// Turn of the whole view about the vertical through the pivot, radians.
    turn: f64,
}

/// The cameras of all frames of an animation.
#[derive(Debug, Clone)]
pub(crate) struct CameraPath {
    /// The resolved scene of the session.
    base: Document,
    poses: Vec<Pose>,
    /// Position on the path of a preview in every frame; empty if there is none.
    positions: Vec<f64>,
    /// Point that the camera turns about; `None` where bends move with the camera.
    pivot: Option<DVec3>,
    /// The walker, along a route.
    pub(crate) following: Option<Following>,
    /// Frames per second.
    pub(crate) fps: f64,
    /// The animation with every default filled in.
    pub(crate) animation: AnimationDoc,
}

/// The scene's own animation, replaced in part or whole by the one given.
fn merged(scene: &Document, given: &AnimationDoc) -> AnimationDoc {
    let mut doc = scene.animation.clone().unwrap_or_default();
    if given.along.is_some() || given.camera.is_some() || given.sweep.is_some() || given.turntable.is_some() {
        let (sweep, turntable) = (doc.sweep.take(), doc.turntable.take());
        (doc.along, doc.camera) = (given.along.clone(), given.camera.clone());
        // A sweep or turn without numbers stands for the scene's own, else for the default.
        doc.sweep = given.sweep.clone().map(|s| if s.phi_deg[0] != s.phi_deg[1] { s } else { sweep.unwrap_or(s) });
        doc.turntable = given.turntable.clone().map(|t| if t.deg_per_s != 0.0 { t } else { turntable.unwrap_or(t) });
    }
    doc.fps = given.fps.or(doc.fps);
    doc.follow = given.follow.clone().or(doc.follow);
    // A stated number of frames takes the place of the scene's speed, and a stated speed that of its number of frames.
    (doc.frames, doc.speed_mps) = match (given.frames, given.speed_mps) {
        (None, None) => (doc.frames, doc.speed_mps),
        stated => stated,
    };
    doc.start_m = given.start_m.or(doc.start_m);
    doc.behind_m = given.behind_m.or(doc.behind_m);
    doc.above_m = given.above_m.or(doc.above_m);
    doc.ahead_m = given.ahead_m.or(doc.ahead_m);
    doc.marker = given.marker.or(doc.marker);
    doc.clock = given.clock.or(doc.clock);
    doc.profile = given.profile.or(doc.profile);
    doc
}

impl Pose {
    /// A camera whose place a walker decides.
    fn of_walker(fov_y_deg: f64) -> Self {
        Self { eye: DVec3::ZERO, look_at: DVec3::ZERO, up: DVec3::Z, fov_y_deg, turn: 0.0 }
    }
}

impl Session {
    /// The session at a time of its scene's own `[animation]`, seconds from the start: in the frame nearest to it.
    ///
    /// Terrain disocclusion is solved for that frame alone; in a film the frames before it count as well.
    ///
    /// # Errors
    /// [`BelvedereError::NoAnimation`] without an `[animation]`, [`BelvedereError::Frame`] if there is no such view.
    pub fn frame_at(&self, time_s: f64) -> Result<Self, BelvedereError> {
        let path = CameraPath::new(self, &AnimationDoc::default())?;
        let frame = ((time_s * path.fps).round().max(0.0) as usize).min(path.len() - 1);
        let (mut memory, progress) = (Memory::default(), Progress::silent());
        let time_step_s = Some(1.0 / path.fps);
        path.session(self, frame, Some(&mut Solving { memory: &mut memory, time_step_s, progress: &progress }))
    }
}

/// Fills in the ranges of a sweep or turntable without numbers.
fn defaults(scene: &Document, animation: &mut AnimationDoc) -> Result<(), BelvedereError> {
    if let Some(SweepDoc { phi_deg: [first, last, step] }) = &mut animation.sweep {
        if *first == 0.0 && *last == 0.0 {
            [*first, *last] = preset_range(scene).ok_or(BelvedereError::NoSweepRange)?;
        }
        if *step == 0.0 {
            *step = (*last - *first).abs() / f64::from(animation.frames.unwrap_or(FRAMES).max(2) - 1);
        }
    }
    if let Some(TurntableDoc { deg_per_s }) = &mut animation.turntable
        && *deg_per_s == 0.0
    {
        *deg_per_s = 360.0 * animation.fps.unwrap_or(FPS) / f64::from(animation.frames.unwrap_or(FRAMES));
    }
    Ok(())
}

/// Range of viewing angles over which the picture of a document changes, degrees: that of its presets; up to straight down if it follows
/// the camera; 0 to 90 if it is fixed to the world.
fn preset_range(document: &Document) -> Option<[f64; 2]> {
    let spline = document.stage.iter().find_map(|s| match s {
        StageDoc::SplineBend(spline) => Some(spline),
        _ => None,
    })?;
    let PresetsDoc::Inline(presets) = &spline.presets else { return None };
    if presets.frame == BendFrame::Plane && presets.presets.len() == 1 {
        return Some([0.0, 90.0]);
    }
    let low = presets.presets.iter().map(|p| p.phi - p.tau).fold(90.0, f64::min);
    let high = presets.presets.iter().map(|p| p.phi + p.tau).fold(0.0, f64::max);
    let follows = presets.follow && presets.frame == BendFrame::Camera;
    let high = if follows { 90.0 } else { high };
    (low < high).then(|| [low.max(0.0), high.min(90.0)])
}

impl CameraPath {
    /// The path of the session's own animation, replaced in part or whole by `given`.
    ///
    /// # Errors
    /// [`BelvedereError::NoAnimation`], [`BelvedereError::NoSweepRange`], [`BelvedereError::Animation`].
    pub(crate) fn new(session: &Session, given: &AnimationDoc) -> Result<Self, BelvedereError> {
        let Some(Description { resolved: scene, roots, .. }) = &session.resolved.description else {
            return Err(BelvedereError::NoAnimation);
        };
        let mut animation = merged(scene, given);
        let fps = *animation.fps.get_or_insert(FPS);
        let moves_camera = animation.along.is_some()
            || animation.camera.is_some()
            || animation.sweep.is_some()
            || animation.turntable.is_some();
        let Some(Description { source, .. }) = &session.resolved.description else {
            return Err(BelvedereError::NoAnimation);
        };
        let image = session.view().pinhole().image;
        let preview_m = constructor::path_length(source, roots, session.scene(), image)?;
        let probe_frames = constructor::frames_of_probe(source, fps).filter(|_| session.loaded.motions.is_none());
        if !moves_camera && session.loaded.motions.is_none() && preview_m.is_none() && probe_frames.is_none() {
            return Err(BelvedereError::NoAnimation);
        }
        defaults(scene, &mut animation)?;
        validate::animation(&animation, !moves_camera)
            .map_err(|(_, reason)| BelvedereError::Animation(format!("animation: {reason}")))?;
        let start_m = scene.constructor.as_ref().and_then(|c| c.position_m).unwrap_or(0.0);
        let positions = match preview_m {
            Some(length) => walk(length, start_m, &mut animation).map_err(BelvedereError::Animation)?,
            None => Vec::new(),
        };
        let mut following = None;
        let (poses, pivot) = if let Some(layer) = animation.along.clone() {
            let walker = following.insert(along(session, scene, &layer, &mut animation)?);
            (vec![Pose::of_walker(scene.camera.fov_y_deg); walker.walked.len()], None)
        } else if let Some(file) = animation.camera.clone() {
            (through_cameras(scene, &roots.resolve(&file)?, &mut animation)?, Some(DVec3::ZERO))
        } else if !moves_camera {
            (resting(session, scene, probe_frames, &mut animation)?, Some(DVec3::ZERO))
        } else {
            let pivot = pivot(session, scene)?;
            let poses = match animation.sweep.clone() {
                Some(sweep) => sweep_phi(session, scene, pivot, sweep, &mut animation)?,
                None => turntable(session, scene, pivot, &mut animation)?,
            };
            (poses, Some(pivot))
        };
        let poses = follow(session, &animation, fps, poses)?;
        Ok(Self { base: scene.clone(), poses, positions, pivot, following, fps, animation })
    }

    /// Number of frames.
    pub(crate) fn len(&self) -> usize {
        self.poses.len()
    }

    /// Whether the scene has stages, which bend its pictures.
    pub(crate) fn has_stages(&self) -> bool {
        !self.base.stage.is_empty()
    }

    /// Whether the constructor of a path preview places the camera.
    pub(crate) fn is_previewed(&self) -> bool {
        !self.positions.is_empty()
    }

    /// The session in a frame.
    ///
    /// # Errors
    /// [`BelvedereError::Frame`] if its camera or stages are impossible; cancellation as it is.
    pub(crate) fn session(
        &self,
        session: &Session,
        frame: usize,
        solving: Option<&mut Solving<'_>>,
    ) -> Result<Session, BelvedereError> {
        let session = session.at_time(frame as f64 / self.fps);
        let resolved = session.with_document(self.document(frame), solving);
        resolved.and_then(|session| session.check_drawable().map(|()| session)).map_err(|e| match e.is_cancelled() {
            true => e,
            false => BelvedereError::Frame { frame, source: Box::new(e) },
        })
    }

    /// The session in a frame without what has to be solved, in a picture of another size, wherever its eye lies.
    ///
    /// # Errors
    /// Those of the stages.
    pub(crate) fn sketch(&self, session: &Session, frame: usize, image: [u32; 2]) -> Result<Session, BelvedereError> {
        let mut document = self.document(frame);
        document.camera.image = image;
        session.at_time(frame as f64 / self.fps).with_document(document, None)
    }

    /// The resolved scene of a frame.
    fn document(&self, frame: usize) -> Document {
        let mut pose = self.poses[frame];
        let mut document = self.base.clone();
        if let Some(following) = &self.following {
            let camera = following.camera(frame);
            (pose.eye, pose.look_at) = (camera.eye, camera.look_at);
            following.bends.apply(&mut document.stage, &camera, following.adjustments[frame].share);
        }
        document.camera = CameraDoc {
            eye: PointDoc::Scene(pose.eye.to_array()),
            look_at: Some(PointDoc::Scene(pose.look_at.to_array())),
            heading_deg: None,
            pitch_deg: None,
            up: pose.up.to_array(),
            fov_y_deg: pose.fov_y_deg,
            ..document.camera
        };
        if let (Some(constructor), Some(position)) = (&mut document.constructor, self.positions.get(frame)) {
            constructor.position_m = Some(*position);
        }
        for stage in &mut document.stage {
            if let (StageDoc::CurvedRays(rays), Some(pivot)) = (stage, self.pivot)
                && pose.turn != 0.0
            {
                turn_rays(rays, pivot, DQuat::from_rotation_z(pose.turn));
            }
        }
        document
    }
}

fn along(
    session: &Session,
    scene: &Document,
    id: &str,
    animation: &mut AnimationDoc,
) -> Result<Following, BelvedereError> {
    let fail = |reason: String| BelvedereError::Animation(format!("along \"{id}\": {reason}"));
    let route = RouteLine::new(&route(session.scene(), id)?);
    let terrain = session.scene().terrain();
    let usual = FlightOptions::for_length(route.length());
    let usual = terrain.map_or(usual, |t| {
        let size = t.spacing() * DVec2::new((t.cols() - 1) as f64, (t.rows() - 1) as f64);
        usual.over_cells(t.spacing().max_element(), size.min_element())
    });
    let stated_target = animation.ahead_m.is_some();
    let options = FlightOptions {
        behind_m: *animation.behind_m.get_or_insert(usual.behind_m),
        above_m: *animation.above_m.get_or_insert(usual.above_m),
        ahead_m: *animation.ahead_m.get_or_insert(usual.ahead_m),
    };
    let flight = Flight::along(&route.plan(), terrain, &options).map_err(|e| fail(e.to_string()))?;
    let walked = walk(flight.length_m(), 0.0, animation).map_err(fail)?;
    let upright = (0.5 * scene.camera.fov_y_deg.to_radians()).tan();
    let [width, height] = session.view().pinhole().image.map(f64::from);
    let half = [upright * width / height, upright];
    let on_ground = |p: DVec3| p.with_z(terrain.and_then(|t| t.surface_at(p.truncate())).unwrap_or(p.z));
    let walkers = walked.iter().filter_map(|&s| route.at(s).map(on_ground)).collect();
    let adjustments = vec![Adjustment::NONE; walked.len()];
    let bends = FollowingBends::of(session.view(), scene);
    Ok(Following { route, flight, walked, walkers, stated_target, half, bends, adjustments })
}

/// Positions on a route of a given length, one per frame, evenly spaced by the speed or by the number of frames.
///
/// * `usual_start`: start of the motion if the animation gives none.
fn walk(length: f64, usual_start: f64, animation: &mut AnimationDoc) -> Result<Vec<f64>, String> {
    let start = *animation.start_m.get_or_insert(usual_start);
    let left = length - start;
    if !(left > 0.0) {
        return Err(format!("start_m is {start}, the route is {length:.1} long; begin earlier"));
    }
    let fps = animation.fps.unwrap_or(FPS);
    let per_frame = match animation.speed_mps {
        Some(speed) => speed / fps,
        None => left / f64::from(animation.frames.unwrap_or(FRAMES).max(2) - 1),
    };
    let possible = (left / per_frame * (1.0 + 1e-12)).floor() as u32 + 1;
    let frames = match (animation.frames, animation.speed_mps) {
        (Some(n), Some(speed)) if n > possible => {
            return Err(format!(
                "{n} frames at {speed} metres per second need more than the {left:.1} left of the route; give at most {possible}"
            ));
        }
        (Some(n), _) => n,
        (None, _) => possible,
    };
    animation.frames = Some(checked(frames).map_err(|e| e.to_string())?);
    animation.speed_mps = Some(per_frame * fps);
    Ok((0..frames).map(|i| start + f64::from(i) * per_frame).collect())
}

/// A camera at rest until all layers have come to rest.
///
/// * `frames`: number of frames instead, if given.
fn resting(
    session: &Session,
    scene: &Document,
    frames: Option<f64>,
    animation: &mut AnimationDoc,
) -> Result<Vec<Pose>, BelvedereError> {
    let until_rest = || session.loaded.motions.as_ref().map_or(0.0, |m| m.end()) * animation.fps.unwrap_or(FPS);
    let lasts = frames.unwrap_or_else(until_rest);
    let frames = *animation.frames.get_or_insert(checked(lasts.floor().min(1e9) as u32 + 1)?);
    let pinhole = session.view().pinhole();
    let fov_y_deg = scene.camera.fov_y_deg;
    let pose = Pose { eye: pinhole.eye, look_at: look_at(session, scene), up: -pinhole.down, fov_y_deg, turn: 0.0 };
    Ok(vec![pose; frames as usize])
}

/// The cameras, moved with the layer that is followed, if there is one.
fn follow(
    session: &Session,
    animation: &AnimationDoc,
    fps: f64,
    mut poses: Vec<Pose>,
) -> Result<Vec<Pose>, BelvedereError> {
    let Some(layer) = &animation.follow else { return Ok(poses) };
    let motions = session.loaded.motions.as_deref().filter(|_| animation.along.is_none());
    let steps = followed::steps(motions, layer, poses.len(), fps)
        .map_err(|reason| BelvedereError::Animation(format!("animation: follow: {reason}")))?;
    for (pose, by) in poses.iter_mut().zip(steps) {
        (pose.eye, pose.look_at) = (pose.eye + by, pose.look_at + by);
    }
    Ok(poses)
}

/// The point that the camera of the scene looks at.
fn look_at(session: &Session, scene: &Document) -> DVec3 {
    let pinhole = session.view().pinhole();
    match scene.camera.look_at {
        Some(PointDoc::Scene(p)) => DVec3::from_array(p),
        _ => pinhole.eye + 100.0 * pinhole.forward,
    }
}

fn checked(frames: u32) -> Result<u32, BelvedereError> {
    let most = validate::MAX_FRAMES;
    if frames <= most {
        return Ok(frames);
    }
    Err(BelvedereError::Animation(format!(
        "the animation would have {frames} frames, at most {most} are drawn; make it faster or shorter"
    )))
}

/// The longest line of a layer, joined with other lines that continue it.
fn route(scene: &Scene, id: &str) -> Result<Vec<DVec3>, BelvedereError> {
    let lines = |kind: &LayerKind| kind.lines().is_some();
    let known: Vec<&str> = scene.layers.iter().filter(|l| lines(&l.kind)).map(|l| l.id.as_str()).collect();
    let layer = scene.layers.iter().find(|l| l.id == id);
    let Some(layer) = layer.and_then(|layer| layer.kind.lines()) else {
        let hint = if known.is_empty() { "the scene has none".to_owned() } else { scene_file::suggestion(id, &known) };
        return Err(BelvedereError::Animation(format!("along: \"{id}\" is no line layer of the scene; {hint}")));
    };
    let gap = scene.terrain().map_or(1.0, |t| 20.0 * t.spacing().max_element());
    Ok(layer.longest_chain(gap))
}

/// One camera of a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedCamera {
    eye: [f64; 3],
    look_at: [f64; 3],
    #[serde(default = "z_up")]
    up: [f64; 3],
    fov_y_deg: Option<f64>,
}

fn z_up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// Eye, look_at, up and field of view of a saved camera, as one vector of numbers.
type Numbers = [f64; 10];

/// Reads the cameras of the animation that a scene states, if it names any.
///
/// # Errors
/// [`BelvedereError`] if the file is not there, or holds none.
pub(crate) fn check(session: &Session) -> Result<(), BelvedereError> {
    let Some(Description { source, resolved, roots }) = &session.resolved.description else { return Ok(()) };
    let Some(animation) = &resolved.animation else { return Ok(()) };
    let Some(file) = &animation.camera else { return Ok(()) };
    let path = roots.resolve(file).map_err(|e| source.origin.refusal(&["animation", "camera"], "animation: ", e))?;
    through_cameras(resolved, &path, &mut animation.clone()).map(|_| ())
}

fn through_cameras(scene: &Document, path: &Path, animation: &mut AnimationDoc) -> Result<Vec<Pose>, BelvedereError> {
    let fail = |reason: String| BelvedereError::Points { path: path.to_owned(), reason };
    let tree = scene_file::json_points(&scene_file::read_text(path)?.0).map_err(|e| fail(e.to_string()))?;
    let saved: Vec<SavedCamera> = scene_file::decode(&tree).map_err(|e| fail(e.to_string()))?;
    if saved.is_empty() {
        return Err(fail("holds no camera; give a list of { eye, look_at }".into()));
    }
    let own = scene.camera.fov_y_deg;
    let keys: Vec<Numbers> = saved
        .iter()
        .map(|c| {
            let numbers = c.eye.into_iter().chain(c.look_at).chain(c.up).chain([c.fov_y_deg.unwrap_or(own)]);
            let mut out = [0.0; 10];
            out.iter_mut().zip(numbers).for_each(|(o, v)| *o = v);
            out
        })
        .collect();
    let frames = *animation.frames.get_or_insert(checked(keys.len() as u32)?);
    let span = (keys.len() - 1) as f64;
    let pose = |i: u32| {
        let k = at(&keys, span * f64::from(i) / f64::from(frames.max(2) - 1));
        let point = |j: usize| DVec3::new(k[j], k[j + 1], k[j + 2]);
        Pose { eye: point(0), look_at: point(3), up: point(6), fov_y_deg: k[9], turn: 0.0 }
    };
    Ok((0..frames).map(pose).collect())
}

/// Catmull-Rom spline through the keys: C1, and equal to each key at whole numbers.
fn at(keys: &[Numbers], t: f64) -> Numbers {
    let i = (t.floor() as usize).min(keys.len() - 1);
    let f = t - i as f64;
    if f <= 0.0 {
        return keys[i];
    }
    let key = |j: isize| &keys[j.clamp(0, keys.len() as isize - 1) as usize];
    let i = i as isize;
    let [a, p, q, b] = [key(i - 1), key(i), key(i + 1), key(i + 2)];
    let (f2, f3) = (f * f, f * f * f);
    std::array::from_fn(|k| {
        let (dp, dq) = (0.5 * (q[k] - a[k]), 0.5 * (b[k] - p[k]));
        (2.0 * f3 - 3.0 * f2 + 1.0) * p[k] + (f3 - 2.0 * f2 + f) * dp + (3.0 * f2 - 2.0 * f3) * q[k] + (f3 - f2) * dq
    })
}

/// The point about which the camera turns: the pivot of a spline, else the point looked at.
fn pivot(session: &Session, scene: &Document) -> Result<DVec3, BelvedereError> {
    let of_spline = session.view().spline_bend().map(|bend| bend.pivot());
    let looked_at = match scene.camera.look_at {
        Some(PointDoc::Scene(p)) => Some(DVec3::from_array(p)),
        _ => None,
    };
    of_spline.or(looked_at).ok_or_else(|| {
        BelvedereError::Animation("nothing says what the camera turns about: give the scene's camera a look_at".into())
    })
}

fn sweep_phi(
    session: &Session,
    scene: &Document,
    pivot: DVec3,
    sweep: SweepDoc,
    animation: &mut AnimationDoc,
) -> Result<Vec<Pose>, BelvedereError> {
    let [first, last, step] = sweep.phi_deg;
    let needed = ((last - first).abs() / step * (1.0 + 1e-12)).floor() + 1.0;
    let frames = *animation.frames.get_or_insert(checked(needed.min(1e9) as u32)?);
    let step = if frames > 1 { (last - first) / f64::from(frames - 1) } else { 0.0 };
    // The scene's own step unless the number of frames says otherwise.
    let step = if f64::from(frames) == needed { sweep.phi_deg[2].copysign(last - first) } else { step };
    let pinhole = session.view().pinhole();
    let normal = stages::plane_normal(scene).and_then(DVec3::try_normalize).unwrap_or(DVec3::Z);
    let level = |v: DVec3| (v - v.dot(normal) * normal).try_normalize();
    // For a camera straight down, the picture's upward direction counts as ahead.
    let ahead = level(pinhole.forward).filter(|_| pinhole.forward.dot(normal).abs() < 0.999_999);
    let ahead = ahead.or_else(|| level(-pinhole.down)).unwrap_or(DVec3::Y);
    let distance = pinhole.eye.distance(pivot);
    if !(distance > 0.0) {
        return Err(BelvedereError::Animation("the eye is the pivot itself; move it away".into()));
    }
    let fov_y_deg = scene.camera.fov_y_deg;
    let pose = |i: u32| {
        let (sin, cos) = (first + f64::from(i) * step).clamp(0.0, 90.0).to_radians().sin_cos();
        let (eye, up) = (pivot + distance * (sin * normal - cos * ahead), sin * ahead + cos * normal);
        Pose { eye, look_at: pivot, up, fov_y_deg, turn: 0.0 }
    };
    Ok((0..frames).map(pose).collect())
}

fn turntable(
    session: &Session,
    scene: &Document,
    pivot: DVec3,
    animation: &mut AnimationDoc,
) -> Result<Vec<Pose>, BelvedereError> {
    let rate = animation.turntable.as_ref().map_or(0.0, |t| t.deg_per_s);
    let fps = animation.fps.unwrap_or(FPS);
    let once = (360.0 / rate.abs() * fps).round().clamp(1.0, 1e9) as u32;
    let frames = checked(animation.frames.unwrap_or(once))?;
    animation.frames = Some(frames);
    let (camera, pinhole) = (&scene.camera, session.view().pinhole());
    let ahead = pinhole.eye + pinhole.eye.distance(pivot).max(1.0) * pinhole.forward;
    let pose = |i: u32| {
        let turn = (rate * f64::from(i) / fps).to_radians();
        let rotation = DQuat::from_rotation_z(turn);
        let [eye, look_at] = [pinhole.eye, ahead].map(|p| pivot + rotation * (p - pivot));
        Pose { eye, look_at, up: rotation * DVec3::from_array(camera.up), fov_y_deg: camera.fov_y_deg, turn }
    };
    Ok((0..frames).map(pose).collect())
}

/// Curved rays turn with the camera.
fn turn_rays(rays: &mut RaysStageDoc, pivot: DVec3, turn: DQuat) {
    let position = |p: &mut [f64; 3]| *p = (pivot + turn * (DVec3::from_array(*p) - pivot)).to_array();
    let direction = |v: &mut [f64; 3]| *v = (turn * DVec3::from_array(*v)).to_array();
    let mut ways: Vec<&mut [TurnDoc]> = vec![&mut rays.turn];
    let mut splits: Vec<&mut SplitDoc> = rays.split.iter_mut().collect();
    while let Some(split) = splits.pop() {
        split.merge.iter_mut().for_each(|merge| position(&mut merge.viewpoint));
        for way in [&mut split.left, &mut split.right] {
            ways.push(&mut way.turn);
            splits.extend(way.split.as_deref_mut());
        }
    }
    for t in ways.into_iter().flatten() {
        [&mut t.viewpoint, &mut t.t0, &mut t.t1, &mut t.t2].into_iter().for_each(&position);
        if let Some(line) = &mut t.line {
            position(&mut line.point);
            direction(&mut line.dir);
        }
        t.normal.iter_mut().for_each(direction);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_frames_as_the_limit_are_drawn_and_no_more() {
        let most = validate::MAX_FRAMES;
        assert_eq!(checked(most).expect("at the limit"), most);
        let error = checked(most + 1).expect_err("beyond it").to_string();
        assert!(error.contains(&(most + 1).to_string()) && error.contains(&most.to_string()), "{error}");
    }

    #[test]
    fn a_path_passes_its_keys_and_rests_on_a_single_one() {
        let key = |x: f64| {
            let mut numbers = [0.0; 10];
            numbers[0] = x;
            numbers
        };
        let keys = [key(0.0), key(10.0), key(-5.0)];
        for (i, key) in keys.iter().enumerate() {
            assert_eq!(at(&keys, i as f64), *key);
        }
        assert_eq!(at(&keys[..1], 0.0), keys[0]);
        let between = at(&keys, 0.5)[0];
        assert!((0.0..10.0).contains(&between), "{between}");
    }
}

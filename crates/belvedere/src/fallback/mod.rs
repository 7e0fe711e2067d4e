//! Fallbacks for targets that no bend shows: occluders are drawn transparent, cut away, or moved apart.
//!
//! Ours, beside the papers: the three usual techniques in their simplest exact form. All are composed of whole pictures of changed
//! scenes, so every renderer draws the same: a transparent group is the picture blended with the one without it; a cone through the
//! eye has no visible walls, so a cutaway is the picture without the occluders, within the cone.

mod explode;
pub(crate) mod in_sight;
mod occluders;
mod region;
#[cfg(test)]
mod tests;

use crate::scene_file::{ConstructorDoc, ConstructorKind, Fallback, FallbackKind, SourceDocument};
use crate::{BelvedereError, Session};
use belvedere_composite::canvas::Canvas;
use belvedere_construct::rays::{Target, TargetSight};
use belvedere_core::{DVec2, DVec3, Pinhole, View, Warning, WarningKind};
use belvedere_overlay::highlight::border;
use belvedere_resolve::targets;
use belvedere_scene::{Color, Frame, LayerKind, Scene};
use belvedere_sight::refusal;
use in_sight::Judge;
use occluders::{Extent, Part};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// Opacity of transparent parts.
const OPACITY: f32 = 0.3;
/// Margin around the target that is cut open, or kept free of moved parts, pixels of a picture 720 high.
const MARGIN_PX: f64 = 10.0;
/// Visible share from which on a target needs no fallback.
const ENOUGH: f64 = 0.99;
/// Places that a picture hides, by which parts are found that hide them, at most.
const HIDDEN_PLACES: usize = 100;
/// A target, or an opening, of fewer pixels than this is easily missed.
const LEAST_PX: usize = 100;
/// Relative difference below which depths in two pictures count as the same.
const SAME_DEPTH: f64 = 2e-4;
const EDGE: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(60, 60, 60)];

/// Report of a fallback.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct FallbackRecord {
    /// Name of the target.
    pub target: String,
    /// Visible share before, 0..=1: of the pixels that the target fills where it is drawn alone, those that show it. For points
    /// and lines the share with a free line of sight.
    pub visible_before: f64,
    /// Visible share in the drawn picture, 0..=1.
    pub visible: f64,
    /// Pixels that the target fills where it is drawn alone; left out for points and lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixels_alone: Option<usize>,
    /// Pixels in which a cutaway shows something else than the picture without it; left out where nothing is cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixels_opened: Option<usize>,
    /// Changes by layer.
    pub changed: Vec<FallbackChange>,
}

/// Change of one layer.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct FallbackChange {
    /// Id of the layer.
    pub layer: String,
    /// Kind of the change.
    pub kind: FallbackKind,
    /// Number of changed parts: boxes, named parts of a mesh, or 1 for the whole layer.
    pub parts: usize,
    /// Parts that hide the target but stay unchanged, since no direction leads out of its image.
    pub stuck: usize,
    /// Opacity of transparent parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opacity: Option<f32>,
    /// Margin around the target, pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_px: Option<f64>,
    /// Largest displacement of a part, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved_by: Option<f64>,
}

impl fmt::Display for FallbackRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = |c: &FallbackChange| {
            let kind = match (c.kind, c.moved_by) {
                (FallbackKind::Transparency, _) => "drawn transparent".into(),
                (FallbackKind::Cutaway, _) => "cut away".into(),
                (FallbackKind::Explosion, by) => format!("moved aside by up to {:.1}", by.unwrap_or(0.0)),
            };
            let parts = if c.parts == 1 { "1 part".into() } else { format!("{} parts", c.parts) };
            let stuck = if c.stuck > 0 { format!(", {} cannot", c.stuck) } else { String::new() };
            format!("{} ({parts} {kind}{stuck})", c.layer)
        };
        let what: Vec<String> = self.changed.iter().map(of).collect();
        let what = if what.is_empty() { "nothing had to give way".into() } else { what.join(", ") };
        // Less than everything is not 100 %.
        let percent = |share: f64| (100.0 * share).round().min(if share < 1.0 { 99.0 } else { 100.0 });
        write!(f, "fallback for {}: {what}; ", self.target)?;
        write!(f, "visible before {} %, ", percent(self.visible_before))?;
        // A share of 100 % is no help through an opening that nobody notices.
        if let (None, Some(pixels @ ..LEAST_PX)) = (self.pixels_alone, self.pixels_opened) {
            return write!(f, "now through an opening of {pixels} pixels, which is easily missed");
        }
        write!(f, "now {} %", percent(self.visible))?;
        match (self.pixels_alone, self.pixels_opened) {
            (Some(pixels), _) => write!(f, " of the {pixels} pixels that it fills"),
            (None, Some(pixels)) => write!(f, ", through an opening of {pixels} pixels"),
            (None, None) => Ok(()),
        }
    }
}

impl FallbackRecord {
    /// Warning about a target, or an opening onto a point or line, that is too small to be noticed.
    pub fn warning(&self) -> Option<Warning> {
        let (what, pixels) = match (self.pixels_alone, self.pixels_opened) {
            (Some(pixels), _) => ("the target fills", pixels),
            (None, Some(pixels)) => ("the cutaway opens", pixels),
            (None, None) => return None,
        };
        (pixels < LEAST_PX).then(|| {
            let remedy = "look from nearer, with a narrower field of view, or draw a larger picture";
            let text =
                format!("{}: {what} {pixels} pixels, fewer than {LEAST_PX} are easily missed; {remedy}", self.target);
            let warning = Warning::new(WarningKind::Hidden, text).about(self.target.clone());
            warning.with("pixels", pixels as f64).with("limit_pixels", LEAST_PX as f64)
        })
    }
}

/// A scene prepared to show a target by fallbacks.
pub struct FallbackPlan {
    /// The scene with parts moved.
    scene: Scene,
    target: Target,
    transparent: Vec<Part>,
    cut: Vec<Part>,
    moves: Vec<(Part, DVec3)>,
    margin_px: f64,
    /// Report of the changes.
    pub record: FallbackRecord,
}

/// Draws a scene in a view, with fixed quality and light.
pub(crate) type Draw<'a> = dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError> + 'a;

/// The plan that a session's document asks for in `view`; `None` if it asks for none, or if the view shows the target anyway.
///
/// * `draw`: draws the pictures by which the target is judged; without it lines of sight judge it, which is faster while something moves.
pub(crate) fn of_session(
    session: &Session,
    view: &View,
    draw: Option<&Draw<'_>>,
) -> Result<Option<FallbackPlan>, BelvedereError> {
    let Some((source, doc)) = asked(session) else { return Ok(None) };
    let rules: Result<Vec<Fallback>, String> = doc.fallback.iter().map(|rule| rule.parse()).collect();
    let rules = rules.map_err(|reason| source.error(&["constructor", "fallback"], format!("constructor: {reason}")))?;
    let (scene, name) = (session.scene(), doc.target.as_deref().unwrap_or_default());
    let mut target = targets::target(scene, name)
        .map_err(|e| source.error(&["constructor", "target"], format!("constructor: {e}")))?;
    let judge = match draw.filter(|_| !has_volumes(scene)) {
        Some(draw) => {
            Judge::of_target(scene, &target).map(|judge| judge.mask((scene, None), view, draw)).transpose()?
        }
        None => None,
    };
    let always = doc.kind == ConstructorKind::Manual;
    if let Some(mask) = &judge {
        if !always && mask.share() >= ENOUGH {
            return Ok(None);
        }
        // What hides places between the points that stand for the target is found, too.
        target = target.with_points(&mask.hidden(view, HIDDEN_PLACES));
    }
    let plan = plan(scene, view, (name, &target), &rules)?;
    Ok(Some(plan).filter(|p| always || judge.is_some() || p.record.visible_before < ENOUGH))
}

/// Whether a session's document asks for a fallback.
pub(crate) fn is_asked(session: &Session) -> bool {
    asked(session).is_some()
}

fn asked(session: &Session) -> Option<(&SourceDocument, &ConstructorDoc)> {
    let source = session.resolved.description.as_ref().map(|d| &d.source)?;
    Some((source, source.document.constructor.as_ref().filter(|doc| !doc.fallback.is_empty())?))
}

/// Whether volumes let light through, which ids and depths of pictures do not tell.
pub(crate) fn has_volumes(scene: &Scene) -> bool {
    scene.layers.iter().any(|layer| layer.kind.volume().is_some())
}

/// Plans the fallbacks in `view` that show a target.
/// * `target`: its name for the report, and the target.
///
/// # Errors
/// [`BelvedereError::Target`] for a rule of a layer that does not exist or cannot do it, and for rigid layers behind a bend.
pub fn plan(
    scene: &Scene,
    view: &View,
    (name, target): (&str, &Target),
    rules: &[Fallback],
) -> Result<FallbackPlan, BelvedereError> {
    if let Some(reason) = refusal("a fallback", scene, view) {
        return Err(BelvedereError::Target(format!("fallback: {reason}")));
    }
    let height = f64::from(view.pinhole().image[1]);
    let margin_px = MARGIN_PX * (height / 720.0).max(0.4);
    let before = TargetSight::new(scene, target).share(view, 0.0);
    let ids: Vec<&str> = scene.layers.iter().map(|l| l.id.as_str()).collect();
    for rule in rules {
        let Some(id) = &rule.layer else { continue };
        let Some(layer) = scene.layers.iter().find(|l| l.id == *id) else {
            let near = crate::scene_file::suggestion(id, &ids);
            return Err(BelvedereError::Target(format!("fallback: \"{id}\" is no layer of the scene; {near}")));
        };
        possible(&layer.kind, rule.kind)
            .map_err(|reason| BelvedereError::Target(format!("fallback: layer \"{id}\": {reason}")))?;
    }
    let own = |index: usize| rules.iter().find(|r| r.layer.as_deref() == Some(ids[index]));
    let rule = |index: usize| {
        let all = || rules.iter().find(|r| r.layer.is_none() && possible(&scene.layers[index].kind, r.kind).is_ok());
        own(index).or_else(all)
    };
    let concerned: Vec<usize> = (0..ids.len()).filter(|i| rule(*i).is_some()).collect();
    let extent = Extent::of(view, &target.points);
    let (mut transparent, mut cut, mut moves) = (Vec::new(), Vec::new(), Vec::new());
    let mut changed: Vec<FallbackChange> = Vec::new();
    for part in occluders::find(scene, view, target, &concerned) {
        let Some(kind) = rule(part.layer).map(|r| r.kind) else { continue };
        let layer = ids[part.layer];
        if changed.last().is_none_or(|c| c.layer != layer) {
            let opacity = (kind == FallbackKind::Transparency).then_some(OPACITY);
            let margin_px = (kind != FallbackKind::Transparency).then_some(margin_px);
            let (parts, stuck, moved_by) = (0, 0, None);
            changed.push(FallbackChange { layer: layer.into(), kind, parts, stuck, opacity, margin_px, moved_by });
        }
        let Some(change) = changed.last_mut() else { continue };
        match kind {
            FallbackKind::Transparency => transparent.push(part),
            FallbackKind::Cutaway => cut.push(part),
            FallbackKind::Explosion => {
                let margin =
                    margin_px + target.radius() * view.pinhole().scale_px() / extent.map_or(1.0, |e| e.depth[0]);
                let way = extent.as_ref().and_then(|e| explode::way(view, scene.unit, &part, e, margin));
                let Some(by) = way else {
                    change.stuck += 1;
                    continue;
                };
                change.moved_by = Some(change.moved_by.unwrap_or(0.0f64).max(by.length()));
                moves.push((part, by));
            }
        }
        change.parts += 1;
    }
    let by: Vec<(&Part, DVec3)> = moves.iter().map(|(part, by)| (part, *by)).collect();
    // Pictures that find their target by its pixels draw it opaque.
    let whole = in_sight::with_opaque_target(scene, target);
    let scene = explode::moved(whole.as_ref().unwrap_or(scene), &by);
    let (pixels_alone, pixels_opened) = (None, None);
    let (target_name, visible) = (name.into(), before);
    let record =
        FallbackRecord { target: target_name, visible_before: before, visible, pixels_alone, pixels_opened, changed };
    let mut plan = FallbackPlan { scene, target: target.clone(), transparent, cut, moves, margin_px, record };
    plan.record.visible = plan.planned_share(view)?;
    Ok(plan)
}

/// Whether a layer supports a fallback; if not, why, and what to do.
fn possible(kind: &LayerKind, how: FallbackKind) -> Result<(), &'static str> {
    match (kind, how) {
        (LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_), _) => {
            Err("lines, areas and points hide nothing; leave the rule out")
        }
        (LayerKind::Terrain(_), FallbackKind::Cutaway | FallbackKind::Explosion) => {
            Err("ground can be drawn transparent only; give transparency")
        }
        (LayerKind::Volume(_), FallbackKind::Explosion) => {
            Err("voxels have no parts that could be moved; give transparency or cutaway")
        }
        _ => Ok(()),
    }
}

/// A picture with fallbacks.
pub struct FallbackPicture {
    /// The picture.
    pub frame: Frame,
    /// Pixels in which a cutaway shows something else than the picture without it; `None` where nothing is cut.
    pub pixels_opened: Option<usize>,
}

impl FallbackPlan {
    /// Share of the target's points that lines of sight reach, 0..=1: past what is cut away, and into volumes from where the picture cuts
    /// them.
    fn planned_share(&self, view: &View) -> Result<f64, BelvedereError> {
        let closer = self.past_volumes(view)?;
        let gone = self.transparent.iter().chain(&self.cut).filter(|part| closer.is_none() || !self.is_volume(part));
        let open = occluders::without(&self.scene, &gone.collect::<Vec<_>>());
        Ok(TargetSight::new(&open, &self.target).share(closer.as_ref().unwrap_or(view), 0.0))
    }

    fn is_volume(&self, part: &Part) -> bool {
        self.scene.layers[part.layer].kind.volume().is_some()
    }

    /// The view that begins at the nearest depth of the target, where volumes are cut; `None` if none is, or if it cannot be.
    fn past_volumes(&self, view: &View) -> Result<Option<View>, BelvedereError> {
        let extent = Extent::of(view, &self.target.points).filter(|_| self.cut.iter().any(|part| self.is_volume(part)));
        let Some(extent) = extent else { return Ok(None) };
        let pinhole = Pinhole { near: extent.depth[0], ..view.pinhole().clone() };
        Ok(Some(View::new(pinhole, view.stages().to_vec())?))
    }

    /// The scene with parts moved.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Draws the picture.
    /// * `draw`: draws a scene in a view with fixed quality and light.
    ///
    /// # Errors
    /// Those of `draw`; [`BelvedereError::View`] if the camera cannot look into a volume.
    pub fn draw(
        &self,
        view: &View,
        draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
    ) -> Result<FallbackPicture, BelvedereError> {
        let mut frame = self.blended(&[], view, draw)?;
        let mut pixels_opened = None;
        if !self.cut.is_empty() {
            let cut: Vec<&Part> = self.cut.iter().collect();
            let mut open = self.blended(&cut, view, draw)?;
            self.look_past_volumes(&mut open, view, draw)?;
            let region = self.region(view, draw, [frame.width, frame.height])?;
            let gone: Vec<bool> = (0..region.len()).map(|i| region[i] && open.color[i] != frame.color[i]).collect();
            pixels_opened = Some(gone.iter().filter(|gone| **gone).count());
            for i in (0..region.len()).filter(|i| region[*i]) {
                copy(&mut frame, &open, i);
                frame.color[i] = open.color[i];
            }
            let (scale, width) = ((frame.height as f64 / 720.0).max(0.4), frame.width);
            let mut canvas = Canvas::new(&mut frame.color, width);
            // The edge is drawn around the target, not over it.
            let own = |i: usize| self.target.own_layers.iter().any(|layer| frame.id[i] as usize == layer + 1);
            for i in border(&gone, width).into_iter().filter(|i| !own(*i)) {
                let at = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
                canvas.disc(at, 0.9 * scale, EDGE[1]);
            }
        }
        if !self.moves.is_empty() {
            self.draw_leaders(&mut frame, view, draw)?;
        }
        Ok(FallbackPicture { frame, pixels_opened })
    }

    /// Draws lines from the old to the new positions of parts, behind the target.
    fn draw_leaders(
        &self,
        frame: &mut Frame,
        view: &View,
        draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
    ) -> Result<(), BelvedereError> {
        let region = self.region(view, draw, [frame.width, frame.height])?;
        let bare = frame.color.clone();
        let mut canvas = Canvas::new(&mut frame.color, frame.width);
        let scale = (canvas.size().y / 720.0).max(0.4);
        for (width, color) in [3.2, 1.4].into_iter().zip(EDGE) {
            for (part, by) in &self.moves {
                let from = part.corners.iter().sum::<DVec3>() / part.corners.len() as f64;
                if let [Ok(a), Ok(b)] = [from, from + *by].map(|p| view.project(p)) {
                    canvas.line(&[a.pixel, b.pixel], scale * width, color);
                    canvas.disc(a.pixel, scale * (0.5 * width + 1.5), color);
                }
            }
        }
        for i in (0..bare.len()).filter(|&i| region[i] && self.is_target(frame.id[i])) {
            frame.color[i] = bare[i];
        }
        Ok(())
    }

    /// Measures the visibility of the target, by ids, and by depths where other parts of its layer may hide it; of points and lines by lines
    /// of sight, unless the picture opens nothing.
    /// * `before`: the unchanged scene; `picture`: as drawn by [`FallbackPlan::draw`].
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn measured(
        &self,
        view: &View,
        (before, picture): (&Scene, &FallbackPicture),
        draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
    ) -> Result<FallbackRecord, BelvedereError> {
        let &FallbackPicture { ref frame, pixels_opened } = picture;
        let of = |scene: &Scene| Judge::of_target(scene, &self.target);
        let (Some(judge), Some(now)) = (of(before), of(&self.scene)) else {
            let shut = pixels_opened == Some(0) && self.transparent.is_empty() && self.moves.is_empty();
            let visible = if shut { self.record.visible_before } else { self.record.visible };
            return Ok(FallbackRecord { visible, pixels_opened, ..self.record.clone() });
        };
        let mask = judge.mask((before, None), view, draw)?;
        let now = now.opaque_in(frame, view, draw)?;
        let (visible_before, visible, pixels_alone) = (mask.share(), now.share(), Some(now.pixels()));
        Ok(FallbackRecord { visible_before, visible, pixels_alone, pixels_opened, ..self.record.clone() })
    }

    /// Whether an id of a picture is that of the target's layer.
    fn is_target(&self, id: u32) -> bool {
        in_sight::is_target(&self.target, id)
    }

    /// Mask of the cutaway: around the image of the target's atoms, else around its box or points.
    fn region(
        &self,
        view: &View,
        draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
        size: [usize; 2],
    ) -> Result<Vec<bool>, BelvedereError> {
        let is_molecule = self
            .target
            .own_parts
            .as_ref()
            .is_some_and(|(layer, _)| self.scene.layers[*layer].kind.molecule().is_some());
        let alone = occluders::target_alone(&self.scene, &self.target).filter(|_| is_molecule);
        let Some(alone) = alone else { return Ok(region::mask(view, &self.target, self.margin_px, size)) };
        let image: Vec<bool> = draw(&alone, view)?.id.iter().map(|id| self.is_target(*id)).collect();
        Ok(region::around(&image, self.margin_px, size))
    }

    /// Draws the scene without the parts of `gone`, with transparent parts blended over the rest.
    fn blended(
        &self,
        gone: &[&Part],
        view: &View,
        draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
    ) -> Result<Frame, BelvedereError> {
        let mut frame = if gone.is_empty() {
            draw(&self.scene, view)?
        } else {
            draw(&occluders::without(&self.scene, gone), view)?
        };
        if !self.transparent.is_empty() {
            let all: Vec<&Part> = gone.iter().copied().chain(&self.transparent).collect();
            let behind = draw(&occluders::without(&self.scene, &all), view)?;
            for i in 0..frame.color.len() {
                for (over, under) in frame.color[i].iter_mut().zip(behind.color[i]) {
                    *over = (OPACITY * f32::from(*over) + (1.0 - OPACITY) * f32::from(under)).round() as u8;
                }
                copy(&mut frame, &behind, i);
            }
        }
        Ok(frame)
    }

    /// Cuts volumes at the nearest depth of the target and shows their inside behind the cut.
    fn look_past_volumes(
        &self,
        open: &mut Frame,
        view: &View,
        draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
    ) -> Result<(), BelvedereError> {
        let Some(closer) = self.past_volumes(view)? else { return Ok(()) };
        let near = closer.pinhole().near;
        let gone: Vec<&Part> = self.cut.iter().filter(|p| !self.is_volume(p)).chain(&self.transparent).collect();
        let inner = draw(&occluders::without(&self.scene, &gone), &closer)?;
        for i in (0..open.color.len()).filter(|i| f64::from(inner.depth[*i]) < f64::INFINITY) {
            if f64::from(open.depth[i]) >= near {
                copy(open, &inner, i);
                open.color[i] = inner.color[i];
            }
        }
        Ok(())
    }
}

/// Copies depth, id and world point of a pixel, but not its colour.
fn copy(frame: &mut Frame, from: &Frame, i: usize) {
    (frame.depth[i], frame.id[i]) = (from.depth[i], from.id[i]);
    if let (Some(to), Some(from)) = (&mut frame.world, &from.world) {
        to[i] = from[i];
    }
}

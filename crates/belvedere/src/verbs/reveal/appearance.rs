//! How the pictures of `reveal` are drawn: light, stylisation, mark, exaggeration. It is written into their scene files.

pub use crate::scene_file::request::EXAGGERATION;
use crate::scene_file::request::Look;
use crate::scene_file::{
    Document, FurnitureWish, LayerDoc, LightDoc, OneOrTwo, OverlayDoc, PlaneDoc, ReliefStageDoc, StageDoc,
    StylisationDoc,
};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_resolve as resolve;
use belvedere_scene::{Crs, Edge, Heightfield, LayerKind, Relief, Scene, Sky};
use std::sync::Arc;

/// How a picture is drawn; what is left out stays as it is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Appearance {
    /// The sun: a direction, or a time, which needs a georeferenced scene.
    pub light: Option<LightDoc>,
    /// Shading of the terrain. If left out, the sun at a time shades by [`Relief::Sun`] while it is up, for all else is dark at night.
    pub relief: Option<Relief>,
    /// Dark edges and depth unsharp masking.
    pub stylisation: Option<StylisationDoc>,
    /// Leaves out the shadows that molecules have without being asked for.
    pub no_shadows: bool,
    /// Leaves out the mark that says that the view is bent; the record still says so.
    pub no_mark: bool,
    /// Title, legend, attribution, compass and scale.
    pub furniture: FurnitureWish,
    /// Factor of heights over the median height of the terrain, in [`EXAGGERATION`]. The straight picture keeps the true heights.
    pub exaggeration: Option<f64>,
}

impl From<&Look> for Appearance {
    fn from(look: &Look) -> Self {
        Self {
            light: look.light(),
            relief: look.relief,
            stylisation: look.stylise,
            no_shadows: look.no_shadows,
            no_mark: look.no_mark,
            furniture: look.air.furnishing.wish(),
            exaggeration: look.exaggeration,
        }
    }
}

impl Appearance {
    /// Whether nothing is asked for.
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }

    /// Refuses what pictures in `crs` cannot have, before anything is searched for.
    ///
    /// # Errors
    /// [`BelvedereError::Appearance`] for a time of the sun without georeference, and for strengths out of range.
    pub(super) fn check(&self, crs: Crs) -> Result<(), BelvedereError> {
        if self.light.as_ref().is_some_and(|light| light.time.is_some()) && crs == Crs::Local {
            let reason = "the position of the sun at a time needs a georeferenced scene, and this one is local; give a direction of \
                          light instead";
            return Err(BelvedereError::Appearance { option: "light-time", reason: reason.into() });
        }
        if let Some(light) = &self.light {
            resolve::check_air(light)?;
        }
        let strengths = self.stylisation.unwrap_or_default().strengths();
        strengths.map(|_| ()).map_err(|(_, reason)| BelvedereError::Appearance { option: "stylise", reason })
    }

    /// Gives molecules of a document their shadows, which tell what stands in front of what.
    pub(super) fn shade_molecules(&self, document: &mut Document) {
        if !self.no_shadows && document.layer.iter().any(|layer| matches!(layer, LayerDoc::Molecule(_))) {
            document.light.get_or_insert_default().shadows = true;
        }
    }

    /// Puts light, marks and stylisation into a document.
    pub(super) fn describe(&self, document: &mut Document) {
        if let Some(light) = &self.light {
            document.light = Some(light.clone().over(document.light.take().unwrap_or_default()));
        }
        self.furniture.put_into(&mut document.furniture);
        document.stylisation = self.stylisation.or(document.stylisation);
        if self.no_mark {
            let overlay = document.overlay.take().unwrap_or_default();
            document.overlay = Some(OverlayDoc { mark: false, ..overlay });
        }
    }

    /// The session of a document that [`Appearance::describe`] changed.
    pub(super) fn of_document(session: &Session, document: Document) -> Result<Session, BelvedereError> {
        let overlay = document.overlay.clone().unwrap_or_default();
        let stylisation = document.stylisation.unwrap_or_default().strengths().unwrap_or_default();
        let furniture = document.furniture.clone().unwrap_or_default();
        let session = session.with_document(document, None)?.with_furniture(furniture);
        Ok(session.with_overlay(overlay).with_stylisation(stylisation))
    }

    /// The session in this appearance, with exaggerated heights in front of its other stages.
    pub(super) fn put_on(&self, session: Session, taller: Option<&Taller>) -> Result<Session, BelvedereError> {
        let Some(mut document) = session.resolved().filter(|_| !self.is_usual()).cloned() else { return Ok(session) };
        self.describe(&mut document);
        document.stage.splice(0..0, taller.map(Taller::stage));
        let session = Self::of_document(&session, document)?;
        let by_day = self.light.as_ref().is_some_and(|l| l.time.is_some()) && session.light().altitude > 0.0;
        Ok(match self.relief.or(by_day.then_some(Relief::Sun)) {
            Some(relief) => shaded(session, relief),
            None => session,
        })
    }
}

/// The options with a soft edge of the data where none is stated: pictures that are made from files alone end in no slab.
pub(super) fn softly_ended(options: &OpenOptions) -> OpenOptions {
    OpenOptions { edge: options.edge.or(Some(Edge::Soft)), ..options.clone() }
}

/// The session with another shading of its terrain, in the scene and in the documents.
fn shaded(mut session: Session, relief: Relief) -> Session {
    for layer in &mut Arc::make_mut(&mut session.loaded.scene).layers {
        if let Some(terrain) = layer.kind.terrain_mut() {
            terrain.relief = relief;
        }
    }
    let description = session.resolved.description.iter_mut();
    for document in description.flat_map(|d| [&mut d.source.document, &mut d.resolved]) {
        for layer in &mut document.layer {
            if let LayerDoc::Terrain(terrain) = layer {
                terrain.style.relief = relief;
            }
        }
    }
    session
}

/// Refuses a transparent sky, over which the outlines of targets would be lost.
///
/// # Errors
/// [`BelvedereError::Appearance`].
pub(super) fn check_background(session: &Session, appearance: &Appearance) -> Result<(), BelvedereError> {
    let asked = appearance.light.as_ref().and_then(|light| light.sky.as_deref());
    let stated = session.light().sky == Sky::Transparent && asked.is_none();
    if !stated && asked != Some(LightDoc::TRANSPARENT) {
        return Ok(());
    }
    let reason =
        "pictures of targets have a background; give white, and render their scene with a transparent sky".into();
    Err(BelvedereError::Appearance { option: "sky", reason })
}

/// Whether a stage is an exaggeration, which stays where other bends are left out.
pub(super) fn is_exaggeration(stage: &StageDoc) -> bool {
    matches!(stage, StageDoc::Relief(_))
}

/// A scene with exaggerated heights: what the relief stage of [`Taller::stage`] makes of it, in which views and bends are searched.
pub(super) struct Taller {
    pub(super) scene: Arc<Scene>,
    factor: f64,
    plane_m: f64,
}

impl Taller {
    /// The scene with its heights over their median multiplied by `factor`; `None` without terrain.
    pub(super) fn of(scene: &Scene, factor: f64) -> Result<Option<Self>, BelvedereError> {
        let [least, most] = EXAGGERATION;
        if !(least..=most).contains(&factor) {
            let reason = format!("the exaggeration is {factor}, it must be in {least}..={most}");
            return Err(BelvedereError::Appearance { option: "exaggeration", reason });
        }
        let Some(plane_m) = scene.terrain().map(Heightfield::median_height) else { return Ok(None) };
        let raised = |z: f64| plane_m + factor * (z - plane_m);
        let mut scene = scene.clone();
        for layer in &mut scene.layers {
            match &mut layer.kind {
                LayerKind::Terrain(terrain) => {
                    terrain.heightfield = Arc::new(stretched(&terrain.heightfield, &raised)?)
                }
                LayerKind::Line(line) => {
                    line.features.iter_mut().flat_map(|f| &mut f.points).for_each(|p| p.z = raised(p.z));
                }
                LayerKind::Point(points) => {
                    points.features.iter_mut().for_each(|p| p.position.z = raised(p.position.z));
                }
                _ => {}
            }
        }
        Ok(Some(Self { scene: Arc::new(scene), factor, plane_m }))
    }

    fn stage(&self) -> StageDoc {
        StageDoc::Relief(ReliefStageDoc {
            exaggeration: Some(OneOrTwo::One(self.factor)),
            plane: Some(PlaneDoc { normal: [0.0, 0.0, 1.0], height_m: Some(self.plane_m) }),
            ..ReliefStageDoc::default()
        })
    }
}

/// The ground with other heights at its nodes.
fn stretched(ground: &Heightfield, raised: &dyn Fn(f64) -> f64) -> Result<Heightfield, BelvedereError> {
    let heights = ground.heights().iter().map(|h| raised(f64::from(*h)) as f32).collect();
    let (cols, rows, states) = (ground.cols(), ground.rows(), ground.states().to_vec());
    Heightfield::new(ground.north_west(), ground.spacing(), cols, rows, heights, states)
        .map_err(|e| BelvedereError::Appearance { option: "exaggeration", reason: e.to_string() })
}

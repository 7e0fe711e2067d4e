//! A picture as a value: what it shows, and the drawings that it is composed of.

use super::options::PictureOptions;
use super::{AuxBuffer, furniture};
use crate::scene_file::HighlightMark;
use crate::vectors::VectorContent;
use crate::{BelvedereError, Session};
use belvedere_core::View;
use belvedere_disocclusion::report::Covered;
use belvedere_overlay::furniture::{Plan as Furniture, with_distances};
use belvedere_overlay::{grid, highlight, thin, widths};
use belvedere_scene::{Aux, Frame, Progress, RenderJob, RenderOptions, Scene, Stylisation};
use belvedere_sight::RigidLayers;
use std::borrow::Cow;

/// A drawing of the scene for a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    /// The picture itself; without marks where these become vectors.
    Surfaces,
    /// The picture with the ground lowered to the lines of sight of covered points.
    Lowered,
    /// The straight picture beside the bent one, or faintly over it.
    Straight,
    /// Surfaces with their positions, for the heat map.
    Moved,
    /// Exact surfaces of the straight and of the bent view, for highlights.
    ExactStraight,
    /// See [`Pass::ExactStraight`].
    Exact,
    /// Depths alone, as coarse as the places of names need them.
    Depths,
    /// Marks alone: nothing is drawn, shapes are computed.
    Marks,
}

/// What lies over the surfaces of a picture; the request's choice before the scene's.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wanted {
    pub(super) highlight: Vec<HighlightMark>,
    pub(super) heatmap: bool,
    /// The straight picture faintly over the bent one.
    pub(super) ghost: bool,
    /// The straight picture beside the bent one.
    pub(super) compare: bool,
    pub(super) vectors: bool,
    /// Spacing of the grid, scene units.
    pub(super) grid: Option<f64>,
    pub(super) stylisation: Stylisation,
}

/// A picture of a session.
pub(super) struct Plan<'a> {
    pub(super) session: &'a Session,
    pub(super) request: &'a PictureOptions,
    /// The session's scene, or that of a fallback.
    pub(super) scene: &'a Scene,
    pub(super) view: View,
    pub(super) wanted: Wanted,
    pub(super) furniture: Furniture,
    /// Points that the ground still covers, which is drawn translucent there.
    pub(super) covered: &'a [Covered],
    progress: &'a Progress,
    options: RenderOptions,
}

impl<'a> Plan<'a> {
    /// * `scene`: the session's, or that of a fallback.
    ///
    /// # Errors
    /// [`BelvedereError::Highlight`] for highlights that exclude each other.
    pub(super) fn new(
        session: &'a Session,
        request: &'a PictureOptions,
        (scene, view): (&'a Scene, View),
        progress: &'a Progress,
    ) -> Result<Self, BelvedereError> {
        let stated = &session.resolved.overlay;
        let (highlight, heatmap) =
            highlight::chosen((&request.highlight, request.heatmap), stated).map_err(BelvedereError::Highlight)?;
        let grid = request.grid.or(grid::stated(stated));
        let wanted = Wanted {
            ghost: (request.ghost || stated.ghost) && view.is_bent(),
            compare: request.compare,
            vectors: request.vectors != VectorContent::Nothing,
            grid: grid.and_then(|spacing| grid::spacing(scene, spacing)),
            stylisation: request.stylisation.unwrap_or(session.resolved.stylisation),
            highlight: if request.straight { Vec::new() } else { highlight },
            heatmap,
        };
        let legends = (!wanted.highlight.is_empty(), heatmap);
        let furniture = furniture::plan(session, (scene, &view), request, legends);
        let lines = grid::wanted(scene, grid).into_iter();
        let mut options = RenderOptions {
            aux: Aux { world: false, exact: !request.aux.is_empty() },
            stylisation: wanted.stylisation,
            density: request.density,
            keep_clear: furniture.keep_clear.clone(),
            max_bytes: session.bytes_for_picture(request.quality.max_bytes),
            ..request.quality.clone()
        };
        options.overlay.under.extend(lines.map(|line| widths::line(line, request.density)));
        let covered = session.terrain_report().map_or(&[][..], |report| &report.covered);
        let covered = if request.straight || scene.terrain().is_none() { &[] } else { covered };
        Ok(Self { session, request, scene, view, wanted, furniture, covered, progress, options })
    }

    /// The drawings that the picture is composed of, in the order in which each goes into it.
    pub(super) fn passes(&self) -> Vec<Pass> {
        let wanted = &self.wanted;
        let is_revealed = wanted.highlight.contains(&HighlightMark::Revealed);
        let all = [
            (!self.covered.is_empty(), Pass::Lowered),
            (wanted.vectors, Pass::Marks),
            (wanted.compare || wanted.ghost, Pass::Straight),
            (wanted.heatmap, Pass::Moved),
            (is_revealed, Pass::ExactStraight),
            (!wanted.highlight.is_empty(), Pass::Exact),
        ];
        [Pass::Surfaces].into_iter().chain(all.into_iter().filter(|(is, _)| *is).map(|(_, pass)| pass)).collect()
    }

    /// How a drawing is made.
    fn options(&self, pass: Pass) -> RenderOptions {
        let bare = |world, exact| RenderOptions { marks: false, aux: Aux { world, exact }, ..self.options.clone() };
        let mut options = match pass {
            Pass::Surfaces | Pass::Lowered => RenderOptions { marks: !self.wanted.vectors, ..self.options.clone() },
            Pass::Marks => self.options.clone(),
            // Names that a film has placed are those of the bent picture.
            Pass::Straight => RenderOptions { names: None, ..self.options.clone() },
            Pass::Moved => bare(true, false),
            Pass::ExactStraight | Pass::Exact => bare(true, true),
            Pass::Depths => {
                let stylisation = Stylisation::default();
                RenderOptions { samples: 1, exposures: 1, stylisation, ..bare(false, false) }
            }
        };
        let asks = |buffer: &AuxBuffer| matches!(buffer, AuxBuffer::World | AuxBuffer::Displacement);
        if matches!(pass, Pass::Surfaces | Pass::Lowered | Pass::Marks | Pass::Straight) {
            let rigid = RigidLayers::of(self.scene, &self.view).any();
            options.aux.world = rigid || self.wanted.vectors || self.request.aux.iter().any(asks);
        }
        options
    }

    /// Gives the job of a drawing to `work`.
    ///
    /// # Errors
    /// [`BelvedereError::Disocclusion`], where the ground cannot be lowered.
    pub(super) fn with<T>(&self, pass: Pass, work: impl FnOnce(&RenderJob<'_>) -> T) -> Result<T, BelvedereError> {
        let scene = match pass {
            Pass::Lowered => {
                Cow::Owned(thin::cut(self.scene, &self.view, self.covered)?.unwrap_or_else(|| self.scene.clone()))
            }
            Pass::Straight => widths::scaled(self.session.scene(), self.request.density),
            _ => self.marked(self.scene),
        };
        let straight = matches!(pass, Pass::Straight | Pass::ExactStraight).then(|| self.view.straightened());
        Ok(self.job(pass, &scene, straight.as_ref().unwrap_or(&self.view), work))
    }

    fn job<T>(&self, pass: Pass, scene: &Scene, view: &View, work: impl FnOnce(&RenderJob<'_>) -> T) -> T {
        let (light, progress) = (self.session.light(), self.progress);
        work(&RenderJob { scene, view, light, options: &self.options(pass), progress })
    }

    /// A scene with the marks that the picture asks for, as wide as it draws them.
    fn marked<'s>(&self, scene: &'s Scene) -> Cow<'s, Scene> {
        let density = self.request.density;
        match with_distances(scene, &self.session.resolved.furniture) {
            Cow::Borrowed(scene) => widths::scaled(scene, density),
            Cow::Owned(scene) => Cow::Owned(widths::scaled(&scene, density).into_owned()),
        }
    }

    /// Makes a drawing.
    ///
    /// # Errors
    /// [`BelvedereError::Render`], [`BelvedereError::Disocclusion`], [`BelvedereError::Cancelled`].
    pub(super) fn draw(&self, pass: Pass) -> Result<Frame, BelvedereError> {
        let renderer = self.session.renderer(&self.request.renderer)?;
        Ok(self.with(pass, |job| renderer.render(job))??)
    }

    /// Draws another scene as the picture is drawn.
    ///
    /// # Errors
    /// As [`Plan::draw`].
    pub(super) fn draw_scene(&self, scene: &Scene, view: &View) -> Result<Frame, BelvedereError> {
        let renderer = self.session.renderer(&self.request.renderer)?;
        Ok(self.job(Pass::Surfaces, &self.marked(scene), view, |job| renderer.render(job))?)
    }
}

/// The view that a request draws.
pub(super) fn view(session: &Session, request: &PictureOptions) -> View {
    if request.straight { session.view().straightened() } else { session.view().clone() }
}

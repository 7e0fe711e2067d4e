//! Draws the picture of a session: layers, marks over them, the straight picture beside the bent one.

use super::displacement::{self, DisplacementReport};
use super::mark_target::plain;
use super::options::PictureOptions;
use super::over::{Measured, Over};
use super::plan::{self, Pass, Plan};
use super::sidecar::{MoleculeRecord, OverlayRecord, Picture, SeeThroughRecord, Sidecar, TerrainRecord};
use super::volume_record::VolumeRecord;
use super::{furniture, nothing_seen, transparent, vectors};
use crate::fallback::{self, FallbackPicture, FallbackPlan, FallbackRecord};
use crate::guard::guarded;
use crate::record::{self, InputFile, ViewRecord};
use crate::scene_file::Document;
use crate::vectors::{Furnish, VectorContent, VectorPicture};
use crate::{BelvedereError, CameraPicture, Session, kept};
use belvedere_composite::canvas::Canvas;
use belvedere_core::{View, Warning};
use belvedere_io::budget;
use belvedere_overlay::furniture::FurnitureRecord;
use belvedere_overlay::{camera, ghost, heat, highlight, thin};
use belvedere_scene::Instant;
use belvedere_scene::{Frame, FrameStats, Progress, RenderJob, RenderOptions, Scene, Unit};
use belvedere_sight::RigidLayers;

impl Session {
    /// Draws the session's view, or its camera.
    ///
    /// # Errors
    /// [`BelvedereError::UnderGround`], [`BelvedereError::Render`], [`BelvedereError::Io`] if an input has gone,
    /// [`BelvedereError::Cancelled`].
    pub fn render(&self, options: &PictureOptions) -> Result<Picture, BelvedereError> {
        let inputs = self.public_names().inputs(&record::inputs(&self.inputs())?);
        guarded(|| draw(self, options, inputs, &options.progress))
    }
}

/// The same as [`Session::render`], with the given record of inputs, under the names that outputs give them.
pub(crate) fn draw(
    session: &Session,
    request: &PictureOptions,
    inputs: Vec<InputFile>,
    progress: &Progress,
) -> Result<Picture, BelvedereError> {
    session.check_drawable()?;
    if request.vectors != VectorContent::Nothing {
        vectors::check(session, request)?;
    }
    let started = Instant::now();
    let mut alpha = None;
    let drawn = match request.camera {
        Some(picture) => draw_camera(session, request, picture, progress)?,
        None => match transparent::backgrounds(session, request)? {
            None => draw_view(session, request, progress)?,
            Some([white, black]) => {
                let mut drawn = draw_view(&white, request, progress)?;
                alpha = Some(transparent::uncover(&mut drawn.frame, &draw_view(&black, request, progress)?.frame));
                drawn
            }
        },
    };
    let Drawn { view, frame, straight, overlay, furniture, displacement, fallback, vectors, warnings } = drawn;
    let rigid = RigidLayers::of(session.scene(), &view);
    let render_ms = started.elapsed().as_secs_f64() * 1e3;
    let stats = frame.stats.clone();
    let made = Made { view: &view, overlay, displacement, fallback, stats, furniture, render_ms, warnings };
    let sidecar = sidecar(session, request, (made, &rigid), inputs)?;
    let (aux, aux_format, crs) = (request.aux.clone(), request.aux_format, session.scene().crs);
    let unit = session.scene().unit;
    let scene = session.loaded.scene.clone();
    Ok(Picture {
        frame,
        alpha,
        straight,
        sidecar,
        vectors,
        aux,
        aux_format,
        view,
        scene,
        rigid,
        crs,
        unit,
        later: None,
    })
}

/// What a record says of a picture that was made.
pub(super) struct Made<'a> {
    pub(super) view: &'a View,
    pub(super) overlay: OverlayRecord,
    pub(super) displacement: Option<DisplacementReport>,
    pub(super) fallback: Option<FallbackRecord>,
    pub(super) stats: FrameStats,
    pub(super) furniture: FurnitureRecord,
    pub(super) render_ms: f64,
    /// Warnings about the picture.
    pub(super) warnings: Vec<Warning>,
}

/// The record of a picture.
pub(super) fn sidecar(
    session: &Session,
    request: &PictureOptions,
    (made, rigid): (Made<'_>, &RigidLayers),
    inputs: Vec<InputFile>,
) -> Result<Sidecar, BelvedereError> {
    let Made { view, overlay, displacement, fallback, stats, furniture, render_ms, warnings: of_picture } = made;
    let names = session.public_names();
    let mut volumes = VolumeRecord::all(session.scene());
    volumes.iter_mut().for_each(|volume| volume.transfer = names.text(&volume.transfer));
    Ok(Sidecar {
        program: format!("belvedere {}", crate::VERSION),
        renderer: session.renderer(&request.renderer)?.name(),
        picture_sha256: None,
        note: displacement.map(|d| note(view, &d, session.scene().unit)),
        print: request.print,
        stages: view.stages().iter().map(|s| s.name()).collect(),
        overlay,
        attribution: furniture::credits(session),
        furniture,
        displacement,
        terrain: session.scene().layers.iter().find_map(|layer| layer.kind.terrain()).map(TerrainRecord::of),
        look: None,
        molecules: MoleculeRecord::all_of(session.scene()),
        see_through: SeeThroughRecord::all_of(session.scene()),
        volumes,
        rigid: rigid.ids(session.scene()),
        areas: session.areas().to_vec(),
        disocclusion: session.terrain_report().filter(|_| !request.straight).cloned(),
        moved: session.moves_report().filter(|_| !request.straight).cloned(),
        strip: session.strip_report().filter(|_| !request.straight).cloned(),
        tube: session.tube_report().filter(|_| !request.straight).cloned(),
        constructor: session.constructor_report().filter(|_| !request.straight).cloned(),
        target: None,
        fallback,
        view: ViewRecord::of(view),
        scene: session.public_document(&names).map(|document| Document {
            print: request.print.map_or(document.print.clone(), |sheet| Some(sheet.document())),
            ..document
        }),
        title: session.scene().title.clone(),
        inputs,
        warnings: [session.warnings(), of_picture.clone()].concat(),
        of_picture,
        stats,
        render_ms,
    })
}

/// Pictures with all marks.
pub(crate) struct Drawn {
    pub(crate) view: View,
    pub(crate) frame: Frame,
    pub(crate) straight: Option<Frame>,
    overlay: OverlayRecord,
    furniture: FurnitureRecord,
    pub(crate) displacement: Option<DisplacementReport>,
    fallback: Option<FallbackRecord>,
    vectors: Option<VectorPicture>,
    warnings: Vec<Warning>,
}

/// Draws the view with all marks, and takes note of the memory that the renderer keeps.
pub(crate) fn draw_view(
    session: &Session,
    request: &PictureOptions,
    progress: &Progress,
) -> Result<Drawn, BelvedereError> {
    let before = budget::held();
    let drawn = draw_marked(session, request, progress)?;
    let frames = kept::bytes_of(&drawn.frame) + drawn.straight.as_ref().map_or(0, kept::bytes_of);
    session.kept.drawn([before, budget::held()], frames);
    Ok(drawn)
}

fn draw_marked(session: &Session, request: &PictureOptions, progress: &Progress) -> Result<Drawn, BelvedereError> {
    let view = plan::view(session, request);
    let judging = plain(session, request, progress);
    let fallback = if request.straight { None } else { fallback::of_session(session, &view, Some(&judging))? };
    if fallback.is_some() && request.vectors != VectorContent::Nothing {
        return Err(BelvedereError::NoVectors("pictures with a fallback for a target"));
    }
    let scene = fallback.as_ref().map_or(session.scene(), FallbackPlan::scene);
    let plan = Plan::new(session, request, (scene, view), progress)?;
    let mut painting = Painting { fallback: fallback.as_ref(), ..Painting::new(&plan) };
    if request.vectors == VectorContent::Alone {
        let has_more = plan.wanted.grid.is_some() || !plan.furniture.kinds.is_empty();
        painting.warnings.extend(vectors::left_out(session, has_more)?);
    }
    for pass in plan.passes() {
        painting.take(pass)?;
    }
    painting.finish()
}

/// A picture while its plan is carried out.
struct Painting<'a> {
    plan: &'a Plan<'a>,
    fallback: Option<&'a FallbackPlan>,
    frame: Frame,
    straight: Option<Frame>,
    /// Exact surfaces of the straight view.
    exact_straight: Option<Frame>,
    vectors: Option<VectorPicture>,
    measured: Measured,
    fallback_record: Option<FallbackRecord>,
    /// That nothing is seen.
    unseen: Option<Warning>,
    warnings: Vec<Warning>,
}

impl<'a> Painting<'a> {
    fn new(plan: &'a Plan<'a>) -> Self {
        Self {
            plan,
            fallback: None,
            frame: Frame::default(),
            straight: None,
            exact_straight: None,
            vectors: None,
            measured: Measured::default(),
            fallback_record: None,
            unseen: None,
            warnings: Vec::new(),
        }
    }

    /// Makes a drawing and puts it into the picture.
    fn take(&mut self, pass: Pass) -> Result<(), BelvedereError> {
        let plan = self.plan;
        let (scene, view, wanted) = (plan.scene, &plan.view, &plan.wanted);
        match pass {
            Pass::Surfaces => self.surfaces()?,
            Pass::Lowered => {
                let size = [self.frame.width, self.frame.height];
                thin::Thin::new(scene, view, plan.covered, size).draw(&mut self.frame, &plan.draw(pass)?, 0);
            }
            Pass::Marks => {
                self.vectors = Some(plan.with(pass, |job| vectors::of_marks(job, &self.frame, plan.request))?);
            }
            Pass::Straight => self.straight = Some(plan.draw(pass)?),
            Pass::Moved => {
                let rigid = RigidLayers::of(scene, view);
                self.measured.heatmap_max = Some(heat::paint(&mut self.frame, &plan.draw(pass)?, (view, &rigid)));
            }
            Pass::ExactStraight => self.exact_straight = Some(plan.draw(pass)?),
            Pass::Exact => {
                let bare = highlight::Bare { bent: &plan.draw(pass)?, straight: self.exact_straight.as_ref() };
                let ramp_px = plan.session.resolved.overlay.highlight_px;
                let record = highlight::paint(&mut self.frame, &bare, scene, view, &wanted.highlight, ramp_px);
                (self.measured.highlight, self.exact_straight) = (Some(record), None);
            }
            Pass::Depths => {}
        }
        Ok(())
    }

    /// Draws the picture itself, with the changes of its fallback.
    fn surfaces(&mut self) -> Result<(), BelvedereError> {
        let plan = self.plan;
        let draw = |scene: &Scene, view: &View| plan.draw_scene(scene, view);
        let picture = match self.fallback {
            Some(fallback) => fallback.draw(&plan.view, &draw)?,
            None => FallbackPicture { frame: plan.draw(Pass::Surfaces)?, pixels_opened: None },
        };
        self.unseen = nothing_seen::warning(plan.scene, &plan.view, &picture.frame);
        // Measured before further pictures are drawn over it.
        let measure = |fallback: &FallbackPlan| fallback.measured(&plan.view, (plan.session.scene(), &picture), &draw);
        self.fallback_record = self.fallback.map(measure).transpose()?;
        self.warnings.extend(self.fallback_record.iter().filter_map(FallbackRecord::warning));
        self.frame = picture.frame;
        Ok(())
    }

    /// Draws what lies over the picture.
    fn finish(mut self) -> Result<Drawn, BelvedereError> {
        let Plan { session: _, request, scene, view, wanted, furniture, .. } = self.plan;
        if let Some(straight) = self.straight.as_ref().filter(|_| wanted.ghost) {
            ghost::draw(&mut self.frame, straight, scene);
        }
        let rigid = RigidLayers::of(scene, view);
        let displacement = view.is_bent().then(|| displacement::measure(view, &rigid, &self.frame)).transpose()?;
        self.measured.displacement = displacement;
        let size = [self.frame.width, self.frame.height];
        let over = Over::new(self.plan, self.measured, size);
        let mut shapes = Vec::new();
        let record = wanted.vectors.then_some(&mut shapes);
        let mut furnish = Furnish { pixels: &mut self.frame.color, size, record };
        over.draw(|name, draw| furnish.draw(name, draw));
        let seen = self.vectors.as_ref().is_some_and(|vectors| !vectors::is_empty(vectors));
        self.warnings.extend(self.unseen.filter(|_| !seen));
        if let Some(vectors) = &mut self.vectors {
            vectors.furniture = shapes;
            self.warnings.extend(vectors::blank(vectors));
        }
        Ok(Drawn {
            view: view.clone(),
            frame: self.frame,
            straight: self.straight.filter(|_| request.compare),
            overlay: over.record(),
            furniture: furniture.record.clone(),
            displacement,
            fallback: self.fallback_record,
            vectors: self.vectors,
            warnings: self.warnings,
        })
    }
}

/// Draws the picture of the camera.
pub(crate) fn draw_camera(
    session: &Session,
    request: &PictureOptions,
    picture: CameraPicture,
    progress: &Progress,
) -> Result<Drawn, BelvedereError> {
    let figure = camera::figure((session.scene(), session.view()), session.ray_end(None)?, picture)?;
    let max_bytes = session.bytes_for_picture(request.quality.max_bytes);
    let options = RenderOptions { overlay: figure.overlay.clone(), max_bytes, ..request.quality.clone() };
    let (scene, view, light) = (session.scene(), &figure.view, session.light());
    let job = RenderJob { scene, view, light, options: &options, progress };
    let mut frame = session.renderer(&request.renderer)?.render(&job)?;
    let title = if scene.title.is_empty() { "The camera" } else { &scene.title };
    camera::draw_legend(&mut Canvas::new(&mut frame.color, frame.width), &figure, (title, scene.unit));
    let overlay = OverlayRecord { camera: Some(picture.name()), ..OverlayRecord::default() };
    let displacement = figure
        .view
        .is_bent()
        .then(|| displacement::measure(&figure.view, &RigidLayers::of(scene, &figure.view), &frame))
        .transpose()?;
    let furniture = FurnitureRecord::default();
    let view = figure.view;
    let (straight, fallback, vectors, warnings) = (None, None, None, Vec::new());
    Ok(Drawn { view, frame, straight, overlay, furniture, displacement, fallback, vectors, warnings })
}

fn note(view: &View, d: &DisplacementReport, unit: Unit) -> String {
    let names: Vec<&str> = view.stages().iter().map(|s| s.name()).filter(|n| *n != "earth").collect();
    format!(
        "bent view ({}): what is shown is displaced by up to {} ({:.0} px); not to scale, not for navigation",
        names.join(", "),
        d.most(unit),
        d.max_px
    )
}

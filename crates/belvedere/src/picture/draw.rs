//! Draws the picture of a session: layers, marks over them, the straight picture beside the bent one.

use super::AuxBuffer;
use super::displacement::{self, DisplacementReport};
use super::mark_target::plain;
use super::options::PictureOptions;
use super::sidecar::{MoleculeRecord, OverlayRecord, Picture, SeeThroughRecord, Sidecar, TerrainRecord};
use super::volume_record::VolumeRecord;
use super::{furniture, nothing_seen, transparent, vectors};
use crate::bodies::RigidLayers;
use crate::fallback::{self, FallbackPicture, FallbackPlan, FallbackRecord};
use crate::guard::guarded;
use crate::overlays::furniture::{FurnitureRecord, with_distances};
use crate::overlays::{badge, camera, curve_inset, ghost, grid, heat, highlight, thin, widths};
use crate::record::{self, InputFile, ViewRecord};
use crate::scene_file::{Document, HighlightMark};
use crate::vectors::{Furnish, VectorContent, VectorPicture};
use crate::{BelvedereError, CameraPicture, Session, kept};
use belvedere_composite::canvas::Canvas;
use belvedere_core::{View, Warning};
use belvedere_io::budget;
use belvedere_scene::Instant;
use belvedere_scene::{Aux, Frame, FrameStats, Progress, RenderJob, RenderOptions, Scene, Unit};

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
    Ok(Picture { frame, alpha, straight, sidecar, vectors, aux, aux_format, view, rigid, crs, unit, later: None })
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
        terrain: session.scene().terrain().map(TerrainRecord::of),
        molecules: MoleculeRecord::all_of(session.scene()),
        see_through: SeeThroughRecord::all_of(session.scene()),
        volumes,
        rigid: rigid.ids(session.scene()),
        areas: session.areas().to_vec(),
        disocclusion: session.terrain_report().filter(|_| !request.straight).cloned(),
        strip: session.strip_report().filter(|_| !request.straight).cloned(),
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
    let view = if request.straight { session.view().straightened() } else { session.view().clone() };
    let judging = plain(session, request, progress);
    let plan = if request.straight { None } else { fallback::of_session(session, &view, Some(&judging))? };
    let scene = plan.as_ref().map_or(session.scene(), FallbackPlan::scene);
    if plan.is_some() && request.vectors != VectorContent::Nothing {
        return Err(BelvedereError::NoVectors("pictures with a fallback for a target"));
    }
    let wanted = &session.resolved.overlay;
    let (marks, heatmap) = highlight::chosen((&request.highlight, request.heatmap), wanted)?;
    let ghost = (request.ghost || wanted.ghost) && view.is_bent();
    let grid = request.grid.or(grid::stated(wanted));
    let grid_spacing = grid.and_then(|spacing| grid::spacing(scene, spacing));
    let rigid = RigidLayers::of(scene, &view);
    let as_vectors = request.vectors != VectorContent::Nothing;
    let world = rigid.any()
        || as_vectors
        || request.aux.iter().any(|a| matches!(a, AuxBuffer::World | AuxBuffer::Displacement));
    let exact = !request.aux.is_empty();
    let stylisation = request.stylisation.unwrap_or(session.resolved.stylisation);
    let mut options = RenderOptions { aux: Aux { world, exact }, stylisation, ..request.quality.clone() };
    options.max_bytes = session.bytes_for_picture(options.max_bytes);
    options.overlay.under.extend(grid::wanted(scene, grid).into_iter().map(|line| widths::line(line, request.density)));
    options.density = request.density;
    let furnished = furniture::plan(session, (scene, &view), request, (!marks.is_empty(), heatmap));
    options.keep_clear.clone_from(&furnished.keep_clear);
    let mut warnings = Vec::new();
    if request.vectors == VectorContent::Alone {
        let has_more = !options.overlay.under.is_empty() || !furnished.kinds.is_empty();
        warnings.extend(vectors::left_out(session, has_more)?);
    }
    let ticked = &session.resolved.furniture;
    // What becomes vectors is not drawn.
    let surfaces = RenderOptions { marks: !as_vectors, ..options.clone() };
    let draw = |scene: &Scene, view: &View| {
        let scene = with_distances(scene, ticked);
        let scene = &*widths::scaled(&scene, request.density);
        let job = RenderJob { scene, view, light: session.light(), options: &surfaces, progress };
        Ok::<_, BelvedereError>(session.renderer(&request.renderer)?.render(&job)?)
    };
    let bare = || Ok(FallbackPicture { frame: draw(scene, &view)?, pixels_opened: None });
    let picture = plan.as_ref().map_or_else(bare, |plan| plan.draw(&view, &draw))?;
    let unseen = nothing_seen::warning(scene, &view, &picture.frame);
    // Measured before further pictures are drawn over it.
    let fallback = plan.as_ref().map(|plan| plan.measured(&view, (session.scene(), &picture), &draw)).transpose()?;
    warnings.extend(fallback.iter().filter_map(FallbackRecord::warning));
    let mut frame = picture.frame;
    if let Some(covered) =
        session.terrain_report().map(|r| &r.covered[..]).filter(|c| !c.is_empty() && !request.straight)
        && let Some(cut) = thin::cut(scene, &view, covered)?
    {
        let job = RenderJob { scene: &cut, view: &view, light: session.light(), options: &surfaces, progress };
        let behind = session.renderer(&request.renderer)?.render(&job)?;
        thin::Thin::new(scene, &view, covered, [frame.width, frame.height]).draw(&mut frame, &behind, 0);
    }
    let mut vectors = as_vectors.then(|| {
        let scene = with_distances(scene, ticked);
        let scene = &*widths::scaled(&scene, request.density);
        let job = RenderJob { scene, view: &view, light: session.light(), options: &options, progress };
        vectors::of_marks(&job, &frame, request)
    });
    let straight = (request.compare || ghost)
        .then(|| {
            // The straight picture is always one of pixels.
            let scene = &*widths::scaled(session.scene(), request.density);
            let options = RenderOptions { names: None, ..options.clone() };
            let job =
                RenderJob { scene, view: &view.straightened(), light: session.light(), options: &options, progress };
            Ok::<_, BelvedereError>(session.renderer(&request.renderer)?.render(&job)?)
        })
        .transpose()?;
    let mut heatmap_max = None;
    if heatmap {
        // Names and lines are drawn over the heat map, not tinted by it.
        let aux = Aux { world: true, exact: false };
        let max_bytes = options.max_bytes;
        let options = RenderOptions { marks: false, aux, max_bytes, ..request.quality.clone() };
        let job = RenderJob { scene, view: &view, light: session.light(), options: &options, progress };
        let bare = session.renderer(&request.renderer)?.render(&job)?;
        heatmap_max = Some(heat::paint(&mut frame, &bare, (&view, &rigid)));
    }
    let highlight = (!marks.is_empty() && !request.straight)
        .then(|| {
            let aux = Aux { world: true, exact: true };
            let max_bytes = options.max_bytes;
            let options = RenderOptions { marks: false, aux, max_bytes, ..request.quality.clone() };
            let draw = |view: &View| {
                let job = RenderJob { scene, view, light: session.light(), options: &options, progress };
                Ok::<_, BelvedereError>(session.renderer(&request.renderer)?.render(&job)?)
            };
            let bent = draw(&view)?;
            let straight = marks.contains(&HighlightMark::Revealed).then(|| draw(&view.straightened())).transpose()?;
            let bare = highlight::Bare { bent: &bent, straight: straight.as_ref() };
            Ok::<_, BelvedereError>(highlight::paint(&mut frame, &bare, scene, &view, &marks, wanted.highlight_px))
        })
        .transpose()?;
    if let Some(straight) = straight.as_ref().filter(|_| ghost) {
        ghost::draw(&mut frame, straight, scene);
    }
    let displacement = view.is_bent().then(|| displacement::measure(&view, &rigid, &frame)).transpose()?;
    let mark = mark_words(session, request, [frame.width, frame.height], displacement);
    let size = [frame.width, frame.height];
    let mut shapes = Vec::new();
    let mut furniture = Furnish { pixels: &mut frame.color, size, record: as_vectors.then_some(&mut shapes) };
    furniture.draw("legend", |canvas| {
        let mut canvas = canvas.scaled(request.density);
        if let Some(most) = heatmap_max {
            heat::legend(&mut canvas, most);
        }
        if let Some(record) = &highlight {
            let taken = if heatmap_max.is_some() { heat::LEGEND_HEIGHT + 10.0 } else { 0.0 };
            highlight::legend(&mut canvas, record, taken);
        }
    });
    let figure = wanted.inset.and_then(|inset| Some((inset, curve_inset::CurveFigure::of(&view)?)));
    let mut inset = None;
    furniture.draw("inset", |canvas| {
        inset = figure.filter(|(_, figure)| draw_inset(canvas, figure, request)).map(|(inset, _)| inset);
    });
    for (name, shapes) in &furnished.kinds {
        furniture.draw(name, |mut canvas| shapes.iter().for_each(|shape| canvas.put(shape)));
    }
    furniture.draw("mark", |mut canvas| {
        if let Some(words) = &mark {
            badge::draw(&mut canvas, words, request.density);
        }
    });
    let seen = vectors.as_ref().is_some_and(|vectors| !vectors::is_empty(vectors));
    warnings.extend(unseen.filter(|_| !seen));
    if let Some(vectors) = &mut vectors {
        vectors.furniture = shapes;
        warnings.extend(vectors::blank(vectors));
    }
    let overlay = OverlayRecord {
        edges: (stylisation.edges > 0.0).then_some(stylisation.edges),
        unsharp: (stylisation.unsharp > 0.0).then_some(stylisation.unsharp),
        mark: mark.is_some(),
        mark_words: mark,
        inset,
        grid: grid_spacing,
        heatmap_max,
        ghost,
        highlight,
        camera: None,
    };
    let straight = straight.filter(|_| request.compare);
    let furniture = furnished.record;
    Ok(Drawn { view, frame, straight, overlay, furniture, displacement, fallback, vectors, warnings })
}

/// Words of the mark of a bent picture, if it has one.
/// * `size`: of the picture, pixels.
pub(super) fn mark_words(
    session: &Session,
    request: &PictureOptions,
    size: [usize; 2],
    displacement: Option<DisplacementReport>,
) -> Option<String> {
    let [width, height] = size.map(|pixels| (pixels as f64 / request.density) as usize);
    match displacement {
        _ if !session.resolved.overlay.mark || request.no_mark || !badge::fits(width, height) => None,
        _ if request.steady_mark => Some(badge::WORDS.to_owned()),
        moved => moved.map(|moved| badge::words(width, moved.max_m, session.scene().unit)),
    }
}

/// Draws the curve of a spline; whether the picture is large enough.
pub(super) fn draw_inset(canvas: Canvas<'_>, figure: &curve_inset::CurveFigure, request: &PictureOptions) -> bool {
    // Its letters are of one size in windows of every density; on paper they are lengths.
    curve_inset::draw(&mut canvas.scaled(if request.print.is_some() { request.density } else { 1.0 }), figure)
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

//! Pictures that are drawn and written some rows at a time, so that memory does not grow with their height. Every byte is that of the picture
//! in one piece.

use super::displacement;
use super::draw::{Made, sidecar};
use super::options::PictureOptions;
use super::over::{Measured, Over};
use super::plan::{self, Pass, Plan};
use super::sidecar::{Later, OverlayRecord, Picture};
use crate::guard::guarded;
use crate::record::{self, InputFile};
use crate::{BelvedereError, Session, fallback};
use belvedere_composite::canvas::Canvas;
use belvedere_io::picture_file::{PictureFile, PictureFormat};
use belvedere_io::png::{self, Channels};
use belvedere_io::{atomic, budget};
use belvedere_overlay::furniture::FurnitureRecord;
use belvedere_overlay::thin;
use belvedere_scene::{Frame, FrameStats, Instant, PictureRows, ROWS, RenderError, RenderJob, Sky};
use belvedere_sight::RigidLayers;
use std::cell::RefCell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pictures with more pixels are drawn in bands.
const LARGE: u64 = 1 << 25;
/// Memory of the rows of a band, bytes, about; more where many threads draw.
const BAND_BYTES: u64 = 48 << 20;
/// Bytes of a pixel of a band.
const PER_PIXEL: u64 = 20;

impl Session {
    /// Draws the picture into a file: the same bytes as [`Session::render`] and [`Picture::write`], but a large picture, or one for which there is
    /// too little memory, is drawn in bands of rows ([`PictureOptions::band_rows`]). The picture that is returned then has no pixels.
    ///
    /// # Errors
    /// Those of [`Session::render`] and [`Picture::write`]; [`BelvedereError::OnePiece`] where bands are needed and the picture has parts that
    /// are drawn in one piece alone.
    pub fn render_to(
        &self,
        options: &PictureOptions,
        out: &Path,
        overwrite: bool,
    ) -> Result<(Picture, Vec<PathBuf>), BelvedereError> {
        let Some(rows) = rows(self, options, out)? else {
            let picture = self.render(options)?;
            let written = picture.write(out, overwrite)?;
            return Ok((picture, written));
        };
        let inputs = self.public_names().inputs(&record::inputs(&self.inputs())?);
        let before = budget::held();
        let drawn = guarded(|| write(self, options, (out, overwrite), (rows, inputs)));
        self.kept.drawn([before, budget::held()], 0);
        drawn
    }
}

/// A picture for `out` that is drawn in bands while it is written, see [`write_later`]; `None` for one that is drawn in one piece, and where
/// a request does not say to which file it goes.
pub(crate) fn later(
    session: &Session,
    request: &PictureOptions,
    out: Option<&Path>,
) -> Result<Option<Picture>, BelvedereError> {
    let Some(out) = out else { return Ok(None) };
    if rows(session, request, out)?.is_none() {
        return Ok(None);
    }
    let scene = session.scene();
    let [width, height] = session.view().pinhole().image.map(|side| side as usize);
    let view = plan::view(session, request);
    let rigid = RigidLayers::of(scene, &view);
    let inputs = session.public_names().inputs(&record::inputs(&session.inputs())?);
    let made = Made {
        view: &view,
        overlay: OverlayRecord::default(),
        displacement: None,
        fallback: None,
        stats: FrameStats::default(),
        furniture: FurnitureRecord::default(),
        render_ms: 0.0,
        warnings: Vec::new(),
    };
    Ok(Some(Picture {
        frame: Frame { width, height, ..Frame::default() },
        alpha: None,
        straight: None,
        sidecar: sidecar(session, request, (made, &rigid), inputs)?,
        vectors: None,
        aux: Vec::new(),
        aux_format: request.aux_format,
        rigid,
        scene: session.loaded.scene.clone(),
        crs: scene.crs,
        unit: scene.unit,
        later: Some(Later { options: Box::new(request.clone()), record: Arc::default() }),
        view,
    }))
}

/// Draws and writes a picture of [`later`].
pub(crate) fn write_later(
    session: &Session,
    later: &Later,
    out: &Path,
    overwrite: bool,
) -> Result<Vec<PathBuf>, BelvedereError> {
    let (picture, written) = session.render_to(&later.options, out, overwrite)?;
    // A picture is written once; a second time its record is the same.
    let _ = later.record.set(picture.sidecar);
    Ok(written)
}

/// Draws the straight picture of [`later`] into a PNG without a record.
pub(crate) fn write_straight(
    session: &Session,
    later: &Later,
    out: &Path,
    overwrite: bool,
) -> Result<(), BelvedereError> {
    let request = &*later.options;
    let plan = plan_of(session, request)?;
    let rows = rows(session, request, Path::new("straight.png"))?.unwrap_or(ROWS);
    let renderer = session.renderer(&request.renderer)?;
    let program = format!("belvedere {}", crate::VERSION);
    let mut result = Ok(());
    plan.with(Pass::Straight, |job| {
        renderer.in_rows(job, &mut |front| {
            let bands = Bands { plan: &plan, rows, thin: None };
            let [width, height] = front.size();
            let text = [("Software", program.as_str())];
            result = drawn(|failed| {
                atomic::write_atomic(out, overwrite, |file| {
                    png::encode_rows(file, (width, height), Channels::Rgb, (&text, None), &|rows| {
                        bands.draw(front, &|_, _| {}, rows).map_err(|error| error.kept_in(failed))
                    })
                })
                .map_err(BelvedereError::from)
            });
            Ok(())
        })
    })??;
    result
}

/// The plan of a picture without a fallback.
fn plan_of<'a>(session: &'a Session, request: &'a PictureOptions) -> Result<Plan<'a>, BelvedereError> {
    Plan::new(session, request, (session.scene(), plan::view(session, request)), &request.progress)
}

/// Runs some writing, during which drawing may fail: then that is the error.
fn drawn<T>(
    write: impl FnOnce(&RefCell<Option<RenderError>>) -> Result<T, BelvedereError>,
) -> Result<T, BelvedereError> {
    let failed = RefCell::new(None);
    let written = write(&failed);
    match failed.into_inner() {
        Some(error) => Err(error.into()),
        None => written,
    }
}

/// Why a picture is drawn in one piece alone, whatever its size; `None` if it may be drawn in bands.
fn whole_only(plan: &Plan<'_>, out: &Path) -> Option<&'static str> {
    let Plan { session, request, wanted, .. } = plan;
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let format = PictureFormat::of(out).unwrap_or(PictureFormat::Png);
    let is_vector = wanted.vectors || ["svg", "svgz", "pdf"].contains(&ending.as_str());
    let reasons = [
        (wanted.compare, "the pair of pictures"),
        (request.camera.is_some(), "the picture of the camera"),
        (!request.aux.is_empty(), "buffers beside it"),
        (is_vector, "its vectors"),
        (!PictureFile::has_rows(format), "its format (PNG, TIFF and JPEG are written in bands)"),
        (session.light().sky == Sky::Transparent, "its transparent sky"),
        (wanted.ghost, "the straight picture faintly over it"),
        (wanted.heatmap || !wanted.highlight.is_empty(), "highlights or a heat map"),
        (!request.straight && fallback::is_asked(session), "a fallback for its target"),
    ];
    reasons.into_iter().find(|(is, _)| *is).map(|(_, what)| what)
}

/// Rows that a picture is drawn at a time; `None` in one piece.
pub(crate) fn rows(session: &Session, request: &PictureOptions, out: &Path) -> Result<Option<usize>, BelvedereError> {
    if request.band_rows == Some(0) {
        return Ok(None);
    }
    let [width, height] = session.view().pinhole().image.map(u64::from);
    let (plan, renderer) = (plan_of(session, request)?, session.renderer(&request.renderer)?);
    let max_bytes = session.bytes_for_picture(request.quality.max_bytes);
    let (needed, refused) =
        plan.with(Pass::Surfaces, |job| (renderer.bytes_for(job, None), renderer.whole_only(job)))?;
    let fits = needed <= max_bytes;
    if request.band_rows.is_none() && fits && width * height <= LARGE {
        return Ok(None);
    }
    if let Some(what) = whole_only(&plan, out).or(refused) {
        if request.band_rows.is_none() && fits {
            return Ok(None);
        }
        let (needed_mib, limit_mib) = (needed.div_ceil(1 << 20), max_bytes >> 20);
        return Err(BelvedereError::OnePiece { what, size: [width, height], needed_mib, limit_mib });
    }
    if let Some(rows) = request.band_rows {
        return Ok(Some(rows.next_multiple_of(ROWS)));
    }
    let threads = match request.quality.threads {
        0 => rayon::current_num_threads(),
        threads => threads,
    };
    let of_row = width * PER_PIXEL;
    let most = (max_bytes / 4 / of_row).max(ROWS as u64);
    let usual = (BAND_BYTES / of_row).max((2 * threads * ROWS) as u64).min(most);
    Ok(Some((usual as usize / ROWS).max(1) * ROWS))
}

/// Everything that the rows of a picture are made of.
struct Bands<'a> {
    plan: &'a Plan<'a>,
    /// Rows of a band.
    rows: usize,
    /// The picture of the lowered ground, and where it shows through.
    thin: Option<(&'a dyn PictureRows, thin::Thin)>,
}

fn write(
    session: &Session,
    request: &PictureOptions,
    out: (&Path, bool),
    (rows, inputs): (usize, Vec<InputFile>),
) -> Result<(Picture, Vec<PathBuf>), BelvedereError> {
    session.check_drawable()?;
    let started = Instant::now();
    let (plan, renderer) = (plan_of(session, request)?, session.renderer(&request.renderer)?);
    let mut result = None;
    let mut write = |front: &dyn PictureRows, thin: Option<(&dyn PictureRows, thin::Thin)>| {
        result = Some(Bands { plan: &plan, rows, thin }.write(front, out, (started, inputs.clone())));
        Ok(())
    };
    let mut draw = |behind: Option<&RenderJob<'_>>| {
        plan.with(Pass::Surfaces, |job| {
            renderer.in_rows(job, &mut |front| {
                let Some(behind) = behind else { return write(front, None) };
                let mut thin = Some(thin::Thin::new(plan.scene, &plan.view, plan.covered, front.size()));
                renderer.in_rows(behind, &mut |behind| write(front, thin.take().map(|thin| (behind, thin))))
            })
        })
    };
    match plan.passes().contains(&Pass::Lowered) {
        true => plan.with(Pass::Lowered, |behind| draw(Some(behind)))???,
        false => draw(None)??,
    }
    // The renderer calls its work once.
    result.unwrap_or(Err(RenderError::WholeOnly { what: "its renderer" }.into()))
}

impl Bands<'_> {
    fn write(
        &self,
        front: &dyn PictureRows,
        (out, overwrite): (&Path, bool),
        (started, inputs): (Instant, Vec<InputFile>),
    ) -> Result<(Picture, Vec<PathBuf>), BelvedereError> {
        let &Plan { session, request, scene, ref view, ref furniture, .. } = self.plan;
        let [width, height] = front.size();
        let rigid = RigidLayers::of(scene, view);
        let displacement = view.is_bent().then(|| displacement::measure(view, &rigid, &front)).transpose()?;
        let over = Over::new(self.plan, Measured { displacement, ..Measured::default() }, [width, height]);
        let made = Made {
            view,
            overlay: over.record(),
            displacement,
            fallback: None,
            stats: front.stats(),
            furniture: furniture.record.clone(),
            render_ms: 0.0,
            warnings: Vec::new(),
        };
        let sidecar = sidecar(session, request, (made, &rigid), inputs)?;
        let mut picture = Picture {
            frame: Frame { width, height, stats: front.stats(), ..Frame::default() },
            alpha: None,
            straight: None,
            sidecar,
            vectors: None,
            aux: Vec::new(),
            aux_format: request.aux_format,
            view: view.clone(),
            rigid,
            scene: session.loaded.scene.clone(),
            crs: scene.crs,
            unit: scene.unit,
            later: None,
        };
        let furnish = |pixels: &mut [[u8; 3]], first: usize| {
            over.draw(|_, draw| draw(Canvas::rows(pixels, [width, height], first)));
        };
        let written = drawn(|failed| {
            picture.write_rows(out, overwrite, &|file| {
                self.draw(front, &furnish, file).map_err(|error| error.kept_in(failed))
            })
        })?;
        picture.sidecar.render_ms = started.elapsed().as_secs_f64() * 1e3;
        Ok((picture, written))
    }

    /// Draws band after band, and writes each.
    fn draw(
        &self,
        front: &dyn PictureRows,
        furnish: &dyn Fn(&mut [[u8; 3]], usize),
        file: &mut dyn Write,
    ) -> Result<(), Failed> {
        let [_, height] = front.size();
        let (mut frame, mut behind) = (Frame::default(), Frame::default());
        for first in (0..height).step_by(self.rows) {
            let rows = first..(first + self.rows).min(height);
            front.draw(rows.clone(), &mut frame)?;
            if let Some((lowered, thin)) = &self.thin {
                lowered.draw(rows, &mut behind)?;
                thin.draw(&mut frame, &behind, first);
            }
            furnish(&mut frame.color, first);
            file.write_all(frame.color.as_flattened()).map_err(Failed::Output)?;
        }
        Ok(())
    }
}

/// Why a band is missing.
enum Failed {
    Drawing(RenderError),
    Output(io::Error),
}

impl Failed {
    /// The error for the output; one of drawing is kept.
    fn kept_in(self, failed: &RefCell<Option<RenderError>>) -> io::Error {
        match self {
            Self::Output(error) => error,
            Self::Drawing(error) => {
                *failed.borrow_mut() = Some(error);
                io::Error::other("the picture was not drawn")
            }
        }
    }
}

impl From<RenderError> for Failed {
    fn from(error: RenderError) -> Self {
        Self::Drawing(error)
    }
}

//! Pictures, films and papers as requests of [`crate::request`] ask for them: every door of the program goes through here.

use crate::picture::{PictureOptions, THRESHOLDS};
use crate::print::Sheet;
use crate::renderers;
use crate::request::{Animate, Drawing, Outside, Paper, Render};
use crate::scene_file::{Document, SourceDocument, SwitchOrLength};
use crate::verbs::animate::AnimateRequest;
use crate::{Advice, BelvedereError, CameraPicture, OpenOptions, Session};
use belvedere_core::Warning;
use std::path::PathBuf;

/// How a picture or a frame is drawn.
///
/// # Errors
/// [`BelvedereError::NoRenderer`], [`BelvedereError::Appearance`].
pub fn picture_of(asked: &Drawing) -> Result<PictureOptions, BelvedereError> {
    renderers::check(&asked.renderer)?;
    let mut options = PictureOptions {
        straight: asked.straight,
        compare: asked.compare,
        renderer: asked.renderer.clone(),
        ..PictureOptions::default()
    };
    let quality = &mut options.quality;
    quality.samples = asked.samples.unwrap_or(quality.samples);
    quality.lod_px = asked.lod.unwrap_or(quality.lod_px);
    quality.exposures = asked.thresholds.unwrap_or(THRESHOLDS).div_ceil(quality.samples.max(1));
    quality.compositing = asked.compositing.unwrap_or_default();
    let strengths = asked.stylise.as_ref().map(|stylise| stylise.strengths()).transpose();
    options.stylisation = strengths.map_err(|(_, reason)| BelvedereError::Appearance { option: "stylise", reason })?;
    Ok(options)
}

/// A scene, opened with what a picture is asked to show otherwise than it says; how the picture is drawn; and warnings about places that are
/// asked for.
///
/// # Errors
/// As [`picture`] and [`Session::from_document`]; [`BelvedereError::Paper`].
pub fn opened(
    source: SourceDocument,
    asked: &Render,
    open: OpenOptions,
) -> Result<(Session, PictureOptions, Vec<Warning>), BelvedereError> {
    let (sheet, image) = paper((&asked.paper, asked.drawing.size), &source.document)?;
    foreseen(asked)?;
    let session = Session::from_document(source, &OpenOptions { image, ..open.showing(asked) })?;
    let (options, warnings) = picture(asked, &session)?;
    Ok((session, sheet.map_or(options.clone(), |sheet| options.on(sheet)), warnings))
}

/// A picture of a session, which was opened with [`OpenOptions::showing`]; and warnings about places that are asked for.
///
/// # Errors
/// As [`picture_of`]; [`BelvedereError::Argument`] for two pictures of the camera, [`BelvedereError::Position`].
pub fn picture(asked: &Render, session: &Session) -> Result<(PictureOptions, Vec<Warning>), BelvedereError> {
    let (mut options, mut warnings) = (foreseen(asked)?, Vec::new());
    if let Some(Outside::From(places)) = &asked.outside {
        let mut found = [[0.0; 3]; 2];
        for (to, place) in found.iter_mut().zip(places) {
            let (p, said) = session.find_place(place, "outside")?;
            *to = p.to_array();
            warnings.extend(said);
        }
        options.camera = Some(CameraPicture::Outside(Some(found)));
    }
    Ok((options, warnings))
}

/// The same before the scene is opened, without what depends on it: places. It tells mistakes, and the files that will be written.
///
/// # Errors
/// As [`picture_of`]; [`BelvedereError::Argument`] for two pictures of the camera.
pub fn foreseen(asked: &Render) -> Result<PictureOptions, BelvedereError> {
    let grid = match asked.grid {
        Some(SwitchOrLength::Switch(true)) => Some(None),
        Some(SwitchOrLength::Length(spacing)) => Some(Some(spacing)),
        Some(SwitchOrLength::Switch(false)) | None => None,
    };
    let is_outside = asked.outside.is_some_and(|outside| outside.is_asked());
    if asked.overhead && is_outside {
        let text = "{} and {} are two pictures of the camera; give one of them";
        return Err(BelvedereError::Argument(Advice::new(text, &["overhead", "outside"])));
    }
    Ok(PictureOptions {
        aux: asked.aux.clone(),
        aux_format: asked.aux_format.unwrap_or_default(),
        grid,
        heatmap: asked.heatmap,
        ghost: asked.ghost,
        highlight: asked.highlight.clone(),
        no_mark: asked.no_mark,
        camera: asked
            .overhead
            .then_some(CameraPicture::Overhead)
            .or(is_outside.then_some(CameraPicture::Outside(None))),
        band_rows: asked.band_rows.map(|rows| rows as usize),
        ..picture_of(&asked.drawing)?
    })
}

/// The paper that is asked for beside that of a scene, and the size of the picture in pixels where one of the two states it.
///
/// # Errors
/// [`BelvedereError::Paper`]; not of the scene's own paper, of which opening the scene tells the line.
pub fn paper(
    (asked, size): (&Paper, Option<[u32; 2]>),
    scene: &Document,
) -> Result<(Option<Sheet>, Option<[u32; 2]>), BelvedereError> {
    let (own, shape) = (scene.print.as_ref(), scene.camera.image);
    if own.is_some_and(|own| Sheet::of(own, None, shape).is_err()) {
        return Ok((None, size));
    }
    let sheet = Sheet::asked(&asked.document(), own, size, shape)?;
    Ok((sheet, sheet.map(|sheet| sheet.pixels()).or(size)))
}

/// A film into `out`, see [`AnimateRequest::out`].
///
/// # Errors
/// As [`picture_of`].
pub fn film(
    asked: &Animate,
    sheet: Option<Sheet>,
    out: PathBuf,
    overwrite: bool,
) -> Result<AnimateRequest, BelvedereError> {
    let picture = picture_of(&asked.drawing)?;
    Ok(AnimateRequest {
        animation: asked.motion(),
        picture: sheet.map_or(picture.clone(), |sheet| picture.on(sheet)),
        out,
        resume: asked.resume,
        overwrite,
        part: asked.part.map(|[first, last]| first..=last),
    })
}

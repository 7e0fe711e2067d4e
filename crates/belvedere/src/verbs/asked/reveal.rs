//! `reveal` as it is asked for: one request for terrain with features, cities and models.

use crate::picture::{Picture, PictureOptions};
use crate::places::Place;
use crate::print::Sheet;
use crate::renderers;
use crate::request::{Molecules, Reveal, given_of};
use crate::scene_file::{self, PaletteDoc};
use crate::verbs::appearance::Appearance;
use crate::verbs::drafts::DraftsAnswer;
use crate::verbs::hold_a_city;
use crate::verbs::reveal::{IMAGE, RevealAnswer, RevealDocument, RevealFiles, RevealRequest, Technique};
use crate::verbs::reveal_target::{self, TargetAnswer, TargetDocument, TargetRequest};
use crate::verbs::target_drafts::target_drafts;
use crate::{Advice, BelvedereError, DataFiles, OpenOptions, Session, Warning, verbs};
use belvedere_core::DVec3;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What a request leaves to its caller.
#[derive(Debug, Clone, Default)]
pub struct Setting {
    /// How scenes are opened.
    pub open: OpenOptions,
    /// Threads, memory and vectors of the picture.
    pub picture: PictureOptions,
    /// As [`RevealRequest::to_file`].
    pub to_file: Option<PathBuf>,
}

/// A picture in which something is visible, and how it was found.
#[derive(Debug, Clone)]
pub enum Revealed {
    /// Features of terrain.
    Features(Box<RevealAnswer>),
    /// A part of models or of a city.
    Target(Box<TargetAnswer>),
}

/// The figures of an answer, as JSON has them.
#[derive(Serialize)]
#[serde(untagged)]
#[allow(clippy::large_enum_variant)] // one at a time, to be written
pub enum RevealedDocument<'a> {
    /// Of features.
    Features(RevealDocument<'a>),
    /// Of a target.
    Target(TargetDocument<'a>),
}

/// Shows what is asked for.
///
/// # Errors
/// [`BelvedereError::Argument`] for options that do not go together, else as
/// [`verbs::reveal::reveal`] and [`reveal_target::reveal_target`].
pub fn reveal(asked: &Reveal, setting: &Setting) -> Result<Revealed, BelvedereError> {
    let open = opened(asked, setting);
    Ok(match Request::of(asked, setting)? {
        Request::Features(request) => Revealed::Features(verbs::reveal::reveal(&request, &open)?.into()),
        Request::Target(request) => Revealed::Target(reveal_target::reveal_target(&request, &open)?.into()),
    })
}

/// Up to `count` drafts of what is asked for, from different sides.
///
/// # Errors
/// As [`reveal()`], [`verbs::drafts::drafts`] and [`target_drafts`].
pub fn drafts(asked: &Reveal, count: usize, setting: &Setting) -> Result<DraftsAnswer, BelvedereError> {
    let open = opened(asked, setting);
    match Request::of(asked, setting)? {
        Request::Features(request) => verbs::drafts::drafts(&request, count, &open),
        Request::Target(request) => target_drafts(&request, count, &open),
    }
}

/// Whether a part of models or of a city is asked for rather than features of terrain.
pub fn is_of_models(asked: &Reveal) -> bool {
    asked.see.is_some() || hold_a_city(&files(asked))
}

/// Paper of the picture, and its size in pixels.
///
/// # Errors
/// [`BelvedereError::Paper`].
pub fn sheet(asked: &Reveal) -> Result<(Option<Sheet>, [u32; 2]), BelvedereError> {
    let shape = asked.size.or_else(|| size_of_scene(Path::new(&asked.data))).unwrap_or(IMAGE);
    let sheet = Sheet::asked(&asked.paper.document(), None, asked.size, shape)?;
    Ok((sheet, sheet.map_or(shape, |sheet| sheet.pixels())))
}

fn files(asked: &Reveal) -> Vec<PathBuf> {
    [&asked.data].into_iter().chain(&asked.features).map(PathBuf::from).collect()
}

/// Size of the picture of a scene file; `None` for other data.
fn size_of_scene(data: &Path) -> Option<[u32; 2]> {
    let is_scene = data.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let text = is_scene.then(|| std::fs::read_to_string(data).ok())??;
    scene_file::parse(data, &text).ok().map(|source| source.document.camera.image)
}

fn opened(asked: &Reveal, setting: &Setting) -> OpenOptions {
    let open = OpenOptions { molecule: asked.appearance.molecules.clone(), ..setting.open.clone() };
    open.airy(&asked.appearance.air)
}

/// A request of one of the two searches.
enum Request {
    Features(Box<RevealRequest>),
    Target(Box<TargetRequest>),
}

impl Request {
    fn of(asked: &Reveal, setting: &Setting) -> Result<Self, BelvedereError> {
        let models = is_of_models(asked);
        check(asked, models)?;
        let (sheet, _) = sheet(asked)?;
        let mut picture = setting.picture.clone();
        renderers::check(&asked.renderer)?;
        picture.renderer = asked.renderer.clone();
        picture.quality.samples = asked.samples.unwrap_or(picture.quality.samples);
        let picture = match sheet {
            Some(sheet) => picture.on(sheet),
            None => picture,
        };
        let image = sheet.map(|sheet| sheet.pixels()).or(asked.size);
        let places: Option<[Place; 2]> = asked.eye.zip(asked.look).map(|(eye, look)| [eye, look]);
        let appearance = Appearance::from(&asked.appearance);
        if models {
            return Ok(Self::Target(Box::new(TargetRequest {
                files: files(asked),
                see: asked.see.clone().unwrap_or_default(),
                fallback: asked.fallback.clone(),
                transfer: asked.transfer.clone(),
                up: asked.up.map(DVec3::from_array),
                technique: asked.technique.filter(|technique| *technique != Technique::Auto),
                fov_y_deg: asked.fov,
                viewpoint: None,
                places,
                image,
                picture,
                appearance,
            })));
        }
        Ok(Self::Features(Box::new(RevealRequest {
            data: data(asked),
            curved_earth: asked.curved_earth,
            technique: asked.technique.unwrap_or_default(),
            no_limits: asked.no_limits,
            to_file: setting.to_file.clone(),
            fov_y_deg: asked.fov,
            viewpoint: None,
            places,
            image,
            picture,
            appearance,
        })))
    }
}

/// Refuses options that do not go together.
fn check(asked: &Reveal, models: bool) -> Result<(), BelvedereError> {
    let refused = |advice| Err(BelvedereError::Argument(advice));
    let not_here: &[(&[&'static str], &str)] = match models {
        true => &[(&Reveal::OF_TERRAIN, "for terrain with features, not for models and cities")],
        false => &[
            (&Reveal::OF_MODELS, "for a part of a model or city, and none is asked for"),
            (&Molecules::OPTIONS, "for molecules, and there is none"),
        ],
    };
    for (options, what) in not_here {
        let given = given_of(asked, options);
        if !given.is_empty() {
            return refused(Advice::of_options(&given, what));
        }
    }
    let alone = |names| refused(Advice::new("{} is given without {}; give both, or neither", names));
    match (asked.eye, asked.look) {
        (Some(_), None) => return alone(&["eye", "look"]),
        (None, Some(_)) => return alone(&["look", "eye"]),
        _ => {}
    }
    if models && matches!(asked.technique, Some(Technique::Terrain | Technique::Both)) {
        let text = "{} of a part of a model or city is curved_rays or spline; give one of them, or leave it out";
        return refused(Advice::new(text, &["technique"]));
    }
    Ok(())
}

fn data(asked: &Reveal) -> DataFiles {
    DataFiles {
        dem: asked.data.clone(),
        features: asked.features.clone(),
        rivers: asked.rivers.clone(),
        crs: asked.crs.clone(),
        keep_voids: asked.keep_voids,
        fill_all_voids: asked.fill_voids,
        drape: asked.drape.clone(),
        labels: asked.labels,
        hidden: asked.appearance.hidden,
        palette: asked.palette.as_deref().map(PaletteDoc::of).unwrap_or_default(),
        no_sea: asked.no_sea,
        area_style: asked.area_style,
        stated: asked.stated.clone(),
    }
}

impl Revealed {
    /// Scene and bent view.
    pub fn session(&self) -> &Session {
        match self {
            Self::Features(answer) => &answer.session,
            Self::Target(answer) => &answer.session,
        }
    }

    /// Both pictures.
    pub fn picture(&self) -> &Picture {
        match self {
            Self::Features(answer) => &answer.picture,
            Self::Target(answer) => &answer.picture,
        }
    }

    /// One sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Features(answer) => answer.summary(),
            Self::Target(answer) => answer.summary(),
        }
    }

    /// Warnings of loading, searching and drawing.
    pub fn warnings(&self) -> Vec<Warning> {
        match self {
            Self::Features(answer) => [answer.session.warnings(), answer.picture.sidecar.of_picture.clone()].concat(),
            Self::Target(answer) => answer.warnings(),
        }
    }

    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> Vec<String> {
        match self {
            Self::Features(answer) => answer.missed().to_vec(),
            Self::Target(answer) => answer.missed(),
        }
    }

    /// Figures of the answer.
    pub fn document(&self) -> RevealedDocument<'_> {
        match self {
            Self::Features(answer) => RevealedDocument::Features(answer.document()),
            Self::Target(answer) => RevealedDocument::Target(answer.document()),
        }
    }

    /// Writes the picture with its record, the pair if it differs from the straight one, and the other files that are named.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        match self {
            Self::Features(answer) => answer.write(files, overwrite),
            Self::Target(answer) => answer.write(files, overwrite),
        }
    }
}

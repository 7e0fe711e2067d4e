//! What is asked for, read: one request for terrain with features, cities and models.

use super::appearance::Appearance;
use super::given::{Given, hold_a_city};
use crate::picture::PictureOptions;
use crate::places::Place;
use crate::print::Sheet;
use crate::renderers;
use crate::request::{Molecules, Reveal, Technique, given_of};
use crate::scene_file::{self, PaletteDoc};
use crate::verbs::found_view::IMAGE;
use crate::{Advice, BelvedereError, DataFiles, OpenOptions};
use std::path::{Path, PathBuf};

/// What a request leaves to its caller.
#[derive(Debug, Clone, Default)]
pub struct Setting {
    /// How scenes are opened.
    pub open: OpenOptions,
    /// Threads, memory and vectors of the picture.
    pub picture: PictureOptions,
    /// The file that the picture is for, if it goes into one and nowhere else: a picture that is too large for one piece is then drawn in bands
    /// while it is written, see [`crate::Session::render_to`], and has no pair beside it.
    pub to_file: Option<PathBuf>,
}

impl From<OpenOptions> for Setting {
    fn from(open: OpenOptions) -> Self {
        Self { open, ..Self::default() }
    }
}

/// A request that was read.
#[derive(Clone)]
pub(super) struct Request<'a> {
    pub(super) asked: &'a Reveal,
    /// Terrain, models or a city, and features.
    pub(super) given: Vec<Given>,
    /// Whether a part of models or of a city is asked for.
    pub(super) models: bool,
    pub(super) open: OpenOptions,
    pub(super) picture: PictureOptions,
    pub(super) appearance: Appearance,
    /// Size of the picture, pixels; that of its paper, if it has one.
    pub(super) image: Option<[u32; 2]>,
    /// Width over height of the picture on its paper, whose pixels are rounded.
    pub(super) aspect: Option<f64>,
    /// Eye and point looked at.
    pub(super) places: Option<[Place; 2]>,
    /// Full vertical field of view, degrees.
    pub(super) fov_y_deg: Option<f64>,
    /// As [`Setting::to_file`].
    pub(super) to_file: Option<PathBuf>,
}

impl<'a> Request<'a> {
    pub(super) fn of(asked: &'a Reveal, setting: &Setting) -> Result<Self, BelvedereError> {
        let files = [&asked.data].into_iter().chain(&asked.features).map(PathBuf::from);
        let given: Vec<Given> = files.map(|name| Given::of(name, &setting.open.arrays)).collect();
        let models = asked.see.is_some() || hold_a_city(&given);
        check(asked, models)?;
        let (sheet, _) = sheet(asked)?;
        renderers::check(&asked.renderer)?;
        let mut picture = PictureOptions { renderer: asked.renderer.clone(), ..setting.picture.clone() };
        picture.quality.samples = asked.samples.unwrap_or(picture.quality.samples);
        let open = OpenOptions { molecule: asked.appearance.molecules.clone(), ..setting.open.clone() };
        Ok(Self {
            asked,
            given,
            models,
            open: open.airy(&asked.appearance.air),
            picture: match sheet {
                Some(sheet) => picture.on(sheet),
                None => picture,
            },
            appearance: Appearance::from(&asked.appearance),
            image: sheet.map(|sheet| sheet.pixels()).or(asked.size),
            aspect: sheet.map(|sheet| sheet.picture_mm()).map(|[width, height]| width / height),
            places: asked.eye.zip(asked.look).map(|(eye, look)| [eye, look]),
            fov_y_deg: asked.fov,
            to_file: setting.to_file.clone(),
        })
    }

    /// Full vertical field of view, radians.
    ///
    /// * `usual`: that of pictures for which none is given, degrees.
    ///
    /// # Errors
    /// [`BelvedereError::FieldOfView`].
    pub(super) fn fov_y(&self, usual: f64) -> Result<f64, BelvedereError> {
        let deg = self.fov_y_deg.unwrap_or(usual);
        if deg > 0.0 && deg < 180.0 { Ok(deg.to_radians()) } else { Err(BelvedereError::FieldOfView { deg }) }
    }

    /// What must be seen; empty: all features.
    pub(super) fn see(&self) -> &str {
        self.asked.see.as_deref().unwrap_or_default()
    }

    pub(super) fn technique(&self) -> Technique {
        self.asked.technique.unwrap_or_default()
    }

    /// The files of terrain and features.
    pub(super) fn data(&self) -> DataFiles {
        data(self.asked)
    }
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

/// Size of the picture of a scene file; `None` for other data.
fn size_of_scene(data: &Path) -> Option<[u32; 2]> {
    let is_scene = data.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let text = is_scene.then(|| std::fs::read_to_string(data).ok())??;
    scene_file::parse(data, &text).ok().map(|source| source.document.camera.image)
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
        first_is_subject: true,
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
        line_class: asked.line_class.clone(),
        stated: asked.stated.clone(),
    }
}

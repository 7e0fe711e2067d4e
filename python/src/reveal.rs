//! `reveal`: terrain and features, or a target in models and cities, to a picture in which they are visible.

use crate::errors::wrong;
use crate::picture::NativePicture;
use crate::request::{self, Drawing, Opening};
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::answers;
use belvedere::core::DVec3;
use belvedere::scene::{Hidden, Relief};
use belvedere::scene_file::{LightDoc, PaletteDoc, StylisationDoc, SurfaceDoc, VerticalUnit};
use belvedere::verbs::appearance::Appearance;
use belvedere::verbs::drafts::drafts as drafted;
use belvedere::verbs::hold_a_city;
use belvedere::verbs::reveal::{self as verb, RevealAnswer, RevealFiles, RevealRequest, Technique};
use belvedere::verbs::reveal_target::{TargetAnswer, TargetRequest, reveal_target};
use belvedere::{BelvedereError, DataFiles, Picture, Session, output};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Deserialize;
use std::path::PathBuf;

/// Techniques by name.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum TechniqueName {
    Auto,
    Spline,
    Terrain,
    Both,
    CurvedRays,
}

impl From<TechniqueName> for Technique {
    fn from(name: TechniqueName) -> Self {
        match name {
            TechniqueName::Auto => Self::Auto,
            TechniqueName::Spline => Self::Spline,
            TechniqueName::Terrain => Self::Terrain,
            TechniqueName::Both => Self::Both,
            TechniqueName::CurvedRays => Self::CurvedRays,
        }
    }
}

/// Files of terrain and features, and what they do not say themselves.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Files {
    dem: String,
    features: Vec<String>,
    rivers: Vec<String>,
    crs: Option<String>,
    keep_voids: bool,
    fill_voids: bool,
    drape: Vec<String>,
    labels: bool,
    hidden: Option<Hidden>,
    palette: Option<String>,
    no_sea: bool,
    area_style: Option<SurfaceDoc>,
    source_crs: Option<String>,
    nodata: Option<f64>,
    vertical_unit: Option<VerticalUnit>,
    name_field: Option<String>,
}

impl Files {
    /// The files as the facade takes them.
    pub(crate) fn data(self) -> DataFiles {
        DataFiles {
            dem: self.dem,
            features: self.features,
            rivers: self.rivers,
            crs: self.crs,
            keep_voids: self.keep_voids,
            fill_all_voids: self.fill_voids,
            drape: self.drape,
            labels: self.labels,
            hidden: self.hidden,
            palette: PaletteDoc::of(self.palette.as_deref().unwrap_or("auto")),
            no_sea: self.no_sea,
            area_style: self.area_style,
            source_crs: self.source_crs,
            nodata: self.nodata,
            vertical_unit: self.vertical_unit,
            name_field: self.name_field,
        }
    }
}

/// Light and look of the picture.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Look {
    light: Option<LightDoc>,
    relief: Option<Relief>,
    stylise: Option<StylisationDoc>,
    no_mark: bool,
    furniture: Option<Vec<String>>,
    title: Option<String>,
    exaggeration: Option<f64>,
}

impl Look {
    fn appearance(self) -> PyResult<Appearance> {
        let furniture = request::furniture(self.furniture.as_deref(), self.title.as_deref())?;
        let Self { light, relief, stylise: stylisation, no_mark, exaggeration, .. } = self;
        Ok(Appearance { light, relief, stylisation, no_mark, furniture, exaggeration, ..Appearance::default() })
    }
}

/// What is asked for.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Asked {
    files: Files,
    look: Look,
    /// Target in models or in a city, see `TargetRequest`.
    see: Option<String>,
    fallback: Vec<String>,
    transfer: Option<String>,
    up: Option<[f64; 3]>,
    eye: Option<String>,
    look_at: Option<String>,
    fov_y_deg: Option<f64>,
    size: Option<[u32; 2]>,
    curved_earth: bool,
    technique: Option<TechniqueName>,
    no_limits: bool,
    draw: Drawing,
    open: Opening,
}

impl Asked {
    /// The request for features of terrain.
    fn of_features(self) -> PyResult<RevealRequest> {
        Ok(RevealRequest {
            data: self.files.data(),
            places: request::places(self.eye.as_deref(), self.look_at.as_deref())?,
            appearance: self.look.appearance()?,
            fov_y_deg: self.fov_y_deg,
            image: self.size,
            curved_earth: self.curved_earth,
            technique: self.technique.map_or(Technique::Spline, Into::into),
            no_limits: self.no_limits,
            picture: self.draw.options(Default::default())?,
            ..RevealRequest::default()
        })
    }
}

/// Views from several sides: their numbers and warnings as JSON, and width and colours (RGB) of the sheet.
#[pyfunction]
pub(crate) fn drafts(py: Python<'_>, asked: &str, count: usize, ask: Ask) -> PyResult<(String, usize, Py<PyBytes>)> {
    let asked: Asked = request::read("drafts", asked)?;
    let open = asked.open.clone();
    let request = asked.of_features()?;
    let (numbers, width, colors) = run(py, &ask, move |progress| {
        let found = drafted(&request, count, &open.options(progress))?;
        let (width, _, colors) = found.sheet();
        let numbers = serde_json::json!({ "drafts": found.drafts, "warnings": found.warnings });
        Ok((output::json(&numbers)?, width, colors))
    })?;
    Ok((numbers, width, PyBytes::new(py, colors.as_flattened()).unbind()))
}

/// A picture in which something is visible, and how it was found.
enum Answer {
    Features(Box<RevealAnswer>),
    Target(Box<TargetAnswer>),
}

impl Answer {
    fn session(&self) -> &Session {
        match self {
            Self::Features(answer) => &answer.session,
            Self::Target(answer) => &answer.session,
        }
    }

    fn picture(&self) -> &Picture {
        match self {
            Self::Features(answer) => &answer.picture,
            Self::Target(answer) => &answer.picture,
        }
    }

    fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        output::check_all(&files.all(), &self.session().input_paths(), overwrite)?;
        match self {
            Self::Features(answer) => answer.write(files, overwrite),
            Self::Target(answer) => answer.write(files, overwrite),
        }
    }
}

/// Result of [`reveal`].
#[pyclass(frozen)]
pub(crate) struct NativeReveal {
    answer: std::sync::Arc<Answer>,
    report: String,
}

#[pymethods]
impl NativeReveal {
    /// Scene and bent view.
    fn scene(&self) -> NativeScene {
        NativeScene { session: self.answer.session().clone() }
    }

    /// Both pictures.
    fn picture(&self) -> NativePicture {
        NativePicture::of(self.answer.session(), self.answer.picture().clone())
    }

    /// The report, JSON.
    #[getter]
    fn report(&self) -> &str {
        &self.report
    }

    /// One sentence.
    fn summary(&self) -> String {
        match &*self.answer {
            Answer::Features(answer) => answer.summary(),
            Answer::Target(answer) => answer.summary(),
        }
    }

    /// Goals that were missed, one sentence each.
    fn missed(&self) -> Vec<String> {
        match &*self.answer {
            Answer::Features(answer) => answer.missed().to_vec(),
            Answer::Target(answer) => answer.missed(),
        }
    }

    /// Writes the picture with its record and the pair, and the other files that are named; returns their paths.
    fn save(
        &self,
        py: Python<'_>,
        out: PathBuf,
        before: Option<PathBuf>,
        report: Option<PathBuf>,
        scene: Option<PathBuf>,
        overwrite: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let answer = self.answer.clone();
        let files = RevealFiles { out, before, report, scene };
        run(py, &Ask::default(), move |_| answer.write(&files, overwrite))
    }
}

/// Chooses a view (unless it is given) and a bend, and draws the picture.
#[pyfunction]
pub(crate) fn reveal(py: Python<'_>, asked: &str, ask: Ask) -> PyResult<NativeReveal> {
    let mut asked: Asked = request::read("reveal", asked)?;
    let files: Vec<PathBuf> = [&asked.files.dem].into_iter().chain(&asked.files.features).map(PathBuf::from).collect();
    let open = std::mem::take(&mut asked.open);
    if asked.see.is_none() && !hold_a_city(&files) {
        let request = asked.of_features()?;
        let (answer, report) = run(py, &ask, move |progress| {
            let answer = verb::reveal(&request, &open.options(progress))?;
            let report = answers::in_file("reveal", &[], &answer.document())?;
            Ok((answer, report))
        })?;
        return Ok(NativeReveal { answer: Answer::Features(Box::new(answer)).into(), report });
    }
    if matches!(asked.technique, Some(TechniqueName::Terrain | TechniqueName::Both)) {
        return Err(wrong(
            "technique: targets in models and cities are shown by \"curved_rays\" or \"spline\"; give one of them, or None",
        ));
    }
    let places = request::places(asked.eye.as_deref(), asked.look_at.as_deref())?;
    let picture = asked.draw.options(Default::default())?;
    let appearance = std::mem::take(&mut asked.look).appearance()?;
    let technique = asked.technique.filter(|name| !matches!(name, TechniqueName::Auto));
    let request = TargetRequest {
        files,
        see: asked.see.unwrap_or_default(),
        fallback: asked.fallback,
        transfer: asked.transfer,
        places,
        appearance,
        fov_y_deg: asked.fov_y_deg,
        up: asked.up.map(DVec3::from_array),
        image: asked.size,
        technique: technique.map(Into::into),
        picture,
        ..TargetRequest::default()
    };
    let (answer, report) = run(py, &ask, move |progress| {
        let answer = reveal_target(&request, &open.options(progress))?;
        let report = answers::in_file("reveal", &[], &answer.document())?;
        Ok((answer, report))
    })?;
    Ok(NativeReveal { answer: Answer::Target(Box::new(answer)).into(), report })
}

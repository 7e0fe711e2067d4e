//! A picture in which something is visible, how it was found, and both in words and figures.

use super::files::RevealFiles;
use super::{RefitRecord, Technique};
use crate::fallback::{FallbackRecord, has_volumes};
use crate::picture::{DisplacementReport, Picture, TargetPlace, TerrainRecord};
use crate::record::{InputFile, ViewRecord};
use crate::{BelvedereError, Session};
use belvedere_construct::measure::{HiddenRun, Shares};
use belvedere_construct::rays::BendReport;
use belvedere_construct::reveal::thresholds::{ENOUGH, NOTHING_HIDDEN};
use belvedere_construct::{Goal, RevealReport};
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainReport;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// A technique that was tried.
#[derive(Debug, Clone, Copy, JsonSchema, Serialize)]
pub struct Tried {
    /// The technique.
    pub technique: Technique,
    /// Visible share of the whole features in its picture.
    pub visible: f64,
    /// Share of the whole features inside its picture.
    pub in_frame: f64,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Whether its time limit ended it early.
    pub out_of_time: bool,
}

/// Shares of the whole features in both pictures, by lines of sight through the whole chain of stages.
#[derive(Debug, Clone, Copy, Default, JsonSchema, Serialize)]
pub struct FinalShares {
    /// Technique that bends the picture; `None` if it is straight, because nothing is hidden or no bend makes a better picture.
    pub technique: Option<Technique>,
    /// Visible share in the straight picture, 0..=1.
    pub visible_straight: f64,
    /// Visible share in the bent picture.
    pub visible_bent: f64,
    /// Share inside the straight picture, hidden or not.
    pub in_frame_straight: f64,
    /// Share inside the bent picture, hidden or not.
    pub in_frame_bent: f64,
}

impl FinalShares {
    pub(super) fn of(technique: Option<Technique>, [straight, bent]: [Shares; 2]) -> Self {
        Self {
            technique,
            visible_straight: straight.visible,
            visible_bent: bent.visible,
            in_frame_straight: straight.in_frame,
            in_frame_bent: bent.in_frame,
        }
    }

    /// Shares in the straight and in the bent picture.
    pub fn both(&self) -> [Shares; 2] {
        [
            Shares { visible: self.visible_straight, in_frame: self.in_frame_straight },
            Shares { visible: self.visible_bent, in_frame: self.in_frame_bent },
        ]
    }
}

/// A picture in which something is visible, beside the straight one.
#[derive(Debug, Clone)]
pub struct RevealAnswer {
    /// Scene and bent view.
    pub session: Session,
    /// Both pictures; one of terrain if it is straight.
    pub picture: Picture,
    /// Shares of the whole subject in both pictures.
    pub shares: FinalShares,
    /// How it was found.
    pub found: Found,
}

/// How a picture was found.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant)] // one of each answer
pub enum Found {
    /// Features of terrain.
    Features {
        /// Report of the search for a view and a spline; its shares, gain and goal are those of the finished picture.
        report: RevealReport,
        /// Tried techniques, if the choice was automatic.
        tried: Vec<Tried>,
        /// Hidden stretches of the features in the picture.
        hidden: Vec<HiddenRun>,
        /// Factor of the sample spacing for the shares and `hidden`: 1, or more if time was short.
        measured_every: u32,
    },
    /// A part of models or of a city.
    Target {
        /// Report of the search.
        report: BendReport,
        /// Name of the target.
        see: String,
        /// Position of the target, if it is a point.
        place: Option<TargetPlace>,
        /// Kind of the target's mark in the pictures.
        mark: &'static str,
        /// Change of the frame after the bend was known; `None` where the camera was given, a spline bends, or the frame stayed.
        refit: Option<RefitRecord>,
    },
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

/// Content of the report file and of `--json`: features of terrain.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct RevealDocument<'a> {
    program: String,
    #[serde(flatten)]
    shares: FinalShares,
    /// Report of the search; its shares, gain and goal are those of the finished picture.
    #[serde(flatten)]
    report: RevealReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    disocclusion: Option<&'a TerrainReport>,
    /// Tried techniques.
    #[serde(skip_serializing_if = "<[Tried]>::is_empty")]
    tried: &'a [Tried],
    /// Hidden stretches of the features in the picture.
    hidden: &'a [HiddenRun],
    measured_every: u32,
    displacement: Option<DisplacementReport>,
    view: &'a ViewRecord,
    crs: String,
    terrain: Option<TerrainRecord>,
    inputs: &'a [InputFile],
    scene_warnings: &'a [Warning],
}

/// Content of the report file and of `--json`: a part of a model or city.
#[derive(Debug, JsonSchema, Serialize)]
pub struct TargetDocument<'a> {
    program: &'a str,
    see: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: &'a Option<TargetPlace>,
    /// Visible share in the bent picture, as `visible`.
    visible_bent: f64,
    /// Share inside the bent picture, hidden or not, as `in_frame`.
    in_frame_bent: f64,
    #[serde(flatten)]
    report: BendReport,
    technique: Option<Technique>,
    /// Change of the frame after the bend was known, so that all of the bent model lies inside; left out where the frame stayed, as it does
    /// where the camera is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    refit: Option<RefitRecord>,
    /// Report of the fallback; left out if none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    fallback: &'a Option<FallbackRecord>,
    mark: &'static str,
    view: &'a ViewRecord,
    inputs: &'a [InputFile],
    warnings: Vec<Warning>,
}

impl RevealAnswer {
    /// One sentence: what is visible, straight and bent.
    pub fn summary(&self) -> String {
        match &self.found {
            Found::Features { .. } => self.words_of_features(),
            Found::Target { report, place, .. } => {
                let place = place.as_ref().map_or_else(String::new, |p| format!("; {p}"));
                let fallback = self.picture.sidecar.fallback.as_ref().map_or_else(String::new, |f| format!("; {f}"));
                self.words_of_target(report) + &place + &fallback
            }
        }
    }

    fn words_of_features(&self) -> String {
        let [straight, bent] = self.shares.both();
        if self.shares.technique.is_some() {
            return format!("visible in the straight picture: {straight}, in the bent one: {bent}");
        }
        let taller =
            if self.session.view().is_bent() { format!(", with exaggerated heights: {bent}") } else { String::new() };
        let reason = if bent.visible >= NOTHING_HIDDEN * bent.in_frame {
            "what is in the frame is not hidden, so nothing is bent"
        } else {
            "no bend that was tried makes a better picture"
        };
        format!("visible in the straight picture: {straight}{taller}; {reason}, and there is no pair of pictures")
    }

    fn words_of_target(&self, report: &BendReport) -> String {
        let &BendReport { visible_straight, visible, light_straight, light_best, tried, .. } = report;
        let of = |visible: f64, in_frame: f64| match in_frame < 1.0 {
            true => format!("{:.0} % ({:.0} % in the frame)", 100.0 * visible, 100.0 * in_frame),
            false => format!("{:.0} %", 100.0 * visible),
        };
        let straight = of(visible_straight, report.in_frame_straight);
        if tried > 0 && visible < ENOUGH && visible <= visible_straight {
            let percent = |share: f64| format!("{:.0} %", 100.0 * share);
            let light = match has_volumes(self.session.scene()) {
                true => format!(
                    "; {} of its light comes through straight, {} at best by a bend, half is needed",
                    percent(light_straight),
                    percent(light_best)
                ),
                false => String::new(),
            };
            return format!("no bend of {tried} shows more than the straight picture, {straight}{light}");
        }
        if tried == 0 || visible <= visible_straight {
            return format!("visible without any bend: {straight}");
        }
        format!("visible in the straight picture: {straight}, in the bent one: {}", of(visible, report.in_frame))
    }

    /// Warnings of loading, searching and drawing.
    pub fn warnings(&self) -> Vec<Warning> {
        let of_picture = self.picture.sidecar.of_picture.iter().cloned();
        self.session.warnings().into_iter().chain(of_picture).chain(self.of_place()).collect()
    }

    /// The warning about the place of a target.
    fn of_place(&self) -> Option<Warning> {
        match &self.found {
            Found::Target { place, .. } => place.as_ref()?.warning(),
            Found::Features { .. } => None,
        }
    }

    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> Vec<String> {
        let place = match &self.found {
            Found::Features { report, .. } => {
                return match &report.goal {
                    Goal::Reached => Vec::new(),
                    Goal::Missed(reasons) => reasons.clone(),
                };
            }
            Found::Target { place, .. } => place,
        };
        let fallback = self.picture.sidecar.fallback.as_ref();
        let visible = fallback.map_or(self.shares.visible_bent, |fallback| fallback.visible);
        if visible >= ENOUGH {
            return Vec::new();
        }
        let text = format!("{:.0} % of what was looked for is visible, 99 % were wanted", 100.0 * visible);
        [text].into_iter().chain(place.as_ref().and_then(TargetPlace::why)).collect()
    }

    /// Figures of the answer.
    pub fn document(&self) -> RevealedDocument<'_> {
        let sidecar = self.picture.record();
        match &self.found {
            Found::Features { report, tried, hidden, measured_every } => RevealedDocument::Features(RevealDocument {
                program: sidecar.program.clone(),
                shares: self.shares,
                report: RevealReport { warnings: sidecar.warnings.clone(), ..report.clone() },
                disocclusion: self.session.terrain_report(),
                tried,
                hidden,
                measured_every: *measured_every,
                displacement: sidecar.displacement,
                view: &sidecar.view,
                crs: self.session.scene().crs.to_string(),
                terrain: sidecar.terrain.clone(),
                inputs: &sidecar.inputs,
                scene_warnings: &sidecar.warnings,
            }),
            Found::Target { report, see, place, mark, refit } => RevealedDocument::Target(TargetDocument {
                program: &sidecar.program,
                see: super::subject::shown_name(see),
                target: place,
                visible_bent: report.visible,
                in_frame_bent: report.in_frame,
                report: *report,
                technique: self.shares.technique,
                refit: *refit,
                fallback: &sidecar.fallback,
                mark,
                view: &sidecar.view,
                inputs: &sidecar.inputs,
                warnings: sidecar.warnings.iter().cloned().chain(self.of_place()).collect(),
            }),
        }
    }

    /// Writes the picture with its record, the pair (`OUT.pair.png`) if it differs from the straight one, and the other files that are named.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        files.write(&self.picture, &self.session, &|| self.document(), overwrite)
    }
}

//! The manifest of a folder of frames, by which an interrupted animation is resumed.

use super::overlay::MarkerRecord;
use crate::camera_path::CameraPath;
use crate::output;
use crate::picture::{DisplacementReport, PictureOptions};
use crate::record::{self, InputFile, ViewRecord};
use crate::scene_file::{AnimationDoc, Document};
use crate::{BelvedereError, Session};
use belvedere_disocclusion::TerrainReport;
use belvedere_resolve::constructor::ConstructorReport;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The record of a folder of frames. Same scene and request, same bytes, whether drawn at once or in parts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Program and version.
    pub program: String,
    /// sha256 of the resolved scene without its animation, hexadecimal.
    pub scene_sha256: String,
    /// Files that were read: names relative to the scene, or bare names, and hashes.
    pub inputs: Vec<InputFile>,
    /// Settings of the frames.
    pub settings: Settings,
    /// Number of finished frames.
    pub done: usize,
    /// One entry per frame, `None` for frames that are not finished.
    pub frames: Vec<Option<FrameRecord>>,
}

/// Settings on which the bytes of the frames depend, besides the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The animation with every default filled in.
    pub animation: AnimationDoc,
    /// Frames per second.
    pub fps: f64,
    /// Width and height, pixels.
    pub image: [u32; 2],
    /// Coverage samples per pixel.
    pub samples: u32,
    /// Worst error of bent edges, pixels.
    pub tolerance_px: f64,
    /// Worst error of terrain drawn with level of detail, pixels.
    pub lod_px: f64,
    /// Name of the renderer.
    pub renderer: String,
    /// Whether the view is drawn without bends.
    pub straight: bool,
    /// Whether the straight picture is drawn beside the bent one.
    pub compare: bool,
}

/// One frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameRecord {
    /// File in the folder.
    pub file: String,
    /// sha256 of the file, hexadecimal.
    pub sha256: String,
    /// The camera in numbers.
    pub view: ViewRecord,
    /// Displacement of the points in the picture; `None` for a straight picture.
    pub displacement: Option<DisplacementReport>,
    /// The ground around the eye; `None` without terrain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground: Option<FrameGround>,
    /// The mark at the walker, if it is asked for and he is in the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub marker: Option<MarkerRecord>,
    /// Report of the terrain solver, if it ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terrain: Option<FrameTerrain>,
    /// Report of the constructor of curved rays, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constructor: Option<ConstructorReport>,
}

/// How a frame sees the drawn ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrameGround {
    /// Height of the eye over the highest drawn ground within `needed_m` of it in plan, scene units; `None` where no ground is drawn there.
    pub clearance_m: Option<f64>,
    /// Least clearance, scene units: the distance to a corner of the near plane, and a quarter of a cell.
    pub needed_m: f64,
    /// Height by which the eye was lifted from its path, scene units.
    pub lifted_m: f64,
    /// Share of the strength of spline bends and curved rays that the frame carries, 0..=1.
    pub bend_share: f64,
    /// Height over the undisplaced ground of the walker that the camera was turned to, scene units.
    #[serde(default)]
    pub aimed_m: f64,
    /// Height over the undisplaced ground of the walker as drawn, scene units.
    #[serde(default)]
    pub walker_m: f64,
    /// Pixels of ground that were judged.
    pub pixels: usize,
    /// Those of them that show its lower side.
    pub from_below: usize,
}

impl FrameGround {
    /// Whether the frame shows the ground from above.
    pub fn is_clear(&self) -> bool {
        self.from_below == 0 && self.clearance_m.is_none_or(|c| c >= self.needed_m)
    }
}

/// The terrain of one frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrameTerrain {
    /// Reference points in view.
    pub points: usize,
    /// Visible share of them.
    pub visible: f64,
    /// Visible share of the features in view.
    pub visible_dense: f64,
    /// Share of them that is hidden only by ground nearer to them than the guard.
    #[serde(default)]
    pub hidden_in_guard: f64,
    /// Points that cannot be shown.
    pub unresolved: usize,
    /// Whether all that is required is guaranteed to be seen in this frame, see [`TerrainReport::guaranteed`].
    #[serde(default)]
    pub guaranteed: bool,
    /// Root mean square displacement, metres.
    pub rms_m: f64,
    /// Largest displacement, metres.
    pub max_m: f64,
    /// Root mean square change against the frame before, metres.
    pub frame_rms_m: f64,
    /// Largest change against the frame before, metres.
    pub frame_max_m: f64,
}

impl FrameTerrain {
    /// The figures of a report that are the same in every run.
    pub(super) fn of(report: &TerrainReport) -> Self {
        Self {
            points: report.points,
            visible: report.metrics.visible,
            visible_dense: report.metrics.visible_dense,
            hidden_in_guard: report.metrics.hidden_in_guard,
            unresolved: report.unresolved.iter().map(|r| r.points).sum(),
            guaranteed: report.guaranteed,
            rms_m: report.metrics.rms_m,
            max_m: report.metrics.max_m,
            frame_rms_m: report.metrics.frame.map_or(0.0, |f| f.rms_m),
            frame_max_m: report.metrics.frame.map_or(0.0, |f| f.max_m),
        }
    }
}

/// Name of the file of a frame.
pub fn frame_name(frame: usize) -> String {
    format!("frame_{frame:05}.png")
}

impl Manifest {
    /// The manifest of an animation without finished frames.
    pub(super) fn new(session: &Session, path: &CameraPath, request: &PictureOptions) -> Result<Self, BelvedereError> {
        let names = session.public_names();
        let document = session.public_document(&names).map(|document| Document { animation: None, ..document });
        Ok(Self {
            program: format!("belvedere {}", crate::VERSION),
            scene_sha256: belvedere_io::sha256(output::json(&document)?.as_bytes()),
            inputs: names.inputs(&record::inputs(&session.inputs())?),
            settings: Settings {
                animation: path.animation.clone(),
                fps: path.fps,
                image: session.view().pinhole().image,
                samples: request.quality.samples,
                tolerance_px: request.quality.tolerance_px,
                lod_px: request.quality.lod_px,
                renderer: session.renderer(&request.renderer)?.name().to_owned(),
                straight: request.straight,
                compare: request.compare,
            },
            done: 0,
            frames: vec![None; path.len()],
        })
    }

    /// Reads a manifest; `None` if there is none.
    pub(super) fn read_file(path: &Path) -> Result<Option<Self>, BelvedereError> {
        let refuse = |reason: String| BelvedereError::Output { path: path.to_owned(), reason };
        match belvedere_io::fs::read_to_string(path) {
            Ok(text) => serde_json::from_str(&text).map(Some).map_err(|e| {
                refuse(format!("is no record of an animation ({e}); remove the folder, or choose another"))
            }),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(belvedere_io::IoError::os(path, e).into()),
        }
    }

    /// Why frames of `earlier` do not belong to this animation; `None` if they do.
    pub(super) fn differs_from(&self, earlier: &Self) -> Option<String> {
        if self.program != earlier.program {
            return Some(format!("it was begun by {}, this is {}", earlier.program, self.program));
        }
        let (now, then) = (&self.settings, &earlier.settings);
        if self.frames.len() != earlier.frames.len() {
            return Some(format!("it has {} frames, {} were asked for", earlier.frames.len(), self.frames.len()));
        }
        if now.image != then.image {
            return Some(format!(
                "its frames are {} x {} pixels, {} x {} were asked for",
                then.image[0], then.image[1], now.image[0], now.image[1]
            ));
        }
        if now != then {
            return Some("the camera's way or the way of drawing is another".into());
        }
        // The scene file is compared by its content, not by its comments.
        let read = |m: &Self| m.inputs.iter().skip(1).map(|i| (i.path.clone(), i.sha256.clone())).collect::<Vec<_>>();
        if let Some((_, (path, _))) = read(earlier).into_iter().zip(read(self)).find(|(a, b)| a.1 != b.1) {
            return Some(format!("{} has changed since", path.display()));
        }
        (self.scene_sha256 != earlier.scene_sha256).then(|| "the scene has changed since".into())
    }

    /// Takes over the frames of `earlier` that are missing here and whose files are unchanged.
    pub(super) fn keep(&mut self, earlier: &Self, folder: &Path) {
        for (mine, theirs) in self.frames.iter_mut().zip(&earlier.frames).filter(|(mine, _)| mine.is_none()) {
            *mine = theirs.clone().filter(|frame| frame.is_whole(folder));
        }
        self.count();
    }

    /// Records a frame that was written.
    pub(super) fn put(&mut self, frame: usize, record: FrameRecord) {
        self.frames[frame] = Some(record);
        self.count();
    }

    fn count(&mut self) {
        self.done = self.frames.iter().flatten().count();
    }

    /// Writes the manifest into its folder.
    pub(super) fn write(&self, folder: &Path, name: &str) -> Result<PathBuf, BelvedereError> {
        let path = folder.join(name);
        output::write_text(&path, &output::pretty(self)?, true)?;
        Ok(path)
    }
}

impl FrameRecord {
    fn is_whole(&self, folder: &Path) -> bool {
        belvedere_io::sha256_of_file(&folder.join(&self.file)).is_ok_and(|found| found == self.sha256)
    }
}

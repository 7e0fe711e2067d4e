//! Data straightened along a line, and the camera that shows all of it.

use crate::scene_file::request::{Straighten, StraightenedLine};
use crate::scene_file::{CameraDoc, CentrelineDoc, Document, LayerDoc, StageDoc, TubeStageDoc};
use crate::user_files::of_user;
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_core::map::straighten::Tube;
use belvedere_core::{DMat3, DVec3, Pinhole, Projection, Stage};
use belvedere_scene::VolumeModel;
use belvedere_scene::volume::SLICE;
use std::path::PathBuf;

/// Room around the tube, as a share of its size.
const ROOM: f64 = 1.03;
/// Longer side of a picture whose size is not asked for, and its least shorter one, pixels.
const LONG_PX: f64 = 1600.0;
const SHORT_PX: f64 = 160.0;
/// Distance between samples of volumes that are cut open, voxel edges: the first one is what is seen.
const CUT_STEP: f64 = 0.01;

/// Puts the stage into a document, and cuts through volumes into their style.
///
/// * `allowed`: takes the folder of a file of points.
pub(crate) fn put_into(
    document: &mut Document,
    asked: &Straighten,
    allowed: &mut Vec<PathBuf>,
) -> Result<(), BelvedereError> {
    let Some(line) = &asked.straighten else { return Ok(()) };
    let (mut path, mut centreline) = (None, None);
    match line {
        StraightenedLine::Between([from, to]) => {
            let volumes: Vec<&str> = document.layer.iter().filter(|l| is_volume(l)).map(LayerDoc::id).collect();
            let [volume] = volumes[..] else {
                let advice =
                    Advice::new("{}: two points are for a scene of one volume, and there are ", &["straighten"]);
                return Err(BelvedereError::Argument(advice.then(volumes.len().to_string())));
            };
            centreline = Some(CentrelineDoc { volume: volume.to_owned(), from: *from, to: *to, values: None });
        }
        StraightenedLine::Named(name) if document.layer.iter().any(|layer| layer.id() == name) => {
            path = Some(name.clone());
        }
        StraightenedLine::Named(name) => path = Some(of_user(name, allowed)?),
    }
    let bends = document.stage.iter().any(|stage| !stands(stage));
    if bends || document.constructor.is_some() {
        let advice = Advice::new(
            "{} chooses a camera, which bends of the scene cannot follow; leave one of them out",
            &["straighten"],
        );
        return Err(BelvedereError::Argument(advice));
    }
    let stage = TubeStageDoc { path, centreline, radius_m: asked.radius, ..TubeStageDoc::default() };
    document.stage.push(StageDoc::Tube(stage));
    for layer in &mut document.layer {
        if let LayerDoc::Volume(volume) = layer
            && !asked.uncut
        {
            (volume.shading, volume.step) = (VolumeModel::Plain, CUT_STEP);
            if volume.transfer == "auto" {
                volume.transfer = SLICE.to_owned();
            }
        }
    }
    Ok(())
}

/// Whether a stage stays as it is, whatever the camera.
fn stands(stage: &StageDoc) -> bool {
    matches!(stage, StageDoc::TerrainDisocclusion(_) | StageDoc::GroundMoves(_)) && !stage.is_terrain_intent()
}

fn is_volume(layer: &LayerDoc) -> bool {
    matches!(layer, LayerDoc::Volume(_))
}

/// The session, seen by the camera that shows the whole tube, its start on the left.
pub(crate) fn aimed(session: Session, options: &OpenOptions) -> Result<Session, BelvedereError> {
    let tube = session.view().stages().iter().find_map(|s| if let Stage::Tube(tube) = s { Some(tube) } else { None });
    let (Some(tube), true) = (tube, options.straighten.straighten.is_some()) else { return Ok(session) };
    let (pinhole, middle) = camera(tube, &options.straighten, options.image)?;
    let camera = CameraDoc { up: (-pinhole.down).to_array(), ..CameraDoc::of(&pinhole, middle) };
    session.seen_by(pinhole, camera)
}

/// An orthographic camera that looks across the straightened line; the near plane goes through the line where it is cut open.
fn camera(tube: &Tube, asked: &Straighten, image: Option<[u32; 2]>) -> Result<(Pinhole, DVec3), BelvedereError> {
    let ([first, last], beyond) = (tube.line().reach(), tube.half_width());
    let ends = [first.max(-beyond), last.min(tube.line().length() + beyond)];
    let [start, end] = ends.map(|g| tube.unrolled().at(g).p);
    let (middle, along) = (0.5 * (start + end), (end - start).normalize_or(DVec3::X));
    let upright = [DVec3::Z, DVec3::Y].map(|axis| axis.reject_from_normalized(along));
    let upright = upright[usize::from(upright[0].length() < 0.1)].normalize_or(along.any_orthonormal_vector());
    let turn = DMat3::from_axis_angle(along, asked.side.unwrap_or(0.0).to_radians());
    let (up, forward) = (turn * upright, turn * upright.cross(along));
    let [width, height] = [start.distance(end), 2.0 * tube.half_width()].map(|side| ROOM * side);
    let image = image.unwrap_or_else(|| {
        let per_unit = LONG_PX / width.max(height);
        [width, height].map(|side| (side * per_unit).max(SHORT_PX).round() as u32)
    });
    let height = height.max(width * f64::from(image[1]) / f64::from(image[0]));
    let back = 2.0 * tube.half_width();
    let near = if asked.uncut { back - ROOM * tube.half_width() } else { back };
    let lens = Projection::Orthographic { height };
    let far = Some(back + ROOM * tube.half_width());
    let pinhole = Pinhole::look_at(middle - back * forward, middle, up, lens, image, near, far);
    Ok((pinhole.map_err(|e| BelvedereError::Setting(e.to_string()))?, middle))
}

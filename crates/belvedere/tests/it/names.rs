//! All types that a caller gives or receives can be named through `belvedere::` alone.

#![allow(dead_code, reason = "that it compiles is the test")]

use belvedere::{construct, core, disocclusion, io, record, scene, scene_file, verbs};

struct Given {
    open: belvedere::OpenOptions,
    needs: belvedere::Needs,
    data: belvedere::DataFiles,
    picture: belvedere::PictureOptions,
    quality: scene::RenderOptions,
    camera_picture: belvedere::CameraPicture,
    setting: verbs::reveal::Setting,
    technique: verbs::reveal::Technique,
    reveal: belvedere::request::Reveal,
    disocclude: belvedere::request::Disocclude,
    animate: verbs::animate::AnimateRequest,
    measure: construct::MeasureOptions,
    progress: scene::Progress,
    settings: disocclusion::TerrainSettings,
    document: scene_file::Document,
    light: scene::Light,
    view: core::View,
    heights: scene::Heightfield,
    limits: io::Limits,
}

struct Received {
    session: belvedere::Session,
    error: belvedere::BelvedereError,
    picture: belvedere::Picture,
    frame: scene::Frame,
    stats: scene::FrameStats,
    sidecar: belvedere::Sidecar,
    displacement: belvedere::DisplacementReport,
    view_record: record::ViewRecord,
    input: record::InputFile,
    reveal: verbs::reveal::RevealAnswer,
    reveal_report: construct::RevealReport,
    goal: construct::Goal,
    measures: construct::Measures,
    disoccluded: verbs::disocclude::Disoccluded,
    solved: disocclusion::Solved,
    terrain: disocclusion::TerrainReport,
    animation: verbs::animate::Animation,
    manifest: verbs::animate::Manifest,
    film: verbs::animate::Film,
    projected: verbs::points::ProjectedPoint,
    picked: belvedere::pick::Picked,
    info: verbs::info::FileInfo,
    io_error: io::IoError,
    view_error: core::ViewError,
    pinhole_error: core::PinholeError,
    render_error: scene::RenderError,
}

//! `reveal --see`: what is asked for.

use super::appearance::Appearance;
use super::view_request::{Technique, Viewpoint};
use crate::picture::PictureOptions;
use crate::places::Place;
use belvedere_core::DVec3;
use std::path::PathBuf;

/// Target to show, and the view.
#[derive(Debug, Clone, Default)]
pub struct TargetRequest {
    /// Models (meshes, molecules, volumes), one scene file, or cities with features and elevation models.
    pub files: Vec<PathBuf>,
    /// The target: id of a layer (that of a file is its name without the ending), atoms such as `chain B`, a point `x,y,z`, scene
    /// coordinates, or in a city the name or id of a building, street or area, `key=value`, or a file of features; empty for all
    /// features of `files`.
    pub see: String,
    /// Transfer function of volume files: a name or a file; `auto` if left out.
    pub transfer: Option<String>,
    /// Eye and target of the view; if left out, the camera of the scene file, or one chosen automatically.
    pub viewpoint: Option<Viewpoint>,
    /// Eye and target as a user wrote them, instead of `viewpoint`.
    pub places: Option<[Place; 2]>,
    /// Full vertical field of view, degrees.
    pub fov_y_deg: Option<f64>,
    /// Direction that is up in the picture, a unit vector; z if left out. Not for scene files, which state their own.
    pub up: Option<DVec3>,
    /// Picture size, pixels.
    pub image: Option<[u32; 2]>,
    /// Fallbacks if no bend shows the target: `transparency`, `cutaway` or `explosion`, alone or as `LAYER:KIND`.
    pub fallback: Vec<String>,
    /// Curved rays, or a spline for features in a city; by default the one that shows more.
    pub technique: Option<Technique>,
    /// Quality of the pictures.
    pub picture: PictureOptions,
    /// Light, stylisation and mark; models have no exaggeration.
    pub appearance: Appearance,
}

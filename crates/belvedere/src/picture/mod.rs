//! Pictures with a record of their origin.

mod bands;
mod buffers;
mod displacement;
mod draw;
pub(crate) mod film_names;
mod furniture;
mod look;
mod mark_target;
mod nothing_seen;
mod options;
mod over;
mod plan;
mod sidecar;
mod target_place;
mod transparent;
mod vectors;
mod volume_record;
mod write;

pub use crate::scene_file::request::{AuxBuffer, AuxFormat};
pub(crate) use bands::{later, write_later, write_straight};
pub use displacement::DisplacementReport;
pub(crate) use draw::{draw, draw_camera, draw_view};
pub use look::{LookRule, LookScore};
pub(crate) use mark_target::plain;
pub use options::{PictureOptions, THRESHOLDS};
pub use sidecar::{MoleculeRecord, OverlayRecord, Picture, SeeThroughRecord, Sidecar, TerrainRecord};
pub use target_place::{TargetPlace, VoxelPlace};
pub use volume_record::VolumeRecord;
pub use write::{check_format, delta_path, outputs, side_by_side};

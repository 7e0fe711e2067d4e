//! Constructors of curved rays: from what is to be seen to the turns of a camera.
//!
//! Source: Cui, Rosen, Popescu, Hoffmann 2010, section 5 (interactive construction, target tracking, path preview). Lines of sight
//! in place of boxes in the image, bends in any direction, and the search for the smallest bend that shows a target are ours.

mod approach;
mod around;
mod film;
mod path;
mod preview;
mod probe;
mod room;
mod sidestep;
mod surface_points;
mod target;
mod tracking;
mod turns;
mod wall;
mod way;

pub use around::{AroundOptions, BendFound, BendReport, bend_around, bend_around_by};
pub use film::FilmPlanner;
pub use preview::{Lens, PathPreview, PreviewReport, Previewed};
pub use probe::{ProbeMemory, ProbeOptions, ProbeReport, Probed, auto_probe};
pub use sidestep::{PlannedBend, Sidestep};
pub use target::{Shown, Target, TargetSight};
pub use tracking::{Tracked, TrackingMemory, TrackingOptions, TrackingReport, track_target};
pub use wall::{Wall, find_wall, share_inside};

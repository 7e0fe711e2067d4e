//! Constructors, which choose the stages of a view for a given purpose, and the measures that judge them.
//!
//! [`measure()`] says what a picture shows of the features it is made for; [`reveal()`] chooses a view and a bend that
//! show more of them.

pub mod centreline;
mod distance;
mod error;
pub mod flight;
mod frontier;
pub mod generalise;
pub mod ground_moves;
mod large_forms;
pub mod measure;
pub mod rays;
pub mod reveal;
mod sample;
mod samples;
mod surface_samples;
pub mod views;

pub use error::ConstructError;
pub use flight::{Flight, FlightError, FlightOptions};
pub use large_forms::large_forms;
pub use measure::{MeasureOptions, Measures, measure};
pub use reveal::{Goal, RevealMemory, RevealOptions, RevealReport, Revealed, reveal};
pub use sample::{Amount, Sample, SampledFeature};
pub use samples::{default_spacing, judged_samples, sample_features};

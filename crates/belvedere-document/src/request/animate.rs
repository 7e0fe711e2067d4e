//! `animate`: a film of a moving camera.

#[cfg(feature = "clap")]
use super::value;
use super::{Drawing, Furnishing, OfData, Paper};
use crate::{AnimationDoc, SweepDoc, TurntableDoc};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A moving camera, and how its frames are drawn.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Animate {
    /// Number of frames; by default the scene's, else 250 or as many as the path needs. Without --speed the speed follows
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=100_000)))]
    pub frames: Option<u32>,
    /// Frames per second; by default the scene's, else 25
    #[cfg_attr(feature = "clap", arg(long, value_name = "F", allow_negative_numbers = true, value_parser = value::number))]
    pub fps: Option<f64>,
    /// Follow the route of this line layer, behind and above a walker; the eye stays above the drawn ground
    #[cfg_attr(feature = "clap", arg(long, value_name = "LAYER", group = "way"))]
    pub along: Option<String>,
    /// Ground speed along the route, metres per second of film; by default the whole route in all frames
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", allow_negative_numbers = true, value_parser = value::number))]
    pub speed: Option<f64>,
    /// Tilt through the viewing angles of the spline's presets: phi, phi=FIRST:LAST or phi=FIRST:LAST:STEP in degrees
    #[cfg_attr(feature = "clap", arg(long, value_name = "phi[=A:B]", group = "way", value_parser = value::sweep))]
    pub sweep: Option<[f64; 3]>,
    /// Turn once around the point looked at, or as the scene says; with a value at so many degrees per second
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG_PER_S", group = "way", num_args = 0..=1, require_equals = true, default_missing_value = "0", allow_hyphen_values = true, value_parser = value::number))]
    pub turntable: Option<f64>,
    /// Frames of a molecule over time, XTC or DCD: shows them one after the other
    #[cfg_attr(feature = "clap", arg(long, value_name = "FILE"))]
    pub trajectory: Option<String>,
    /// Follow this layer, which moves: the camera moves with its middle, or with that of the selected atoms
    #[cfg_attr(feature = "clap", arg(long, value_name = "LAYER"))]
    pub follow: Option<String>,
    /// Mark the walker, along a route; he is seen through ground that hides him
    #[cfg_attr(feature = "clap", arg(long, value_name = "true|false", num_args = 0..=1, require_equals = true, default_missing_value = "true"))]
    pub marker: Option<bool>,
    /// Write the time at the walker, along a route, where a GPX file gives times
    #[cfg_attr(feature = "clap", arg(long, value_name = "true|false", num_args = 0..=1, require_equals = true, default_missing_value = "true"))]
    pub clock: Option<bool>,
    /// Draw a strip with the heights of the route and the walker's place
    #[cfg_attr(feature = "clap", arg(long, value_name = "true|false", num_args = 0..=1, require_equals = true, default_missing_value = "true"))]
    pub profile: Option<bool>,
    /// Keep the frames that exist and draw the rest
    #[cfg_attr(feature = "clap", arg(long))]
    pub resume: bool,
    /// Draw these frames alone, counted from 0, both included: for one of several processes or machines that draw a film into one folder. --resume without it collects the parts and makes the film
    #[cfg_attr(feature = "clap", arg(long, value_name = "FIRST:LAST", value_parser = value::part))]
    pub part: Option<[usize; 2]>,
    /// Size, renderer, samples.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub drawing: Drawing,
    /// Paper of the frames.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub paper: Paper,
    /// Title, legend and more over each frame.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub furnishing: Furnishing,
    /// What data without a scene file do not say.
    #[cfg_attr(feature = "clap", command(flatten, next_help_heading = "Data without a scene file"))]
    #[serde(flatten)]
    pub data: OfData,
}

impl Animate {
    /// The motion as a scene states it; what is left out stays as the scene has it.
    pub fn motion(&self) -> AnimationDoc {
        AnimationDoc {
            along: self.along.clone(),
            follow: self.follow.clone(),
            sweep: self.sweep.map(|phi_deg| SweepDoc { phi_deg }),
            turntable: self.turntable.map(|deg_per_s| TurntableDoc { deg_per_s }),
            frames: self.frames,
            fps: self.fps,
            speed_mps: self.speed,
            marker: self.marker,
            clock: self.clock,
            profile: self.profile,
            ..AnimationDoc::default()
        }
    }
}

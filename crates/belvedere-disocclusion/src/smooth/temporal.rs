//! Coherence between frames.

use belvedere_core::DVec3;

/// Jumps: eye moved further than this share of the scene's diagonal, or view turned by more than this angle.
const JUMP_SHARE: f64 = 0.05;
const JUMP_DEG: f64 = 20.0;

/// Temporal weight gamma for a frame `dt_s` seconds after the last one and time constant `time_s`: with
/// `alpha = 1 - exp(-dt / T)`, `gamma = w sqrt((1 - alpha) / alpha)`, so that what is seen after a second does not
/// depend on the frame rate. gamma = 2 w, the paper's, is T = 0.15 s at 30 frames per second. 0 if T is 0; capped at
/// 1000 w, where time stands still.
pub fn temporal_weight(w: f64, dt_s: f64, time_s: f64) -> f64 {
    if !(time_s > 0.0) {
        return 0.0;
    }
    let kept = (-dt_s.max(0.0) / time_s).exp();
    w * (kept / (1.0 - kept).max(f64::MIN_POSITIVE)).sqrt().min(1000.0)
}

/// What the smooth pass remembers of the last frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SmoothMemory {
    last: Option<Last>,
}

#[derive(Debug, Clone, PartialEq)]
struct Last {
    eye: DVec3,
    forward: DVec3,
    size: [usize; 2],
    u: Vec<f64>,
}

impl SmoothMemory {
    /// Displacement of the last frame on a coarse grid of `size` = columns, rows; `None` at the first frame, after a
    /// jump (eye moved by > 5 % of `diagonal`, view turned by > 20 degrees) or when the grid changed. The smooth pass
    /// then takes the naive displacement in its place, and its matrix stays what it was.
    pub fn previous(&self, eye: DVec3, forward: DVec3, diagonal: f64, size: [usize; 2]) -> Option<&[f64]> {
        let last = self.last.as_ref()?;
        let near = eye.distance(last.eye) <= JUMP_SHARE * diagonal;
        let steady = forward.angle_between(last.forward) <= JUMP_DEG.to_radians();
        (near && steady && last.size == size).then_some(&last.u)
    }

    /// Remembers the final displacement of a frame: after the quadratic program where there is one.
    pub fn remember(&mut self, eye: DVec3, forward: DVec3, size: [usize; 2], u: Vec<f64>) {
        self.last = Some(Last { eye, forward, size, u });
    }

    /// Forgets.
    pub fn clear(&mut self) {
        self.last = None;
    }
}

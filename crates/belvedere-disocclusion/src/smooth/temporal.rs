//! Temporal weight of the smooth pass.

/// Temporal weight gamma for a frame `dt_s` seconds after the last one and time constant `time_s`: with `alpha = 1 - exp(-dt / T)`,
/// `gamma = w sqrt((1 - alpha) / alpha)`, so that the displacement after a second does not depend on the frame rate. gamma = 2 w, the
/// paper's, is T = 0.15 s at 30 frames per second. 0 if T is 0; at most 1000 w.
pub fn temporal_weight(w: f64, dt_s: f64, time_s: f64) -> f64 {
    if !(time_s > 0.0) {
        return 0.0;
    }
    let kept = (-dt_s.max(0.0) / time_s).exp();
    w * (kept / (1.0 - kept).max(f64::MIN_POSITIVE)).sqrt().min(1000.0)
}

//! `--timings`: how long the steps of a command took. Records of pictures hold no times, so that they are the same in every run.

use crate::common_args::Common;
use belvedere::output;
use serde_json::{Map, Value, json};
use std::sync::Mutex;
use std::time::Instant;

/// Times of one run.
pub(crate) struct Timings {
    began: Instant,
    parts: Mutex<Map<String, Value>>,
}

impl Timings {
    pub(crate) fn begin() -> Self {
        Self { began: Instant::now(), parts: Mutex::default() }
    }

    /// Notes the time of a part, or an object of times.
    pub(crate) fn note(&self, name: &str, value: Value) {
        if let Ok(mut parts) = self.parts.lock() {
            parts.insert(name.to_owned(), value);
        }
    }

    /// Notes the times of a picture and of the solver of its ground.
    pub(crate) fn note_picture(&self, sidecar: &belvedere::Sidecar) {
        self.note("draw_ms", json!(sidecar.render_ms));
        self.note("renderer_ms", json!(sidecar.stats.milliseconds));
        if let Some(report) = &sidecar.disocclusion {
            self.note("disocclusion", json!(report.times));
        }
    }

    /// Writes the file of `--timings`, if it is asked for.
    pub(crate) fn write(&self, verb: &str, common: &Common) -> anyhow::Result<()> {
        let Some(path) = &common.timings else { return Ok(()) };
        let parts = self.parts.lock().map(|parts| parts.clone()).unwrap_or_default();
        let total_ms = 1e3 * self.began.elapsed().as_secs_f64();
        let text = output::pretty(&json!({ "verb": verb, "total_ms": total_ms, "parts": parts }))?;
        Ok(output::write_text(path, &text, common.overwrite)?)
    }
}

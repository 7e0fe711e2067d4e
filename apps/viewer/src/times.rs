//! Times of pictures for measurements: written as JSON to the file that `BELVEDERE_VIEW_TIMES` names when the window closes.

use crate::model::Model;
use belvedere::scene::Instant;

/// Times of one run.
#[derive(Debug)]
pub(crate) struct Times {
    started: Instant,
    first_ms: Option<f64>,
}

impl Default for Times {
    fn default() -> Self {
        Self { started: Instant::now(), first_ms: None }
    }
}

impl Times {
    /// Notes the time of the first picture.
    pub(crate) fn note(&mut self, model: &Model) {
        if model.shown.is_some() && self.first_ms.is_none() {
            self.first_ms = Some(self.started.elapsed().as_secs_f64() * 1e3);
        }
    }

    /// The noted times as JSON.
    pub(crate) fn report(&self, model: &Model) -> serde_json::Value {
        serde_json::json!({
            "pictures": model.pictures,
            "rests": model.rests(),
            "first_picture_ms": self.first_ms,
            "input_to_picture_median_ms": model.latency(),
            "input_to_picture_ms": model.latencies,
            "rest_to_full_picture_ms": model.rests_after,
        })
    }

    /// Writes the report if `BELVEDERE_VIEW_TIMES` is set.
    pub(crate) fn tell(&self, model: &Model) {
        let Some(path) = std::env::var_os("BELVEDERE_VIEW_TIMES") else { return };
        let times = self.report(model).to_string();
        // An error is ignored: whoever measures notices the missing file.
        let _ = belvedere::output::write_text(std::path::Path::new(&path), &times, true);
    }
}

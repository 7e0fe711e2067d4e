//! Messages to the user: dismissed by the user or after a time.

use crate::language::{fill, tr};
use crate::theme;
use eframe::egui;

/// What a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Problem,
    Done,
    Note,
}

impl Kind {
    fn heading(self) -> (&'static str, egui::Color32) {
        match self {
            Self::Problem => (tr("Problem"), theme::PROBLEM),
            Self::Done => (tr("Done"), theme::DONE),
            Self::Note => (tr("Note"), theme::NOTE),
        }
    }
}

/// One message.
#[derive(Debug, Clone)]
struct Notice {
    text: String,
    kind: Kind,
    /// Time of the window at which it disappears, seconds; `None`: it stays until it is dismissed.
    until: Option<f64>,
}

/// Messages that are shown.
#[derive(Debug, Default)]
pub(crate) struct Notices {
    shown: Vec<Notice>,
}

/// Time for which messages other than errors are shown, seconds.
const STAYS: f64 = 6.0;
/// Messages that are shown at once.
const MOST_MESSAGES: usize = 5;

impl Notices {
    /// Adds an error, which stays until it is dismissed.
    pub(crate) fn error(&mut self, text: impl Into<String>) {
        self.add(Notice { text: text.into(), kind: Kind::Problem, until: None });
    }

    /// Adds the message of a finished action, which disappears by itself.
    ///
    /// * `now`: time of the window, seconds.
    pub(crate) fn say(&mut self, text: impl Into<String>, now: f64) {
        self.add(Notice { text: text.into(), kind: Kind::Done, until: Some(now + STAYS) });
    }

    /// Adds a hint, which disappears by itself.
    ///
    /// * `now`: time of the window, seconds.
    pub(crate) fn note(&mut self, text: impl Into<String>, now: f64) {
        self.add(Notice { text: text.into(), kind: Kind::Note, until: Some(now + STAYS) });
    }

    /// Adds a hint that disappears by itself; its time begins when it is shown.
    pub(crate) fn tell(&mut self, text: impl Into<String>) {
        self.add(Notice { text: text.into(), kind: Kind::Note, until: Some(f64::INFINITY) });
    }

    fn add(&mut self, notice: Notice) {
        self.shown.retain(|old| old.text != notice.text);
        self.shown.push(notice);
        let extra = self.shown.len().saturating_sub(MOST_MESSAGES);
        self.shown.drain(..extra);
    }

    /// Shows them in the upper right corner.
    pub(crate) fn show(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|input| input.time);
        for notice in &mut self.shown {
            notice.until = notice.until.map(|until| until.min(now + STAYS));
        }
        self.shown.retain(|notice| notice.until.is_none_or(|until| now < until));
        let (mut dismissed, mut top) = (None, 44.0);
        for (i, notice) in self.shown.iter().enumerate() {
            let (heading, color) = notice.kind.heading();
            let window = egui::Window::new(format!("{heading} {}", i + 1))
                .id(egui::Id::unique(("notice", i)))
                .title_bar(false)
                .resizable(false)
                .anchor(egui::Align2::RIGHT_TOP, [-12.0, top])
                .show(ctx, |ui| {
                    ui.set_max_width(380.0);
                    ui.horizontal(|ui| {
                        ui.colored_label(theme::readable(color, ui.visuals().dark_mode), heading);
                        if ui.small_button(fill(tr("Dismiss {0}"), &[&(i + 1)])).clicked() {
                            dismissed = Some(i);
                        }
                    });
                    ui.label(&notice.text);
                });
            top += window.map_or(0.0, |window| window.response.rect.height() + 6.0);
        }
        if let Some(i) = dismissed {
            self.shown.remove(i);
        }
        if let Some(next) = self.shown.iter().filter_map(|notice| notice.until).reduce(f64::min) {
            ctx.request_repaint_after_secs((next - now).max(0.05) as f32);
        }
    }
}

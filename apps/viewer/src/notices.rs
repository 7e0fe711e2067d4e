//! What the application has to say: readable, dismissed by the reader or by time.

use eframe::egui;

/// One message.
#[derive(Debug, Clone)]
struct Notice {
    text: String,
    is_error: bool,
    /// Time of the window at which it goes; `None` = when it is dismissed.
    until: Option<f64>,
}

/// Messages that are shown.
#[derive(Debug, Default)]
pub(crate) struct Notices {
    shown: Vec<Notice>,
}

/// How long good news stay, seconds.
const STAYS: f64 = 6.0;
/// Messages that are shown at once.
const MOST: usize = 5;

impl Notices {
    /// Something went wrong; it stays until it is dismissed.
    pub(crate) fn error(&mut self, text: impl Into<String>) {
        self.add(Notice { text: text.into(), is_error: true, until: None });
    }

    /// Something happened; it goes by itself.
    ///
    /// * `now`: time of the window, seconds.
    pub(crate) fn say(&mut self, text: impl Into<String>, now: f64) {
        self.add(Notice { text: text.into(), is_error: false, until: Some(now + STAYS) });
    }

    fn add(&mut self, notice: Notice) {
        self.shown.retain(|old| old.text != notice.text);
        self.shown.push(notice);
        let extra = self.shown.len().saturating_sub(MOST);
        self.shown.drain(..extra);
    }

    /// Shows them in the upper right corner.
    pub(crate) fn show(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|input| input.time);
        self.shown.retain(|notice| notice.until.is_none_or(|until| now < until));
        let mut dismissed = None;
        for (i, notice) in self.shown.iter().enumerate() {
            let (heading, color) = if notice.is_error {
                ("Problem", egui::Color32::from_rgb(190, 60, 40))
            } else {
                ("Done", egui::Color32::from_rgb(40, 120, 80))
            };
            egui::Window::new(format!("{heading} {}", i + 1))
                .id(egui::Id::unique(("notice", i)))
                .title_bar(false)
                .resizable(false)
                .anchor(egui::Align2::RIGHT_TOP, [-12.0, 44.0 + 78.0 * i as f32])
                .show(ctx, |ui| {
                    ui.set_max_width(380.0);
                    ui.horizontal(|ui| {
                        ui.colored_label(color, heading);
                        if ui.small_button(format!("Dismiss {}", i + 1)).clicked() {
                            dismissed = Some(i);
                        }
                    });
                    ui.label(&notice.text);
                });
        }
        if let Some(i) = dismissed {
            self.shown.remove(i);
        }
        if let Some(next) = self.shown.iter().filter_map(|notice| notice.until).reduce(f64::min) {
            ctx.request_repaint_after_secs((next - now).max(0.05) as f32);
        }
    }
}

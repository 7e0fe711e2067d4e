//! Work that takes long: what it is at, and a button to stop it.

use super::Viewer;
use crate::language::{heard, tr};
use belvedere_studio::THREADS;
use eframe::egui::{Align2, Area, Context, Frame, Id, Order, ProgressBar, vec2};

/// Time after which running work is announced, seconds.
const PATIENT: f64 = 0.8;

impl Viewer {
    /// Shows the work above the picture.
    pub(super) fn at_work(&mut self, ctx: &Context) {
        let opening = self.pending.is_some().then(|| self.model.opening.clone()).flatten();
        let drawing = self.model.works_since().filter(|since| *since > PATIENT);
        let (words, share) = match (&opening, drawing) {
            (Some(opening), _) => (opening.clone(), None),
            (None, Some(since)) => {
                let at = self.model.progress().filter(|(stage, _)| !stage.is_empty());
                let what = at.as_ref().map_or_else(|| tr("working").to_owned(), |(stage, _)| heard(stage));
                (format!("{what}, {since:.0} s"), at.map(|(_, share)| share as f32))
            }
            (None, None) if self.model.is_stopped() => {
                (tr("Stopped: the picture is older than the scene").into(), None)
            }
            (None, None) => return,
        };
        let at = self.picture.middle_top + vec2(0.0, 10.0);
        let area = Area::new(Id::unique("at work")).order(Order::Foreground).pivot(Align2::CENTER_TOP).fixed_pos(at);
        let (mut cancelled, mut again) = (false, false);
        area.show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(300.0);
                ui.horizontal(|ui| {
                    ui.label(words);
                    if self.model.is_stopped() && opening.is_none() {
                        again = ui.button(tr("Draw again")).clicked();
                    } else if THREADS {
                        cancelled = ui.button(tr("Cancel")).clicked();
                    }
                });
                if let Some(share) = share {
                    ui.add(ProgressBar::new(share).desired_height(6.0));
                }
            });
        });
        match (cancelled, opening.is_some()) {
            (true, true) => self.cancel_opening(),
            (true, false) => self.model.stop(),
            (false, _) => {}
        }
        if again {
            self.model.draw_again();
        }
    }
}

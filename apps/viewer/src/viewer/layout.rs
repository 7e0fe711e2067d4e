//! Arrangement of the window: a panel beside the picture, or, on a small screen, a sheet over it.

use super::Viewer;
use crate::language::tr;
use crate::menu::{self, Choice};
use eframe::egui::{Align2, Area, Button, CentralPanel, Frame, Id, Order, Panel, Rect, Ui, pos2, vec2};

/// Width of a window below which the picture fills it and the panel is a sheet, points.
pub(super) const SMALL: f32 = 600.0;
/// Width of the panel: the usual one, and the largest share of the window that it starts with.
const PANEL: f32 = 330.0;
const PANEL_SHARE: f32 = 0.34;
/// Height of the open sheet as a share of the window's, and of the button that opens it, points.
const SHEET: f32 = 0.46;
const GRIP: f32 = 40.0;

impl Viewer {
    fn menu(&mut self, ui: &mut Ui) -> Option<Choice> {
        let (waiting, recent) = (self.waiting(), &self.remembered.recent);
        menu::bar(ui, &mut self.model, &mut self.settings, recent, &self.bookmarks, &waiting)
    }

    /// Menu above, panel to the left, picture in the rest.
    pub(super) fn large(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        let choice = Panel::top("menu").show(ui, |ui| self.menu(ui)).inner;
        if let Some(choice) = choice {
            self.choose(&ctx, choice);
        }
        if self.model.look.panel {
            let width = PANEL.min(PANEL_SHARE * ctx.content_rect().width());
            Panel::left("panels")
                .default_size(width)
                .show(ui, |ui| self.panels.show(ui, &mut self.model, &self.bookmarks));
        }
        CentralPanel::no_frame().show(ui, |ui| {
            let free = ui.available_rect_before_wrap();
            self.picture.show(ui, &mut self.model, free);
        });
    }

    /// The picture in the whole window; menu and sheet lie over it.
    pub(super) fn small(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        let room = ctx.content_rect();
        let sheet = if self.sheet { SHEET * room.height() } else { 0.0 };
        let free = Rect::from_min_max(room.min + vec2(0.0, 34.0), room.max - vec2(0.0, sheet + GRIP + 8.0));
        CentralPanel::no_frame().show(ui, |ui| self.picture.show(ui, &mut self.model, free));
        let top = Area::new(Id::unique("menu")).order(Order::Middle).fixed_pos(room.min).constrain(false);
        let choice = top.show(&ctx, |ui| {
            Frame::side_top_panel(ui.style()).show(ui, |ui| {
                ui.set_width(room.width() - 16.0);
                self.menu(ui)
            })
        });
        if let Some(choice) = choice.inner.inner {
            self.choose(&ctx, choice);
        }
        let bottom = Area::new(Id::unique("sheet"))
            .order(Order::Middle)
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(pos2(room.left(), room.bottom()))
            .constrain(false);
        bottom.show(&ctx, |ui| {
            Frame::side_top_panel(ui.style()).show(ui, |ui| {
                ui.set_width(room.width() - 16.0);
                let name = tr(if self.sheet { "Hide the panel" } else { "Show the panel" });
                if ui.add_sized([ui.available_width(), GRIP - 4.0], Button::new(name)).clicked() {
                    self.sheet = !self.sheet;
                }
                // A sheet that was opened just now has room from the next picture on.
                if sheet > 0.0 {
                    ui.allocate_ui(vec2(ui.available_width(), sheet - 12.0), |ui| {
                        ui.set_min_height(sheet - 12.0);
                        self.panels.show(ui, &mut self.model, &self.bookmarks);
                    });
                }
            });
        });
    }
}

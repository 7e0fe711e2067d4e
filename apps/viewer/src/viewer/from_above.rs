//! The camera from above in a window of its own.

use super::Viewer;
use crate::language::tr;
use crate::panels::set_stage;
use crate::picture::image_of_frame;
use crate::theme;
use crate::widgets::overhead::overhead;
use belvedere::scene_file::StageDoc;
use eframe::egui::{self, Context, Id, TextureOptions, Window};

impl Viewer {
    /// Shows the camera from above in a window of its own.
    pub(super) fn overhead(&mut self, ctx: &Context) {
        if !self.model.look.overhead {
            return;
        }
        let mut open = true;
        let mut edit = None;
        // In the lower right corner, where the window does not hide the side panel.
        let corner = ctx.content_rect().right_bottom() - egui::vec2(490.0, 360.0);
        Window::new(tr("Camera from above")).open(&mut open).default_pos(corner).default_width(460.0).show(ctx, |ui| {
            let Some((frame, view)) = &self.model.overhead else {
                ui.label(tr("drawing"));
                return;
            };
            if self.from_above.as_ref().is_none_or(|(of, _)| *of != self.model.pictures) {
                let texture = ctx.load_texture("camera from above", image_of_frame(frame), TextureOptions::LINEAR);
                self.from_above = Some((self.model.pictures, texture));
            }
            let Some((_, texture)) = &self.from_above else { return };
            let turns = match self.model.stage("curved_rays") {
                Some(StageDoc::CurvedRays(stage)) => stage.turn.clone(),
                _ => Vec::new(),
            };
            edit = overhead(ui, ui.scope_id(), texture.id(), view, &turns);
            if let Some(reason) = &self.model.violated {
                ui.colored_label(theme::readable(theme::PROBLEM, ui.visuals().dark_mode), reason);
            }
        });
        self.model.look.overhead = open;
        let Some(edit) = edit else { return };
        if edit.begins {
            self.model.begin_gesture();
        }
        self.model.edit_on(Id::unique("camera from above"), |document| {
            let stage = document.stage.iter().find_map(|stage| match stage {
                StageDoc::CurvedRays(stage) => Some(stage.clone()),
                _ => None,
            });
            if let Some(mut stage) = stage
                && let Some(turn) = stage.turn.get_mut(edit.turn)
            {
                edit.apply(turn);
                set_stage(document, StageDoc::CurvedRays(stage));
            }
        });
    }
}

//! Views kept under names: a window to rename, order and remove them.

use super::Viewer;
use super::layout::SMALL;
use crate::language::{fill, tr};
use crate::menu::Bookmark;
use belvedere::io::fs;
use eframe::egui::{
    Button, Color32, Context, Grid, Pos2, Rect, Role, ScrollArea, Sense, TextEdit, TextureHandle, Ui, Vec2, WidgetInfo,
    Window, pos2, vec2,
};

/// Size of a picture in the list, points.
const PICTURE: Vec2 = vec2(64.0, 36.0);

/// A change of the list.
enum Change {
    GoTo(usize),
    Swap(usize),
    Remove(usize),
}

impl Viewer {
    /// Keeps the current view under the first free name.
    pub(super) fn bookmark(&mut self) {
        if let Some(camera) = self.model.camera_doc() {
            let taken = |name: &String| self.bookmarks.iter().any(|bookmark| bookmark.name == *name);
            let name = (1..).map(|n| fill(tr("View {0}"), &[&n])).find(|name| !taken(name)).unwrap_or_default();
            self.bookmarks.push(Bookmark { name, camera });
            self.remember_bookmarks();
        }
    }

    /// Keeps the bookmarks of a scene that has a file; those of others are in the recovery file until the scene is saved.
    pub(super) fn remember_bookmarks(&mut self) {
        let scene = self.model.editor.place.scene.as_ref().and_then(|path| fs::canonicalize(path).ok());
        if let Some(scene) = scene {
            self.remembered.bookmarks.insert(scene, self.bookmarks.clone());
            self.write_remembered();
        }
    }

    /// Flies to a bookmark.
    pub(super) fn go_to_bookmark(&mut self, ctx: &Context, i: usize) {
        if let Some(bookmark) = self.bookmarks.get(i) {
            let camera = bookmark.camera.clone();
            self.model.return_to(&camera, ctx);
        }
    }

    /// Removes a bookmark.
    pub(super) fn forget_bookmark(&mut self, i: usize) {
        if i < self.bookmarks.len() {
            self.bookmarks.remove(i);
            self.remember_bookmarks();
        }
    }

    /// The window of the bookmarks.
    pub(super) fn bookmark_window(&mut self, ctx: &Context) {
        let mut open = self.lists_bookmarks;
        let (mut change, mut renamed) = (None, false);
        let corner = self.picture.middle_top + vec2(-150.0, 60.0);
        Window::new(tr("Bookmarks")).open(&mut open).resizable(false).default_pos(corner).show(ctx, |ui| {
            if self.bookmarks.is_empty() {
                ui.label(tr("There is none yet: B keeps the present view."));
            }
            // On a small screen the names and buttons take all its width.
            let pictures = (ctx.content_rect().width() >= SMALL).then_some(&self.bookmark_pictures);
            let last = self.bookmarks.len().saturating_sub(1);
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                Grid::new("bookmarks").num_columns(6).show(ui, |ui| {
                    for (i, bookmark) in self.bookmarks.iter_mut().enumerate() {
                        if let Some(pictures) = pictures {
                            picture(ui, bookmark, pictures.of(bookmark));
                        }
                        renamed |= name_field(ui, i, &mut bookmark.name);
                        let name = bookmark.name.as_str();
                        for (enabled, sign, label, what) in [
                            (true, tr("Go"), tr("Go to {0}"), Change::GoTo(i)),
                            (i > 0, tr("Up"), tr("Move {0} up"), Change::Swap(i.saturating_sub(1))),
                            (i < last, tr("Down"), tr("Move {0} down"), Change::Swap(i)),
                            (true, tr("Remove"), tr("Remove {0}"), Change::Remove(i)),
                        ] {
                            if button(ui, enabled, sign, &fill(label, &[&name])) {
                                change = Some(what);
                            }
                        }
                        ui.end_row();
                    }
                });
            });
        });
        self.lists_bookmarks = open;
        match change {
            Some(Change::GoTo(i)) => self.go_to_bookmark(ctx, i),
            Some(Change::Swap(i)) => {
                self.bookmarks.swap(i, i + 1);
                renamed = true;
            }
            Some(Change::Remove(i)) => self.forget_bookmark(i),
            None => {}
        }
        if renamed {
            self.remember_bookmarks();
        }
    }
}

/// A small picture of a bookmark, or its place.
fn picture(ui: &mut Ui, bookmark: &Bookmark, texture: Option<&TextureHandle>) {
    let (rect, response) = ui.allocate_exact_size(PICTURE, Sense::hover());
    ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    if let Some(texture) = texture {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
        let name = fill(tr("Picture of {0}"), &[&bookmark.name]);
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    }
}

/// A field for a name, which is taken when the field is left, unless it is empty. Returns whether it changed.
fn name_field(ui: &mut Ui, i: usize, name: &mut String) -> bool {
    let key = ui.scope_id().with(("bookmark", i));
    let mut text = ui.data(|data| data.get_temp::<String>(key)).unwrap_or_else(|| name.clone());
    let field = ui.add_sized([150.0, 20.0], TextEdit::singleline(&mut text));
    let label = fill(tr("Name of bookmark {0}"), &[&(i + 1)]);
    let shown = text.clone();
    field.widget_info(|| WidgetInfo { label: Some(label.clone()), ..WidgetInfo::text_edit(true, &shown, &shown, "") });
    if field.has_focus() {
        ui.data_mut(|data| data.insert_temp(key, text));
        return false;
    }
    ui.data_mut(|data| data.remove::<String>(key));
    let changes = field.lost_focus() && !text.trim().is_empty() && text != *name;
    if changes {
        *name = text;
    }
    changes
}

fn button(ui: &mut Ui, enabled: bool, sign: &str, name: &str) -> bool {
    let response = ui.add_enabled(enabled, Button::new(sign).small());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    response.on_hover_text(name).clicked()
}

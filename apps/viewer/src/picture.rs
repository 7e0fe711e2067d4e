//! The picture on the screen: shown, compared, navigated, picked.

mod handles;

use crate::language::{fill, heard, tr};
use crate::measure::Measure;
use crate::model::{Compare, Model, Tool};
use crate::pointer::{Hand, share};
use crate::points::{coordinates, image_of};
use belvedere::core::{Aabb, DVec2, DVec3};
use belvedere::live::{Pace, Shown};
use belvedere::scene::Frame;
use eframe::egui::{
    Align2, Color32, ColorImage, Context, CursorIcon, FontId, Painter, Pos2, Rect, Response, Role, Sense, Stroke,
    TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2,
};

/// Most pixels of a picture on the screen.
const MOST_PIXELS: f32 = 2.4e6;
/// Time of one picture of a flicker, seconds.
const FLICKER: f64 = 0.7;
/// Time after which running work is announced, seconds.
const PATIENT: f64 = 0.8;
/// Colour of the ring.
const MARK: Color32 = Color32::from_rgb(214, 60, 20);
const INK: Color32 = Color32::from_rgb(28, 34, 44);
const PAPER: Color32 = Color32::from_rgba_premultiplied(225, 225, 222, 225);

/// The picture on the screen.
#[derive(Default)]
pub(crate) struct PictureView {
    textures: [Option<TextureHandle>; 2],
    of: u64,
    hand: Hand,
    /// Middle of the part that nothing covers, and of its upper edge, in the window.
    pub(crate) middle: Pos2,
    pub(crate) middle_top: Pos2,
    /// The clicked point and the id of its layer.
    pub(crate) picked: Option<(DVec3, String)>,
    measure: Measure,
    /// The point of the menu of a place.
    place: Option<DVec3>,
}

impl PictureView {
    /// Shows the picture in the rest of the window, and handles pointer and keyboard in it.
    ///
    /// * `free`: the part of it that no menu and no sheet covers, where words are written.
    pub(crate) fn show(&mut self, ui: &mut Ui, model: &mut Model, free: Rect) {
        let rect = ui.available_rect_before_wrap();
        (self.middle, self.middle_top) = (free.center(), free.center_top());
        let response = ui.interact(rect, ui.scope_id().with("picture"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, tr("Picture")));
        self.hand.steer(ui, &response, rect, model);
        self.order(ui.ctx(), rect, model);
        self.upload(ui.ctx(), model);
        let painter = ui.painter_at(rect);
        self.paint(&painter, (rect, free), ui.ctx(), model);
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            self.click(share(rect, at), model);
        }
        let cursor = match (model.look.tool, response.dragged()) {
            (Tool::Track | Tool::Residue | Tool::Measure | Tool::Move(_), _) => CursorIcon::Crosshair,
            (_, true) => CursorIcon::Grabbing,
            (_, false) => CursorIcon::Grab,
        };
        let response = response.on_hover_cursor(cursor);
        self.measure.show(ui, &response, (rect, free), model);
        ring(&painter, rect, ui.ctx(), model);
        self.menu(&response, rect, model);
        if let Some(at) = response.hover_pos() {
            self.tell(&painter, free, share(rect, at), model);
        }
        match model.look.compare {
            Compare::Split => self.bar(ui, rect, model),
            Compare::Off => handles::show(ui, rect, model),
            Compare::Flicker => {}
        }
        model.handles = None;
    }

    /// Orders the picture at the resolution of the screen, within the limits of pixels and of what the screen can show as one image.
    fn order(&self, ctx: &Context, rect: Rect, model: &mut Model) {
        let size = rect.size() * ctx.pixels_per_point();
        let side = ctx.input(|input| input.max_texture_side) as f32;
        let fewer = (MOST_PIXELS / (size.x * size.y)).sqrt().min(side / size.max_elem()).min(1.0);
        let size = size * fewer;
        model.density = f64::from(ctx.pixels_per_point() * fewer);
        let image = [size.x, size.y].map(|n| (n.round() as u32).max(16));
        let now = ctx.input(|input| input.time);
        if let Some(again) = model.order(image, now) {
            ctx.request_repaint_after_secs(again as f32);
        }
    }

    fn upload(&mut self, ctx: &Context, model: &Model) {
        let Some(shown) = model.shown.as_ref().filter(|_| self.of != model.pictures) else { return };
        self.of = model.pictures;
        for (slot, frame) in self.textures.iter_mut().zip([&shown.bent, &shown.straight]) {
            let Some(frame) = frame else { continue };
            let image = ColorImage::from_rgb([frame.width, frame.height], frame.color.as_flattened());
            match slot {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => *slot = Some(ctx.load_texture("picture", image, TextureOptions::LINEAR)),
            }
        }
    }

    fn paint(&self, painter: &Painter, (rect, free): (Rect, Rect), ctx: &Context, model: &Model) {
        let [bent, straight] = &self.textures;
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let draw = |texture: &Option<TextureHandle>, clip: Rect| {
            if let Some(texture) = texture {
                painter.with_clip_rect(clip).image(texture.id(), rect, whole, Color32::WHITE);
            }
        };
        let bar = rect.left() + model.look.split * rect.width();
        let now = ctx.input(|input| input.time);
        match model.look.compare {
            Compare::Split => {
                draw(straight, rect.with_max_x(bar));
                draw(bent, rect.with_min_x(bar));
            }
            Compare::Flicker => {
                let is_bent = (now / FLICKER) as i64 % 2 == 0;
                draw(if is_bent { bent } else { straight }, rect);
                label(
                    painter,
                    free.center_top() + vec2(0.0, 8.0),
                    Align2::CENTER_TOP,
                    tr(if is_bent { "bent" } else { "straight" }),
                );
                ctx.request_repaint_after_secs(0.1);
            }
            Compare::Off => {
                // During the transition there is one picture, the bent one.
                let has = |side: fn(&Shown) -> &Option<Frame>| {
                    model.shown.as_deref().is_some_and(|shown| side(shown).is_some())
                };
                let both = has(|shown| &shown.bent) && has(|shown| &shown.straight);
                let is_bent = if both { model.look.bent } else { has(|shown| &shown.bent) };
                draw(if is_bent { bent } else { straight }, rect);
            }
        }
        if model.look.inset && model.look.compare == Compare::Off {
            let small = Rect::from_min_size(free.min + vec2(10.0, 10.0), 0.28 * rect.size());
            if let Some(texture) = if model.look.bent { straight } else { bent } {
                painter.image(texture.id(), small, whole, Color32::WHITE);
                painter.rect_stroke(small, 2.0, Stroke::new(1.5, Color32::WHITE), eframe::egui::StrokeKind::Outside);
                let words = tr(if model.look.bent { "straight view" } else { "bent view" });
                label(painter, small.center_top() + vec2(0.0, 4.0), Align2::CENTER_TOP, words);
            }
        }
        frame_corners(painter, rect, model);
        self.marks(painter, (rect, free), model);
    }

    /// Labels over the picture: state, messages, the picked point.
    fn marks(&self, painter: &Painter, (rect, free): (Rect, Rect), model: &Model) {
        let Some(shown) = &model.shown else {
            let words = model.violated.as_deref().or(model.opening.as_deref()).unwrap_or(tr("opening the scene"));
            painter.text(free.center(), Align2::CENTER_CENTER, words, FontId::proportional(15.0), Color32::GRAY);
            return;
        };
        let moving = matches!(shown.pace, Pace::Moving { .. });
        if moving && shown.session.view().is_bent() && shown.bent.is_some() {
            label(painter, free.right_bottom() + vec2(-8.0, -8.0), Align2::RIGHT_BOTTOM, tr("bent view"));
        }
        let mut top = free.center_top() + vec2(0.0, 8.0);
        if model.opening.is_some() || model.works_since().is_some_and(|since| since > PATIENT) || model.is_stopped() {
            top.y += 54.0;
        }
        if let Some(waits) = shown.waits {
            label(painter, top, Align2::CENTER_TOP, &heard(waits));
            top.y += 26.0;
        }
        if let Some(reason) = &model.violated {
            let galley = painter.layout(reason.clone(), FontId::proportional(13.0), Color32::WHITE, 0.7 * free.width());
            let frame =
                Rect::from_center_size(top + vec2(0.0, 0.5 * galley.size().y + 6.0), galley.size() + vec2(20.0, 12.0));
            painter.rect_filled(frame, 4.0, Color32::from_rgb(160, 50, 36));
            painter.galley(frame.min + vec2(10.0, 6.0), galley, Color32::WHITE);
        }
        if model.look.statistics {
            let stats = shown.bent.as_ref().or(shown.straight.as_ref()).map(|frame| &frame.stats);
            let whole = |value: f64| format!("{value:.0}");
            let words = fill(
                tr(
                    "CPU renderer · {0} ms, drawing {1} ms · {2} triangles · {3} % of the pixels' width · input to picture {4} ms",
                ),
                &[
                    &whole(shown.milliseconds),
                    &whole(stats.map_or(0.0, |s| s.milliseconds)),
                    &stats.map_or(0, |s| s.triangles_drawn),
                    &whole(100.0 * shown.quality.width()),
                    &whole(model.latency().unwrap_or_default()),
                ],
            );
            // Placed above the mark that is part of the picture.
            label(painter, free.right_bottom() + vec2(-8.0, -44.0), Align2::RIGHT_BOTTOM, &words);
        }
        if let Some((point, name)) = &self.picked
            && let Some(at) = image_of(*point, rect, model)
        {
            painter.circle_stroke(at, 6.0, Stroke::new(2.5, Color32::WHITE));
            painter.circle_stroke(at, 6.0, Stroke::new(1.2, INK));
            let words = format!("{name}  {}", coordinates(*point, shown.session.scene().unit));
            label(painter, at + vec2(10.0, -10.0), Align2::LEFT_BOTTOM, &words);
        }
    }

    /// Shows the true coordinates under the pointer.
    fn tell(&self, painter: &Painter, rect: Rect, at: DVec2, model: &Model) {
        let (Some(point), Some(shown)) = (model.world_at(at), &model.shown) else { return };
        let layer = model.layer_at(at).unwrap_or_default();
        let words = format!("{}   {layer}", coordinates(point, shown.session.scene().unit));
        label(painter, rect.left_bottom() + vec2(8.0, -8.0), Align2::LEFT_BOTTOM, &words);
    }

    /// The menu of a place: a right click, or a long press of a finger.
    fn menu(&mut self, response: &Response, rect: Rect, model: &mut Model) {
        if response.secondary_clicked() {
            let at = response.interact_pointer_pos();
            self.place = at.and_then(|at| model.world_at(share(rect, at)));
        }
        let (Some(point), Some(unit)) = (self.place, model.shown.as_ref().map(|shown| shown.session.scene().unit))
        else {
            return;
        };
        response.context_menu(|ui| {
            if ui.button(tr("Fly here")).clicked() {
                model.visit(&Aabb::of([point]), ui.ctx());
            }
            if ui.button(tr("Measure from here")).clicked() {
                self.measure.begin_at(point, model);
            }
            if ui.button(tr("Copy the coordinates")).clicked() {
                ui.ctx().copy_text(coordinates(point, unit));
            }
        });
    }

    fn click(&mut self, at: DVec2, model: &mut Model) {
        if model.look.tool == Tool::Measure {
            self.measure.add(at, model);
            return;
        }
        let Some((layer, point)) = clicked(at, model) else {
            self.picked = None;
            return;
        };
        if model.look.tool == Tool::Residue {
            let select = model.object_at(at, &layer, point);
            if !crate::panels::layers::choose_clicked(model, &layer, select) {
                model.notices.tell(tr("There is no molecule; click one of its atoms."));
                return;
            }
            model.look.tool = Tool::Map;
            return;
        }
        if let Tool::Move(kind) = model.look.tool {
            if let Some(point) = point {
                crate::panels::moves::place(model, kind, point);
                model.look.tool = Tool::Map;
            }
            return;
        }
        if model.look.tool == Tool::Track {
            if !crate::panels::rays::can_track(model, &layer) {
                model
                    .notices
                    .tell(tr("The ground cannot be kept in sight; click a line, a point, a building or a model."));
                return;
            }
            let target = model.object_at(at, &layer, point).unwrap_or(layer);
            crate::panels::rays::track(model, &target);
            model.look.tool = Tool::Map;
            return;
        }
        self.picked = point.map(|point| (point, layer));
    }

    /// The bar between the two halves.
    fn bar(&self, ui: &mut Ui, rect: Rect, model: &mut Model) {
        let x = rect.left() + model.look.split * rect.width();
        let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(14.0, rect.height()));
        let response = ui.interact(grip, ui.scope_id().with("split"), Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, tr("Bar between straight and bent")));
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            model.look.split = ((at.x - rect.left()) / rect.width()).clamp(0.02, 0.98);
        }
        let painter = ui.painter();
        painter.vline(x, rect.y_range(), Stroke::new(2.0, Color32::WHITE));
        label(painter, pos2(x - 8.0, rect.top() + 8.0), Align2::RIGHT_TOP, tr("straight"));
        label(painter, pos2(x + 8.0, rect.top() + 8.0), Align2::LEFT_TOP, tr("bent"));
        response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    }
}

/// Length of the marks at the corners of the document's frame, points.
const CORNER: f32 = 14.0;
/// Share of the picture that the frame leaves out on each side, beyond which its corners are marked.
const APART: f64 = 0.01;

/// Marks the corners of what an exported picture shows, where the picture in the window shows more.
fn frame_corners(painter: &Painter, rect: Rect, model: &Model) {
    let Some([w, h]) = model.frame_shares().filter(|_| model.shown.is_some()) else { return };
    if w.min(h) > 1.0 - 2.0 * APART {
        return;
    }
    let size = vec2(w.min(1.0) as f32 * rect.width(), h.min(1.0) as f32 * rect.height());
    let frame = Rect::from_center_size(rect.center(), size).shrink(1.0);
    for corner in [frame.left_top(), frame.right_top(), frame.right_bottom(), frame.left_bottom()] {
        let inwards = frame.center() - corner;
        let ends = [vec2(inwards.x.signum() * CORNER, 0.0), vec2(0.0, inwards.y.signum() * CORNER)];
        for (width, color) in [(3.0, Color32::from_black_alpha(90)), (1.2, Color32::WHITE)] {
            for end in ends {
                painter.line_segment([corner, corner + end], Stroke::new(width, color));
            }
        }
    }
}

/// The ring around what was found, which closes in and fades.
fn ring(painter: &Painter, rect: Rect, ctx: &Context, model: &Model) {
    let Some(at) = model.ring.as_ref().and_then(|ring| image_of(ring.point, rect, model)) else { return };
    let over = model.ring_share(ctx);
    let (radius, left) = (18.0 + 26.0 * (1.0 - 3.0 * over).max(0.0), (3.0 * (1.0 - over)).min(1.0));
    painter.circle_stroke(at, radius, Stroke::new(5.0, Color32::WHITE.gamma_multiply(0.8 * left)));
    painter.circle_stroke(at, radius, Stroke::new(2.5, MARK.gamma_multiply(left)));
}

/// A label: text on a light background.
fn label(painter: &Painter, at: Pos2, align: Align2, words: &str) {
    let galley = painter.layout_no_wrap(words.to_owned(), FontId::proportional(13.0), INK);
    let rect = align.anchor_size(at, galley.size() + vec2(12.0, 6.0));
    painter.rect_filled(rect, 3.0, PAPER);
    painter.galley(rect.min + vec2(6.0, 3.0), galley, INK);
}

/// A frame as an image of the window.
pub(crate) fn image_of_frame(frame: &Frame) -> ColorImage {
    ColorImage::from_rgb([frame.width, frame.height], frame.color.as_flattened())
}

/// Layer and world point that a click takes: of solids that something shines through the nearest, else what the picture shows.
fn clicked(at: DVec2, model: &Model) -> Option<(String, Option<DVec3>)> {
    let session = &model.shown.as_ref()?.session;
    if model.look.bent && session.scene().has_see_through() {
        let [w, h] = session.view().pinhole().image.map(f64::from);
        let picked = session.pick(&[(at * DVec2::new(w, h)).to_array()]).ok()?.pop()??;
        return Some((picked.layer, Some(DVec3::from_array(picked.point))));
    }
    Some((model.layer_at(at)?, model.world_at(at)))
}

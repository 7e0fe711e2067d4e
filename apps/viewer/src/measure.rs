//! Measuring: points set in the picture, their lengths along the true ground, and a height profile.

use crate::language::{fill, tr};
use crate::model::{Model, Tool};
use crate::pointer::share;
use crate::points::{Places, coordinates, has_same_layers};
use belvedere::core::{DVec2, DVec3};
use belvedere::scene::{Scene, Unit};
use belvedere::scene_file::Document;
use belvedere_studio::{Lengths, ground_way, lengths, lengths_geojson};
use eframe::egui::{
    Align, Align2, Area, Color32, Context, CursorIcon, FontId, Frame, Grid, Id, Key, Layout, Mesh, Modifiers, Order,
    Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;

/// Width and height of the profile, points.
const PROFILE: [f32; 2] = [250.0, 66.0];
/// Size of the handle of a point, points.
const GRAB: f32 = 22.0;
/// Pieces of the drawn way from one point to the next.
const PIECES: usize = 96;
const INK: Color32 = Color32::from_rgb(176, 32, 84);

/// Points that were set, and their lengths.
#[derive(Default)]
pub(crate) struct Measure {
    points: Vec<DVec3>,
    /// Lengths of the points, and the way that is drawn; made anew when the points change.
    of: Option<(Lengths, Vec<DVec3>)>,
    /// The document that they are lengths in.
    document: Option<Arc<Document>>,
    /// Number of the scene that the points lie in.
    scene: u64,
    /// Whether the last measurement is at an end.
    ended: bool,
}

impl Measure {
    /// Sets the next point at a position of the picture (shares of width and height); a new measurement after the end of the last.
    pub(crate) fn add(&mut self, at: DVec2, model: &Model) {
        let Some(point) = surface_at(at, model) else { return };
        if std::mem::take(&mut self.ended) {
            self.points.clear();
        }
        self.points.push(point);
        self.of = None;
    }

    /// Begins anew at a point.
    pub(crate) fn begin_at(&mut self, point: DVec3, model: &mut Model) {
        (self.points, self.of, self.ended) = (vec![point], None, false);
        model.look.tool = Tool::Measure;
    }

    /// Ends the measurement; its figures stay.
    pub(crate) fn end(&mut self, model: &mut Model) {
        self.ended = true;
        model.look.tool = Tool::Map;
    }

    /// Draws way, points and figures, and lets the points be dragged.
    pub(crate) fn show(&mut self, ui: &mut Ui, picture: &Response, (rect, free): (Rect, Rect), model: &mut Model) {
        if self.scene != model.scenes {
            *self = Self { scene: model.scenes, ..Self::default() };
        }
        let measures = model.look.tool == Tool::Measure;
        let is_free = ui.ctx().memory(|memory| memory.focused().is_none());
        if measures && is_free && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
            self.end(model);
        }
        if measures && picture.double_clicked() {
            self.end(model);
        }
        let Some(shown) = &model.shown else { return };
        let is_same = |of: &Arc<Document>| has_same_layers(of, &shown.document);
        if (self.of.is_none() || !self.document.as_ref().is_some_and(is_same)) && !self.points.is_empty() {
            let scene = shown.session.scene();
            self.of = Some((lengths(scene, &self.points), drawn_way(scene, &self.points)));
            self.document = Some(shown.document.clone());
        }
        self.draw(&ui.painter_at(rect), rect, model);
        self.handles(ui, rect, model);
        if measures || !self.points.is_empty() {
            self.panel(ui.ctx(), free, model);
        }
    }

    fn draw(&self, painter: &Painter, rect: Rect, model: &Model) {
        let (Some((_, way)), Some(places)) = (&self.of, Places::of(rect, model)) else { return };
        let images: Vec<Option<Pos2>> = way.iter().map(|p| places.at(*p)).collect();
        for (width, color) in [(4.5, Color32::from_white_alpha(210)), (2.2, INK)] {
            for run in images.split(Option::is_none).filter(|run| run.len() > 1) {
                let line: Vec<Pos2> = run.iter().flatten().copied().collect();
                painter.add(Shape::line(line, Stroke::new(width, color)));
            }
        }
    }

    fn handles(&mut self, ui: &Ui, rect: Rect, model: &mut Model) {
        let mut moved = None;
        let mut ends = false;
        let spots: Vec<Option<Pos2>> =
            Places::of(rect, model).map_or_else(Vec::new, |places| self.points.iter().map(|p| places.at(*p)).collect());
        for (i, at) in spots.into_iter().enumerate() {
            let Some(at) = at else { continue };
            let (id, area) = (ui.scope_id().with(("measured", i)), Rect::from_center_size(at, vec2(GRAB, GRAB)));
            let response = ui.interact(area, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::Move);
            let name = fill(tr("Measured point {0}"), &[&(i + 1)]);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            let radius = if response.hovered() || response.dragged() { 6.5 } else { 5.0 };
            ui.painter().circle(at, radius, INK, Stroke::new(2.0, Color32::WHITE));
            // A second click on the last point ends, soon after the first or late.
            ends |= response.clicked() && i + 1 == self.points.len();
            if response.dragged()
                && response.drag_delta() != vec2(0.0, 0.0)
                && let Some(to) = response.interact_pointer_pos()
            {
                moved = surface_at(share(rect, to), model).map(|point| (i, point));
            }
        }
        if let Some((i, point)) = moved {
            self.points[i] = point;
            self.of = None;
        }
        if ends && model.look.tool == Tool::Measure {
            self.end(model);
        }
    }

    fn panel(&mut self, ctx: &Context, free: Rect, model: &mut Model) {
        let area = Area::new(Id::unique("measure"))
            .order(Order::Middle)
            .pivot(Align2::LEFT_BOTTOM)
            .default_pos(free.left_bottom() + vec2(10.0, -38.0))
            .constrain_to(free);
        area.show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(PROFILE[0].min(free.width() - 40.0));
                // The panel leaves the picture as much room as it can.
                (ui.spacing_mut().interact_size.y, ui.spacing_mut().item_spacing) = (15.0, vec2(6.0, 2.0));
                ui.strong(tr("Measured"));
                // The buttons below keep their identities when figures come.
                ui.scope(|ui| match &self.of {
                    Some((of, _)) if self.points.len() > 1 => figures(ui, of, model),
                    _ => drop(
                        ui.label(tr("Click points in the picture; a second click on the last one or Escape ends.")),
                    ),
                });
                self.buttons(ui, model);
            });
        });
    }

    fn buttons(&mut self, ui: &mut Ui, model: &mut Model) {
        let scene = model.shown.as_ref().map(|shown| shown.session.scene());
        let mut clears = false;
        ui.horizontal_wrapped(|ui| {
            if let (Some(scene), false) = (scene, self.points.is_empty()) {
                if ui.small_button(tr("Copy as text")).clicked() {
                    ui.ctx().copy_text(self.text(scene));
                }
                if ui.small_button(tr("Copy as GeoJSON")).clicked() {
                    ui.ctx().copy_text(lengths_geojson(scene, &self.points, false).to_string());
                }
                if self.points.len() > 2 && ui.small_button(tr("Copy the area as GeoJSON")).clicked() {
                    ui.ctx().copy_text(lengths_geojson(scene, &self.points, true).to_string());
                }
                if ui.small_button(tr("Remove the last point")).clicked() {
                    self.points.pop();
                    self.of = None;
                }
            }
            clears = ui.small_button(tr("Close the measurement")).clicked();
        });
        if clears {
            (self.points, self.of) = (Vec::new(), None);
            self.end(model);
        }
    }

    /// The figures and the points as text.
    fn text(&self, scene: &Scene) -> String {
        let Some((of, _)) = &self.of else { return String::new() };
        let rows = rows(of, scene.unit).into_iter().map(|(name, value)| format!("{name}\t{value}"));
        let points = self.points.iter().map(|point| coordinates(*point, scene.unit));
        let crs = fill(tr("coordinates in {0}"), &[&scene.crs]);
        rows.chain([crs]).chain(points).collect::<Vec<_>>().join("\n")
    }
}

/// World point of the surface that the picture shows: that of the pixel's middle, on the ground exactly.
fn surface_at(at: DVec2, model: &Model) -> Option<DVec3> {
    let shown = model.shown.as_ref()?;
    let frame = if model.look.bent { shown.bent.as_ref() } else { shown.straight.as_ref() }?;
    let size = DVec2::new(frame.width as f64, frame.height as f64);
    let at = ((at * size).floor() + 0.5) / size;
    let point = model.world_at(at)?;
    let layer = model.layer_at(at)?;
    let scene = shown.session.scene();
    let is_ground = scene.layers.iter().any(|one| one.id == layer && one.kind.terrain().is_some());
    let ground = scene.terrain().filter(|_| is_ground).and_then(|ground| ground.surface_at(point.truncate()));
    Some(ground.map_or(point, |z| point.with_z(z)))
}

/// The way as it is drawn: along the ground where there is some, at every point itself.
fn drawn_way(scene: &Scene, points: &[DVec3]) -> Vec<DVec3> {
    let mut way = Vec::new();
    for pair in points.windows(2) {
        way.push(pair[0]);
        if let Some(ground) = scene.terrain().and_then(|ground| ground_way(ground, pair)) {
            let step = ground.len().div_ceil(PIECES).max(1);
            way.extend(ground.into_iter().skip(1).step_by(step));
        } else {
            way.extend((1..PIECES).map(|k| pair[0].lerp(pair[1], k as f64 / PIECES as f64)));
        }
        way.push(pair[1]);
    }
    way
}

/// Names and values of the figures.
fn rows(of: &Lengths, unit: Unit) -> Vec<(&'static str, String)> {
    let along = of.along_ground.map(|length| (tr("along the ground"), long(length, unit)));
    let area = of.area.map(|area| (tr("area in plan"), wide(area)));
    let climb = [(tr("climb"), of.climb), (tr("descent"), of.descent)].map(|(name, by)| (name, high(by, unit)));
    let straight = (tr("straight"), long(of.straight, unit));
    along.into_iter().chain([straight]).chain(climb).chain(area).collect()
}

/// A length in the unit of the scene.
fn long(length: f64, unit: Unit) -> String {
    match unit {
        Unit::Metre if length >= 1000.0 => format!("{:.3} km", length / 1000.0),
        Unit::Metre => format!("{length:.1} m"),
        Unit::Angstrom => format!("{length:.2} Å"),
        Unit::Voxel => fill(tr("{0} voxels"), &[&format!("{length:.1}")]),
    }
}

/// A height in the unit of the scene: metres stay metres.
fn high(height: f64, unit: Unit) -> String {
    if unit == Unit::Metre { format!("{height:.0} m") } else { long(height, unit) }
}

/// An area in metres or kilometres.
fn wide(area: f64) -> String {
    if area >= 1e6 { format!("{:.3} km²", area / 1e6) } else { format!("{area:.0} m²") }
}

fn figures(ui: &mut Ui, of: &Lengths, model: &Model) {
    let Some(shown) = &model.shown else { return };
    let unit = shown.session.scene().unit;
    Grid::new("lengths").num_columns(2).min_col_width(118.0).show(ui, |ui| {
        for (name, value) in rows(of, unit) {
            ui.label(name);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.monospace(value));
            ui.end_row();
        }
    });
    profile(ui, of, unit);
    if shown.session.view().stages().iter().any(|stage| stage.moves_ground()) {
        ui.weak(tr("Lengths are of the true ground, not of the moved one."));
    } else if shown.session.view().is_bent() {
        ui.weak(tr("Lengths are of true space, not of the bent picture."));
    }
    if of.along_ground.is_none() && shown.session.scene().terrain().is_some() {
        ui.weak(tr("There is no ground below a part of it."));
    }
}

/// Height over distance, with the heights at its ends.
fn profile(ui: &mut Ui, of: &Lengths, unit: Unit) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), PROFILE[1]), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, tr("Height profile")));
    let [low, most] = of.profile.iter().fold([f64::MAX, f64::MIN], |[low, most], p| [low.min(p[1]), most.max(p[1])]);
    let (far, span) = (of.profile.last().map_or(0.0, |p| p[0]), (most - low).max(1e-9));
    if far <= 0.0 {
        return;
    }
    let plot = rect.shrink2(vec2(2.0, 6.0));
    let at = |p: &[f64; 2]| {
        let [x, y] = [p[0] / far, (p[1] - low) / span].map(|share| share as f32);
        pos2(plot.left() + x * plot.width(), plot.bottom() - y * plot.height())
    };
    let painter = ui.painter_at(rect);
    let line: Vec<Pos2> = of.profile.iter().map(at).collect();
    let mut below = Mesh::default();
    for (i, top) in (0u32..).zip(&line) {
        below.colored_vertex(*top, INK.gamma_multiply(0.2));
        below.colored_vertex(pos2(top.x, plot.bottom()), INK.gamma_multiply(0.2));
        if i > 0 {
            below.add_triangle(2 * i - 2, 2 * i - 1, 2 * i);
            below.add_triangle(2 * i - 1, 2 * i, 2 * i + 1);
        }
    }
    painter.add(below);
    painter.add(Shape::line(line, Stroke::new(1.6, INK)));
    let color = ui.visuals().text_color();
    let ends = [(most, rect.left_top(), Align2::LEFT_TOP), (low, rect.left_bottom(), Align2::LEFT_BOTTOM)];
    for (value, corner, align) in ends {
        painter.text(corner, align, high(value, unit), FontId::proportional(10.5), color);
    }
    painter.text(rect.right_bottom(), Align2::RIGHT_BOTTOM, long(far, unit), FontId::proportional(10.5), color);
}

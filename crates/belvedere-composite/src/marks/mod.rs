//! Lines, outlines, points and names, drawn over the surfaces.

mod alike;
mod area_names;
mod baseline;
mod candidates;
mod dash;
mod distance;
mod drawing;
mod drawn;
mod face;
mod label;
mod line_of_sight;
mod name_memory;
mod names;
mod occupied;
mod path;
mod placed;
mod point;
mod pole;
mod pylons;
mod request;
mod residue_names;
mod ribbon;
mod segment;
mod shapes;
mod shown;
mod symbol;
mod symbols;
mod visibility;
mod ways;

use crate::canvas::{Canvas, Fonts};
use crate::color::{Packed, linear};
use crate::depths::{DepthTiles, Depths};
use crate::drawn::{Drawn, Sight};
use crate::skyline::Skyline;
use alike::alike;
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{
    AreaLayer, Color, FrameStats, Hidden, Layer, LayerKind, LineClass, LineFeature, LineLayer, Overlay, OverlayLine,
    ROWS, RenderJob, Scene, Symbol,
};
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::{COARSE_PX, Screen};
use belvedere_sight::sections::Sections;
use drawing::PlacedDrawing;
use face::Face;
use label::Labels;
use line_of_sight::LineOfSight;
use name_memory::Choice;
pub use name_memory::{NameMemory, Patience};
use path::LinePoint;
use placed::Placed;
use point::PointMarks;
use rayon::prelude::*;
use request::{LabelRequest, Page};
use ribbon::{Ink, Lane, Stroke, StrokeLayer};
pub use shapes::{LayerShapes, LineShape, Paint, Role, Shapes, SymbolShape, outline, simplified};
use visibility::{DepthMap, LineVisibility, Run, Station};

/// Width of a hidden line in widths of the visible one.
const HIDDEN_WIDTH: f64 = 0.6;

/// All marks of a frame, in the order of drawing: outlines and lines in the order of the layers, then points, whose symbols no line crosses;
/// of each, first those of context, then those that must be seen.
#[derive(Debug, Default)]
pub struct Marks {
    under: Vec<StrokeLayer>,
    faces: Vec<Face>,
    sheets: Vec<StrokeLayer>,
    /// Symbols of the scene's own.
    drawings: Vec<PlacedDrawing>,
    labels: Labels,
    left_out: LeftOut,
}

/// Numbers of symbols and names that found no room.
#[derive(Debug, Clone, Copy, Default)]
struct LeftOut {
    symbols: u64,
    names: u64,
}

impl Marks {
    /// Places all marks of a job over its drawn surfaces.
    pub fn new(job: &RenderJob<'_>, drawn: &Drawn<'_>) -> Self {
        Self::place(job, drawn, Purpose::Picture)
    }

    /// The names of a job that is the frame of a film, in their places; a name stays where it was in the frame before while it can.
    ///
    /// * `job`: without names given beforehand; `before`: the names of the frame before, none at first.
    /// * `patience`: for how many frames a name stays whose point is hidden, and for how many one that went stays away.
    pub fn next_names(
        job: &RenderJob<'_>,
        drawn: &Drawn<'_>,
        (before, patience): (&NameMemory, Patience),
    ) -> NameMemory {
        Self::place(job, drawn, Purpose::Names(Choice::Next(before, patience))).labels.into_memory()
    }

    /// Whether a scene may have names, symbols with texts or marks of distances.
    pub fn are_named(scene: &Scene) -> bool {
        scene.layers.iter().any(|layer| match &layer.kind {
            LayerKind::Line(line) => line.label_px.is_some() || line.markers.is_some(),
            LayerKind::Area(area) => area.label_px.is_some(),
            LayerKind::Point(point) => point.style.label_px.is_some(),
            LayerKind::Molecule(molecule) => molecule.label_px.is_some(),
            _ => false,
        })
    }

    /// The marks of a job as shapes: the ones that [`Marks::new`] places, to be written instead of drawn.
    pub fn shapes(job: &RenderJob<'_>, drawn: &Drawn<'_>) -> Shapes {
        let marks = Self::place(job, drawn, Purpose::Shapes);
        let of = |sheets: &[StrokeLayer]| sheets.iter().map(StrokeLayer::shapes).collect();
        let mut names = Vec::new();
        marks.write_names(&mut Canvas::recording(&mut names, job.view.pinhole().image.map(|side| side as usize)));
        Shapes { under: of(&marks.under), layers: of(&marks.sheets), names }
    }

    /// Where the marks of a job read the depths of the surfaces, which are not drawn yet.
    ///
    /// * `drawn`: its depths and rays are not used.
    pub fn wanted_depths(job: &RenderJob<'_>, drawn: &Drawn<'_>) -> DepthTiles {
        let tiles = DepthTiles::new([drawn.screen.width, drawn.screen.height].map(|side| side.max(0) as usize));
        Self::place(job, &Drawn { depth: Depths::Wanted(&tiles), sight: &NoSight, ..*drawn }, Purpose::Picture);
        tiles
    }

    /// Whether the marks of a job stand where the sky begins: names of points do.
    pub fn read_skyline(job: &RenderJob<'_>) -> bool {
        let named = |kind: &LayerKind| kind.points().is_some_and(|p| p.style.label_px.is_some());
        job.scene.layers.iter().any(|layer| named(&layer.kind))
    }

    fn place(job: &RenderJob<'_>, drawn: &Drawn<'_>, purpose: Purpose<'_>) -> Self {
        if !job.options.marks {
            return Self::default();
        }
        let Drawn { passes, screen, tolerance_px, depth, sight } = *drawn;
        let map = DepthMap { depth, width: screen.width, height: screen.height };
        let sections = Sections::new(job);
        let skyline = match depth {
            Depths::Whole(depth) if Self::read_skyline(job) => Skyline::of(depth, screen.width.max(0) as usize),
            Depths::Tiles(tiles) => tiles.skyline.clone(),
            _ => Skyline::default(),
        };
        let choice = match (purpose, &job.options.names) {
            (Purpose::Names(choice), _) => choice,
            (_, Some(names)) => Choice::Given(names),
            _ => Choice::Free,
        };
        let fonts = Fonts::with(&job.scene.fonts);
        let sight = LineOfSight { scene: job.scene, sight };
        let builder = MarkBuilder {
            sections: sections.as_ref(),
            scene: job.scene,
            passes,
            records: job.view.records(),
            screen,
            tolerance_px,
            map,
            sight: &sight,
            eye: job.view.pinhole().eye,
            density: job.options.density,
            fonts: &fonts,
            skyline: &skyline,
            keep: matches!(purpose, Purpose::Shapes),
            names_alone: matches!(purpose, Purpose::Names(_)),
            choice,
        };
        let (mut context, mut subject) = (Placed::default(), Placed::default());
        for (i, layer) in job.scene.layers.iter().enumerate() {
            builder.layer(i, layer, if layer.must_see { &mut subject } else { &mut context });
        }
        let overlay = &job.options.overlay;
        let with_text = |l: &&OverlayLine| !builder.names_alone || !l.label.is_empty();
        // Texts of the grid find room first, then those of what must be seen.
        let mut requests = Vec::new();
        let under = overlay.under.iter().filter(with_text).map(|l| builder.overlay_line(l, &mut requests)).collect();
        let (size, density, keep_clear) = (2.0 * screen.center, job.options.density, &job.options.keep_clear[..]);
        let must_see = subject.lines(density);
        let without_room = symbols::keep_off(&mut context.symbols, &must_see)
            + symbols::thin([&mut context.symbols, &mut subject.symbols], keep_clear);
        // Lines, then symbols; of both, what must be seen is drawn over the rest.
        let must_see = subject.with_symbols(must_see);
        let mut points = PointMarks::default();
        let [lines, of_subject] = [&mut context, &mut subject].map(|placed| std::mem::take(&mut placed.sheets));
        let subject = subject.drawn(&builder, &mut points, &mut requests);
        let context = context.drawn(&builder, &mut points, &mut requests);
        let mut sheets: Vec<StrokeLayer> = [lines, of_subject, context, subject].into_iter().flatten().collect();
        sheets.extend(overlay.over.iter().filter(with_text).map(|l| builder.overlay_line(l, &mut requests)));
        sheets.extend(overlay.points.iter().map(|p| builder.overlay_point(p, &mut requests)));
        if map.only_asks() {
            return Self::default();
        }
        let faces = overlay
            .faces
            .iter()
            .flat_map(|f| passes.iter().take(job.view.records()).filter_map(|p| Face::new(f, p, screen)));
        let labels = Labels::place(requests, &Page { size, density, fonts: &fonts, keep_clear, must_see }, choice);
        let left_out = LeftOut { symbols: without_room, names: labels.left_out() };
        Self { under, faces: faces.collect(), sheets, drawings: points.drawings, labels, left_out }
    }

    /// Whether the job may have any marks.
    pub fn are_in(job: &RenderJob<'_>) -> bool {
        let drawn = |kind: &LayerKind| match kind {
            LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_) | LayerKind::Volume(_) => true,
            LayerKind::Molecule(molecule) => molecule.label_px.is_some(),
            _ => false,
        };
        job.scene.layers.iter().any(|l| drawn(&l.kind)) || job.options.overlay != Overlay::default()
    }

    /// Draws the rows from `y0` on, one band; `depth` as in [`Marks::new`].
    pub fn draw(&self, y0: i32, screen: &Screen, depth: &[f32], color: &mut [Packed], id: &mut [u32]) {
        let mut masks = ribbon::CoverageMasks::default();
        for sheet in &self.under {
            sheet.draw(&mut masks, y0, screen.width, color, id);
        }
        for face in &self.faces {
            face.draw(screen, y0, color, depth);
        }
        for sheet in &self.sheets {
            sheet.draw(&mut masks, y0, screen.width, color, id);
        }
    }

    /// Coverage of the pixels of a band by parts of lines, outlines and points that nothing hides, 0..=1 with their opacity; empty if
    /// there are none. `y0` is the first row, `pixels` the size of the band.
    pub(crate) fn visible_cover(&self, y0: i32, screen: &Screen, pixels: usize) -> Vec<f32> {
        let mut masks = ribbon::CoverageMasks::default();
        let mut cover = Vec::new();
        for sheet in &self.sheets {
            sheet.add_visible(&mut masks, y0, screen.width, pixels, &mut cover);
        }
        cover
    }

    /// The counts of a picture with those of the marks that found no room.
    pub fn counted(&self, stats: FrameStats) -> FrameStats {
        let LeftOut { symbols, names } = self.left_out;
        FrameStats { symbols_left_out: symbols, names_left_out: names, ..stats }
    }

    /// Draws symbols of the scene's own and writes the names over the finished picture, or over some of its rows.
    pub fn write_names(&self, canvas: &mut Canvas<'_>) {
        self.drawings.iter().for_each(|drawing| drawing.draw(canvas));
        self.labels.draw(canvas);
    }
}

/// What marks are placed for.
#[derive(Clone, Copy)]
enum Purpose<'a> {
    Picture,
    /// Lines are kept as shapes.
    Shapes,
    /// Nothing but names.
    Names(Choice<'a>),
}

/// Rays of a picture that is not drawn yet.
struct NoSight;

impl Sight for NoSight {
    fn first_depth(&self, _: DVec2) -> Option<f64> {
        None
    }
}

struct MarkBuilder<'a> {
    sections: Option<&'a Sections<'a>>,
    scene: &'a Scene,
    /// All passes of the view, the first ones of its records.
    passes: &'a [&'a Pass<'a>],
    records: usize,
    screen: &'a Screen,
    tolerance_px: f64,
    map: DepthMap<'a>,
    sight: &'a LineOfSight<'a>,
    eye: DVec3,
    /// Pixels per unit of lengths that styles do not state.
    density: f64,
    /// Fonts of names.
    fonts: &'a Fonts,
    skyline: &'a Skyline,
    /// Whether lines are kept as shapes.
    keep: bool,
    /// Whether nothing but names is wanted.
    names_alone: bool,
    choice: Choice<'a>,
}

/// Width and treatment of hidden parts of a line.
#[derive(Clone, Copy)]
struct Style {
    half_px: f64,
    casing_px: Option<f64>,
    hidden: Hidden,
    lift_m: f64,
}

/// Symbol of a point and treatment of hidden ones.
#[derive(Clone, Copy)]
struct Marker {
    symbol: Symbol,
    half_px: f64,
    casing: bool,
    hidden: Hidden,
}

impl<'a> MarkBuilder<'a> {
    /// The passes that draw the contents of some boxes, each image once: the records, or the segments where the records leave something
    /// out; segments part at the ends of the turns.
    fn passes_for(&self, boxes: impl Iterator<Item = Aabb>) -> &'a [&'a Pass<'a>] {
        let (records, segments) = self.passes.split_at(self.records.min(self.passes.len()));
        let mut boxes = boxes;
        let left_out = |b: &Aabb| segments.iter().any(|s| s.fills_in(self.screen, b));
        if !segments.is_empty() && boxes.any(|b| left_out(&b)) { segments } else { records }
    }
}

impl MarkBuilder<'_> {
    fn casing_of(&self, half_px: f64) -> f64 {
        casing_of(half_px, self.density)
    }

    /// The screen of a coarse picture; `None` for any other.
    fn coarse(&self) -> Option<&Screen> {
        (self.tolerance_px >= COARSE_PX).then_some(self.screen)
    }

    /// Adds the marks of a layer.
    fn layer(&self, i: usize, layer: &Layer, out: &mut Placed) {
        let (id, first) = (i as u32 + 1, out.requests.len());
        // Names stay off the lines that must be seen.
        let is_drawn = !self.names_alone || layer.must_see;
        match &layer.kind {
            LayerKind::Line(l) => {
                let l = &*self.shown_lines(i, l);
                if is_drawn {
                    out.sheets.extend(self.line_sheets(l, id));
                }
                out.sheets.extend(self.distances(l, id, &mut out.requests));
                out.requests.extend(self.line_names(l, id));
            }
            LayerKind::Area(a) => {
                if is_drawn {
                    out.sheets.extend(self.outlines(a, id));
                }
                out.requests.extend(self.area_names(i, a));
            }
            LayerKind::Point(p) => out.symbols.extend(self.points(&self.shown_points(i, p), id)),
            LayerKind::Molecule(m) => out.requests.extend(self.residue_names(m)),
            _ => {}
        }
        out.requests[first..].iter_mut().for_each(|request| request.layer = id);
    }

    fn line_sheets(&self, layer: &LineLayer, id: u32) -> Vec<StrokeLayer> {
        let sheet = |group: alike::Alike<'_, LineFeature>| {
            let half_px = 0.5 * width_or_none(group.scale * layer.width_px, self.density);
            let casing = group.casing.or(layer.casing);
            let casing_px = casing.map(|_| self.casing_of(half_px));
            let style = Style { half_px, casing_px, hidden: layer.hidden, lift_m: layer.lift_m };
            let mut paths: Vec<Vec<LinePoint>> = group
                .features
                .par_iter()
                .map(|f| path::drape(self.scene, &f.points, layer.lift_m, self.coarse()))
                .collect();
            let mut strokes = Vec::new();
            if group.class == Some(LineClass::Lift) {
                let lifts = group.features.iter();
                paths.extend(lifts.flat_map(|lift| self.pylons(lift, (layer.lift_m, style), &mut strokes)));
            }
            self.sheet(paths, style, inks(group.color, casing, layer.hidden), id).with_strokes(strokes)
        };
        alike(&layer.features, layer.color, |f| f.style).into_iter().map(sheet).collect()
    }

    fn outlines(&self, layer: &AreaLayer, id: u32) -> Option<StrokeLayer> {
        let color = layer.outline?;
        let mut paths: Vec<Vec<LinePoint>> = Vec::new();
        for ring in layer.features.iter().flat_map(|f| &f.rings) {
            let closed = ring.iter().chain(ring.first()).map(|xy| xy.extend(0.0));
            paths.extend(path::lay(self.scene, &closed.collect::<Vec<_>>(), layer.lift_m, self.coarse()));
        }
        let half_px = 0.5 * width_or_none(layer.width_px, self.density);
        let style = Style { half_px, casing_px: None, hidden: layer.hidden, lift_m: layer.lift_m };
        let paths = self.shown_paths(id as usize - 1, paths);
        Some(self.sheet(paths, style, inks(color, None, layer.hidden), id))
    }

    fn overlay_line(&self, line: &OverlayLine, requests: &mut Vec<LabelRequest>) -> StrokeLayer {
        let half_px = 0.5 * width_or_none(line.width_px, self.density);
        let casing_px = line.casing.map(|_| self.casing_of(half_px));
        let style = Style { half_px, casing_px, hidden: line.hidden, lift_m: 0.0 };
        let paths = match line.on_ground {
            true => path::lay(self.scene, &line.points, 0.0, self.coarse()),
            false => vec![path::as_given(&line.points)],
        };
        if !line.label.is_empty() {
            requests.extend(self.rim_label(line, &paths, style));
        }
        self.sheet(paths, style, inks(line.color, line.casing, line.hidden), 0)
    }

    /// The text of a line at its visible end nearest to the bottom of the picture.
    fn rim_label(&self, line: &OverlayLine, paths: &[Vec<LinePoint>], style: Style) -> Option<LabelRequest> {
        let size = 2.0 * self.screen.center;
        let margin = DVec2::splat(1.5 * line.label_px);
        let inside = |p: DVec2| p.cmpge(margin).all() && p.cmple(size - margin).all();
        let runs = paths.iter().flat_map(|p| self.runs(p, style));
        let parts = runs.flat_map(|r| r.1.parts()).filter(|(visible, _)| *visible);
        let ends = parts.filter_map(|(_, part)| {
            let mut seen = part.iter().map(|s| s.pixel).filter(|p| inside(*p));
            let first = seen.next()?;
            Some([first, seen.next_back().unwrap_or(first)])
        });
        let at = ends.flatten().max_by(|a, b| a.y.total_cmp(&b.y))?;
        let color = line.color.with_alpha(255);
        let marker = [2.0 * self.density; 2];
        Some(LabelRequest { marker, ..LabelRequest::new(line.label.clone(), at, line.label_px, color) })
    }

    fn sheet(&self, paths: Vec<Vec<LinePoint>>, style: Style, inks: [Ink; 3], id: u32) -> StrokeLayer {
        let drawn: Vec<(Vec<Stroke>, Vec<LineShape>)> = paths
            .par_iter()
            .enumerate()
            .map(|(number, line)| {
                let (mut strokes, mut lines) = (Vec::new(), Vec::new());
                let runs = self.runs(line, style);
                if self.map.only_asks() {
                    return (strokes, lines);
                }
                for (_, run) in runs {
                    for (visible, part) in run.parts() {
                        self.strokes(visible, &part, style, &mut strokes);
                        lines.extend(self.keep.then(|| self.line_shape(number, visible, &part, style)));
                    }
                }
                (strokes, lines)
            })
            .collect();
        let (strokes, lines): (Vec<_>, Vec<_>) = drawn.into_iter().unzip();
        StrokeLayer::new(strokes.concat(), inks, id, self.screen.height as usize, ROWS).with_lines(lines.concat())
    }

    /// Images of a line in every pass, with the number of the pass.
    fn runs(&self, line: &[LinePoint], style: Style) -> Vec<(usize, Run)> {
        let reach = style.half_px + 4.0;
        let mut runs = Vec::new();
        let pairs = line.windows(2).map(|pair| Aabb::of([pair[0].p, pair[1].p]));
        for (i, pass) in self.passes_for(pairs).iter().enumerate() {
            let judge =
                LineVisibility { pass, screen: self.screen, map: self.map, sight: self.sight, lift_m: style.lift_m };
            for piece in path::project(pass, self.screen, line, self.tolerance_px) {
                runs.extend(judge.runs(&piece, reach).into_iter().map(|run| (i, run)));
            }
        }
        runs
    }

    /// Draws a stretch of equal visibility.
    fn strokes(&self, visible: bool, part: &[Station], style: Style, out: &mut Vec<Stroke>) {
        if visible || style.hidden == Hidden::Show {
            if let Some(casing) = style.casing_px {
                dash::trace(part, casing, Lane::Casing, out);
            }
            dash::trace(part, style.half_px, if visible { Lane::Fill } else { Lane::Shown }, out);
        } else {
            let half = style.half_px * HIDDEN_WIDTH;
            match style.hidden {
                Hidden::Fade => dash::trace(part, half, Lane::Hidden, out),
                Hidden::Dash => dash::dashes(part, style.half_px * 2.0, self.density, half, out),
                Hidden::Show | Hidden::Cut => {}
            }
        }
    }

    /// The same stretch as a shape; hidden ones are kept whatever the style, so that nothing of a line is lost.
    fn line_shape(&self, number: usize, visible: bool, part: &[Station], style: Style) -> LineShape {
        let drawn = visible || style.hidden == Hidden::Show;
        let width = 2.0 * style.half_px * if drawn { 1.0 } else { HIDDEN_WIDTH };
        let size = 2.0 * self.screen.center;
        let inside = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all();
        let lengths = part.windows(2).filter(|pair| inside(0.5 * (pair[0].pixel + pair[1].pixel)));
        LineShape {
            number,
            points: part.iter().map(|station| station.pixel).collect(),
            length: lengths.map(|pair| self.length([pair[0].on_line.p, pair[1].on_line.p])).sum(),
            visible,
            drawn: drawn || style.hidden != Hidden::Cut,
            role: if drawn { Role::Fill } else { Role::Hidden },
            width,
            casing: style.casing_px.filter(|_| drawn).map(|half| 2.0 * half),
            dash: (!drawn && style.hidden == Hidden::Dash)
                .then(|| dash::pattern(part, 2.0 * style.half_px, self.density)),
        }
    }

    /// Length as measures count it, scene units: in plan where there is ground.
    fn length(&self, [a, b]: [DVec3; 2]) -> f64 {
        match self.scene.terrain() {
            Some(_) => a.truncate().distance(b.truncate()),
            None => a.distance(b),
        }
    }

    /// Marks at equal distances along the lines of a layer.
    fn distances(&self, layer: &LineLayer, id: u32, requests: &mut Vec<LabelRequest>) -> Option<StrokeLayer> {
        let markers = layer.markers?;
        let draped = |f: &LineFeature| {
            let mut line = path::drape(self.scene, &f.points, layer.lift_m, self.coarse());
            for i in 1..line.len() {
                line[i].along = line[i - 1].along + self.length([line[i - 1].p, line[i].p]);
            }
            line
        };
        let lines: Vec<_> = layer.features.iter().map(draped).collect();
        let lengths = lines.iter().filter_map(|l| l.last().map(|p| p.along));
        let every = distance::spacing(markers, lengths)?;
        let half_px = (0.5 * width_or_none(layer.width_px, self.density)).max(self.density) + 1.2 * self.density;
        // A hidden mark cannot be told from the dashes.
        let hidden = if layer.hidden == Hidden::Show { Hidden::Show } else { Hidden::Cut };
        let marker = Marker { symbol: Symbol::Dot, half_px, casing: true, hidden };
        let mut strokes = Vec::new();
        let side = half_px + 2.0 * self.density;
        for (number, line) in (0..).zip(&lines) {
            for (on_line, text) in distance::marks(line, every) {
                requests.extend(self.mark(&on_line, layer.lift_m, marker, &mut strokes).iter().map(|seen| {
                    let request = seen.request(text.clone(), layer.marker_px, darker(layer.color));
                    LabelRequest { marker: [side; 2], number, ..request }
                }));
            }
        }
        let white = Color::rgb(255, 255, 255);
        let inks = inks(white, Some(layer.color), hidden);
        Some(StrokeLayer::new(strokes, inks, id, self.screen.height as usize, ROWS))
    }
}

/// A colour that reads as text.
fn darker(c: Color) -> Color {
    let [r, g, b] = [c.r, c.g, c.b].map(|v| (f32::from(v) * 0.6) as u8);
    Color::rgb(r, g, b)
}

/// Largest width of a line and size of a symbol, pixels of a scene.
const MOST_WIDTH: f64 = 1000.0;

/// The width, or 0 if it cannot be drawn.
/// * `density`: pixels per pixel of the scene; the largest width grows with it.
fn width_or_none(width_px: f64, density: f64) -> f64 {
    if width_px.is_finite() { width_px.clamp(0.0, MOST_WIDTH * density.max(1.0)) } else { 0.0 }
}

/// Half width of a casing.
fn casing_of(half_px: f64, density: f64) -> f64 {
    half_px + (0.6 * half_px).clamp(0.9 * density, 2.5 * density)
}

/// Inks of hidden, casing and fill.
fn inks(color: Color, casing: Option<Color>, hidden: Hidden) -> [Ink; 3] {
    let ink =
        |c: Color, share: f32| Ink { color: linear([c.r, c.g, c.b]), alpha: share * f32::from(c.a) / 255.0, stored: c };
    let faint = if hidden == Hidden::Fade { 0.45 } else { 0.75 };
    [ink(color, faint), ink(casing.unwrap_or(color), if casing.is_some() { 0.9 } else { 0.0 }), ink(color, 1.0)]
}

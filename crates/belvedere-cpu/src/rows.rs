//! A picture drawn some rows at a time: geometry, marks and what stylisation needs of the whole picture are prepared once; every row is
//! then drawn as in one piece.
//!
//! What marks and measures read of the depths is drawn beforehand, at the pixel centres alone and only where something reads it.

use crate::cache::{GroundCache, lock};
use crate::frame::{check_memory, threads_of};
use crate::geometry::lod::Tree;
use crate::geometry::pass::{BodyPasses, Pass};
use crate::over_ground::{self, SeenRow};
use crate::raster::band::{BAND, Band, SKY, sample_offsets};
use crate::resolve::relief::resolve_relief;
use crate::resolve::{Colors, Rows, resolve};
use crate::screen::Screen;
use crate::see_through::SeeThrough;
use crate::shade::{LightCache, Sample, Shader};
use crate::surfaces::{Scratch, Surfaces, stats};
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_composite::depths::{DepthTiles, Depths};
use belvedere_composite::finish::{draw_marks_on_rows, is_open};
use belvedere_composite::layers::Levels;
use belvedere_composite::marks::Marks;
use belvedere_composite::skyline::Skyline;
use belvedere_composite::stylise::{self, Relief, StyledRows, Survey};
use belvedere_composite::traced_marks;
use belvedere_composite::unsharp::{DepthGrid, Surroundings};
use belvedere_composite::veil::{Veil, Veiled};
use belvedere_scene::{
    Cancelled, Frame, FrameStats, Instant, PictureRows, PixelGrid, RenderError, RenderJob, Stylisation,
};
use belvedere_sight::pass;
use belvedere_sight::sections::Sections;
use belvedere_sight::{Carried, Solids};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Rows of depths that are drawn together beforehand.
const AHEAD: usize = 16 * BAND;

/// Caches of the ground.
pub(crate) type Caches<'a> = (&'a GroundCache<(), Arc<Tree>>, &'a LightCache);

/// What keeps the rasteriser from drawing a job some rows at a time.
pub(crate) fn whole_only(job: &RenderJob<'_>) -> Option<&'static str> {
    let has_volumes = job.scene.layers.iter().any(|layer| layer.kind.volume().is_some());
    let is_marked = Levels::of(job).is_some_and(|levels| !levels.published) && Marks::are_in(job);
    let reasons = [
        (has_volumes, "its volumes"),
        (job.view.split_rays().is_some(), "its rays, which part"),
        (is_marked, "lines, names or other marks over styling sections whose representations are drawn one by one"),
        (!job.options.overlay.faces.is_empty(), "faces over the picture"),
        (job.options.aux.exact, "buffers of exact depths"),
    ];
    reasons.into_iter().find(|(is, _)| *is).map(|(_, what)| what)
}

/// Fails for a job that is not drawn some rows at a time.
pub(crate) fn check(job: &RenderJob<'_>) -> Result<(), RenderError> {
    if let Some(what) = whole_only(job) {
        return Err(RenderError::WholeOnly { what });
    }
    if ![1, 4, 16].contains(&job.options.samples) {
        return Err(RenderError::Samples { samples: job.options.samples });
    }
    check_memory(job, (0, Some(BAND)))
}

/// Work on a prepared picture.
pub(crate) type Work<'w> = &'w mut dyn FnMut(&dyn PictureRows) -> Result<(), RenderError>;

/// Prepares a picture and lets `work` draw it.
pub(crate) fn draw(
    (detail, light): Caches<'_>,
    job: &RenderJob<'_>,
    scratch: &mut Scratch,
    work: Work<'_>,
) -> Result<(), RenderError> {
    check(job)?;
    let start = Instant::now();
    let pool = threads_of(job);
    let pool = pool.as_ref();
    job.progress.tick("project", 0.0)?;
    let screen = Screen::new(job.view.pinhole());
    let passes = Pass::all(job.view);
    let carried = Carried::new(job.scene, job.view);
    let bodies = carried.as_ref().map(BodyPasses::new);
    let Scratch { blocks, bands, .. } = scratch;
    let sections = Sections::new(job);
    on(pool, || blocks.build(job, (&passes, bodies.as_ref()), &screen, sections.as_ref(), detail));
    job.progress.tick("project", 1.0)?;
    let blocks = &*blocks;
    let shader = on(pool, || Shader::new(job, &screen, blocks, light));
    let see_through = SeeThrough::of(job.scene);
    let surfaces = Surfaces {
        job,
        screen: &screen,
        blocks,
        shader: &shader,
        centers: None,
        sections: sections.as_ref(),
        layers: &see_through,
        spare: bands,
    };
    let mut rows = Prepared {
        surfaces,
        pool,
        survey: Survey::default(),
        marks: Marks::default(),
        front: Marks::default(),
        stats: FrameStats::default(),
        color: Mutex::default(),
    };
    on(pool, || rows.prepare(&Pass::plain(&passes)))?;
    rows.stats = stats(blocks, 0, start).and(&rows.stats);
    work(&rows)
}

/// Runs some work on threads of the job's own, if there are any.
pub(crate) fn on<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// A picture that is ready to be drawn.
struct Prepared<'a> {
    surfaces: Surfaces<'a>,
    pool: Option<&'a ThreadPool>,
    survey: Survey,
    marks: Marks,
    /// Marks in front of what shines through.
    front: Marks,
    stats: FrameStats,
    /// Memory of the colours of the rows drawn last.
    color: Mutex<Vec<Packed>>,
}

/// Depths of a row at the pixel centres: of what hides, and of the nearest surface.
struct DepthRow {
    number: usize,
    depth: Vec<f32>,
    nearest: Option<Vec<f32>>,
}

impl Prepared<'_> {
    fn job(&self) -> &RenderJob<'_> {
        self.surfaces.job
    }

    fn picture(&self) -> [usize; 2] {
        let Screen { width, height, .. } = *self.surfaces.screen;
        [width, height].map(|side| side.max(0) as usize)
    }

    /// Decides what holds for the whole picture.
    fn prepare(&mut self, passes: &[&pass::Pass<'_>]) -> Result<(), RenderError> {
        let Surfaces { job, screen, .. } = self.surfaces;
        let Stylisation { edges, unsharp } = job.options.stylisation;
        let [_, height] = self.picture();
        if unsharp > 0.0 {
            let mut grid = DepthGrid::new(self.picture());
            let wanted: Vec<usize> = grid.rows().collect();
            self.each_row(&wanted, None, false, |row| grid.fill(row.number, &row.depth))?;
            self.survey.around = Some(Surroundings::new(&grid, screen.ortho));
        }
        if edges > 0.0 && screen.ortho {
            self.survey.depths = self.depths_of_samples()?;
        }
        if !(job.options.marks && Marks::are_in(job)) {
            return Ok(());
        }
        let mut tiles = traced_marks::wanted_depths(job, passes, screen);
        tiles.make_room();
        let mut near = (!self.surfaces.layers.is_empty()).then(|| {
            let mut near = traced_marks::wanted_depths(job, passes, screen);
            near.make_room();
            near
        });
        let wanted: Vec<usize> = (0..height).filter(|row| tiles.are_wanted_in(*row..row + 1)).collect();
        let columns = |tiles: &DepthTiles, rows: Range<usize>| tiles.wanted_columns(rows);
        for rows in wanted.chunk_by(|a, b| a / AHEAD == b / AHEAD) {
            let only = columns(&tiles, rows[0]..rows[rows.len() - 1] + 1);
            self.each_row(rows, only, near.is_some(), |row| {
                tiles.fill(row.number, &row.depth);
                if let (Some(near), Some(depth)) = (&mut near, &row.nearest) {
                    near.fill(row.number, depth);
                }
            })?;
        }
        if Marks::read_skyline(job) {
            tiles.skyline = self.skyline()?;
            if let Some(near) = &mut near {
                near.skyline = tiles.skyline.clone();
            }
        }
        self.marks = traced_marks::place(job, passes, screen, (Depths::Tiles(&tiles), Solids::Opaque));
        self.stats = self.marks.counted(std::mem::take(&mut self.stats));
        if let Some(near) = &near {
            self.front = traced_marks::place(job, passes, screen, (Depths::Tiles(near), Solids::Drawn));
        }
        Ok(())
    }

    /// Where the sky begins over each column.
    fn skyline(&self) -> Result<Skyline, RenderError> {
        let picture = self.picture();
        let mut skyline = Skyline::unknown(picture);
        let rows: Vec<usize> = (0..picture[1]).collect();
        let mut open = true;
        for rows in rows.chunks(AHEAD) {
            if open {
                self.each_row(rows, None, false, |row| open = skyline.note(row.number, &row.depth))?;
            }
        }
        Ok(skyline)
    }

    /// Draws the depths of rows at the pixel centres, and hands them over in their order.
    /// * `wanted`: rising; `only`: columns that are read; `near`: whether the nearest depths are wanted too.
    fn each_row(
        &self,
        wanted: &[usize],
        only: Option<Range<usize>>,
        near: bool,
        mut take: impl FnMut(&DepthRow),
    ) -> Result<(), RenderError> {
        let bands: Vec<&[usize]> = wanted.chunk_by(|a, b| a / BAND == b / BAND).collect();
        let at_once = 2 * rayon::current_num_threads().max(1);
        for some in bands.chunks(at_once) {
            self.job().progress.tick("look", 0.0)?;
            let rows = some.par_iter().map(|rows| self.depth_rows(rows, only.clone(), near));
            for rows in rows.collect::<Vec<_>>() {
                rows.iter().for_each(&mut take);
            }
        }
        Ok(())
    }

    /// Offsets of the samples that are drawn beforehand: thresholds of exposures depend on all of them.
    fn offsets_ahead(&self) -> Vec<[i32; 2]> {
        let all = sample_offsets(self.job().options.samples);
        let by_threshold = self.surfaces.sections.is_some() && self.job().options.representation.is_none();
        if by_threshold { all } else { all[..1].to_vec() }
    }

    /// Depths of some rows of one band.
    fn depth_rows(&self, rows: &[usize], only: Option<Range<usize>>, near: bool) -> Vec<DepthRow> {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
        let [_, height] = self.picture();
        let y = [*first, (*last + 1).min(height)].map(|row| row as i32);
        let offsets = self.offsets_ahead();
        let only = only.map(|columns| [columns.start, columns.end].map(|column| column as i32));
        let (band, exposed) = self.surfaces.filled(y, &offsets, only);
        let over = if near { self.surfaces.see_through(&band, y, (&offsets, exposed)) } else { Vec::new() };
        let out = rows.iter().map(|row| {
            let depth = self.row_of(&band, *row);
            let nearest = near.then(|| {
                over.iter().fold(depth.clone(), |nearest, band| {
                    nearest.iter().zip(self.row_of(band, *row)).map(|(a, b)| a.min(b)).collect()
                })
            });
            DepthRow { number: *row, depth, nearest }
        });
        let out = out.collect();
        lock(self.surfaces.spare).extend(over.into_iter().chain([band]));
        out
    }

    fn row_of(&self, band: &Band, row: usize) -> Vec<f32> {
        let from = band.index(0, 0, row as i32);
        let [width, _] = self.picture();
        let seen = band.q[from..][..width].iter().zip(&band.prim[from..][..width]);
        seen.map(|(q, prim)| if *prim == SKY { f32::INFINITY } else { self.surfaces.screen.depth_of(*q) }).collect()
    }

    /// Least and largest depth of all samples but the centres, as edges need them.
    fn depths_of_samples(&self) -> Result<Option<[f32; 2]>, RenderError> {
        let [_, height] = self.picture();
        let offsets = sample_offsets(self.job().options.samples);
        let bands = (0..height.div_ceil(BAND)).into_par_iter();
        let of_band = |i: usize| {
            self.job().progress.tick("look", 0.0)?;
            let y = [i * BAND, ((i + 1) * BAND).min(height)].map(|row| row as i32);
            let mut relief = self.relief_of((y[1] - y[0]) as usize);
            let (band, _) = self.surfaces.filled(y, &offsets, None);
            relief.bands(usize::MAX / 64).into_iter().flatten().for_each(|mut rows| {
                resolve_relief(&band, self.surfaces.shader, &mut rows);
            });
            lock(self.surfaces.spare).push(band);
            Ok::<_, Cancelled>(relief.depths())
        };
        let both = |a: Option<[f32; 2]>, b: Option<[f32; 2]>| match (a, b) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (a, b) => a.or(b),
        };
        Ok(bands.map(of_band).try_reduce(|| None, |a, b| Ok(both(a, b)))?)
    }

    fn relief_of(&self, rows: usize) -> Relief {
        let places = sample_offsets(self.job().options.samples).len().max(2) - 1;
        Relief::of_rows(places, rows * self.picture()[0])
    }

    fn draw_rows(&self, rows: Range<usize>, frame: &mut Frame) -> Result<(), RenderError> {
        let Surfaces { job, screen, .. } = self.surfaces;
        let [width, height] = self.picture();
        let rows = rows.start..rows.end.min(height);
        let pixels = rows.len() * width;
        let color = std::mem::take(&mut *lock(&self.color));
        let old = std::mem::take(frame);
        let mut buffers = Buffers::of_pixels(job, (pixels, is_open(job)), color, old);
        if job.scene.paints_over_ground() {
            buffers.world.get_or_insert_with(|| vec![[f64::NAN; 3]; pixels]);
        }
        buffers.color.truncate(if buffers.open { pixels } else { 0 });
        let [above, below] = [rows.start > 0, rows.end < height];
        let mut relief = (job.options.stylisation.edges > 0.0)
            .then(|| self.relief_of(rows.len() + usize::from(above) + usize::from(below)));
        let own = usize::from(above) * width..(usize::from(above) + rows.len()) * width;
        if let Some(relief) = &mut relief {
            for (row, at) in [(above, 0, rows.start.wrapping_sub(1)), (below, own.end, rows.end)]
                .into_iter()
                .filter_map(|(is, at, row)| is.then_some((row, at)))
            {
                let y = [row as i32, row as i32 + 1];
                let (band, _) = self.surfaces.filled(y, &sample_offsets(job.options.samples), None);
                for mut part in relief.bands_of(at..at + width, width).into_iter().flatten() {
                    resolve_relief(&band, self.surfaces.shader, &mut part);
                }
                lock(self.surfaces.spare).push(band);
            }
        }
        let mut veil = (!self.surfaces.layers.is_empty()).then(|| Veil::clear(pixels));
        let part = relief.as_mut().map(|relief| (relief, own));
        self.surfaces.draw(rows.start, &mut buffers, (part, veil.as_mut()))?;
        let around = if job.scene.paints_over_ground() {
            [above.then(|| rows.start - 1), below.then_some(rows.end)].map(|row| row.map(|row| self.seen_row(row)))
        } else {
            [None, None]
        };
        over_ground::paint(job, (self.surfaces.shader, screen), (rows.start, around), &mut buffers);
        if buffers.open {
            if stylise::is_on(job) {
                let styled = StyledRows { width, first: rows.start, above };
                stylise::apply_to_rows(job, &styled, &self.survey, relief, &mut buffers);
            }
            let veiled = veil.as_ref().map(|veil| Veiled { veil, first: rows.start, front: &self.front });
            draw_marks_on_rows(&self.marks, veiled, (screen, rows.start), &mut buffers);
        }
        let Buffers { color, depth, id, world, out, .. } = buffers;
        *lock(&self.color) = color;
        *frame = Frame { width, height: rows.len(), color: out, depth, id, world, stats: FrameStats::default() };
        Ok(())
    }

    /// What a row sees at its pixel centres.
    fn seen_row(&self, row: usize) -> SeenRow {
        let Surfaces { job, screen, shader, .. } = self.surfaces;
        let [width, _] = self.picture();
        let y = [row as i32, row as i32 + 1];
        let (band, _) = self.surfaces.filled(y, &sample_offsets(job.options.samples), None);
        let (mut color, mut depth) = (vec![Packed::default(); width], vec![0.0; width]);
        let (mut world, mut id) = (vec![[f64::NAN; 3]; width], vec![0; width]);
        let color = &mut Colors::Open(&mut color);
        let (depth, id_out, world_out) = (&mut depth[..], &mut id[..], Some(&mut world[..]));
        resolve(&band, shader, screen, &mut Rows { color, depth, id: id_out, world: world_out, centers: None });
        lock(self.surfaces.spare).push(band);
        (world, id)
    }

    /// Layers and world points of some pixels of a row.
    fn points(&self, band: &Band, row: usize, columns: impl Iterator<Item = usize>, frame: &mut Frame) {
        let Surfaces { blocks, shader, .. } = self.surfaces;
        let [ox, oy] = band.offsets[0];
        let sub = crate::screen::SUB;
        let world = frame.world.get_or_insert_default();
        for x in columns {
            let prim = band.prim[band.index(0, x as i32, row as i32)];
            let at = [x as i32 * sub + ox, row as i32 * sub + oy];
            world.push(shader.world(Sample { prim, at }).to_array());
            let layer = if prim == SKY { None } else { blocks.layer_of(prim) };
            frame.id.push(layer.map_or(0, |layer| layer + 1));
        }
    }

    /// Depths of a grid of pixels, band by band.
    fn look_at(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError> {
        let PixelGrid { first, step, count } = *grid;
        let [width, height] = count;
        let rows: Vec<usize> = (0..height).map(|i| first[1] + i * step).collect();
        let columns = || (0..width).map(|i| first[0] + i * step);
        let only = first[0]..first[0] + width.saturating_sub(1) * step + 1;
        let is_all = only.len() * 2 > self.picture()[0];
        let only = (!is_all).then_some(only);
        let bands: Vec<&[usize]> = rows.chunk_by(|a, b| a / BAND == b / BAND).collect();
        let of_band = |rows: &&[usize]| {
            self.job().progress.tick("look", 0.0)?;
            let (Some(from), Some(to)) = (rows.first(), rows.last()) else { return Ok(Frame::default()) };
            let y = [*from as i32, *to as i32 + 1];
            let only = only.as_ref().map(|columns| [columns.start, columns.end].map(|column| column as i32));
            let (band, _) = self.surfaces.filled(y, &self.offsets_ahead(), only);
            let mut out = Frame::default();
            let marked = if points { self.marked(*from) } else { Vec::new() };
            for row in *rows {
                let at = band.index(0, 0, *row as i32);
                for x in columns() {
                    let hidden = band.prim[at + x] == SKY;
                    let q = band.q[at + x];
                    out.depth.push(if hidden { f32::INFINITY } else { self.surfaces.screen.depth_of(q) });
                }
                if points {
                    self.points(&band, *row, columns(), &mut out);
                    let from = row % BAND * self.picture()[0];
                    let new = out.id.len() - width;
                    for (id, x) in out.id[new..].iter_mut().zip(columns()) {
                        *id = marked.get(from + x).copied().filter(|mark| *mark != 0).unwrap_or(*id);
                    }
                }
            }
            lock(self.surfaces.spare).push(band);
            Ok::<_, Cancelled>(out)
        };
        let parts = bands.par_iter().map(of_band).collect::<Result<Vec<Frame>, _>>()?;
        let mut frame = Frame { width, height, world: points.then(Vec::new), ..Frame::default() };
        for part in parts {
            frame.depth.extend(part.depth);
            frame.id.extend(part.id);
            if let (Some(all), Some(world)) = (&mut frame.world, part.world) {
                all.extend(world);
            }
        }
        Ok(frame)
    }

    /// Ids of the marks in the band of a row, 0 where there are none.
    fn marked(&self, row: usize) -> Vec<u32> {
        let [width, height] = self.picture();
        let first = row / BAND * BAND;
        let pixels = width * ((first + BAND).min(height) - first);
        let (mut color, mut id) = (vec![Packed::default(); pixels], vec![0; pixels]);
        self.marks.draw(first as i32, self.surfaces.screen, &[], &mut color, &mut id);
        id
    }
}

impl PictureRows for Prepared<'_> {
    fn size(&self) -> [usize; 2] {
        self.picture()
    }

    fn stats(&self) -> FrameStats {
        self.stats.clone()
    }

    fn look(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError> {
        on(self.pool, || self.look_at(grid, points))
    }

    fn draw(&self, rows: Range<usize>, frame: &mut Frame) -> Result<(), RenderError> {
        on(self.pool, || self.draw_rows(rows, frame))
    }
}

//! From the colours of surfaces to the finished picture: stylisation, then marks, then what is in front of them, band by band.

use crate::buffers::Buffers;
use crate::canvas::Canvas;
use crate::color::{self, Packed};
use crate::marks::Marks;
use crate::stylise::{self, Relief};
use crate::veil::Veiled;
use belvedere_scene::{Frame, ROWS, RenderJob};
use belvedere_sight::screen::Screen;
use rayon::prelude::*;

/// Buffers of a picture; every pixel is sky.
pub fn buffers(job: &RenderJob<'_>) -> Buffers {
    let stylised = stylise::is_on(job);
    let buffers = Buffers::reuse(job, true, Vec::new(), Frame::default());
    // Where only centres are known, edges between faces are found from world points.
    let n = buffers.out.len();
    let world = (job.options.aux.world || stylised || job.scene.paints_over_ground()).then(|| vec![[f64::NAN; 3]; n]);
    Buffers { world, ..buffers }
}

/// Buffers in the memory of older ones; all pixels must be written.
pub fn buffers_in(job: &RenderJob<'_>, color: Vec<Packed>, old: Frame) -> Buffers {
    let buffers = Buffers::reuse(job, is_open(job), color, old);
    let n = buffers.out.len();
    let world = buffers.world.or_else(|| job.scene.paints_over_ground().then(|| vec![[f64::NAN; 3]; n]));
    Buffers { world, ..buffers }
}

/// Whether anything may be drawn over the surfaces of a job.
pub fn is_open(job: &RenderJob<'_>) -> bool {
    Marks::are_in(job) || stylise::is_on(job) || job.scene.has_see_through() || job.scene.paints_over_ground()
}

/// Draws stylisation, lines and points over the surfaces, and encodes the colours.
/// * `relief`: depths and faces of all samples, if they are known.
pub fn finish(job: &RenderJob<'_>, marks: &Marks, screen: &Screen, relief: Option<Relief>, buffers: &mut Buffers) {
    finish_veiled(job, (marks, None), screen, relief, buffers);
}

/// [`finish`], with solids that something shines through over it, if there are any.
pub fn finish_veiled(
    job: &RenderJob<'_>,
    (marks, veiled): (&Marks, Option<Veiled<'_>>),
    screen: &Screen,
    relief: Option<Relief>,
    buffers: &mut Buffers,
) {
    if stylise::is_on(job) {
        stylise::apply(job, screen.width as usize, relief, buffers);
    }
    draw_marks(marks, veiled, screen, buffers);
}

/// Draws lines and points over the surfaces and what is veiled, and encodes the colours.
pub fn draw_marks(marks: &Marks, veiled: Option<Veiled<'_>>, screen: &Screen, buffers: &mut Buffers) {
    draw_marks_on_rows(marks, veiled, (screen, 0), buffers);
}

/// [`draw_marks`] on the rows of a picture from `first` on, a multiple of [`ROWS`].
pub fn draw_marks_on_rows(
    marks: &Marks,
    veiled: Option<Veiled<'_>>,
    (screen, first): (&Screen, usize),
    buffers: &mut Buffers,
) {
    let chunk = ROWS * screen.width as usize;
    let Buffers { depth, color, id, out, .. } = buffers;
    let encoding = color::encoding();
    out.par_chunks_mut(chunk).zip(color.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk)).enumerate().for_each(
        |(i, ((out, color), id))| {
            let y0 = (first + i * ROWS) as i32;
            marks.draw(y0, screen, depth, color, id);
            if let Some(veiled) = veiled {
                veiled.lay(y0, screen, color);
            }
            for (o, c) in out.iter_mut().zip(color.iter()) {
                *o = c.encode(encoding);
            }
        },
    );
    marks.write_names(&mut Canvas::rows(out, [screen.width, screen.height].map(|side| side as usize), first));
}

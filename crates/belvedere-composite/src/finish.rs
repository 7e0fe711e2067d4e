//! From the colours of surfaces to the finished picture: stylisation, then marks, then what is in front of them, band by band.

use crate::buffers::Buffers;
use crate::color::{self, Packed};
use crate::marks::Marks;
use crate::screen::{BAND, Screen};
use crate::stylise::{self, Relief};
use crate::veil::Veiled;
use belvedere_scene::{Frame, RenderJob};
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
    let painted = job.scene.paints_over_ground();
    let is_open = Marks::are_in(job) || stylise::is_on(job) || job.scene.has_see_through() || painted;
    let buffers = Buffers::reuse(job, is_open, color, old);
    let n = buffers.out.len();
    let world = buffers.world.or_else(|| painted.then(|| vec![[f64::NAN; 3]; n]));
    Buffers { world, ..buffers }
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
    let chunk = BAND * screen.width as usize;
    let Buffers { depth, color, id, out, .. } = buffers;
    let encoding = color::encoding();
    out.par_chunks_mut(chunk).zip(color.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk)).enumerate().for_each(
        |(i, ((out, color), id))| {
            marks.draw((i * BAND) as i32, screen, depth, color, id);
            if let Some(veiled) = veiled {
                veiled.lay((i * BAND) as i32, screen, color);
            }
            for (o, c) in out.iter_mut().zip(color.iter()) {
                *o = c.encode(encoding);
            }
        },
    );
    marks.write_names(out, screen.width as usize);
}

//! What is painted on ground that was drawn, by the places that the pixels see: lines of equal height.

mod contours;

use crate::screen::Screen;
use crate::shade::Shader;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Rgb;
use belvedere_composite::stylise;
use belvedere_core::DVec2;
use belvedere_scene::RenderJob;

/// What a row of pixels sees: world points and layers.
pub(crate) type SeenRow = (Vec<[f64; 3]>, Vec<u32>);

/// Paints over the ground of every terrain layer, on the rows of a picture from `first` on.
///
/// * `around`: the rows above and below, where there are some.
pub(crate) fn paint(
    job: &RenderJob<'_>,
    (shader, screen): (&Shader<'_>, &Screen),
    (first, around): (usize, [Option<SeenRow>; 2]),
    buffers: &mut Buffers,
) {
    if !job.scene.paints_over_ground() {
        return;
    }
    let width = screen.width as usize;
    if let Some(world) = buffers.world.take() {
        let is_area = |id: u32| {
            let layer = (id as usize).checked_sub(1).and_then(|i| job.scene.layers.get(i));
            layer.is_some_and(|layer| layer.kind.areas().is_some())
        };
        for (i, layer) in job.scene.layers.iter().enumerate() {
            let Some(terrain) = layer.kind.terrain() else { continue };
            // Areas are painted on the ground below them.
            let shows = |id: u32| id == i as u32 + 1 || is_area(id);
            let seen = |world, id| Seen { world, id, shows: &shows, width };
            let ground = seen(&world, &buffers.id);
            if let Some(lines) = &terrain.contours {
                // On a soft edge lines fade as the ground does.
                let ink = |pixel: usize, place: DVec2, line: Rgb| {
                    let at = [pixel % width, first + pixel / width].map(|v| v as f32 + 0.5);
                    shader.faded(i, place, at, line).unwrap_or(line)
                };
                let density = job.options.density;
                let interval = lines.interval_in(&terrain.heightfield, job.view.pinhole(), density);
                let around = [0, 1].map(|i| around[i].as_ref().map(|(world, id)| seen(world, id)));
                let style = (interval, lines.color, density);
                contours::paint(&ground, around, &terrain.heightfield, style, &ink, &mut buffers.color);
            }
        }
        buffers.world = Some(world);
    }
    if !job.options.aux.world && !stylise::is_on(job) {
        buffers.world = None;
    }
}

/// Places on one ground that the pixels of a picture see.
struct Seen<'a> {
    world: &'a [[f64; 3]],
    id: &'a [u32],
    /// Whether a layer is the ground, or lies on it.
    shows: &'a (dyn Fn(u32) -> bool + Sync),
    width: usize,
}

impl Seen<'_> {
    /// Where on the map a pixel looks; `None` if it shows something else.
    fn place(&self, pixel: usize) -> Option<DVec2> {
        let [x, y, _] = self.world[pixel];
        let place = DVec2::new(x, y);
        (place.is_finite() && (self.shows)(self.id[pixel])).then_some(place)
    }
}

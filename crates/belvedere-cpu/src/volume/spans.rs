//! Range of the pixels of each row that may show a volume.

use super::bricks::{EDGE, Leaps};
use belvedere_core::{Aabb, DVec3, ImageBox, View};
use belvedere_scene::Volume;
use rayon::prelude::*;

/// Largest number of cubes into which bricks are grouped.
const MAX_CUBES: usize = 4096;

/// First pixel and the one past the last, per row; `None` where every pixel may show the volume.
pub(super) struct Spans(Option<Vec<[u32; 2]>>);

impl Spans {
    /// Spans of the image boxes of the visible bricks.
    pub(super) fn new(view: &View, volume: &Volume, leaps: &Leaps) -> Self {
        let [nx, ny, nz] = leaps.dims();
        let mut edge = 1;
        let cubes = |edge: usize| [nx, ny, nz].map(|n| n.div_ceil(edge));
        while cubes(edge).iter().product::<usize>() > MAX_CUBES {
            edge += 1;
        }
        let [cx, cy, cz] = cubes(edge);
        let images: Option<Vec<ImageBox>> = (0..cx * cy * cz)
            .into_par_iter()
            .map(|i| [i % cx, i / cx % cy, i / (cx * cy)].map(|c| [c * edge, (c + 1) * edge]))
            .filter(|cube| leaps.shows(*cube))
            .map(|cube| view.image_box(&bounds(volume, cube)))
            .collect();
        Self(images.map(|images| rows(&images, view.pinhole().image)))
    }

    /// Whether a pixel may show the volume.
    pub(super) fn hold(&self, [x, y]: [usize; 2]) -> bool {
        self.0.as_ref().is_none_or(|rows| (rows[y][0] as usize..rows[y][1] as usize).contains(&x))
    }
}

/// Scene bounds of bricks.
fn bounds(volume: &Volume, cube: [[usize; 2]; 3]) -> Aabb {
    let most = DVec3::from_array(volume.dims().map(|n| (n - 1) as f64));
    let [min, max] = [0, 1].map(|k| DVec3::from_array(cube.map(|c| c[k] as f64 * f64::from(EDGE))).min(most));
    Aabb::of(Aabb { min, max }.corners().map(|q| volume.scene_from_lattice(q)))
}

/// Range of each row that the images cover, widened by a pixel.
fn rows(images: &[ImageBox], [width, height]: [u32; 2]) -> Vec<[u32; 2]> {
    let mut rows = vec![[width, 0]; height as usize];
    for image in images {
        // Casts saturate at the bounds of u32.
        let [x0, y0] = (image.min.floor() - 1.0).to_array().map(|v| v as u32);
        let [x1, y1] = (image.max.ceil() + 1.0).to_array().map(|v| v as u32);
        for row in rows.iter_mut().take(y1 as usize).skip(y0 as usize) {
            *row = [row[0].min(x0), row[1].max(x1.min(width))];
        }
    }
    rows
}

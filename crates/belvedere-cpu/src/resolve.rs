//! From samples to pixels.

use crate::lens::{Lens, SUB};
use crate::polish::Polish;
use crate::raster::{Band, SKY};
use crate::shade::color::{Packed, Rgb};
use crate::shade::{Shaded, Shader};

/// Rows of the picture that a band fills.
pub(crate) struct Rows<'a> {
    pub(crate) color: &'a mut [Packed],
    pub(crate) depth: &'a mut [f32],
    pub(crate) id: &'a mut [u32],
    pub(crate) world: Option<&'a mut [[f64; 3]]>,
    /// Makes depth and place exact, if asked for.
    pub(crate) polish: Option<&'a Polish<'a>>,
}

/// Two samples farther apart than this share of their depth are coloured separately.
const SAME_SURFACE: f32 = 0.02;

/// Colours the band's pixels.
pub(crate) fn resolve(band: &Band, shader: &Shader<'_>, lens: &Lens, rows: &mut Rows<'_>) {
    let mut cache: Vec<(u32, f32, Rgb)> = Vec::with_capacity(band.offsets.len());
    for y in band.y0..band.y1 {
        for x in 0..band.width {
            let out = ((y - band.y0) * band.width + x) as usize;
            let mut centre = sample(band, shader, 0, x, y);
            let i = band.index(0, x, y);
            let q = band.q[i];
            rows.depth[out] = if band.prim[i] == SKY { f32::INFINITY } else { lens.depth_of(q) };
            if let Some(polish) = rows.polish
                && let Some((place, depth)) = shader.exact_place(polish, band.prim[i], centre.world, x, y)
            {
                (centre.world, rows.depth[out]) = (place, depth);
            }
            rows.id[out] = centre.id;
            if let Some(world) = &mut rows.world {
                world[out] = centre.world.to_array();
            }
            rows.color[out] = Packed::new(if band.offsets.len() == 1 {
                centre.color
            } else {
                cache.clear();
                cache.push((band.prim[i], q, centre.color));
                coverage(band, shader, lens, x, y, &mut cache)
            });
        }
    }
}

/// Mean colour of the coverage samples; samples on one surface share the colour of the first of them.
fn coverage(band: &Band, shader: &Shader<'_>, lens: &Lens, x: i32, y: i32, seen: &mut Vec<(u32, f32, Rgb)>) -> Rgb {
    let n = band.offsets.len();
    let mut sum = Rgb::ZERO;
    for s in 1..n {
        let i = band.index(s, x, y);
        let (prim, q) = (band.prim[i], band.q[i]);
        let known = seen.iter().find(|&&(p, q0, _)| {
            p == prim
                || (p != SKY && prim != SKY && {
                    let (a, b) = (lens.depth_of(q), lens.depth_of(q0));
                    (a - b).abs() <= SAME_SURFACE * a.abs().min(b.abs()) && shader.is_terrain(p, prim)
                })
        });
        sum += match known {
            Some(&(_, _, color)) => color,
            None => {
                let color = sample(band, shader, s, x, y).color;
                seen.push((prim, q, color));
                color
            }
        };
    }
    sum / (n - 1) as f32
}

fn sample(band: &Band, shader: &Shader<'_>, s: usize, x: i32, y: i32) -> Shaded {
    let i = band.index(s, x, y);
    let [ox, oy] = band.offsets[s];
    shader.shade(band.prim[i], band.q[i], x * SUB + ox, y * SUB + oy)
}

//! Depths and faces of samples, from which edges are drawn.

use crate::raster::band::{Band, SKY};
use crate::shade::Shader;
use belvedere_composite::stylise::{Face, ReliefRows, SKY_NEAR};

/// Writes depth and face of the band's samples, without the centres if there are other samples.
pub(crate) fn resolve_relief(band: &Band, shader: &Shader<'_>, rows: &mut ReliefRows<'_>) {
    let places = rows.places;
    let first = usize::from(band.offsets.len() > 1);
    // Most samples lie on the face of the sample before.
    let mut last = (SKY, Face::default());
    let mut at = 0;
    for y in band.y0..band.y1 {
        for x in 0..band.width {
            for place in 0..places {
                let i = band.index(first + place, x, y);
                let prim = band.prim[i];
                if prim != last.0 {
                    last = (prim, shader.face(prim));
                }
                rows.near[at] = if prim == SKY { SKY_NEAR } else { band.q[i] };
                rows.face[at] = last.1;
                at += 1;
            }
        }
    }
}

//! Reference in 64 bits, one sample after the other: the fast method is tested against it, and the exact renderer uses it.

use super::Gathered;
use super::light::{SURFACE, light};
use super::table::light_of;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{VolumeLayer, VolumeModel};
use belvedere_sight::volume::{ENOUGH, Sample, absorb, value_near};
use glam::Vec3A;

/// Light that the ray of `pixel` gathers between two depths.
pub(super) fn gather(view: &View, layer: &VolumeLayer, pixel: DVec2, range: [f64; 2]) -> Gathered {
    let mut color = Vec3A::ZERO;
    let absorbed = absorb(view, layer, pixel, range, |sample| color += lit(layer, sample) * sample.weight);
    let mut out = Gathered {
        color,
        alpha: absorbed.alpha,
        enters: absorbed.enters,
        half: absorbed.half,
        samples: absorbed.samples,
    };
    if out.alpha >= ENOUGH {
        out.color /= out.alpha;
        out.alpha = 1.0;
    }
    out
}

/// Linear light of a sample.
fn lit(layer: &VolumeLayer, sample: &Sample) -> Vec3A {
    let light = Vec3A::from_array(light_of(&layer.transfer, sample.value));
    match layer.model {
        VolumeModel::Plain => light,
        VolumeModel::Shaded => {
            let [factor, white] = shading(layer, sample.q, sample.chord.normalize());
            light * factor + white
        }
    }
}

fn shading(layer: &VolumeLayer, q: DVec3, along: DVec3) -> [f32; 2] {
    let volume = &*layer.volume;
    let value = |q: DVec3| value_near(volume, q).unwrap_or(0.0);
    let gradient = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| 0.5 * (value(q + e) - value(q - e)));
    // Normals transform by the inverse transpose of the axes.
    let normal = volume.lattice_axes().transpose() * DVec3::from_array(gradient);
    let per_edge = normal.length() * volume.voxel_edge();
    let [lo, hi] = volume.range().map(f64::from);
    let surface = f64::from(SURFACE) * (hi - lo);
    let solid = per_edge * per_edge / (per_edge * per_edge + surface * surface).max(f64::MIN_POSITIVE);
    let n = normal.normalize_or_zero();
    let towards = if n.dot(along) > 0.0 { -n } else { n };
    light(n.dot(along).abs() as f32, solid as f32, towards.z as f32)
}

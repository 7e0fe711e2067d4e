//! A coiled tube as a scanner sees it: a wall with folds around a channel, and two knots in it that show only from inside.

use super::noise::hash_unit;
use super::{BuiltinError, SuggestedCamera};
use belvedere_core::{DMat3, DVec3};
use belvedere_scene::{Crs, Layer, LayerKind, Scene, TransferFunction, Unit, Volume, VolumeLayer, VoxelValues};
use rayon::prelude::*;

/// Voxels along x, y, z.
const DIMS: [usize; 3] = [120, 120, 110];
/// Values of the channel, the wall and the knots, and the noise; the value outside the tube is 0.
const CHANNEL: f64 = 25.0;
const WALL: f64 = 150.0;
const KNOT: f64 = 225.0;
const NOISE: f64 = 2.5;
/// Centre line of the channel, a coil about the middle of the volume: radius and rise per step, voxels, and number of steps.
const COIL: f64 = 38.0;
const RISE_PER_STEP: f64 = 0.26;
const STEPS: usize = 240;
/// Cosine and sine of 3 degrees, the turn of one step: no angles, which differ between platforms in the last bit.
const TURN: [f64; 2] = [0.998_629_534_754_573_9, 0.052_335_956_242_943_835];
/// Radius of the channel and depth of its folds, voxels; steps from fold to fold; thickness of the wall, voxels.
const RADIUS: f64 = 10.0;
const FOLD: f64 = 2.5;
const FOLD_STEPS: f64 = 16.0;
const THICK: f64 = 3.0;
/// Knots: step, direction from the middle (outwards, upwards), distance from the middle, radius.
const KNOTS: [(usize, [f64; 2], f64, f64); 2] = [(92, [0.8, -0.6], 8.0, 3.6), (168, [-0.6, -0.8], 8.0, 3.2)];

/// The tube: 120 x 120 x 110 voxels of edge 1, its first voxel at the origin. The seed changes the noise.
///
/// # Errors
/// None in practice: the volume is well formed.
pub fn tube(seed: u64) -> Result<(Scene, SuggestedCamera), BuiltinError> {
    let [nx, ny, nz] = DIMS;
    let middle = middle();
    let plane = |z: usize| {
        let at = |i: usize| DVec3::new((i % nx) as f64, (i / nx) as f64, z as f64);
        let near: Vec<(usize, DVec3)> =
            middle.iter().copied().enumerate().filter(|(_, p)| (p.z - z as f64).abs() < RADIUS + THICK + 3.0).collect();
        (0..nx * ny).map(|i| value(at(i), &near, &middle)).collect::<Vec<f64>>()
    };
    let planes: Vec<f64> = (0..nz).into_par_iter().flat_map_iter(plane).collect();
    let noisy = planes.iter().enumerate().map(|(i, v)| {
        let noise = hash_unit(seed, i as u64, 1) + hash_unit(seed, i as u64, 2) + hash_unit(seed, i as u64, 3) - 1.5;
        (v + 2.0 * NOISE * noise).round().clamp(0.0, 255.0) as u8
    });
    let volume = Volume::new(DIMS, DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(noisy.collect()))?;
    let transfer = TransferFunction::auto(&volume);
    let kind = LayerKind::Volume(VolumeLayer::new(volume, transfer));
    let layers = vec![Layer { id: "tube".into(), must_see: false, kind }];
    let title = "A coiled tube".to_owned();
    let (eye, look_at) = (DVec3::new(200.0, -160.0, 150.0), DVec3::new(60.0, 60.0, 55.0));
    let camera = SuggestedCamera { title: title.clone(), eye, look_at, fov_y: 32f64.to_radians() };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Voxel, layers, ..Scene::default() }, camera))
}

/// Points of the centre line of the channel.
fn middle() -> Vec<DVec3> {
    let (mut x, mut y) = (COIL, 0.0);
    let centre = 0.5 * DVec3::from_array(DIMS.map(|n| (n - 1) as f64));
    let low = centre.z - 0.5 * RISE_PER_STEP * (STEPS - 1) as f64;
    let mut points = Vec::with_capacity(STEPS);
    for k in 0..STEPS {
        points.push(DVec3::new(centre.x + x, centre.y + y, low + RISE_PER_STEP * k as f64));
        (x, y) = (TURN[0] * x - TURN[1] * y, TURN[1] * x + TURN[0] * y);
    }
    points
}

/// Value at position `p`, voxels.
/// * `near`: points of the centre line that may be nearest, with their numbers; `middle`: all of them.
fn value(p: DVec3, near: &[(usize, DVec3)], middle: &[DVec3]) -> f64 {
    let nearest = near.iter().min_by(|a, b| p.distance_squared(a.1).total_cmp(&p.distance_squared(b.1)));
    let Some(&(at, _)) = nearest else { return 0.0 };
    // Foot on the chord between the points beside the nearest one.
    let (a, b) = (middle[at.saturating_sub(1)], middle[(at + 1).min(STEPS - 1)]);
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    let off = p.distance(a.lerp(b, t));
    let step = at.saturating_sub(1) as f64 + 2.0 * t;
    let fold = 1.0 - (2.0 * (step / FOLD_STEPS).fract() - 1.0).abs();
    let radius = RADIUS - FOLD * fold.powi(4);
    // A scanner blurs edges over about two voxels.
    let share = |distance: f64| (0.5 - 0.5 * distance).clamp(0.0, 1.0);
    let knots = KNOTS.map(|(step, [out, up], away, size)| {
        let axis = 0.5 * DVec3::from_array(DIMS.map(|n| (n - 1) as f64));
        let outwards = (middle[step] - axis).with_z(0.0).normalize();
        p.distance(middle[step] + away * (out * outwards + up * DVec3::Z)) - size
    });
    let knot = share(knots[0].min(knots[1])) * share(off - RADIUS - THICK);
    let tube = share(off - RADIUS - THICK) * (WALL + share(off - radius) * (CHANNEL - WALL));
    tube + knot * (KNOT - tube)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_channel_runs_inside_a_wall_from_end_to_end() {
        let (scene, _) = tube(7).unwrap();
        let Some(layer) = scene.layers[0].kind.volume() else { panic!("a volume") };
        let middle = middle();
        let value = |p: DVec3| layer.volume.at(p).unwrap();
        for (k, p) in middle.iter().enumerate() {
            assert!((value(*p) - CHANNEL).abs() < 20.0, "{k}: {}", value(*p));
            let outwards = (*p - DVec3::new(59.5, 59.5, p.z)).normalize();
            assert!(value(*p + 11.5 * outwards) > 120.0 && value(*p + 16.0 * outwards) < 20.0, "{k}");
        }
        assert!(value(middle[92] + 8.0 * DVec3::new(0.0, 0.0, -0.6)) < 225.0);
        assert_eq!(layer.volume.dims(), DIMS);
    }
}

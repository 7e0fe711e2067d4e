//! A machined block as a scanner sees it: walls with bores and channels, and a denser valve in a chamber that is open above and hidden from
//! level lines of sight.

use super::noise::hash_unit;
use super::{BuiltinError, SuggestedCamera};
use belvedere_core::{DMat3, DVec2, DVec3};
use belvedere_scene::{Crs, Layer, LayerKind, Scene, TransferFunction, Unit, Volume, VolumeLayer, VoxelValues};
use rayon::prelude::*;

/// Voxels along x, y, z.
const DIMS: [usize; 3] = [160, 128, 96];
/// Values of air, cast metal and the denser steel of the valve.
const AIR: f64 = 8.0;
const METAL: f64 = 124.0;
const STEEL: f64 = 226.0;
/// Standard deviation of the scanner's noise, about.
const NOISE: f64 = 3.0;

/// The engine: 160 x 128 x 96 voxels of edge 1, its first voxel at the origin. The seed changes where small bores lie, and the noise.
///
/// # Errors
/// None in practice: the volume is well formed.
pub fn engine(seed: u64) -> Result<(Scene, SuggestedCamera), BuiltinError> {
    let block = Block::new(seed);
    let [nx, ny, nz] = DIMS;
    let values = (0..nx * ny * nz).into_par_iter().map(|i| {
        let p = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
        let noise = hash_unit(seed, i as u64, 1) + hash_unit(seed, i as u64, 2) + hash_unit(seed, i as u64, 3) - 1.5;
        (block.value(p) + 2.0 * NOISE * noise).round().clamp(0.0, 255.0) as u8
    });
    let volume = Volume::new(DIMS, DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(values.collect()))?;
    let transfer = TransferFunction::auto(&volume);
    let kind = LayerKind::Volume(VolumeLayer::new(volume, transfer));
    let layers = vec![Layer { id: "engine".into(), must_see: false, kind }];
    let title = "A machined block".to_owned();
    let (eye, look_at) = (DVec3::new(80.0, -260.0, 104.0), DVec3::new(80.0, 60.0, 56.0));
    let camera = SuggestedCamera { title: title.clone(), eye, look_at, fov_y: 32f64.to_radians() };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Voxel, layers, ..Scene::default() }, camera))
}

/// The block, as signed distances: negative inside, in voxels.
struct Block {
    /// Positions and radii of bolt holes from above.
    bolts: Vec<(DVec2, f64)>,
    /// Oil channels along y: positions in x and z, radii.
    channels: Vec<(DVec2, f64)>,
}

impl Block {
    fn new(seed: u64) -> Self {
        let shift = |k: u64| 4.0 * (hash_unit(seed, k, 9) - 0.5);
        let corners = [(20.0, 20.0), (20.0, 108.0), (140.0, 20.0), (140.0, 108.0), (80.0, 18.0)];
        let bolts = corners.into_iter().enumerate().map(|(i, (x, y))| {
            (DVec2::new(x + shift(i as u64), y + shift(50 + i as u64)), 3.5 + 0.4 * shift(100 + i as u64).abs())
        });
        let channels = [(34.0, 18.0), (126.0, 18.0), (30.0, 70.0), (130.0, 70.0)].into_iter().enumerate();
        let channels = channels.map(|(i, (x, z))| (DVec2::new(x + shift(200 + i as u64), z), 4.2));
        Self { bolts: bolts.collect(), channels: channels.collect() }
    }

    fn value(&self, p: DVec3) -> f64 {
        // A scanner blurs edges over about two voxels.
        let share = |distance: f64| (0.5 - 0.5 * distance).clamp(0.0, 1.0);
        let (metal, steel) = (share(self.housing(p)), share(valve(p)));
        let cast = AIR + metal * (METAL - AIR);
        cast + steel * (STEEL - cast)
    }

    /// Signed distance of the cast housing, without its bores and chambers.
    fn housing(&self, p: DVec3) -> f64 {
        let body = rounded_box(p - DVec3::new(79.5, 63.5, 42.0), DVec3::new(66.0, 52.0, 33.0), 5.0);
        let flange = rounded_box(p - DVec3::new(79.5, 63.5, 72.0), DVec3::new(72.0, 58.0, 4.5), 2.0);
        let boss = cylinder(DVec2::new(p.x - 40.0, p.z - 44.0), p.y - 8.0, 17.0, 7.0);
        let mut solid = body.min(flange).min(boss);
        let mut cut = |hole: f64| solid = solid.max(-hole);
        // Two cylinders, open above, and the chamber of the valve between and behind them.
        for x in [46.0, 113.0] {
            cut(cylinder(DVec2::new(p.x - x, p.y - 46.0), p.z - 62.0, 21.0, 42.0));
        }
        cut(rounded_box(p - DVec3::new(79.5, 92.0, 54.0), DVec3::new(54.0, 15.0, 22.0), 6.0));
        cut(rounded_box(p - DVec3::new(79.5, 92.0, 70.0), DVec3::new(48.0, 12.5, 20.0), 4.0));
        cut(cylinder(DVec2::new(p.x - 40.0, p.z - 44.0), p.y - 4.0, 10.0, 20.0));
        self.bolts.iter().for_each(|(at, r)| cut(cylinder(p.truncate() - *at, p.z - 66.0, *r, 22.0)));
        self.channels.iter().for_each(|(at, r)| cut(cylinder(DVec2::new(p.x, p.z) - *at, p.y - 63.5, *r, 70.0)));
        solid
    }
}

/// Signed distance of the valve in the chamber: a stem along x with a head, a ring and coils around it.
fn valve(p: DVec3) -> f64 {
    let q = p - DVec3::new(79.5, 92.0, 57.0);
    let across = DVec2::new(q.y, q.z);
    let stem = cylinder(across, q.x, 3.2, 44.0);
    let head = cylinder(across, q.x - 38.0 + 0.25 * across.length(), 11.5, 4.0);
    let ring =
        (DVec2::new(across.length() - 9.5, q.x + 34.0).length() - 3.0).min(cylinder(across, q.x + 34.0, 9.0, 2.0));
    // Coils 9 voxels apart; no angles, which differ between platforms in the last bit.
    let coil = 9.0 * (q.x.clamp(-27.0, 27.0) / 9.0).round();
    let spring = DVec2::new(across.length() - 8.2, q.x - coil).length() - 1.9;
    stem.min(head).min(ring).min(spring)
}

/// Signed distance of a box with rounded edges, given by its half extents.
fn rounded_box(p: DVec3, half: DVec3, radius: f64) -> f64 {
    let q = p.abs() - half + radius;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - radius
}

/// Signed distance of a cylinder, given by the position across and along its axis, its radius and half its length.
fn cylinder(across: DVec2, along: f64, radius: f64, half: f64) -> f64 {
    let q = DVec2::new(across.length() - radius, along.abs() - half);
    q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(seed: u64) -> std::sync::Arc<Volume> {
        let (scene, _) = engine(seed).unwrap();
        let Some(layer) = scene.layers[0].kind.volume() else { panic!("a volume") };
        layer.volume.clone()
    }

    #[test]
    fn the_valve_lies_in_a_chamber_behind_walls() {
        let volume = volume(7);
        let at = |x: f64, y: f64, z: f64| volume.at(DVec3::new(x, y, z)).unwrap();
        assert!(at(80.0, 92.0, 57.0) > 190.0, "the stem");
        assert!(at(60.0, 104.0, 50.0) < 60.0, "the chamber");
        assert!(at(80.0, 112.0, 57.0) > 90.0 && at(158.0, 92.0, 57.0) < 60.0, "its wall, and air outside");
        // Straight from the front every line to the stem meets metal first.
        for x in [50.0, 60.0, 100.0] {
            let first = (0..90).map(f64::from).find(|y| at(x, *y, 57.0) > 80.0);
            assert!(first.is_some_and(|y| y < 80.0), "{x}: {first:?}");
        }
    }

    #[test]
    fn a_seed_makes_one_engine() {
        assert_eq!(volume(7), volume(7));
        assert_ne!(volume(7), volume(8));
    }
}

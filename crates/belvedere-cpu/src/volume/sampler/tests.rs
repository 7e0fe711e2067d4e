use super::*;
use belvedere_core::{DMat3, DVec3};
use belvedere_scene::VoxelValues;

const GROUP: usize = 8;

fn judged<T: Voxel>(values: &[T], stored: VoxelValues) {
    let volume = Volume::new([11, 9, 7], DMat3::IDENTITY, DVec3::ZERO, stored).unwrap();
    let sampler = Sampler::new(&volume, values);
    let value = |p: DVec3| volume.at(p.clamp(DVec3::ZERO, DVec3::new(10.0, 8.0, 6.0))).unwrap();
    for k in 0..200u32 {
        // Every third group lies near the border.
        let room = if k % 3 == 0 { 0.0 } else { 1.0 };
        let share = |l: usize, a: u32| f64::from((k * 8 + l as u32) * (7919 + 104_729 * a) % 1000) / 999.0;
        let place = |l: usize| {
            let most = DVec3::new(10.0, 8.0, 6.0) - 2.0 * room - 1e-3;
            DVec3::splat(room) + most * DVec3::new(share(l, 0), share(l, 1), share(l, 2))
        };
        let p: [[f32; GROUP]; 3] = std::array::from_fn(|a| std::array::from_fn(|l| place(l)[a] as f32));
        let (found, slopes) = (sampler.at(&p), sampler.gradients(&p));
        for l in 0..GROUP {
            let q = place(l);
            assert!((f64::from(found[l]) - value(q)).abs() < 1e-4 * 300.0, "{q}: {} {}", found[l], value(q));
            for (a, e) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
                let want = 0.5 * (value(q + e) - value(q - e));
                assert!((f64::from(slopes[a][l]) - want).abs() < 0.05, "{q} axis {a}: {} {want}", slopes[a][l]);
            }
        }
    }
}

#[test]
fn values_and_gradients_are_those_of_the_volume_for_every_type() {
    let number = |i: usize| ((i * 7919) % 251) as i32;
    let all = || (0..11 * 9 * 7).map(number);
    let bytes: Vec<u8> = all().map(|v| v as u8).collect();
    judged(&bytes, VoxelValues::U8(bytes.clone()));
    let wide: Vec<u16> = all().map(|v| v as u16 + 300).collect();
    judged(&wide, VoxelValues::U16(wide.clone()));
    let signed: Vec<i16> = all().map(|v| v as i16 - 120).collect();
    judged(&signed, VoxelValues::I16(signed.clone()));
    let real: Vec<f32> = all().map(|v| v as f32 - 40.5).collect();
    judged(&real, VoxelValues::F32(real.clone()));
}

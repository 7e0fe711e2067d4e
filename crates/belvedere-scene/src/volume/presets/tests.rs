use super::*;
use crate::VoxelValues;
use belvedere_core::{DMat3, DVec3};

fn volume(values: Vec<u8>) -> Volume {
    Volume::new([16, 16, 16], DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(values)).unwrap()
}

#[test]
fn every_name_is_a_function_over_the_range() {
    let volume = volume((0..4096u32).map(|i| (20 + i % 100) as u8).collect());
    for name in TRANSFER_NAMES {
        let f = TransferFunction::named(name, &volume).unwrap();
        // A cut shows the background, too.
        let background = if *name == SLICE { 1.0 } else { 0.0 };
        assert_eq!((f.name(), f.at(20.0)[3]), (*name, background));
        assert!(f.at(119.0)[3] > 0.25, "{name}");
    }
    assert_eq!(TransferFunction::named("bone", &volume), None);
}

#[test]
fn the_background_is_left_out() {
    // Noise around 30, a ball of about 140.
    let values = (0..4096i64).map(|i| {
        let [x, y, z] = [i % 16, i / 16 % 16, i / 256].map(|v| v - 8);
        let noise = i * 7919 % 13;
        (if x * x + y * y + z * z < 36 { 140 + noise } else { 24 + noise }) as u8
    });
    let f = TransferFunction::auto(&volume(values.collect()));
    assert!(f.at(36.0)[3] < 0.01 && f.at(140.0)[3] > 0.5, "{f:?}");
}

/// A dense stem, thin leaves of low values beside it, and noise.
fn tree(leaves: bool) -> Volume {
    let n = 40usize;
    let value = |i: usize| {
        let [x, y, z] = [i % n, i / n % n, i / n / n].map(|v| v as f64 - 20.0);
        let noise = (i * 7919 % 13) as f64 - 6.0;
        let stem = x.hypot(y) < 4.0;
        let leaf = leaves && z.rem_euclid(10.0) < 2.0 && (x - 12.0).hypot(y) < 6.0;
        (12.0
            + noise
            + if stem {
                180.0
            } else if leaf {
                45.0
            } else {
                0.0
            }) as u8
    };
    let values = VoxelValues::U8((0..n * n * n).map(value).collect());
    Volume::new([n; 3], DMat3::IDENTITY, DVec3::ZERO, values).unwrap()
}

#[test]
fn leaves_are_shown_as_well_as_stems() {
    let f = TransferFunction::auto(&tree(true));
    assert!(f.at(18.0)[3] == 0.0 && f.at(57.0)[3] > 0.15 && f.at(190.0)[3] > 0.7, "{f:?}");
    // Without them, low values are borders of the stem, and stay clear.
    let f = TransferFunction::auto(&tree(false));
    assert!(f.at(57.0)[3] == 0.0 && f.at(190.0)[3] > 0.7, "{f:?}");
}

#[test]
fn hounsfield_units_are_shown_as_such_however_far_they_reach() {
    let of = |most: i16| {
        let values = (0..4096).map(|i| if i == 0 { most } else { -1024 + (i % 2000) as i16 }).collect();
        let volume = Volume::new([16; 3], DMat3::IDENTITY, DVec3::ZERO, VoxelValues::I16(values)).unwrap();
        TransferFunction::named("ct-bone", &volume).unwrap()
    };
    // Muscle is clear, bone is not; metal changes nothing.
    assert!(of(1200).at(60.0)[3] == 0.0 && of(1200).at(500.0)[3] > 0.4);
    assert_eq!(of(1200), of(32000));
}

#[test]
fn a_wall_is_opaque_and_its_lumen_clear_on_either_side() {
    for (lumen, wall) in [(-1000.0, 40.0), (300.0, 50.0)] {
        let f = TransferFunction::wall(lumen, 0.5 * (lumen + wall), wall);
        let at = |share: f64| f.at(lumen + share * (wall - lumen))[3];
        assert_eq!([at(-9.0), at(0.0), at(0.5), at(0.76), at(1.0), at(9.0)], [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert!(at(0.55) > 0.1, "{f:?}");
    }
}

#[test]
fn one_value_alone_is_a_translucent_block() {
    let block = volume(vec![9; 4096]);
    for name in TRANSFER_NAMES {
        let f = TransferFunction::named(name, &block).unwrap();
        assert!((1.0 - (1.0 - f.at(9.0)[3]).powi(15) - BLOCK).abs() < 1e-12 && f.name() == *name);
    }
}

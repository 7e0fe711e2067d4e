//! Valid files of every format, small, made by the program's own writers or by the functions here.

pub mod cities;
pub mod documents;
pub mod meshes;
pub mod molecules;
pub mod packages;
pub mod rasters;
pub mod stacks;
pub mod tables;
pub mod vectors;
pub mod volumes;

use belvedere::core::DVec2;
use belvedere::io::crs::Transform;

/// South-west corner of the ground of all seeds, EPSG:32632.
const CORNER: DVec2 = DVec2::new(600_000.0, 5_200_000.0);

/// Longitude and latitude of a point `x` metres east and `y` north of the corner.
fn degrees(x: f64, y: f64) -> [f64; 2] {
    let to_degrees = Transform::between_epsg(32632, 4326).expect("both systems are known");
    to_degrees.forward_one(CORNER + DVec2::new(x, y)).expect("inside its zone").to_array()
}

/// Positions of a walk over the ground, metres from the corner.
fn walk() -> Vec<[f64; 2]> {
    (0..12).map(|i| f64::from(i) / 11.0).map(|t| [60.0 + 420.0 * t, 250.0 + 120.0 * (6.0 * t).sin()]).collect()
}

/// Corners of a square around a point, closed, metres from the corner of the ground.
fn square(x: f64, y: f64, half: f64) -> Vec<[f64; 2]> {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[u, v]| [x + half * u, y + half * v]).into()
}

/// What `write` writes to a file of this name, as bytes.
fn written(name: &str, write: impl FnOnce(&std::path::Path)) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join(name);
    write(&path);
    std::fs::read(&path).expect("written")
}

/// Bytes in letters.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for part in bytes.chunks(3) {
        let n = part.iter().fold(0u32, |n, b| n << 8 | u32::from(*b)) << (8 * (3 - part.len()));
        for k in 0..4 {
            let digit = char::from(DIGITS[(n >> (18 - 6 * k) & 63) as usize]);
            out.push(if k <= part.len() { digit } else { '=' });
        }
    }
    out
}

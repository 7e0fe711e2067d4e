//! Geometries of GeoPackage: a header of its own (OGC 12-128r19, 2.1.3), then well-known binary.

use super::odd::Odd;
use super::{Geometry, wkb};

/// The geometries of a value, several of a collection, none of an empty one.
///
/// * `srs_id`: system of its table.
pub(super) fn geometries(blob: &[u8], srs_id: i64, odd: &mut Odd) -> Result<Vec<Geometry>, String> {
    let header = Header::of(blob)?;
    odd.other_system += usize::from(i64::from(header.srs_id) != srs_id);
    let mut out = Vec::new();
    if !header.empty {
        wkb::read(header.wkb, odd, &mut out)?;
    }
    out.retain(|geometry| geometry.vertices().next().is_some());
    odd.without_geometry += usize::from(out.is_empty());
    Ok(out)
}

/// The header before the well-known binary.
struct Header<'b> {
    srs_id: i32,
    empty: bool,
    wkb: &'b [u8],
}

impl<'b> Header<'b> {
    fn of(blob: &'b [u8]) -> Result<Self, String> {
        let short = || format!("its geometry of {} bytes is cut off; get the file again", blob.len());
        let head: &[u8; 8] = blob.first_chunk().ok_or_else(short)?;
        let [b'G', b'P', _, flags, srs_id @ ..] = head else {
            let [a, b, ..] = head;
            return Err(format!(
                "its geometry begins with the bytes {a:02x} {b:02x}, not with \"GP\"; export the file again"
            ));
        };
        if flags & 0x20 != 0 {
            return Err("its geometry is of an extended type that is not read; export it as a standard one".into());
        }
        let srs_id = if flags & 1 == 1 { i32::from_le_bytes(*srs_id) } else { i32::from_be_bytes(*srs_id) };
        let envelope = match flags >> 1 & 7 {
            0 => 0,
            1 => 32,
            2 | 3 => 48,
            4 => 64,
            code => return Err(format!("its envelope is of kind {code}, the last is 4; export the file again")),
        };
        let wkb = blob.get(8 + envelope..).ok_or_else(short)?;
        Ok(Self { srs_id, empty: flags & 0x10 != 0, wkb })
    }
}

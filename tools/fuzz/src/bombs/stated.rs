//! Files whose heads state sizes that nothing follows.

use super::Bomb;

/// Files of all formats with a head that states sizes.
pub(super) fn all() -> Vec<Bomb> {
    let mut out = Vec::new();
    for side in [20_000u32, 60_000, 400_000] {
        for bits in [8u16, 16, 32] {
            out.push(Bomb::new(format!("strip_{side}_{bits}.tif"), strip(side, bits)));
        }
        out.push(Bomb::new(
            format!("ascii_{side}.asc"),
            format!("ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n"),
        ));
    }
    for side in [20_000u32, 60_000] {
        out.push(Bomb::new(format!("tiles_left_out_{side}.tif"), tiles(side, None)));
        out.push(Bomb::new(
            format!("one_tile_for_all_{side}.tif"),
            tiles(side, Some(super::packed::zlib_zeros(TILE * TILE * 2))),
        ));
    }
    for n in [1500u64, 60_000, 4_000_000_000] {
        let head = |kind: &str| format!("NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {n} {n} {n}\nencoding: raw\n\n");
        out.push(Bomb::new(format!("stated_{n}.nrrd"), head("uint8")));
        out.push(Bomb::new(format!("stated_floats_{n}.nrrd"), head("float")));
        out.push(Bomb::new(
            format!("stated_{n}.mha"),
            format!("ObjectType = Image\nNDims = 3\nDimSize = {n} {n} {n}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"),
        ));
        out.push(Bomb::new(
            format!("stated_{n}.vtk"),
            format!("# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {n} {n} {n}\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA {n}\nSCALARS x unsigned_char 1\nLOOKUP_TABLE default\n"),
        ));
        let last = n - 1;
        out.push(Bomb::new(
            format!("stated_{n}.vti"),
            format!("<?xml version=\"1.0\"?><VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 {last} 0 {last} 0 {last}\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 {last} 0 {last} 0 {last}\"><PointData><DataArray type=\"UInt8\" Name=\"x\" format=\"ascii\">1 2</DataArray></PointData></Piece></ImageData></VTKFile>"),
        ));
        out.push(Bomb::new(
            format!("vertices_{n}.ply"),
            format!("ply\nformat binary_little_endian 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\nelement face {n}\nproperty list uchar int vertex_indices\nend_header\n"),
        ));
        out.push(Bomb::new(
            format!("cube_{n}.cube"),
            format!("x\ny\n1 0 0 0\n{n} 1 0 0\n{n} 0 1 0\n{n} 0 0 1\n6 0 0 0 0\n1 2 3\n"),
        ));
        out.push(Bomb::new(
            format!("accessor_{n}.gltf"),
            format!("{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\"accessors\":[{{\"componentType\":5126,\"count\":{n},\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,1]}}]}}"),
        ));
    }
    let mut stl = vec![0u8; 80];
    stl.extend(u32::MAX.to_le_bytes());
    out.push(Bomb::new("triangles.stl", stl));
    out.extend(nested());
    out
}

/// Texts that nest or refer to themselves.
fn nested() -> Vec<Bomb> {
    let deep = |n: usize| format!("{{\"type\":\"LineString\",\"coordinates\":{}{}}}", "[".repeat(n), "]".repeat(n));
    let entities: String =
        (1..10).map(|k| format!("<!ENTITY e{k} \"{}\">", format!("&e{};", k - 1).repeat(10))).collect();
    let doctype = |root: &str| format!("<?xml version=\"1.0\"?><!DOCTYPE {root} [<!ENTITY e0 \"spam\">{entities}]>");
    vec![
        Bomb::new("deep.geojson", deep(500_000)),
        Bomb::new("digits.geojson", format!("{{\"type\":\"Point\",\"coordinates\":[1{}, 2]}}", "0".repeat(2_000_000))),
        Bomb::new("entities.kml", format!("{}<kml><Document><name>&e9;</name></Document></kml>", doctype("kml"))),
        Bomb::new("entities.gpx", format!("{}<gpx><trk><name>&e9;</name></trk></gpx>", doctype("gpx"))),
        Bomb::new(
            "entities.osm",
            format!(
                "{}<osm><node id=\"1\" lat=\"0\" lon=\"0\"><tag k=\"name\" v=\"&e9;\"/></node></osm>",
                doctype("osm")
            ),
        ),
        Bomb::new("corners.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf{}\n", " 1 2 3".repeat(500_000))),
    ]
}

/// Nodes along a side of a tile.
const TILE: usize = 512;

/// A directory of tags with values of 32 bits, and what follows it.
fn tiff(tags: &[(u16, u32, u32)], rest: &[u8]) -> Vec<u8> {
    let mut out = b"II*\0\x08\0\0\0".to_vec();
    out.extend((tags.len() as u16).to_le_bytes());
    for (tag, count, value) in tags {
        out.extend(tag.to_le_bytes());
        out.extend(4u16.to_le_bytes());
        out.extend(count.to_le_bytes());
        out.extend(value.to_le_bytes());
    }
    out.extend([0; 4]);
    out.extend(rest);
    out
}

/// Where what follows a directory of so many tags begins.
fn behind(tags: usize) -> u32 {
    (8 + 2 + 12 * tags + 4) as u32
}

/// A raster in one strip of which eight bytes are there.
fn strip(side: u32, bits: u16) -> Vec<u8> {
    let format = if bits == 32 { 3 } else { 1 };
    let tags = [
        (256, 1, side),
        (257, 1, side),
        (258, 1, u32::from(bits)),
        (259, 1, 1),
        (262, 1, 1),
        (273, 1, behind(9)),
        (278, 1, side),
        (279, 1, 8),
        (339, 1, format),
    ];
    tiff(&tags, &[0; 8])
}

/// A raster of 16 bits in tiles: all left out, or all the same packed one.
fn tiles(side: u32, tile: Option<Vec<u8>>) -> Vec<u8> {
    let count = side.div_ceil(TILE as u32).pow(2);
    let tables = behind(9);
    let data = tables + 8 * count;
    let (at, size) = tile.as_ref().map_or((0, 0), |tile| (data, tile.len() as u32));
    let mut rest: Vec<u8> = std::iter::repeat_n(at.to_le_bytes(), count as usize).flatten().collect();
    rest.extend(std::iter::repeat_n(size.to_le_bytes(), count as usize).flatten());
    rest.extend(tile.unwrap_or_default());
    let tags = [
        (256, 1, side),
        (257, 1, side),
        (258, 1, 16),
        (259, 1, 8),
        (262, 1, 1),
        (322, 1, TILE as u32),
        (323, 1, TILE as u32),
        (324, count, tables),
        (325, count, tables + 4 * count),
    ];
    tiff(&tags, &rest)
}

//! Voxels and their colours.

use super::base64;
use super::packages::{gzip, zlib};

/// 3 x 4 x 5 values.
fn values() -> impl Iterator<Item = u8> {
    (0..60u8).map(|i| 7 + 2 * i)
}

fn nrrd_head(kind: &str, encoding: &str) -> String {
    format!(
        "NRRD0004\n# a seed\ntype: {kind}\ndimension: 3\nsizes: 3 4 5\nspacings: 2 2 1.5\nendian: little\nencoding: {encoding}\n\n"
    )
}

/// NRRD: raw, compressed, text, with directions.
pub fn nrrd() -> Vec<Vec<u8>> {
    let raw: Vec<u8> = values().collect();
    let floats: Vec<u8> = values().flat_map(|v| f32::from(v).to_le_bytes()).collect();
    let text: Vec<String> = values().map(|v| v.to_string()).collect();
    let directed = "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 4 5\nspace directions: (0,2,0) (-3,0,0) (0,0,1.5)\nspace origin: (1, -2, 5e1)\nencoding: raw\nbyte skip: -1\n\n";
    vec![
        [nrrd_head("uint8", "raw").into_bytes(), raw.clone()].concat(),
        [nrrd_head("float", "gzip").into_bytes(), gzip(&floats)].concat(),
        [nrrd_head("int16", "ascii").into_bytes(), text.join(" ").into_bytes()].concat(),
        [directed.into(), raw].concat(),
    ]
}

/// VTK ImageData: text, letters, compressed blocks, appended.
pub fn vti() -> Vec<Vec<u8>> {
    let raw: Vec<u8> = values().collect();
    let count = |n: usize| (n as u32).to_le_bytes().to_vec();
    let whole = |attributes: &str, format: &str, inline: &str, appended: &[u8]| {
        let head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" {attributes}>\n<ImageData WholeExtent=\"0 2 0 3 0 4\" Origin=\"1 2 3\" Spacing=\"2 1 0.5\">\n<Piece Extent=\"0 2 0 3 0 4\">\n<PointData Scalars=\"density\">\n<DataArray type=\"Float32\" Name=\"flow\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3</DataArray>\n<DataArray type=\"UInt8\" Name=\"density\" {format}>{inline}</DataArray>\n</PointData>\n<CellData></CellData></Piece></ImageData>\n"
        );
        [head.as_bytes(), appended, b"</VTKFile>\n"].concat()
    };
    let text: Vec<String> = raw.iter().map(u8::to_string).collect();
    let plain = [count(raw.len()), raw.clone()].concat();
    let blocks: Vec<Vec<u8>> = raw.chunks(16).map(zlib).collect();
    let mut head = [count(blocks.len()), count(16), count(raw.len() % 16)].concat();
    head.extend(blocks.iter().flat_map(|b| count(b.len())));
    let packed = base64(&head) + &base64(&blocks.concat());
    let appended =
        [b"<AppendedData encoding=\"raw\">\n _".to_vec(), plain.clone(), b"</AppendedData>".to_vec()].concat();
    let narrow = "header_type=\"UInt32\"";
    vec![
        whole(narrow, "format=\"ascii\"", &text.join(" "), b""),
        whole(narrow, "format=\"binary\"", &base64(&plain), b""),
        whole(&format!("{narrow} compressor=\"vtkZLibDataCompressor\""), "format=\"binary\"", &packed, b""),
        whole(narrow, "format=\"appended\" offset=\"0\"", "", &appended),
    ]
}

/// Raw samples of four bytes.
pub fn raw() -> Vec<Vec<u8>> {
    vec![values().flat_map(|v| f32::from(v).to_le_bytes()).collect()]
}

/// The volume beside a transfer function.
pub fn beside_transfer() -> Vec<(&'static str, Vec<u8>)> {
    vec![("v.nrrd", nrrd().remove(0))]
}

/// Transfer functions: the program's own, and ParaView's.
pub fn transfers() -> Vec<Vec<u8>> {
    vec![
        br##"{"reference_step":0.5,"points":[{"value":10,"color":"#101010","opacity":0},{"value":60,"color":"#ffcc88","opacity":0.4},{"value":120,"color":"#ffffff","opacity":1}]}"##.to_vec(),
        br#"[{"Name":"seed","ColorSpace":"RGB","Points":[7,0,0.5,0,125,1,0.5,0],"RGBPoints":[7,0.1,0.2,0.9,60,0.8,0.8,0.8,125,0.7,0.1,0.1]}]"#.to_vec(),
    ]
}

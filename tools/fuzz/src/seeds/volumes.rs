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

/// MetaImage: raw, compressed, text; turned and moved.
pub fn meta_image() -> Vec<Vec<u8>> {
    let raw: Vec<u8> = values().collect();
    let shorts: Vec<u8> = values().flat_map(|v| u16::from(v).to_be_bytes()).collect();
    let text: Vec<String> = values().map(|v| v.to_string()).collect();
    let head = |kind: &str, more: &str| {
        let place =
            "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 -2 5e1\nElementSpacing = 2 3 1.5\nDimSize = 3 4 5";
        format!("ObjectType = Image\nNDims = 3\n{more}{place}\nElementType = {kind}\nElementDataFile = LOCAL\n")
            .into_bytes()
    };
    vec![
        [head("MET_UCHAR", "BinaryData = True\n"), raw.clone()].concat(),
        [head("MET_USHORT", "BinaryDataByteOrderMSB = True\nCompressedData = True\n"), zlib(&shorts)].concat(),
        [head("MET_FLOAT", "BinaryData = False\n"), text.join(" ").into_bytes()].concat(),
        [head("MET_UCHAR", "HeaderSize = -1\n"), b"skip".to_vec(), raw].concat(),
    ]
}

/// NIfTI of both versions and byte orders: placed by rows, by a turn, and not at all; scaled.
pub fn nifti() -> Vec<Vec<u8>> {
    let one = |big: bool, sform: bool| {
        let mut head = vec![0u8; 352];
        let mut put = |at: usize, bytes: &[u8]| {
            let reversed: Vec<u8> = bytes.iter().rev().copied().collect();
            head[at..at + bytes.len()].copy_from_slice(if big { &reversed } else { bytes });
        };
        put(0, &348u32.to_le_bytes());
        [3i16, 3, 4, 5, 1, 1, 1, 1].iter().enumerate().for_each(|(i, n)| put(40 + 2 * i, &n.to_le_bytes()));
        put(70, &4i16.to_le_bytes());
        put(72, &16i16.to_le_bytes());
        [-1.0f32, 2.0, 3.0, 1.5].iter().enumerate().for_each(|(i, n)| put(76 + 4 * i, &n.to_le_bytes()));
        put(108, &352.0f32.to_le_bytes());
        put(112, &0.5f32.to_le_bytes());
        put(if sform { 254 } else { 252 }, &1i16.to_le_bytes());
        put(256, &0.5f32.to_le_bytes());
        [0.0f32, -3.0, 0.0, 9.0, 2.0, 0.0, 0.0, -4.0, 0.0, 0.0, 1.5, 7.0]
            .iter()
            .enumerate()
            .for_each(|(i, n)| put(280 + 4 * i, &n.to_le_bytes()));
        head[123] = 2;
        head[344..348].copy_from_slice(b"n+1\0");
        head.extend(values().flat_map(|v| if big { i16::from(v).to_be_bytes() } else { i16::from(v).to_le_bytes() }));
        head
    };
    let mut two = vec![0u8; 544];
    two[..4].copy_from_slice(&540u32.to_le_bytes());
    two[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
    two[12] = 2;
    [3i64, 3, 4, 5].iter().enumerate().for_each(|(i, n)| two[16 + 8 * i..24 + 8 * i].copy_from_slice(&n.to_le_bytes()));
    [1.0f64, 2.0, 2.0, 1.5]
        .iter()
        .enumerate()
        .for_each(|(i, n)| two[104 + 8 * i..112 + 8 * i].copy_from_slice(&n.to_le_bytes()));
    two[168..176].copy_from_slice(&544i64.to_le_bytes());
    two.extend(values());
    vec![one(false, true), one(true, false), two]
}

/// Legacy VTK: text and binary, attributes and fields, values of points and cells.
pub fn vtk() -> Vec<Vec<u8>> {
    let head = |kind: &str| {
        format!(
            "# vtk DataFile Version 5.1\na seed\n{kind}\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 4 5\nSPACING 2 1 0.5\nORIGIN 1 2 3\n"
        )
    };
    let text: Vec<String> = values().map(|v| v.to_string()).collect();
    let shorts: Vec<u8> = values().flat_map(|v| u16::from(v).to_be_bytes()).collect();
    let cells = "CELL_DATA 24\nFIELD FieldData 2\nid 1 24 int\n";
    let ids: String = (0..24).map(|i| format!("{i} ")).collect();
    vec![
        format!("{}POINT_DATA 60\nSCALARS density float 1\nLOOKUP_TABLE default\n{}\n", head("ASCII"), text.join(" "))
            .into_bytes(),
        [
            head("BINARY").as_bytes(),
            b"POINT_DATA 60\nSCALARS a%20b unsigned_short\nLOOKUP_TABLE default\n",
            &shorts,
            b"\nMETADATA\nINFORMATION 0\n\n",
        ]
        .concat(),
        format!("{}{cells}{ids}\nflow 3 1 double\n1 2 3\n", head("ASCII")).into_bytes(),
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

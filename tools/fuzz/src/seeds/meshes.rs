//! Triangles and their pictures.

use super::{base64, rasters::png};

/// Corners of a pyramid on a square, and its triangles.
const CORNERS: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0], [4.0, 4.0, 6.0]];
const TRIANGLES: [[u16; 3]; 6] = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

/// A square with a picture.
pub fn textured_obj() -> Vec<u8> {
    "mtllib m.mtl\nv 0 0 0\nv 8 0 0\nv 8 8 2\nv 0 8 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\no left wing\nusemtl paper\nf 1/1/1 2/2/1 3/3/1\no right wing\nf 1/1 3/3 4/4\n".into()
}

/// Files beside OBJ.
pub fn beside_obj() -> Vec<(&'static str, Vec<u8>)> {
    vec![("m.mtl", mtl().remove(0)), ("p.png", png(4, 4)), ("p.jpg", jpeg())]
}

/// OBJ: with a picture, and with faces of many corners and indices from the end.
pub fn obj() -> Vec<Vec<u8>> {
    let corners: String = CORNERS.iter().map(|[x, y, z]| format!("v {x} {y} {z} 0.5 0.25 1\n")).collect();
    let text =
        format!("# a seed\n{corners}g base\ns 1\nf 1 4 3 2\ng sides\nf -5 -4 -1\nf 2 3 5\nf 3 4 5\nf 4 1 5\nl 1 2 3\n");
    vec![textured_obj(), text.into_bytes()]
}

/// Materials.
pub fn mtl() -> Vec<Vec<u8>> {
    vec![
        b"newmtl paper\nKd 1 0.5 0.25\nd 0.8\nmap_Kd p.png\nnewmtl other\nKd 0 0 1\nmap_Kd -s 2 2 1 p.jpg\n".to_vec(),
        b"newmtl paper\nKa 0 0 0\nmap_Kd p.jpg\nmap_d p.png\n".to_vec(),
    ]
}

/// A grey JPEG of 8 x 8 pixels: one block whose coefficients are all zero.
pub fn jpeg() -> Vec<u8> {
    let segment =
        |marker: u8, content: &[u8]| [&[0xff, marker][..], &(content.len() as u16 + 2).to_be_bytes(), content].concat();
    // One code of one bit in each table: no difference, end of block.
    let huffman = |class: u8| [&[class, 1][..], &[0; 15], &[0]].concat();
    [
        vec![0xff, 0xd8],
        segment(0xe0, b"JFIF\0\x01\x01\0\0\x01\0\x01\0\0"),
        segment(0xdb, &[&[0][..], &[16; 64]].concat()),
        segment(0xc0, &[8, 0, 8, 0, 8, 1, 1, 0x11, 0]),
        segment(0xc4, &huffman(0x00)),
        segment(0xc4, &huffman(0x10)),
        segment(0xda, &[1, 1, 0, 0, 63, 0]),
        vec![0x3f, 0xff, 0xd9],
    ]
    .concat()
}

/// PLY: text and binary in both orders.
pub fn ply() -> Vec<Vec<u8>> {
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a seed\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let corners: String = CORNERS.iter().map(|[x, y, z]| format!("{x} {y} {z} 200 {x} 30\n")).collect();
    let faces: String = TRIANGLES.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect();
    let binary = |is_big: bool| {
        let four = |v: [u8; 4]| if is_big { v.into_iter().rev().collect::<Vec<u8>>() } else { v.to_vec() };
        let corner =
            |p: &[f32; 3]| [p.iter().flat_map(|v| four(v.to_le_bytes())).collect(), vec![200, 10, 30]].concat();
        let face =
            |t: &[u16; 3]| [vec![3], t.iter().flat_map(|v| four(u32::from(*v).to_le_bytes())).collect()].concat();
        let name = if is_big { "binary_big_endian" } else { "binary_little_endian" };
        let body: Vec<u8> = CORNERS.iter().flat_map(corner).chain(TRIANGLES.iter().flat_map(face)).collect();
        [head(name).into_bytes(), body].concat()
    };
    vec![(head("ascii") + &corners + &faces).into_bytes(), binary(false), binary(true)]
}

/// STL: text and binary.
pub fn stl() -> Vec<Vec<u8>> {
    let corner = |k: &u16| CORNERS[usize::from(*k)];
    let mut text = "solid seed\n".to_owned();
    let mut binary = [vec![b'x'; 80], (TRIANGLES.len() as u32).to_le_bytes().to_vec()].concat();
    for triangle in &TRIANGLES {
        let rows: String = triangle.iter().map(corner).map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).collect();
        text += &format!("facet normal 0 0 1\nouter loop\n{rows}endloop\nendfacet\n");
        let numbers = [0.0f32, 0.0, 1.0].into_iter().chain(triangle.iter().flat_map(corner));
        binary.extend(numbers.flat_map(f32::to_le_bytes));
        binary.extend([0, 0]);
    }
    vec![(text + "endsolid seed\n").into_bytes(), binary]
}

/// Positions, texture coordinates and indices of the pyramid, and a picture, in one buffer.
fn buffer() -> (Vec<u8>, usize) {
    let positions: Vec<u8> = CORNERS.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let textures: Vec<u8> = CORNERS.iter().flat_map(|p| [p[0] / 8.0, p[1] / 8.0]).flat_map(f32::to_le_bytes).collect();
    let indices: Vec<u8> = TRIANGLES.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let picture = png(4, 4);
    let length = picture.len();
    ([positions, textures, indices, picture].concat(), length)
}

fn gltf_json(uri: &str) -> String {
    let (bytes, picture) = buffer();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"name":"house","mesh":0,"scale":[1,1,1.5],"translation":[0,0,0.5],"children":[1]}},{{"mesh":0,"rotation":[0,0,0.7071068,0.7071068],"translation":[12,0,0]}}],
"meshes":[{{"name":"pyramid","primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0,"mode":4}}]}}],
"materials":[{{"alphaMode":"MASK","alphaCutoff":0.4,"pbrMetallicRoughness":{{"baseColorFactor":[1,0.5,0.5,1],"baseColorTexture":{{"index":0}}}}}}],
"textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":10497,"wrapT":33071}}],"images":[{{"bufferView":3,"mimeType":"image/png"}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3","min":[0,0,0],"max":[8,8,6]}},{{"bufferView":1,"componentType":5126,"count":5,"type":"VEC2"}},{{"bufferView":2,"componentType":5123,"count":18,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":60}},{{"buffer":0,"byteOffset":60,"byteLength":40}},{{"buffer":0,"byteOffset":100,"byteLength":36}},{{"buffer":0,"byteOffset":136,"byteLength":{picture}}}],
"buffers":[{{"byteLength":{}{uri}}}]}}"#,
        bytes.len()
    )
}

/// glTF with its data in the text.
pub fn gltf() -> Vec<Vec<u8>> {
    let uri = format!(",\"uri\":\"data:application/octet-stream;base64,{}\"", base64(&buffer().0));
    vec![gltf_json(&uri).into_bytes()]
}

/// GLB.
pub fn glb() -> Vec<Vec<u8>> {
    let chunk = |kind: &[u8; 4], mut content: Vec<u8>, fill: u8| {
        content.resize(content.len().next_multiple_of(4), fill);
        [&(content.len() as u32).to_le_bytes()[..], kind, &content].concat()
    };
    let body = [chunk(b"JSON", gltf_json("").into_bytes(), b' '), chunk(b"BIN\0", buffer().0, 0)].concat();
    vec![
        [b"glTF".to_vec(), 2u32.to_le_bytes().to_vec(), (body.len() as u32 + 12).to_le_bytes().to_vec(), body].concat(),
    ]
}

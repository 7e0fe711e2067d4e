//! Voxels in files that hold images or arrays: stacks of TIFF, NumPy, MRC, DICOM.

/// 3 x 4 x 5 values.
fn values() -> impl Iterator<Item = u8> {
    (0..60u8).map(|i| 7 + 2 * i)
}

/// A TIFF of five pages of 3 x 4 pixels of 8 bits, described by a text.
fn tiff(text: &str) -> Vec<u8> {
    let mut out = b"II*\0\x08\0\0\0".to_vec();
    let samples: Vec<u8> = values().collect();
    for page in 0..5usize {
        let words = if page == 0 && !text.is_empty() { [text.as_bytes(), b"\0"].concat() } else { Vec::new() };
        let count = if words.is_empty() { 7u16 } else { 8 };
        let body = out.len() + 2 + 12 * usize::from(count) + 4;
        let mut entries = vec![(256u16, 4u32, 3u32), (257, 4, 4), (258, 3, 8), (259, 3, 1)];
        entries.push((262, 3, 1));
        if !words.is_empty() {
            entries.push((270, 2, (body + 12) as u32));
        }
        entries.extend([(273, 4, body as u32), (279, 4, 12)]);
        out.extend(count.to_le_bytes());
        for (tag, kind, value) in entries {
            let number = if tag == 270 { words.len() as u32 } else { 1 };
            out.extend(tag.to_le_bytes());
            out.extend((kind as u16).to_le_bytes());
            out.extend(number.to_le_bytes());
            out.extend(value.to_le_bytes());
        }
        let end = body + 12 + words.len();
        out.extend((if page < 4 { end as u32 } else { 0 }).to_le_bytes());
        out.extend(&samples[12 * page..12 * page + 12]);
        out.extend(words);
    }
    out
}

/// Stacks of TIFF: of ImageJ, OME-TIFF, plain pages.
pub fn tiffs() -> Vec<Vec<u8>> {
    let ome = "<?xml version=\"1.0\"?><OME><Image ID=\"I\"><Pixels DimensionOrder=\"XYZCT\" Type=\"uint8\" SizeX=\"3\" SizeY=\"4\" SizeZ=\"5\" SizeC=\"1\" SizeT=\"1\" PhysicalSizeX=\"2\" PhysicalSizeY=\"2\" PhysicalSizeZ=\"1.5\"><TiffData IFD=\"0\" FirstZ=\"0\" PlaneCount=\"5\"/></Pixels></Image></OME>";
    vec![tiff("ImageJ=1.54f\nimages=5\nslices=5\nspacing=1.5\nunit=mm\n"), tiff(ome), tiff("")]
}

/// Arrays of NumPy, in both orders of memory.
pub fn npy() -> Vec<Vec<u8>> {
    let array = |version: u8, descr: &str, fortran: &str, data: Vec<u8>| {
        let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': (5, 4, 3), }}\n");
        let mut out = vec![0x93, b'N', b'U', b'M', b'P', b'Y', version, 0];
        match version {
            1 => out.extend((header.len() as u16).to_le_bytes()),
            _ => out.extend((header.len() as u32).to_le_bytes()),
        }
        [out, header.into_bytes(), data].concat()
    };
    let floats = values().flat_map(|v| f32::from(v).to_be_bytes()).collect();
    vec![array(1, "|u1", "False", values().collect()), array(2, ">f4", "True", floats)]
}

/// Density maps in both orders of bytes.
pub fn mrc() -> Vec<Vec<u8>> {
    let map = |big: bool| {
        let mut head = vec![0u8; 1024];
        let mut put = |word: usize, value: i32| {
            let bytes = if big { value.to_be_bytes() } else { value.to_le_bytes() };
            head[4 * (word - 1)..4 * word].copy_from_slice(&bytes);
        };
        let usual =
            [(1, 3), (2, 4), (3, 5), (4, 2), (5, 1), (8, 3), (9, 4), (10, 5), (17, 2), (18, 1), (19, 3), (24, 16)];
        usual.iter().for_each(|(word, value)| put(*word, *value));
        for (word, value) in [(11, 6.0f32), (12, 8.0), (13, 7.5), (14, 90.0), (15, 100.0), (16, 90.0)] {
            put(word, value.to_bits() as i32);
        }
        head[208..214].copy_from_slice(if big { b"MAP \x11\x11" } else { b"MAP \x44\x44" });
        let of = |v: u8| if big { f32::from(v).to_be_bytes() } else { f32::from(v).to_le_bytes() };
        [head, vec![1; 16], values().flat_map(of).collect()].concat()
    };
    vec![map(false), map(true)]
}

/// DICOM of five frames: explicit and implicit types, run lengths.
pub fn dicom() -> Vec<Vec<u8>> {
    let element = |explicit: bool, tag: u32, kind: &str, value: &[u8]| {
        let mut value = value.to_vec();
        value.resize(value.len().next_multiple_of(2), b' ');
        let mut out = [(tag >> 16) as u16, tag as u16].iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
        match (explicit, kind) {
            (false, _) => out.extend((value.len() as u32).to_le_bytes()),
            (true, "OB") => {
                out.extend(b"OB\0\0");
                out.extend((value.len() as u32).to_le_bytes());
            }
            (true, _) => {
                out.extend(kind.bytes());
                out.extend((value.len() as u16).to_le_bytes());
            }
        }
        [out, value].concat()
    };
    let file = |explicit: bool, syntax: &str, pixels: Vec<u8>| {
        let mut out = [vec![0; 128], b"DICM".to_vec(), element(true, 0x0002_0010, "UI", syntax.as_bytes())].concat();
        let short = |tag: u32, value: u16| element(explicit, tag, "US", &value.to_le_bytes());
        out.extend(element(explicit, 0x0018_0088, "DS", b"1.5"));
        out.extend(element(explicit, 0x0020_0032, "DS", b"1\\2\\3"));
        out.extend(element(explicit, 0x0020_0037, "DS", b"1\\0\\0\\0\\1\\0"));
        out.extend([short(0x0028_0002, 1), element(explicit, 0x0028_0008, "IS", b"5")].concat());
        out.extend([short(0x0028_0010, 4), short(0x0028_0011, 3)].concat());
        out.extend(element(explicit, 0x0028_0030, "DS", b"2\\2"));
        out.extend([short(0x0028_0100, 8), short(0x0028_0101, 8), short(0x0028_0102, 7)].concat());
        out.extend(element(explicit, 0x0028_1053, "DS", b"0.5"));
        [out, pixels].concat()
    };
    let raw: Vec<u8> = values().collect();
    let mut runs = element(true, 0x7fe0_0010, "OB", &[]);
    let length = runs.len() - 4;
    runs[length..].fill(0xff);
    let item = |bytes: &[u8]| [b"\xfe\xff\x00\xe0", &(bytes.len() as u32).to_le_bytes()[..], bytes].concat();
    runs.extend(item(&[]));
    for frame in raw.chunks(12) {
        let mut head = vec![0u8; 64];
        (head[0], head[4]) = (1, 64);
        runs.extend(item(&[head, vec![11], frame.to_vec(), vec![128]].concat()));
    }
    runs.extend(b"\xfe\xff\xdd\xe0\0\0\0\0");
    vec![
        file(true, "1.2.840.10008.1.2.1", element(true, 0x7fe0_0010, "OB", &raw)),
        file(false, "1.2.840.10008.1.2", element(false, 0x7fe0_0010, "OB", &raw)),
        file(true, "1.2.840.10008.1.2.5", runs),
    ]
}

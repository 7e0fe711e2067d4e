//! PLY, text and binary, with colours and normals of its vertices or colours of its faces.

use super::MeshFile;
use crate::text::text_of;
use crate::{IoError, Limits, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Color, MeshColors};
use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Encoding, Header, Property, PropertyAccess, PropertyAccessResult};
use std::path::Path;

/// The properties of an element that are read.
#[derive(Debug, Clone, Default)]
struct Item {
    position: [Option<f64>; 3],
    normal: [f64; 3],
    color: [Option<u8>; 3],
    corners: Vec<i64>,
}

impl PropertyAccess for Item {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = |names: [&str; 3]| names.iter().position(|n| *n == name);
        if let Some(i) = axis(["x", "y", "z"]) {
            self.position[i] = number(&value);
        } else if let Some(i) = axis(["nx", "ny", "nz"]) {
            self.normal[i] = number(&value).unwrap_or(0.0);
        } else if let Some(i) = axis(["red", "green", "blue"]).or(axis(["r", "g", "b"])) {
            self.color[i] = share(&value);
        } else if matches!(name, "vertex_indices" | "vertex_index") {
            self.corners = list(value).unwrap_or_default();
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

/// The file with a header that the parser takes, if it has another: comments in Latin-1, lines that end in carriage returns alone, or a text
/// of two bytes.
fn mended(bytes: &[u8]) -> Option<Vec<u8>> {
    const END: &[u8] = b"end_header";
    if matches!(bytes, [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [b'p', 0, ..] | [0, b'p', ..]) {
        return Some(text_of(bytes, &mut Vec::new()).into_bytes());
    }
    let end = bytes.windows(END.len()).position(|w| w == END)? + END.len();
    let (header, rest) = bytes.split_at(end);
    let old_lines = header.contains(&b'\r') && !header.contains(&b'\n');
    if header.is_ascii() && !old_lines {
        return None;
    }
    let line = |b: &u8| match *b {
        b'\r' if old_lines => b'\n',
        b if b.is_ascii() => b,
        _ => b'?',
    };
    let is_text = header.windows(5).any(|w| w == b"ascii");
    // Of binary data only the end of the header's last line is one.
    let rest: Vec<u8> = match rest {
        _ if old_lines && is_text => rest.iter().map(line).collect(),
        [b'\r', data @ ..] if old_lines => [b"\n", data].concat(),
        rest => rest.to_vec(),
    };
    Some(header.iter().map(line).chain(rest).collect())
}

fn number(value: &Property) -> Option<f64> {
    Some(match *value {
        Property::Char(v) => v.into(),
        Property::UChar(v) => v.into(),
        Property::Short(v) => v.into(),
        Property::UShort(v) => v.into(),
        Property::Int(v) => v.into(),
        Property::UInt(v) => v.into(),
        Property::Float(v) => v.into(),
        Property::Double(v) => v,
        _ => return None,
    })
}

/// A part of a colour: bytes as they are, floating point as a share of 1.
fn share(value: &Property) -> Option<u8> {
    match *value {
        Property::UChar(v) => Some(v),
        Property::Float(_) | Property::Double(_) => number(value).map(|v| (255.0 * v.clamp(0.0, 1.0)).round() as u8),
        _ => number(value).map(|v| v.clamp(0.0, 255.0) as u8),
    }
}

fn list(value: Property) -> Option<Vec<i64>> {
    Some(match value {
        Property::ListChar(v) => v.into_iter().map(Into::into).collect(),
        Property::ListUChar(v) => v.into_iter().map(Into::into).collect(),
        Property::ListShort(v) => v.into_iter().map(Into::into).collect(),
        Property::ListUShort(v) => v.into_iter().map(Into::into).collect(),
        Property::ListInt(v) => v.into_iter().map(Into::into).collect(),
        Property::ListUInt(v) => v.into_iter().map(Into::into).collect(),
        _ => return None,
    })
}

/// The message of the parser without its inner workings; it gives texts alone, which its kinds of errors do not tell.
fn words(said: &str) -> String {
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = said.split(" Error: ").next().unwrap_or_default().trim_end_matches('.');
    let (place, line) = said.split_once(" String: ").unwrap_or((said, ""));
    let number = place.strip_prefix("Line ").and_then(|rest| rest.split(':').next());
    match number {
        Some(number) if !line.is_empty() => {
            let line: String = line.trim_matches(['\'', ' ']).chars().take(60).collect();
            format!("line {number} cannot be read ({line})")
        }
        _ if said.contains("UTF-8") => "its header is no text".into(),
        _ if said.contains("end of file") => "it ends too early".into(),
        _ => said.chars().take(120).collect(),
    }
}

pub(super) fn read(path: &Path, bytes: &[u8], _: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let bad = |reason: String| IoError::format(path, reason);
    let damaged = |e: &dyn std::fmt::Display| bad(format!("{}; it is damaged or no PLY file", words(&e.to_string())));
    let parser = Parser::<Item>::new();
    let mended = mended(bytes);
    let bytes = mended.as_deref().unwrap_or(bytes);
    let mut reader = Reader::new(bytes);
    let mut header = parser.read_header(&mut reader).map_err(|e| damaged(&e))?;
    let cut = cut_short(&mut header, bytes);
    let mut out = MeshFile { format: "PLY", ..MeshFile::default() };
    let (mut normals, mut per_vertex, mut per_triangle) = (Vec::new(), Vec::new(), Vec::new());
    for element in header.elements.values() {
        // An element takes at least one byte: a greater count is invalid.
        if element.count > bytes.len() {
            return Err(bad(format!(
                "it declares {} x {:?} in {} bytes; it is damaged",
                element.count,
                element.name,
                bytes.len()
            )));
        }
        let items = parser.read_payload_for_element(&mut reader, element, &header).map_err(|e| damaged(&e))?;
        match element.name.as_str() {
            "vertex" => {
                for item in &items {
                    let [Some(x), Some(y), Some(z)] = item.position else {
                        return Err(bad("its vertices lack x, y or z; it is no mesh".into()));
                    };
                    out.positions.push(DVec3::new(x, y, z));
                    normals.push(DVec3::from_array(item.normal).normalize_or_zero());
                    per_vertex.push(colored(item));
                }
            }
            "face" => {
                for item in &items {
                    let Some((&first, rest)) = item.corners.split_first() else { continue };
                    for pair in rest.windows(2) {
                        out.triangles.push(triangle([first, pair[0], pair[1]]).map_err(bad)?);
                        per_triangle.push(colored(item));
                    }
                }
            }
            "tristrips" => out.triangles.extend(of_strips(&items).map_err(bad)?),
            _ => {}
        }
    }
    let beyond = out.triangles.iter().flatten().find(|v| **v as usize >= out.positions.len());
    if let Some(v) = beyond {
        return Err(bad(format!("a face names vertex {v} of {}; it is damaged", out.positions.len())));
    }
    out.normals = normals.iter().any(|n| *n != DVec3::ZERO).then_some(normals);
    let all = |colors: Vec<Option<Color>>| colors.into_iter().collect::<Option<Vec<Color>>>().filter(|c| !c.is_empty());
    out.colors = match (all(per_vertex), all(per_triangle)) {
        (Some(colors), _) => MeshColors::PerVertex(colors),
        (None, Some(colors)) => MeshColors::PerTriangle(colors),
        _ => MeshColors::Layer,
    };
    Ok(Loaded::new(out, cut.into_iter().map(|w| w.in_file(path)).collect()))
}

/// Triangles of strips as scanners write them, parted by -1.
fn of_strips(items: &[Item]) -> Result<Vec<[u32; 3]>, String> {
    let mut out = Vec::new();
    for strip in items.iter().flat_map(|item| item.corners.split(|v| *v == -1)) {
        for (k, t) in strip.windows(3).enumerate() {
            let corners = if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            if t[0] != t[1] && t[1] != t[2] && t[0] != t[2] {
                out.push(triangle(corners)?);
            }
        }
    }
    Ok(out)
}

/// Whether a line is a list of fewer numbers than it says.
fn is_short_list(line: &[u8]) -> bool {
    let line = String::from_utf8_lossy(line);
    let mut words = line.split_whitespace();
    let count = words.next().and_then(|word| word.parse::<usize>().ok());
    count.is_some_and(|count| (3..=64).contains(&count) && words.count() < count)
}

/// Lowers the counts of a text that ends too early to what is whole, and says so. Vertices are needed whole.
fn cut_short(header: &mut Header, bytes: &[u8]) -> Option<Warning> {
    const END: &[u8] = b"end_header";
    if header.encoding != Encoding::Ascii {
        return None;
    }
    let body = &bytes[bytes.windows(END.len()).position(|w| w == END)? + END.len()..];
    let mut lines = body.split(|b| *b == b'\n').filter(|line| !line.trim_ascii().is_empty()).count();
    let declared: usize = header.elements.values().map(|element| element.count).fold(0, usize::saturating_add);
    let last = body.rsplit(|b| *b == b'\n').next().unwrap_or_default();
    if lines > declared || (lines == declared && !is_short_list(last)) {
        return None;
    }
    // Without its end the last line may be cut.
    lines -= usize::from(!last.is_empty() && lines > 0);
    let mut said = None;
    for element in header.elements.values_mut() {
        let held = element.count.min(lines);
        lines -= held;
        if held < element.count && element.name == "vertex" {
            return None;
        }
        if held < element.count && said.is_none() {
            let (count, name) = (element.count, &element.name);
            let text = format!("it declares {count} x {name:?} and holds {held}; it is cut off, what is whole is read");
            said = Some(
                Warning::new(WarningKind::Repaired, text).with("declared", count as f64).with("held", held as f64),
            );
        }
        element.count = held;
    }
    said
}

fn colored(item: &Item) -> Option<Color> {
    let [Some(r), Some(g), Some(b)] = item.color else { return None };
    Some(Color::rgb(r, g, b))
}

fn triangle(corners: [i64; 3]) -> Result<[u32; 3], String> {
    let mut out = [0; 3];
    for (out, v) in out.iter_mut().zip(corners) {
        *out = u32::try_from(v).map_err(|_| format!("a face names vertex {v}; it is damaged"))?;
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(normals: &str, rows: [&str; 3]) -> MeshFile {
        let head = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{normals}element face 1\n\
             property list uchar int vertex_indices\nend_header\n"
        );
        let text = head + &rows.join("\n") + "\n3 0 1 2\n";
        read(Path::new("t.ply"), text.as_bytes(), &Limits::default()).expect("a mesh").value
    }

    #[test]
    fn strips_of_triangles_turn_with_every_corner_and_are_parted_by_minus_one() {
        let head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
            element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
        let text = format!("{head}0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n10 0 1 2 3 4 -1 0 2 2 4\n");
        let mesh = read(Path::new("t.ply"), text.as_bytes(), &Limits::default()).expect("a mesh").value;
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]], "strips that fold back have no area");
        let up = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            (b - a).cross(c - a).z
        };
        assert!(mesh.triangles.iter().all(|t| up(t) < 0.0), "all face one side");
    }

    #[test]
    fn normals_are_kept_where_there_are_any() {
        let keys = "property float nx\nproperty float ny\nproperty float nz\n";
        let with = load(keys, ["0 0 0 0 0 1", "1 0 0 0 0 1", "0 1 0 1 0 0"]);
        assert_eq!(with.normals, Some(vec![DVec3::Z, DVec3::Z, DVec3::X]));
        assert_eq!(load("", ["0 0 0", "1 0 0", "0 1 0"]).normals, None);
        assert_eq!(load(keys, ["0 0 0 0 0 0", "1 0 0 0 0 0", "0 1 0 0 0 0"]).normals, None, "all zero says nothing");
    }
}

//! Text of OBJ and MTL files as their reader takes it: one statement per line, in UTF-8, without forms that it rejects.

use crate::text::text_of;

/// Statements of an OBJ file: lines that end in a backslash are joined with the next, comments behind numbers are cut off.
pub(super) fn statements(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len());
    let text = decoded(bytes);
    let lines = text.split('\n').flat_map(|line| line.trim_end_matches('\r').split('\r'));
    for line in lines {
        let open = line.trim_end().strip_suffix('\\');
        let part = open.unwrap_or(line);
        let numbers = ["v ", "vn ", "vt ", "f ", "v\t", "f\t"].iter().any(|k| part.trim_start().starts_with(k));
        match part.trim_start().split_once(char::is_whitespace).unwrap_or((part.trim(), "")) {
            // The reader rejects a material without a name, and wants a blank before it.
            ("usemtl" | "mtllib", name) if name.trim().is_empty() => {}
            (key @ ("usemtl" | "mtllib"), name) => out.extend([key, " ", name]),
            _ => out.push_str(if numbers { part.split('#').next().unwrap_or(part) } else { part }),
        }
        out.push(if open.is_some() { ' ' } else { '\n' });
    }
    out
}

/// Statements of an MTL file; a colour of one value is a grey of it (MTL specification, Kd r g b: "if only r is specified, then g and b
/// are assumed to be equal to r"). Statements without their numbers are left out and reported.
pub(super) fn materials(bytes: &[u8], left_out: &mut Vec<String>) -> String {
    let text = statements(bytes);
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let key = words.next().unwrap_or("");
        let wanted = match key {
            "Ka" | "Kd" | "Ks" => 3,
            "Ns" | "Ni" | "d" | "illum" => 1,
            _ => 0,
        };
        if wanted == 0 {
            out.push_str(line);
            out.push('\n');
            continue;
        }
        let words: Vec<&str> = words.collect();
        let numbers: Vec<&str> =
            words.iter().copied().take_while(|w| w.parse::<f64>().is_ok_and(f64::is_finite)).take(wanted).collect();
        let whole = key != "illum" || numbers.iter().all(|n| n.parse::<u8>().is_ok());
        match numbers.as_slice() {
            [grey] if wanted == 3 => out.push_str(&format!("{key} {grey} {grey} {grey}\n")),
            [r, g, ..] if wanted == 3 => {
                let b = numbers.get(2).unwrap_or(g);
                out.push_str(&format!("{key} {r} {g} {b}\n"));
            }
            [one] if whole => out.push_str(&format!("{key} {one}\n")),
            _ => left_out.push(line.trim().chars().take(40).collect()),
        }
    }
    out
}

/// The files of materials that statements name, in quotes.
pub(super) fn material_files(statements: &str) -> String {
    let names = statements.lines().filter_map(|line| line.trim_start().strip_prefix("mtllib "));
    names.map(|name| format!("{:?}", name.trim().chars().take(80).collect::<String>())).collect::<Vec<_>>().join(", ")
}

/// What is wrong with statements that the reader rejects, with the first line at fault where it can be told.
pub(super) fn fault(error: &tobj::LoadError, statements: &str) -> String {
    use tobj::LoadError as E;
    let (key, what) = match error {
        E::PositionParseError => ("v", "a vertex is not three numbers"),
        E::NormalParseError => ("vn", "a normal is not three numbers"),
        E::TexcoordParseError => ("vt", "a place in a picture is not two numbers"),
        E::FaceParseError => ("f", "a face is not a list of numbers"),
        E::FaceVertexOutOfBounds => return "a face names a vertex that there is not".into(),
        E::FaceTexCoordOutOfBounds => return "a face names a place in a picture that there is not".into(),
        E::FaceNormalOutOfBounds => return "a face names a normal that there is not".into(),
        other => return other.to_string(),
    };
    let least = if key == "vt" { 2 } else { 3 };
    let is_bad = |line: &&str| {
        let mut words = line.split_whitespace();
        words.next() == Some(key) && {
            let words: Vec<&str> = words.collect();
            let number = |w: &&str| w.split('/').all(|part| part.is_empty() || part.parse::<f64>().is_ok());
            words.len() < least || !words.iter().all(number)
        }
    };
    match statements.lines().find(is_bad) {
        Some(line) => format!("{what} ({})", line.trim().chars().take(60).collect::<String>()),
        None => what.into(),
    }
}

/// Statements without the colours of vertices.
pub(super) fn without_colors(statements: &str) -> String {
    let position = |line: &str| {
        let mut words = line.split_whitespace();
        (words.next() == Some("v")).then(|| words.take(3).fold("v".to_owned(), |out, word| out + " " + word))
    };
    let lines = statements.lines().map(|line| position(line).unwrap_or_else(|| line.to_owned()) + "\n");
    lines.collect()
}

fn decoded(bytes: &[u8]) -> String {
    let text = text_of(bytes, &mut Vec::new());
    text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_need_a_name_and_a_blank() {
        let text = statements(b"mtllib\twall.mtl\nusemtl\nusemtl \nusemtl\tred\nf 1 2 3\nmtllib\n");
        assert_eq!(text.split_whitespace().collect::<Vec<_>>().join(" "), "mtllib wall.mtl usemtl red f 1 2 3");
        assert_eq!(material_files(&text), "\"wall.mtl\"");
    }

    #[test]
    fn lines_are_joined_and_comments_cut_off() {
        let text = statements(b"v 0 0 0 # first\r\nf 1 2 \\\r\n 3\n# f 9 9 9\rusemtl a#b\\\nc");
        assert_eq!(text, "v 0 0 0 \nf 1 2   3\n# f 9 9 9\nusemtl a#b c\n");
        assert_eq!(statements(b"o T\xfcr\n"), "o Tür\n\n");
    }

    #[test]
    fn colours_of_one_value_are_grey_and_odd_ones_are_left_out() {
        let mut odd = Vec::new();
        let text = materials(
            b"newmtl m\nKd 0.8\nKs 1 0 0 9\nKa spectral x.rfl\nd -halo 0.5\nillum 2\nNs nan\nmap_Kd a b.png\n",
            &mut odd,
        );
        assert_eq!(text.trim_end(), "newmtl m\nKd 0.8 0.8 0.8\nKs 1 0 0\nillum 2\nmap_Kd a b.png");
        assert_eq!(odd, ["Ka spectral x.rfl", "d -halo 0.5", "Ns nan"]);
    }
}

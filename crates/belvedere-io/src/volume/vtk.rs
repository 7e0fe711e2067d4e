//! Legacy VTK files of structured points (.vtk). Source: "VTK File Formats", Kitware, section on simple legacy formats.

use super::{ByteOrder, Number, Source, VolumeFile, odd_values};
use crate::{Fault, Loaded};
use glam::{DMat3, DVec3};

/// Most arrays.
const MAX_ARRAYS: usize = 4096;

/// An array of the file.
struct Array<'b> {
    name: String,
    /// `None`: of a type that is not read.
    number: Option<Number>,
    components: usize,
    of_cells: bool,
    data: &'b [u8],
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, Fault> {
    let mut text = Cursor { bytes: source.bytes, at: 0 };
    if !text.line().starts_with("# vtk DataFile") {
        return Err("it does not begin with \"# vtk DataFile\"; it is no legacy VTK file".into());
    }
    text.line();
    let binary = match text.word()?.to_ascii_uppercase().as_str() {
        "BINARY" => true,
        "ASCII" => false,
        other => {
            return Err(format!("its third line is {other:.20?}, it must be ASCII or BINARY; it is damaged").into());
        }
    };
    let mut file = Parts { binary, ..Parts::default() };
    file.read(&mut text)?;
    let points = file.dims.ok_or("it has no DIMENSIONS; it is damaged, or cut off")?;
    let array = file.choose(source.request.array.as_deref())?;
    let number = array.number.ok_or_else(|| {
        format!("array \"{}\" is of a type that is not read; convert it to a number type", array.name)
    })?;
    let dims = if array.of_cells { points.map(|n| n.saturating_sub(1)) } else { points };
    let expected = source.expected(dims, number, array.data.len(), !binary)?;
    let count = expected / number.bytes();
    let (values, changed) = if binary {
        // Always the most significant byte first.
        number.decode(array.data[..expected].to_vec(), ByteOrder::Big)
    } else {
        if count > array.data.len() {
            return Err(format!(
                "it declares {count} values and has {} bytes of text; it is cut off",
                array.data.len()
            )
            .into());
        }
        let text = std::str::from_utf8(array.data)
            .map_err(|e| format!("byte {} of its text is no text; it is damaged", e.valid_up_to()))?;
        number.parse(text, count)?
    };
    let spacing = file.spacing.unwrap_or(DVec3::ONE);
    let shift = if array.of_cells { 0.5 * spacing } else { DVec3::ZERO };
    let (axes, origin) = (DMat3::from_diagonal(spacing), file.origin.unwrap_or(DVec3::ZERO) + shift);
    let name = Some(array.name.clone());
    let file = VolumeFile { format: "legacy VTK", array: name, stored: number, dims, axes, origin, values };
    Ok(Loaded::new(file, odd_values(source.path, &changed)))
}

/// Content of a file.
#[derive(Default)]
struct Parts<'b> {
    binary: bool,
    dims: Option<[usize; 3]>,
    origin: Option<DVec3>,
    spacing: Option<DVec3>,
    arrays: Vec<Array<'b>>,
    /// Whether the values that follow belong to cells, and how many they are; `None` before both.
    group: Option<(bool, usize)>,
}

impl<'b> Parts<'b> {
    fn read(&mut self, text: &mut Cursor<'b>) -> Result<(), String> {
        let mut dataset = false;
        while let Some(word) = text.next_word() {
            match word.to_ascii_uppercase().as_str() {
                "DATASET" => {
                    let kind = text.word()?;
                    if !kind.eq_ignore_ascii_case("STRUCTURED_POINTS") {
                        return Err(format!(
                            "its dataset is {kind:.40}, only STRUCTURED_POINTS are volumes; write it so, or as .vti, for example from ParaView (meshes as PLY)"
                        ));
                    }
                    dataset = true;
                }
                "DIMENSIONS" => self.dims = Some(text.numbers("DIMENSIONS")?),
                "ORIGIN" => self.origin = Some(text.vector("ORIGIN")?),
                "SPACING" | "ASPECT_RATIO" => self.spacing = Some(text.vector("SPACING")?),
                "POINT_DATA" => self.group = Some((false, text.count("POINT_DATA")?)),
                "CELL_DATA" => self.group = Some((true, text.count("CELL_DATA")?)),
                "METADATA" => text.pass_paragraph(),
                "FIELD" => {
                    text.word()?;
                    for _ in 0..text.count("FIELD")? {
                        self.field(text)?;
                    }
                }
                other => self.attribute(other, text)?,
            }
        }
        if dataset { Ok(()) } else { Err("it has no DATASET; it is damaged, or cut off".into()) }
    }

    /// `name components tuples type`, and the values.
    fn field(&mut self, text: &mut Cursor<'b>) -> Result<(), String> {
        let mut name = text.word()?;
        if name.eq_ignore_ascii_case("METADATA") {
            text.pass_paragraph();
            name = text.word()?;
        }
        let (components, tuples) = (text.count(name)?, text.count(name)?);
        let kind = text.word()?;
        text.line();
        self.array(text, name, kind, components, tuples)
    }

    /// An attribute: `KIND name type`, and the values.
    fn attribute(&mut self, kind: &str, text: &mut Cursor<'b>) -> Result<(), String> {
        let tuples = self.group.map(|(_, tuples)| tuples);
        let tuples = tuples
            .ok_or_else(|| format!("the word {kind:.30?} near byte {} is not known here; it is damaged", text.at));
        match kind {
            "SCALARS" => {
                let (name, type_name) = (text.word()?, text.word()?);
                let rest = text.line();
                let components = rest.trim().parse().unwrap_or(1);
                // A line that names a table of colours may follow.
                let mark = text.at;
                match text.next_word() {
                    Some(word) if word.eq_ignore_ascii_case("LOOKUP_TABLE") => drop(text.line()),
                    _ => text.at = mark,
                }
                self.array(text, name, type_name, components, tuples?)
            }
            "VECTORS" | "NORMALS" | "TENSORS" | "TENSORS6" | "GLOBAL_IDS" | "PEDIGREE_IDS" => {
                let (name, type_name) = (text.word()?, text.word()?);
                text.line();
                let components = match kind {
                    "VECTORS" | "NORMALS" => 3,
                    "TENSORS" => 9,
                    "TENSORS6" => 6,
                    _ => 1,
                };
                self.array(text, name, type_name, components, tuples?)
            }
            "TEXTURE_COORDINATES" => {
                let name = text.word()?;
                let components = text.count(name)?;
                let type_name = text.word()?;
                text.line();
                self.array(text, name, type_name, components, tuples?)
            }
            "COLOR_SCALARS" | "LOOKUP_TABLE" => {
                let name = text.word()?;
                let count = text.count(name)?;
                text.line();
                let (components, tuples) = if kind == "LOOKUP_TABLE" { (4, count) } else { (count, tuples?) };
                let type_name = if self.binary { "unsigned_char" } else { "float" };
                let before = self.arrays.len();
                self.array(text, name, type_name, components, tuples)?;
                // Colours are no values.
                self.arrays.truncate(before);
                Ok(())
            }
            other => Err(format!("the word {other:.30?} near byte {} is not known; it is damaged", text.at)),
        }
    }

    fn array(
        &mut self,
        text: &mut Cursor<'b>,
        name: &str,
        type_name: &str,
        components: usize,
        tuples: usize,
    ) -> Result<(), String> {
        if self.arrays.len() >= MAX_ARRAYS {
            return Err(format!("it has more than {MAX_ARRAYS} arrays; it is damaged"));
        }
        let type_name = type_name.to_ascii_lowercase();
        let number = match type_name.as_str() {
            "char" => Some(Number::Int8),
            "vtkidtype" => Some(Number::Int32),
            "long" | "vtktypeint64" => Some(Number::Int64),
            "unsigned_long" | "vtktypeuint64" => Some(Number::UInt64),
            other => Number::named(&other.replace('_', " ")),
        };
        let cut =
            || format!("array {name:.40?} has {components} x {tuples} values, which end after the file; it is cut off");
        let count = components.checked_mul(tuples).ok_or_else(cut)?;
        let data = match (self.binary, number, type_name.as_str()) {
            (false, _, "string") | (true, None, _) if type_name != "bit" => {
                return Err(format!(
                    "array {name:.40?} is of type {type_name:.30?}, which cannot be passed over; leave it out"
                ));
            }
            (false, ..) => text.words(count).ok_or_else(cut)?,
            (true, Some(number), _) => {
                let bytes = count.checked_mul(number.bytes()).ok_or_else(cut)?;
                text.bytes(bytes).ok_or_else(cut)?
            }
            (true, None, _) => text.bytes(count.div_ceil(8)).ok_or_else(cut)?,
        };
        let Some((of_cells, _)) = self.group else { return Ok(()) };
        self.arrays.push(Array { name: decoded(name), number, components, of_cells, data });
        Ok(())
    }

    /// The array asked for, else the first of single values, points before cells.
    fn choose(&self, wanted: Option<&str>) -> Result<&Array<'b>, String> {
        let names = || self.arrays.iter().map(|a| format!("\"{}\"", a.name)).take(20).collect::<Vec<_>>().join(", ");
        let first = |cells: bool| self.arrays.iter().find(|a| a.components == 1 && a.of_cells == cells);
        let found = match wanted {
            Some(name) => self.arrays.iter().find(|a| a.name == name),
            None => first(false).or_else(|| first(true)),
        };
        let found = found.ok_or_else(|| match wanted {
            Some(name) => format!("it has no array \"{name:.60}\"; it has {}", names()),
            None if self.arrays.is_empty() => "it has no values; it is cut off".to_owned(),
            None => format!("it has no array of single values; it has {}", names()),
        })?;
        if found.components != 1 {
            let (name, n) = (&found.name, found.components);
            return Err(format!("array \"{name}\" has {n} components, single values are needed; choose another array"));
        }
        Ok(found)
    }
}

/// A name whose spaces and other bytes are written as `%20`.
fn decoded(name: &str) -> String {
    let mut out = Vec::new();
    let mut rest = name.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let hex = after.get(..2).filter(|_| first == b'%').and_then(|h| std::str::from_utf8(h).ok());
        match hex.and_then(|h| u8::from_str_radix(h, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                rest = &after[2..];
            }
            None => {
                out.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Words, lines and blocks of a file.
struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Cursor<'b> {
    fn rest(&self) -> &'b [u8] {
        &self.bytes[self.at..]
    }

    /// The rest of the line, without its end.
    fn line(&mut self) -> String {
        let rest = self.rest();
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        String::from_utf8_lossy(&rest[..end.min(256)]).into_owned()
    }

    /// Goes past the rest of the line and the lines after it, up to an empty one.
    fn pass_paragraph(&mut self) {
        self.line();
        while !self.line().trim().is_empty() {}
    }

    /// The next word; `None` at the end, and for one that is no text.
    fn next_word(&mut self) -> Option<&'b str> {
        let rest = self.rest();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.at += start + length;
        // Bytes that are no text are no word that is known.
        Some(std::str::from_utf8(&rest[start..start + length.min(1024)]).unwrap_or("\u{fffd}"))
    }

    fn word(&mut self) -> Result<&'b str, String> {
        self.next_word().ok_or_else(|| "it ends within its header; it is cut off".to_owned())
    }

    fn count(&mut self, what: &str) -> Result<usize, String> {
        let word = self.word()?;
        word.parse()
            .map_err(|_| format!("{what:.40} is followed by {word:.20?}, a whole number is needed; it is damaged"))
    }

    fn numbers(&mut self, what: &str) -> Result<[usize; 3], String> {
        Ok([self.count(what)?, self.count(what)?, self.count(what)?])
    }

    fn vector(&mut self, what: &str) -> Result<DVec3, String> {
        let mut of = || {
            let word = self.word()?;
            let number = word.parse().ok().filter(|v: &f64| v.is_finite());
            number.ok_or_else(|| format!("{what} is followed by {word:.20?}, a finite number is needed; it is damaged"))
        };
        Ok(DVec3::new(of()?, of()?, of()?))
    }

    /// The next `n` bytes.
    fn bytes(&mut self, n: usize) -> Option<&'b [u8]> {
        let found = self.rest().get(..n)?;
        self.at += n;
        Some(found)
    }

    /// The bytes of the next `n` words.
    fn words(&mut self, n: usize) -> Option<&'b [u8]> {
        let start = self.at;
        for _ in 0..n {
            self.next_word()?;
        }
        Some(&self.bytes[start..self.at])
    }
}

//! The XML part of VTK ImageData: lattice, arrays, and where their data are.

use super::{ByteOrder, Number};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// Deepest nesting, and most arrays.
const MAX_DEPTH: usize = 64;
const MAX_ARRAYS: usize = 4096;

/// How the bytes of an array are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Numbers as text.
    Ascii,
    /// Base64 between the tags.
    Inline,
    /// At an offset into the data after the XML.
    Appended(u64),
}

/// An array.
#[derive(Debug, Clone)]
pub(super) struct Array {
    pub(super) name: String,
    pub(super) number: Option<Number>,
    pub(super) type_name: String,
    pub(super) components: usize,
    pub(super) encoding: Encoding,
    pub(super) text: String,
    /// Whether values belong to cells rather than to points.
    pub(super) of_cells: bool,
}

/// Content of the XML.
#[derive(Debug, Default)]
pub(super) struct Header {
    pub(super) order: ByteOrder,
    /// Whether lengths take 8 bytes rather than 4.
    pub(super) wide: bool,
    pub(super) compressor: Option<String>,
    pub(super) extent: Option<[i64; 6]>,
    pub(super) spacing: Option<[f64; 3]>,
    pub(super) origin: Option<[f64; 3]>,
    pub(super) direction: Option<[f64; 9]>,
    pub(super) pieces: usize,
    pub(super) piece: Option<[i64; 6]>,
    pub(super) arrays: Vec<Array>,
    pub(super) wanted: Option<String>,
    open: Vec<String>,
    root: bool,
}

impl Header {
    /// Reads the XML, without the appended data.
    pub(super) fn parse(xml: &str) -> Result<Self, String> {
        let mut header = Self::default();
        let mut reader = Reader::from_str(xml);
        loop {
            let at = reader.buffer_position();
            let damaged =
                |e: &dyn std::fmt::Display| format!("is no well-formed XML near byte {at} ({e}); it is damaged");
            match reader.read_event().map_err(|e| damaged(&e))? {
                Event::Start(e) => {
                    header.start(&e)?;
                    header.open.push(e.local_name().as_ref().to_owned());
                    if header.open.len() > MAX_DEPTH {
                        return Err(format!("nests elements deeper than {MAX_DEPTH} near byte {at}; it is damaged"));
                    }
                }
                Event::Empty(e) => header.start(&e)?,
                Event::End(_) => {
                    header.open.pop();
                }
                Event::Text(t) if header.open.last().is_some_and(|o| o == "DataArray") => {
                    if let Some(array) = header.arrays.last_mut() {
                        array.text.push_str(&t.xml10_content());
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        if !header.root {
            return Err("it is no VTK XML file of type ImageData; choose a .vti file of an image".into());
        }
        Ok(header)
    }

    fn start(&mut self, e: &BytesStart<'_>) -> Result<(), String> {
        let attribute = |key: &str| -> Option<String> {
            let found = e.attributes().flatten().find(|a| a.key.local_name().as_ref() == key)?;
            Some(found.value.trim().to_owned())
        };
        let numbers = |key: &str| -> Result<Option<Vec<f64>>, String> {
            let Some(text) = attribute(key) else { return Ok(None) };
            let list: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
            let shown: String = text.chars().take(60).collect();
            list.map(Some).map_err(|_| format!("its {key} {shown:?} is no list of numbers; it is damaged"))
        };
        match e.local_name().as_ref() {
            "VTKFile" => {
                self.root = attribute("type").as_deref() == Some("ImageData");
                self.order = match attribute("byte_order").as_deref() {
                    Some("BigEndian") => ByteOrder::Big,
                    _ => ByteOrder::Little,
                };
                self.wide = attribute("header_type").as_deref() == Some("UInt64");
                self.compressor = attribute("compressor").filter(|c| !c.is_empty());
            }
            "ImageData" => {
                self.extent = attribute("WholeExtent").as_deref().map(extent).transpose()?;
                self.spacing = fixed("Spacing", numbers("Spacing")?)?;
                self.origin = fixed("Origin", numbers("Origin")?)?;
                self.direction = fixed("Direction", numbers("Direction")?)?;
            }
            "Piece" => {
                self.pieces += 1;
                self.piece = attribute("Extent").as_deref().map(extent).transpose()?;
            }
            "PointData" if self.pieces <= 1 => self.wanted = attribute("Scalars").filter(|s| !s.is_empty()),
            "DataArray" if self.pieces == 1 => self.array(&attribute)?,
            _ => {}
        }
        Ok(())
    }

    fn array(&mut self, attribute: &dyn Fn(&str) -> Option<String>) -> Result<(), String> {
        let of_cells = match self.open.last().map(String::as_str) {
            Some("PointData") => false,
            Some("CellData") => true,
            _ => return Ok(()),
        };
        if self.arrays.len() >= MAX_ARRAYS {
            return Err(format!("it has more than {MAX_ARRAYS} arrays; it is damaged"));
        }
        let name = attribute("Name").unwrap_or_default();
        let type_name = attribute("type").unwrap_or_default();
        let components = attribute("NumberOfComponents").map_or(Ok(1), |t| t.parse());
        let components =
            components.map_err(|_| format!("array {name:?} has no number of components; it is damaged"))?;
        let encoding = match attribute("format").as_deref() {
            Some("ascii") => Encoding::Ascii,
            Some("appended") => {
                let offset = attribute("offset").and_then(|o| o.parse().ok());
                Encoding::Appended(offset.ok_or_else(|| format!("array {name:?} has no offset; it is damaged"))?)
            }
            _ => Encoding::Inline,
        };
        let number = Number::named(&type_name);
        self.arrays.push(Array { name, number, type_name, components, encoding, text: String::new(), of_cells });
        Ok(())
    }

    /// The array asked for, else the one marked as scalars, else the first of single values; points before cells.
    pub(super) fn choose(&self, wanted: Option<&str>) -> Result<&Array, String> {
        let names = || self.arrays.iter().map(|a| format!("\"{}\"", a.name)).collect::<Vec<_>>().join(", ");
        let single = |a: &&Array| a.components == 1;
        let by_name = |name: &str| self.arrays.iter().find(|a| a.name == name);
        let found = match wanted {
            Some(name) => by_name(name).ok_or_else(|| format!("it has no array \"{name}\"; it has {}", names()))?,
            None => {
                let marked = self.wanted.as_deref().and_then(by_name).filter(single);
                let first = |cells: bool| self.arrays.iter().find(|a| a.components == 1 && a.of_cells == cells);
                marked
                    .or_else(|| first(false))
                    .or_else(|| first(true))
                    .ok_or_else(|| format!("it has no array of single values; it has {}", names()))?
            }
        };
        if found.components != 1 {
            let (name, n) = (&found.name, found.components);
            return Err(format!("array \"{name}\" has {n} components, single values are needed; choose another array"));
        }
        Ok(found)
    }
}

fn extent(text: &str) -> Result<[i64; 6], String> {
    let list: Result<Vec<i64>, _> = text.split_whitespace().map(str::parse).collect();
    let shown: String = text.chars().take(60).collect();
    let list = list.ok().and_then(|l| <[i64; 6]>::try_from(l).ok());
    list.filter(|e| (0..3).all(|a| e[2 * a + 1].checked_sub(e[2 * a]).is_some_and(|n| (0..1 << 40).contains(&n))))
        .ok_or_else(|| format!("its extent {shown:?} is not six whole numbers in order; it is damaged"))
}

fn fixed<const N: usize>(key: &str, list: Option<Vec<f64>>) -> Result<Option<[f64; N]>, String> {
    let Some(list) = list else { return Ok(None) };
    let found = list.len();
    <[f64; N]>::try_from(list).map(Some).map_err(|_| format!("its {key} has {found} numbers, {N} are needed"))
}

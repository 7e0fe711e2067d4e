//! XML documents of features, read element by element; of a damaged one what is whole before the damage.

use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};

/// Deepest nesting accepted.
const MAX_DEPTH: usize = 200;

/// What is done with elements.
pub(super) trait Elements {
    /// An element begins.
    ///
    /// * `open`: local names of the elements around it.
    /// * `name`: its local name.
    fn start(&mut self, open: &[String], name: &str, element: &BytesStart<'_>);

    /// An element ends.
    ///
    /// * `text`: its own text since the last element inside it.
    fn end(&mut self, open: &[String], name: &str, text: &str);

    /// The document is broken off. Takes from the open elements, the innermost last, those that are of no use unless they are whole, and from the
    /// text what may be; those that are left then end.
    fn broken(&mut self, open: &mut Vec<String>, text: &mut String);
}

/// Hands all elements over; where and why the document cannot be read further, if it cannot.
///
/// * `format`, `root`: name of the format and local name of its root, in any case of its letters.
///
/// # Errors
/// A predicate for text that is not of the format.
pub(super) fn read(
    text: &str,
    format: &str,
    root: &str,
    elements: &mut impl Elements,
) -> Result<Option<String>, String> {
    let (mut open, mut inner) = (Vec::new(), String::new());
    let damage = walk(text, format, root, elements, &mut open, &mut inner)?;
    if damage.is_some() {
        elements.broken(&mut open, &mut inner);
        while let Some(name) = open.pop() {
            elements.end(&open, &name, &inner);
            inner.clear();
        }
    }
    Ok(damage)
}

fn walk(
    text: &str,
    format: &str,
    root: &str,
    elements: &mut impl Elements,
    open: &mut Vec<String>,
    inner: &mut String,
) -> Result<Option<String>, String> {
    let mut reader = Reader::from_str(text);
    // Names of places are written with a bare &.
    reader.config_mut().allow_dangling_amp = true;
    let mut root_seen = false;
    loop {
        let at = reader.buffer_position();
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(e) => return Ok(Some(format!("is no well-formed XML near byte {at} ({e}); it is damaged"))),
        };
        match &event {
            Event::Start(e) | Event::Empty(e) => {
                let name = e.local_name().as_ref().to_owned();
                if !root_seen && !name.eq_ignore_ascii_case(root) {
                    return Err(format!(
                        "is XML with the root <{name}>, not a {format}; convert it to GPX, KML or GeoJSON"
                    ));
                }
                root_seen = true;
                inner.clear();
                elements.start(open, &name, e);
                if matches!(event, Event::Empty(_)) {
                    elements.end(open, &name, "");
                } else {
                    open.push(name);
                }
                if open.len() > MAX_DEPTH {
                    return Err(format!("nests elements deeper than {MAX_DEPTH} near byte {at}; it is no {format}"));
                }
            }
            Event::End(_) => {
                if let Some(name) = open.pop() {
                    elements.end(open, &name, inner);
                }
                inner.clear();
            }
            Event::Text(t) => inner.push_str(&t.xml10_content()),
            Event::CData(t) => inner.push_str(&t.xml10_content()),
            Event::GeneralRef(r) => match r.resolve_char_ref() {
                Ok(Some(c)) => inner.push(c),
                _ => inner.push_str(resolve_predefined_entity(r).unwrap_or("")),
            },
            Event::Eof => break,
            _ => {}
        }
    }
    match open.last() {
        Some(open) => Ok(Some(format!("ends inside <{open}>; the file is cut off"))),
        None if root_seen => Ok(None),
        None => Err(format!("holds no XML element; it is no {format}")),
    }
}

//! Trees of XML as CityGML has them: elements by their local names, with a bound on their depth.

use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};

/// Deepest nesting accepted.
const MAX_DEPTH: usize = 200;

/// An element.
#[derive(Debug, Default)]
pub(super) struct Node {
    /// Name without prefix.
    pub(super) name: String,
    /// `gml:id`, possibly empty.
    pub(super) id: String,
    /// Target of `xlink:href`, or of `uri` or `ring` of a texture, without its `#`, possibly empty.
    pub(super) href: String,
    /// `srsName`, possibly empty.
    pub(super) srs: String,
    /// `srsDimension`.
    pub(super) dimension: Option<usize>,
    /// Whether `orientation` is `-`.
    pub(super) reversed: bool,
    /// `name` of generic attributes, possibly empty.
    pub(super) label: String,
    /// Own text, trimmed.
    pub(super) text: String,
    pub(super) children: Vec<Node>,
    /// Line where it starts, from 1.
    pub(super) line: usize,
}

impl Node {
    pub(super) fn child(&self, name: &str) -> Option<&Node> {
        self.children.iter().find(|c| c.name == name)
    }

    /// Calls `visit` for this element and all within, parents first.
    pub(super) fn walk<'n>(&'n self, visit: &mut impl FnMut(&'n Node)) {
        visit(self);
        self.children.iter().for_each(|c| c.walk(visit));
    }

    fn of(event: &BytesStart<'_>, line: usize) -> Result<Self, String> {
        let name = event.local_name().as_ref().to_owned();
        let mut node = Self { name, line, ..Self::default() };
        for attribute in event.attributes() {
            let attribute = attribute.map_err(|e| format!("line {line}: an attribute is damaged ({e})"))?;
            let value = || attribute.value.to_string();
            match attribute.key.local_name().as_ref() {
                "id" => node.id = value(),
                "href" | "uri" | "ring" => node.href = value().trim().trim_start_matches('#').trim().to_owned(),
                "srsName" => node.srs = value().trim().to_owned(),
                "srsDimension" => node.dimension = value().trim().parse().ok(),
                "orientation" => node.reversed = value().trim() == "-",
                "name" => node.label = value(),
                _ => {}
            }
        }
        Ok(node)
    }
}

/// The root element of a document.
pub(super) fn parse(text: &str) -> Result<Node, String> {
    let mut reader = Reader::from_str(text);
    let (mut open, mut line, mut counted): (Vec<Node>, usize, usize) = (Vec::new(), 1, 0);
    loop {
        let at = (reader.buffer_position() as usize).min(text.len());
        line += text.as_bytes()[counted..at].iter().filter(|b| **b == b'\n').count();
        counted = at;
        let damaged =
            |e: &dyn std::fmt::Display| format!("line {line}: no well-formed XML ({e}); it is damaged or cut off");
        let done = match reader.read_event().map_err(|e| damaged(&e))? {
            Event::Start(e) => {
                open.push(Node::of(&e, line)?);
                if open.len() > MAX_DEPTH {
                    return Err(format!("line {line}: elements nest deeper than {MAX_DEPTH}; it is no CityGML"));
                }
                None
            }
            Event::Empty(e) => close(Node::of(&e, line)?, &mut open),
            Event::End(_) => open.pop().and_then(|node| close(node, &mut open)),
            Event::Text(e) => {
                if let Some(node) = open.last_mut() {
                    node.text.push_str(&e.xml10_content());
                }
                None
            }
            Event::CData(e) => {
                if let Some(node) = open.last_mut() {
                    node.text.push_str(&e.xml10_content());
                }
                None
            }
            Event::GeneralRef(e) => {
                let written = e.resolve_char_ref().map_err(|e| damaged(&e))?;
                if let Some(node) = open.last_mut() {
                    match written {
                        Some(c) => node.text.push(c),
                        None => node.text.push_str(resolve_predefined_entity(&e).unwrap_or("?")),
                    }
                }
                None
            }
            Event::Eof => return Err(format!("line {line}: it ends within its elements; it is cut off")),
            _ => None,
        };
        if let Some(root) = done {
            return Ok(root);
        }
    }
}

/// Adds a finished element to its parent; returns the root.
fn close(mut node: Node, open: &mut [Node]) -> Option<Node> {
    if node.text.trim().len() < node.text.len() {
        node.text = node.text.trim().to_owned();
    }
    match open.last_mut() {
        Some(parent) => {
            parent.children.push(node);
            None
        }
        None => Some(node),
    }
}

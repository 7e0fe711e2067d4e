//! The tree of accessibility, told to the page, which mirrors it in its elements (web/mirror.js), and the actions that come back.

use eframe::egui::accesskit::{Action, ActionData, ActionRequest, Live, Node, NodeId, Role, Toggled, TreeId};
use eframe::egui::{Context, Event, FullOutput, Plugin, RawInput};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::HashMap;

thread_local! {
    /// Actions that were asked for since the last frame.
    static ASKED: RefCell<Vec<ActionRequest>> = const { RefCell::new(Vec::new()) };
}

/// Asks for an action in the next frame; `None` if it is none.
///
/// * `text`, `number`: the value for the actions of these names.
pub(crate) fn ask(id: &str, action: &str, text: Option<String>, number: Option<f64>) -> Option<()> {
    let (action, data) = match action {
        "click" => (Action::Click, None),
        "focus" => (Action::Focus, None),
        "text" => (Action::SetValue, Some(ActionData::Value(text?.into()))),
        "number" => (Action::SetValue, Some(ActionData::NumericValue(number?))),
        _ => return None,
    };
    let target_node = NodeId(id.parse().ok()?);
    ASKED.with_borrow_mut(|asked| {
        asked.push(ActionRequest { action, target_tree: TreeId::ROOT, target_node, data });
    });
    Some(())
}

/// The tree as the page has it.
pub(crate) struct Mirror {
    nodes: HashMap<NodeId, Node>,
    focus: Option<NodeId>,
    tell: Box<dyn Fn(&str) + Send + Sync>,
    rest: Box<dyn Fn(f64) + Send + Sync>,
}

impl Mirror {
    /// * `tell`: takes what has changed, as JSON. `rest`: takes the time until the next frame, milliseconds.
    pub(crate) fn new(tell: impl Fn(&str) + Send + Sync + 'static, rest: impl Fn(f64) + Send + Sync + 'static) -> Self {
        Self { nodes: HashMap::new(), focus: None, tell: Box::new(tell), rest: Box::new(rest) }
    }
}

impl Plugin for Mirror {
    fn debug_name(&self) -> &'static str {
        "mirror"
    }

    fn input_hook(&mut self, _: &Context, input: &mut RawInput) {
        ASKED.with_borrow_mut(|asked| input.events.extend(asked.drain(..).map(Event::AccessKitActionRequest)));
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let delays = output.viewport_output.values().map(|viewport| viewport.repaint_delay.as_secs_f64());
        (self.rest)(1e3 * delays.fold(f64::MAX, f64::min).min(1e9));
        let Some(update) = output.platform_output.accesskit_update.take() else { return };
        let Some(root) = update.tree.map(|tree| tree.root) else { return };
        // The pieces of which a text is set say nothing beyond it.
        let nodes: HashMap<NodeId, Node> =
            update.nodes.into_iter().filter(|(_, node)| node.role() != Role::TextRun).collect();
        let zoom = f64::from(ctx.zoom_factor());
        let changed = nodes.iter().filter(|(id, node)| self.nodes.get(id) != Some(*node));
        let changed: Vec<Value> = changed.map(|(id, node)| described(*id, node, &nodes, zoom)).collect();
        let gone: Vec<String> = self.nodes.keys().filter(|id| !nodes.contains_key(id)).map(name_of).collect();
        if !changed.is_empty() || !gone.is_empty() || self.focus != Some(update.focus) {
            let (root, focus) = (name_of(&root), name_of(&update.focus));
            let text = json!({ "root": root, "focus": focus, "nodes": changed, "gone": gone }).to_string();
            (self.tell)(&text);
        }
        (self.nodes, self.focus) = (nodes, Some(update.focus));
    }
}

/// An id as the page writes it; its numbers are too short for it.
fn name_of(id: &NodeId) -> String {
    id.0.to_string()
}

/// What the page needs of a node; empty entries are left out.
fn described(id: NodeId, node: &Node, nodes: &HashMap<NodeId, Node>, zoom: f64) -> Value {
    let there = |ids: &[NodeId]| ids.iter().filter(|id| nodes.contains_key(id)).map(name_of).collect::<Vec<_>>();
    let place = node.bounds().map(|b| [b.x0, b.y0, b.x1 - b.x0, b.y1 - b.y0].map(|v| (zoom * v).round()));
    let named_by = there(node.labelled_by());
    let is_live = node.live().map(|live| match live {
        Live::Off => "off",
        Live::Polite => "polite",
        Live::Assertive => "assertive",
    });
    let toggled = node.toggled().map(|toggled| match toggled {
        Toggled::True => "true",
        Toggled::False => "false",
        Toggled::Mixed => "mixed",
    });
    let mut value = json!({
        "id": name_of(&id),
        "role": role(node),
        "name": node.label(),
        "named_by": (!named_by.is_empty()).then_some(named_by),
        "description": node.description(),
        "value": node.value(),
        "number": node.numeric_value(),
        "min": node.min_numeric_value(),
        "max": node.max_numeric_value(),
        "toggled": toggled,
        "selected": node.is_selected(),
        "expanded": node.is_expanded(),
        "disabled": node.is_disabled().then_some(true),
        "hidden": node.is_hidden().then_some(true),
        "live": is_live,
        "place": place,
        "children": there(node.children()),
    });
    if let Some(entries) = value.as_object_mut() {
        entries.retain(|_, entry| !entry.is_null());
    }
    value
}

/// The role in the words of ARIA; `None` for plain text and for boxes without a name.
fn role(node: &Node) -> Option<&'static str> {
    Some(match node.role() {
        Role::Button | Role::DefaultButton | Role::ColorWell | Role::DisclosureTriangle => "button",
        Role::CheckBox => "checkbox",
        Role::Switch => "switch",
        Role::RadioButton => "radio",
        Role::Link => "link",
        Role::TextInput | Role::MultilineTextInput | Role::SearchInput => "textbox",
        Role::Slider => "slider",
        Role::SpinButton | Role::NumberInput => "spinbutton",
        Role::ComboBox | Role::EditableComboBox => "combobox",
        Role::ListBox => "listbox",
        Role::ListBoxOption => "option",
        Role::List => "list",
        Role::ListItem => "listitem",
        Role::Menu => "menu",
        Role::MenuBar => "menubar",
        Role::MenuItem => "menuitem",
        Role::Tab => "tab",
        Role::TabList => "tablist",
        Role::TabPanel => "tabpanel",
        Role::Image => "img",
        Role::ProgressIndicator => "progressbar",
        Role::Splitter => "separator",
        Role::Heading => "heading",
        Role::Tooltip => "tooltip",
        Role::Alert => "alert",
        Role::Status => "status",
        Role::Dialog | Role::AlertDialog => "dialog",
        Role::Label => return None,
        _ => return node.label().map(|_| "group"),
    })
}

#[cfg(test)]
mod tests;

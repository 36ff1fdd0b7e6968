//! The mirrored elements, and how one state of them differs from another.

use std::collections::{BTreeMap, BTreeSet};

use egui::accesskit::{AriaCurrent, Node, NodeId, Role, SortDirection, Toggled, TreeUpdate};
use serde::Serialize;

use super::arrange::{gather_rows, gather_tabs, is_leaf};
use super::role::aria_role;

/// The interface as a tree of elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    elements: BTreeMap<u64, Element>,
    top: Vec<u64>,
    focus: Option<u64>,
    /// What is to be said now, to someone who does not see it.
    pub(super) announcement: String,
}

/// One element: a widget, a text, or a group of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Element {
    /// Its name among the elements, the same from frame to frame; written as text, because JavaScript's numbers
    /// cannot hold it.
    #[serde(serialize_with = "as_text")]
    pub id: u64,
    /// Its ARIA role; empty for plain text.
    pub role: &'static str,
    /// Its accessible name.
    pub label: String,
    /// What it holds: the text of an input, the words of a label.
    pub value: Option<String>,
    /// More about it than its name says.
    pub description: Option<String>,
    /// Left, upper, width and height in CSS pixels of the canvas.
    pub bounds: [f64; 4],
    /// What is inside it, in reading order.
    #[serde(serialize_with = "all_as_text")]
    pub children: Vec<u64>,
    /// Whether it can be used.
    pub enabled: bool,
    /// Whether it takes clicks.
    pub clickable: bool,
    /// Whether it is checked or pressed; `None` if it cannot be.
    pub toggled: Option<Flag>,
    /// Whether it is the chosen one among others; `None` if it cannot be.
    pub selected: Option<bool>,
    /// Whether it leads to what is selected now.
    pub current: bool,
    /// How it sorts what it heads.
    pub sort: Option<&'static str>,
    /// Whether what it holds is shown; `None` if it does not fold.
    pub expanded: Option<bool>,
    /// Whether it holds several lines of text.
    pub multiline: bool,
    /// Its number and, where they are known, the least and the greatest one.
    pub number: Option<[Option<f64>; 3]>,
    /// The depth of a heading or of an item of a tree, from 1.
    pub level: Option<usize>,
    /// The place among those beside it, from 1, and how many these are.
    pub position: Option<[usize; 2]>,
}

/// Whether something is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Flag {
    False,
    True,
    /// Some of what it represents is.
    Mixed,
}

/// How a document differs from an earlier one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Elements that are gone.
    #[serde(serialize_with = "all_as_text")]
    pub removed: Vec<u64>,
    /// Elements that are new or other than before.
    pub changed: Vec<Element>,
    /// The outermost elements, in reading order.
    #[serde(serialize_with = "all_as_text")]
    pub top: Vec<u64>,
    /// The element that has the keyboard.
    #[serde(serialize_with = "maybe_as_text")]
    pub focus: Option<u64>,
    /// What is to be said now, to someone who does not see it.
    pub announcement: String,
}

impl Element {
    /// An element that only holds others.
    pub(super) fn group(id: u64, role: &'static str, bounds: [f64; 4], children: Vec<u64>) -> Self {
        Self {
            id,
            role,
            label: String::new(),
            value: None,
            description: None,
            bounds,
            children,
            enabled: true,
            clickable: false,
            toggled: None,
            selected: None,
            current: false,
            sort: None,
            expanded: None,
            multiline: false,
            number: None,
            level: None,
            position: None,
        }
    }
}

impl Document {
    /// Reads a whole AccessKit tree, as egui gives one in every frame. `scale` is CSS pixels per egui point.
    pub(super) fn read(update: &TreeUpdate, scale: f64) -> Self {
        let nodes: BTreeMap<NodeId, &Node> = update.nodes.iter().map(|(id, node)| (*id, node)).collect();
        let mut document =
            Self { focus: nodes.contains_key(&update.focus).then_some(update.focus.0), ..Self::default() };
        let Some(root) = update.tree.as_ref().map(|tree| tree.root) else {
            return document;
        };
        let reader = Reader { nodes, scale };
        document.top = reader.read_children(root, &mut document.elements, &mut BTreeSet::new());
        document.focus = document.focus.filter(|id| document.elements.contains_key(id));
        document
    }

    /// All elements, by id.
    pub fn elements(&self) -> impl Iterator<Item = &Element> {
        self.elements.values()
    }

    /// The elements of an ARIA role whose label or value contains a text.
    pub fn find<'a>(&'a self, role: &'a str, text: &'a str) -> impl Iterator<Item = &'a Element> {
        self.elements.values().filter(move |element| {
            element.role == role
                && (element.label.contains(text)
                    || element.value.as_ref().is_some_and(|value| value.contains(text)))
        })
    }

    /// The element that has the keyboard.
    pub fn focus(&self) -> Option<u64> {
        self.focus
    }

    /// Returns how this differs from an earlier document; `None` if it does not.
    pub(super) fn change_since(&self, earlier: &Self) -> Option<Change> {
        if self == earlier {
            return None;
        }
        Some(Change {
            removed: earlier.elements.keys().filter(|id| !self.elements.contains_key(id)).copied().collect(),
            changed: self
                .elements
                .iter()
                .filter(|(id, element)| earlier.elements.get(id) != Some(element))
                .map(|(_, element)| element.clone())
                .collect(),
            top: self.top.clone(),
            focus: self.focus,
            announcement: self.announcement.clone(),
        })
    }
}

struct Reader<'a> {
    nodes: BTreeMap<NodeId, &'a Node>,
    scale: f64,
}

impl Reader<'_> {
    /// Reads what is inside a node, leaving out containers that say nothing; answers the elements directly inside.
    fn read_children(
        &self,
        parent: NodeId,
        elements: &mut BTreeMap<u64, Element>,
        seen: &mut BTreeSet<NodeId>,
    ) -> Vec<u64> {
        let Some(node) = self.nodes.get(&parent) else {
            return Vec::new();
        };
        if !seen.insert(parent) {
            return Vec::new();
        }
        let mut inside = Vec::new();
        for &child in node.children() {
            let Some(node) = self.nodes.get(&child) else {
                continue;
            };
            if node.is_hidden() || node.role() == Role::TextRun {
                continue;
            }
            let children = self.read_children(child, elements, seen);
            match self.element(child, node, children) {
                Ok(mut element) => {
                    inside.push(element.id);
                    if is_leaf(element.role) {
                        inside.append(&mut element.children);
                    } else if element.role == "table" {
                        element.children = gather_rows(element.id, &element.children, elements);
                    }
                    elements.insert(element.id, element);
                }
                Err(children) => inside.extend(children),
            }
        }
        gather_tabs(parent.0, &inside, elements)
    }

    /// A node as an element, or its children if it says nothing itself.
    fn element(&self, id: NodeId, node: &Node, children: Vec<u64>) -> Result<Element, Vec<u64>> {
        let label = self.label(node);
        let value = self.value(node);
        let role = match aria_role(node.role()) {
            Some(role) => role,
            None if label.is_empty() => return Err(children),
            None => "group",
        };
        if role.is_empty() && label.is_empty() && value.as_ref().is_none_or(String::is_empty) {
            return Err(children);
        }
        let number = node
            .numeric_value()
            .map(|number| [Some(number), node.min_numeric_value(), node.max_numeric_value()]);
        Ok(Element {
            id: id.0,
            role,
            label,
            value,
            description: node.description().map(str::to_owned),
            bounds: self.bounds(node),
            children,
            enabled: !node.is_disabled(),
            clickable: node.supports_action(egui::accesskit::Action::Click),
            toggled: node.toggled().map(|toggled| match toggled {
                Toggled::False => Flag::False,
                Toggled::True => Flag::True,
                Toggled::Mixed => Flag::Mixed,
            }),
            selected: node.is_selected(),
            current: node.aria_current() == Some(AriaCurrent::True),
            sort: node.sort_direction().map(|direction| match direction {
                SortDirection::Ascending => "ascending",
                SortDirection::Descending => "descending",
                SortDirection::Other => "other",
            }),
            expanded: node.is_expanded(),
            multiline: node.role() == Role::MultilineTextInput,
            number,
            level: node.level(),
            position: node.position_in_set().zip(node.size_of_set()).map(|(at, size)| [at + 1, size]),
        })
    }

    /// The accessible name: a node's own, or that of the nodes that label it.
    fn label(&self, node: &Node) -> String {
        if let Some(label) = node.label() {
            return label.to_owned();
        }
        let words: Vec<&str> = node
            .labelled_by()
            .iter()
            .filter_map(|id| self.nodes.get(id))
            .filter_map(|node| node.label().or(node.value()))
            .collect();
        words.join(" ")
    }

    /// The value: a node's own, or the rows of text inside it.
    fn value(&self, node: &Node) -> Option<String> {
        if let Some(value) = node.value() {
            return Some(value.to_owned());
        }
        let rows: Vec<&str> = node
            .children()
            .iter()
            .filter_map(|id| self.nodes.get(id))
            .filter(|node| node.role() == Role::TextRun)
            .filter_map(|node| node.value())
            .collect();
        (!rows.is_empty()).then(|| rows.concat())
    }

    fn bounds(&self, node: &Node) -> [f64; 4] {
        let Some(bounds) = node.bounds() else {
            return [0.0; 4];
        };
        // Halves of pixels are near enough to point at, and keep small movements from counting as changes.
        let place = |points: f64| (points * self.scale * 2.0).round() / 2.0;
        let (left, upper) = (place(bounds.x0), place(bounds.y0));
        [left, upper, place(bounds.x1) - left, place(bounds.y1) - upper]
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde wants a reference; no lint on 32 bits")]
fn as_text<S: serde::Serializer>(id: &u64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(id)
}

fn all_as_text<S: serde::Serializer>(ids: &[u64], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(ids.iter().map(u64::to_string))
}

#[expect(clippy::ref_option, reason = "serde passes fields by reference")]
fn maybe_as_text<S: serde::Serializer>(id: &Option<u64>, serializer: S) -> Result<S::Ok, S::Error> {
    match id {
        Some(id) => serializer.collect_str(id),
        None => serializer.serialize_none(),
    }
}

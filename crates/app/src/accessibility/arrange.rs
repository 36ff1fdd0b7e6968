//! What ARIA wants of elements and egui does not give: tabs in a list of tabs, rows and cells in tables, and nothing in
//! what can hold nothing.

use std::collections::BTreeMap;

use super::document::Element;

/// Elements of these roles are leaves: assistive technology does not look inside.
const LEAVES: [&str; 15] = [
    "button",
    "checkbox",
    "img",
    "link",
    "meter",
    "option",
    "progressbar",
    "radio",
    "separator",
    "slider",
    "spinbutton",
    "switch",
    "tab",
    "textbox",
    "searchbox",
];

/// Returns whether what is inside an element of this role has to stand behind it instead.
pub(super) fn is_leaf(role: &str) -> bool {
    LEAVES.contains(&role)
}

/// Puts the tabs among neighbors into a list of tabs, where the first of them stood. `parent` is whose children they
/// are.
pub(super) fn gather_tabs(parent: u64, inside: &[u64], elements: &mut BTreeMap<u64, Element>) -> Vec<u64> {
    let is_tab = |id: &u64| elements.get(id).is_some_and(|element| element.role == "tab");
    let (tabs, others): (Vec<u64>, Vec<u64>) = inside.iter().partition(|id| is_tab(id));
    let Some(first) = inside.iter().position(is_tab) else { return others };
    let list = Element::group(derived(parent, 0), "tablist", hull(&tabs, elements), tabs);
    let mut all = others;
    all.insert(first, list.id);
    elements.insert(list.id, list);
    all
}

/// Arranges the cells of a table in rows, by where they are; the first row heads the columns.
pub(super) fn gather_rows(table: u64, cells: &[u64], elements: &mut BTreeMap<u64, Element>) -> Vec<u64> {
    let mut rows: Vec<Vec<u64>> = Vec::new();
    let mut lower = f64::NEG_INFINITY;
    for &cell in cells {
        let Some(element) = elements.get(&cell) else { continue };
        let [_, top, _, height] = element.bounds;
        if top + height / 2.0 > lower {
            rows.push(Vec::new());
            lower = top + height;
        }
        if let Some(row) = rows.last_mut() {
            row.push(cell);
        }
    }
    let mut ids = Vec::new();
    for (at, row) in rows.into_iter().enumerate() {
        let role = if at == 0 { "columnheader" } else { "cell" };
        let bounds = hull(&row, elements);
        let inside = row.into_iter().map(|id| as_cell(id, role, elements)).collect();
        let row = Element::group(derived(table, at as u64 + 1), "row", bounds, inside);
        ids.push(row.id);
        elements.insert(row.id, row);
    }
    ids
}

/// A text becomes a cell, anything else is put into one, which says how the table is sorted by it.
fn as_cell(id: u64, role: &'static str, elements: &mut BTreeMap<u64, Element>) -> u64 {
    let Some(element) = elements.get_mut(&id) else { return id };
    if element.role.is_empty() {
        element.role = role;
        return id;
    }
    let mut cell = Element::group(derived(id, 0), role, element.bounds, vec![id]);
    cell.sort = element.sort.take();
    let id = cell.id;
    elements.insert(id, cell);
    id
}

/// The id of an element that egui knows nothing of.
fn derived(id: u64, number: u64) -> u64 {
    (id ^ 0x9E37_79B9_7F4A_7C15).wrapping_add(number).wrapping_mul(0xBF58_476D_1CE4_E5B9)
}

fn hull(ids: &[u64], elements: &BTreeMap<u64, Element>) -> [f64; 4] {
    let all = || ids.iter().filter_map(|id| elements.get(id)).map(|element| element.bounds);
    let left = all().map(|[left, ..]| left).fold(f64::INFINITY, f64::min);
    let upper = all().map(|[_, upper, ..]| upper).fold(f64::INFINITY, f64::min);
    let right = all().map(|[left, _, width, _]| left + width).fold(left, f64::max);
    let lower = all().map(|[_, upper, _, height]| upper + height).fold(upper, f64::max);
    [left, upper, right - left, lower - upper]
}

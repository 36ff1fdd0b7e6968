//! What the colors of a timeline mean: the sites that activities go to or work at, and the values of states.

use std::collections::BTreeMap;

use rmpl::program::{LabelMode, Program};
use smol_str::SmolStr;
use tpn::{Network, ValueSet};

use super::row::{Bar, BarKind, Item};

/// A site or a value of a state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Category {
    pub name: SmolStr,
    pub is_site: bool,
}

/// Finds out the category of each bar of `items`; the sites come first, in the order of their declarations.
pub(super) fn categories(program: &Program, network: &Network, items: &mut [Item]) -> Vec<Category> {
    let locations = &program.world.locations;
    let sites: BTreeMap<&str, usize> =
        locations.iter().enumerate().map(|(at, it)| (it.name.text.as_str(), at)).collect();
    // A site by its number, a value by the number of its name after all sites.
    let mut values: BTreeMap<SmolStr, usize> = BTreeMap::new();
    let mut is_used = vec![false; locations.len()];
    for bar in items.iter_mut().flat_map(|item| &mut item.bars) {
        let site = match bar.kind {
            BarKind::Activity | BarKind::Past | BarKind::Aborted => site(network, bar, &sites),
            BarKind::Value | BarKind::Changing => sites.get(bar.name.as_str()).copied(),
            _ => None,
        };
        bar.category = site;
        if let Some(site) = site {
            is_used[site] = true;
        } else if matches!(bar.kind, BarKind::Value | BarKind::Changing) {
            let next = values.len();
            bar.category = Some(locations.len() + *values.entry(bar.name.clone()).or_insert(next));
        }
    }
    let mut legend: Vec<Category> = Vec::new();
    let mut place = vec![0; locations.len() + values.len()];
    for (at, location) in locations.iter().enumerate().filter(|(at, _)| is_used[*at]) {
        place[at] = legend.len();
        legend.push(Category { name: location.name.text.clone(), is_site: true });
    }
    let mut values: Vec<(usize, SmolStr)> = values.into_iter().map(|(name, at)| (at, name)).collect();
    values.sort_unstable();
    for (at, name) in values {
        place[locations.len() + at] = legend.len();
        legend.push(Category { name, is_site: false });
    }
    for bar in items.iter_mut().flat_map(|item| &mut item.bars) {
        bar.category = bar.category.map(|at| place[at]);
    }
    legend
}

/// Returns where an activity goes or works: the place that it sets or requires, or the last that it is called with.
fn site(network: &Network, bar: &Bar, sites: &BTreeMap<&str, usize>) -> Option<usize> {
    let place = |mode: LabelMode| {
        bar.labels.iter().filter_map(|label| network.labels.get(label.index())).find_map(|label| {
            let variable = network.variables.get(label.literal.variable.index())?;
            let ValueSet::In(values) = &label.literal.values else { return None };
            let [value] = values.as_slice() else { return None };
            let is_place = label.mode == mode && variable.name.ends_with(".at");
            sites.get(variable.values.get(value.index()).filter(|_| is_place)?.as_str()).copied()
        })
    };
    let arguments = || {
        let occurrence = network.occurrences.get(bar.occurrence?.index())?;
        occurrence.arguments.iter().rev().find_map(|it| sites.get(it.as_str()).copied())
    };
    place(LabelMode::Tell).or_else(|| place(LabelMode::Ask)).or_else(arguments)
}

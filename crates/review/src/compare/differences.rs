//! Finds what differs. Each kind of thing is matched by name; the work is linear in the size of both plans, times the
//! logarithm for finding names.

use std::collections::{BTreeMap, BTreeSet};

use super::{Change, Comparison, Difference, Item, PathPair, Row, Side, Subject, Taken, Way, windows_text};

/// Compares two plans.
pub fn compare(before: &Side, after: &Side) -> Comparison {
    let rows = rows(before, after);
    let mut differences = choices(before, after);
    differences.extend(rows.iter().filter_map(|row| item_difference(row, before, after)));
    differences.extend(links(before, after));
    differences.extend(orderings(before, after));
    differences.extend(figures(before, after));
    let paths = paths(before, after);
    // Ways that one side does not know are not a difference.
    if before.ways.is_some() && after.ways.is_some() {
        differences.extend(paths.iter().filter_map(path_difference));
    }
    Comparison { differences, rows, paths }
}

/// The names of both sides, each once, in order.
fn names<'side, V, W>(
    before: &'side BTreeMap<String, V>,
    after: &'side BTreeMap<String, W>,
) -> BTreeSet<&'side String> {
    before.keys().chain(after.keys()).collect()
}

/// A difference of something that one side or both have; the texts are what each says of it.
fn difference(
    subject: Subject,
    name: &str,
    before: Option<String>,
    after: Option<String>,
    both: Change,
) -> Difference {
    let change = match (&before, &after) {
        (None, _) => Change::Added,
        (_, None) => Change::Removed,
        _ => both,
    };
    Difference { change, subject, name: name.to_owned(), before, after }
}

fn choices(before: &Side, after: &Side) -> Vec<Difference> {
    let text = |taken: &Taken| match &taken.text {
        Some(text) if !text.is_empty() => format!("alternative {}: {text}", taken.alternative),
        _ => format!("alternative {}", taken.alternative),
    };
    // `D10` comes after `D9`.
    let mut names: Vec<&String> = names(&before.choices, &after.choices).into_iter().collect();
    names.sort_by_key(|name| (name.len(), name.as_str()));
    names
        .into_iter()
        .filter_map(|name| {
            let (old, new) = (before.choices.get(name), after.choices.get(name));
            let is_same = old.zip(new).is_some_and(|(old, new)| old.alternative == new.alternative);
            (!is_same)
                .then(|| difference(Subject::Choice, name, old.map(text), new.map(text), Change::Rechosen))
        })
        .collect()
}

fn rows(before: &Side, after: &Side) -> Vec<Row> {
    let mut rows: Vec<Row> = names(&before.items, &after.items)
        .into_iter()
        .filter_map(|name| {
            let (old, new) = (before.items.get(name), after.items.get(name));
            let known = new.or(old)?;
            let change = match (old, new) {
                (None, _) => Some(Change::Added),
                (_, None) => Some(Change::Removed),
                (Some(old), Some(new)) if old.windows != new.windows => Some(Change::Moved),
                (Some(old), Some(new)) if has_other_arguments(old, new) => Some(Change::Changed),
                _ => None,
            };
            Some(Row {
                name: name.clone(),
                subject: known.subject,
                change,
                before: old.map(|item| item.windows),
                after: new.map(|item| item.windows),
            })
        })
        .collect();
    rows.sort_by_key(|row| {
        let windows = row.after.or(row.before);
        // What contains others is above them.
        windows.map(|[start, end]| (start.earliest, std::cmp::Reverse(end.earliest)))
    });
    rows
}

fn has_other_arguments(old: &Item, new: &Item) -> bool {
    old.arguments.as_ref().zip(new.arguments.as_ref()).is_some_and(|(old, new)| old != new)
}

fn item_difference(row: &Row, before: &Side, after: &Side) -> Option<Difference> {
    let change = row.change?;
    let (old, new) = (before.items.get(&row.name), after.items.get(&row.name));
    let says_arguments = old.zip(new).is_some_and(|(old, new)| has_other_arguments(old, new));
    let text = |item: &Item| match (&item.arguments, change) {
        (Some(arguments), Change::Changed) => format!("({arguments})"),
        (Some(arguments), _) if says_arguments => format!("({arguments}) {}", windows_text(item.windows)),
        _ => windows_text(item.windows),
    };
    Some(difference(row.subject, &row.name, old.map(text), new.map(text), change))
}

fn links(before: &Side, after: &Side) -> Vec<Difference> {
    let text = |tell: &String| format!("supported by {tell}");
    names(&before.links, &after.links)
        .into_iter()
        .filter_map(|ask| {
            let (old, new) = (before.links.get(ask), after.links.get(ask));
            (old != new)
                .then(|| difference(Subject::Link, ask, old.map(text), new.map(text), Change::Rechosen))
        })
        .collect()
}

fn orderings(before: &Side, after: &Side) -> Vec<Difference> {
    // A pair is known by its names in order, whichever comes first in time.
    let by_pair = |side: &Side| -> BTreeMap<String, String> {
        let entry = |[first, then]: &[String; 2]| {
            let (left, right) = if first <= then { (first, then) } else { (then, first) };
            (format!("{left} and {right}"), format!("{first} first"))
        };
        side.orderings.iter().map(entry).collect()
    };
    let (old, new) = (by_pair(before), by_pair(after));
    let differ = names(&old, &new).into_iter().filter_map(|pair| {
        let (old, new) = (old.get(pair).cloned(), new.get(pair).cloned());
        (old != new).then(|| difference(Subject::Ordering, pair, old, new, Change::Rechosen))
    });
    differ.chain(reversed(before, after)).collect()
}

/// Changes of one variable that are in both plans, one after the other in the first plan, and the other way round in the
/// second.
fn reversed(before: &Side, after: &Side) -> Vec<Difference> {
    let mut found = Vec::new();
    for (variable, old) in &before.states {
        let Some(new) = after.states.get(variable) else { continue };
        let places: BTreeMap<&String, usize> = new.iter().zip(0..).collect();
        let kept: Vec<(&String, usize)> =
            old.iter().filter_map(|name| Some((name, *places.get(name)?))).collect();
        let reversed = kept.array_windows().filter(|[one, other]| one.1 > other.1);
        found.extend(reversed.map(|[(first, _), (then, _)]| {
            let sides = [first, then].map(|name| Some(format!("{name} first")));
            let [old, new] = sides;
            difference(Subject::Ordering, &format!("{first} and {then}"), old, new, Change::Rechosen)
        }));
    }
    found
}

/// Returns how far resources are used, and what the plans are worth.
fn figures(before: &Side, after: &Side) -> Vec<Difference> {
    names(&before.figures, &after.figures)
        .into_iter()
        .filter_map(|name| {
            let (old, new) = (before.figures.get(name).cloned(), after.figures.get(name).cloned());
            (old != new).then(|| difference(Subject::Figure, name, old, new, Change::Changed))
        })
        .collect()
}

fn paths(before: &Side, after: &Side) -> Vec<PathPair> {
    let none = BTreeMap::new();
    let (old, new) = (before.ways.as_ref().unwrap_or(&none), after.ways.as_ref().unwrap_or(&none));
    names(old, new)
        .into_iter()
        .map(|name| PathPair {
            name: name.clone(),
            before: old.get(name).cloned(),
            after: new.get(name).cloned(),
        })
        .collect()
}

fn path_difference(pair: &PathPair) -> Option<Difference> {
    let text = |way: &Way| {
        let points = way.points_m.len();
        format!("{:.1} m over {points} points", way.length_m)
    };
    let is_same =
        pair.before.as_ref().map(|way| &way.points_m) == pair.after.as_ref().map(|way| &way.points_m);
    (!is_same).then(|| {
        difference(
            Subject::Path,
            &pair.name,
            pair.before.as_ref().map(text),
            pair.after.as_ref().map(text),
            Change::Changed,
        )
    })
}

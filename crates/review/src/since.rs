//! What differs between what was approved and the present: in the text, the plan, the checklist and the runs with chance.

use std::collections::BTreeMap;

use similar::{Algorithm, DiffOp, DiffTag};
use snapshot::Robustness;
use snapshot::Snapshot;

use super::record::{Rate, SeenLine, Subject, seen_lines};
use super::{Review, Section};
use crate::compare::{Comparison, Side, compare};

/// What differs since an approval.
#[derive(Clone, Debug, PartialEq)]
pub struct Since {
    /// The places at which the text differs, in order.
    pub text: Vec<TextChange>,
    /// How the plans differ; `None` where the approved one was not kept.
    pub plan: Option<Comparison>,
    /// The lines of the checklist that are not as they were.
    pub lines: Vec<LineChange>,
    /// The flight rules that are not as they were, before and after.
    pub rules: Vec<[String; 2]>,
    /// How many runs reached the end then and now, if that differs.
    pub robustness: Option<[Option<Rate>; 2]>,
}

/// Lines of a text in place of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextChange {
    /// The first line of the place in the former text, from 1.
    pub before_line: usize,
    /// The first line of the place in the present text, from 1.
    pub after_line: usize,
    /// The lines that are gone.
    pub removed: Vec<String>,
    /// The lines that are new.
    pub added: Vec<String>,
}

/// A line of a checklist that is not as it was.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChange {
    /// As it was; nothing of a new line.
    pub before: Option<SeenLine>,
    /// As it is; nothing of a line that is gone.
    pub after: Option<SeenLine>,
}

impl LineChange {
    /// The section that it belongs to.
    pub fn section(&self) -> Option<Section> {
        self.after.as_ref().or(self.before.as_ref()).map(|line| line.section)
    }

    /// In words: `new`, `gone`, `was passed, needs attention`.
    pub fn sentence(&self) -> String {
        match (&self.before, &self.after) {
            (Some(before), Some(after)) if before.status == after.status => {
                format!("{}, new wording: {} → {}", after.status.name(), before.text, after.text)
            }
            (Some(before), Some(after)) if before.text == after.text => {
                format!("{}, was {}: {}", after.status.name(), before.status.name(), after.text)
            }
            (Some(before), Some(after)) => {
                let (now, then) = (after.status.name(), before.status.name());
                format!("{now}, was {then}: {} → {}", before.text, after.text)
            }
            (None, Some(after)) => format!("new, {}: {}", after.status.name(), after.text),
            (Some(before), None) => format!("gone, was {}: {}", before.status.name(), before.text),
            (None, None) => String::new(),
        }
    }
}

impl Since {
    /// Returns whether nothing differs.
    pub fn is_nothing(&self) -> bool {
        self.text.is_empty()
            && self.plan.as_ref().is_none_or(Comparison::is_same)
            && self.lines.is_empty()
            && self.rules.is_empty()
            && self.robustness.is_none()
    }
}

/// Returns what differs between what was approved and a reviewed snapshot with the runs that were made of it.
pub fn since(approved: &Subject, snapshot: &Snapshot, review: &Review, found: Option<&Robustness>) -> Since {
    let plan = Side::of_json("approved", &approved.plan).ok();
    let rates = [approved.robustness, found.map(Rate::new)];
    let words = |rules: &super::FlightRules| rules.in_words(&review.unit);
    Since {
        text: text_changes(&approved.source, &snapshot.source),
        plan: plan.map(|before| compare(&before, &Side::of_snapshot("present", snapshot))),
        lines: line_changes(&approved.lines, &seen_lines(review)),
        rules: rule_changes(&words(&approved.rules), &words(&review.rules)),
        robustness: (rates[0] != rates[1]).then_some(rates),
    }
}

/// Lines beyond what differs are looked at one by one up to here: finding the least that differs takes as long as the
/// product of what differs and what there is.
const MAX_LINES: usize = 4000;

/// The places at which two texts differ, in order.
pub fn text_changes(before: &str, after: &str) -> Vec<TextChange> {
    if before == after {
        return Vec::new();
    }
    let before: Vec<&str> = before.lines().collect();
    let after: Vec<&str> = after.lines().collect();
    let same = before.iter().zip(&after).take_while(|(before, after)| before == after).count();
    let (before_rest, after_rest) = (&before[same..], &after[same..]);
    let tail = before_rest.iter().rev().zip(after_rest.iter().rev());
    let same_at_end = tail.take_while(|(before, after)| before == after).count();
    let before_rest = &before_rest[..before_rest.len() - same_at_end];
    let after_rest = &after_rest[..after_rest.len() - same_at_end];
    let owned = |lines: &[&str]| lines.iter().map(|&line| line.to_owned()).collect::<Vec<String>>();
    if before_rest.len().max(after_rest.len()) > MAX_LINES {
        return vec![TextChange {
            before_line: same + 1,
            after_line: same + 1,
            removed: owned(before_rest),
            added: owned(after_rest),
        }];
    }
    let operations = similar::capture_diff_slices(Algorithm::Myers, before_rest, after_rest);
    let differing = operations.iter().filter(|operation| operation.tag() != DiffTag::Equal);
    let change = |operation: &DiffOp| TextChange {
        before_line: same + operation.old_range().start + 1,
        after_line: same + operation.new_range().start + 1,
        removed: owned(&before_rest[operation.old_range()]),
        added: owned(&after_rest[operation.new_range()]),
    };
    differing.map(change).collect()
}

/// Lines that say the same are the same line; of the others, those about the same names in one section are.
fn line_changes(before: &[SeenLine], after: &[SeenLine]) -> Vec<LineChange> {
    if before.is_empty() {
        // What was approved by the version before had no lines.
        return Vec::new();
    }
    let mut is_left = vec![true; before.len()];
    let mut by_text: BTreeMap<(Section, &str), Vec<usize>> = BTreeMap::new();
    for (index, line) in before.iter().enumerate().rev() {
        by_text.entry((line.section, &line.text)).or_default().push(index);
    }
    let mut changes = Vec::new();
    let mut others = Vec::new();
    for line in after {
        match by_text.get_mut(&(line.section, line.text.as_str())).and_then(Vec::pop) {
            Some(index) => {
                is_left[index] = false;
                if before[index].status != line.status {
                    changes
                        .push(LineChange { before: Some(before[index].clone()), after: Some(line.clone()) });
                }
            }
            None => others.push(line),
        }
    }
    let mut by_names: BTreeMap<(Section, &[String]), Vec<usize>> = BTreeMap::new();
    for (index, line) in before.iter().enumerate().rev() {
        if is_left[index] && !line.names.is_empty() {
            by_names.entry((line.section, &line.names)).or_default().push(index);
        }
    }
    for line in others {
        let known = by_names.get_mut(&(line.section, line.names.as_slice())).and_then(Vec::pop);
        if let Some(index) = known {
            is_left[index] = false;
        }
        changes
            .push(LineChange { before: known.map(|index| before[index].clone()), after: Some(line.clone()) });
    }
    let gone = before.iter().zip(is_left).filter(|(_, is_left)| *is_left);
    changes.extend(gone.map(|(line, _)| LineChange { before: Some(line.clone()), after: None }));
    changes.sort_by_key(LineChange::section);
    changes
}

fn rule_changes(before: &[String], after: &[String]) -> Vec<[String; 2]> {
    let only = |these: &[String], those: &[String]| -> Vec<String> {
        these.iter().filter(|rule| !those.contains(rule)).cloned().collect()
    };
    let (gone, new) = (only(before, after), only(after, before));
    let count = gone.len().max(new.len());
    let of = |rules: &[String], index: usize| rules.get(index).cloned().unwrap_or_default();
    (0..count).map(|index| [of(&gone, index), of(&new, index)]).collect()
}

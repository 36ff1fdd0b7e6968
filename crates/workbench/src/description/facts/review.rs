//! The review of the present plan.

use review::{Line, Section, Status};

use super::{Row, count, truth, words};
use crate::description::Description;

pub(super) const VALUES: &[Row] = &[
    ("reviewed", |it, _| truth(it.current_review().is_some())),
    ("items", |it, name| {
        let status = STATUSES.into_iter().find(|(_, known)| *known == name)?.0;
        count(lines(it)?.iter().filter(|line| line.status == status).count())
    }),
    ("item", |it, text| {
        let status = lines(it)?.into_iter().find(|line| line.text.contains(text))?.status;
        words(STATUSES.into_iter().find(|(known, _)| *known == status)?.1)
    }),
    ("has-item", |it, text| truth(lines(it)?.iter().any(|line| line.text.contains(text)))),
];

/// What items of a review can be, in words.
const STATUSES: [(Status, &str); 4] = [
    (Status::Passed, "passed"),
    (Status::Attention, "needs attention"),
    (Status::Failed, "failed"),
    (Status::Information, "information"),
];

fn lines<'a>(it: &Description<'a>) -> Option<Vec<&'a Line>> {
    let review = it.current_review()?;
    Some(Section::ALL.into_iter().flat_map(|section| review.lines(section)).collect())
}

//! A plan's schedule as a plan in PDDL 2.1: `0.000: (drive r1 a b) [10.000]`.

use exact::Time;
use interchange::pddl::{body_of, named_action};
use review::schedule::scheduled;
use snapshot::Snapshot;
use tpn::{Occurrence, OccurrenceKind};

use crate::export::{About, unit_in_words};

/// One line for each primitive, at its earliest times. `None` without a plan.
///
/// In a mission that was read from PDDL a name holds the action with its objects. In any other mission the action is the
/// primitive and its objects are the arguments. Times are decimals in the unit of the mission, to the nearest of nine places.
pub fn pddl(snapshot: &Snapshot, about: &About<'_>) -> Option<String> {
    let network = snapshot.network.as_deref()?;
    let plan = about.plan.or_else(|| snapshot.plan())?;
    let unit = unit_in_words(snapshot);
    let mut text = format!(
        "; Earliest schedule, in {unit} of the mission ({}, content {}).\n",
        about.status_in_words(),
        about.content_hash
    );
    let is_action = |occurrence: &Occurrence| match occurrence.kind {
        OccurrenceKind::Primitive => true,
        // The primitive with its conditions is a part of it.
        OccurrenceKind::Activity => {
            let body = body_of(&occurrence.activity);
            snapshot.program.primitives.iter().any(|primitive| primitive.name.text == body)
        }
        _ => false,
    };
    for row in scheduled(network, plan) {
        let occurrence = &network.occurrences[row.occurrence.index()];
        let Some(action) = named_action(&occurrence.activity).filter(|_| is_action(occurrence)) else {
            continue;
        };
        let arguments = occurrence.arguments.iter().map(smol_str::SmolStr::as_str);
        let words: Vec<&str> = action.words.into_iter().chain(arguments).collect();
        text += &format!("{}: ({})", places(row.start.earliest), words.join(" "));
        if !action.is_instant {
            text += &format!(" [{}]", places(row.end.earliest.checked_sub(row.start.earliest)?));
        }
        text.push('\n');
    }
    Some(text)
}

/// A decimal of at least three places.
fn places(time: Time) -> String {
    let decimal = time.nearest_decimal();
    let (whole, fraction) = decimal.split_once('.').unwrap_or((&decimal, ""));
    format!("{whole}.{fraction:0<3}")
}

//! Reasons about traverses that cannot be driven, told as what they are.

use kirk::{Constraint, CycleMember, Outcome, Reason};
use tpn::{ArcKind, Network};

use crate::Undrivable;

/// Tells of a blocked traverse what blocks it, instead of the contradiction that represents it.
pub fn name_blocked(outcome: &mut Outcome, network: &Network, undrivable: &[Undrivable]) {
    let Some(failure) = &mut outcome.failure else { return };
    for reason in &mut failure.reasons {
        name_blocked_in(reason, network, undrivable);
    }
    failure.relaxations.retain(|relaxation| {
        network.arcs.get(relaxation.arc.index()).is_some_and(|arc| arc.kind != ArcKind::Path)
    });
}

/// Tells a reason that is about a traverse without a way as what it is.
pub fn name_blocked_in(reason: &mut Reason, network: &Network, undrivable: &[Undrivable]) {
    let arc = |member: &CycleMember| {
        let (Constraint::Lower(arc) | Constraint::Upper(arc)) = member.constraint else { return None };
        network.arcs.get(arc.index())
    };
    let mut members = reason.cycle.iter().map(arc);
    let blocked = members.clone().flatten().filter(|arc| arc.kind == ArcKind::Path).find_map(|arc| {
        // A traverse that only its own bounds leave no time for is in conflict with nothing else.
        let is_alone = members.all(|other| other.is_some_and(|other| other.occurrence == arc.occurrence));
        undrivable
            .iter()
            .find(|traverse| Some(traverse.occurrence) == arc.occurrence && (traverse.leg > 0 || is_alone))
    });
    if let Some(traverse) = blocked {
        let occurrence = &network.occurrences[traverse.occurrence.index()];
        reason.message = format!("{} can't be driven {}", occurrence.name, traverse.reason);
        reason.spans = occurrence.span.into_iter().collect();
    }
}

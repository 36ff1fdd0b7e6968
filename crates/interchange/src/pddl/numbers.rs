//! Numbers that change, as reservoirs: one for how far a number is above its minimum, and one for how far it is below its
//! maximum. A reservoir that no condition asks for is left out.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use exact::Rational;

use super::error::PddlError;
use super::ground::{Action, Conditions, Fluent, Ground, Need, Snap};

/// The range of a number, whatever the plan is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) initial: Rational,
    pub(super) least: Rational,
    pub(super) greatest: Rational,
    /// Whether conditions ask for at least some value.
    pub(super) has_least: bool,
    /// Whether conditions ask for at most some value.
    pub(super) has_most: bool,
}

/// What a snap takes out of one of the reservoirs of a number when it begins, and puts in when it is over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Exchange {
    pub(super) takes: Rational,
    pub(super) gives: Rational,
}

/// Which of the two reservoirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    /// How far the number is above its minimum.
    Above,
    /// How far the number is below its maximum.
    Below,
}

fn sum(left: Rational, right: Rational) -> Result<Rational, PddlError> {
    left.checked_add(right).ok_or(PddlError::Number)
}

fn difference(left: Rational, right: Rational) -> Result<Rational, PddlError> {
    left.checked_sub(right).ok_or(PddlError::Number)
}

/// The ranges of the numbers that conditions ask for. Makes strict limits of whole numbers plain ones, and leaves out
/// conditions that always hold and actions whose conditions never do.
pub(super) fn ranges(ground: &mut Ground, times: u32) -> Result<BTreeMap<Fluent, Range>, PddlError> {
    let mut ranges: BTreeMap<Fluent, Range> = BTreeMap::new();
    let conditions = ground.actions.iter().flat_map(Action::conditions).chain([&ground.goal]);
    let asked: Vec<Need> = conditions.flat_map(|conditions| &conditions.needs).copied().collect();
    for need in &asked {
        if let Entry::Vacant(vacant) = ranges.entry(need.fluent) {
            vacant.insert(range(ground, need.fluent, times)?);
        }
    }
    let is_integer = |ground: &Ground, fluent: Fluent| {
        let changes = ground.actions.iter().flat_map(Action::snaps).filter_map(|it| it.changes.get(&fluent));
        changes.chain(ground.values.get(&fluent)).all(|number| number.is_integer())
    };
    let integers: BTreeMap<Fluent, bool> =
        ranges.keys().map(|fluent| (*fluent, is_integer(ground, *fluent))).collect();
    let names = &ground.fluents.all;
    let plain = |need: &Need| {
        if !need.is_strict {
            return Ok(*need);
        }
        if !integers[&need.fluent] || !need.limit.is_integer() {
            return Err(PddlError::Said {
                place: format!("({})", names[need.fluent].join(" ")),
                what: "a strict comparison of a number that is not whole",
            });
        }
        let step = Rational::from_integer(if need.is_least { 1 } else { -1 });
        Ok(Need { is_strict: false, limit: sum(need.limit, step)?, ..*need })
    };
    // Whether all can hold. What always does is left out.
    let mut settle = |conditions: &mut Conditions| -> Result<bool, PddlError> {
        let mut kept = Vec::new();
        for need in &conditions.needs {
            let need = plain(need)?;
            let range = ranges.get_mut(&need.fluent).ok_or(PddlError::Number)?;
            let (always, never) = if need.is_least {
                (need.limit <= range.least, need.limit > range.greatest)
            } else {
                (need.limit >= range.greatest, need.limit < range.least)
            };
            if never {
                return Ok(false);
            }
            if !always {
                range.has_least |= need.is_least;
                range.has_most |= !need.is_least;
                kept.push(need);
            }
        }
        conditions.needs = kept;
        Ok(true)
    };
    let mut kept = Vec::new();
    for mut action in std::mem::take(&mut ground.actions) {
        if settle(&mut action.start.conditions)?
            && settle(&mut action.throughout)?
            && settle(&mut action.end.conditions)?
        {
            kept.push(action);
        }
    }
    if !settle(&mut ground.goal)? {
        return Err(PddlError::NeverTrue);
    }
    ground.actions = kept;
    ranges.retain(|_, range| range.has_least || range.has_most);
    Ok(ranges)
}

/// The range of a number if every action happens as often as allowed.
fn range(ground: &Ground, fluent: Fluent, times: u32) -> Result<Range, PddlError> {
    let lacks = || PddlError::Said {
        place: format!("({})", ground.fluents.all[fluent].join(" ")),
        what: "a number without a value at first",
    };
    let initial = *ground.values.get(&fluent).ok_or_else(lacks)?;
    let (mut least, mut greatest) = (initial, initial);
    for snap in ground.actions.iter().flat_map(Action::snaps) {
        let Some(change) = snap.changes.get(&fluent) else { continue };
        let all = change.checked_mul(Rational::from(times)).ok_or(PddlError::Number)?;
        let side = if all.is_negative() { &mut least } else { &mut greatest };
        *side = sum(*side, all)?;
    }
    Ok(Range { initial, least, greatest, has_least: false, has_most: false })
}

impl Range {
    /// Returns how much of a reservoir conditions reserve.
    pub(super) fn reserved(
        &self,
        fluent: Fluent,
        side: Side,
        conditions: &Conditions,
    ) -> Result<Rational, PddlError> {
        let mut most = Rational::default();
        let of_side = |need: &&Need| need.fluent == fluent && need.is_least == (side == Side::Above);
        for need in conditions.needs.iter().filter(of_side) {
            most = most.max(match side {
                Side::Above => difference(need.limit, self.least)?,
                Side::Below => difference(self.greatest, need.limit)?,
            });
        }
        Ok(most)
    }

    /// Returns what a snap takes and gives, of what is not reserved already.
    pub(super) fn exchange(
        &self,
        fluent: Fluent,
        side: Side,
        snap: &Snap,
        already: Rational,
    ) -> Result<Exchange, PddlError> {
        let zero = Rational::default();
        let change = snap.changes.get(&fluent).copied().unwrap_or_default();
        let change = if side == Side::Above { change } else { difference(zero, change)? };
        let reserved = difference(self.reserved(fluent, side, &snap.conditions)?, already)?;
        let takes = reserved.max(difference(zero, change)?).max(zero);
        Ok(Exchange { takes, gives: sum(takes, change)? })
    }

    /// The sides that conditions ask for, each with its initial level.
    pub(super) fn sides(&self) -> Result<Vec<(Side, Rational)>, PddlError> {
        let mut sides = Vec::new();
        if self.has_least {
            sides.push((Side::Above, difference(self.initial, self.least)?));
        }
        if self.has_most {
            sides.push((Side::Below, difference(self.greatest, self.initial)?));
        }
        Ok(sides)
    }

    /// The most that a reservoir holds.
    pub(super) fn size(&self) -> Result<Rational, PddlError> {
        difference(self.greatest, self.least)
    }
}

//! How much of a resource gives a mission without a plan one: the least amount, found by planning with others.
//!
//! A capacity only has to hold what is used at one time, and a reservoir with room for everything is never too full. So with
//! more of either there still is a plan, and halving finds the least. All that can be short is a whole multiple of the largest
//! amount that divides everything which is used or written: no amount between two multiples needs a look.

use exact::Rational;
use rmpl::program::{Change, Program};
use rmpl::{Edit, Fix, Span};
use tpn::{Network, Resource, ResourceId, Supply, Use};

/// Meters of paths are counted in so many parts ([`tpn::worth::rounded_up`]).
const PARTS_OF_A_METER: i64 = 1_000;
/// More amounts than this between what there is and what is enough are not looked through.
const MAX_STEPS: i64 = 1 << 40;

/// What planning says of an amount.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    Plan,
    NoPlan,
    /// It takes too long to find out.
    Unknown,
}

/// A resource of which there might be more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Amount {
    /// The resource's declaration.
    span: Span,
    name: String,
    of: Of,
    /// A multiple of `unit` that is not above what there is.
    present: Rational,
    unit: Rational,
    /// With so many units more everything fits, or there is no room for more.
    most: i64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Of {
    Capacity,
    /// The level at the start, between bounds as they are written; with the second upper one there is room for everything.
    Level {
        least: String,
        greatest: String,
        unbounded: String,
    },
}

impl Amount {
    /// Returns what there might be more of, if `uses` take too much of a resource.
    pub(super) fn new(network: &Network, program: &Program, source: &str, uses: &[&Use]) -> Option<Self> {
        let id = uses.first()?.resource;
        let resource = &network.resources[id.index()];
        let declared = program.resources.iter().find(|it| it.name.text == resource.name)?;
        let text = |span: Span| source.get(span.range()).unwrap_or_default().to_owned();
        let unit = unit(network, id, resource)?;
        let sum = |change: Change| {
            let own = network.uses.iter().filter(|used| used.resource == id && used.change == change);
            own.map(|used| used.amount).try_fold(Rational::ZERO, Rational::checked_add)
        };
        let (of, first, now, enough) = match (&declared.supply, resource.supply) {
            (rmpl::program::Supply::Reusable { .. }, Supply::Reusable { capacity }) => {
                (Of::Capacity, Rational::ZERO, capacity, sum(Change::Uses)?)
            }
            (
                rmpl::program::Supply::Reservoir { least, greatest, .. },
                Supply::Reservoir { least: lowest, greatest: highest, level },
            ) => {
                if !is_short(uses, lowest, level)? {
                    return None;
                }
                let unbounded = highest.checked_add(sum(Change::Produces)?)?.decimal()?;
                let (least, greatest) = (text(least.span), text(greatest.span));
                (Of::Level { least, greatest, unbounded }, lowest, level, highest)
            }
            _ => return None,
        };
        let units = |amount: Rational| {
            Some(amount.checked_sub(first)?.checked_div(unit)?.floor()).filter(|units| *units < MAX_STEPS)
        };
        let present = first.checked_add(unit.checked_mul(Rational::from_integer(units(now)?))?)?;
        let most = units(enough)?.checked_sub(units(now)?)?;
        Some(Self { span: declared.span, name: resource.name.to_string(), of, present, unit, most })
    }

    /// The least amount with which there is a plan, as a change of the text. `verdict` tells what planning says of a changed
    /// declaration.
    pub(super) fn fix(&self, verdict: &mut dyn FnMut(&[Edit]) -> Verdict) -> Option<Fix> {
        let mut with = |steps: i64| {
            self.declaration(steps, true).map_or(Verdict::Unknown, |text| verdict(&self.edits(text)))
        };
        let (steps, is_least) = least(self.most, &mut with)?;
        let text = self.declaration(steps, false)?;
        // What is less than the least for a reservoir with room for everything is less than the least for this one.
        let is_known = self.declaration(steps, true).as_ref() == Some(&text);
        if !is_known && verdict(&self.edits(text.clone())) != Verdict::Plan {
            return None;
        }
        let (amount, name) = (self.amount(steps)?, &self.name);
        let or_less = if is_least { "" } else { ", or less" };
        let label = match self.of {
            Of::Capacity => format!("have {amount} of {name} at a time{or_less}: {text}"),
            Of::Level { .. } => format!("start with {amount} of {name}{or_less}: {text}"),
        };
        Some(Fix { label, edits: self.edits(text) })
    }

    fn amount(&self, steps: i64) -> Option<String> {
        let more = self.unit.checked_mul(Rational::from_integer(steps))?;
        self.present.checked_add(more)?.decimal()
    }

    /// The declaration with so many units more; if wanted, of a reservoir that has room for everything.
    fn declaration(&self, steps: i64, has_room: bool) -> Option<String> {
        let (amount, name) = (self.amount(steps)?, &self.name);
        Some(match &self.of {
            Of::Capacity => format!("resource {name} capacity {amount};"),
            Of::Level { least, greatest, unbounded } => {
                let greatest = if has_room { unbounded } else { greatest };
                format!("resource {name} {least} .. {greatest} = {amount};")
            }
        })
    }

    fn edits(&self, text: String) -> Vec<Edit> {
        vec![Edit { span: self.span, text }]
    }
}

/// The largest amount of which all that is used of a resource, and all its bounds' distance, are whole multiples.
fn unit(network: &Network, id: ResourceId, resource: &Resource) -> Option<Rational> {
    let of_meters = Rational::new(1, PARTS_OF_A_METER)?;
    let mut unit = Rational::ZERO;
    for used in network.uses.iter().filter(|used| used.resource == id) {
        unit = unit.common_part(used.amount)?.common_part(used.per_meter.checked_mul(of_meters)?)?;
    }
    if let Supply::Reservoir { least, greatest, .. } = resource.supply {
        let asked = network.uses.iter().filter(|used| used.resource == id).filter_map(|used| used.level);
        for level in asked.map(|level| level.bound).chain([greatest]) {
            let above = level.checked_sub(least)?;
            unit = unit.common_part(if above.is_negative() { above.checked_neg()? } else { above })?;
        }
    }
    (!unit.is_zero()).then_some(unit)
}

/// Returns whether a reservoir with this level has too little for `uses`, not too much.
fn is_short(uses: &[&Use], mut lowest: Rational, level: Rational) -> Option<bool> {
    let mut after = level;
    let mut counts_meters = false;
    for used in uses {
        if let Some(level) = used.level.filter(|level| level.order.is_minimum()) {
            lowest = lowest.max(level.bound);
        }
        after = match used.change {
            Change::Produces => after.checked_add(used.at_least)?,
            Change::Consumes => after.checked_sub(used.amount)?,
            Change::Uses => after,
        };
        counts_meters |= used.change == Change::Consumes && used.per_meter.is_positive();
    }
    Some(after < lowest || counts_meters)
}

/// The least number of steps, from 1 to `most`, with which there is a plan, where there is one with more; and whether it is known
/// that there is none with one step less. There is none without a step. `None` if there is no plan with the most, or no
/// one knows.
fn least(most: i64, verdict: &mut dyn FnMut(i64) -> Verdict) -> Option<(i64, bool)> {
    if most < 1 || verdict(most) != Verdict::Plan {
        return None;
    }
    let (mut fails, mut plans, mut is_proven) = (0, most, true);
    // What is missing is little more often than much.
    let mut reach = 1;
    while plans - fails > 1 {
        let middle = fails + (plans - fails) / 2;
        let next = middle.min(fails + reach);
        match verdict(next) {
            Verdict::Plan => (plans, reach) = (next, i64::MAX / 2 - most),
            said => {
                (fails, is_proven) = (next, said == Verdict::NoPlan);
                reach = reach.saturating_mul(2).min(i64::MAX / 2 - most);
            }
        }
    }
    Some((plans, is_proven))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what comes of looking for the least of some steps, with the numbers of steps that were looked at.
    fn found(most: i64, mut verdict: impl FnMut(i64) -> Verdict) -> (Option<(i64, bool)>, usize) {
        let mut looks = 0;
        let found = least(most, &mut |steps| {
            looks += 1;
            verdict(steps)
        });
        (found, looks)
    }

    #[test]
    fn the_least_is_found_in_few_looks() {
        for most in [1, 2, 3, 7, 100, 1_000_000] {
            for least in [1, 2, 3, 5, 50, 99, 100, 999_999].into_iter().filter(|least| *least <= most) {
                let at = |steps| if steps >= least { Verdict::Plan } else { Verdict::NoPlan };
                let (found, looks) = found(most, at);
                assert_eq!(found, Some((least, true)), "{least} of {most}");
                assert!(looks <= 45, "{looks} looks for {least} of {most}");
            }
        }
        assert_eq!(found(100, |steps| if steps >= 1 { Verdict::Plan } else { Verdict::NoPlan }).1, 2);
    }

    #[test]
    fn nothing_is_called_least_that_is_not_known_to_be() {
        let at = |steps| match steps {
            ..5 => Verdict::NoPlan,
            5..8 => Verdict::Unknown,
            _ => Verdict::Plan,
        };
        assert_eq!(found(100, at).0, Some((8, false)));
        assert_eq!(found(100, |_| Verdict::Unknown).0, None);
        assert_eq!(found(100, |_| Verdict::NoPlan).0, None);
        assert_eq!(found(0, |_| Verdict::Plan).0, None);
    }
}

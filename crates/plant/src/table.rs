//! Constraints of modes as flat tables, so that the usual ones are enforced in one pass over a few words.

use serde::{Deserialize, Serialize};

use crate::formula::{Formula, conjunction};
use crate::value_set::ValueSet;

/// A constraint as clauses, of each of which one alternative has to hold, which is a conjunction of memberships.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Table {
    /// The memberships of all alternatives of all clauses, in a row.
    members: Vec<Member>,
    /// How many clauses there are.
    clauses: u32,
}

/// That a symbol has one of some values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Member {
    pub(crate) symbol: u32,
    ends: Ends,
    pub(crate) set: ValueSet,
}

/// What ends with a membership.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Ends {
    Nothing,
    Alternative,
    Clause,
}

/// What the values that are left make of a clause.
pub(crate) enum Clause<'table> {
    /// It holds whatever is chosen.
    True,
    /// It cannot hold.
    False,
    /// It holds only if these memberships do.
    Needs(&'table [Member]),
    /// There are several ways for it to hold.
    Open,
}

impl Table {
    /// The table of a constraint; `None` if it is nested deeper than a table can say, or says nothing or too much.
    pub(crate) fn new(formula: &Formula) -> Option<Self> {
        let mut table = Self::default();
        match formula {
            Formula::All(clauses) => clauses.iter().try_for_each(|clause| table.add_clause(clause))?,
            clause => table.add_clause(clause)?,
        }
        Some(table)
    }

    fn add_clause(&mut self, clause: &Formula) -> Option<()> {
        let before = self.members.len();
        match clause {
            Formula::Constant(true) => return Some(()),
            Formula::Any(alternatives) => {
                alternatives.iter().try_for_each(|alternative| self.add_alternative(alternative))?;
            }
            alternative => self.add_alternative(alternative)?,
        }
        // A clause that can never hold has no members that could tell so.
        self.members.get_mut(before..)?.last_mut()?.ends = Ends::Clause;
        self.clauses += 1;
        Some(())
    }

    fn add_alternative(&mut self, alternative: &Formula) -> Option<()> {
        let parts = match alternative {
            Formula::All(parts) => parts.as_slice(),
            part => std::slice::from_ref(part),
        };
        let mut members = Vec::new();
        for part in parts {
            let Formula::Member { symbol, set } = part else { return None };
            let Some(both) = conjunction(&members, &[(*symbol, *set)]) else { return Some(()) };
            members = both;
        }
        let members = members.into_iter().map(|(symbol, set)| Member { symbol, ends: Ends::Nothing, set });
        self.members.extend(members);
        // One that always holds has no members either.
        let last = if parts.is_empty() { None } else { self.members.last_mut() };
        last?.ends = Ends::Alternative;
        Some(())
    }

    /// Returns whether there is only one clause; all have to hold.
    pub(crate) const fn is_single(&self) -> bool {
        self.clauses == 1
    }

    /// Returns what `domains` make of the clause whose members start at `start`, and where the next one starts.
    #[inline]
    pub(crate) fn clause(&self, start: usize, domains: &[ValueSet]) -> Option<(Clause<'_>, usize)> {
        let members = self.members.get(start..)?;
        let (mut first, mut misses, mut exceeds) = (0, false, ValueSet::EMPTY);
        let (mut is_true, mut possible, mut needed) = (false, 0_u32, 0..0);
        for (at, member) in members.iter().enumerate() {
            let domain = domains[member.symbol as usize];
            misses |= (domain & member.set).is_empty();
            exceeds |= domain & !member.set;
            if member.ends == Ends::Nothing {
                continue;
            }
            if !misses {
                is_true |= exceeds.is_empty();
                possible += 1;
                needed = first..at + 1;
            }
            (first, misses, exceeds) = (at + 1, false, ValueSet::EMPTY);
            if member.ends == Ends::Clause {
                let clause = match possible {
                    _ if is_true => Clause::True,
                    0 => Clause::False,
                    1 => Clause::Needs(&members[needed]),
                    _ => Clause::Open,
                };
                return Some((clause, start + at + 1));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Truth;

    fn values(bits: u64) -> ValueSet {
        (0..64).filter(|value| bits >> value & 1 == 1).collect()
    }

    /// The values are the bits of `set`.
    fn member(symbol: u32, set: u64) -> Formula {
        Formula::Member { symbol, set: values(set) }
    }

    /// Every clause of three symbols with two values each, under all domains that are not empty.
    #[test]
    fn clauses_are_as_true_as_the_constraint_they_come_from() {
        let formula = Formula::All(vec![
            Formula::Any(vec![
                Formula::All(vec![member(0, 1), member(1, 1)]),
                Formula::All(vec![member(0, 2), member(1, 2)]),
            ]),
            member(2, 2),
            Formula::Any(vec![member(0, 2), Formula::All(vec![member(1, 1), member(2, 1)])]),
        ]);
        let Formula::All(parts) = &formula else { panic!("a conjunction") };
        let table = Table::new(&formula).expect("flat enough");
        assert_eq!(table.clauses, 3);
        for code in 0..27_u64 {
            let domains = [code % 3 + 1, code / 3 % 3 + 1, code / 9 + 1].map(values);
            let mut start = 0;
            for part in parts {
                let truth = part.truth(&domains);
                let (clause, next) = table.clause(start, &domains).expect("a clause for each part");
                match clause {
                    Clause::True => assert_eq!(truth, Truth::True, "{part:?} {domains:?}"),
                    Clause::False => assert_eq!(truth, Truth::False, "{part:?} {domains:?}"),
                    Clause::Needs(_) | Clause::Open => assert_eq!(truth, Truth::Open, "{part:?} {domains:?}"),
                }
                start = next;
            }
            assert!(table.clause(start, &domains).is_none());
        }
    }

    #[test]
    fn what_is_nested_deeper_has_no_table() {
        let inner = Formula::Any(vec![member(0, 1), member(1, 1)]);
        let deep = Formula::Any(vec![Formula::All(vec![inner, member(2, 1)]), member(2, 2)]);
        assert!(Table::new(&deep).is_none());
    }
}

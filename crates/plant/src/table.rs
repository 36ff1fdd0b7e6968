//! Constraints of modes as flat tables, so that the usual ones are enforced in one pass over a few words.

use serde::{Deserialize, Serialize};

use crate::formula::{Formula, conjunction};

/// A constraint as clauses, of each of which one alternative has to hold, which is a conjunction of memberships.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Table {
    /// Symbols with the values that they may have.
    members: Vec<(u32, u64)>,
    /// Where each alternative ends among the members.
    alternatives: Vec<u32>,
    /// Where each clause ends among the alternatives.
    clauses: Vec<u32>,
}

/// What the values that are left make of a clause.
pub(crate) enum Clause<'table> {
    /// It holds whatever is chosen.
    True,
    /// It cannot hold.
    False,
    /// It holds only if these memberships do.
    Needs(&'table [(u32, u64)]),
    /// There are several ways for it to hold.
    Open,
}

impl Table {
    /// The table of a constraint; `None` if it is nested deeper than a table can say.
    pub(crate) fn new(formula: &Formula) -> Option<Self> {
        let mut table = Self::default();
        match formula {
            Formula::All(clauses) => clauses.iter().try_for_each(|clause| table.add_clause(clause))?,
            clause => table.add_clause(clause)?,
        }
        Some(table)
    }

    fn add_clause(&mut self, clause: &Formula) -> Option<()> {
        match clause {
            Formula::Constant(true) => return Some(()),
            Formula::Constant(false) => {}
            Formula::Any(alternatives) => {
                alternatives.iter().try_for_each(|alternative| self.add_alternative(alternative))?;
            }
            alternative => self.add_alternative(alternative)?,
        }
        self.clauses.push(self.alternatives.len() as u32);
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
        self.members.append(&mut members);
        self.alternatives.push(self.members.len() as u32);
        Some(())
    }

    /// How many clauses there are; all have to hold.
    pub(crate) const fn clause_count(&self) -> usize {
        self.clauses.len()
    }

    /// What `domains` make of a clause.
    pub(crate) fn clause(&self, at: usize, domains: &[u64]) -> Clause<'_> {
        let first = at.checked_sub(1).map_or(0, |before| self.clauses[before] as usize);
        let mut start = first.checked_sub(1).map_or(0, |before| self.alternatives[before] as usize);
        let mut possible = None;
        let mut is_open = false;
        for &end in &self.alternatives[first..self.clauses[at] as usize] {
            let members = &self.members[start..end as usize];
            start = end as usize;
            let (mut misses, mut exceeds) = (false, 0);
            for &(symbol, set) in members {
                let domain = domains[symbol as usize];
                misses |= domain & set == 0;
                exceeds |= domain & !set;
            }
            if misses {
                continue;
            }
            if exceeds == 0 {
                return Clause::True;
            }
            is_open |= possible.is_some();
            possible = Some(members);
        }
        match possible {
            _ if is_open => Clause::Open,
            Some(members) => Clause::Needs(members),
            None => Clause::False,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Truth;

    fn member(symbol: u32, set: u64) -> Formula {
        Formula::Member { symbol, set }
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
        assert_eq!(table.clause_count(), 3);
        for code in 0..27_u64 {
            let domains = [code % 3 + 1, code / 3 % 3 + 1, code / 9 + 1];
            for (at, part) in parts.iter().enumerate() {
                let truth = part.truth(&domains);
                match table.clause(at, &domains) {
                    Clause::True => assert_eq!(truth, Truth::True, "{at} {domains:?}"),
                    Clause::False => assert_eq!(truth, Truth::False, "{at} {domains:?}"),
                    Clause::Needs(_) | Clause::Open => assert_eq!(truth, Truth::Open, "{at} {domains:?}"),
                }
            }
        }
    }

    #[test]
    fn what_is_nested_deeper_has_no_table() {
        let inner = Formula::Any(vec![member(0, 1), member(1, 1)]);
        let deep = Formula::Any(vec![Formula::All(vec![inner, member(2, 1)]), member(2, 2)]);
        assert!(Table::new(&deep).is_none());
    }
}

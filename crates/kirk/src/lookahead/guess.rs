//! Guessed links: a second network in which each requirement is carried by some assertion, as far as all can be at once.
//!
//! A requirement can be carried as long as its guess stands, so that it need not be looked at after every choice, and the
//! schedule need not be moved to and fro for one requirement after the other. Guesses are no consequences of the
//! choices: they give way to whatever contradicts them, and no conflict rests on them.

use stn::{Inconsistency, Overflow, PointId};
use tpn::LabelId;

use super::{GuideOrigin, Lookahead, Origin, link_edges};
use crate::model::Model;
use crate::unplannable::Unplannable;

impl Lookahead {
    /// Guesses which assertion carries `ask`, in accord with all other guesses. `false` if none is found to.
    pub(super) fn guess_carrier(&mut self, model: &Model, ask: LabelId) -> Result<bool, Unplannable> {
        let witness = self.witness[ask];
        if let Some(witness) = witness
            && self.is_active_label[witness]
            && self.guess(model, ask, witness)?
        {
            return Ok(true);
        }
        for tell in model.conditions.supporters(ask) {
            if Some(tell) != witness
                && self.is_active_label[tell]
                && !self.refuses_link(model, ask, tell)
                && self.guess(model, ask, tell)?
            {
                self.witness[ask] = Some(tell);
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn guess(&mut self, model: &Model, ask: LabelId, tell: LabelId) -> Result<bool, Unplannable> {
        let checkpoint = self.guide.checkpoint();
        let position = self.guide.num_edges() as u32;
        for (from, to, weight) in link_edges(model, ask, tell) {
            match self.guide.insert(from, to, weight, GuideOrigin::Guess(ask).tag()) {
                Ok(()) => {}
                Err(Inconsistency::NegativeCycle) => {
                    self.guide.rollback(checkpoint);
                    return Ok(false);
                }
                Err(Inconsistency::Overflow(overflow)) => return Err(overflow.into()),
            }
        }
        self.guessed[ask] = Some(position);
        self.guesses.push(ask);
        Ok(true)
    }

    /// Adds an edge that follows from the choices; guesses that contradict it are given up.
    pub(super) fn insert(
        &mut self,
        (from, to, weight): (PointId, PointId, i64),
        origin: Origin,
    ) -> Result<(), Inconsistency> {
        self.stn.insert(from, to, weight, origin.tag())?;
        let tag = GuideOrigin::Known.tag();
        while self.guide.insert(from, to, weight, tag) == Err(Inconsistency::NegativeCycle) {
            if !self.give_up_contradicted() {
                return Err(Overflow { point: to }.into());
            }
        }
        Ok(())
    }

    /// Adds `lower ≤ to − from ≤ upper` like [`Lookahead::insert`].
    pub(super) fn constrain(
        &mut self,
        from: PointId,
        to: PointId,
        (lower, upper): (i64, Option<i64>),
        origin: Origin,
    ) -> Result<(), Inconsistency> {
        if let Some(upper) = upper {
            self.insert((from, to, upper), origin)?;
        }
        self.insert((to, from, lower.checked_neg().ok_or(Overflow { point: to })?), origin)
    }

    /// Takes back the guesses from the one at `first` on, whose edges are gone.
    pub(super) fn forget_guesses(&mut self, first: usize) {
        let num_edges = self.guide.num_edges() as u32;
        for ask in self.guesses.drain(first..) {
            let guess = &mut self.guessed[ask];
            *guess = guess.filter(|&position| position < num_edges);
        }
    }

    /// Gives up the guesses in the contradiction found last. `false` if there are none.
    fn give_up_contradicted(&mut self) -> bool {
        let mut gave_up = false;
        for position in 0..self.guide.cycle().len() {
            if let GuideOrigin::Guess(ask) = GuideOrigin::of(self.guide.cycle()[position].tag)
                && let Some(guess) = self.guessed[ask].take()
            {
                self.guide.withdraw(guess as usize);
                self.guide.withdraw(guess as usize + 1);
                gave_up = true;
            }
        }
        gave_up
    }
}

//! What a controllable plan is, played out: a game between the executive and the environment on whole numbers of ticks.
//!
//! At every instant nature ends what it likes and the executive executes what it likes, one after the other, until both
//! let time pass. The executive wins if every event has happened and every bound is kept. Nothing of the checker is here.

use std::collections::HashMap;

use exact::Bound;
use tpn::Network;

/// A bound between two events, in ticks; `is_natures` says that the environment chooses within it.
#[derive(Clone, Copy, Debug)]
struct Range {
    from: usize,
    to: usize,
    lower: i32,
    upper: i32,
    is_natures: bool,
}

/// Past the end of every game.
const NEVER: i32 = i32::MAX / 4;

type State = (Vec<Option<i32>>, i32);

pub struct Game {
    ranges: Vec<Range>,
    horizon: i32,
    /// By state at the environment's turn, and whether the executive has let time pass.
    nature: HashMap<(State, bool), bool>,
}

impl Game {
    /// Returns whether the executive has a strategy. All arcs are kept; the start happens at 0, everything by `horizon`
    /// units; there are `ticks` in a unit.
    pub fn has_strategy(network: &Network, horizon: i32, ticks: i32) -> bool {
        let whole = |time: exact::Time| {
            assert!(time.is_integer(), "a game on whole numbers");
            time.numerator() as i32 * ticks
        };
        let range = |arc: &tpn::Arc| Range {
            from: arc.from.index(),
            to: arc.to.index(),
            lower: whole(arc.lower),
            upper: match arc.upper {
                Bound::Finite(upper) => whole(upper),
                Bound::Infinite => NEVER,
            },
            is_natures: arc.is_contingent,
        };
        let ranges = network.arcs.iter().map(range).collect();
        let mut game = Self { ranges, horizon: horizon * ticks, nature: HashMap::new() };
        let mut times = vec![None; network.nodes.len()];
        times[network.start.index()] = Some(0);
        game.is_won_by_the_executive((times, 0), false)
    }

    /// Returns whether a bound can no longer be kept.
    fn is_broken(&self, (times, now): &State) -> bool {
        self.ranges.iter().filter(|range| !range.is_natures).any(|range| {
            match (times[range.from], times[range.to]) {
                (None, None) => false,
                (Some(from), None) => now - from > range.upper,
                (None, Some(to)) => to - now < range.lower,
                (Some(from), Some(to)) => to - from < range.lower || to - from > range.upper,
            }
        })
    }

    fn is_natures(&self, event: usize) -> bool {
        self.ranges.iter().any(|range| range.is_natures && range.to == event)
    }

    fn after(state: &State, event: usize) -> State {
        let mut after = state.clone();
        after.0[event] = Some(state.1);
        after
    }

    /// The environment's turn.
    fn is_won_by_the_executive(&mut self, state: State, has_passed: bool) -> bool {
        if self.is_broken(&state) {
            return false;
        }
        let key = (state, has_passed);
        if let Some(&known) = self.nature.get(&key) {
            return known;
        }
        let (state, _) = &key;
        let (times, now) = state;
        let pending: Vec<Range> = (self.ranges.iter().copied())
            .filter(|range| range.is_natures && times[range.to].is_none())
            .filter(|range| times[range.from].is_some_and(|from| now - from >= range.lower))
            .collect();
        let can_wait =
            pending.iter().all(|range| times[range.from].is_some_and(|from| now - from < range.upper));
        let is_won =
            pending.iter().all(|range| self.is_won_by_the_executive(Self::after(state, range.to), false))
                && (!can_wait || if has_passed { self.goes_on(state) } else { self.can_act(state) });
        self.nature.insert(key, is_won);
        is_won
    }

    fn can_act(&mut self, state: &State) -> bool {
        let free: Vec<usize> =
            (0..state.0.len()).filter(|&event| state.0[event].is_none() && !self.is_natures(event)).collect();
        free.into_iter().any(|event| self.is_won_by_the_executive(Self::after(state, event), false))
            || self.is_won_by_the_executive(state.clone(), true)
    }

    fn goes_on(&mut self, (times, now): &State) -> bool {
        times.iter().all(Option::is_some)
            || (*now < self.horizon && self.is_won_by_the_executive((times.clone(), now + 1), false))
    }
}

//! How likely a program is to end within some steps, computed from all its runs instead of some.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use hca::Standing;
use num_traits::{One as _, Zero as _};
use plant::{EstimateError, Interval, Probability};

use super::product::{End, Explorer, Key, Way};
use crate::model_based::closed_loop::{ClosedLoop, Knowledge};
use crate::model_based::system::System;

/// Where some runs are after the same number of steps.
struct Share {
    standing: Standing,
    closed: ClosedLoop,
    probability: Probability,
}

/// The shares of runs that are still going after the same number of steps, in the order in which they were found.
#[derive(Default)]
struct Layer {
    shares: Vec<Share>,
    places: HashMap<Key, usize>,
}

/// The probability that a program ends within `steps` steps, while components fail and choices fall by chance. Of the runs
/// that come to more than `most` different places the least likely are left open.
pub fn chance_to_end(
    system: &Arc<System>,
    knowledge: Knowledge,
    steps: u32,
    most: usize,
) -> Result<Interval, EstimateError> {
    let mut explorer = Explorer::new(system, Vec::new());
    let mut layer = Layer::default();
    let starts = explorer.starts(knowledge, most);
    let known: Probability = starts.iter().map(Way::weight).sum();
    // Starts that were left out have the rest.
    let mut open = Probability::one() - &known;
    let mut ended = layer.add(&explorer, starts, &known);
    for _ in 0..steps {
        let mut shares = layer.shares;
        shares.sort_by(|left, right| right.probability.cmp(&left.probability));
        open = shares.iter().skip(most).fold(open, |sum, share| sum + &share.probability);
        shares.truncate(most);
        layer = Layer::default();
        for share in shares {
            explorer.has_cut = false;
            let (ways, _) = explorer.ways(&share.standing, &share.closed, u32::MAX)?;
            if explorer.has_cut || ways.is_empty() {
                open += share.probability;
                continue;
            }
            ended += layer.add(&explorer, ways, &share.probability);
        }
    }
    Ok(Interval { high: &ended + open, low: ended })
}

impl Layer {
    /// Gives each of the ways from a place its share of the probability of being there, and returns that of those that end.
    fn add(&mut self, explorer: &Explorer, ways: Vec<Way>, probability: &Probability) -> Probability {
        // Modes that contradict each other are drawn again, so that the other ways share their probability.
        let weights: Vec<Probability> = ways.iter().map(Way::weight).collect();
        let total: Probability = weights.iter().sum();
        let mut ended = Probability::zero();
        if total.is_zero() {
            return ended;
        }
        for (way, weight) in ways.into_iter().zip(weights) {
            let probability = probability * weight / &total;
            match way.end() {
                Some(End::Ended) => ended += probability,
                // Such a run never ends.
                Some(End::Deadlock | End::Refuted | End::Unclear) => {}
                None => self.add_share(explorer.key(&way, 0), way, probability),
            }
        }
        ended
    }

    fn add_share(&mut self, key: Key, way: Way, probability: Probability) {
        match self.places.entry(key) {
            Entry::Occupied(place) => self.shares[*place.get()].probability += probability,
            Entry::Vacant(place) => {
                place.insert(self.shares.len());
                let (standing, closed) = way.place();
                self.shares.push(Share { standing, closed, probability });
            }
        }
    }
}

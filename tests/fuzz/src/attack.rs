//! One reader, attacked: so many mutated inputs, counted and timed.

use std::collections::BTreeSet;
use std::panic::catch_unwind;
use std::time::{Duration, Instant};

use crate::mutation::{Random, mutated};
use crate::readers::Reader;

/// Inputs that led to something new, besides the seeds, that are mutated further: of those that were read, and of others.
const MAX_POOL: usize = 2_000;

/// An input that made a reader panic.
#[derive(Clone, Debug)]
pub struct Breaking {
    pub input: Vec<u8>,
    /// How many inputs came before it.
    pub number: u64,
}

/// What became of an attack.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Inputs that were exercised.
    pub executions: u64,
    /// Inputs that were read, and not refused.
    pub read: u64,
    /// How long that took.
    pub took: Duration,
    /// Different things that inputs led to.
    pub outcomes: usize,
    /// What made the reader panic.
    pub breaking: Vec<Breaking>,
    /// The input that took longest, and how long.
    pub slowest: (Duration, Vec<u8>),
}

/// Attacks a reader with its kept inputs, its seeds, and then with mutations of these until there were `executions`.
/// `watch` is told each input before it is exercised. The same seed gives the same inputs.
pub fn attack(reader: &Reader, executions: u64, seed: u64, watch: &mut dyn FnMut(&[u8])) -> Tally {
    let mut tally = Tally::default();
    let mut seen = BTreeSet::new();
    let given: Vec<Vec<u8>> = reader.broken().into_iter().chain(reader.seeds()).collect();
    // Of what led to something new, what was read and what was refused.
    let mut found: [Vec<Vec<u8>>; 2] = [Vec::new(), Vec::new()];
    let mut random = Random::new(seed);
    let begun = Instant::now();
    while tally.executions < executions.max(given.len() as u64) {
        let known = given.get(tally.executions as usize).cloned();
        let is_known = known.is_some();
        let input = known.unwrap_or_else(|| {
            // What is given is known to be read, and what is refused leads seldom further than to other refusals.
            let pool = match random.below(8) {
                0..4 => &given,
                4..7 => &found[0],
                _ => &found[1],
            };
            let pool = if pool.is_empty() { &given } else { pool };
            let mut input = mutated(&mut random, pool, reader.words, reader.keeps_form);
            if random.below(2) == 0 {
                (reader.mend)(&mut input);
            }
            input
        });
        watch(&input);
        let started = Instant::now();
        let outcome = catch_unwind(|| (reader.exercise)(&input));
        let took = started.elapsed();
        tally.executions += 1;
        if took > tally.slowest.0 {
            tally.slowest = (took, input.clone());
        }
        match outcome {
            Ok(outcome) => {
                tally.read += u64::from(outcome.is_read);
                let is_new = seen.insert(outcome.signature);
                let pool = &mut found[usize::from(!outcome.is_read)];
                if is_new && !is_known && pool.len() < MAX_POOL {
                    pool.push(input);
                }
            }
            Err(_) => tally.breaking.push(Breaking { input, number: tally.executions - 1 }),
        }
    }
    tally.took = begun.elapsed();
    tally.outcomes = seen.len();
    tally
}

//! Random histories: no person takes a board by the dates and the places of their entries.
//!
//! What one person could reach honestly, with entries that follow all others, is allowed. Everything else that this person
//! can write must not let a group approve that could not approve before, except that it may block the history.

use std::collections::BTreeSet;

use jiff::Timestamp;
use tpn::generate::Rng;

use super::{InForce, Ruling, rules_of};
use crate::FlightRules;
use crate::check::{Check, Signature};
use crate::keys::PublicKey;
use crate::record::{Act, Entry, Said, USUAL_RULES, in_order};
use crate::record_tests::key;
use crate::seat::{self, Seat};

const PEOPLE: [&str; 4] = ["Mallory", "Ada", "Chair", "Grace"];
/// Histories that are tried; `ENROUTE_HISTORIES` sets another number.
const HISTORIES: u64 = 3000;

fn some<T: Clone>(random: &mut Rng, of: &[T]) -> T {
    of[random.below(of.len() as u64) as usize].clone()
}

fn public(name: &str) -> PublicKey {
    key(name).public()
}

fn random_rules(random: &mut Rng) -> FlightRules {
    let mut board: Vec<Seat> = Vec::new();
    for role in ["R", "S", "T"] {
        if !random.chance(40) {
            continue;
        }
        let mut seat = Seat::new(role, 1 + random.below(3) as u32);
        if random.chance(50) {
            seat.people = PEOPLE.iter().filter(|_| random.chance(40)).map(|name| public(name)).collect();
            if !seat.people.is_empty() {
                seat.approvals = seat.approvals.min(seat.people.len() as u32);
            }
        }
        board.push(seat);
    }
    if board.is_empty() {
        board.push(Seat::new("R", 1 + random.below(2) as u32));
    }
    FlightRules { board, ..FlightRules::default() }
}

/// A history that grows, with one clock.
#[derive(Clone, Default)]
struct History {
    entries: Vec<Entry>,
}

impl History {
    fn ruling(&self) -> (Vec<Entry>, Ruling) {
        let entries = in_order(self.entries.clone());
        let check = Check { signature: Signature::Valid, problem: None };
        let ruling = Ruling::new(&entries, &vec![check; entries.len()]);
        (entries, ruling)
    }

    /// The boards in force.
    fn boards(&self) -> Vec<Vec<Seat>> {
        let (entries, ruling) = self.ruling();
        let rules = |it: &InForce| it.at.and_then(|index| rules_of(&entries[index])).unwrap_or(&USUAL_RULES);
        ruling.in_force.iter().map(|it| rules(it).board.clone()).collect()
    }

    fn heads(&self) -> Vec<String> {
        let former: BTreeSet<&String> = self.entries.iter().flat_map(|it| &it.former).collect();
        let digests = self.entries.iter().map(|it| it.digest().to_owned());
        digests.filter(|digest| !former.contains(digest)).collect()
    }

    fn push(
        &mut self,
        by: &str,
        minute: i64,
        former: Vec<String>,
        rules: Option<FlightRules>,
        signs: String,
    ) {
        let act = match rules {
            Some(rules) => Act::Rules { rules },
            None => Act::Comment { about: None, to: None, text: minute.to_string() },
        };
        let time = Timestamp::from_second(1_767_225_600 + 60 * minute).expect("in range");
        let said = Said {
            by: by.to_owned(),
            mission: "Sol".to_owned(),
            history: String::new(),
            nonce: String::new(),
            key: None,
            role: String::new(),
            time: time.strftime("%Y-%m-%dT%H:%M:%SZ").to_string(),
            content_hash: String::new(),
            plan_hash: String::new(),
            rules: signs,
            acknowledged: Vec::new(),
            former,
            act,
        };
        let entry = Entry::signed(said, &key(by));
        if self.entries.iter().all(|known| known.digest() != entry.digest()) {
            self.entries.push(entry);
        }
    }

    /// Adds an entry as the program does: it follows all others, and names the rules in force.
    fn say(&mut self, by: &str, minute: i64, rules: Option<FlightRules>) {
        let signs = self.ruling().1.digests();
        self.push(by, minute, self.heads(), rules, signs);
    }
}

fn completes(board: &[Seat], people: &BTreeSet<PublicKey>) -> bool {
    seat::filled(board, &people.iter().collect()) >= seat::wanted(board)
}

/// The boards that Mallory reaches with up to `depth` honest entries.
fn reached(history: &History, minute: i64, all: &[FlightRules], depth: usize, found: &mut Vec<Vec<Seat>>) {
    if let [only] = history.boards().as_slice() {
        found.push(only.clone());
    }
    for rules in all.iter().filter(|_| depth > 0) {
        let mut next = history.clone();
        next.say("Mallory", minute, Some(rules.clone()));
        reached(&next, minute + 1, all, depth - 1, found);
    }
}

/// Returns whether entries that Mallory forged changed the board.
fn try_to_take_a_board(seed: u64) -> bool {
    let random = &mut Rng::new(seed);
    let mut honest = History::default();
    let first = random.chance(50).then(|| random_rules(random));
    honest.say(some(random, &PEOPLE), 0, first);
    let agreed: Vec<FlightRules> = (0..3).map(|_| random_rules(random)).collect();
    let mut minute = 10;
    for _ in 0..=random.below(6) {
        let rules = random.chance(85).then(|| some(random, &agreed));
        honest.say(some(random, &PEOPLE[1..]), minute, rules);
        minute += 10;
    }
    let mut all = agreed;
    all.extend((0..4).map(|_| random_rules(random)));
    let mut known: Vec<String> = all.iter().map(FlightRules::digest).collect();
    known.push(USUAL_RULES.digest());

    let mut forged = honest.clone();
    for _ in 0..=random.below(5) {
        let mut former: BTreeSet<String> = BTreeSet::from([forged.entries[0].digest().to_owned()]);
        for _ in 0..random.below(4) {
            former.insert(some(random, &forged.entries).digest().to_owned());
        }
        let time = |it: &&Entry| former.contains(it.digest());
        let latest = forged.entries.iter().filter(time).map(|it| it.time.clone()).max().expect("the first");
        let latest: Timestamp = latest.parse().expect("a time");
        let earliest = (latest.as_second() - 1_767_225_600) / 60 + 1;
        let signs = if random.chance(40) {
            format!("{} {}", some(random, &known), some(random, &known))
        } else {
            some(random, &known)
        };
        let rules = some(random, &all);
        let minute = earliest + random.below(40) as i64;
        forged.push("Mallory", minute, former.into_iter().collect(), Some(rules), signs);
    }
    if random.chance(70) {
        forged.say("Mallory", 2000, Some(some(random, &all)));
    }
    let [board] = &forged.boards()[..] else { return true };
    let before = honest.boards();
    let groups = (0..8).map(|group: usize| {
        let others = (1..PEOPLE.len()).filter(move |place| group >> (place - 1) & 1 == 1);
        others.chain([0]).map(|place| public(PEOPLE[place])).collect::<BTreeSet<_>>()
    });
    let could_not = |group: &BTreeSet<PublicKey>| !before.iter().any(|before| completes(before, group));
    let new: Vec<_> = groups.filter(|group| completes(board, group) && could_not(group)).collect();
    if !new.is_empty() {
        let mut honestly = Vec::new();
        reached(&honest, 1000, &all, 2, &mut honestly);
        for group in new {
            assert!(honestly.iter().any(|board| completes(board, &group)), "seed {seed}: {board:?}");
        }
    }
    before.as_slice() != std::slice::from_ref(board)
}

#[test]
fn no_one_takes_a_board_by_dates_and_places_of_entries() {
    let count =
        std::env::var("ENROUTE_HISTORIES").ok().and_then(|count| count.parse().ok()).unwrap_or(HISTORIES);
    let changed = (0..count).filter(|seed| try_to_take_a_board(*seed)).count() as u64;
    // Many of the forged entries have an effect, such as a block.
    assert!(changed > count / 10 && changed < count, "{changed}");
}

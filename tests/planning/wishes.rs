//! Days with more wishes than there is room for: the most that can be had, against all selections in all orders.

use acceptance::mission::network;
use kirk::{Event, Options, Outcome, Search, TreeStatus};
use tpn::generate::Rng;

/// Missions that are compared.
const MISSIONS: u64 = 300;

/// Something that would be good to have, done with the one body there is.
struct Wish {
    duration: i64,
    release: i64,
    deadline: i64,
    energy: i64,
    reward: i64,
    /// Another one, one of which at most can be chosen, is worth and takes so much.
    other: Option<(i64, i64)>,
}

struct Day {
    wishes: Vec<Wish>,
    horizon: i64,
    energy: i64,
}

impl Day {
    fn random(seed: u64) -> Self {
        let mut random = Rng::new(seed);
        let mut whole = |low: i64, high: i64| random.between(low, high);
        let count = whole(4, 7);
        let horizon = 3 * count;
        let wishes = (0..count).map(|_| {
            let duration = whole(1, 8);
            let release = whole(0, 1) * whole(0, horizon / 2);
            let deadline =
                if whole(0, 1) == 0 { horizon } else { (release + duration + whole(0, 6)).min(horizon) };
            let other = (whole(0, 3) == 0).then(|| (whole(1, 8), whole(1, 9)));
            Wish { duration, release, deadline, energy: whole(0, 5), reward: whole(1, 9), other }
        });
        Self { wishes: wishes.collect(), horizon, energy: 2 * count }
    }

    fn text(&self) -> String {
        let Self { wishes, horizon, energy } = self;
        let mut text = format!("resource Body; resource Battery 0..{energy} = {energy};\n");
        let mut branches = Vec::new();
        for (at, wish) in wishes.iter().enumerate() {
            let energy =
                if wish.energy > 0 { format!(" consumes Battery {}", wish.energy) } else { String::new() };
            text += &format!(
                "primitive Wish{at}()[{0},{0}] uses Body{energy} rewards {1};\n",
                wish.duration, wish.reward
            );
            let mut call = format!("Wish{at}()");
            if let Some((duration, reward)) = wish.other {
                text +=
                    &format!("primitive Other{at}()[{duration},{duration}] uses Body rewards {reward};\n");
                call = format!("choose {{ Wish{at}(), Other{at}() }}");
            }
            let (release, spare) = (wish.release, horizon - wish.deadline);
            // What is not chosen takes no time.
            branches
                .push(format!("{{ delay[{release},{horizon}]; optional {call}; delay[{spare},{horizon}] }}"));
        }
        format!(
            "{text}objective maximize reward;\nscenario Day[0,{horizon}] = {{ {} }}\n",
            branches.join(", ")
        )
    }

    /// The most that can be had from a time on with what is left.
    fn best(&self, left: &mut Vec<bool>, time: i64, energy: i64) -> i64 {
        let mut best = 0;
        for at in 0..self.wishes.len() {
            if !left[at] {
                continue;
            }
            left[at] = false;
            let wish = &self.wishes[at];
            let own = (wish.duration, wish.reward, wish.energy);
            let other = wish.other.map(|(duration, reward)| (duration, reward, 0));
            for (duration, reward, taken) in [own].into_iter().chain(other) {
                let over = time.max(wish.release) + duration;
                if over <= wish.deadline && taken <= energy {
                    best = best.max(reward + self.best(left, over, energy - taken));
                }
            }
            left[at] = true;
        }
        best
    }
}

fn planned(text: &str, options: &Options) -> Outcome {
    kirk::plan(&network(text), options, &mut kirk::Unlimited)
}

#[test]
fn the_most_is_made_of_every_day() {
    for seed in 0..MISSIONS {
        let day = Day::random(seed);
        let text = day.text();
        let best = day.best(&mut vec![true; day.wishes.len()], 0, day.energy);
        for search in [Search::ConflictDirected, Search::BestFirst] {
            let outcome = planned(&text, &Options { search, ..Options::default() });
            let quality = &outcome.plans[0].quality;
            assert_eq!(
                (quality.reward.to_f64(), quality.is_optimal),
                (best as f64, Some(true)),
                "seed {seed}, {search:?}\n{text}"
            );
        }
    }
}

/// Of the states that a best-first search continues with none may become better than the one after it, and none is
/// worse than the best.
#[test]
fn the_best_open_state_goes_on() {
    for seed in 0..60 {
        let day = Day::random(seed);
        let best = day.best(&mut vec![true; day.wishes.len()], 0, day.energy) as f64;
        let options =
            Options { search: Search::BestFirst, trace_events: Some(1_000_000), ..Options::default() };
        let trace = planned(&day.text(), &options).trace.expect("it was asked for");
        let visited = trace.events.iter().filter_map(|entry| match &entry.event {
            Event::Visit { values, .. } => Some(values[0].to_f64()),
            _ => None,
        });
        let visited: Vec<f64> = visited.collect();
        assert!(visited.is_sorted_by(|before, after| before >= after), "seed {seed}: {visited:?}");
        assert!(visited.last().is_some_and(|&last| last >= best), "seed {seed}: {visited:?}");
        let is_open = |node: &kirk::TreeNode| node.status == TreeStatus::Unexplored;
        assert!(
            !trace.tree.iter().any(is_open),
            "seed {seed}: nothing that is left unexplored is unexplained"
        );
    }
}

#[test]
fn a_search_that_is_stopped_tells_a_bound_that_holds() {
    for seed in 0..60 {
        let day = Day::random(seed);
        let best = day.best(&mut vec![true; day.wishes.len()], 0, day.energy) as f64;
        let text = day.text();
        for most in [0, 2, 5, 20] {
            let mut stop = |stats: &kirk::Stats| stats.conflicts > most;
            let outcome = kirk::plan(&network(&text), &Options::default(), &mut stop);
            let Some(plan) = outcome.plans.first() else { continue };
            match outcome.bound {
                Some(bound) => assert!(bound.to_f64() >= best, "seed {seed}: {bound:?} below {best}\n{text}"),
                None => assert_eq!(plan.quality.reward.to_f64(), best, "seed {seed}\n{text}"),
            }
        }
    }
}

/// So many uses of one body that not all of their orders are choice points: each starts as early as it can.
#[test]
fn a_crowd_that_has_room_is_planned_without_going_over_its_orders() {
    for count in [60, 120, 200] {
        let uses = vec!["{ delay; Use()[1,2]; delay }"; count].join(", ");
        let text =
            format!("resource Body; primitive Use() uses Body; scenario S[0,{}] = {{ {uses} }}", 10 * count);
        let network = network(&text);
        let outcome = kirk::plan(&network, &Options::default(), &mut kirk::Unlimited);
        assert!(verify::check_plan(&network, &outcome.plans[0]).valid, "{count}");
        assert!(outcome.stats.expanded < 4_000, "{count}: {:?}", outcome.stats);
    }
}

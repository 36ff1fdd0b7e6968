//! What is said of the trajectories of a step is what exact updates of single states say.

use std::collections::BTreeMap;

use plant::{
    Belief, FactoredBelief, Interval, Model, Observation, Probability, Random, SimulatedPlant, State, groups,
    step_branches, update_exact,
};

use crate::estimation::{model, random_model};

/// Returns what follows from one state: the probabilities before the observation, and whether it can be made.
fn successors(
    model: &Model,
    state: &State,
    commands: &plant::Commands,
    observation: &Observation,
) -> BTreeMap<State, (Probability, bool)> {
    let certain = Belief::certain(state.clone());
    let all = update_exact(model, &certain, commands, &Observation::default()).expect("successors");
    let seen = update_exact(model, &certain, commands, observation).ok();
    let is_seen = |state: &State| seen.iter().flat_map(Belief::states).any(|(known, _)| known == state);
    all.states()
        .map(|(state, share)| {
            (state.clone(), (share.exact().expect("nothing is dropped").clone(), is_seen(state)))
        })
        .collect()
}

#[test]
fn trajectories_end_where_exact_updates_of_their_states_end() {
    let (mut ended, mut kept, mut alone) = (0, 0, 0);
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let model = std::sync::Arc::new(model(&random_model(&mut random)));
        let groups = groups(&model);
        let mut plant = SimulatedPlant::new(&model, None);
        let mut belief = FactoredBelief::certain(&groups, &model.initial_state());
        for step in 0..3 {
            let mut commands = model.idle();
            for (value, variable) in commands.0.iter_mut().zip(&model.command_variables) {
                *value = random.below(variable.values.len() as u64) as u8;
            }
            plant.step_with_chance(&commands, &BTreeMap::new(), &mut random).expect("a step");
            let observation = plant.observation();
            let each = groups.iter().zip(belief.beliefs()).map(|(group, belief)| {
                let (commands, seen) = (group.commands(&commands), group.observation(&observation));
                std::sync::Arc::new(update_exact(&group.model, belief, &commands, &seen).expect("an update"))
            });
            let after = FactoredBelief::new(&groups, each.collect());
            let found =
                step_branches(&model, &belief, &commands, &observation, Some(&after)).expect("targets");
            let before: Vec<(State, Interval)> = belief.states().collect();
            let next: Vec<BTreeMap<State, (Probability, bool)>> =
                before.iter().map(|(state, _)| successors(&model, state, &commands, &observation)).collect();
            assert_eq!(found.dropped.exact(), Some(&Probability::default()), "seed {seed} step {step}");
            for ((state, _), branch) in after.states().zip(&found.kept) {
                let shares = before.iter().zip(&next).take(64);
                let shares: Vec<bool> = shares.map(|(_, next)| next.contains_key(&state)).collect();
                let from = branch.from.expect("every state comes from one");
                assert!(shares[from], "seed {seed} step {step}");
                // It comes from there most likely.
                let joint = |from: usize| {
                    let share = next[from].get(&state).map(|(share, _)| share.clone()).unwrap_or_default();
                    before[from].1.exact().expect("nothing is dropped") * share
                };
                let most = (0..shares.len()).map(joint).max().expect("a state");
                assert_eq!(joint(from), most, "seed {seed} step {step}");
                assert_eq!(branch.others + 1, shares.iter().filter(|can| **can).count(), "seed {seed}");
                kept += 1;
            }
            for one in &found.ruled_out {
                let (share, is_seen) = &next[one.from][&one.state];
                assert!(!is_seen, "seed {seed} step {step}: {one:?} can be observed");
                let expected = before[one.from].1.exact().expect("nothing is dropped") * share;
                assert_eq!(one.probability, Some(Interval::certain(expected)), "seed {seed} step {step}");
                assert!(!one.by.is_empty() && one.by.iter().all(|id| observation.0.contains_key(id)));
                let is_alone = one.by.iter().all(|id| {
                    let only = Observation(BTreeMap::from([(*id, observation.0[id])]));
                    !successors(&model, &before[one.from].0, &commands, &only)[&one.state].1
                });
                alone += usize::from(is_alone);
                ended += 1;
            }
            let shares: Vec<&Interval> =
                found.ruled_out.iter().filter_map(|one| one.probability.as_ref()).collect();
            assert!(shares.is_sorted_by(|left, right| left.high >= right.high), "seed {seed} step {step}");
            // All that ended is told of, as far as there is room.
            let all = next.iter().take(6).flat_map(BTreeMap::values).filter(|(_, is_seen)| !is_seen).count();
            assert_eq!(found.ruled_out.len(), all.min(6), "seed {seed} step {step}");
            belief = after;
        }
    }
    assert!(ended > 100 && kept > 200 && alone > 50, "{ended} {kept} {alone}");
}

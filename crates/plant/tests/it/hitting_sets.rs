//! Conflicts and hitting-set trees, on random models: against enumeration of all sets of assumptions and all values.

use plant::hitting_sets::{HittingLabel, HittingMove, HittingTree, Refusal};
use plant::{ComponentId, Model, Observation, Random, State, conflicts};

use crate::estimation::{admitted_observations, model, random_model};

/// Returns whether the modes of these components and an observation can hold together, by trying all values of all
/// variables. Of the other components nothing is assumed.
fn can_hold(model: &Model, modes: &State, assumed: &[ComponentId], observation: &Observation) -> bool {
    let mut free = model.clone();
    for (at, component) in free.components.iter_mut().enumerate() {
        if !assumed.contains(&ComponentId(at as u32)) {
            for mode in &mut component.modes {
                mode.constraint = plant::Formula::Constant(true);
            }
        }
    }
    // Constraints may name modes of components of which nothing is assumed: these can be in any mode.
    let counts: Vec<u8> = model.components.iter().map(|component| component.modes.len() as u8).collect();
    let observed: Vec<u8> = observation.0.values().copied().collect();
    crate::estimation::assignments(&counts).into_iter().any(|candidate| {
        let is_as_assumed = assumed.iter().all(|id| candidate[id.0 as usize] == modes.0[id.0 as usize]);
        is_as_assumed && admitted_observations(&free, &candidate, observation).contains(&observed)
    })
}

/// All minimal sets of components without whose assumptions the others can hold.
fn by_enumeration(model: &Model, modes: &State, observation: &Observation) -> Vec<Vec<ComponentId>> {
    let all: Vec<ComponentId> = model.component_ids().collect();
    let mut sets: Vec<Vec<ComponentId>> = (0_u32..1 << all.len())
        .map(|bits| all.iter().copied().filter(|id| bits >> id.0 & 1 == 1).collect())
        .collect();
    sets.sort_by_key(Vec::len);
    let mut minimal: Vec<Vec<ComponentId>> = Vec::new();
    for set in sets {
        let others: Vec<ComponentId> = all.iter().copied().filter(|id| !set.contains(id)).collect();
        let is_covered = minimal.iter().any(|known| known.iter().all(|id| set.contains(id)));
        if !is_covered && can_hold(model, modes, &others, observation) {
            minimal.push(set);
        }
    }
    minimal.sort();
    minimal
}

fn found(tree: &HittingTree) -> Vec<Vec<ComponentId>> {
    let mut found: Vec<Vec<ComponentId>> = tree.diagnoses().map(|(_, set)| set.to_vec()).collect();
    found.sort();
    found
}

/// Random models with what was observed of them, where that contradicts the expected modes.
fn cases() -> impl Iterator<Item = (u64, Model, State, Observation)> {
    (0..120).filter_map(|seed| {
        let mut random = Random::new(seed);
        let model = model(&random_model(&mut random));
        // Of more components there are too many assignments to try them all.
        if model.components.len() > 4 {
            return None;
        }
        let modes = model.initial_state();
        let names: Vec<(String, String)> = (model.variables.iter())
            .filter(|variable| variable.observable)
            .map(|variable| {
                let value = random.below(variable.values.len() as u64) as usize;
                (variable.name.to_string(), variable.values[value].to_string())
            })
            .collect();
        let pairs = names.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        let observation = model.observation_from_names(pairs).expect("names");
        let all: Vec<ComponentId> = model.component_ids().collect();
        // Some observations nothing can explain, whatever is assumed.
        let is_case =
            !can_hold(&model, &modes, &all, &observation) && can_hold(&model, &modes, &[], &observation);
        is_case.then_some((seed, model, modes, observation))
    })
}

#[test]
fn conflicts_cannot_hold_and_their_parts_can() {
    let mut count = 0;
    for (seed, model, modes, observation) in cases() {
        let found = conflicts(&model, &modes, &model.idle(), &observation, 64).expect("deterministic");
        assert!(!found.is_empty(), "seed {seed}");
        for conflict in found {
            let assumed: Vec<ComponentId> = conflict.modes.iter().map(|(id, _)| *id).collect();
            assert!(!can_hold(&model, &modes, &assumed, &observation), "seed {seed}: {conflict:?}");
            for leave in &assumed {
                let part: Vec<ComponentId> = assumed.iter().copied().filter(|id| id != leave).collect();
                assert!(can_hold(&model, &modes, &part, &observation), "seed {seed}: {conflict:?}");
            }
            count += 1;
        }
    }
    assert!(count > 30, "{count} conflicts");
}

#[test]
fn finished_trees_have_exactly_the_minimal_diagnoses_in_whatever_order_they_are_built() {
    let (mut trees, mut larger) = (0, 0);
    for (seed, model, modes, observation) in cases() {
        let expected = by_enumeration(&model, &modes, &observation);
        // The search for conflicts may end before it has all: the tree finds the others.
        for most in [1, 64] {
            let listed = conflicts(&model, &modes, &model.idle(), &observation, most).expect("deterministic");
            let mut tree = HittingTree::new(listed.clone());
            let mut by_level = HittingTree::new(listed);
            let mut random = Random::new(seed + 7);
            while !tree.is_finished() {
                let open: Vec<usize> = (0..tree.nodes().len())
                    .filter(|&at| tree.nodes()[at].label == HittingLabel::Open)
                    .collect();
                let at = open[random.below(open.len() as u64) as usize];
                let expansions = (0..tree.conflicts().len()).map(HittingMove::Expand);
                let moves = [HittingMove::Close, HittingMove::Diagnose].into_iter().chain(expansions);
                for step in moves {
                    if tree.apply(at, step, &model, &modes, &observation).is_ok() {
                        break;
                    }
                }
            }
            assert_eq!(found(&tree), expected, "seed {seed}");
            while let Some((at, step)) = by_level.next_move() {
                match by_level.apply(at, step, &model, &modes, &observation) {
                    Ok(()) => {}
                    Err(Refusal::Contradicts(_)) => assert_eq!(most, 1, "seed {seed}: all were listed"),
                    Err(refusal) => panic!("seed {seed}: {refusal:?}"),
                }
            }
            assert_eq!(found(&by_level), expected, "seed {seed}, level by level");
            trees += 1;
            larger += usize::from(expected.iter().any(|set| set.len() > 1));
        }
    }
    assert!(trees > 20 && larger > 4, "{trees} trees, {larger} with a diagnosis of several components");
}

#[test]
fn what_is_wrong_is_refused_with_the_reason() {
    let model = model(
        "(DEFCLASS Source () (VAR out {off on}) (MODE Good (out = on)) (MODE Unknown true) (FAULT Good Unknown 0.01))
         (DEFCLASS Lamp () (PORT from Source) (VAR light {dark lit} OBSERVABLE)
           (MODE Good (((from.out = on) AND (light = lit)) OR ((from.out = off) AND (light = dark))))
           (MODE Unknown true) (FAULT Good Unknown 0.01))
         (DEFINSTANCE s Source) (DEFINSTANCE a Lamp (from s)) (DEFINSTANCE b Lamp (from s))",
    );
    let observation = model.observation_from_names([("a.light", "dark"), ("b.light", "lit")]).expect("names");
    let modes = model.initial_state();
    let found = conflicts(&model, &modes, &model.idle(), &observation, 8).expect("deterministic");
    let [s, a, b] = [0, 1, 2].map(ComponentId);
    let sets: Vec<Vec<ComponentId>> =
        found.iter().map(|it| it.modes.iter().map(|(id, _)| *id).collect()).collect();
    assert_eq!(sets, [vec![s, a], vec![a, b]]);
    let mut tree = HittingTree::new(found);
    let mut apply = |at: usize, step: HittingMove| tree.apply(at, step, &model, &modes, &observation);
    assert_eq!(apply(0, HittingMove::Close), Err(Refusal::NothingCovers));
    assert!(matches!(apply(0, HittingMove::Diagnose), Err(Refusal::Contradicts(_))));
    assert_eq!(apply(0, HittingMove::Expand(7)), Err(Refusal::Unknown));
    assert_eq!(apply(0, HittingMove::Expand(0)), Ok(()));
    assert_eq!(apply(0, HittingMove::Expand(1)), Err(Refusal::Unknown), "it is not open");
    // Node 1 is without the source, node 2 without lamp a.
    assert_eq!(apply(1, HittingMove::Diagnose), Err(Refusal::Contradicts(1)));
    assert_eq!(apply(2, HittingMove::Expand(1)), Err(Refusal::IsHit(a)));
    assert_eq!(apply(1, HittingMove::Expand(1)), Ok(()));
    // Depth first: {source, a} is marked before its part {a} is.
    assert_eq!(apply(3, HittingMove::Diagnose), Ok(()));
    assert_eq!(apply(2, HittingMove::Diagnose), Ok(()));
    assert_eq!(apply(4, HittingMove::Diagnose), Ok(()));
    assert_eq!(tree.nodes()[3].label, HittingLabel::Closed { by: 2 });
    assert!(tree.is_finished());
    let diagnoses: Vec<&[ComponentId]> = tree.diagnoses().map(|(_, set)| set).collect();
    assert_eq!(diagnoses, [&[a][..], &[s, b]]);
}

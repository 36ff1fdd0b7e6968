//! What is counted of a search is the same wherever it stands: in the plan, as the command line prints it, in the record
//! that the search tree draws, and in what the page tells a host.

use kirk::Status;
use test_support::start;
use tpn::generate::{Recipe, Tightness, mission};
use workbench::command::Command;
use workbench::state::search::Counts;
use workbench::state::settings::SettingsCommand;
use workbench::workspace::Workspace;

/// The missions of the page, and random ones that have no plan or barely one.
fn missions() -> Vec<(String, String)> {
    let examples =
        ["backjump", "negative-cycle", "threats", "causal-links", "battery", "sol", "fleet", "exploration"];
    let mut missions: Vec<(String, String)> = Vec::new();
    for name in examples {
        let mut app = start();
        app.run(Command::OpenExample(name.into()));
        missions.push((name.to_owned(), app.session.state().document.text().to_owned()));
    }
    for (tightness, word) in [(Tightness::Infeasible, "infeasible"), (Tightness::Boundary, "boundary")] {
        for seed in 0..6 {
            missions.push((format!("{word} {seed}"), mission(Recipe { nodes: 40, tightness, seed })));
        }
    }
    missions
}

#[test]
fn what_is_counted_of_a_search_is_the_same_wherever_it_stands() {
    let (mut jumps, mut without_plan) = (0, 0);
    for (name, source) in missions() {
        let mut app = start();
        app.run(Command::ShowWorkspace(Workspace::Teach));
        app.run(Command::SetSource(source));
        for search in kirk::Search::ALL {
            app.run(Command::Settings(SettingsCommand::SetSearch(search)));
            let name = format!("{name}, {search:?}");
            let state = app.session.state();
            let shown = state.shown().expect("a snapshot");
            let planning = shown.planning.as_deref().expect("a plan, or why there is none");
            let stats = planning.outcome.stats;
            without_plan += usize::from(planning.outcome.status == Status::NoPlan);
            let recordings = state.search.recordings(Some(shown));
            let [recording] = recordings.as_slice() else { panic!("{name}: one search is recorded") };
            assert!(!recording.trace().is_truncated, "{name}");
            let counts = Counts::of(recording.trace());
            let counted = [counts.states - 1, counts.backtracks, counts.failures].map(u64::from);
            assert_eq!(counted, [stats.expanded, stats.backtracks, stats.conflicts], "{name}");
            assert_eq!(counts, Counts::until(recording.trace(), recording.steps()), "{name}");
            let is_jump = |entry: &kirk::Entry| matches!(entry.event, kirk::Event::Backjump { .. });
            jumps += recording.trace().events.iter().filter(|entry| is_jump(entry)).count();
        }
    }
    assert!(jumps > 10 && without_plan > 10, "{jumps} jumps, {without_plan} without a plan");
}

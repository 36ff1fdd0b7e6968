//! The parallel branches of a program, and what has happened of a plan.

use layout::Progress;
use layout::threads::{thread_name, threads};
use tpn::{Network, Top};

use crate::plans::earliest_plan;

const MISSION: &str = "primitive A(); primitive B(); primitive C(); primitive D();
scenario S = { A()[1,2]; { B()[3,4], { C()[5,6]; { D()[1,1], A()[2,2] } } }; B()[1,1] }";

fn compiled() -> Network {
    let (network, diagnostics) = tpn::compile(&rmpl::parse(MISSION).program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

#[test]
fn threads_are_numbered_as_they_are_nested_and_named_for_what_comes_first_in_them() {
    let network = compiled();
    let threads = threads(&network);
    let names: Vec<_> = (0..threads.len()).filter_map(|at| thread_name(&network, &threads[at..])).collect();
    assert_eq!(
        names[1..],
        ["Thread 1 · B", "Thread 2 · C", "Thread 2.1 · D", "Thread 2.2 · A"],
        "after what lies outside: {names:?}"
    );
    let all: usize = threads.iter().map(|thread| thread.occurrences.len()).sum();
    let mut seen: Vec<_> = threads.iter().flat_map(|thread| &thread.occurrences).collect();
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), all, "nothing is in two threads");
}

#[test]
fn at_a_moment_some_events_have_happened_and_some_arcs_are_under_way() {
    let network = compiled();
    let plan = &earliest_plan(&network, None);
    let name = |arc: tpn::ArcId| {
        let occurrence = network.arcs[arc.index()].occurrence?;
        Some(network.occurrences[occurrence.index()].name.to_string())
    };
    // As early as can be: A from 0 to 1, B from 1 to 4, C from 1 to 6.
    let progress = Progress::at(&network, plan, 2.5);
    let mut under_way: Vec<_> =
        progress.under_way.iter().filter_map(|&(arc, part)| Some((name(arc)?, part))).collect();
    under_way.sort_by(|left, right| left.0.cmp(&right.0));
    under_way.retain(|(name, _)| !name.starts_with("scenario"));
    assert_eq!(under_way, [("B#1".to_owned(), 0.5), ("C#1".to_owned(), 0.3)]);
    let ended =
        network.occurrences.iter().filter(|it| progress.done.contains(&it.end)).map(|it| it.name.as_str());
    assert_eq!(ended.collect::<Vec<_>>(), ["A#1"]);
    assert_eq!(Progress::at(&network, plan, -1.0), Progress::default());
    let last = Progress::at(&network, plan, 1e9);
    assert_eq!((last.done.len(), last.under_way.len()), (network.nodes.len(), 0));
}

//! Both searches of one network, recorded and measured, for showing side by side.

use kirk::{Options, Search, Stats};
use link::{BothSearches, Searched};
use tpn::Network;

use crate::host::CoreHost;

/// Alternatives after which a search of a network with one node would be stopped. Larger networks take longer for each,
/// and get less in proportion.
const MAX_WORK: u64 = 20_000_000;
/// Every network gets as many alternatives.
const MIN_ALTERNATIVES: u64 = 2_000;
/// None gets more.
const MAX_ALTERNATIVES: u64 = 200_000;

/// Searches `network` both ways, recording up to `trace_events` events of each. `None` when superseded.
pub fn search(
    network: &Network,
    revision: u64,
    trace_events: usize,
    host: &mut dyn CoreHost,
) -> Option<BothSearches> {
    let first = searched(network, Search::Chronological, trace_events, host)?;
    let second = searched(network, Search::ConflictDirected, trace_events, host)?;
    Some(BothSearches { revision, searches: [first, second] })
}

fn searched(
    network: &Network,
    search: Search,
    trace_events: usize,
    host: &mut dyn CoreHost,
) -> Option<Searched> {
    let options = Options {
        search,
        trace_events: Some(trace_events),
        explain: false,
        relax: false,
        ..Options::default()
    };
    let nodes = network.nodes.len().max(1) as u64;
    let most = (MAX_WORK / nodes).clamp(MIN_ALTERNATIVES, MAX_ALTERNATIVES);
    let begun = host.now_millis();
    let mut is_superseded = false;
    let outcome = kirk::plan(network, &options, &mut |stats: &Stats| {
        is_superseded |= host.is_superseded();
        is_superseded || stats.expanded >= most
    });
    if is_superseded {
        return None;
    }
    Some(Searched {
        search,
        status: outcome.status,
        stats: outcome.stats,
        millis: host.now_millis() - begun,
        trace: outcome.trace.unwrap_or_default(),
    })
}

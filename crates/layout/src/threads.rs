//! The parallel branches of a program: their numbers, their names, and what occurs in them.

use smol_str::{SmolStr, format_smolstr};
use tpn::{BlockId, BlockKind, Network, OccurrenceId};

/// A parallel branch of the program, or what lies outside all of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thread {
    /// Which branch of which: `[1, 2]` is the second branch of the first; empty outside all branches.
    pub path: Vec<u32>,
    pub block: Option<BlockId>,
    /// What occurs in it, outside its own branches, in textual order.
    pub occurrences: Vec<OccurrenceId>,
    branches: u32,
}

/// The branches of a network with structure, parents right before their branches. Linear in the structure, but for
/// sorting the branches.
pub fn threads(network: &Network) -> Vec<Thread> {
    let mut threads = vec![Thread::new(Vec::new(), None)];
    let mut pending: Vec<(BlockId, usize)> = network.root.map(|root| (root, 0)).into_iter().collect();
    while let Some((id, thread)) = pending.pop() {
        let Some(block) = network.blocks.get(id.index()) else { continue };
        match &block.kind {
            BlockKind::Leaf { arc } => {
                let arc = network.arcs.get(arc.index());
                threads[thread].occurrences.extend(arc.and_then(|arc| arc.occurrence));
            }
            BlockKind::Sequence { children } | BlockKind::Choose { alternatives: children, .. } => {
                pending.extend(children.iter().rev().map(|&child| (child, thread)));
            }
            BlockKind::Parallel { branches } => {
                let (above, first) = (threads[thread].path.clone(), threads[thread].branches + 1);
                threads[thread].branches += branches.len() as u32;
                for (number, &branch) in (first..).zip(branches) {
                    let path = above.iter().copied().chain([number]).collect();
                    threads.push(Thread::new(path, Some(branch)));
                    pending.push((branch, threads.len() - 1));
                }
            }
            BlockKind::Scope { child, occurrence, .. } => {
                threads[thread].occurrences.extend(*occurrence);
                pending.push((*child, thread));
            }
            BlockKind::Guard { child, .. } => pending.push((*child, thread)),
        }
    }
    threads.sort_by(|left, right| left.path.cmp(&right.path));
    threads
}

/// Returns what a thread is called: its number, and the first activity that occurs in it or in its own branches.
/// `following` are the threads from this one on.
pub fn thread_name(network: &Network, following: &[Thread]) -> Option<SmolStr> {
    let thread = following.first()?;
    let own = following.iter().take_while(|it| it.path.starts_with(&thread.path));
    let first = own.flat_map(|it| &it.occurrences).next()?;
    let activity = &network.occurrences.get(first.index())?.activity;
    Some(if thread.path.is_empty() {
        format_smolstr!("Main thread · {activity}")
    } else {
        format_smolstr!("Thread {} · {activity}", thread.number())
    })
}

impl Thread {
    fn new(path: Vec<u32>, block: Option<BlockId>) -> Self {
        Self { path, block, occurrences: Vec::new(), branches: 0 }
    }

    /// Its number: `1.2`.
    pub fn number(&self) -> String {
        self.path.iter().map(u32::to_string).collect::<Vec<_>>().join(".")
    }
}

//! Windows during execution (SPEC 6.2): what remains possible once some events have happened.

use crate::network::{Inconsistency, Overflow, PointId, Stn, Tag, Window};

/// What is known at a moment of execution. Times are relative to the origin.
#[derive(Clone, Copy, Debug)]
pub struct Execution<'a> {
    /// What all times are relative to.
    pub origin: PointId,
    /// Events that happened, and when.
    pub executed: &'a [(PointId, i64)],
    /// Events that are known not to have happened before `now`.
    pub pending: &'a [PointId],
    pub now: i64,
}

/// What remains possible.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExecutionWindows {
    /// The window of every point.
    Consistent(Vec<Window>),
    /// The plan is violated; the tags of the constraints that contradict each other. What was observed has the tag
    /// given by the caller.
    Violated(Vec<Tag>),
}

/// The windows of all points once `execution` has been observed; observations carry `tag`. The network is left as it
/// was.
pub fn execution_windows(
    stn: &mut Stn,
    execution: Execution<'_>,
    tag: Tag,
) -> Result<ExecutionWindows, Overflow> {
    let checkpoint = stn.checkpoint();
    let observed = execution
        .executed
        .iter()
        .try_for_each(|&(point, time)| stn.constrain(execution.origin, point, time, Some(time), tag));
    let observed = observed.and_then(|()| {
        let mut pending = execution.pending.iter();
        pending.try_for_each(|&point| stn.constrain(execution.origin, point, execution.now, None, tag))
    });
    let result = match observed {
        Ok(()) => stn.windows(execution.origin).map(ExecutionWindows::Consistent),
        Err(Inconsistency::Overflow(overflow)) => Err(overflow),
        Err(Inconsistency::NegativeCycle) => {
            Ok(ExecutionWindows::Violated(stn.cycle().iter().map(|edge| edge.tag).collect()))
        }
    };
    stn.rollback(checkpoint);
    result
}

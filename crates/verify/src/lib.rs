//! The independent checker of plans and schedules; it shares no planning code.

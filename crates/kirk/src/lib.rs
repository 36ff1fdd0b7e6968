//! The Kirk planner: selection, open conditions, threats, explanations and the search trace.

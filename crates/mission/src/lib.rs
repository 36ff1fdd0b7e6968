//! The shared planning core: one mission from text to plan to paths, as an immutable snapshot.

//! Rapidly-exploring random trees, vehicle models, kinodynamics and local avoidance.

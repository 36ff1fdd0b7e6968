//! Coordinates for drawings of plan networks and automata.

//! Hierarchical constraint automata: compilation from control programs, stepping, trace.

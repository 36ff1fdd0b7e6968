//! The integration tests of `rmpl`, in one program: each module is about one thing.

mod conformance_programs;
mod contingent;
mod copies;
mod editor_fleets;
mod editor_help;
mod editor_lasting;
mod editor_names;
mod editor_text;
mod explanations;
mod fixture;
mod formatting;
mod incremental;
mod large;
mod lasting;
mod suite;
mod written;

//! Tests of the crates together, in one program: the conformance cases, the references, the language in documents.

mod checker;
mod conformance;
mod constraints;
mod contingent;
mod contradicted;
mod controllability;
mod explanations;
mod fleets;
mod interchange;
mod language;
mod larger_missions;
mod lasting;
mod levels;
mod metamorphic;
mod missions;
mod paths;
mod records;
mod reference;
mod rmpl_text;
mod search_trees;
mod shared_resources;
mod uncertain;
mod uncertain_resources;
mod wishes;

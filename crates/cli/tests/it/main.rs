//! The integration tests of `cli`, in one program: each module is about one thing.

mod arguments;
mod attacks;
mod claims;
mod command;
mod control;
mod documents;
mod driving;
mod files;
mod geojson;
mod help;
mod models;
mod networks;
mod pddl;
mod pddl_rules;
mod plandev;
mod proven_rules;
mod ptpn;
mod public_files;
mod reference;
mod running;
mod schema;
mod time_limit;
mod uncertain_networks;
mod written_files;

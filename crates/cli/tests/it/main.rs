//! The integration tests of `cli`, in one program: each module is about one thing.

mod attacks;
mod claims;
mod command;
mod control;
mod documents;
mod driving;
mod files;
mod geojson;
mod networks;
mod plandev;
mod ptpn;
mod running;
mod time_limit;
mod uncertain_networks;

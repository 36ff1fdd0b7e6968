//! The integration tests of `mission`, in one program: each module is about one thing.

mod agreement;
mod days;
mod enroute;
mod exploration;
mod fleets;
mod geojson;
mod kinodynamics;
mod levels;
mod listing;
mod margins;
mod meetings;
mod movements;
mod nature;
mod networks;
mod paths;
mod programs;
mod proving;
mod repairs;
mod ridge;
mod robustness;
mod sessions;
mod sight;
mod simulation;
mod standing;
mod support;
mod tours;

//! The formats of other tools, read and written: networks as plan-schema, pTPN and plans of `PlanDev`, a network as the text
//! of a mission, a problem in PDDL as a mission, models of Livingstone (JMPL) and Pamela as plant models and missions, and
//! places and obstacles of `GeoJSON`.
//!
//! Our own JSON is `tpn::network_json`. Nothing here decides what a network means.

pub mod geojson;
pub mod jmpl;
pub mod pamela;
pub mod pddl;
pub mod plan_schema;
pub mod plandev;
pub mod ptpn;
pub mod rmpl_text;
mod source;
mod translation;

pub use source::{ReadError, Source, is_network_file, is_network_text, is_plandev_text};
pub use translation::Translation;

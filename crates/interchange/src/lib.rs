//! Networks in the formats of other tools, read and written: plan-schema, pTPN and the plans of `PlanDev`; and a network as
//! the text of a mission.
//!
//! Our own JSON is `tpn::network_json`. Nothing here decides what a network means.

pub mod plan_schema;
pub mod plandev;
pub mod ptpn;
pub mod rmpl_text;
mod source;

pub use source::{ReadError, Source, is_network_file, is_network_text, is_plandev_text};

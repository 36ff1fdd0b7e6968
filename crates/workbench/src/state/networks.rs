//! The forms of a network for other tools.

use interchange::is_plandev_text;
use interchange::ptpn::is_ptpn;

/// A notation of networks that other tools read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkForm {
    /// plan-schema, in JSON.
    PlanSchema,
    /// The XML of `RMPyL`.
    Ptpn,
}

/// Returns what a file with the text of a network ends in.
pub(crate) fn network_ending(text: &str) -> &'static str {
    if is_ptpn(text) {
        ".tpn"
    } else if text.contains(":network-id") {
        ".tpn.edn"
    } else if is_plandev_text(text) {
        ".plandev.json"
    } else {
        ".tpn.json"
    }
}

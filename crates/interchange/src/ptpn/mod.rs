//! pTPN: temporal plan networks in the XML of MIT's MERS group, as its `RMPyL` writes them (namespace
//! `http://mers.csail.mit.edu/tpn`): events, temporal constraints and episodes between them, and decision variables, each
//! guarded by what has to be decided for it to be part of the plan.
//!
//! A network here says by its arcs what is part of a plan, so a file is read where each guard is what its arcs come to.

mod guard;
mod read;
mod write;

pub use read::read;
pub use write::write;

/// The namespace of the elements.
pub const NAMESPACE: &str = "http://mers.csail.mit.edu/tpn";

/// Why a file is not a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PtpnError {
    #[error("this is not XML: {0}")]
    Xml(String),
    /// An element is not there, or not as it has to be.
    #[error("{0}")]
    Shape(String),
    /// A guard that arcs cannot say.
    #[error("the guard of {place} depends on more than the choices before it, which is not supported")]
    Guard {
        /// The event, constraint or episode.
        place: String,
    },
    /// Guards of more than 1,000 ways.
    #[error("the guard of {place} has too many alternatives")]
    TooManyTerms {
        /// The event, constraint or episode.
        place: String,
    },
    /// The network that it comes to cannot be read.
    #[error(transparent)]
    Network(#[from] crate::plan_schema::PlanSchemaError),
}

/// Returns whether a text is a pTPN: XML whose first element is one of it.
pub fn is_ptpn(text: &str) -> bool {
    let mut rest = text.strip_prefix('\u{feff}').unwrap_or(text).trim_start();
    while let Some(after) = ["<?", "<!--"].iter().find_map(|start| rest.strip_prefix(start)) {
        rest = after.split_once('>').map_or("", |(_, rest)| rest).trim_start();
    }
    let name = rest.strip_prefix('<').unwrap_or_default();
    let name =
        name.split(|it: char| it.is_whitespace() || ['>', '/'].contains(&it)).next().unwrap_or_default();
    let local = name.rsplit(':').next().unwrap_or_default();
    ["tpns", "tpn", "ptpn"].contains(&local)
}

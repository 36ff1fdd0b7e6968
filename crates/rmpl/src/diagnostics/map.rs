//! `W-MAP`: gray values of a map file that mean neither free nor occupied. Only who reads the file can find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-MAP");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "unclear gray values in a map",
    meaning: "A ROS map has cells whose gray value is between `free_thresh` and `occupied_thresh`, and is not 205, the value
that mapping programs write for unknown cells. Such cells are unknown: no path crosses them.",
    example: "terrain \"warehouse.yaml\" cell 0.05;
location BASE (1, 1);
vehicle R1 : ATRV-Jr at BASE;
scenario Day[0,60] = { delay }",
    fix: "Change the thresholds in the YAML file, or write 205 for cells that are unknown.",
    mended: "terrain \"warehouse.yaml\" cell 0.05;
location BASE (1, 1);
vehicle R1 : ATRV-Jr at BASE;
scenario Day[0,60] = { delay }",
};

/// A map of which so many of all cells are unclear, where the mission names it.
pub fn unclear((cells, all): (usize, usize), map: &str, span: Span) -> Diagnostic {
    let message = format!(
        "{cells} of {all} cells of \"{map}\" have a gray value between its thresholds: they are unknown, and no path crosses them"
    );
    Diagnostic::warning(CODE, span, message)
        .with_hint("change `free_thresh` or `occupied_thresh` in the file, or use 205 for unknown cells")
}

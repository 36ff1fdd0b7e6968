//! `W-MAP`: gray values of a map file that mean neither free nor occupied. Only who reads the file can find it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

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

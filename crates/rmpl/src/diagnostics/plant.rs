//! `W-PLANT`: activities whose control programs may want the same component at the same time. Only planning can find it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("W-PLANT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "control programs wait for each other",
    meaning: "Two activities of the plan may overlap, and their control programs command the same component. Then the
program that starts second waits until the first has ended, and its activity takes longer. Programs that command different
components run in parallel.",
    example: "primitive Insert()[6,16] runs OrbitInsert;
primitive Survey()[4,30] runs TakePictures;
scenario Day[0,60] = { Insert(), Survey() }",
    fix: "Put one activity after the other, or give the second one time to wait.",
    mended: "primitive Insert()[6,16] runs OrbitInsert;
primitive Survey()[4,30] runs TakePictures;
scenario Day[0,60] = { Insert(); Survey() }",
};

//! `W-PLANT`: activities whose control programs may want the same component at the same time. Only planning can find it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("W-PLANT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "control programs that wait for each other",
    meaning: "Control programs that command different components of the plant run at once. The plan allows two activities to
overlap whose programs command the same one: the program that starts second waits until the first one has ended, and its
activity lasts that much longer.",
    example: "primitive Insert()[6,16] runs OrbitInsert;
primitive Survey()[4,30] runs TakePictures;
scenario Day[0,60] = { Insert(), Survey() }",
    fix: "Put one after the other, or leave the second one time to wait.",
    mended: "primitive Insert()[6,16] runs OrbitInsert;
primitive Survey()[4,30] runs TakePictures;
scenario Day[0,60] = { Insert(); Survey() }",
};

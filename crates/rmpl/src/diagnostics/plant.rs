//! `W-PLANT`: activities whose control programs may want the plant at the same time. Only planning can find it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

/// The code.
pub const CODE: Code = Code("W-PLANT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "control programs that may run at the same time",
    meaning: "All control programs of a mission command one plant, which takes commands of one program at a time. The plan
allows two activities that run programs to overlap: the one that starts second would find the plant taken, and the mission
would be stopped.",
    example: "primitive Insert()[6,16] runs OrbitInsert;
primitive Survey()[4,30] runs TakePictures;
scenario Day[0,60] = { Insert(), Survey() }",
    fix: "Put one after the other, or run one program that does both.",
    mended: "primitive Insert()[6,16] runs OrbitInsert;
primitive Survey()[4,30] runs TakePictures;
scenario Day[0,60] = { Insert(); Survey() }",
};

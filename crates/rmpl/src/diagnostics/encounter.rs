//! `W-ENCOUNTER`: vehicles of different traverses that come too near each other. Only planning can find it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("W-ENCOUNTER");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "vehicles too close to each other",
    meaning: "In some schedule of the plan, two vehicles that do not drive together come closer than the sum of their radii
plus 1 m. The message says when, where, and in which schedule. Vehicles of one traverse keep formation and are not reported.",
    example: "location WEST (0, 0);
location EAST (60, 0);
vehicle Rover1 : ATRV at WEST;
vehicle Rover2 : ATRV at EAST;
primitive Drive1(to)[2,10] moves Rover1;
primitive Drive2(to)[2,10] moves Rover2;
scenario Day[0,60] = { Drive1(EAST), Drive2(WEST) }",
    fix: "Delay one vehicle, or route it differently.",
    mended: "location WEST (0, 0);
location EAST (60, 0);
location NORTH (0, 40);
vehicle Rover1 : ATRV at WEST;
vehicle Rover2 : ATRV at EAST;
primitive Drive1(to)[2,10] moves Rover1;
primitive Drive2(to)[2,10] moves Rover2;
scenario Day[0,60] = { Drive1(NORTH); Drive2(WEST) }",
};

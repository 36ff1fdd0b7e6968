//! Vehicles of models that the mission declares (SPEC 17): paths, speeds and sight follow the properties of the models, and
//! each vehicle has its own equipment.

use link::Update;
use mission::{Core, Evaluated, Manner};

use crate::ridge::{SilentHost, ridge};

/// A mission on the ridge, planned.
#[track_caller]
fn planned(world: &str, scenario: &str) -> Evaluated {
    let mut core = Core::default();
    core.import("ridge.asc", &ridge()).expect("a map");
    let text = format!(
        "terrain \"ridge.asc\"; location BASE (10, 10); location CRATER (50, 14); location OPEN (50, 3);\n{world}\n\
         primitive Drive(r, to)[0,60] moves r; primitive Relay(r, to)[1,2] requires r.at in visible(to);\n\
         scenario Day[0,300] = {{ {scenario} }}"
    );
    let compiled = core.compile(&Update::new(1, text), &SilentHost);
    assert!(compiled.network().is_some(), "{:?}", compiled.diagnostics);
    let ground = core.ground(&compiled.program).expect("known ground");
    core.plan(compiled, ground, Manner::default(), &mut SilentHost).expect("a network")
}

/// Returns whether a vehicle of `model`, which `declared` declares, can do what the scenario says.
#[track_caller]
fn can(declared: &str, model: &str, scenario: &str) -> bool {
    let evaluated = planned(&format!("{declared} vehicle V : {model} at CRATER;"), scenario);
    evaluated.planned.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid)
}

#[test]
fn a_mast_decides_what_is_in_sight() {
    let declared = "model Tall { mast 20; } model Far extends Tall { body 1 x 1; }";
    assert!(!can(declared, "ATRV", "Relay(V, BASE)"));
    assert!(can(declared, "Tall", "Relay(V, BASE)"));
    assert!(can(declared, "Far", "Relay(V, BASE)"));
}

#[test]
fn a_speed_bounds_how_long_a_traverse_takes() {
    let declared = "model Slow { speed (0, 0.1); } model Hasty { speed (0.5 m/s, 0.6 m/s); }";
    // The way is 11 m long.
    assert!(can(declared, "ATRV", "Drive(V, OPEN)[0,1]"));
    assert!(!can(declared, "Slow", "Drive(V, OPEN)[0,1]"));
    assert!(can(declared, "Slow", "Drive(V, OPEN)[0,3]"));
    assert!(can(declared, "ATRV", "Drive(V, OPEN)[2,3]"));
    assert!(!can(declared, "Hasty", "Drive(V, OPEN)[2,3]"));
}

#[test]
fn a_body_decides_where_a_vehicle_fits() {
    // The obstacle leaves 5 m of the gap.
    let declared = "model Wide { body 8 x 8; } obstacle Rock polygon (27, -30, 33, -30, 33, 6, 27, 6);";
    assert!(can(declared, "ATRV", "Drive(V, BASE)"));
    assert!(!can(declared, "Wide", "Drive(V, BASE)"));
}

#[test]
fn an_area_that_is_closed_to_a_model_is_closed_to_those_that_extend_it() {
    let declared = "model Scout { mast 1; } model Digger extends Scout { mast 2; } model Other { mast 1; }
                    keepout Gap polygon (27, -5, 33, -5, 33, 12, 27, 12) for Scout;";
    assert!(!can(declared, "Digger", "Drive(V, BASE)"));
    assert!(can(declared, "Other", "Drive(V, BASE)"));
    let of_built_in = "model Scout extends ATRV-Jr { mast 1; }
                       keepout Gap polygon (27, -5, 33, -5, 33, 12, 27, 12) for ATRV-Jr;";
    assert!(!can(of_built_in, "Scout", "Drive(V, BASE)"));
}

#[test]
fn each_vehicle_drives_on_its_own_battery() {
    let world = "model Scout { resource battery 0..100 = 60; state drill : {IN, OUT} = IN; }
                 vehicle S[1..2] : Scout at CRATER; group All = S;
                 primitive Work(r : Scout)[1,2] requires r.drill=IN consumes r.battery 40 sets r.drill=OUT;";
    let evaluated = planned(world, "each r in All { Drive(r, OPEN); Work(r) }");
    let planning = &evaluated.planned.planning;
    assert!(planning.verdict.as_ref().is_some_and(|verdict| verdict.valid));
    assert_eq!(evaluated.planned.traverses.len(), 2);
    let has_plan = |scenario: &str| {
        let evaluated = planned(world, scenario);
        evaluated.planned.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid)
    };
    assert!(has_plan("Work(S[1]); Work(S[2])"));
    assert!(!has_plan("Work(S[1]); Work(S[1])"));
    assert!(has_plan("{ delay; Work(S[1]) }, { delay; any r in All Work(r) }"));
}

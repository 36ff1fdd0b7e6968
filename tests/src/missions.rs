//! Many missions by name: the examples, those of the lessons, those of the conformance cases, and random ones.

use std::path::Path;

use tpn::generate::{Recipe, Tightness};
use workbench::lesson::{COURSE, Lesson};

use crate::cases;
use crate::lasting_missions::{Kind, lasting_mission};
use crate::random::{crowded_mission, small_mission, timed_mission};

/// The missions, by where they come from, with so many random ones of each kind.
pub fn missions(random: u64) -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = Vec::new();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/missions");
    let mut examples: Vec<_> =
        std::fs::read_dir(examples).expect("the examples").map(|it| it.expect("a file").path()).collect();
    examples.sort();
    all.extend(examples.iter().map(|path| (path.display().to_string(), cases::read(path))));
    for course in COURSE.iter().flat_map(|chapter| chapter.lessons) {
        let (lesson, _) = Lesson::read(course.name, course.text);
        all.push((format!("lesson {}", course.name), lesson.mission.source().to_owned()));
    }
    let with_program = cases::all().into_iter().filter(|(_, case)| case["program"].is_string());
    all.extend(with_program.map(|(name, case)| (name, cases::program(&case))));
    for seed in 0..random {
        all.push((format!("timed {seed}"), timed_mission(seed)));
        all.push((format!("small {seed}"), small_mission(seed)));
        all.push((format!("crowded {seed}"), crowded_mission(seed)));
        for (name, kind) in [("states", Kind::STATES), ("resources", Kind::RESOURCES), ("both", Kind::BOTH)] {
            all.push((format!("{name} {seed}"), lasting_mission(seed, kind)));
        }
        let recipe = Recipe { nodes: 24, tightness: Tightness::Infeasible, seed };
        all.push((format!("infeasible {seed}"), tpn::generate::mission(recipe)));
    }
    all
}

//! The missions that come with the app, by name.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A mission that comes with the app.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// Its name in addresses and commands.
    pub name: &'static str,
    /// What the mission picker calls it.
    pub title: &'static str,
    /// What it shows, in one sentence.
    pub about: &'static str,
    pub source: &'static str,
}

/// All of them. The first one opens on a first visit, so it has neither errors nor warnings.
pub const EXAMPLES: &[Example] = &[
    Example {
        name: "both-paths",
        title: "Both paths open",
        about: "Two paths are open at different times; the planner shows which ones keep the deadline.",
        source: include_str!("../../../assets/missions/both-paths.rmpl"),
    },
    Example {
        name: "enroute",
        title: "Enroute",
        about: "Two rovers drive together along the path that is open, report, and wait for permission to proceed.",
        source: include_str!("../../../assets/missions/enroute.rmpl"),
    },
    Example {
        name: "detour",
        title: "Detour",
        about: "Drag a boulder into the gap and see the plan change to the long path.",
        source: include_str!("../../../assets/missions/detour.rmpl"),
    },
    Example {
        name: "negative-cycle",
        title: "Negative cycle",
        about: "One alternative takes longer than the mission may last; the planner explains the conflict.",
        source: include_str!("../../../assets/missions/negative-cycle.rmpl"),
    },
    Example {
        name: "causal-links",
        title: "Causal links",
        about: "A drive needs light throughout; a causal link shows which assertion supports it.",
        source: include_str!("../../../assets/missions/causal-links.rmpl"),
    },
    Example {
        name: "threats",
        title: "Threats",
        about: "Three activities use one arm, and the planner puts them in an order.",
        source: include_str!("../../../assets/missions/threats.rmpl"),
    },
    Example {
        name: "backjump",
        title: "Backjumping",
        about: "The first choice can never work, but the search finds out late: watch it jump back.",
        source: include_str!("../../../assets/missions/backjump.rmpl"),
    },
    Example {
        name: "arm",
        title: "Robotic arm (lasting state)",
        about: "A rover digs with its arm, and drives only while the arm is stowed.",
        source: include_str!("../../../assets/missions/arm.rmpl"),
    },
    Example {
        name: "battery",
        title: "Battery recharge",
        about: "A rover makes three drives on a battery for two, so it must charge in between.",
        source: include_str!("../../../assets/missions/battery.rmpl"),
    },
    Example {
        name: "stations",
        title: "Stations in any order",
        about: "Three rovers share two stations, and the planner finds the order of their visits.",
        source: include_str!("../../../assets/missions/stations.rmpl"),
    },
    Example {
        name: "controllability",
        title: "Consistent but not controllable",
        about: "All bounds are consistent, but no plan works for every duration of the drive.",
        source: include_str!("../../../assets/missions/controllability.rmpl"),
    },
    Example {
        name: "storm",
        title: "Storm with an uncertain start",
        about: "A survey must end before a storm whose start is uncertain.",
        source: include_str!("../../../assets/missions/storm.rmpl"),
    },
    Example {
        name: "sol",
        title: "Oversubscribed sol",
        about: "One day has more tasks than time; the planner chooses the most valuable ones.",
        source: include_str!("../../../assets/missions/sol.rmpl"),
    },
    Example {
        name: "relay",
        title: "Line of sight to the base",
        about: "A rover reports only from where it sees its base; the map draws the lines of sight.",
        source: include_str!("../../../assets/missions/relay.rmpl"),
    },
    Example {
        name: "fleet",
        title: "Four rovers and a blimp",
        about: "Four rovers and a blimp divide their sites so that they drive as little as possible.",
        source: include_str!("../../../assets/missions/fleet.rmpl"),
    },
    Example {
        name: "exploration",
        title: "Cooperative exploration",
        about: "Scouts, a laboratory and a blimp explore together; each step waits for the previous one.",
        source: include_str!("../../../assets/missions/exploration.rmpl"),
    },
    Example {
        name: "orbit",
        title: "Orbit insertion (mission)",
        about: "A spacecraft brakes into orbit; let its engine fail and see the backup take over.",
        source: include_str!("../../../assets/missions/orbit.rmpl"),
    },
    Example {
        name: "flyby",
        title: "Camera failover",
        about: "A probe looks at a comet through the first of its two cameras that starts.",
        source: include_str!("../../../assets/missions/flyby.rmpl"),
    },
    Example {
        name: "orbit-insertion",
        title: "Orbit insertion",
        about: "A control program fires the backup engine as soon as the first one has failed.",
        source: include_str!("../../../assets/programs/orbit-insertion.rmpl"),
    },
];

/// The plant that a control program without one runs on, if its names fit.
pub const PLANT: &str = include_str!("../../../assets/programs/orbit-plant.rmpl");

/// The example of this name.
pub fn example(name: &str) -> Option<&'static Example> {
    EXAMPLES.iter().find(|example| example.name == name)
}

/// The pictures of the examples, by name: their plans as bars. A test computes them.
pub const PICTURES: &str = include_str!("../../../assets/missions/pictures.json");

/// The plan of the example of this name as bars, each as start, end and row (see [`crate::library::Mission`]); none for a
/// mission without a plan, or a control program.
pub fn example_picture(name: &str) -> &'static [[u16; 3]] {
    static READ: LazyLock<BTreeMap<String, Vec<[u16; 3]>>> =
        LazyLock::new(|| serde_json::from_str(PICTURES).unwrap_or_default());
    READ.get(name).map_or(&[], Vec::as_slice)
}

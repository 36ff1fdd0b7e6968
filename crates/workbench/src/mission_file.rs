//! The missions that come with the app, by name.

/// A mission that comes with the app.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// Its name in addresses and commands.
    pub name: &'static str,
    /// What the mission picker calls it.
    pub title: &'static str,
    pub source: &'static str,
}

/// All of them. The first one opens on a first visit, so it has neither errors nor warnings.
pub const EXAMPLES: &[Example] = &[
    Example {
        name: "both-paths",
        title: "Both paths open",
        source: include_str!("../../../assets/missions/both-paths.rmpl"),
    },
    Example {
        name: "enroute",
        title: "Enroute",
        source: include_str!("../../../assets/missions/enroute.rmpl"),
    },
    Example { name: "detour", title: "Detour", source: include_str!("../../../assets/missions/detour.rmpl") },
    Example {
        name: "negative-cycle",
        title: "Negative cycle",
        source: include_str!("../../../assets/missions/negative-cycle.rmpl"),
    },
    Example {
        name: "causal-links",
        title: "Causal links",
        source: include_str!("../../../assets/missions/causal-links.rmpl"),
    },
    Example {
        name: "threats",
        title: "Threats",
        source: include_str!("../../../assets/missions/threats.rmpl"),
    },
    Example {
        name: "backjump",
        title: "Backjumping",
        source: include_str!("../../../assets/missions/backjump.rmpl"),
    },
    Example {
        name: "arm",
        title: "Robotic arm (lasting state)",
        source: include_str!("../../../assets/missions/arm.rmpl"),
    },
    Example {
        name: "battery",
        title: "Battery recharge",
        source: include_str!("../../../assets/missions/battery.rmpl"),
    },
    Example {
        name: "stations",
        title: "Stations in any order",
        source: include_str!("../../../assets/missions/stations.rmpl"),
    },
    Example {
        name: "controllability",
        title: "Consistent but not controllable",
        source: include_str!("../../../assets/missions/controllability.rmpl"),
    },
    Example {
        name: "storm",
        title: "Storm with an uncertain start",
        source: include_str!("../../../assets/missions/storm.rmpl"),
    },
    Example {
        name: "sol",
        title: "Oversubscribed sol",
        source: include_str!("../../../assets/missions/sol.rmpl"),
    },
    Example {
        name: "relay",
        title: "Line of sight to the base",
        source: include_str!("../../../assets/missions/relay.rmpl"),
    },
    Example {
        name: "fleet",
        title: "Four rovers and a blimp",
        source: include_str!("../../../assets/missions/fleet.rmpl"),
    },
    Example {
        name: "exploration",
        title: "Cooperative exploration",
        source: include_str!("../../../assets/missions/exploration.rmpl"),
    },
    Example {
        name: "orbit",
        title: "Orbit insertion (mission)",
        source: include_str!("../../../assets/missions/orbit.rmpl"),
    },
    Example {
        name: "flyby",
        title: "Camera failover",
        source: include_str!("../../../assets/missions/flyby.rmpl"),
    },
    Example {
        name: "orbit-insertion",
        title: "Orbit insertion",
        source: include_str!("../../../assets/programs/orbit-insertion.rmpl"),
    },
];

/// The plant that a control program without one runs on, if its names fit.
pub const PLANT: &str = include_str!("../../../assets/programs/orbit-plant.rmpl");

/// The example of this name.
pub fn example(name: &str) -> Option<&'static Example> {
    EXAMPLES.iter().find(|example| example.name == name)
}

//! What new missions begin with.

/// A text to begin a mission with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Template {
    /// Its name in commands.
    pub name: &'static str,
    /// What it is called on screen.
    pub title: &'static str,
    /// One line about it.
    pub about: &'static str,
    pub source: &'static str,
}

/// All of them, the plainest first.
pub const TEMPLATES: &[Template] = &[
    Template { name: "empty", title: "Empty", about: "Start from an empty text", source: "" },
    Template {
        name: "sequence",
        title: "First mission",
        about: "Three activities, two in parallel",
        source: "// Three activities: one after the other with `;`, at the same time with `,`.\n\
                 // Bounds are minimum and maximum durations.\n\n\
                 primitive Wake-Up()[1,2];\n\
                 primitive Take-Picture(what)[2,4];\n\
                 primitive Measure-Wind()[5,8];\n\n\
                 scenario First[0,30] = {\n  \
                   Wake-Up();\n  \
                   { Take-Picture(HORIZON), Measure-Wind() }\n\
                 }\n",
    },
    Template {
        name: "rover",
        title: "Rover on a map",
        about: "Places, a vehicle, and a choice between two paths",
        source: "// Times are in minutes, distances in meters.\n\n\
                 terrain \"tai-plain\" cell 0.6 origin (0, 0);\n\n\
                 location BASE (24, 52);\n\
                 location ROCK (120, 70);\n\
                 location RIDGE (44, 120);\n\n\
                 vehicle Rover : ATRV-Jr at BASE;\n\n\
                 primitive Drive(to)[5,60] moves Rover speed (0.02, 0.2);\n\
                 primitive Take-Picture(what)[2,4];\n\n\
                 scenario First[0,200] = {\n  \
                   choose {\n    \
                     { Drive(ROCK); Take-Picture(ROCK) },\n    \
                     { Drive(RIDGE); Take-Picture(RIDGE) }\n  \
                   }\n\
                 }\n",
    },
];

/// The template of this name.
pub fn template(name: &str) -> Option<&'static Template> {
    TEMPLATES.iter().find(|template| template.name == name)
}

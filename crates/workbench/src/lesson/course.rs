//! The course that comes with the app, in order.

/// Lessons that belong together.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    /// What they are about.
    pub title: &'static str,
    /// The lessons, in order.
    pub lessons: &'static [CourseLesson],
}

/// A lesson that comes with the app.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CourseLesson {
    /// Its name in addresses and commands.
    pub name: &'static str,
    pub text: &'static str,
}

macro_rules! lessons {
    ($($number:literal $name:literal),* $(,)?) => {
        &[$(CourseLesson {
            name: $name,
            text: include_str!(concat!("../../../../assets/lessons/", $number, "-", $name, ".md")),
        }),*]
    };
}

/// The chapters of the course, in order.
pub const COURSE: &[Chapter] = &[
    Chapter {
        title: "The language",
        lessons: lessons!["01" "first-line", "02" "sequence-and-parallel", "03" "bounds"],
    },
    Chapter {
        title: "Planning",
        lessons: lessons![
            "04" "negative-cycle",
            "05" "choices",
            "06" "causal-links",
            "07" "threats",
            "08" "learning",
        ],
    },
    Chapter {
        title: "Time and resources",
        lessons: lessons![
            "09" "dispatching",
            "10" "states",
            "11" "resources",
            "12" "order",
            "13" "objectives",
            "14" "controllability",
        ],
    },
    Chapter { title: "Paths", lessons: lessons!["15" "rrt"] },
    Chapter {
        title: "Control",
        lessons: lessons![
            "16" "automata",
            "17" "esterel-pause",
            "18" "esterel-preempt",
            "19" "estimation",
        ],
    },
    Chapter { title: "A complete mission", lessons: lessons!["20" "whole-mission"] },
    Chapter { title: "Review", lessons: lessons!["21" "review", "22" "verified", "23" "proof"] },
    Chapter { title: "Control in time", lessons: lessons!["24" "timeouts", "25" "locks"] },
];

/// A tour of Enroute for new users: a lesson before the course.
pub const TOUR: CourseLesson =
    CourseLesson { name: "tour", text: include_str!("../../../../assets/lessons/tour.md") };

/// The lesson of this name, or the tour.
pub fn course_lesson(name: &str) -> Option<&'static CourseLesson> {
    let course = COURSE.iter().flat_map(|chapter| chapter.lessons);
    std::iter::once(&TOUR).chain(course).find(|lesson| lesson.name == name)
}

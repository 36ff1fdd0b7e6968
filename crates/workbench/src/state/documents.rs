//! The forms of a schedule for other tools.

/// A schedule's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScheduleForm {
    /// Comma-separated values with windows and slack, in mission units.
    Csv,
    /// A JSON document with all that is known of the schedule.
    Json,
    /// A plan for Open MCT.
    OpenMct,
    Icalendar,
    /// A plan for `PlanDev` (Aerie).
    PlanDev,
}

impl ScheduleForm {
    /// Returns what it is called in dialogs.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Csv => "Export schedule as CSV",
            Self::Json => "Export schedule as JSON",
            Self::OpenMct => "Export to Open MCT",
            Self::Icalendar => "Export to calendar",
            Self::PlanDev => "Export to PlanDev",
        }
    }

    /// Its name in commands.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Json => "json",
            Self::OpenMct => "open-mct",
            Self::Icalendar => "icalendar",
            Self::PlanDev => "plandev",
        }
    }

    /// The form of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        let all = [Self::Csv, Self::Json, Self::OpenMct, Self::Icalendar, Self::PlanDev];
        all.into_iter().find(|form| form.name() == name)
    }

    /// Returns whether its times are dates, so that it must be known when the mission starts.
    pub const fn needs_epoch(self) -> bool {
        matches!(self, Self::OpenMct | Self::Icalendar | Self::PlanDev)
    }

    pub(crate) const fn ending(self) -> &'static str {
        match self {
            Self::Csv => "schedule.csv",
            Self::Json => "schedule.json",
            Self::OpenMct => "open-mct.json",
            Self::Icalendar => "ics",
            Self::PlanDev => "plandev.json",
        }
    }
}

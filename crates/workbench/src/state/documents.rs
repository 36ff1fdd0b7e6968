//! Documents that are written from the open mission: the report, and schedules for other tools.

use report::calendar::Calendar;
use report::export;
use review::PlanStatus;

use crate::state::{AppState, Effect, ToastKind};

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
    /// What it is called in dialogs.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Csv => "CSV schedule",
            Self::Json => "JSON schedule",
            Self::OpenMct => "Open MCT plan",
            Self::Icalendar => "iCalendar",
            Self::PlanDev => "PlanDev plan",
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

    /// Whether its times are dates, so that it must be known when the mission starts.
    pub const fn needs_epoch(self) -> bool {
        matches!(self, Self::OpenMct | Self::Icalendar | Self::PlanDev)
    }

    const fn ending(self) -> &'static str {
        match self {
            Self::Csv => "schedule.csv",
            Self::Json => "schedule.json",
            Self::OpenMct => "open-mct.json",
            Self::Icalendar => "ics",
            Self::PlanDev => "plandev.json",
        }
    }
}

impl AppState {
    /// Writes the report of the present content; reviews it first if that has not been done.
    pub(super) fn write_report(&mut self) {
        let Some(review) = self.current_review().cloned() else {
            self.run_review();
            self.review.wants_report = true;
            self.toasts.add(ToastKind::Info, "The mission is reviewed first; the report follows");
            return;
        };
        let revision = self.document.revision();
        let Some(snapshot) = self.snapshots.latest().filter(|it| it.revision == revision) else { return };
        let ground = snapshot.map.as_ref().and_then(|key| self.maps.get(key));
        let page = report::html(&report::Document {
            name: &self.mission,
            snapshot,
            review: &review,
            record: Some(self.review.record()),
            robustness: self.robustness().map(AsRef::as_ref),
            seed: self.settings.plan.seed,
            ground: ground.map(AsRef::as_ref),
        });
        self.effects.push(Effect::SaveFile {
            name: format!("{}.report.html", self.mission),
            bytes: page.into_bytes(),
        });
    }

    /// Writes the schedule of the present plan. `epoch` says when the mission starts, where the form needs it.
    pub(super) fn write_schedule(&mut self, form: ScheduleForm, epoch: &str) {
        match self.schedule(form, epoch) {
            Ok(text) => {
                if !epoch.is_empty() {
                    epoch.clone_into(&mut self.settings.epoch);
                }
                self.effects.push(Effect::SaveFile {
                    name: format!("{}.{}", self.mission, form.ending()),
                    bytes: text.into_bytes(),
                });
            }
            Err(reason) => self.toasts.add(ToastKind::Failed, reason),
        }
    }

    fn schedule(&self, form: ScheduleForm, epoch: &str) -> Result<String, String> {
        let beyond = || "The schedule does not fit into the calendar".to_owned();
        let snapshot = self
            .shown()
            .filter(|shown| shown.plan().is_some() && !self.snapshots.is_stale(self.document.revision()))
            .ok_or("There is no plan, so there is no schedule")?;
        let calendar = match epoch {
            "" if !form.needs_epoch() => None,
            epoch => Some(Calendar::new(epoch, snapshot.program.options.time_unit).ok_or_else(|| {
                format!("\"{epoch}\" is no date such as 2004-01-25 or 2004-01-25T05:05:00Z")
            })?),
        };
        let plan = self.pins.plan(snapshot);
        let about = export::About {
            content_hash: self.review.hash().unwrap_or_default(),
            status: self.standing().map_or(PlanStatus::Draft, |standing| standing.status),
            calendar: calendar.as_ref(),
            pins: &plan.map(|_| self.pins.all()).unwrap_or_default(),
            plan,
        };
        let written = |document: serde_json::Value| {
            let text = serde_json::to_string_pretty(&document).map_err(|error| error.to_string())?;
            Ok(format!("{text}\n"))
        };
        match form {
            ScheduleForm::Csv => export::csv(snapshot, &about).ok_or_else(beyond),
            ScheduleForm::Json => written(export::json(snapshot, &about).ok_or_else(beyond)?),
            ScheduleForm::OpenMct => written(export::open_mct(snapshot, &about).ok_or_else(beyond)?),
            ScheduleForm::Icalendar => export::icalendar(snapshot, &about).ok_or_else(beyond),
            ScheduleForm::PlanDev => written(report::plandev::plandev(snapshot, &about).ok_or_else(beyond)?),
        }
    }
}

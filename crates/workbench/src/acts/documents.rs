//! Documents that are written from the open mission: the report, schedules and networks for other tools; and the other
//! way, a network of another tool as a mission in RMPL.

use interchange::is_plandev_text;
use interchange::ptpn::{self, is_ptpn};
use interchange::{plan_schema, rmpl_text};
use report::calendar::Calendar;
use report::export;
use review::PlanStatus;

use crate::state::AppState;
use crate::state::documents::ScheduleForm;
use crate::state::networks::{NetworkForm, network_ending};
use crate::state::review::Waiting;

/// What the version is called in which the text of the network is kept.
const VERSION: &str = "Network";

impl AppState {
    /// Writes the report of the present content; reviews it first if that has not been done.
    pub(super) fn write_report(&mut self) {
        let Some(review) = self.review.current().cloned() else {
            self.reviewing().run();
            self.review.waiting = Some(Waiting::Report);
            self.window.info("Reviewing first; the report opens when it's done");
            return;
        };
        let revision = self.document.revision();
        let Some(snapshot) = self.snapshots.latest().filter(|it| it.revision == revision) else { return };
        let ground = self.maps.of(snapshot);
        let page = report::html(&report::Document {
            name: &self.mission,
            snapshot,
            review: &review,
            record: Some(self.review.record()),
            robustness: self.robustness().map(AsRef::as_ref),
            seed: self.settings.plan.seed,
            ground: ground.map(AsRef::as_ref),
        });
        self.window.save_file(format!("{}.report.html", self.mission), page.into_bytes());
    }

    /// Writes the schedule of the present plan. `epoch` says when the mission starts, where the form needs it.
    pub(super) fn write_schedule(&mut self, form: ScheduleForm, epoch: &str) {
        // A schedule says whether its plan is approved, which only a review tells.
        let has_history = self.review.record().counted().next().is_some();
        if has_history && self.review.current().is_none() && self.update_with_plan().is_some() {
            self.reviewing().run();
            self.review.waiting = Some(Waiting::Schedule(form, epoch.to_owned()));
            self.window.info("Reviewing first; the schedule is saved when it's done");
        } else {
            self.save_schedule(form, epoch);
        }
    }

    pub(super) fn save_schedule(&mut self, form: ScheduleForm, epoch: &str) {
        match self.schedule(form, epoch) {
            Ok(text) => {
                if !epoch.is_empty() {
                    epoch.clone_into(&mut self.settings.epoch);
                }
                self.window.save_file(format!("{}.{}", self.mission, form.ending()), text.into_bytes());
            }
            Err(reason) => self.window.failed(reason),
        }
    }

    fn schedule(&self, form: ScheduleForm, epoch: &str) -> Result<String, String> {
        let beyond = || "The schedule has dates a calendar file can't hold".to_owned();
        let snapshot = self
            .shown()
            .filter(|shown| shown.plan().is_some() && !self.snapshots.is_stale(self.document.revision()))
            .ok_or("Cannot export a schedule without a plan")?;
        let calendar = match epoch {
            "" if !form.needs_epoch() => None,
            epoch => Some(Calendar::new(epoch, snapshot.program.options.time_unit).ok_or_else(|| {
                format!("Invalid date “{epoch}”. Enter a date such as 2004-01-25 or 2004-01-25T05:05:00Z.")
            })?),
        };
        let plan = self.pins.plan(snapshot);
        let about = export::About {
            content_hash: self.review.hash().unwrap_or_default(),
            status: self.review.standing().map_or(PlanStatus::Draft, |standing| standing.status),
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

    /// Whether the text is a network that was read as it stands.
    pub(crate) fn has_read_network(&self) -> Result<(), &'static str> {
        if !self.language.is_network() {
            return Err("this mission isn't an imported network");
        }
        if self.snapshots.is_stale(self.document.revision()) {
            return Err("the network is still loading");
        }
        let is_read = self.shown().is_some_and(|shown| shown.network.is_some());
        if is_read { Ok(()) } else { Err("the network has errors") }
    }

    /// The text becomes that of a mission which compiles to the same network. What it was is kept as a version, beside
    /// the history of the text.
    pub(super) fn turn_into_rmpl(&mut self) {
        let text = match self.network_in_rmpl() {
            Ok(text) => text,
            Err(reason) => {
                self.window.failed(format!("Couldn't convert the network to RMPL: {reason}"));
                return;
            }
        };
        if self.refuses_text(text.len()) {
            return;
        }
        self.mission_of_its_own();
        self.library.keep_version(VERSION, self.frame.unix_millis);
        self.document.replace_all(&text);
        let words =
            format!("Converted to RMPL. Undo to go back; the network is saved as version “{VERSION}”.");
        self.window.done(words);
    }

    /// Writes the network as it is shown. A file that another tool wrote in this notation is saved as it was written, with
    /// what is not understood.
    pub(super) fn write_network(&mut self, form: NetworkForm) {
        match self.network_as(form) {
            Ok((ending, text)) => {
                self.window.save_file(format!("{}{ending}", self.mission), text.into_bytes());
            }
            Err(reason) => {
                self.window.failed(format!("Couldn't save the network: {reason}"));
            }
        }
    }

    fn network_as(&self, form: NetworkForm) -> Result<(&'static str, String), String> {
        let text = self.document.text();
        let is_written_so = match form {
            NetworkForm::PlanSchema => text.contains("tpn-type") && !is_ptpn(text) && !is_plandev_text(text),
            NetworkForm::Ptpn => is_ptpn(text),
        };
        if self.language.is_network() && is_written_so {
            return Ok((network_ending(text), text.to_owned()));
        }
        if self.snapshots.is_stale(self.document.revision()) {
            return Err("the network is out of date".to_owned());
        }
        let network = self.shown().and_then(|shown| shown.network.as_deref());
        let network = network.ok_or("the mission has no network")?;
        match form {
            NetworkForm::PlanSchema => {
                let text = serde_json::to_string_pretty(&plan_schema::write(network));
                Ok((".tpn.json", format!("{}\n", text.map_err(|error| error.to_string())?)))
            }
            NetworkForm::Ptpn => Ok((".tpn", ptpn::write(network).map_err(|error| error.to_string())?)),
        }
    }

    fn network_in_rmpl(&self) -> Result<String, String> {
        self.has_read_network()?;
        let shown = self.shown().ok_or("the network is still loading")?;
        let network = shown.network.as_deref().ok_or("the network has errors")?;
        let said: Vec<String> = shown.problems.iter().map(|problem| problem.message.clone()).collect();
        rmpl_text::write(network, &said).map_err(|obstacle| obstacle.told(network, &[], &[]))
    }
}

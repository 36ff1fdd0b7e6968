//! Searches for a leg's path as sessions: each is kept with its trees, and continues from where it is.

use std::sync::Arc;

use link::Response;
use link::path_growth::MAX_SAMPLES;
use link::{GrowthStanding, PathGrowth, WantedPlanner};
use motion::{PlannerKind, Query, Settings, TracedSearch};
use snapshot::ContentKey;
use snapshot::ground::closed_to;
use terrain::ConfigurationSpace;

use super::Core;
use crate::host::CoreHost;

/// A search that was asked for last.
pub(super) struct Session {
    key: ContentKey,
    space: Arc<ConfigurationSpace>,
    query: Query,
    settings: Settings,
    search: Result<TracedSearch, String>,
    elapsed_millis: f64,
}

/// Samples are drawn for about this long before an answer says what they did.
const PROGRESS_MILLIS: f64 = 60.0;

/// How many samples a planner draws before it is the next one's turn.
const TURN_SAMPLES: usize = 16;

/// What is searched: the ground, the ends, and the settings of a planner.
struct Task {
    space: Arc<ConfigurationSpace>,
    query: Query,
    settings: Settings,
}

impl Core {
    /// Searches for a leg's path, to the end of every search.
    pub(super) fn grow_path(&mut self, wanted: &PathGrowth, host: &mut dyn CoreHost) {
        let Some(task) = self.task_of(wanted, host) else { return };
        let mut known = std::mem::take(&mut self.growth);
        for asked in &wanted.planners {
            let settings = Settings { planner: asked.planner, ..task.settings };
            let is_it = |known: &Session| {
                // Spaces are kept by what they are made of.
                Arc::ptr_eq(&known.space, &task.space)
                    && known.query == task.query
                    && known.settings == settings
            };
            let session = match known.iter().position(is_it) {
                Some(at) => known.swap_remove(at),
                None => Session::new(self.keys.fresh(), &task, settings),
            };
            self.growth.push(session);
        }
        race(&mut self.growth, wanted, host);
    }

    fn task_of(&mut self, wanted: &PathGrowth, host: &mut dyn CoreHost) -> Option<Task> {
        let evaluated = self.evaluate(&wanted.update, host)?.ok()?;
        let network = &evaluated.planned.network;
        let has_name = |traverse: &&snapshot::Traverse| {
            let occurrence = network.occurrences.get(traverse.occurrence.index());
            occurrence.is_some_and(|occurrence| occurrence.name == wanted.traverse)
        };
        let traverse = evaluated.planned.traverses.iter().find(has_name)?;
        let leg = traverse.legs.get(wanted.leg as usize)?;
        let query = Query { start_m: *leg.points_m.first()?, goal_m: *leg.points_m.last()? };
        let world = &evaluated.compiled.program.world;
        let vehicles: Vec<usize> = traverse.vehicles.iter().map(|&it| it as usize).collect();
        let model = snapshot::vehicle::model_of(world, *vehicles.first()?)?;
        let (key, map) = evaluated.ground.as_ref()?;
        let activity = &network.occurrences.get(traverse.occurrence.index())?.activity;
        let obstacles = closed_to(world, &vehicles, activity).map(|it| it.shape.clone()).collect();
        let space = self.grounds.space(key, map, &model, obstacles).exact;
        let defaults = Settings::of(PlannerKind::Rrt);
        let settings = Settings {
            seed: wanted.update.seed,
            // The same for all planners, so that they can be compared.
            step_m: defaults.step_m.max(Settings::step_across_m(space.frame())),
            max_samples: MAX_SAMPLES,
            limits: motion::DriveLimits::of(&model),
            ..defaults
        };
        Some(Task { space, query, settings })
    }
}

/// Lets the sessions draw their samples in turn, and tells what each did: from time to time, and at its end.
fn race(sessions: &mut [Session], wanted: &PathGrowth, host: &mut dyn CoreHost) {
    let told = |asked: &WantedPlanner, session: &Session| {
        if asked.held_search == session.key { asked.held as usize } else { 0 }
    };
    let mut told: Vec<usize> = wanted.planners.iter().zip(&*sessions).map(|it| told(it.0, it.1)).collect();
    let mut running: Vec<usize> = (0..sessions.len()).collect();
    let mut answered_millis = host.now_millis();
    while !running.is_empty() {
        for &at in &running {
            if !sessions[at].draw(host) {
                return;
            }
        }
        let is_due = host.now_millis() - answered_millis > PROGRESS_MILLIS;
        for &at in &running {
            if is_due || sessions[at].is_finished() {
                let answer = sessions[at].standing(wanted, told[at]);
                told[at] = sessions[at].samples();
                host.answer(Response::PathGrowth(Box::new(answer)));
            }
        }
        if is_due {
            answered_millis = host.now_millis();
        }
        running.retain(|&at| !sessions[at].is_finished());
    }
}

impl Session {
    fn new(key: ContentKey, task: &Task, settings: Settings) -> Self {
        let search = TracedSearch::new(&task.space, task.query, settings);
        Self {
            key,
            space: Arc::clone(&task.space),
            query: task.query,
            settings,
            search: search.map_err(|failure| failure.to_string()),
            elapsed_millis: 0.0,
        }
    }

    fn is_finished(&self) -> bool {
        self.search.as_ref().map_or(true, TracedSearch::is_finished)
    }

    fn samples(&self) -> usize {
        self.search.as_ref().map_or(0, |search| search.trace().steps.len())
    }

    /// Draws the samples of a turn. Returns whether what is searched is still wanted; a later request goes on from here.
    fn draw(&mut self, host: &mut dyn CoreHost) -> bool {
        let Ok(search) = &mut self.search else { return true };
        let begun_millis = host.now_millis();
        let mut is_wanted = true;
        for _ in 0..TURN_SAMPLES {
            if search.is_finished() || !is_wanted {
                break;
            }
            search.step(&self.space);
            is_wanted = !host.is_superseded();
        }
        self.elapsed_millis += host.now_millis() - begun_millis;
        is_wanted
    }

    /// The search as it stands, for someone who holds its first samples.
    fn standing(&self, wanted: &PathGrowth, held: usize) -> GrowthStanding {
        let trace = self.search.as_ref().ok().map(TracedSearch::trace);
        let steps = trace.map_or(&[][..], |trace| trace.steps.as_slice());
        let first = held.min(steps.len());
        GrowthStanding {
            revision: wanted.update.revision,
            traverse: wanted.traverse.clone(),
            leg: wanted.leg,
            planner: self.settings.planner,
            search: self.key,
            roots_m: trace.map_or_else(Vec::new, |trace| trace.roots_m.clone()),
            first: first as u32,
            steps: steps[first..].to_vec(),
            elapsed_millis: self.elapsed_millis,
            is_complete: self.is_finished(),
            refusal: self.search.as_ref().err().cloned(),
        }
    }
}

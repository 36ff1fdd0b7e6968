//! The search for the path of one leg, sample by sample: the trees growing from both ends.
//!
//! It is the recorded search that planned the leg, or another planner's on the same ground from the same seed. That one
//! is run by the core, which answers what each sample did as it goes on.

use std::sync::Arc;

use mission::request::Update;
use mission::{ContentKey, GrowthStanding, PathGrowth, Snapshot};
use motion::{GrowthStep, GrowthTrace, PlannerKind};
use nalgebra::Point2;
use rmpl::program::World;
use smol_str::SmolStr;
use terrain::Obstacle;
use tpn::OccurrenceId;

use crate::state::Selection;

/// The growth that is looked at, if one is.
#[derive(Clone, Debug)]
pub struct Growth {
    /// The planner whose search is shown; `None` for the search that planned the leg.
    pub planner: Option<PlannerKind>,
    /// Whether samples are drawn by themselves.
    pub is_playing: bool,
    shown: Option<Shown>,
    elapsed_samples: f64,
    /// Whether the core is to be asked for a search.
    wants_answer: bool,
}

/// A search under way.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The traverse.
    pub occurrence: OccurrenceId,
    /// Its name, by which it is found again in another network.
    pub name: SmolStr,
    /// The leg, from 0.
    pub leg: usize,
    /// The places of the traverse, as many as its legs: where each leads.
    pub goals: Vec<SmolStr>,
    /// Samples that the whole search draws.
    pub total: u32,
    walk: Walk,
}

/// A search that can be looked at after any number of samples.
#[derive(Clone, Debug)]
enum Walk {
    /// The recorded one, and how many samples of it are looked at.
    Recorded(Arc<GrowthTrace>, u32),
    /// One that the core runs.
    Running(Box<Running>),
    /// There is none, for this reason.
    Refused(String),
}

/// A search that the core runs, as far as it has answered.
#[derive(Clone, Debug, Default)]
struct Running {
    search: ContentKey,
    trace: GrowthTrace,
    /// How many of its samples are looked at.
    samples: u32,
    is_complete: bool,
}

/// A search as it stands after some samples, to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// Where the trees begin.
    pub roots_m: Vec<Point2<f64>>,
    /// The edges, each with the number of its tree.
    pub edges: Vec<(usize, Vec<Point2<f64>>)>,
    /// The best path so far.
    pub path_m: Option<Vec<Point2<f64>>>,
    /// The last sample, and whether an obstacle was in its way.
    pub sample: Option<(Point2<f64>, bool)>,
}

/// What can be asked of the growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrowthCommand {
    /// Shows the growth for the selected traverse, or the first one; hides it if it is shown.
    Toggle,
    /// Hides it.
    Close,
    /// Another leg of the traverse, from 0.
    ChooseLeg(usize),
    /// Another planner; `None` for the search that planned the leg.
    ChoosePlanner(Option<PlannerKind>),
    /// To this number of samples.
    GoTo(u32),
    /// So many samples more, or fewer if negative.
    Step(i64),
    /// Lets samples be drawn by themselves, or stops.
    TogglePlaying,
}

/// What a growth is made from.
#[derive(Clone, Copy)]
pub struct GrowthInput<'a> {
    /// The mission.
    pub snapshot: &'a Snapshot,
    /// What is selected.
    pub selection: &'a Selection,
}

/// Seconds that a whole search takes to play at rate 1, and the least and greatest number of samples a second.
const PLAY_SECS: f64 = 8.0;
const SAMPLES_PER_SEC: [f64; 2] = [6.0, 600.0];

impl Default for Growth {
    fn default() -> Self {
        Self { planner: None, is_playing: false, shown: None, elapsed_samples: 0.0, wants_answer: false }
    }
}

impl Growth {
    /// What is looked at.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Does what `command` asks for; without a mission and its ground there is nothing to show.
    pub fn apply(&mut self, command: GrowthCommand, input: Option<GrowthInput<'_>>) {
        let Some(input) = input else {
            self.close();
            return;
        };
        match command {
            GrowthCommand::Close => self.close(),
            GrowthCommand::Toggle if self.shown.is_some() => self.close(),
            GrowthCommand::Toggle => {
                let network = input.snapshot.network.as_deref();
                let selected = network.and_then(|network| input.selection.occurrence(network));
                let traverses = &input.snapshot.traverses;
                let traverse =
                    traverses.iter().find(|it| Some(it.occurrence) == selected).or(traverses.first());
                if let Some(traverse) = traverse {
                    self.shown = self.start(&input, traverse, 0);
                }
            }
            GrowthCommand::ChooseLeg(leg) => self.restart(&input, leg),
            GrowthCommand::ChoosePlanner(planner) => {
                self.planner = planner;
                let leg = self.shown.as_ref().map_or(0, |shown| shown.leg);
                self.restart(&input, leg);
            }
            GrowthCommand::GoTo(samples) => {
                if let Some(shown) = &mut self.shown {
                    shown.go_to(samples);
                }
            }
            GrowthCommand::Step(samples) => {
                if let Some(shown) = &mut self.shown {
                    let target = i64::from(shown.samples()).saturating_add(samples).max(0);
                    shown.go_to(u32::try_from(target).unwrap_or(u32::MAX));
                }
            }
            GrowthCommand::TogglePlaying => self.toggle_playing(),
        }
    }

    /// Looks at the same leg of another snapshot, at the same number of samples; nothing if it is gone.
    pub fn follow(&mut self, input: Option<GrowthInput<'_>>) {
        let Some(before) = &self.shown else { return };
        let (leg, samples, name) = (before.leg, before.samples(), before.name.clone());
        let traverse = input.and_then(|input| Some((input, named_traverse(input.snapshot, &name)?)));
        let Some((input, traverse)) = traverse else {
            self.close();
            return;
        };
        let running = match self.shown.take().map(|shown| shown.walk) {
            // Until the core has answered, what was known is shown; it may still hold.
            Some(walk @ Walk::Running(_)) => Some(walk),
            _ => None,
        };
        self.shown = self.start(&input, traverse, leg);
        if let Some(shown) = &mut self.shown {
            if let (Walk::Running(_), Some(running)) = (&shown.walk, running) {
                shown.walk = running;
                shown.total = shown.known();
            }
            shown.go_to(samples);
        }
    }

    /// What to ask the core, once whenever that has changed; `update` is the mission that is shown.
    pub fn take_request(&mut self, update: impl FnOnce() -> Option<Update>) -> Option<PathGrowth> {
        if !self.wants_answer {
            return None;
        }
        let update = update()?;
        self.wants_answer = false;
        let shown = self.shown.as_ref()?;
        let Walk::Running(running) = &shown.walk else { return None };
        Some(PathGrowth {
            update,
            traverse: shown.name.clone(),
            leg: shown.leg as u32,
            planner: self.planner?,
            held_search: running.search,
            held: running.trace.steps.len() as u32,
        })
    }

    /// Takes what the core answered.
    pub fn take(&mut self, standing: GrowthStanding) {
        let Some(shown) = &mut self.shown else { return };
        let is_wanted = shown.name == standing.traverse
            && shown.leg == standing.leg as usize
            && self.planner == Some(standing.planner);
        let Walk::Running(running) = &mut shown.walk else { return };
        if !is_wanted || standing.first as usize > running.trace.steps.len() {
            return;
        }
        if let Some(refusal) = standing.refusal {
            shown.walk = Walk::Refused(refusal);
            shown.total = 0;
            return;
        }
        running.search = standing.search;
        running.trace.roots_m = standing.roots_m;
        running.trace.steps.truncate(standing.first as usize);
        running.trace.steps.extend(standing.steps);
        running.is_complete = standing.is_complete;
        running.samples = running.samples.min(running.trace.steps.len() as u32);
        shown.total = shown.known();
    }

    /// Lets `seconds` go by. Returns whether more samples were drawn.
    pub fn advance(&mut self, seconds: f64, rate: f64) -> bool {
        let Some(shown) = self.shown.as_mut().filter(|_| self.is_playing) else { return false };
        let [least, greatest] = SAMPLES_PER_SEC;
        let per_second = (f64::from(shown.total) / PLAY_SECS).clamp(least, greatest);
        self.elapsed_samples += seconds * rate * per_second;
        let samples = self.elapsed_samples as u32;
        if samples == 0 {
            return false;
        }
        self.elapsed_samples -= f64::from(samples);
        shown.go_to(shown.samples() + samples);
        self.is_playing = shown.samples() < shown.total || !shown.is_complete();
        true
    }

    fn close(&mut self) {
        self.shown = None;
        self.is_playing = false;
    }

    fn toggle_playing(&mut self) {
        self.elapsed_samples = 0.0;
        if let Some(shown) = &mut self.shown {
            if !self.is_playing && shown.samples() >= shown.total {
                shown.go_to(0);
            }
            self.is_playing = !self.is_playing && (shown.total > 0 || !shown.is_complete());
        }
    }

    fn restart(&mut self, input: &GrowthInput<'_>, leg: usize) {
        let Some(name) = self.shown.as_ref().map(|shown| shown.name.clone()) else { return };
        if let Some(traverse) = named_traverse(input.snapshot, &name) {
            self.is_playing = false;
            self.shown = self.start(input, traverse, leg);
        }
    }

    fn start(&mut self, input: &GrowthInput<'_>, traverse: &mission::Traverse, leg: usize) -> Option<Shown> {
        let leg = leg.min(traverse.legs.len().checked_sub(1)?);
        let way = &traverse.legs[leg];
        let walk = match self.planner {
            None => Walk::Recorded(Arc::clone(&way.growth), 0),
            Some(_) => Walk::Running(Box::default()),
        };
        self.wants_answer = matches!(walk, Walk::Running(_));
        let network = input.snapshot.network.as_deref()?;
        let mut shown = Shown {
            occurrence: traverse.occurrence,
            name: network.occurrences.get(traverse.occurrence.index())?.name.clone(),
            leg,
            goals: traverse.legs.iter().map(|leg| leg.to.clone()).collect(),
            total: 0,
            walk,
        };
        shown.total = shown.known();
        Some(shown)
    }
}

impl Shown {
    /// Samples drawn so far.
    pub fn samples(&self) -> u32 {
        match &self.walk {
            Walk::Recorded(_, samples) => *samples,
            Walk::Running(running) => running.samples,
            Walk::Refused(_) => 0,
        }
    }

    /// Samples that are known.
    fn known(&self) -> u32 {
        match &self.walk {
            Walk::Recorded(trace, _) => trace.steps.len() as u32,
            Walk::Running(running) => running.trace.steps.len() as u32,
            Walk::Refused(_) => 0,
        }
    }

    /// Whether all samples of the search are known.
    pub fn is_complete(&self) -> bool {
        match &self.walk {
            Walk::Running(running) => running.is_complete,
            Walk::Recorded(..) | Walk::Refused(_) => true,
        }
    }

    /// Why there is no search.
    pub fn refusal(&self) -> Option<&str> {
        match &self.walk {
            Walk::Refused(reason) => Some(reason),
            _ => None,
        }
    }

    /// Vertices of all trees.
    pub fn vertices(&self) -> u32 {
        match &self.walk {
            Walk::Recorded(trace, samples) => {
                (trace.roots_m.len() + trace.grown(*samples as usize).count()) as u32
            }
            Walk::Running(running) => {
                let grown = running.trace.grown(running.samples as usize).count();
                (running.trace.roots_m.len() + grown) as u32
            }
            Walk::Refused(_) => 0,
        }
    }

    /// What the last sample did.
    pub fn last(&self) -> Option<&GrowthStep> {
        let (trace, samples) = match &self.walk {
            Walk::Recorded(trace, samples) => (trace.as_ref(), *samples),
            Walk::Running(running) => (&running.trace, running.samples),
            Walk::Refused(_) => return None,
        };
        trace.steps.get((samples as usize).checked_sub(1)?)
    }

    /// The length of the best path so far in metres.
    pub fn length_m(&self) -> Option<f64> {
        match &self.walk {
            Walk::Recorded(trace, samples) => {
                trace.path_m(*samples as usize).map(mission::traverse::length_m)
            }
            Walk::Running(running) => {
                running.trace.path_m(running.samples as usize).map(mission::traverse::length_m)
            }
            Walk::Refused(_) => None,
        }
    }

    /// The search as it stands, to be drawn.
    pub fn standing(&self) -> Standing {
        match &self.walk {
            Walk::Recorded(trace, samples) => recorded(trace, *samples as usize),
            Walk::Running(running) => running.standing(),
            Walk::Refused(_) => Standing::default(),
        }
    }

    /// Goes to a number of samples, or to the end.
    fn go_to(&mut self, samples: u32) {
        match &mut self.walk {
            Walk::Recorded(trace, at) => *at = samples.min(trace.steps.len() as u32),
            Walk::Running(running) => running.samples = samples.min(running.trace.steps.len() as u32),
            Walk::Refused(_) => {}
        }
    }
}

/// A vertex of a tree as it stands.
struct Vertex<'a> {
    parent: Option<u32>,
    point_m: Point2<f64>,
    /// The way from its first parent, if that was not straight.
    curve_m: &'a [Point2<f64>],
}

impl Running {
    /// The trees after the samples that are looked at; vertices that got another parent hang on that.
    fn standing(&self) -> Standing {
        let samples = self.samples as usize;
        let root = |&point_m: &Point2<f64>| vec![Vertex { parent: None, point_m, curve_m: &[] }];
        let mut trees: Vec<Vec<Vertex<'_>>> = self.trace.roots_m.iter().map(root).collect();
        for step in self.trace.steps.iter().take(samples) {
            for &[tree, vertex, parent] in &step.rewired {
                if let Some(vertex) = trees.get_mut(tree as usize).and_then(|it| it.get_mut(vertex as usize))
                {
                    vertex.parent = Some(parent);
                }
            }
            for grown in &step.added {
                let vertex =
                    Vertex { parent: Some(grown.parent), point_m: grown.point_m, curve_m: &grown.curve_m };
                if let Some(tree) = trees.get_mut(grown.tree as usize) {
                    tree.push(vertex);
                }
            }
        }
        let last = samples.checked_sub(1).and_then(|last| self.trace.steps.get(last));
        let edges = trees.iter().enumerate().flat_map(|(number, tree)| {
            tree.iter().filter_map(move |vertex| {
                let parent = tree.get(vertex.parent? as usize)?;
                let mut way = vec![parent.point_m];
                if vertex.curve_m.is_empty() {
                    way.push(vertex.point_m);
                } else {
                    way.extend(vertex.curve_m);
                }
                Some((number, way))
            })
        });
        Standing {
            edges: edges.collect(),
            roots_m: self.trace.roots_m.clone(),
            path_m: self.trace.path_m(samples).map(<[_]>::to_vec),
            sample: last.map(|step| (step.sample_m, step.added.is_empty())),
        }
    }
}

fn recorded(trace: &GrowthTrace, samples: usize) -> Standing {
    let last = samples.checked_sub(1).and_then(|last| trace.steps.get(last));
    Standing {
        roots_m: trace.roots_m.clone(),
        edges: trace
            .grown(samples)
            .map(|grown| (grown.tree as usize, vec![grown.from_m, grown.point_m]))
            .collect(),
        path_m: trace.path_m(samples).map(<[_]>::to_vec),
        sample: last.map(|step| (step.sample_m, step.added.is_empty())),
    }
}

/// The obstacles of a world for path planning.
pub fn obstacles(world: &World) -> Vec<Obstacle> {
    world.obstacles.iter().map(|it| mission::ground::obstacle(&it.shape)).collect()
}

/// The name of a planner on screen; `None` is the search that planned the leg.
pub const fn planner_title(planner: Option<PlannerKind>) -> &'static str {
    match planner {
        None => "As planned",
        Some(PlannerKind::Rrt) => "RRT",
        Some(PlannerKind::RrtConnect) => "RRT-Connect",
        Some(PlannerKind::RrtStar) => "RRT*",
        Some(PlannerKind::Kinodynamic) => "Kinodynamic RRT",
    }
}

fn named_traverse<'a>(snapshot: &'a Snapshot, name: &str) -> Option<&'a mission::Traverse> {
    let network = snapshot.network.as_deref()?;
    snapshot
        .traverses
        .iter()
        .find(|it| network.occurrences.get(it.occurrence.index()).is_some_and(|found| found.name == name))
}

//! Searches for the path of one leg, sample by sample: the trees growing from its ends.
//!
//! It is the recorded search that planned the leg, another planner's on the same ground from the same seed, or a race of
//! all planners. Other planners are run by the core, which answers what each sample did as it continues.

mod search;
mod wording;

use std::sync::Arc;

use link::request::Update;
use link::{GrowthStanding, PathGrowth};
use motion::{GrowthStep, PlannerKind};
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::OccurrenceId;

pub use search::{Counts, LastSample, Search, Standing};

use crate::state::selection::Selection;

/// The growth that is looked at, if one is.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// Whose searches are shown.
    pub planners: Planners,
    /// Whether samples are drawn by themselves.
    pub is_playing: bool,
    shown: Option<Shown>,
    elapsed_samples: f64,
    /// Whether the core is to be asked for searches.
    wants_answer: bool,
}

/// Whose searches are looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planners {
    /// The search that planned the leg.
    #[default]
    AsPlanned,
    One(PlannerKind),
    /// Those of all planners, which draw their samples side by side.
    Race,
}

/// What is looked at: the searches for one leg.
#[derive(Clone, Debug)]
pub struct Shown {
    pub occurrence: OccurrenceId,
    /// Its name, by which it is found again in another network.
    pub name: SmolStr,
    /// The leg, from 0.
    pub leg: usize,
    /// The places of the traverse, as many as its legs: where each leads.
    pub goals: Vec<SmolStr>,
    /// The searches: one, or those that race.
    pub searches: Vec<Search>,
    /// How many samples of each are looked at, if it has as many.
    at: u32,
}

/// What can be asked of the growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrowthCommand {
    /// Shows the growth for the selected traverse, or the first one; hides it if it is shown.
    Toggle,
    Close,
    /// Another leg of the traverse, from 0.
    ChooseLeg(usize),
    /// Other planners.
    Choose(Planners),
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
    pub snapshot: &'a Snapshot,
    /// What is selected.
    pub selection: &'a Selection,
}

/// Seconds that a whole search takes to play at rate 1, and the least and greatest number of samples a second.
const PLAY_SECS: f64 = 8.0;
const SAMPLES_PER_SEC: [f64; 2] = [6.0, 600.0];

impl Planners {
    /// In the order of menus.
    pub const ALL: [Self; 6] = [
        Self::AsPlanned,
        Self::One(PlannerKind::Rrt),
        Self::One(PlannerKind::RrtConnect),
        Self::One(PlannerKind::RrtStar),
        Self::One(PlannerKind::Kinodynamic),
        Self::Race,
    ];

    /// Their name in lessons and for programs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AsPlanned => "as-planned",
            Self::One(PlannerKind::Rrt) => "rrt",
            Self::One(PlannerKind::RrtConnect) => "rrt-connect",
            Self::One(PlannerKind::RrtStar) => "rrt-star",
            Self::One(PlannerKind::Kinodynamic) => "kinodynamic",
            Self::Race => "race",
        }
    }

    /// Those of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.name() == name)
    }

    /// Their name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::AsPlanned => "Planner of the plan",
            Self::One(planner) => planner_title(planner),
            Self::Race => "All planners",
        }
    }
}

/// The name of a planner on screen.
pub const fn planner_title(planner: PlannerKind) -> &'static str {
    match planner {
        PlannerKind::Rrt => "RRT",
        PlannerKind::RrtConnect => "RRT-Connect",
        PlannerKind::RrtStar => "RRT*",
        PlannerKind::Kinodynamic => "Kinodynamic RRT",
    }
}

impl Growth {
    /// Returns what the last sample of the growth that is looked at did.
    pub fn last_sample(&self) -> Option<&GrowthStep> {
        self.shown()?.last()
    }

    /// The growth that is looked at.
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
            GrowthCommand::Choose(planners) => {
                self.planners = planners;
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

    /// Looks at the same leg of another snapshot, at the same number of samples. Where its plan drives no such leg, that
    /// is said; nothing is shown if there is no such activity any more.
    pub fn follow(&mut self, input: Option<GrowthInput<'_>>) {
        let Some(before) = self.shown.take() else { return };
        let network = input.and_then(|input| input.snapshot.network.as_deref());
        let (Some(input), Some(network)) = (input, network) else {
            self.close();
            return;
        };
        let Some(traverse) = named_traverse(input.snapshot, &before.name) else {
            let named = |it: &tpn::Occurrence| it.name == before.name;
            match network.occurrences.iter().position(named) {
                Some(at) => self.shown = Some(before.without_path(OccurrenceId::from_index(at))),
                None => self.close(),
            }
            return;
        };
        // Who has seen all samples continues to see all of them.
        let saw_all = before.total() > 0 && before.is_complete() && before.at >= before.total();
        self.shown = self.start(&input, traverse, before.leg);
        if let Some(shown) = &mut self.shown {
            for (search, known) in shown.searches.iter_mut().zip(before.searches) {
                // Until the core has answered, what was known is shown; it may still hold.
                if known.planner.is_some() && known.planner == search.planner && known.refusal().is_none() {
                    *search = known;
                }
            }
            shown.at = if saw_all { u32::MAX } else { before.at };
        }
    }

    /// Returns whether the core is to be asked for searches.
    pub(crate) const fn wants_answer(&self) -> bool {
        self.wants_answer
    }

    /// Returns what to ask the core, once whenever that has changed; `update` is the mission that is shown.
    pub fn take_request(&mut self, update: Update) -> Option<PathGrowth> {
        self.wants_answer = false;
        let shown = self.shown.as_ref()?;
        let planners: Vec<_> = shown.searches.iter().filter_map(Search::wanted).collect();
        let request = PathGrowth { update, traverse: shown.name.clone(), leg: shown.leg as u32, planners };
        (!request.planners.is_empty()).then_some(request)
    }

    /// Takes what the core answered.
    pub fn take(&mut self, standing: GrowthStanding) {
        let Some(shown) = &mut self.shown else { return };
        if shown.name == standing.traverse && shown.leg == standing.leg as usize {
            let planner = Some(standing.planner);
            if let Some(search) = shown.searches.iter_mut().find(|search| search.planner == planner) {
                search.take(standing);
            }
        }
    }

    /// Lets `seconds` go by. Returns whether more samples were drawn.
    pub fn advance(&mut self, seconds: f64, rate: f64) -> bool {
        let Some(shown) = self.shown.as_mut().filter(|_| self.is_playing) else { return false };
        let [least, greatest] = SAMPLES_PER_SEC;
        let per_second = (f64::from(shown.total()) / PLAY_SECS).clamp(least, greatest);
        self.elapsed_samples += seconds * rate * per_second;
        let samples = self.elapsed_samples as u32;
        if samples == 0 {
            return false;
        }
        self.elapsed_samples -= f64::from(samples);
        shown.go_to(shown.samples() + samples);
        self.is_playing = shown.samples() < shown.total() || !shown.is_complete();
        true
    }

    fn close(&mut self) {
        self.shown = None;
        self.is_playing = false;
    }

    fn toggle_playing(&mut self) {
        self.elapsed_samples = 0.0;
        if let Some(shown) = &mut self.shown {
            if !self.is_playing && shown.samples() >= shown.total() {
                shown.go_to(0);
            }
            self.is_playing = !self.is_playing && (shown.total() > 0 || !shown.is_complete());
        }
    }

    fn restart(&mut self, input: &GrowthInput<'_>, leg: usize) {
        let Some(name) = self.shown.as_ref().map(|shown| shown.name.clone()) else { return };
        if let Some(traverse) = named_traverse(input.snapshot, &name) {
            self.is_playing = false;
            self.shown = self.start(input, traverse, leg);
        }
    }

    fn start(&mut self, input: &GrowthInput<'_>, traverse: &snapshot::Traverse, leg: usize) -> Option<Shown> {
        let leg = leg.min(traverse.legs.len().checked_sub(1)?);
        let way = &traverse.legs[leg];
        let searches = match self.planners {
            Planners::AsPlanned => vec![Search::recorded(Arc::clone(&way.growth))],
            Planners::One(planner) => vec![Search::awaited(planner)],
            Planners::Race => PlannerKind::ALL.map(Search::awaited).to_vec(),
        };
        self.wants_answer = self.planners != Planners::AsPlanned;
        let network = input.snapshot.network.as_deref()?;
        Some(Shown {
            occurrence: traverse.occurrence,
            name: network.occurrences.get(traverse.occurrence.index())?.name.clone(),
            leg,
            goals: traverse.legs.iter().map(|leg| leg.to.clone()).collect(),
            searches,
            at: 0,
        })
    }
}

impl Shown {
    /// Samples drawn so far: of a race, by whoever has drawn most.
    pub fn samples(&self) -> u32 {
        self.at.min(self.total())
    }

    /// Samples that are known: of a race, of the longest search.
    pub fn total(&self) -> u32 {
        self.searches.iter().map(Search::known).max().unwrap_or(0)
    }

    /// Returns whether all samples of all searches are known.
    pub fn is_complete(&self) -> bool {
        self.searches.iter().all(Search::is_complete)
    }

    /// Returns why there is no search: said where there is none at all.
    pub fn refusal(&self) -> Option<&str> {
        let has_one = self.searches.iter().any(|search| search.refusal().is_none());
        self.searches.iter().find_map(Search::refusal).filter(|_| !has_one)
    }

    /// Returns whether several searches are looked at.
    pub const fn is_race(&self) -> bool {
        self.searches.len() > 1
    }

    /// Returns what the search has done by now; of a race, its first search.
    pub fn counts(&self) -> Counts {
        self.counts_of(0)
    }

    /// Returns what one of the searches has done by now.
    pub fn counts_of(&self, search: usize) -> Counts {
        let none = Counts { samples: 0, vertices: 0, checks: 0, length_m: None };
        self.searches.get(search).map_or(none, |search| search.counts(self.samples()))
    }

    /// Returns what the last sample did, in the first search.
    pub fn last(&self) -> Option<&GrowthStep> {
        self.searches.first()?.last(self.samples())
    }

    /// The searches as they stand, to be drawn, in their order.
    pub fn standings(&self) -> impl Iterator<Item = Standing> {
        self.searches.iter().map(|search| search.standing(self.samples()))
    }

    /// Goes to a number of samples, or to the end.
    fn go_to(&mut self, samples: u32) {
        self.at = samples.min(self.total());
    }

    /// The same leg while no plan drives it.
    fn without_path(self, occurrence: OccurrenceId) -> Self {
        let reason = format!("{} has no planned path. The Plan panel explains why.", self.name);
        let refuse = |search: Search| Search::refused(search.planner, reason.clone());
        Self { occurrence, searches: self.searches.into_iter().map(refuse).collect(), ..self }
    }
}

fn named_traverse<'a>(snapshot: &'a Snapshot, name: &str) -> Option<&'a snapshot::Traverse> {
    let network = snapshot.network.as_deref()?;
    snapshot
        .traverses
        .iter()
        .find(|it| network.occurrences.get(it.occurrence.index()).is_some_and(|found| found.name == name))
}

//! A mission text worked out by the shared core, as the page does it: compiled, planned, and driven.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use mission::{Core, CoreHost, Goal, Request, Response, SearchKind, Snapshot, Update};
use terrain::Terrain;

use crate::deadline::{Deadline, TimeIsUp};
use crate::ground::map_file;
use crate::input::read_mission;
use crate::load::Target;

/// A mission, worked out.
pub struct WorkedOut {
    /// Its file's name, for messages.
    pub name: String,
    /// Everything known of it.
    pub snapshot: Arc<Snapshot>,
    /// Its ground, if it has one.
    pub ground: Option<Arc<Terrain>>,
}

/// Works out the mission that `target` names. Fails when it cannot be read, or is a network.
pub fn work_out(target: &Target, seed: u64, deadline: Deadline) -> anyhow::Result<WorkedOut> {
    let is_network = target.file.extension().is_some_and(|ending| ending == "json" || ending == "edn");
    anyhow::ensure!(!is_network, "this command wants a mission text, not a network");
    let name = target.file.file_name().filter(|name| *name != "-");
    let name = name.map_or_else(|| "mission".to_owned(), |name| name.to_string_lossy().into_owned());
    work_out_text(name, &target.file, &read_mission(&target.file)?, target.goal()?, seed, deadline)
}

/// Works out a mission text. The map file that it names, if it names one, lies beside `file`.
pub fn work_out_text(
    name: String,
    file: &Path,
    source: &str,
    goal: Goal,
    seed: u64,
    deadline: Deadline,
) -> anyhow::Result<WorkedOut> {
    let update = Update {
        revision: 1,
        source: source.into(),
        goal,
        search: SearchKind::default(),
        seed,
        trace: false,
    };
    let mut answers =
        Answers { begun: Instant::now(), deadline, snapshot: None, ground: None, rejected: None };
    let mut core = Core::default();
    if let Some((name, bytes)) = map_file(file, &rmpl::parse(source).program().world)? {
        core.handle(Request::ImportMap { name: name.into(), bytes }, &mut answers);
        if let Some(reason) = answers.rejected.take() {
            anyhow::bail!("the terrain cannot be used: {reason}");
        }
    }
    core.handle(Request::Update(update), &mut answers);
    if answers.snapshot.is_none() && deadline.is_over() {
        return Err(TimeIsUp.into());
    }
    Ok(WorkedOut {
        name,
        snapshot: answers.snapshot.ok_or_else(|| anyhow::anyhow!("the planning core gave no answer"))?,
        ground: answers.ground,
    })
}

/// Keeps the last answers of the core.
struct Answers {
    begun: Instant,
    deadline: Deadline,
    snapshot: Option<Arc<Snapshot>>,
    ground: Option<Arc<Terrain>>,
    /// Why a map was not taken.
    rejected: Option<String>,
}

impl CoreHost for Answers {
    fn now_millis(&self) -> f64 {
        self.begun.elapsed().as_secs_f64() * 1000.0
    }

    fn is_superseded(&mut self) -> bool {
        self.deadline.is_over()
    }

    fn answer(&mut self, response: Response) {
        match response {
            Response::Snapshot(snapshot) => self.snapshot = Some(snapshot),
            Response::Map { map, .. } => self.ground = Some(map),
            Response::MapRejected { reason, .. } => self.rejected = Some(reason),
            _ => {}
        }
    }
}

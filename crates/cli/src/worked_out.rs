//! A mission text worked out by the shared core, as the page does it: compiled, planned, and driven.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use kirk::Search as SearchKind;
use link::{Request, Response, Update};
use mission::{Core, CoreHost};
use snapshot::{Goal, Snapshot};
use terrain::Terrain;

use crate::deadline::{Deadline, TimeIsUp, Undecided};
use crate::ground::map_file;
use crate::input::{read_mission, read_text};
use crate::load::{Target, is_network, read_network};

/// A mission, worked out.
pub struct WorkedOut {
    /// Its file's name, for messages.
    pub name: String,
    /// Everything known of it.
    pub snapshot: Arc<Snapshot>,
    /// Its ground, if it has one.
    pub ground: Option<Arc<Terrain>>,
}

/// Works out the mission or the network that `target` names. Fails when it cannot be read.
pub fn work_out(target: &Target, seed: u64, deadline: Deadline) -> anyhow::Result<WorkedOut> {
    let name = target.file.file_name().filter(|name| *name != "-");
    let name = name.map_or_else(|| "mission".to_owned(), |name| name.to_string_lossy().into_owned());
    if is_network(&target.file.to_string_lossy(), "") {
        return work_out_network(name, &read_text(&target.file)?, deadline);
    }
    let source = read_mission(&target.file)?;
    if target.file == Path::new("-") && is_network("-", &source) {
        return work_out_network(name, &source, deadline);
    }
    work_out_text(name, &target.file, &source, target.goal()?, seed, deadline)
}

/// Works out a network of a file.
fn work_out_network(name: String, source: &str, deadline: Deadline) -> anyhow::Result<WorkedOut> {
    let (network, problems) = read_network(&name, source)?;
    let snapshot =
        mission::planned_network(source.into(), Arc::new(network), problems, &mut || deadline.is_over());
    if let Some(planning) = &snapshot.planning {
        deadline.check(&planning.outcome)?;
    }
    Ok(WorkedOut { name, snapshot: Arc::new(snapshot), ground: None })
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
    let late = TimeIsUp(Undecided::Plan);
    let Some(snapshot) = answers.snapshot else {
        anyhow::ensure!(!deadline.is_over(), late);
        anyhow::bail!("the planning core gave no answer");
    };
    match &snapshot.planning {
        Some(planning) => deadline.check(&planning.outcome)?,
        // What is compiled is answered before it is planned.
        None => anyhow::ensure!(snapshot.network.is_none() || !deadline.is_over(), late),
    }
    Ok(WorkedOut { name, snapshot, ground: answers.ground })
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

//! A mission or a network of a file, which the core reads, compiles and plans: each command means what the page means.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Context as _;
use interchange::Source;
use link::{Request, Response, Update};
use mission::{Compiled, Core, CoreHost, Evaluated, Ground, Manner, SavedState, Scenarios};
use rmpl::program::{Program, World};
use rmpl::{Diagnostic, Severity};
use serde_json::Value;
use snapshot::{Goal, Problem, Snapshot};
use terrain::Terrain;

use crate::deadline::{Deadline, TimeIsUp, Undecided};
use crate::diagnostics::print_problems;
use crate::ground::{cannot_read, map_file};
use crate::input::{mission_of, read_text};
use crate::output::{Format, WRONG, document, exit, print_json};
use crate::target::{Target, is_network};

/// A file with the core that evaluates it.
pub struct Opened {
    /// Its name as it was given, for messages.
    pub name: String,
    /// Its text, joined with the texts of the files that it imports.
    pub source: Arc<str>,
    pub core: Core,
    file: PathBuf,
    /// Whether the file must be a network, so that it is an error if it cannot be read as one.
    must_be_network: bool,
    update: Update,
    host: Host,
}

impl Target {
    /// Reads the file.
    pub fn open(&self) -> anyhow::Result<Opened> {
        let text = read_text(&self.file)?;
        if is_network(&self.file.to_string_lossy(), &text) {
            return Ok(Opened { must_be_network: true, ..Opened::new(&self.file, text, Goal::Default) });
        }
        anyhow::ensure!(
            !interchange::pddl::is_pddl(&text),
            "{} is PDDL; write it as a mission with enroute import DOMAIN PROBLEM",
            self.file.display()
        );
        Ok(Opened::new(&self.file, mission_of(&self.file, &text)?, self.goal()?))
    }
}

impl Opened {
    /// A text that was read from `file`.
    pub fn new(file: &Path, source: String, goal: Goal) -> Self {
        let source: Arc<str> = source.into();
        Self {
            name: file.display().to_string(),
            source: Arc::clone(&source),
            core: Core::default(),
            file: file.to_owned(),
            must_be_network: false,
            update: Update { goal, ..Update::new(1, source) },
            host: Host::default(),
        }
    }

    /// Lets the mission start from a state. Fails if the state names what the mission does not declare. A mission with errors is
    /// left to [`Self::compile`], which reports them.
    pub fn start_from(&mut self, start: SavedState) -> anyhow::Result<()> {
        anyhow::ensure!(
            !self.must_be_network,
            "{} is a network; only a mission can start from a state",
            self.name
        );
        let parse = rmpl::parse(&self.source);
        if parse.diagnostics().iter().all(|found| found.severity != Severity::Error)
            && let Some(undeclared) = start.undeclared(&parse.program())
        {
            anyhow::bail!("{} cannot start from this state: {undeclared}", self.name);
        }
        self.core.start_from(start);
        Ok(())
    }

    /// Compiles the text. Fails when it is a network that cannot be read.
    pub fn compile(&mut self) -> anyhow::Result<Compiled> {
        let compiled = self.core.compile(&self.update, &self.host);
        self.readable(Some(&compiled))?;
        self.is_mission(compiled.network().is_some())?;
        Ok(compiled)
    }

    /// Finds everything that is wrong with the text, and what there is to plan if the mission has ground.
    pub fn compile_all(&mut self) -> anyhow::Result<Scenarios> {
        let all = self.core.compile_all(&self.update, &self.host);
        self.readable(all.scenarios.first())?;
        Ok(all)
    }

    fn readable(&self, compiled: Option<&Compiled>) -> anyhow::Result<()> {
        if self.must_be_network && compiled.is_none_or(|compiled| compiled.network().is_none()) {
            Source::read(&self.source).with_context(|| format!("cannot read {}", self.name))?;
        }
        Ok(())
    }

    /// Fails if there is no network because the text is a control program.
    fn is_mission(&self, has_network: bool) -> anyhow::Result<()> {
        anyhow::ensure!(
            has_network || !rmpl::control::is_control_text(&self.source),
            "{} is a control program; use `enroute run`",
            self.name
        );
        Ok(())
    }

    /// Answers where errors prevent a network.
    pub fn refuse(
        &self,
        problems: &[Problem],
        format: Format,
        (kind, body): (&str, Value),
    ) -> anyhow::Result<ExitCode> {
        match format {
            Format::Json => print_json(&document(kind, problems, body))?,
            Format::Text => print_problems(&self.name, &self.source, problems)?,
        }
        Ok(exit(WRONG))
    }

    /// The ground that a mission names: a terrain of Enroute, or a map file beside the mission. Fails when there is neither,
    /// or the file is not a map.
    pub fn ground(&mut self, compiled: &Compiled) -> anyhow::Result<Option<Ground>> {
        self.ground_or_problem(&compiled.program)?.map_err(|problem| {
            let hint = problem.hint.map_or_else(String::new, |hint| format!(" ({hint})"));
            anyhow::anyhow!("{}{hint}", problem.message)
        })
    }

    /// The ground as `ground` finds it, or what is wrong with the mission that names it. Fails when the file is not a map.
    pub fn ground_or_problem(
        &mut self,
        program: &Program,
    ) -> anyhow::Result<Result<Option<Ground>, Diagnostic>> {
        self.import_map(&program.world)?;
        Ok(self.core.ground(program).map_err(|mut problem| {
            let beside = "put the map file into the mission's folder";
            let hint = problem.hint.map_or_else(|| beside.to_owned(), |hint| format!("{hint}; {beside}"));
            problem.hint = Some(hint);
            *problem
        }))
    }

    fn import_map(&mut self, world: &World) -> anyhow::Result<()> {
        let Some((name, bytes)) = map_file(&self.file, world)? else { return Ok(()) };
        self.core.import(&name, &bytes).map_err(anyhow::Error::msg).with_context(|| cannot_read(&name))
    }

    /// Plans what was compiled. Fails when the time is up, unless the best plan so far is enough then.
    pub fn plan(
        &mut self,
        compiled: Compiled,
        ground: Option<Ground>,
        manner: Manner,
        deadline: Deadline,
    ) -> anyhow::Result<Evaluated> {
        self.host.deadline = deadline;
        self.host.has_grace = manner.most_millis.is_some();
        let evaluated = self.core.plan(compiled, ground, manner, &mut self.host);
        let evaluated = evaluated.context("a mission with errors cannot be planned")?;
        if !self.host.has_grace {
            deadline.check(&evaluated.planned.planning.outcome)?;
        }
        Ok(evaluated)
    }

    /// Evaluates the text for commands that read snapshots. Returns the ground as well, if the mission has one.
    pub fn evaluate(
        mut self,
        seed: u64,
        deadline: Deadline,
    ) -> anyhow::Result<(Arc<Snapshot>, Option<Arc<Terrain>>)> {
        let compiled = self.compile()?;
        self.import_map(&compiled.program.world)?;
        self.host.deadline = deadline;
        self.core.handle(Request::Update(Update { seed, ..self.update }), &mut self.host);
        let late = TimeIsUp(Undecided::Plan);
        let Some(snapshot) = self.host.snapshot else {
            anyhow::ensure!(!deadline.is_over(), late);
            anyhow::bail!("the planning core gave no answer");
        };
        match &snapshot.planning {
            Some(planning) => deadline.check(&planning.outcome)?,
            // What is compiled is answered before it is planned.
            None => anyhow::ensure!(snapshot.network.is_none() || !deadline.is_over(), late),
        }
        Ok((snapshot, self.host.ground))
    }

    /// The file's name without folders.
    pub fn short_name(&self) -> String {
        let name = self.file.file_name().filter(|name| *name != "-");
        name.map_or_else(|| "mission".to_owned(), |name| name.to_string_lossy().into_owned())
    }
}

/// The clock of the core, and its last answers.
struct Host {
    begun: Instant,
    deadline: Deadline,
    /// Whether the best plan so far may be finished when the time is up.
    has_grace: bool,
    snapshot: Option<Arc<Snapshot>>,
    ground: Option<Arc<Terrain>>,
}

impl Default for Host {
    fn default() -> Self {
        let (begun, deadline) = (Instant::now(), Deadline::default());
        Self { begun, deadline, has_grace: false, snapshot: None, ground: None }
    }
}

impl CoreHost for Host {
    fn now_millis(&self) -> f64 {
        self.begun.elapsed().as_secs_f64() * 1000.0
    }

    fn is_superseded(&mut self) -> bool {
        if self.has_grace { self.deadline.is_long_over() } else { self.deadline.is_over() }
    }

    fn answer(&mut self, response: Response) {
        match response {
            Response::Snapshot(snapshot) => self.snapshot = Some(snapshot),
            Response::Map { map, .. } => self.ground = Some(map),
            _ => {}
        }
    }
}

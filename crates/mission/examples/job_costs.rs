//! Measures what jobs cost that are asked for again and again: a step of a control program and an edit of it, the edit of
//! a comment in a large mission, and the growth of a search tree. `cargo run -p mission --release --example job_costs`.

#![expect(clippy::print_stdout, reason = "the figures are this program's answer")]

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

use executive::model_based::{Options, Run, StepInput};
use link::control_run::Input;
use link::wire::{AskerEnd, CoreEnd};
use link::{ControlRun, ControlStanding, PathGrowth, Request, Response, Update};
use mission::{Control, Core, CoreHost, read_control};
use motion::PlannerKind;
use snapshot::Snapshot;
use tpn::generate::{Recipe, Tightness, mission};

/// The core's host: measures, and passes answers on as bytes.
struct Page {
    begun: Instant,
    core: CoreEnd,
    asker: AskerEnd,
    text: Arc<str>,
    bytes: usize,
    write_millis: f64,
    read_millis: f64,
    snapshot: Option<Arc<Snapshot>>,
    standing: Option<ControlStanding>,
    samples: usize,
    answers: usize,
}

impl CoreHost for Page {
    fn now_millis(&self) -> f64 {
        self.begun.elapsed().as_secs_f64() * 1e3
    }

    fn is_superseded(&mut self) -> bool {
        false
    }

    fn answer(&mut self, response: Response) {
        let begun = self.now_millis();
        let bytes = self.core.write(response).expect("it can be written");
        let written = self.now_millis();
        let response = self.asker.read(&bytes, Arc::clone(&self.text)).expect("it can be read");
        self.write_millis += written - begun;
        self.read_millis += self.now_millis() - written;
        self.bytes += bytes.len();
        self.answers += 1;
        match response {
            Response::Snapshot(snapshot) => self.snapshot = Some(snapshot),
            Response::ControlRun(standing) => self.standing = Some(*standing),
            Response::PathGrowth(standing) => self.samples = standing.first as usize + standing.steps.len(),
            _ => {}
        }
    }
}

fn page() -> Page {
    Page {
        begun: Instant::now(),
        core: CoreEnd::default(),
        asker: AskerEnd::default(),
        text: Arc::default(),
        bytes: 0,
        write_millis: 0.0,
        read_millis: 0.0,
        snapshot: None,
        standing: None,
        samples: 0,
        answers: 0,
    }
}

fn main() {
    control_steps();
    comment_edit();
    growth();
}

/// Breakers that are switched on and off for ever, and trip now and then.
fn breakers(count: usize) -> String {
    let mut text = String::from("Main ():: (PARALLEL");
    for at in 0..count {
        let _ = write!(
            text,
            "\n  (WHENEVER-DONEXT (cb{at} = Off) (cb{at} = On)) (WHENEVER-DONEXT (cb{at} = On) (cb{at} = Off))"
        );
    }
    text.push_str(
        ")\n(DEFCLASS Breaker () (VAR out {dead live} OBSERVABLE) (COMMAND cmd {none on off})
  (MODE Off (out = dead)) (MODE On (out = live)) (MODE Tripped (out = dead))
  (TRANSITION Off On (cmd = on)) (TRANSITION On Off (cmd = off)) (TRANSITION Tripped Off (cmd = off))
  (FAULT On Tripped 1/100))\n",
    );
    for at in 0..count {
        let _ = writeln!(text, "(DEFINSTANCE cb{at} Breaker INIT Off)");
    }
    text
}

fn control_steps() {
    let source = breakers(24);
    let Control::Bound(system) = read_control(&source, None).0 else { panic!("it compiles") };
    let options = Options { seed: Some(1), ..Options::default() };
    for steps in [20, 80] {
        let begun = Instant::now();
        let mut run = Run::new(&system, options);
        for _ in 0..=steps {
            run.step(&StepInput::default()).expect("a step");
        }
        println!("24 breakers, step {steps} from the first step on: {:.1} ms", millis(begun));
    }
    let (mut core, mut page) = (Core::default(), page());
    let mut ask = |source: &str, steps: usize, page: &mut Page| {
        let before = page.standing.take();
        let wanted = ControlRun {
            token: 0,
            revision: 0,
            source: source.into(),
            plant: None,
            seed: Some(1),
            inputs: vec![Input::default(); steps],
            held_program: before.as_ref().map(|it| it.program).unwrap_or_default(),
            held_run: before.as_ref().map(|it| it.run).unwrap_or_default(),
            held: before.map_or(0, |it| it.first + it.moments.len() as u32),
        };
        (page.bytes, page.write_millis, page.read_millis) = (0, 0.0, 0.0);
        let begun = Instant::now();
        core.handle(Request::RunControl(wanted), page);
        (millis(begun) - page.write_millis - page.read_millis, page.bytes, page.read_millis)
    };
    for steps in 0..=80 {
        let (core_millis, bytes, read_millis) = ask(&source, steps, &mut page);
        if [0, 20, 80].contains(&steps) {
            println!(
                "24 breakers, step {steps} as a session: {core_millis:.1} ms in the core, {bytes} bytes, \
                 {read_millis:.2} ms to read them"
            );
        }
    }
    let edits = [
        ("a comment", format!("; A note.\n{source}")),
        ("one more goal", source.replace("Main ():: (PARALLEL", "Main ():: (PARALLEL (cb0 = On)")),
    ];
    for (what, text) in edits {
        let (core_millis, bytes, read_millis) = ask(&text, 80, &mut page);
        println!(
            "24 breakers, edit of {what} at step 80: {core_millis:.1} ms in the core, {bytes} bytes, {read_millis:.2} ms \
             to read them"
        );
    }
}

fn comment_edit() {
    let source = mission(Recipe { nodes: 4000, tightness: Tightness::Feasible, seed: 1 });
    let (mut core, mut page) = (Core::default(), page());
    for (revision, what, text) in [
        (1, "opened", format!("// A note.\n{source}")),
        (2, "comment at its beginning edited", format!("// A longer note.\n{source}")),
        (3, "comment at its end added", format!("// A longer note.\n{source}\n// The end.\n")),
    ] {
        let update = Update { seed: 1, ..Update::new(revision, text) };
        (page.bytes, page.write_millis, page.read_millis) = (0, 0.0, 0.0);
        page.text = Arc::clone(update.source.text());
        let begun = Instant::now();
        core.handle(Request::Update(update), &mut page);
        let whole = millis(begun) - page.write_millis - page.read_millis;
        let snapshot = page.snapshot.as_ref().expect("it is answered");
        let nodes = snapshot.network.as_ref().map_or(0, |network| network.nodes.len());
        println!(
            "mission of {nodes} nodes, {what}: {whole:.2} ms in the core (parse {:.2}, compile {:.2}, plan {:.2}), \
             {} bytes, {:.2} ms to write and {:.2} ms to read them; network {:?}",
            snapshot.timings.parse_millis,
            snapshot.timings.compile_millis,
            snapshot.timings.plan_millis,
            page.bytes,
            page.write_millis,
            page.read_millis,
            snapshot.keys.network,
        );
    }
}

fn growth() {
    let source = include_str!("../../../assets/missions/enroute.rmpl");
    let update = Update { seed: 1, ..Update::new(1, source) };
    let (mut core, mut page) = (Core::default(), page());
    page.text = Arc::clone(update.source.text());
    core.handle(Request::Update(update.clone()), &mut page);
    let snapshot = page.snapshot.clone().expect("it is answered");
    let network = snapshot.network.as_ref().expect("it compiles");
    let traverse = network.occurrences[snapshot.traverses[0].occurrence.index()].name.clone();
    for planner in [PlannerKind::RrtConnect, PlannerKind::RrtStar, PlannerKind::Kinodynamic] {
        (page.bytes, page.read_millis, page.answers) = (0, 0.0, 0);
        let wanted = PathGrowth {
            update: update.clone(),
            traverse: traverse.clone(),
            leg: 0,
            planners: vec![link::WantedPlanner {
                planner,
                held_search: snapshot::ContentKey::default(),
                held: 0,
            }],
        };
        let begun = Instant::now();
        core.handle(Request::GrowPath(wanted), &mut page);
        println!(
            "growth of {planner:?} to {} samples: {:.1} ms in the core, {} answers of {} bytes, {:.2} ms to read them",
            page.samples,
            millis(begun) - page.read_millis,
            page.answers,
            page.bytes,
            page.read_millis
        );
    }
}

fn millis(begun: Instant) -> f64 {
    begun.elapsed().as_secs_f64() * 1e3
}

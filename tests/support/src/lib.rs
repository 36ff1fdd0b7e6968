//! The workbench without a window, on a host that plans at once: shared by tests of several crates.

pub mod host;

use std::rc::Rc;

use serde_json::Value;
use workbench::Session;
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::chance::ChanceCommand;
use workbench::state::review::ReviewCommand;

pub use host::{TestHost, World};

/// A session, and what it shares with its host.
pub struct App {
    pub session: Session,
    /// The host's side.
    pub world: Rc<World>,
}

/// Starts a session and lets it plan its first mission.
pub fn start() -> App {
    let mut app = start_in(Rc::default());
    app.settle();
    app
}

/// Starts a session in a given world.
pub fn start_in(world: Rc<World>) -> App {
    App { session: Session::new(Box::new(TestHost::new(&world)), ""), world }
}

impl App {
    /// One frame, at the time that the clock shows.
    pub fn step(&mut self) {
        self.session.begin_frame();
        self.session.end_frame(None);
        self.session.remember();
    }

    /// Lets frames go by until nothing changes any more.
    pub fn settle(&mut self) {
        for _ in 0..6 {
            self.world.now_secs.set(self.world.now_secs.get() + 1.0 / 60.0);
            self.step();
        }
    }

    /// Runs a command, and lets its answers come.
    pub fn run(&mut self, command: Command) {
        self.session.apply(vec![command]);
        self.settle();
    }

    /// Runs a command by its name, and lets its answers come.
    pub fn dispatch(&mut self, command: &str, arguments: &Value) {
        self.session.dispatch(command, arguments).expect("the command can be used");
        self.settle();
    }

    /// Makes so many runs with chance.
    pub fn sample(&mut self, runs: u64, seed: u64) {
        let settings = self.session.state().chance.settings.clone();
        let settings = snapshot::RobustnessSettings { runs, seed, ..settings };
        self.run(Command::Chance(ChanceCommand::Set(Box::new(settings))));
        self.run(Command::Chance(ChanceCommand::Start));
        for _ in 0..runs {
            self.settle();
        }
        assert_eq!(self.json()["robustness"]["runs"], runs);
    }

    /// Creates a key of this name, where there is none, and signs with it from now on where no one is named.
    pub fn sign_as(&mut self, name: &str) {
        if self.session.state().keys.ring().own_named(name).is_none() {
            self.dispatch("review.createKey", &serde_json::json!({ "name": name }));
        }
        self.run(Command::Review(ReviewCommand::SignAs(name.to_owned())));
    }

    /// Acknowledges every item that needs attention of the review, one by one.
    pub fn acknowledge_all(&mut self, name: &str) {
        if self.session.state().keys.ring().own_named(name).is_none() {
            self.sign_as(name);
        }
        let items = self.json()["review"]["items"].as_array().expect("a list").clone();
        for (index, item) in items.iter().enumerate() {
            if item["status"] == "attention" && item["acknowledged"].is_null() {
                let arguments = serde_json::json!({ "name": name, "item": index, "text": "As meant." });
                self.dispatch("review.acknowledge", &arguments);
            }
        }
    }

    /// The state as a host page sees it.
    pub fn json(&self) -> Value {
        serde_json::to_value(workbench::host_io::Remote::state(&self.session)).expect("plain data")
    }
}

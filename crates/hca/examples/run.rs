//! A control program compiled to an automaton and run on given estimates: `cargo run -p hca --example run`.
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

/// Both engines get ready while the camera is turned off; then engine A fires.
const TEXT: &str = "
(DO-WATCHING (EngineA = Firing)
  (PARALLEL
    (EngineA = Standby)
    (Camera = Off)
    (WHEN-DONEXT ((EngineA = Standby) AND (Camera = Off)) (EngineA = Firing))))";

fn main() -> Result<(), String> {
    let compilation = hca::compile_text(TEXT, &hca::Vocabulary::default());
    let automaton = compilation.automaton.ok_or_else(|| format!("{:#?}", compilation.diagnostics))?;
    // What is known of the plant at the end of each step; an estimator would say this.
    let estimates = [("Off", "Off"), ("Standby", "Off"), ("Standby", "Off"), ("Firing", "Off")]
        .map(|(engine, camera)| automaton.estimate([("EngineA", engine), ("Camera", camera)]));
    let run = hca::trace(&automaton, &estimates);
    for step in &run.steps {
        println!("step {}: marked {:?}, goals {:?}", step.step, step.labels, step.goals);
    }
    println!("the program has ended: {}", run.terminated);
    if run.terminated { Ok(()) } else { Err("the program should have ended".to_owned()) }
}

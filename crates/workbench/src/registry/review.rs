//! Judging and comparing plans, and documents about them.

use review::keys::PublicKey;
use review::record::{Act, LineKey};
use review::{FlightRules, Section};
use serde_json::Value;

use super::arguments::text_argument;
use super::available::{
    with_approval, with_mission, with_natures_choice, with_pins, with_plan, with_record, with_review,
    with_rule_proof, with_rules, with_trial,
};
use super::spec::{called, plain, when};
use crate::command::Command;
use crate::dialog::Dialog;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::AppState;
use crate::state::compare::CompareCommand;
use crate::state::contradict::ContradictCommand;
use crate::state::documents::ScheduleForm;
use crate::state::keys::KeyChange;
use crate::state::pins::PinCommand;
use crate::state::pins::event_by_name;
use crate::state::review::{Person, ReviewCommand};
use crate::state::rule_proof::RuleProofCommand;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain("review.run", "Review plan", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Review(ReviewCommand::Run)
        }),
        with_mission,
    ),
    when(
        plain(
            "review.contradict",
            "Contradict all passed items",
            Group::Review,
            &[],
            Scope::Everywhere,
            |_| Command::Contradict(ContradictCommand::Start(None)),
        ),
        with_review,
    ),
    when(
        plain("review.stopContradict", "Stop contradicting", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Contradict(ContradictCommand::Stop)
        }),
        with_trial,
    ),
    called("review.contradictItem", "Contradict passed item", Group::Review, |state, arguments| {
        Ok(Command::Contradict(ContradictCommand::Start(Some(item(state, arguments)?))))
    }),
    called("review.replay", "Replay counterexample", Group::Review, |state, arguments| {
        Ok(Command::Contradict(ContradictCommand::Replay(item(state, arguments)?)))
    }),
    when(
        plain(
            "review.proveRules",
            "Prove rules in every plan",
            Group::Review,
            &[],
            Scope::Everywhere,
            |_| Command::RuleProof(RuleProofCommand::Start(None)),
        ),
        with_rules,
    ),
    when(
        plain("review.stopProof", "Stop proving rules", Group::Review, &[], Scope::Everywhere, |_| {
            Command::RuleProof(RuleProofCommand::Stop)
        }),
        with_rule_proof,
    ),
    called("review.proveRule", "Prove rule in every plan", Group::Review, |state, arguments| {
        Ok(Command::RuleProof(RuleProofCommand::Start(Some(rule(state, arguments)?))))
    }),
    called("review.openRulePlan", "Open plan that violates rule", Group::Review, |state, arguments| {
        Ok(Command::RuleProof(RuleProofCommand::Open(rule(state, arguments)?)))
    }),
    when(
        plain("file.report", "Write report", Group::Review, &[], Scope::Everywhere, |_| Command::WriteReport),
        with_mission,
    ),
    when(
        plain("export.csv", "Export schedule as CSV…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::Csv)
        }),
        with_plan,
    ),
    when(
        plain("export.json", "Export schedule as JSON…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::Json)
        }),
        with_plan,
    ),
    when(
        plain("export.openMct", "Export to Open MCT…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::OpenMct)
        }),
        with_plan,
    ),
    when(
        plain("export.icalendar", "Export to calendar…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::Icalendar)
        }),
        with_plan,
    ),
    when(
        plain("export.planDev", "Export to PlanDev…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::PlanDev)
        }),
        with_plan,
    ),
    when(
        plain("compare.pin", "Set plan as baseline", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Compare(CompareCommand::Pin)
        }),
        with_plan,
    ),
    when(
        plain(
            "compare.approved",
            "Compare with last approval",
            Group::Review,
            &[],
            Scope::Everywhere,
            |_| Command::Compare(CompareCommand::WithApproved),
        ),
        with_approval,
    ),
    plain("compare.file", "Compare with file…", Group::Review, &[], Scope::Everywhere, |_| {
        Command::Compare(CompareCommand::OpenFile)
    }),
    when(
        plain("review.save", "Save review history", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Review(ReviewCommand::SaveRecord)
        }),
        with_record,
    ),
    plain("review.open", "Merge review history…", Group::Review, &[], Scope::Everywhere, |_| {
        Command::Review(ReviewCommand::OpenRecord)
    }),
    called("review.approve", "Approve plan", Group::Review, |state, arguments| {
        let by = state.review.seated(&person(arguments, "name")?);
        let standing = state.review.standing().ok_or("wait until planning ends")?;
        standing.may_approve(&state.keys.secret(&by.name)?.0, &by.role)?;
        Ok(Command::Review(ReviewCommand::Approve { by, text: words(arguments) }))
    }),
    called("review.acknowledge", "Acknowledge item", Group::Review, |state, arguments| {
        let line = item(state, arguments)?;
        said(state, arguments, Act::Acknowledge { line, text: words(arguments) })
    }),
    called("review.waive", "Waive item", Group::Review, |state, arguments| {
        let line = item(state, arguments)?;
        let until = text_argument(arguments, "until")?.trim().to_owned();
        said(state, arguments, Act::Waive { line, text: words(arguments), until })
    }),
    called("review.createKey", "Create key", Group::Review, |state, arguments| {
        let name = text_argument(arguments, "name")?.trim().to_owned();
        state.keys.ring().may_be_called(&name).map_err(|error| error.to_string())?;
        Ok(Command::Review(ReviewCommand::ChangeKeys(KeyChange::Create(name))))
    }),
    called("review.saveKey", "Save key to file", Group::Review, |state, arguments| {
        let name = text_argument(arguments, "name")?.to_owned();
        state.keys.secret(&name)?;
        Ok(Command::Review(ReviewCommand::SaveOwnKey(name)))
    }),
    called("review.trust", "Trust key", Group::Review, |state, arguments| {
        let name = text_argument(arguments, "name")?.trim().to_owned();
        let key = key(arguments)?;
        let person = review::keys::Person { name, key, secret: None };
        state.keys.ring().clone().add(person.clone()).map_err(|error| error.to_string())?;
        Ok(Command::Review(ReviewCommand::ChangeKeys(KeyChange::Add(vec![person]))))
    }),
    called("review.removeKey", "Remove key", Group::Review, |_, arguments| {
        Ok(Command::Review(ReviewCommand::ChangeKeys(KeyChange::Remove(key(arguments)?))))
    }),
    plain("review.saveKeys", "Save trusted keys", Group::Review, &[], Scope::Everywhere, |_| {
        Command::Review(ReviewCommand::SaveKeys)
    }),
    called("review.resolve", "Resolve comment", Group::Review, |state, arguments| {
        said(state, arguments, Act::Resolve { of: entry(arguments)?, text: words(arguments) })
    }),
    called("review.reopen", "Reopen comment", Group::Review, |state, arguments| {
        said(state, arguments, Act::Reopen { of: entry(arguments)?, text: words(arguments) })
    }),
    called("review.withdraw", "Withdraw entry", Group::Review, |state, arguments| {
        said(state, arguments, Act::Withdraw { of: entry(arguments)?, text: words(arguments) })
    }),
    called("review.rules", "Change flight rules", Group::Review, |state, arguments| {
        // What is not named stays as it is.
        let mut rules = serde_json::to_value(state.review.record().rules()).map_err(|it| it.to_string())?;
        let members = arguments.as_object().ok_or("expected an object with the rules to change")?;
        if let Some(known) = rules.as_object_mut() {
            known.extend(members.iter().map(|(name, rule)| (name.clone(), rule.clone())));
        }
        let rules: FlightRules = serde_json::from_value(rules).map_err(|it| it.to_string())?;
        rules.problem().map_or(Ok(()), |problem| Err(problem.to_owned()))?;
        let name = &state.settings.reviewer;
        state.keys.secret(name)?;
        Ok(Command::Review(ReviewCommand::SetRules(Box::new(rules))))
    }),
    plain("review.saveRules", "Save flight rules", Group::Review, &[], Scope::Everywhere, |_| {
        Command::Review(ReviewCommand::SaveRules)
    }),
    called("review.comment", "Add comment", Group::Review, |state, arguments| {
        let about = arguments.get("about").and_then(Value::as_str).map(str::to_owned);
        let by = person(arguments, "author")?;
        let to = arguments.get("to").and_then(Value::as_str);
        let to = to.map(|name| {
            let mut people = state.keys.ring().people().iter();
            let person = people.find(|person| person.name == name);
            person.map(|person| person.key.clone()).ok_or_else(|| format!("no key of “{name}” is trusted"))
        });
        let text = text_argument(arguments, "text")?.trim().to_owned();
        let act = Act::Comment { about, to: to.transpose()?, text };
        state.review.may_say(&state.keys.secret(&by.name)?.0, &act)?;
        Ok(Command::Review(ReviewCommand::Say { by, act }))
    }),
    called("export.schedule", "Export schedule", Group::Review, |_, arguments| {
        let name = text_argument(arguments, "as")?;
        let form = ScheduleForm::by_name(name).ok_or_else(|| {
            "\"as\" must be \"csv\", \"json\", \"open-mct\", \"icalendar\" or \"plandev\"".to_owned()
        })?;
        let epoch = arguments.get("epoch").and_then(Value::as_str).unwrap_or_default().to_owned();
        Ok(Command::WriteSchedule { form, epoch })
    }),
    when(
        plain("plan.release", "Unpin all events", Group::Plan, &[], Scope::Everywhere, |_| {
            Command::Pins(PinCommand::ReleaseAll)
        }),
        with_pins,
    ),
    when(
        plain("strategy.goOn", "Advance to next event", Group::Plan, &[], Scope::Everywhere, |_| {
            Command::Pins(PinCommand::GoOn)
        }),
        with_natures_choice,
    ),
    when(
        plain("strategy.takeBack", "Undo last step", Group::Plan, &[], Scope::Everywhere, |_| {
            Command::Pins(PinCommand::TakeBack)
        }),
        with_pins,
    ),
    when(
        called("plan.pin", "Pin event", Group::Plan, |state, arguments| {
            let name = arguments.get("event").and_then(Value::as_str);
            let time = arguments.get("time").and_then(Value::as_f64);
            let (Some(name), Some(time)) = (name, time.filter(|time| time.abs() < 1e12)) else {
                return Err("expected {\"event\": text, \"time\": number}".to_owned());
            };
            let network = state.shown().and_then(|shown| shown.network.as_deref());
            let node = network.and_then(|network| event_by_name(network, name));
            let node = node.ok_or_else(|| format!("unknown event \"{name}\""))?;
            // Pins are resolved to a tenth of a unit at least; thousandths are finer than any drag.
            let time = exact::Time::from_f64_nearest(time, 1000).ok_or("\"time\" must be a number")?;
            Ok(Command::Pins(PinCommand::Pin(node, time)))
        }),
        with_plan,
    ),
];

/// The public key that is meant.
fn key(arguments: &Value) -> Result<PublicKey, String> {
    let text = text_argument(arguments, "key")?;
    PublicKey::read(text).ok_or_else(|| format!("“{text}” is not a public key"))
}

/// Returns who does it: the argument `name`, or what it is called, and `role`.
fn person(arguments: &Value, name: &str) -> Result<Person, String> {
    let role = arguments.get("role").and_then(Value::as_str).unwrap_or_default();
    Ok(Person { name: text_argument(arguments, name)?.to_owned(), role: role.to_owned() })
}

/// The line of the present review that it is about, by its number.
fn item(state: &AppState, arguments: &Value) -> Result<LineKey, String> {
    let review = state.review.current().ok_or("review the current text first")?;
    let mut lines = Section::ALL
        .iter()
        .flat_map(|&section| review.lines(section).into_iter().map(move |line| (section, line)));
    let index = arguments.get("item").and_then(Value::as_u64).and_then(|index| usize::try_from(index).ok());
    let (section, line) =
        index.and_then(|index| lines.nth(index)).ok_or("\"item\" must be the number of a review item")?;
    Ok(LineKey::new(section, line))
}

/// Returns what the flight rule of a name says.
fn rule(state: &AppState, arguments: &Value) -> Result<String, String> {
    let name = arguments.get("rule").and_then(Value::as_str);
    let mut rules = state.review.record().rules().rules.iter();
    let found = name.and_then(|name| rules.find(|rule| rule.name == name));
    found.map(|rule| rule.rule.clone()).ok_or_else(|| "\"rule\" must be the name of a flight rule".to_owned())
}

/// Returns what is said with it, if anything.
fn words(arguments: &Value) -> String {
    arguments.get("text").and_then(Value::as_str).unwrap_or_default().trim().to_owned()
}

/// The entry that it is about.
fn entry(arguments: &Value) -> Result<String, String> {
    Ok(text_argument(arguments, "id")?.to_owned())
}

fn said(state: &AppState, arguments: &Value, act: Act) -> Result<Command, String> {
    let by = person(arguments, "name")?;
    state.review.may_say(&state.keys.secret(&by.name)?.0, &act)?;
    Ok(Command::Review(ReviewCommand::Say { by, act }))
}

/// Asks when the mission starts, beginning with what was said last.
fn ask_epoch(state: &AppState, form: ScheduleForm) -> Command {
    Command::Window(WindowCommand::ShowDialog(Dialog::Epoch { form, epoch: state.settings.epoch.clone() }))
}

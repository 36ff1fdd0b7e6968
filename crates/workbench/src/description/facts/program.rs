//! The run of a control program: what is marked, what is believed, and what is true.

use super::{Row, count, truth, words};
use crate::lesson::Value;
use crate::state::diagnosing::set_text;

pub(super) const VALUES: &[Row] = &[
    ("program", |it, _| truth(it.program()?.locations > 0 && it.program()?.marked.is_some())),
    ("moments", |it, _| count(it.program().map_or(0, |run| run.step))),
    ("locations", |it, _| count(Some(it.program()?.locations).filter(|&count| count > 0)?)),
    ("marks", |it, _| words(it.program()?.marked.as_ref()?.join(", "))),
    ("marked", |it, label| truth(it.program()?.marked.as_ref()?.iter().any(|it| it == label))),
    ("marked-places", |it, _| count(it.moment()?.upcoming.marked.len())),
    ("goals", |it, _| words(it.program()?.goals.as_ref()?.join(", "))),
    ("ended", |it, _| truth(it.moment()?.upcoming.marked.is_empty())),
    ("fired", |it, _| count(it.moment()?.taken.as_ref()?.fired.len())),
    ("mode", |it, name| {
        let (model, plant) = it.plant_of_moment()?;
        let component = model.component_named(name)?;
        words(model.mode_name(component, plant.belief.most_likely().mode(component)))
    }),
    ("true-mode", |it, name| words(it.plant()?.true_state.get(name)?.as_str())),
    ("believed", |it, _| count(it.plant()?.belief.len())),
    ("likelihood", |it, _| in_percent(&it.plant_of_moment()?.1.belief.highest_probability())),
    ("confidence", |it, name| {
        let (model, plant) = it.plant_of_moment()?;
        let component = model.component_named(name)?;
        let mode = plant.belief.most_likely().mode(component);
        in_percent(plant.belief.marginal(model, component).get(usize::from(mode))?)
    }),
    ("commands", |it, _| {
        let named = it.plant()?.next_commands.as_ref()?.iter();
        let each: Vec<String> = named.map(|(name, value)| format!("{name}.{value}")).collect();
        words(each.join(", "))
    }),
    ("observed", |it, name| words(it.plant()?.observations.as_ref()?.get(name)?.as_str())),
    ("conflicts", |it, _| count(it.plant()?.conflicts.as_ref()?.len())),
    ("conflict", |it, _| words(it.plant()?.conflicts.as_ref()?.first()?.as_str())),
    ("proof-states", |it, _| count(it.program()?.proof.as_ref().filter(|proof| !proof.is_running)?.states)),
    ("verdict", |it, property| words(it.verdict(property)?.verdict.as_str())),
    ("counterexample", |it, property| words(it.verdict(property)?.faults.join("; "))),
    ("diagnoses", |it, _| {
        let step = it.step_conflicts()?;
        step.root().and_then(|_| count(step.diagnoses().len()))
    }),
    ("likeliest-diagnosis", |it, _| {
        let (model, _) = it.plant_of_moment()?;
        let sets = it.step_conflicts()?.diagnoses().iter();
        words(set_text(model, &sets.max_by(|one, other| one.1.total_cmp(&other.1))?.0))
    }),
    ("diagnosed", |it, _| {
        it.step_conflicts()?.root()?;
        truth(it.diagnosing().is_some_and(|it| it.tree().is_finished()))
    }),
];

fn in_percent(probability: &plant::Interval) -> Option<Value> {
    if let Some(exact) = probability.exact() {
        return words(format!("{:.3}%", percent(&exact.to_string())?));
    }
    let (low, high) = probability.percents(3);
    words(format!("{low} to {high}%"))
}

/// An exact fraction in percent. Its parts may have more digits than an integer holds.
fn percent(fraction: &str) -> Option<f64> {
    let (numerator, denominator) = fraction.split_once('/').unwrap_or((fraction, "1"));
    Some(numerator.parse::<f64>().ok()? / denominator.parse::<f64>().ok()? * 100.0)
}

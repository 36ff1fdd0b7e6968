//! How robust the plan is, as many runs with chance found; before they were made, how to make them.

use egui::{Button, Ui};
use snapshot::Robustness;
use workbench::command::CommandSender;
use workbench::registry;

use super::row;
use crate::{Context, counted};

/// The command that makes the runs.
const COMMAND: &str = "execute.sample";
/// Events that are named.
const MAX_EVENTS: usize = 5;

/// Returns what the heading says.
pub(super) fn note(figures: Option<&Robustness>) -> String {
    match figures {
        None => "not run yet".to_owned(),
        Some(figures) if figures.is_complete() => format!("{} runs", figures.tally.runs),
        Some(figures) => format!("{} of {} runs", figures.tally.runs, figures.settings.runs),
    }
}

/// Shows the figures, or how to come by them.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    figures: Option<&Robustness>,
    commands: &mut CommandSender,
) {
    let Some(figures) = figures else {
        row::muted(ui, context, "No Monte Carlo runs yet. Run them to estimate how often the plan succeeds.");
        ui.horizontal(|ui| {
            ui.add_space(row::INDENT);
            let spec = registry::by_id(COMMAND);
            let refused =
                spec.map_or(Err("not available in this build"), |spec| (spec.available)(context.state));
            let button = ui.add_enabled(refused.is_ok(), Button::new("Run Monte Carlo"));
            let button = match refused {
                Err(reason) => button.on_disabled_hover_text(reason),
                Ok(()) => button,
            };
            if button.clicked()
                && let Some(command) = spec.and_then(|spec| spec.plain(context.state))
            {
                commands.send(command);
            }
        });
        return;
    };
    let tally = &figures.tally;
    let (low, high) = tally.interval();
    let percent = |part: f64| format!("{:.1}%", part * 100.0);
    row::muted(
        ui,
        context,
        &format!(
            "{} of {} runs reached the end: {} (95% confidence: {} to {}). {} had to replan.",
            tally.succeeded,
            tally.runs,
            percent(tally.probability()),
            percent(low),
            percent(high),
            tally.succeeded_by_replanning
        ),
    );
    for (event, breaks) in tally.worst_events().into_iter().take(MAX_EVENTS) {
        let text = format!(
            "{event} missed its window {}; {} of these ended the mission. {}",
            counted(breaks.violations, "time"),
            breaks.stops,
            breaks.example
        );
        row::muted(ui, context, &text);
    }
    for (event, mean, most) in tally.tightest_events().into_iter().take(MAX_EVENTS) {
        let text =
            format!("{event} used {} of its slack on average, at most {}", percent(mean), percent(most));
        row::muted(ui, context, &text);
    }
}

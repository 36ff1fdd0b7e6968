//! How the badge looks: a sign, a word and a color for each way in which the plan can stand.

use egui::Color32;
use theme::Tokens;
use theme::icon::Icon;
use workbench::PanelKind;
use workbench::state::Status;

/// What the badge shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    pub sign: Icon,
    pub text: &'static str,
    /// The color of both.
    pub color: Color32,
    /// What lies behind them.
    pub fill: Color32,
    /// The panel that tells more.
    pub panel: PanelKind,
}

/// The look of a status. `is_stale`: what is drawn belongs to an older text; `verdict`: what the checker says of the plan.
pub fn look(tokens: &Tokens, status: Status, is_stale: bool, verdict: Option<bool>) -> Look {
    let [good, warning, error, info] = tokens.soft;
    let plain = tokens.raised;
    let (sign, text, color, fill, panel) = match (status, verdict) {
        (Status::Working, _) => (Icon::Working, "Planning", tokens.info, info, PanelKind::Plan),
        (Status::Broken, _) if is_stale => {
            (Icon::Error, "Errors · showing last valid version", tokens.error, error, PanelKind::Problems)
        }
        (Status::Broken, _) => (Icon::Error, "Errors", tokens.error, error, PanelKind::Problems),
        (Status::NoPlan, _) => (Icon::Warning, "No plan", tokens.warning, warning, PanelKind::Plan),
        (Status::Empty, _) => (Icon::Nothing, "Nothing to plan", tokens.text, plain, PanelKind::Problems),
        (Status::Undecided, _) if is_stale => {
            (Icon::Changed, "Out of date", tokens.text_muted, plain, PanelKind::Plan)
        }
        (Status::Undecided, _) => (Icon::Changed, "Undecided", tokens.text_muted, plain, PanelKind::Plan),
        (Status::Program, _) => (Icon::Play, "Program", tokens.good, good, PanelKind::Automaton),
        (Status::Plan, Some(true)) => (Icon::Check, "Plan · verified", tokens.good, good, PanelKind::Plan),
        (Status::Plan, Some(false)) => {
            (Icon::Error, "Plan · failed verification", tokens.error, error, PanelKind::Plan)
        }
        (Status::Plan, None) => (Icon::Info, "Plan · not checked", tokens.info, info, PanelKind::Plan),
    };
    Look { sign, text, color, fill, panel }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_no_plan_stale_planning_and_verified_are_five_looks() {
        for tokens in [&theme::DARK, &theme::LIGHT] {
            let looks = [
                look(tokens, Status::Broken, true, Some(true)),
                look(tokens, Status::NoPlan, false, None),
                look(tokens, Status::Undecided, true, Some(true)),
                look(tokens, Status::Working, true, Some(true)),
                look(tokens, Status::Plan, false, Some(true)),
            ];
            for (index, one) in looks.iter().enumerate() {
                for other in &looks[index + 1..] {
                    assert_ne!(one.sign, other.sign, "{one:?} {other:?}");
                    assert_ne!(one.text, other.text);
                    assert_ne!(one.color, other.color, "{one:?} {other:?}");
                    assert_ne!(one.fill, other.fill, "{one:?} {other:?}");
                }
            }
        }
    }

    #[test]
    fn only_a_plan_that_the_checker_finds_valid_is_green() {
        let all =
            [Status::Working, Status::Broken, Status::Empty, Status::Plan, Status::NoPlan, Status::Undecided];
        for status in all {
            for (is_stale, verdict) in [(false, None), (false, Some(false)), (true, Some(true))] {
                let tokens = &theme::DARK;
                let is_green = look(tokens, status, is_stale, verdict).color == tokens.good;
                assert_eq!(is_green, status == Status::Plan && verdict == Some(true), "{status:?}");
            }
        }
    }
}

//! The drawings of a report as SVG.

mod map;
mod timeline;

use mission::Snapshot;

pub(crate) use map::map;
pub(crate) use timeline::timeline;

/// The network with the plan marked in it; `None` without a network.
pub(crate) fn network(snapshot: &Snapshot) -> Option<String> {
    let network = snapshot.network.as_deref()?;
    let measure = &layout::approximate_text_width;
    let options = layout::Options::default();
    let drawing = layout::network(network, &options, measure);
    let plan = snapshot.plan();
    let (mut overlays, mut notes) = (Vec::new(), Vec::new());
    if let Some(plan) = plan {
        overlays.extend(layout::overlay::causal_links(&drawing, network, plan));
        overlays.extend(layout::overlay::orderings(&drawing, network, plan));
        notes.extend(layout::overlay::windows(&drawing, plan, options.window_width, measure));
    }
    let svg = layout::SvgOptions {
        palette: &layout::Palette::LIGHT,
        plan,
        overlays: &overlays,
        notes: &notes,
        parts: layout::Parts::default(),
        progress: None,
        title: "Temporal plan network",
    };
    Some(layout::svg(&drawing, network, &svg))
}

/// A coordinate with at most two decimals.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A round step that divides `range` into about `wanted` parts: 1, 2 or 5 times a power of ten.
fn round_step(range: f64, wanted: f64) -> f64 {
    let rough = (range / wanted).max(f64::MIN_POSITIVE);
    let mut power = 1.0;
    while power > rough {
        power /= 10.0;
    }
    while power * 10.0 <= rough {
        power *= 10.0;
    }
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= rough)
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::{number, round_step};

    #[test]
    fn steps_are_round_and_numbers_short() {
        assert_eq!([round_step(800.0, 8.0), round_step(33.0, 8.0), round_step(0.9, 10.0)], [100.0, 5.0, 0.1]);
        assert_eq!([number(1.0), number(-0.001), number(2.50)], ["1", "0", "2.5"]);
    }
}

//! The drawing as a file: the same display list that is painted, as an SVG, from which a PNG is made.

use display::DisplayList;
use layout::list::network::progress_list;
use layout::{NetworkState, Progress};
use tpn::{Network, Plan};
use workbench::PictureFormat;
use workbench::command::Command;
use workbench::state::settings::NetworkView;
use workbench::state::window::WindowCommand;

use super::data::Drawn;
use crate::Context;

/// Longer sides than this are more than browsers draw.
const MAX_SIDE: f64 = 16_000.0;
/// More pixels than this are more than browsers draw.
const MAX_PIXELS: f64 = 120e6;
/// Pixels per unit of the drawing, where that is not too large.
const FINEST: f64 = 2.0;

/// The command that saves the drawing, all of it, with what is shown of it and nothing that is selected.
pub(super) fn save(
    format: PictureFormat,
    context: &Context<'_>,
    drawn: &Drawn,
    network: &Network,
    plan: Option<&Plan>,
    progress: Option<&Progress>,
    view: &NetworkView,
) -> Command {
    let svg = svg(context, drawn, network, plan, progress, view);
    let name = format!("{}-network.{}", context.state.mission, format.extension());
    match format {
        PictureFormat::Svg => Command::Window(WindowCommand::SaveFile { name, bytes: svg.into_bytes() }),
        PictureFormat::Png => {
            let (width, height) = (drawn.frame().width(), drawn.frame().height());
            let scale = pixels_per_unit(width, height);
            let size = [width, height].map(|side| (side * scale).round().max(1.0) as u32);
            Command::Window(WindowCommand::SavePicture { name, svg, size })
        }
    }
}

/// As fine as can be without being more than browsers draw.
pub(super) fn pixels_per_unit(width: f64, height: f64) -> f64 {
    let by_side = MAX_SIDE / width.max(height).max(1.0);
    let by_area = (MAX_PIXELS / (width * height).max(1.0)).sqrt();
    FINEST.min(by_side).min(by_area)
}

fn svg(
    context: &Context<'_>,
    drawn: &Drawn,
    network: &Network,
    plan: Option<&Plan>,
    progress: Option<&Progress>,
    view: &NetworkView,
) -> String {
    let state = NetworkState { plan, parts: view.parts(), ..NetworkState::default() };
    let progress = progress.map(|it| progress_list(&drawn.drawing, network, &state, it, None));
    let mut list = drawn.list.clone();
    list.frame = drawn.frame();
    let lists: Vec<&DisplayList> = std::iter::once(&list).chain(&progress).chain(&drawn.changes).collect();
    let title = format!("Network of {}", context.state.mission);
    display::svg(&lists, context.tokens.exported(), &title)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_fine_unless_that_makes_them_too_large() {
        assert_eq!(pixels_per_unit(800.0, 300.0), 2.0);
        for (width, height) in [(400_000.0, 3_000.0), (30_000.0, 20_000.0), (10.0, 90_000.0)] {
            let scale = pixels_per_unit(width, height);
            assert!(width.max(height) * scale <= MAX_SIDE + 1.0);
            assert!(width * height * scale * scale <= MAX_PIXELS + 1.0);
        }
    }
}

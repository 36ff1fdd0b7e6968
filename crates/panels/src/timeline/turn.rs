//! The turns of a run above the timeline, with a line down to the bars: when it was replanned, and how it ended.

use egui::{CursorIcon, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use workbench::command::{Command, CommandSender};
use workbench::state::playback::number;

use super::view::TimeView;
use crate::Context;
use crate::execution::story;

/// The size of a flag.
const FLAG: [f32; 2] = [10.0, 9.0];

/// Shows the turns up to the time shown. A click on a flag goes to its time.
pub(super) fn show(
    ui: &Ui,
    context: &Context<'_>,
    (axis, view): (Rect, &TimeView),
    bottom: f32,
    commands: &mut CommandSender,
) {
    let state = context.state;
    let Some(run) = state.run_shown().filter(|_| context.step().is_none() && !state.execution.is_working())
    else {
        return;
    };
    let painter = ui.painter().with_clip_rect(axis.with_max_y(bottom).expand2(vec2(FLAG[0], 0.0)));
    for (index, turn) in story::turns(run, state.playback.time).into_iter().enumerate() {
        let x = axis.left() + ((number(turn.time) - view.start) * view.scale) as f32;
        if !axis.x_range().contains(x) {
            continue;
        }
        let (_, color, _) = turn.kind.look(context.tokens);
        let line = [pos2(x, axis.bottom()), pos2(x, bottom)];
        painter.extend(Shape::dashed_line(&line, Stroke::new(1.0, color), 4.0, 3.0));
        let flag = Rect::from_min_size(pos2(x, axis.bottom() - FLAG[1]), vec2(FLAG[0], FLAG[1]));
        let corners = vec![flag.left_top(), pos2(flag.right(), flag.center().y), flag.left_bottom()];
        painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
        let response = ui.interact(flag.expand(2.0), ui.scope_id().with(("turn", index)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &turn.text));
        if response.clicked() {
            commands.send(Command::Seek(number(turn.time)));
        }
        response.on_hover_cursor(CursorIcon::PointingHand).on_hover_ui(|ui| {
            ui.label(theme::strong(&turn.text));
            if let Some(because) = &turn.because {
                ui.label(because);
            }
        });
    }
}

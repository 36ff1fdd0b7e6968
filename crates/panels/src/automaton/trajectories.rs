//! The trajectories of the plant that were kept, as a tree through time: a row for each step, in it the most likely states,
//! each below the state that it most likely comes from; crosses are trajectories that an observation ended.

use egui::accesskit::{self, Action, Role};
use egui::{
    Align2, FontId, Painter, Pos2, Rect, Response, RichText, Sense, Stroke, Ui, UiBuilder, pos2, vec2,
};
use plant::{Interval, Model, State, StepBranches};
use theme::size;
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, PlantMoment};

use super::components::percent_between;
use super::title;
use crate::Context;

/// So many steps before the moment that is looked at are drawn.
const MAX_ROWS: usize = 8;
/// So many of the most likely states of a step are drawn.
const MAX_STATES: usize = 6;
/// So many columns have room, crosses included.
const COLUMNS: usize = 8;
const ROW_HEIGHT: f32 = 30.0;
/// Room for the number of a step, and for the probability of its most likely state.
const MARGINS: [f32; 2] = [34.0, 96.0];

/// Something of a row: a state that was kept, or a trajectory that ended.
struct Mark {
    /// Which of the row before it comes from.
    from: Option<usize>,
    is_ruled_out: bool,
    is_true: bool,
    /// The share of the drawn radius.
    weight: f32,
    /// What it is, in words.
    name: String,
}

/// A moment of the run.
struct Row {
    /// How many steps were taken before it.
    at: usize,
    marks: Vec<Mark>,
    /// The probability of the most likely state, and what was dropped.
    note: String,
}

pub(super) fn show(ui: &mut Ui, context: &Context<'_>, model: &Model, commands: &mut CommandSender) {
    let state = &context.state.automaton;
    let first = (state.at() + 1).saturating_sub(MAX_ROWS);
    let moments = state.moments().iter().enumerate().skip(first).take(state.at() + 1 - first);
    let plants: Vec<(usize, &PlantMoment)> =
        moments.filter_map(|(at, moment)| Some((at, moment.plant.as_ref()?))).collect();
    if plants.len() < 2 {
        return;
    }
    title(ui, context, "Trajectories", "the most likely states, each with its past");
    let mut rows: Vec<Row> = Vec::with_capacity(plants.len());
    for (number, (at, plant)) in plants.iter().enumerate() {
        let before = number.checked_sub(1).and_then(|before| plants.get(before)).map(|(_, plant)| *plant);
        rows.push(row(model, *at, plant, before));
    }
    let height = ROW_HEIGHT * rows.len() as f32;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    let name = format!("Trajectories over {}", crate::counted(rows.len() as u64 - 1, "step"));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Tree, true, &name));
    paint(context, &ui.painter_at(rect), rect, &rows, state.at());
    let chosen = items(ui, &response, rect, &rows).or_else(|| {
        let pointer = response.interact_pointer_pos().filter(|_| response.clicked())?;
        Some(((pointer.y - rect.top()) / ROW_HEIGHT) as usize)
    });
    if let Some(row) = chosen.and_then(|row| rows.get(row)) {
        commands.send(Command::Automaton(AutomatonCommand::GoTo(row.at)));
    }
    if let Some((row, mark)) = response.hover_pos().and_then(|pointer| nearest(rect, &rows, pointer)) {
        response.on_hover_text(&rows[row].marks[mark].name);
    }
    let last = plants.last().and_then(|(_, plant)| Some((plant, plant.branches.as_ref()?)));
    let before = plants.iter().rev().nth(1).map(|(_, plant)| *plant);
    if let Some(((plant, branches), before)) = last.zip(before) {
        ended(ui, context, model, plant, before, branches);
    }
}

/// What the observation of the last step ended, and what was dropped, in words.
fn ended(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    plant: &PlantMoment,
    before: &PlantMoment,
    branches: &StepBranches,
) {
    let muted = context.tokens.text_muted;
    for mark in ruled_out(model, plant, before, branches) {
        ui.add(egui::Label::new(RichText::new(format!("✕ {}", mark.name)).small().color(muted)).wrap());
    }
    if let Some(text) = dropped(branches) {
        ui.add(egui::Label::new(RichText::new(text).small().color(context.tokens.warning)).wrap());
    }
}

fn dropped(branches: &StepBranches) -> Option<String> {
    let is_some = branches.dropped.exact().is_none();
    is_some.then(|| format!("Dropped: at most {}%", branches.dropped.percents(2).1))
}

fn row(model: &Model, at: usize, plant: &PlantMoment, before: Option<&PlantMoment>) -> Row {
    let states: Vec<(State, Interval)> = plant.belief.states().take(MAX_STATES).collect();
    let branches = plant.branches.as_ref();
    let mut marks = Vec::with_capacity(COLUMNS);
    for (rank, (state, probability)) in states.iter().enumerate() {
        let what = if rank == 0 { "most likely".to_owned() } else { model.differences(&states[0].0, state) };
        let branch = branches.and_then(|branches| branches.kept.get(rank));
        let others = branch.map_or(0, |branch| branch.others);
        let others = match others {
            0 => String::new(),
            _ => format!(", also from {} more", crate::counted(others as u64, "state")),
        };
        marks.push(Mark {
            // Of the states before, only those in the first columns are drawn; crosses follow them.
            from: branch.and_then(|branch| branch.from).filter(|from| *from < MAX_STATES),
            is_ruled_out: false,
            is_true: *state == plant.true_state,
            weight: probability.to_f64().0 as f32,
            name: format!("{what}, {}{others}", percent_between(probability, 2)),
        });
    }
    let ended = before.zip(branches).map(|(before, branches)| ruled_out(model, plant, before, branches));
    let room = COLUMNS.saturating_sub(marks.len());
    marks.extend(ended.into_iter().flatten().take(room));
    let share = states.first().map(|(_, probability)| percent_between(probability, 2)).unwrap_or_default();
    let has_dropped = branches.and_then(dropped).is_some();
    Row { at, marks, note: if has_dropped { format!("{share}, dropped") } else { share } }
}

/// The trajectories that the observation of a step ended.
fn ruled_out(model: &Model, plant: &PlantMoment, before: &PlantMoment, branches: &StepBranches) -> Vec<Mark> {
    let Some(record) = &plant.record else { return Vec::new() };
    let states: Vec<State> = before.belief.states().take(MAX_STATES).map(|(state, _)| state).collect();
    let marks = branches.ruled_out.iter().filter_map(|ended| {
        let changes = ended.changes(model, states.get(ended.from)?);
        let share = ended.probability.as_ref();
        let share = share.map_or_else(String::new, |it| format!(" ({})", percent_between(it, 2)));
        let reasons = ended.reasons(model, &record.observation);
        Some(Mark {
            from: Some(ended.from),
            is_ruled_out: true,
            is_true: false,
            weight: 0.0,
            name: format!("{changes}{share} ruled out by {reasons}"),
        })
    });
    marks.collect()
}

fn place(rect: Rect, row: usize, column: usize) -> Pos2 {
    let width = (rect.width() - MARGINS[0] - MARGINS[1]) / COLUMNS as f32;
    let x = rect.left() + MARGINS[0] + (column.min(COLUMNS) as f32 + 0.5) * width;
    pos2(x, rect.top() + (row as f32 + 0.5) * ROW_HEIGHT)
}

/// The row and the mark that are closest to a place, if one is near.
fn nearest(rect: Rect, rows: &[Row], pointer: Pos2) -> Option<(usize, usize)> {
    let row = ((pointer.y - rect.top()) / ROW_HEIGHT) as usize;
    let marks = &rows.get(row)?.marks;
    let distance = |column: &usize| place(rect, row, *column).distance(pointer);
    let column = (0..marks.len()).min_by(|left, right| distance(left).total_cmp(&distance(right)))?;
    (distance(&column) < ROW_HEIGHT / 2.0).then_some((row, column))
}

fn paint(context: &Context<'_>, painter: &Painter, rect: Rect, rows: &[Row], now: usize) {
    let tokens = context.tokens;
    let font = FontId::proportional(size::SMALL);
    for (number, row) in rows.iter().enumerate() {
        let middle = place(rect, number, 0).y;
        let color = if row.at == now { tokens.accent } else { tokens.text_muted };
        let label = (row.at + 1).to_string();
        painter.text(pos2(rect.left() + 4.0, middle), Align2::LEFT_CENTER, label, font.clone(), color);
        painter.text(pos2(rect.right(), middle), Align2::RIGHT_CENTER, &row.note, font.clone(), color);
        for (column, mark) in row.marks.iter().enumerate() {
            let at = place(rect, number, column);
            let (color, width) = match (mark.is_ruled_out, column) {
                (true, _) => (tokens.error, 1.0),
                (false, 0) => (tokens.accent, 2.0),
                (false, _) => (tokens.text_muted, 1.0),
            };
            if let Some(from) = mark.from.filter(|_| number > 0) {
                painter.line_segment([place(rect, number - 1, from), at], Stroke::new(width, color));
            }
            if mark.is_ruled_out {
                let arm = 4.0;
                let stroke = Stroke::new(1.5, color);
                painter.line_segment([at - vec2(arm, arm), at + vec2(arm, arm)], stroke);
                painter.line_segment([at - vec2(arm, -arm), at + vec2(arm, -arm)], stroke);
            } else {
                painter.circle_filled(at, 3.0 + 5.0 * mark.weight.sqrt(), color);
                if mark.is_true {
                    painter.circle_filled(at, 2.0, tokens.surface);
                }
            }
        }
    }
}

/// The marks for assistive technology, each before those that come from it. Returns the row that it goes to.
fn items(ui: &mut Ui, response: &Response, rect: Rect, rows: &[Row]) -> Option<usize> {
    if !ui.ctx().has_accesskit_node(response.id) {
        return None;
    }
    let builder = UiBuilder::new().max_rect(rect).id_salt("trajectories").accessibility_parent(response.id);
    let mut list = Vec::new();
    for column in 0..rows.first().map_or(0, |row| row.marks.len()) {
        add_with_branches(rows, 0, column, &mut list);
    }
    // What comes from states that are not drawn has no place below another one.
    for (number, row) in rows.iter().enumerate().skip(1) {
        for (column, mark) in row.marks.iter().enumerate() {
            let is_drawn = |from: usize| from < rows[number - 1].marks.len();
            if !mark.from.is_some_and(is_drawn) {
                add_with_branches(rows, number, column, &mut list);
            }
        }
    }
    let inside = ui.new_child(builder);
    let mut chosen = None;
    for (row, column) in list {
        let area = Rect::from_center_size(place(rect, row, column), vec2(16.0, 16.0));
        let widget = inside.interact(area, inside.scope_id().with((row, column)), Sense::hover());
        inside.ctx().accesskit_node_builder(widget.id, |node| {
            node.set_role(Role::TreeItem);
            let [x0, y0, x1, y1] = [area.min.x, area.min.y, area.max.x, area.max.y].map(f64::from);
            node.set_bounds(accesskit::Rect { x0, y0, x1, y1 });
            node.set_label(format!("before step {}: {}", rows[row].at + 1, rows[row].marks[column].name));
            node.set_level(row + 1);
            node.set_position_in_set(column);
            node.set_size_of_set(rows[row].marks.len());
            node.add_action(Action::Click);
        });
        if ui.input(|input| input.has_accesskit_action_request(widget.id, Action::Click)) {
            chosen = Some(row);
        }
    }
    chosen
}

fn add_with_branches(rows: &[Row], row: usize, column: usize, into: &mut Vec<(usize, usize)>) {
    into.push((row, column));
    if rows[row].marks[column].is_ruled_out {
        return;
    }
    let next = rows.get(row + 1).map_or(&[][..], |next| next.marks.as_slice());
    for (below, mark) in next.iter().enumerate() {
        if mark.from == Some(column) {
            add_with_branches(rows, row + 1, below, into);
        }
    }
}

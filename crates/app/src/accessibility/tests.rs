//! The mirror against real egui frames, without a window.

use egui::{CentralPanel, Context, RawInput, Rect, Slider, Ui, pos2, vec2};

use super::{AccessibilityMirror, Act, Element, Flag};

/// Runs one frame of an interface.
fn frame(context: &Context, draw: impl FnMut(&mut Ui)) {
    let mut draw = draw;
    let input = RawInput {
        screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0))),
        ..RawInput::default()
    };
    let mut output = context.run_ui(input, |ui| {
        CentralPanel::default().show(ui, |ui| draw(ui));
    });
    // Nothing is painted here.
    output.textures_delta.clear();
}

fn mirrored() -> Context {
    let context = Context::default();
    context.add_plugin(AccessibilityMirror::default());
    context
}

fn find(context: &Context, role: &str, text: &str) -> Element {
    let plugin = context.plugin::<AccessibilityMirror>();
    let mirror = plugin.lock();
    let found: Vec<Element> = mirror.document().find(role, text).cloned().collect();
    assert_eq!(found.len(), 1, "{role} {text}: {:#?}", mirror.document());
    found[0].clone()
}

fn take_change(context: &Context) -> Option<super::Change> {
    context.plugin::<AccessibilityMirror>().lock().take_change()
}

#[test]
fn widgets_appear_with_role_name_value_and_bounds() {
    let context = mirrored();
    let (mut name, mut on, mut speed) = ("Rover".to_owned(), true, 3.0);
    for _ in 0..2 {
        frame(&context, |ui| {
            let label = ui.label("Name");
            ui.text_edit_singleline(&mut name).labelled_by(label.id);
            ui.checkbox(&mut on, "Follow");
            ui.add(Slider::new(&mut speed, 0.0..=10.0).text("Speed"));
            let _ = ui.button("Plan");
        });
    }
    let input = find(&context, "textbox", "Rover");
    assert_eq!((input.label.as_str(), input.value.as_deref()), ("Name", Some("Rover")));
    assert_eq!(find(&context, "checkbox", "Follow").toggled, Some(Flag::True));
    assert_eq!(find(&context, "slider", "Speed").number, Some([Some(3.0), Some(0.0), Some(10.0)]));
    let button = find(&context, "button", "Plan");
    let [left, upper, width, height] = button.bounds;
    assert!(left >= 0.0 && upper > 0.0 && width > 10.0 && height > 10.0, "{:?}", button.bounds);
    assert_eq!(find(&context, "", "Name").value.as_deref(), Some("Name"));
}

#[test]
fn only_what_changed_is_handed_out() {
    let context = mirrored();
    let mut count = 0;
    let draw = |count: u32| {
        move |ui: &mut Ui| {
            let _ = ui.button("Steady");
            ui.label(format!("Count {count}"));
            if count > 1 {
                let _ = ui.button("Late");
            }
        }
    };
    for _ in 0..2 {
        frame(&context, draw(count));
    }
    assert!(take_change(&context).is_some_and(|change| change.changed.len() == 2));
    frame(&context, draw(count));
    assert_eq!(take_change(&context), None);
    count += 1;
    frame(&context, draw(count));
    let change = take_change(&context).expect("the label changed");
    let values: Vec<_> = change.changed.iter().map(|element| element.value.as_deref()).collect();
    assert_eq!(values, [Some("Count 1")]);
    frame(&context, draw(2));
    assert_eq!(take_change(&context).map(|change| change.removed.len()), Some(0));
    frame(&context, draw(1));
    assert_eq!(take_change(&context).map(|change| change.removed.len()), Some(1));
}

#[test]
fn clicking_an_element_clicks_the_widget() {
    let context = mirrored();
    let mut clicks = 0;
    frame(&context, |ui| {
        let _ = ui.button("Plan");
    });
    let button = find(&context, "button", "Plan");
    assert!(button.clickable);
    context.plugin::<AccessibilityMirror>().lock().act(button.id, Act::Click);
    frame(&context, |ui| clicks += u32::from(ui.button("Plan").clicked()));
    frame(&context, |ui| clicks += u32::from(ui.button("Plan").clicked()));
    assert_eq!(clicks, 1);
}

#[test]
fn focusing_an_element_gives_its_widget_the_keyboard() {
    let context = mirrored();
    let mut text = String::new();
    let mut draw = |ui: &mut Ui| {
        ui.text_edit_singleline(&mut text).accessible_name("Query");
    };
    frame(&context, &mut draw);
    let input = find(&context, "textbox", "Query");
    context.plugin::<AccessibilityMirror>().lock().act(input.id, Act::Focus);
    frame(&context, &mut draw);
    frame(&context, &mut draw);
    let plugin = context.plugin::<AccessibilityMirror>();
    assert_eq!(plugin.lock().document().focus(), Some(input.id));
}

#[test]
fn tabs_stand_in_a_list_and_cells_in_rows() {
    let context = mirrored();
    for _ in 0..2 {
        frame(&context, |ui| {
            ui.horizontal(|ui| {
                for (name, is_open) in [("Text", true), ("Outline", false)] {
                    let tab = ui.button(name);
                    theme::structure::role(&tab, egui::accesskit::Role::Tab);
                    let cross = ui.button("x");
                    cross.widget_info(|| {
                        egui::WidgetInfo::selected(egui::Role::Button, true, is_open, format!("Close {name}"))
                    });
                }
            });
            egui::Grid::new("grid").show(ui, |ui| {
                theme::structure::part(ui, egui::accesskit::Role::Table, "Keys");
                for row in [["Key", "What"], ["F6", "Next panel"]] {
                    for cell in row {
                        ui.label(cell);
                    }
                    ui.end_row();
                }
            });
        });
    }
    let plugin = context.plugin::<AccessibilityMirror>();
    let mirror = plugin.lock();
    let element =
        |id: u64| mirror.document().elements().find(|element| element.id == id).expect("an element");
    let lists: Vec<&Element> =
        mirror.document().elements().filter(|element| element.role == "tablist").collect();
    assert_eq!(lists.len(), 1);
    let tabs: Vec<&str> = lists[0].children.iter().map(|&id| element(id).label.as_str()).collect();
    assert_eq!(tabs, ["Text", "Outline"]);
    let table = mirror.document().find("table", "Keys").next().expect("a table");
    let cells = |row: u64| -> Vec<(&str, &str)> {
        let cell = |&id: &u64| (element(id).role, element(id).value.as_deref().unwrap_or_default());
        element(row).children.iter().map(cell).collect()
    };
    assert_eq!(table.children.len(), 2);
    assert_eq!(cells(table.children[0]), [("columnheader", "Key"), ("columnheader", "What")]);
    assert_eq!(cells(table.children[1]), [("cell", "F6"), ("cell", "Next panel")]);
}

#[test]
fn what_selects_something_is_no_toggle_button() {
    let context = mirrored();
    for _ in 0..2 {
        frame(&context, |ui| {
            for (name, is_current) in [("Drill", true), ("Drive", false)] {
                theme::structure::item(&ui.button(name), is_current, name);
            }
            theme::structure::choice(ui, true, "Plant");
            theme::structure::folding(&ui.button("Events"), false, "Events");
            egui::Grid::new("windows").show(ui, |ui| {
                theme::structure::part(ui, egui::accesskit::Role::Table, "Windows");
                theme::structure::sorting(&ui.button("Slack"), Some(true), "Sort by slack");
                ui.end_row();
                ui.label("3");
                ui.end_row();
            });
            ui.scope(|ui| {
                theme::structure::options(ui, "Speed");
                theme::structure::option(ui, true, "×2");
            });
            ui.toggle_value(&mut true, "Measure");
        });
    }
    let current = |role, name| {
        let element = find(&context, role, name);
        (element.current, element.toggled)
    };
    assert_eq!(current("button", "Drill"), (true, None));
    assert_eq!(current("button", "Drive"), (false, None));
    assert_eq!(current("button", "Plant"), (true, None));
    assert_eq!(find(&context, "button", "Events").expanded, Some(false));
    assert_eq!(find(&context, "columnheader", "").sort, Some("descending"));
    assert_eq!(find(&context, "option", "×2").toggled, Some(Flag::True), "mirrored as selected");
    assert_eq!(current("button", "Measure"), (false, Some(Flag::True)), "what stays pressed says so");
}

#[test]
fn what_is_announced_is_handed_out_once() {
    let context = mirrored();
    let announce = |words: &str| context.plugin::<AccessibilityMirror>().lock().announce(words);
    let draw = |ui: &mut Ui| drop(ui.button("Steady"));
    announce("Plan found and verified.");
    frame(&context, draw);
    assert_eq!(take_change(&context).expect("news").announcement, "Plan found and verified.");
    announce("Plan found and verified.");
    frame(&context, draw);
    assert_eq!(take_change(&context), None);
    announce("No plan.");
    frame(&context, draw);
    assert_eq!(take_change(&context).expect("news").announcement, "No plan.");
}

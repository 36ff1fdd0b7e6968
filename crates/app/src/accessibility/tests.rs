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

//! The same lists, drawn on the screen and written as SVG, give the same shapes in the same places.

use std::collections::BTreeSet;

use display::{DisplayList, Theme, approximate_text_width};
use egui::epaint::ClippedShape;
use egui::{Pos2, RawInput, Rect, Shape, pos2, vec2};

use super::{DisplayPainter, Placement};

/// The shapes that a list becomes on a screen that shows all of it at zoom 1, with its corner in the screen's.
fn on_screen(list: &DisplayList) -> Vec<Shape> {
    let context = egui::Context::default();
    theme::install_fonts(&context);
    let screen = Rect::from_min_size(Pos2::ZERO, vec2(list.frame.width() as f32, list.frame.height() as f32));
    let mut found = Vec::new();
    // Fonts are there from the second frame on.
    for _ in 0..2 {
        let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
        let output = context.run_ui(input, |ui| {
            let placement = Placement { point: list.frame.min, at: Pos2::ZERO, zoom: 1.0 };
            let painter = ui.ctx().layer_painter(egui::LayerId::background());
            DisplayPainter::new(&painter, screen, placement, &theme::LIGHT).paint(&[list], Vec::new());
        });
        found = output.shapes.iter().map(|ClippedShape { shape, .. }| shape.clone()).collect();
        output.drop_without_applying_deltas();
    }
    let mut flat = Vec::new();
    for shape in found {
        flatten(shape, &mut flat);
    }
    flat
}

fn flatten(shape: Shape, into: &mut Vec<Shape>) {
    match shape {
        Shape::Vec(shapes) => {
            for shape in shapes {
                flatten(shape, into);
            }
        }
        Shape::Noop => {}
        shape => into.push(shape),
    }
}

/// The values of an attribute of all elements of this name.
fn written(svg: &str, element: &str, attributes: &[&str]) -> Vec<Vec<f64>> {
    let begin = format!("<{element} ");
    let tags = svg.split(&begin).skip(1).filter_map(|rest| rest.split('>').next());
    let value = |tag: &str, name: &str| {
        let (_, rest) = format!(" {tag}")
            .split_once(&format!(" {name}=\""))
            .map(|(a, b)| (a.to_owned(), b.to_owned()))?;
        rest.split('"').next()?.parse().ok()
    };
    tags.map(|tag| attributes.iter().filter_map(|name| value(tag, name)).collect()).collect()
}

fn rounded(values: impl IntoIterator<Item = f64>) -> Vec<i64> {
    values.into_iter().map(|value| (value * 4.0).round() as i64).collect()
}

fn assert_same(list: &DisplayList) {
    let svg = display::svg(&[list], Theme::Light, "t");
    let shapes = on_screen(list);
    let corner = list.frame.min;
    let moved = |at: Pos2| [f64::from(at.x) + corner.x, f64::from(at.y) + corner.y];
    let circles: BTreeSet<Vec<i64>> = shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Circle(it) => {
                let [x, y] = moved(it.center);
                Some(rounded([x, y, f64::from(it.radius)]))
            }
            _ => None,
        })
        .collect();
    let in_file = written(&svg, "circle", &["cx", "cy", "r"]).into_iter().map(rounded).collect();
    assert_eq!(circles, in_file, "circles");
    let boxes = |shape: &Shape| match shape {
        Shape::Rect(it) => {
            let ([left, top], size) = (moved(it.rect.min), it.rect.size());
            Some(rounded([left, top, f64::from(size.x), f64::from(size.y)]))
        }
        _ => None,
    };
    let on_screen: BTreeSet<Vec<i64>> = shapes.iter().filter_map(boxes).collect();
    let mut in_file = written(&svg, "rect", &["x", "y", "width", "height"]);
    in_file.remove(0);
    // Plates are as wide as their texts are in the fonts at hand.
    let solid: Vec<_> = list
        .items()
        .iter()
        .filter_map(|item| match item.shape {
            display::Shape::Rectangle { rect, .. } if item.detail.holds(1.0) => {
                let is_dashed = item.stroke.is_some_and(|stroke| stroke.dash.lengths().is_some());
                let is_drawn = matches!(item.fill, Some(display::Fill::Solid(_))) || item.stroke.is_some();
                (is_drawn && (!is_dashed || item.fill.is_some()))
                    .then(|| rounded([rect.min.x, rect.min.y, rect.width(), rect.height()]))
            }
            _ => None,
        })
        .collect();
    assert!(!solid.is_empty() || in_file.is_empty(), "there are boxes to compare");
    let in_file: BTreeSet<Vec<i64>> = in_file.into_iter().map(rounded).collect();
    for rect in solid {
        assert!(on_screen.contains(&rect), "{rect:?} is not on the screen");
        assert!(in_file.contains(&rect), "{rect:?} is not in the file");
    }
    let texts: Vec<&str> = shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Text(it) => Some(it.galley.job.text.as_str()),
            _ => None,
        })
        .collect();
    let in_list = list.items().iter().filter_map(|item| match item.shape {
        display::Shape::Text(place) if item.detail.holds(1.0) => Some(list.text(place)),
        _ => None,
    });
    for text in in_list.filter(|text| text.heading.is_none() && !text.text.is_empty()) {
        let (x, y) = (text.rect.center().x - corner.x, text.rect.center().y - corner.y);
        let is_there = shapes.iter().any(|shape| match shape {
            Shape::Text(it) => {
                let place = it.visual_bounding_rect().expand(12.0);
                it.galley.job.text == text.text.as_str() && place.contains(pos2(x as f32, y as f32))
            }
            _ => false,
        });
        let room = 40.0 + text.rect.width();
        let is_loose = !text.fit.fills_its_place() && room > 80.0;
        assert!(is_there || is_loose && texts.contains(&text.text.as_str()), "{text:?} is not on the screen");
    }
    // Lines: as many as there are paths with a stroke in the file, but for dashes, of which each is a line.
    let solid_paths = list.items().iter().filter(|item| {
        matches!(item.shape, display::Shape::Path { end, .. } if end != display::PathEnd::Closed)
            && item.detail.holds(1.0)
            && item.stroke.is_some_and(|stroke| stroke.dash.lengths().is_none())
    });
    let lines = shapes.iter().filter(|shape| matches!(shape, Shape::Path(_) | Shape::LineSegment { .. }));
    assert!(lines.count() >= solid_paths.count(), "every line is on the screen");
}

fn network(text: &str) -> tpn::Network {
    let (network, diagnostics) = tpn::compile(&rmpl::parse(text).program(), &tpn::Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{diagnostics:#?}"))
}

#[test]
fn a_network_is_the_same_on_the_screen_and_in_a_file() {
    let network = network(include_str!("../../../../assets/missions/enroute.rmpl"));
    let drawing = layout::network(&network, &layout::Options::default(), &approximate_text_width);
    let parts = layout::Parts { structure: true, ..layout::Parts::default() };
    let state = layout::NetworkState { parts, ..layout::NetworkState::default() };
    let list = layout::network_list(&drawing, &network, &state).indexed();
    assert!(list.items().len() > network.nodes.len() + network.arcs.len());
    assert_same(&list);
}

#[test]
fn an_automaton_is_the_same_on_the_screen_and_in_a_file() {
    let text = include_str!("../../../../tests/conformance/h01_orbit_nominal.rmpl");
    let automaton = hca::compile_text(text, &hca::Vocabulary::default()).automaton.expect("it compiles");
    let drawing = layout::automaton(&automaton, &approximate_text_width);
    let marking = automaton.start();
    let state = layout::AutomatonState { marking: Some(&marking), ..layout::AutomatonState::default() };
    assert_same(&layout::automaton_list(&drawing, &automaton, &state));
}

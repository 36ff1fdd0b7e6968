//! The app without a window: a host that plans at once, in memory, with a clock that the test moves.
#![allow(dead_code, reason = "examples use a part of it")]

use std::rc::Rc;

use app::Enroute;
use egui::epaint::TextShape;
use egui::{Rect, Shape};
use egui_kittest::{Harness, HarnessBuilder};
use workbench::host::{FileKind, HostEvent};

pub use test_support::{TestHost, World};

/// A harness around the app, and what it shares with its host.
pub struct App {
    pub harness: Harness<'static, Enroute>,
    /// The host's side.
    pub world: Rc<World>,
}

/// Starts the app in a window of 1440 × 900.
pub fn start() -> App {
    start_in(Rc::default(), |builder| builder)
}

/// Starts the app in a given world, with a changed harness.
pub fn start_in(
    world: Rc<World>,
    build: impl FnOnce(HarnessBuilder<Enroute>) -> HarnessBuilder<Enroute>,
) -> App {
    let host = TestHost::new(&world);
    let builder =
        build(Harness::builder().with_size([1440.0, 900.0]).with_max_steps(8).with_step_dt(1.0 / 60.0));
    let dropped_on = Rc::clone(&world);
    let harness = builder.build_eframe(move |creation| {
        let app = Enroute::new(&creation.egui_ctx, Box::new(host), "");
        app.reading_dropped_files(move |file| read_dropped(&dropped_on, &file))
    });
    App { harness, world }
}

fn read_dropped(world: &World, file: &egui::DroppedFileHandle) {
    let name = file.path().to_string_lossy().into_owned();
    let event = match file.bytes() {
        Ok(bytes) => HostEvent::FileOpened { kind: FileKind::of_name(&name), name, bytes, token: None },
        Err(reason) => HostEvent::FileFailed { name, reason },
    };
    world.news.borrow_mut().push_back(event);
}

impl App {
    /// Lets frames go by until nothing changes any more, at most a few.
    pub fn settle(&mut self) {
        for _ in 0..6 {
            self.world.now_secs.set(self.world.now_secs.get() + 1.0 / 60.0);
            self.harness.step();
        }
    }

    /// The app's state as a host page sees it.
    pub fn json(&self) -> serde_json::Value {
        serde_json::to_value(workbench::host_io::Remote::state(self.harness.state())).expect("plain data")
    }

    /// The texts that are drawn in a place, and where.
    pub fn texts(&self, place: Rect) -> Vec<(String, Rect)> {
        let mut found = Vec::new();
        self.each_text(&mut |text, clip| {
            let rect = text.galley.rect.translate(text.pos.to_vec2());
            if place.contains_rect(rect) && clip.intersects(rect) {
                found.push((text.galley.text().to_owned(), rect));
            }
        });
        found
    }

    /// The places where a text is drawn.
    pub fn texts_of(&self, words: &str) -> Vec<Rect> {
        let mut found = Vec::new();
        self.each_text(&mut |text, clip| {
            let rect = text.galley.rect.translate(text.pos.to_vec2());
            if text.galley.text() == words && clip.intersects(rect) {
                found.push(rect);
            }
        });
        found
    }

    /// Calls `visit` for each text that was painted, with the part of the screen outside of which it is cut.
    pub fn each_text(&self, visit: &mut dyn FnMut(&TextShape, Rect)) {
        fn each(shape: &Shape, clip: Rect, visit: &mut dyn FnMut(&TextShape, Rect)) {
            match shape {
                Shape::Text(text) => visit(text, clip),
                Shape::Vec(shapes) => shapes.iter().for_each(|shape| each(shape, clip, visit)),
                _ => {}
            }
        }
        for shape in &self.harness.output().shapes {
            each(&shape.shape, shape.clip_rect, visit);
        }
    }
}

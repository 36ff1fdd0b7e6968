//! New things of a mission's world as declarations in its text: where they go, and what they are called.

use std::collections::BTreeSet;

use nalgebra::{Point2, Vector2};
use rmpl::program::{Program, World};
use rmpl::{Edit, Span};
use smol_str::{SmolStr, format_smolstr};

use crate::state::selection::Selection;

/// Something that is to be declared.
#[derive(Clone, Debug, PartialEq)]
pub enum NewThing {
    /// A named place, in meters east and north.
    Location(Point2<f64>),
    /// A round obstacle.
    Circle {
        center_m: Point2<f64>,
        /// Its radius in meters.
        radius_m: f64,
    },
    /// An obstacle with at least three corners.
    Polygon(Vec<Point2<f64>>),
    /// A straight wall.
    Wall {
        /// Its ends, which differ.
        ends_m: [Point2<f64>; 2],
        /// How thick it is, in meters.
        thickness_m: f64,
    },
    Vehicle {
        /// The name of its model.
        model: SmolStr,
        /// Where it starts.
        start: VehicleStart,
    },
}

/// Where a vehicle starts.
#[derive(Clone, Debug, PartialEq)]
pub enum VehicleStart {
    /// At a location that is declared.
    Location(SmolStr),
    /// At a place that gets a location of its own.
    Ground(Point2<f64>),
}

/// The edits that declare something, in textual order, and what to select then.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    pub edits: Vec<Edit>,
    /// What was declared.
    pub selection: Selection,
    /// Its declaration as it is in the new text.
    pub text: String,
}

/// The kinds of declaration, in the order in which a file has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Terrain,
    Location,
    Obstacle,
    Vehicle,
}

/// The edits that declare `thing` in one file of `text`, whose meaning is `program`, under a name that the text does not use.
pub fn declare(text: &str, file: Span, program: &Program, thing: &NewThing) -> Declared {
    let here = Here { text, file, world: &program.world };
    let mut names = Names::of(text);
    let (kind, declaration, selection, start) = match thing {
        NewThing::Location(at_m) => {
            let name = names.fresh("P");
            (Kind::Location, location(&name, *at_m), Selection::Location(name), None)
        }
        NewThing::Circle { center_m, radius_m } => {
            let name = names.fresh("Rock");
            let text =
                format!("obstacle {name} circle ({}, {});", place(*center_m), meters(radius_m.max(0.1)));
            (Kind::Obstacle, text, Selection::Obstacle(name), None)
        }
        NewThing::Polygon(corners_m) => {
            let name = names.fresh("Area");
            (Kind::Obstacle, polygon(&name, corners_m), Selection::Obstacle(name), None)
        }
        NewThing::Wall { ends_m, thickness_m } => {
            let name = names.fresh("Wall");
            (Kind::Obstacle, polygon(&name, &wall(*ends_m, *thickness_m)), Selection::Obstacle(name), None)
        }
        NewThing::Vehicle { model, start } => {
            let name = names.fresh(if model == "Blimp" { "Blimp" } else { "Rover" });
            let (at, new) = names.start(start);
            let text = format!("vehicle {name} : {model} at {at};");
            (Kind::Vehicle, text, Selection::Vehicle(name), new)
        }
    };
    let mut edits = Vec::new();
    if let Some(start) = start {
        here.insert(&mut edits, Kind::Location, &start);
    }
    here.insert(&mut edits, kind, &declaration);
    Declared { edits, selection, text: declaration }
}

/// The edits that make a declared vehicle start elsewhere, in textual order.
pub fn move_start(
    text: &str,
    file: Span,
    program: &Program,
    vehicle: &str,
    start: &VehicleStart,
) -> Option<Vec<Edit>> {
    let here = Here { text, file, world: &program.world };
    let declared = here.world.vehicles.iter().find(|it| it.name.text == vehicle)?;
    let (at, new) = Names::of(text).start(start);
    let mut edits = vec![Edit { span: declared.start.span, text: at.to_string() }];
    if let Some(new) = new {
        here.insert(&mut edits, Kind::Location, &new);
    }
    edits.sort_by_key(|edit| edit.span);
    Some(edits)
}

/// Meters to a tenth, as an author would write them.
pub fn meters(value: f64) -> String {
    let tenths = (value * 10.0).round() / 10.0;
    format!("{}", if tenths == 0.0 { 0.0 } else { tenths })
}

/// A place to a tenth of a meter, without parentheses.
pub fn place(point_m: Point2<f64>) -> String {
    format!("{}, {}", meters(point_m.x), meters(point_m.y))
}

/// The corners of a wall of some thickness between two ends, counter-clockwise.
pub fn wall(ends_m: [Point2<f64>; 2], thickness_m: f64) -> [Point2<f64>; 4] {
    let [from, to] = ends_m;
    let along = (to - from).try_normalize(1e-9).unwrap_or_else(Vector2::x);
    let aside = Vector2::new(-along.y, along.x) * (0.5 * thickness_m);
    [from - aside, to - aside, to + aside, from + aside]
}

fn polygon(name: &str, corners_m: &[Point2<f64>]) -> String {
    let corners: Vec<String> = corners_m.iter().map(|&corner| place(corner)).collect();
    format!("obstacle {name} polygon ({});", corners.join(", "))
}

fn location(name: &str, at_m: Point2<f64>) -> String {
    format!("location {name} ({});", place(at_m))
}

/// The words of a text, so that new names do not meet old ones.
pub(super) struct Names {
    used: BTreeSet<SmolStr>,
}

impl Names {
    pub(super) fn of(text: &str) -> Self {
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        Self { used: text.split(|c| !is_part(c)).map(SmolStr::new).collect() }
    }

    /// Returns whether the text has a word, or a new name is that word.
    pub(super) fn contains(&self, word: &str) -> bool {
        self.used.contains(word)
    }

    /// `stem` with the least number that makes it new.
    pub(super) fn fresh(&mut self, stem: &str) -> SmolStr {
        let mut names = (1_u32..).map(|number| format_smolstr!("{stem}{number}"));
        let name = names.find(|name| !self.used.contains(name)).unwrap_or_default();
        self.used.insert(name.clone());
        name
    }

    /// The name of the location where a vehicle starts, and its declaration if it needs one.
    fn start(&mut self, start: &VehicleStart) -> (SmolStr, Option<String>) {
        match start {
            VehicleStart::Location(name) => (name.clone(), None),
            VehicleStart::Ground(at_m) => {
                let name = self.fresh("Start");
                let text = location(&name, *at_m);
                (name, Some(text))
            }
        }
    }
}

/// Where new declarations go.
struct Here<'a> {
    text: &'a str,
    /// The file that takes them.
    file: Span,
    world: &'a World,
}

impl Here<'_> {
    /// Adds the edit that puts a declaration after the last one of its kind in the file, or else after the kinds that come
    /// before it, or else before all code.
    fn insert(&self, edits: &mut Vec<Edit>, kind: Kind, declaration: &str) {
        let (offset, inserted) = if let Some((span, last)) = self.last_before(kind) {
            let between = if last == kind { "\n" } else { "\n\n" };
            (behind(self.text, span.end), format!("{between}{declaration}"))
        } else {
            let own = self.text.get(self.file.range()).unwrap_or_default();
            let offset = first_code(own);
            let after = if offset == own.len() { "\n" } else { "\n\n" };
            (self.file.start + offset as u32, format!("{declaration}{after}"))
        };
        // Edits are disjoint: what goes to the same place goes there at once.
        if let Some(same) = edits.iter_mut().find(|edit| edit.span == Span::new(offset, offset)) {
            same.text = if same.text.ends_with('\n') {
                format!("{}{inserted}", same.text)
            } else {
                format!("{}\n{}", same.text, inserted.trim_start_matches('\n'))
            };
        } else {
            edits.push(Edit { span: Span::new(offset, offset), text: inserted });
            edits.sort_by_key(|edit| edit.span);
        }
    }

    /// The last declaration of the kind in the file, or of the nearest kind before it that the file has.
    fn last_before(&self, kind: Kind) -> Option<(Span, Kind)> {
        let world = self.world;
        let is_here = |span: &Span| self.file.contains(*span);
        let last = |kind| match kind {
            Kind::Terrain => world.terrain.iter().map(|it| it.span).rfind(is_here),
            Kind::Location => world.locations.iter().map(|it| it.span).rfind(is_here),
            Kind::Obstacle => world.obstacles.iter().map(|it| it.span).rfind(is_here),
            Kind::Vehicle => world.vehicles.iter().map(|it| it.span).rfind(is_here),
        };
        let kinds = [Kind::Vehicle, Kind::Obstacle, Kind::Location, Kind::Terrain];
        kinds.into_iter().filter(|&other| other <= kind).find_map(|other| Some((last(other)?, other)))
    }
}

/// The place after the end of a piece of text, and after a comment that ends its line.
pub(super) fn behind(text: &str, end: u32) -> u32 {
    let end = (end as usize).min(text.len());
    let rest = text.get(end..).unwrap_or_default();
    let line = rest.split('\n').next().unwrap_or_default();
    let is_note = line.trim().is_empty() || line.trim_start().starts_with("//");
    if is_note { (end + line.trim_end().len()) as u32 } else { end as u32 }
}

/// The start of the first line that is neither blank nor a comment, or the end of the text.
pub fn first_code(text: &str) -> usize {
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        let trimmed = line.trim();
        if !trimmed.is_empty() && !trimmed.starts_with("//") {
            return offset;
        }
        offset += line.len();
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(text: &str, thing: &NewThing) -> String {
        let mut document = text_editing::Document::new(text);
        let declared = declare(text, Span::new(0, text.len() as u32), &rmpl::parse(text).program(), thing);
        document.edit(&declared.edits, text_editing::EditKind::Single, None);
        let declared_text = document.text().to_owned();
        document.undo();
        assert_eq!(document.text(), text, "one step back is the text as it was");
        declared_text
    }

    const WORLD: &str = "// A mission.\nterrain \"flat\";\nlocation A (1, 2); // home\nlocation P1 (3, 4);\n\n\
                         vehicle Rover1 : ATRV at A;\nscenario S = { }\n";

    #[test]
    fn a_location_comes_behind_the_last_one_under_a_name_that_is_new() {
        let text = after(WORLD, &NewThing::Location(Point2::new(12.34, -0.02)));
        assert_eq!(text, WORLD.replace("P1 (3, 4);", "P1 (3, 4);\nlocation P2 (12.3, 0);"));
    }

    #[test]
    fn the_first_obstacle_comes_behind_the_locations() {
        let text = after(WORLD, &NewThing::Circle { center_m: Point2::new(5.0, 6.0), radius_m: 2.5 });
        assert_eq!(text, WORLD.replace("P1 (3, 4);", "P1 (3, 4);\n\nobstacle Rock1 circle (5, 6, 2.5);"));
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]].map(Point2::from).to_vec();
        let text = after(WORLD, &NewThing::Polygon(corners));
        assert!(text.contains("obstacle Area1 polygon (0, 0, 4, 0, 4, 4);"), "{text}");
    }

    #[test]
    fn a_wall_is_as_thick_as_it_is_wanted_to_both_sides_of_its_line() {
        let ends_m = [[10.0, 20.0], [10.0, 50.0]].map(Point2::from);
        let text = after(WORLD, &NewThing::Wall { ends_m, thickness_m: 3.0 });
        assert!(text.contains("obstacle Wall1 polygon (11.5, 20, 11.5, 50, 8.5, 50, 8.5, 20);"), "{text}");
    }

    #[test]
    fn a_vehicle_on_free_ground_gets_a_location_in_the_same_step() {
        let start = VehicleStart::Ground(Point2::new(7.0, 8.0));
        let text = after(WORLD, &NewThing::Vehicle { model: "ATRV".into(), start });
        let expected = WORLD
            .replace("P1 (3, 4);", "P1 (3, 4);\nlocation Start1 (7, 8);")
            .replace("ATRV at A;", "ATRV at A;\nvehicle Rover2 : ATRV at Start1;");
        assert_eq!(text, expected);
        let start = VehicleStart::Ground(Point2::new(7.0, 8.0));
        let text = after("// Nothing.\n", &NewThing::Vehicle { model: "Blimp".into(), start });
        assert_eq!(text, "// Nothing.\nlocation Start1 (7, 8);\nvehicle Blimp1 : Blimp at Start1;\n");
    }

    #[test]
    fn a_comment_behind_the_last_declaration_stays_on_its_line() {
        let text = after("location A (1, 2); // home\n", &NewThing::Location(Point2::new(3.0, 4.0)));
        assert_eq!(text, "location A (1, 2); // home\nlocation P1 (3, 4);\n");
        let text = after("location A (1, 2); scenario S = {}", &NewThing::Location(Point2::new(3.0, 4.0)));
        assert_eq!(text, "location A (1, 2);\nlocation P1 (3, 4); scenario S = {}");
    }

    #[test]
    fn a_declaration_goes_to_the_file_that_is_shown() {
        let world = "location A (1, 2);\n";
        let whole =
            rmpl::files::joined([("", "scenario S = { }\n"), ("world.rmpl", world), ("more.rmpl", "")]);
        let files = rmpl::files::Files::of(&whole);
        let declared = |name: &str| {
            let file = files.named(name).expect("it is there");
            let program = rmpl::parse(&whole).program();
            let thing = NewThing::Location(Point2::new(3.0, 4.0));
            let mut document = text_editing::Document::new(&whole);
            let range = document.file_range(file.start as usize);
            let span = Span::new(range.start as u32, range.end as u32);
            document.edit(
                &declare(&whole, span, &program, &thing).edits,
                text_editing::EditKind::Single,
                None,
            );
            let text = document.text().to_owned();
            let files = rmpl::files::split(&text).into_iter();
            files.map(|(_, text)| text.trim_end().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(declared(""), ["location P1 (3, 4);\n\nscenario S = { }", "location A (1, 2);", ""]);
        assert_eq!(declared("world.rmpl")[1], "location A (1, 2);\nlocation P1 (3, 4);");
        assert_eq!(declared("more.rmpl"), ["scenario S = { }", "location A (1, 2);", "location P1 (3, 4);"]);
    }

    #[test]
    fn a_text_without_a_world_gets_its_first_place_in_front_of_its_code() {
        let text = after("// A title.\n\nscenario S = { }\n", &NewThing::Location(Point2::new(3.0, 4.0)));
        assert_eq!(text, "// A title.\n\nlocation P1 (3, 4);\n\nscenario S = { }\n");
    }

    #[test]
    fn a_vehicle_is_moved_to_a_location_or_to_a_new_one() {
        let program = rmpl::parse(WORLD).program();
        let moved = |start| {
            let mut document = text_editing::Document::new(WORLD);
            let edits = move_start(WORLD, Span::new(0, WORLD.len() as u32), &program, "Rover1", &start)
                .expect("it is declared");
            document.edit(&edits, text_editing::EditKind::Single, None);
            document.text().to_owned()
        };
        assert_eq!(moved(VehicleStart::Location("P1".into())), WORLD.replace("ATRV at A", "ATRV at P1"));
        let expected = WORLD
            .replace("P1 (3, 4);", "P1 (3, 4);\nlocation Start1 (9, 9);")
            .replace("ATRV at A", "ATRV at Start1");
        assert_eq!(moved(VehicleStart::Ground(Point2::new(9.0, 9.0))), expected);
    }
}

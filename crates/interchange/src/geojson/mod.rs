//! Places and obstacles of `GeoJSON` (RFC 7946) as declarations of a mission, and the frame that both have in common.
//!
//! A `Point` is a `location`, or with a `radius_m` among its properties an `obstacle … circle`; a `Polygon` is an
//! `obstacle … polygon`, its holes cut open from the border; a `MultiPolygon` is one obstacle for each of its parts. All
//! other geometries are counted and left out. Heights are not read: the terrain has them. A `Point` with an
//! `enroute_model` is a vehicle of that model and the place where it starts; places and vehicles with one `enroute_group`
//! are a group (SPEC 17). A table in CSV says the same, one point in each line.

mod keyhole;
mod projection;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use nalgebra::Point2;
use rmpl::syntax::SyntaxKind;
use serde_json::Value;

pub use keyhole::without_holes;
pub use projection::{BODY_RADII_M, EARTH_RADIUS_M, Frame, Projection};
pub use table::is_table;

/// The member of a file, beside `type`, that says what its coordinates are: `{"units": "metres"}` for meters east and
/// north of the mission's origin, or `{"origin": [LON, LAT], "radius_m": R}` for where the origin is and how large the
/// body.
pub const FRAME: &str = "enroute_frame";

/// The most corners and places that a file may have.
pub const MAX_POSITIONS: usize = 100_000;

/// The most corners of polygons that have holes: each hole is held against all sides.
pub const MAX_HOLED_POSITIONS: usize = 5_000;

/// Why a file gives no declarations.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeoJsonError {
    /// It is not JSON, or no `GeoJSON` object.
    #[error("this is not GeoJSON: {0}")]
    Shape(String),
    /// A table that cannot be read, or lacks a column.
    #[error("cannot read the table: {0}")]
    Table(String),
    /// Its coordinates are in a system that is not known here.
    #[error(
        "coordinates in {0} are not supported; convert them to degrees (RFC 7946), as with `ogr2ogr -t_srs EPSG:4326 -lco \
         RFC7946=YES OUT.geojson IN`, or use `enroute import --meters` if they are meters"
    )]
    ReferenceSystem(String),
    /// A position that is none.
    #[error("{place}: {problem}")]
    Position {
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// More than [`MAX_POSITIONS`] or [`MAX_HOLED_POSITIONS`].
    #[error(
        "the file has more than {MAX_POSITIONS} positions, or {MAX_HOLED_POSITIONS} in polygons with holes"
    )]
    TooLarge,
    /// Nothing in it is a place or an obstacle.
    #[error("the file needs a Point, Polygon or MultiPolygon")]
    Empty,
}

/// Returns whether a document is `GeoJSON`, by its `type`.
pub fn is_geojson(document: &Value) -> bool {
    let kind = document.get("type").and_then(Value::as_str).unwrap_or_default();
    (kind == "FeatureCollection" && document.get("features").is_some_and(Value::is_array))
        || (kind == "Feature" && document.get("geometry").is_some())
        || (GEOMETRIES.contains(&kind)
            && (document.get("coordinates").is_some() || document.get("geometries").is_some()))
}

const GEOMETRIES: [&str; 7] =
    ["Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon", "GeometryCollection"];

/// The declarations of a file that is named or looks like `GeoJSON`; `None` for all others.
pub fn declarations_of_file(name: &str, bytes: &[u8]) -> Option<Result<String, GeoJsonError>> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let is_object = bytes.trim_ascii_start().starts_with(b"{");
    let is_named_so = name.to_ascii_lowercase().ends_with(".geojson") || is_table(name);
    if !is_object && !is_named_so {
        return None;
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Some(declarations(name, text, &Frame::default())),
        Err(_) => Some(Err(GeoJsonError::Shape("the file is not text".to_owned()))),
    }
}

/// The declarations that a file comes to, as lines of a mission, after comments that say where they are from and what was
/// left out. `wanted` overrides what the file says of its frame.
pub fn declarations(name: &str, text: &str, wanted: &Frame) -> Result<String, GeoJsonError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document: Value = if is_table(name) {
        table::document(text, wanted)?
    } else {
        serde_json::from_str(text).map_err(|error| GeoJsonError::Shape(error.to_string()))?
    };
    if !is_geojson(&document) {
        return Err(GeoJsonError::Shape("expected a feature, a collection or a geometry".to_owned()));
    }
    let mut reader = Reader::default();
    match document.get("features").and_then(Value::as_array) {
        Some(features) => features.iter().try_for_each(|feature| reader.feature(feature))?,
        None if document.get("geometry").is_some() => reader.feature(&document)?,
        None => reader.geometry(&document, &Feature::default())?,
    }
    if reader.shapes.is_empty() {
        return Err(GeoJsonError::Empty);
    }
    let frame = Frame::of_file(&document, wanted)?.overridden(wanted);
    if !wanted.is_meters {
        projection::check_mercator(&document, reader.positions())?;
    }
    let projection = frame.projection(reader.positions())?;
    let mut lines = format!("// Places and obstacles of {}: {projection}.\n", one_line(name));
    match reader.lines {
        0 => {}
        1 => lines.push_str("// Not read: a line.\n"),
        count => {
            let _ = writeln!(lines, "// Not read: {count} lines.");
        }
    }
    for shape in &reader.shapes {
        shape.declare(&projection, &mut lines)?;
    }
    for Vehicle { name, model, start } in &reader.vehicles {
        let _ = writeln!(lines, "vehicle {name} : {model} at {start};");
    }
    for (_, name, members) in &reader.groups {
        let _ = writeln!(lines, "group {name} = {};", members.join(", "));
    }
    Ok(lines)
}

/// Its name and what its properties say.
#[derive(Default)]
struct Feature {
    name: String,
    radius_m: Option<f64>,
    /// The vehicle model of what starts here.
    model: Option<String>,
    group: Option<String>,
}

enum Geometry {
    Place([f64; 2]),
    Circle {
        center: [f64; 2],
        radius_m: f64,
    },
    /// The border, and then the holes.
    Polygon(Vec<Vec<[f64; 2]>>),
}

/// One declaration, in the coordinates of the file.
struct Shape {
    name: String,
    geometry: Geometry,
}

/// A vehicle and the location where it starts.
struct Vehicle {
    name: String,
    model: String,
    start: String,
}

#[derive(Default)]
struct Reader {
    shapes: Vec<Shape>,
    vehicles: Vec<Vehicle>,
    /// By the name in the file: the name in the mission, and the members.
    groups: Vec<(String, String, Vec<String>)>,
    names: BTreeSet<String>,
    /// How many have asked for a name.
    asked: BTreeMap<String, usize>,
    position_count: usize,
    holed_count: usize,
    lines: usize,
}

impl Reader {
    fn feature(&mut self, feature: &Value) -> Result<(), GeoJsonError> {
        let properties = feature.get("properties");
        let property = |key: &str| properties.and_then(|it| it.get(key));
        let named = property("name").or_else(|| feature.get("id"));
        let name = match named {
            Some(Value::String(name)) => name.clone(),
            Some(Value::Number(number)) => number.to_string(),
            _ => String::new(),
        };
        let radius_m = property("radius_m").and_then(Value::as_f64);
        let text = |key: &str| property(key).and_then(Value::as_str).map(str::to_owned);
        let (model, group) = (text("enroute_model"), text("enroute_group"));
        match feature.get("geometry") {
            // A feature may have no place.
            None | Some(Value::Null) => Ok(()),
            Some(geometry) => self.geometry(geometry, &Feature { name, radius_m, model, group }),
        }
    }

    fn geometry(&mut self, geometry: &Value, feature: &Feature) -> Result<(), GeoJsonError> {
        let coordinates = geometry.get("coordinates").unwrap_or(&Value::Null);
        match geometry.get("type").and_then(Value::as_str).unwrap_or_default() {
            "Point" => self.point(coordinates, feature),
            "MultiPoint" => {
                list(coordinates, feature)?.iter().try_for_each(|point| self.point(point, feature))
            }
            "Polygon" => self.polygon(coordinates, feature),
            "MultiPolygon" => {
                list(coordinates, feature)?.iter().try_for_each(|part| self.polygon(part, feature))
            }
            "GeometryCollection" => {
                let parts = geometry.get("geometries").unwrap_or(&Value::Null);
                list(parts, feature)?.iter().try_for_each(|part| self.geometry(part, feature))
            }
            "LineString" | "MultiLineString" => {
                self.lines += 1;
                Ok(())
            }
            other => Err(wrong(feature, format!("`{}` is not a geometry", one_line(other)))),
        }
    }

    fn point(&mut self, point: &Value, feature: &Feature) -> Result<(), GeoJsonError> {
        let position = self.position(point, feature)?;
        let (geometry, plain) = match feature.radius_m {
            Some(radius_m) if !RADII_M.contains(&radius_m) => {
                return Err(wrong(feature, format!("`radius_m` must be greater than 0, not {radius_m}")));
            }
            Some(radius_m) => (Geometry::Circle { center: position, radius_m }, "Obstacle"),
            None => (Geometry::Place(position), "Place"),
        };
        if feature.radius_m.is_some() {
            refuse_members(feature)?;
        }
        let name = self.free_name(&feature.name, if feature.model.is_some() { "Vehicle" } else { plain });
        let Some(model) = &feature.model else {
            self.join(feature, &name);
            self.shapes.push(Shape { name, geometry });
            return Ok(());
        };
        let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
        if !model.starts_with(|letter: char| letter.is_ascii_alphabetic()) || !model.chars().all(is_part) {
            return Err(wrong(feature, format!("`{}` is not the name of a model", one_line(model))));
        }
        let start = self.free_name(&format!("{name}_START"), plain);
        self.join(feature, &name);
        self.vehicles.push(Vehicle { name, model: model.clone(), start: start.clone() });
        self.shapes.push(Shape { name: start, geometry });
        Ok(())
    }

    /// A place or vehicle becomes a member of the group that its feature says.
    fn join(&mut self, feature: &Feature, name: &str) {
        let Some(group) = &feature.group else { return };
        let known = self.groups.iter().position(|(said, ..)| said == group);
        let at = known.unwrap_or_else(|| {
            let free = self.free_name(group, "Group");
            self.groups.push((group.clone(), free, Vec::new()));
            self.groups.len() - 1
        });
        self.groups[at].2.push(name.to_owned());
    }

    fn polygon(&mut self, rings: &Value, feature: &Feature) -> Result<(), GeoJsonError> {
        refuse_members(feature)?;
        let mut read = Vec::new();
        for ring in list(rings, feature)? {
            let positions = list(ring, feature)?.iter().map(|position| self.position(position, feature));
            let mut ring: Vec<[f64; 2]> = positions.collect::<Result<_, _>>()?;
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            if ring.len() < 3 {
                return Err(wrong(feature, "a ring needs at least three corners".to_owned()));
            }
            read.push(ring);
        }
        if read.len() > 1 {
            self.holed_count += read.iter().map(Vec::len).sum::<usize>();
        }
        if self.holed_count > MAX_HOLED_POSITIONS {
            return Err(GeoJsonError::TooLarge);
        }
        if !read.is_empty() {
            let name = self.free_name(&feature.name, "Obstacle");
            self.shapes.push(Shape { name, geometry: Geometry::Polygon(read) });
        }
        Ok(())
    }

    fn position(&mut self, position: &Value, feature: &Feature) -> Result<[f64; 2], GeoJsonError> {
        self.position_count += 1;
        if self.position_count > MAX_POSITIONS {
            return Err(GeoJsonError::TooLarge);
        }
        let number = |axis: usize| position.get(axis).and_then(Value::as_f64).filter(|it| it.is_finite());
        match (number(0), number(1)) {
            (Some(east), Some(north)) => Ok([east, north]),
            _ => Err(wrong(feature, "a position must be a pair of numbers".to_owned())),
        }
    }

    fn positions(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.shapes.iter().flat_map(|shape| match &shape.geometry {
            Geometry::Place(position) | Geometry::Circle { center: position, .. } => vec![*position],
            Geometry::Polygon(rings) => rings.concat(),
        })
    }

    /// Returns what a feature is called as a name of the language, told from those before it.
    fn free_name(&mut self, said: &str, plain: &str) -> String {
        let mut name: String =
            said.chars().map(|it| if it.is_ascii_alphanumeric() { it } else { '_' }).collect();
        name.truncate(MAX_NAME_BYTES);
        let name = name.trim_matches('_').to_owned();
        let has_name = !name.is_empty();
        let name = match name.chars().next() {
            None => plain.to_owned(),
            Some(first) if first.is_ascii_digit() => format!("{plain}_{name}"),
            Some(_) if SyntaxKind::keyword(&name).is_some() => format!("{name}_"),
            Some(_) => name,
        };
        let joint = if has_name { "_" } else { "" };
        let asked = self.asked.entry(name.clone()).or_default();
        loop {
            *asked += 1;
            let number = *asked;
            let free = if has_name && number == 1 { name.clone() } else { format!("{name}{joint}{number}") };
            if self.names.insert(free.clone()) {
                return free;
            }
        }
    }
}

const MAX_NAME_BYTES: usize = 60;

/// Radii that a declaration can give: at least a millimeter.
const RADII_M: std::ops::Range<f64> = 0.001..1e8;

impl Shape {
    fn declare(&self, projection: &Projection, lines: &mut String) -> Result<(), GeoJsonError> {
        let name = &self.name;
        let project = |position: [f64; 2]| {
            let place = || name.clone();
            projection
                .to_meters(position)
                .map_err(|problem| GeoJsonError::Position { place: place(), problem })
        };
        match &self.geometry {
            Geometry::Place(position) => {
                let _ = writeln!(lines, "location {name} ({});", written([project(*position)?]));
            }
            Geometry::Circle { center, radius_m } => {
                let center = written([project(*center)?]);
                let _ = writeln!(lines, "obstacle {name} circle ({center}, {});", millimeters(*radius_m));
            }
            Geometry::Polygon(rings) => {
                let rings = rings.iter().map(|ring| ring.iter().copied().map(project).collect());
                let mut rings = rings.collect::<Result<Vec<Vec<Point2<f64>>>, _>>()?.into_iter();
                let border = rings.next().unwrap_or_default();
                let corners = written(without_holes(border, rings.collect()));
                let _ = writeln!(lines, "obstacle {name} polygon ({corners});");
            }
        }
        Ok(())
    }
}

/// Refuses an obstacle with a vehicle model or a group.
fn refuse_members(feature: &Feature) -> Result<(), GeoJsonError> {
    match (&feature.model, &feature.group) {
        (None, None) => Ok(()),
        _ => Err(wrong(feature, "an obstacle cannot have a model or a group".to_owned())),
    }
}

fn list<'value>(value: &'value Value, feature: &Feature) -> Result<&'value Vec<Value>, GeoJsonError> {
    value.as_array().ok_or_else(|| wrong(feature, "its coordinates must be a list".to_owned()))
}

fn wrong(feature: &Feature, problem: String) -> GeoJsonError {
    let name = one_line(&feature.name);
    let place = if name.is_empty() { "a feature without a name".to_owned() } else { format!("\"{name}\"") };
    GeoJsonError::Position { place, problem }
}

/// Numbers of the language, to the millimeter.
fn written(points_m: impl IntoIterator<Item = Point2<f64>>) -> String {
    let numbers = points_m.into_iter().map(|it| format!("{}, {}", millimeters(it.x), millimeters(it.y)));
    numbers.collect::<Vec<_>>().join(", ")
}

fn millimeters(meters: f64) -> String {
    let text = format!("{meters:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn one_line(text: &str) -> String {
    text.chars().map(|it| if it.is_control() { ' ' } else { it }).take(80).collect()
}

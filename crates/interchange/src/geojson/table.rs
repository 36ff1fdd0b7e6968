//! Tables of places and vehicles: CSV with a heading, as the `GeoJSON` that says the same.

use serde_json::{Map, Value, json};

use super::{FRAME, Frame, GeoJsonError, Projection};

/// Columns of numbers, and what they are in degrees or meters.
const METERS: [&str; 2] = ["east", "north"];
const DEGREES: [&str; 2] = ["lon", "lat"];
/// Columns of texts, and the properties that they become.
const TEXTS: [(&str, &str); 3] = [("name", "name"), ("model", "enroute_model"), ("group", "enroute_group")];

/// Returns whether a file is a table, by its name.
pub fn is_table(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".csv")
}

/// The points of a table with the frame that its columns have, which must agree with what is `wanted`.
pub(super) fn document(text: &str, wanted: &Frame) -> Result<Value, GeoJsonError> {
    let wrong = GeoJsonError::Table;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let heading = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let column = |name: &str| heading.iter().position(|it| it.eq_ignore_ascii_case(name));
    let pair = |[first, second]: [&str; 2]| Some([column(first)?, column(second)?]);
    let (axes, is_meters) = match (pair(METERS), pair(DEGREES)) {
        (Some(axes), None) => (axes, true),
        (None, Some(axes)) => (axes, false),
        _ => return Err(wrong("it needs the columns `east` and `north`, or `lon` and `lat`".to_owned())),
    };
    if wanted.is_meters && !is_meters {
        return Err(wrong("its columns are in degrees; remove --meters".to_owned()));
    }
    if is_meters && (wanted.origin_deg.is_some() || wanted.radius_m.is_some()) {
        return Err(wrong("its columns are in meters; remove --origin and --radius".to_owned()));
    }
    let is_known = |name: &str| {
        let texts = TEXTS.iter().map(|(column, _)| *column).chain(["radius_m"]);
        texts.chain(METERS).chain(DEGREES).any(|known| known.eq_ignore_ascii_case(name))
    };
    if let Some(unknown) = heading.iter().find(|name| !is_known(name)) {
        return Err(wrong(format!(
            "unknown column `{unknown}`; the columns are name, east, north (or lon, lat), radius_m, model and group"
        )));
    }
    let mut features = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |at: usize| record.get(at).unwrap_or("");
        let number = |at: usize| {
            let number: Option<f64> = cell(at).parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| wrong(format!("line {line}: `{}` is not a number", cell(at))))
        };
        let mut properties = Map::new();
        for (name, property) in TEXTS {
            if let Some(text) = column(name).map(cell).filter(|text| !text.is_empty()) {
                properties.insert(property.to_owned(), text.into());
            }
        }
        if let Some(at) = column("radius_m").filter(|&at| !cell(at).is_empty()) {
            properties.insert("radius_m".to_owned(), number(at)?.into());
        }
        let coordinates = [number(axes[0])?, number(axes[1])?];
        features.push(json!({
            "type": "Feature",
            "properties": properties,
            "geometry": { "type": "Point", "coordinates": coordinates },
        }));
    }
    let frame = if is_meters { Projection::Meters.to_json() } else { json!({ "units": "degrees" }) };
    Ok(json!({ "type": "FeatureCollection", FRAME: frame, "features": features }))
}

#[cfg(test)]
mod tests {
    use super::super::{Frame, declarations};

    fn read(table: &str, wanted: &Frame) -> Result<Vec<String>, String> {
        let lines = declarations("fleet.csv", table, wanted).map_err(|error| error.to_string())?;
        Ok(lines.lines().filter(|line| !line.starts_with("//")).map(str::to_owned).collect())
    }

    #[test]
    fn lines_are_places_obstacles_vehicles_and_members_of_groups() {
        let table = "Name, East, North, radius_m, model, group\nRIDGE,30,0,,,Sites\nROCK,5,5,2,,\nBASIN,0,40,,,Sites\n\
                     R1,1,2,,ATRV-Jr,Scouts\nR2,3,2.5,,ATRV-Jr,Scouts\n";
        let lines = read(table, &Frame::default());
        let expected = [
            "location RIDGE (30, 0);",
            "obstacle ROCK circle (5, 5, 2);",
            "location BASIN (0, 40);",
            "location R1_START (1, 2);",
            "location R2_START (3, 2.5);",
            "vehicle R1 : ATRV-Jr at R1_START;",
            "vehicle R2 : ATRV-Jr at R2_START;",
            "group Sites = RIDGE, BASIN;",
            "group Scouts = R1, R2;",
        ];
        assert_eq!(lines, Ok(expected.map(str::to_owned).to_vec()));
    }

    #[test]
    fn columns_in_degrees_become_meters() {
        let frame = Frame { origin_deg: Some([77.45, 18.44]), ..Frame::default() };
        assert_eq!(
            read("name,lon,lat\nBASE,77.45,18.44\n", &frame),
            Ok(vec!["location BASE (0, 0);".to_owned()])
        );
    }

    #[test]
    fn what_a_table_does_not_say_is_refused() {
        let refused = |table: &str, wanted: &Frame, problem: &str| {
            let error = read(table, wanted).expect_err("it is refused");
            assert!(error.contains(problem), "{error}");
        };
        let (plain, meters) = (Frame::default(), Frame { is_meters: true, ..Frame::default() });
        let origin = Frame { origin_deg: Some([0.0, 0.0]), ..Frame::default() };
        refused("name,east\nA,1\n", &plain, "needs the columns `east` and `north`, or `lon` and `lat`");
        refused("name,east,north,color\nA,1,2,red\n", &plain, "unknown column `color`");
        refused("name,east,north\nA,1,here\n", &plain, "line 2: `here` is not a number");
        refused("name,east,north\nA,1\n", &plain, "cannot read the table");
        refused("name,east,north,radius_m,group\nA,1,2,3,Sites\n", &plain, "an obstacle cannot have");
        refused("name,east,north,model\nA,1,2,A B\n", &plain, "`A B` is not the name of a model");
        refused("name,lon,lat\nA,1,2\n", &meters, "remove --meters");
        refused("name,east,north\nA,1,2\n", &origin, "remove --origin and --radius");
        refused("name,east,north\n", &plain, "needs a Point");
    }
}

//! Places and obstacles of `GeoJSON`: declarations that the language reads, in the right places.

use interchange::geojson::{EARTH_RADIUS_M, Frame, Projection, declarations};
use nalgebra::Point2;
use rmpl::program::{ObstacleShape, World};
use serde_json::{Value, json};

fn world(file: &Value) -> World {
    world_of(file, &Frame::default())
}

fn world_of(file: &Value, frame: &Frame) -> World {
    let lines = declarations("site.geojson", &file.to_string(), frame).expect("it is GeoJSON");
    let parse = rmpl::parse(&lines);
    assert!(parse.diagnostics().is_empty(), "{lines}\n{:?}", parse.diagnostics());
    parse.program().world
}

fn refusal(file: &Value) -> String {
    declarations("site.geojson", &file.to_string(), &Frame::default()).expect_err("it is refused").to_string()
}

fn point(name: &str, position: [f64; 2]) -> Value {
    let geometry = json!({ "type": "Point", "coordinates": position });
    json!({ "type": "Feature", "properties": { "name": name }, "geometry": geometry })
}

fn meters(features: &[Value]) -> Value {
    json!({ "type": "FeatureCollection", "enroute_frame": { "units": "metres" }, "features": features })
}

#[test]
fn degrees_are_meters_east_and_north_of_the_south_west_corner() {
    let (lon, lat) = (-6.5, 46.5);
    let file = json!({ "type": "FeatureCollection", "features": [
        point("Base", [lon, lat]), point("East", [lon + 0.01, lat]), point("North", [lon, lat + 0.01]),
    ]});
    let places = world(&file).locations;
    let degree_m = EARTH_RADIUS_M * 1_f64.to_radians();
    let expected = [
        ("Base", [0.0, 0.0]),
        ("East", [0.01 * degree_m * lat.to_radians().cos(), 0.0]),
        ("North", [0.0, 0.01 * degree_m]),
    ];
    for (place, (name, wanted)) in places.iter().zip(expected) {
        assert_eq!(place.name.text, name);
        // A parallel is not straight: 770 m east it is 0.05 m farther north.
        assert!((place.position_m[0] - wanted[0]).abs() < 0.1, "{place:?}");
        assert!((place.position_m[1] - wanted[1]).abs() < 0.1, "{place:?}");
    }
}

#[test]
fn the_origin_and_the_radius_are_the_files_or_the_callers() {
    let said = json!({ "origin": [77.4, 18.4], "radius_m": 3_396_190.0 });
    let file =
        json!({ "type": "FeatureCollection", "enroute_frame": said, "features": [point("A", [77.4, 18.5])] });
    let north = |world: &World| world.locations[0].position_m[1];
    assert!((north(&world(&file)) - 3_396_190.0 * 0.1_f64.to_radians()).abs() < 0.001);
    let wanted = Frame { origin_deg: Some([77.4, 18.45]), ..Frame::default() };
    assert!((north(&world_of(&file, &wanted)) - 3_396_190.0 * 0.05_f64.to_radians()).abs() < 0.001);
}

#[test]
fn what_is_projected_comes_back_and_the_distance_from_the_origin_is_that_on_the_sphere() {
    // Across the date line, in the south, at the pole.
    for origin_deg in [[77.4, 18.4], [179.99, -45.0], [0.0, 89.99], [12.0, 0.0]] {
        let projection = Projection::Degrees { origin_deg, radius_m: 3_396_190.0 };
        for point in [[0.0, 0.0], [1500.0, -20.0], [-4000.0, 3000.0]].map(Point2::from) {
            let position = projection.from_meters(point);
            let back = projection.to_meters(position).expect("it is near");
            assert!(nalgebra::distance(&point, &back) < 1e-5, "{origin_deg:?} {point} {back}");
            let [[lon, lat], [lon_0, lat_0]] = [position, origin_deg].map(|it| it.map(f64::to_radians));
            let half = ((lat - lat_0) / 2.0).sin().powi(2)
                + lat.cos() * lat_0.cos() * ((lon - lon_0) / 2.0).sin().powi(2);
            let haversine = 2.0 * 3_396_190.0 * half.sqrt().asin();
            assert!((haversine - point.coords.norm()).abs() < 1e-3, "{haversine} {point}");
        }
    }
}

fn polygon(rings: &Value) -> Value {
    let geometry = json!({ "type": "Polygon", "coordinates": rings });
    json!({ "type": "Feature", "id": 7, "properties": null, "geometry": geometry })
}

fn covers(world: &World, point: [f64; 2]) -> bool {
    world.obstacles.iter().any(|it| snapshot::ground::obstacle(&it.shape).contains(point.into()))
}

#[test]
fn a_polygon_is_an_obstacle_and_its_holes_are_free_whichever_way_they_turn() {
    let square =
        |x: f64, y: f64, side: f64| vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]];
    for turned in [false, true] {
        let mut holes = [square(1.0, 1.0, 2.0), square(6.0, 5.0, 3.0), square(4.0, 1.0, 1.0)];
        if turned {
            for ring in &mut holes {
                ring.reverse();
            }
        }
        let [a, b, c] = holes;
        let world = world(&meters(&[polygon(&json!([square(0.0, 0.0, 10.0), a, b, c]))]));
        assert_eq!(world.obstacles[0].name.text, "Obstacle_7");
        assert_eq!(world.obstacles.len(), 1);
        for free in [[2.0, 2.1], [7.5, 6.6], [4.4, 1.6], [11.0, 5.0]] {
            assert!(!covers(&world, free), "{free:?} {turned}");
        }
        for covered in [[0.5, 0.4], [3.5, 3.6], [5.2, 6.1], [9.4, 9.7], [3.4, 1.3], [0.3, 8.8]] {
            assert!(covers(&world, covered), "{covered:?} {turned}");
        }
    }
}

#[test]
fn parts_circles_and_names() {
    let square = |x: f64| json!([[[x, 0.0], [x + 1.0, 0.0], [x, 1.0], [x, 0.0]]]);
    let parts = json!({ "type": "MultiPolygon", "coordinates": [square(0.0), square(5.0)] });
    let circle = json!({ "type": "Point", "coordinates": [1.5, 2.0, 99.0] });
    let file = meters(&[
        json!({ "type": "Feature", "properties": { "name": "Big rock" }, "geometry": parts }),
        json!({ "type": "Feature", "properties": { "name": "choose", "radius_m": 2.5 }, "geometry": circle }),
        point("2nd site", [-1.0, 1e-9]),
        point("", [3.0, 4.0]),
        json!({ "type": "Feature", "properties": {}, "geometry": null }),
    ]);
    let world = world(&file);
    let names: Vec<&str> = world.obstacles.iter().map(|it| it.name.text.as_str()).collect();
    assert_eq!(names, ["Big_rock", "Big_rock_2", "choose_"]);
    assert_eq!(world.obstacles[2].shape, ObstacleShape::Circle { center_m: [1.5, 2.0], radius_m: 2.5 });
    let places: Vec<_> = world.locations.iter().map(|it| (it.name.text.as_str(), it.position_m)).collect();
    assert_eq!(places, [("Place_2nd_site", [-1.0, 0.0]), ("Place1", [3.0, 4.0])]);
}

#[test]
fn what_is_left_out_is_said() {
    let line = json!({ "type": "LineString", "coordinates": [[0, 0], [1, 1]] });
    let file =
        meters(&[point("A", [0.0, 0.0]), json!({ "type": "Feature", "properties": {}, "geometry": line })]);
    let lines = declarations("a\nb.geojson", &file.to_string(), &Frame::default()).expect("it is GeoJSON");
    assert!(lines.contains("// Not read: a line.") && lines.contains("of a b.geojson"), "{lines}");
}

#[test]
fn a_reference_system_of_the_file_or_of_its_features_may_be_in_meters() {
    let system = |code: u32| json!({ "type": "name", "properties": { "name": format!("urn:ogc:def:crs:EPSG::{code}") } });
    let collection = |features: &[Value]| json!({ "type": "FeatureCollection", "features": features });
    let lines = |file: &Value| declarations("a.geojson", &file.to_string(), &Frame::default());
    for code in [3857, 32_633, 25_832] {
        let mut of_file = collection(&[point("A", [12.5, -3.0])]);
        of_file["crs"] = system(code);
        let mut feature = point("A", [12.5, -3.0]);
        feature["crs"] = system(code);
        for file in [of_file, collection(&[feature.clone()]), feature] {
            let lines = lines(&file).expect("it is GeoJSON");
            assert!(lines.contains("location A (12.5, -3);"), "{code}: {lines}");
        }
    }
    let mut degrees = collection(&[point("A", [12.5, -3.0])]);
    degrees["features"][0]["crs"] = system(4326);
    assert!(lines(&degrees).expect("it is GeoJSON").contains("location A (0, 0);"));
    let mut mixed = collection(&[point("A", [1.0, 1.0]), point("B", [1.0, 1.0])]);
    mixed["features"][1]["crs"] = system(3857);
    assert!(refusal(&mixed).contains("degrees for some features"), "{}", refusal(&mixed));
    // Far from the equator its meters are shorter than those on the ground.
    let mut far = collection(&[point("A", [0.0, 8_000_000.0])]);
    far["crs"] = system(3857);
    assert!(refusal(&far).contains("EPSG:3857 far from the equator"), "{}", refusal(&far));
}

#[test]
fn what_cannot_be_placed_is_refused_with_its_reason() {
    let collection = |features: &[Value]| json!({ "type": "FeatureCollection", "features": features });
    let mut projected = collection(&[point("A", [500_000.0, 4_000_000.0])]);
    assert!(
        refusal(&projected).contains("not a longitude and latitude in degrees"),
        "{}",
        refusal(&projected)
    );
    projected["crs"] = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::31467" } });
    assert!(refusal(&projected).contains("EPSG::31467 are not supported"));
    let wanted = Frame { is_meters: true, ..Frame::default() };
    let read = declarations("a.geojson", &projected.to_string(), &wanted).expect("they are meters");
    assert!(read.contains("location A (500000, 4000000)"), "{read}");
    let far = collection(&[point("A", [0.0, 0.0]), point("B", [90.0, 0.0])]);
    assert!(refusal(&far).contains("B: 10008 km from the origin"), "{}", refusal(&far));
    assert!(refusal(&collection(&[])).contains("needs a Point, Polygon"));
    let mut flat = point("Dot", [0.0, 0.0]);
    flat["properties"]["radius_m"] = json!(0.0001);
    assert!(refusal(&meters(&[flat])).contains("must be greater than 0"));
    assert!(refusal(&json!({ "type": "Topology" })).contains("not GeoJSON"));
    assert!(
        refusal(&meters(&[polygon(&json!([[[0, 0], [1, 1], [0, 0]]]))])).contains("at least three corners")
    );
    assert!(refusal(&meters(&[polygon(&json!([[[0, 0], [1, null], [2, 2]]]))])).contains("pair of numbers"));
}

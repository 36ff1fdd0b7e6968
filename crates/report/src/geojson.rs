//! The places, obstacles and paths of a mission as `GeoJSON` (RFC 7946).

use interchange::geojson::{FRAME, Projection};
use nalgebra::Point2;
use rmpl::program::{ObstacleKind, ObstacleShape};
use serde_json::{Value, json};
use snapshot::Snapshot;

/// The corners of a circle, which `GeoJSON` does not have.
const CIRCLE_CORNERS: u32 = 64;

/// A feature for each location (`Point`), each obstacle (`Polygon`; a circle has 64 corners) and each traverse of the plan
/// (`MultiLineString`, a line for each leg). Longitudes are within 180 degrees of Greenwich.
pub fn geojson(snapshot: &Snapshot, projection: &Projection) -> Value {
    let world = &snapshot.program.world;
    let position = |point: Point2<f64>| {
        let [east, north] = projection.from_meters(point);
        match projection {
            Projection::Meters => json!([east, north]),
            // A nanodegree is a tenth of a millimeter.
            Projection::Degrees { .. } => {
                json!([nano((east + 180.0).rem_euclid(360.0) - 180.0), nano(north)])
            }
        }
    };
    let feature = |properties: Value, kind: &str, coordinates: Value| {
        let geometry = json!({ "type": kind, "coordinates": coordinates });
        json!({ "type": "Feature", "properties": properties, "geometry": geometry })
    };
    let mut features = Vec::new();
    for place in &world.locations {
        let properties = json!({ "kind": "location", "name": place.name.text });
        features.push(feature(properties, "Point", position(place.position_m.into())));
    }
    for obstacle in &world.obstacles {
        let ring: Vec<Value> = ring(&obstacle.shape).into_iter().map(position).collect();
        let properties = match &obstacle.kind {
            ObstacleKind::Solid => json!({ "kind": "obstacle", "name": obstacle.name.text }),
            ObstacleKind::KeepOut { closed_to } => json!({
                "kind": "keepout",
                "name": obstacle.name.text,
                "closed_to": closed_to.iter().map(|it| it.text.as_str()).collect::<Vec<_>>(),
            }),
        };
        features.push(feature(properties, "Polygon", json!([ring])));
    }
    for traverse in snapshot.traverses.iter() {
        let legs = traverse.legs.iter().map(|leg| leg.points_m.iter().copied().map(position).collect());
        let legs: Vec<Value> = legs.map(Value::Array).collect();
        let activity =
            snapshot.network.as_deref().and_then(|it| it.occurrences.get(traverse.occurrence.index()));
        let vehicles = traverse.vehicles.iter().filter_map(|&index| world.vehicles.get(index as usize));
        let properties = json!({
            "kind": "path",
            "name": activity.map(|it| it.name.as_str()),
            "vehicles": vehicles.map(|it| it.name.text.as_str()).collect::<Vec<_>>(),
            "length_m": traverse.length_m,
        });
        features.push(feature(properties, "MultiLineString", legs.into()));
    }
    json!({ "type": "FeatureCollection", FRAME: projection.to_json(), "features": features })
}

/// The corners against the clock, the first one again at the end, as RFC 7946 has them.
fn ring(shape: &ObstacleShape) -> Vec<Point2<f64>> {
    let mut corners: Vec<Point2<f64>> = match shape {
        ObstacleShape::Circle { center_m, radius_m } => (0..CIRCLE_CORNERS)
            .map(|corner| {
                let angle = std::f64::consts::TAU * f64::from(corner) / f64::from(CIRCLE_CORNERS);
                Point2::new(
                    center_m[0] + radius_m * libm::cos(angle),
                    center_m[1] + radius_m * libm::sin(angle),
                )
            })
            .collect(),
        ObstacleShape::Polygon { corners_m } => corners_m.iter().copied().map(Point2::from).collect(),
    };
    let turn: f64 =
        corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| a.coords.perp(&b.coords)).sum();
    if turn < 0.0 {
        corners.reverse();
    }
    corners.extend(corners.first().copied());
    corners
}

fn nano(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

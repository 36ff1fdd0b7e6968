//! Between degrees on a body and meters on a mission's plane.

use std::fmt;

use nalgebra::Point2;
use serde_json::Value;

use super::{FRAME, GeoJsonError};

/// The mean radius of the Earth (WGS 84), on which degrees of `GeoJSON` are unless a file says otherwise.
pub const EARTH_RADIUS_M: f64 = 6_371_008.8;

/// Positions farther from the origin than this are refused: distances across them would be wrong by more than 0.2 %.
const MAX_ANGLE_RAD: f64 = 0.1;

/// Radii of bodies, in meters: from a boulder to a star.
pub const BODY_RADII_M: std::ops::RangeInclusive<f64> = 1.0..=1e9;

/// What is known of the coordinates of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Whether they are meters east and north already.
    pub is_meters: bool,
    /// The longitude and latitude in degrees at which the mission's origin is; the south-west corner of what the file has
    /// otherwise.
    pub origin_deg: Option<[f64; 2]>,
    /// The radius of the body; the Earth's otherwise.
    pub radius_m: Option<f64>,
}

impl Frame {
    /// Returns what a file says of itself, but for what `wanted` says: then its reference system does not matter.
    pub fn of_file(document: &Value, wanted: &Self) -> Result<Self, GeoJsonError> {
        let said = |problem: &str| GeoJsonError::Shape(format!("`{FRAME}` {problem}"));
        let Some(frame) = document.get(FRAME) else {
            if *wanted != Self::default() {
                return Ok(*wanted);
            }
            let is_meters = System::of(document)? == System::Meters;
            return Ok(Self { is_meters, ..Self::default() });
        };
        match frame.get("units").and_then(Value::as_str) {
            Some("metres") => return Ok(Self { is_meters: true, ..Self::default() }),
            None | Some("degrees") => {}
            Some(_) => return Err(said("needs `units` \"metres\" or \"degrees\"")),
        }
        let origin_deg = match frame.get("origin") {
            None => None,
            Some(origin) => {
                let number = |axis: usize| origin.get(axis).and_then(Value::as_f64);
                let both = number(0).zip(number(1)).map(|(lon, lat)| [lon, lat]);
                Some(both.ok_or_else(|| said("needs an `origin` with a longitude and a latitude"))?)
            }
        };
        let radius_m = match frame.get("radius_m") {
            None => None,
            Some(radius) => {
                let radius = radius.as_f64().filter(|radius| BODY_RADII_M.contains(radius));
                Some(radius.ok_or_else(|| said("needs a `radius_m` from 1 to 1,000,000,000"))?)
            }
        };
        Ok(Self { is_meters: false, origin_deg, radius_m })
    }

    /// The same, but with what `wanted` says where it says something.
    pub fn overridden(self, wanted: &Self) -> Self {
        let is_degrees = wanted.origin_deg.is_some() || wanted.radius_m.is_some();
        Self {
            is_meters: wanted.is_meters || (self.is_meters && !is_degrees),
            origin_deg: wanted.origin_deg.or(self.origin_deg),
            radius_m: wanted.radius_m.or(self.radius_m),
        }
    }

    /// The way to meters, for these positions.
    pub fn projection(self, positions: impl Iterator<Item = [f64; 2]>) -> Result<Projection, GeoJsonError> {
        if self.is_meters {
            return Ok(Projection::Meters);
        }
        let corner =
            || positions.reduce(|low, it| [low[0].min(it[0]), low[1].min(it[1])]).unwrap_or_default();
        let origin_deg = self.origin_deg.unwrap_or_else(corner);
        check_degrees(origin_deg)
            .map_err(|problem| GeoJsonError::Position { place: "the origin".to_owned(), problem })?;
        Ok(Projection::Degrees { origin_deg, radius_m: self.radius_m.unwrap_or(EARTH_RADIUS_M) })
    }
}

/// What coordinates are in, by the `crs` that `GeoJSON` had before RFC 7946.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum System {
    Degrees,
    Meters,
}

impl System {
    /// That of a whole file: of its own `crs`, or of those of its features, which have to agree.
    fn of(document: &Value) -> Result<Self, GeoJsonError> {
        let own = Self::named(document)?;
        let mut of_all = None;
        for feature in document.get("features").and_then(Value::as_array).into_iter().flatten() {
            let geometry = feature.get("geometry").unwrap_or(&Value::Null);
            let of_feature =
                Self::named(geometry)?.or(Self::named(feature)?).or(own).unwrap_or(Self::Degrees);
            if of_all.is_some_and(|of_all| of_all != of_feature) {
                let problem = "degrees for some features and meters for others";
                return Err(GeoJsonError::ReferenceSystem(problem.to_owned()));
            }
            of_all = Some(of_feature);
        }
        let of_geometry = document.get("geometry").map(Self::named).transpose()?.flatten();
        Ok(of_all.or(of_geometry).or(own).unwrap_or(Self::Degrees))
    }

    /// Returns what a `crs` says. Meters are those of UTM, and of the Web Mercator, in which plans of buildings and
    /// yards are drawn around (0, 0), where it is true.
    fn named(holder: &Value) -> Result<Option<Self>, GeoJsonError> {
        let Some(system) = holder.get("crs").filter(|system| !system.is_null()) else { return Ok(None) };
        let name = system.get("properties").and_then(|it| it.get("name")).and_then(Value::as_str);
        let name = name.unwrap_or("a reference system without a name");
        let code = name.rsplit([':', '/']).next().unwrap_or_default();
        match code.parse::<u32>() {
            _ if code == "CRS84" => Ok(Some(Self::Degrees)),
            Ok(4326 | 4258 | 4269 | 4979) => Ok(Some(Self::Degrees)),
            Ok(WEB_MERCATOR | 32_601..=32_660 | 32_701..=32_760 | 25_828..=25_838) => Ok(Some(Self::Meters)),
            _ => Err(GeoJsonError::ReferenceSystem(super::one_line(name))),
        }
    }
}

/// The EPSG code of the Web Mercator.
const WEB_MERCATOR: u32 = 3857;

/// How far from (0, 0) lengths in the Web Mercator are wrong by less than 0.2 %.
const TRUE_MERCATOR_METERS: f64 = 400_000.0;

/// Refuses positions in the Web Mercator where its meters are longer than those on the ground.
pub(super) fn check_mercator(
    document: &Value,
    mut positions: impl Iterator<Item = [f64; 2]>,
) -> Result<(), GeoJsonError> {
    let mut is_true = || positions.all(|[_, north]| north.abs() < TRUE_MERCATOR_METERS);
    if names_mercator(document) && !is_true() {
        let problem = "EPSG:3857 far from the equator, where its meters are too short";
        return Err(GeoJsonError::ReferenceSystem(problem.to_owned()));
    }
    Ok(())
}

fn names_mercator(document: &Value) -> bool {
    let features = document.get("features").and_then(Value::as_array).into_iter().flatten();
    let holders = features.flat_map(|feature| [Some(feature), feature.get("geometry")]);
    let mut holders = holders.chain([Some(document), document.get("geometry")]).flatten();
    holders.any(|holder| {
        let name = holder.pointer("/crs/properties/name").and_then(Value::as_str).unwrap_or_default();
        name.ends_with("3857")
    })
}

/// From a file's coordinates to meters east and north, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// They are meters.
    Meters,
    /// Longitude and latitude in degrees on a sphere, by the azimuthal equidistant projection (Snyder 1987, chapter 25):
    /// distances and directions from the origin are exact.
    Degrees {
        /// Where the origin of the mission is.
        origin_deg: [f64; 2],
        /// The radius of the sphere.
        radius_m: f64,
    },
}

impl Projection {
    /// Meters east and north of the origin; in words why there are none.
    pub fn to_meters(&self, position: [f64; 2]) -> Result<Point2<f64>, String> {
        let &Self::Degrees { origin_deg, radius_m } = self else {
            let is_near = position.iter().all(|meters| meters.abs() < MAX_METERS);
            return if is_near { Ok(position.into()) } else { Err("too far away".to_owned()) };
        };
        check_degrees(position)?;
        let [lon, lat] = position.map(f64::to_radians);
        let [lon_0, lat_0] = origin_deg.map(f64::to_radians);
        let (east, north) = (libm::sin(lon - lon_0), libm::cos(lon - lon_0));
        let x = libm::cos(lat) * east;
        let y = libm::cos(lat_0) * libm::sin(lat) - libm::sin(lat_0) * libm::cos(lat) * north;
        let z = libm::sin(lat_0) * libm::sin(lat) + libm::cos(lat_0) * libm::cos(lat) * north;
        let sine = libm::hypot(x, y);
        let angle = libm::atan2(sine, z);
        if angle > MAX_ANGLE_RAD {
            let far_km = angle * radius_m / 1000.0;
            return Err(format!("{far_km:.0} km from the origin, which is too far for a flat map"));
        }
        let scale = if sine > 0.0 { radius_m * angle / sine } else { radius_m };
        Ok(Point2::new(scale * x, scale * y))
    }

    /// The position of a point in the coordinates of a file.
    pub fn from_meters(&self, point_m: Point2<f64>) -> [f64; 2] {
        let &Self::Degrees { origin_deg, radius_m } = self else { return point_m.into() };
        let [lon_0, lat_0] = origin_deg.map(f64::to_radians);
        let distance = libm::hypot(point_m.x, point_m.y);
        if distance == 0.0 {
            return origin_deg;
        }
        let angle = distance / radius_m;
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let (east, north) = (point_m.x / distance, point_m.y / distance);
        let lat = libm::asin((cosine * libm::sin(lat_0) + north * sine * libm::cos(lat_0)).clamp(-1.0, 1.0));
        let lon =
            lon_0 + libm::atan2(east * sine, libm::cos(lat_0) * cosine - libm::sin(lat_0) * sine * north);
        [lon.to_degrees(), lat.to_degrees()]
    }

    /// Returns what [`FRAME`] says of it.
    pub fn to_json(&self) -> Value {
        match self {
            Self::Meters => serde_json::json!({ "units": "metres" }),
            Self::Degrees { origin_deg, radius_m } => {
                serde_json::json!({ "units": "degrees", "origin": origin_deg, "radius_m": radius_m })
            }
        }
    }
}

const MAX_METERS: f64 = 1e8;

fn check_degrees([lon, lat]: [f64; 2]) -> Result<(), String> {
    if lon.abs() <= 360.0 && lat.abs() <= 90.0 {
        Ok(())
    } else {
        Err(format!(
            "({lon}, {lat}) is not a longitude and latitude in degrees; if the file is in meters, add \"{FRAME}\": \
             {{\"units\": \"metres\"}}"
        ))
    }
}

impl fmt::Display for Projection {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Meters => out.write_str("meters as in the file"),
            Self::Degrees { origin_deg: [lon, lat], radius_m } => write!(
                out,
                "meters east and north of longitude {lon}, latitude {lat}, on a sphere with a radius of {radius_m} m"
            ),
        }
    }
}

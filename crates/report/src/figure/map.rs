//! The map of a mission from above, with the paths of the plan on its ground.

use display::Theme;
use layout::list::map::{MapFrame, MapPath, Relief, extent_m, map_list, path_stroke};
use nalgebra::{Point2, Vector3};
use snapshot::Snapshot;
use terrain::Terrain;

use super::sheet::{Figure, Medium};

/// The longer side of the drawing, in user units.
const SIDE: f64 = 640.0;

/// The map of a mission; `None` if it has no places.
pub(crate) fn map(snapshot: &Snapshot, ground: Option<&Terrain>) -> Option<Figure> {
    let world = &snapshot.program.world;
    let extent = extent_m(world, std::iter::empty()).filter(|_| !world.locations.is_empty())?;
    let [low_m, high_m] = ground.map_or(extent, |ground| {
        let frame = ground.frame();
        [frame.origin_m, frame.far_corner_m()]
    });
    let frame = MapFrame::with_side(low_m, high_m, SIDE);
    let name_of = |traverse: &snapshot::Traverse| {
        let network = snapshot.network.as_deref()?;
        Some(network.readable(&network.occurrences.get(traverse.occurrence.index())?.name))
    };
    let names: Vec<String> = snapshot.traverses.iter().map(|it| name_of(it).unwrap_or_default()).collect();
    let paths = snapshot.traverses.iter().zip(&names).enumerate().map(|(number, (traverse, name))| MapPath {
        name,
        points_m: traverse.legs.iter().flat_map(|leg| leg.points_m.iter().copied()).collect(),
        stroke: path_stroke(number),
    });
    let paths: Vec<MapPath<'_>> = paths.collect();
    let shade_at;
    let relief: Option<Relief<'_>> = match ground {
        Some(ground) => {
            shade_at = |point_m: Point2<f64>| shade(ground, point_m);
            Some(&shade_at)
        }
        None => None,
    };
    let list = map_list(world, &paths, &frame, relief);
    Some(Figure {
        drawing: display::svg(&[&list], Theme::Light, "Map with the paths of the plan"),
        caption: "North is up. Lines are the paths of the plan; shaded areas are obstacles.".to_owned(),
        medium: Medium::Everywhere,
    })
}

/// The brightness of the ground at a point, in steps.
fn shade(ground: &Terrain, point_m: Point2<f64>) -> u8 {
    let Some(normal) = ground.normal_at(point_m) else { return 0xD0 };
    // Light from the north-west, 45° high.
    let to_light = Vector3::new(-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2);
    let light = to_light.dot(&normal).clamp(0.0, 1.0);
    let steps = (light * 32.0).round() / 32.0;
    (150.0 + 125.0 * steps).min(246.0) as u8
}

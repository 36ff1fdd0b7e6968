//! The map of a mission from above: ground, obstacles, places and the paths of the plan. North is up.

use mission::Snapshot;
use rmpl::program::{ObstacleShape, World};
use terrain::Terrain;

use super::{number, round_step};
use crate::escape::escaped;

/// The longer side of the drawing, in user units.
const SIDE: f64 = 640.0;
/// Squares of shaded ground along the longer side.
const SHADES: f64 = 96.0;
/// Colours of the paths, told apart without colour by their dashes.
const PATHS: [(&str, &str); 4] =
    [("#0072b2", ""), ("#b84300", "9 4"), ("#9c3f77", "3 3"), ("#9a6200", "12 3 3 3")];

/// Metres to user units; north is up.
struct View {
    low_m: [f64; 2],
    high_m: [f64; 2],
    scale: f64,
}

impl View {
    fn new(low_m: [f64; 2], high_m: [f64; 2]) -> Self {
        let longest_m = (high_m[0] - low_m[0]).max(high_m[1] - low_m[1]).max(1e-6);
        Self { low_m, high_m, scale: SIDE / longest_m }
    }

    fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.high_m[axis] - self.low_m[axis]) * self.scale)
    }

    fn point(&self, point_m: [f64; 2]) -> [f64; 2] {
        [(point_m[0] - self.low_m[0]) * self.scale, (self.high_m[1] - point_m[1]) * self.scale]
    }

    /// Points as `x,y x,y`.
    fn points(&self, points_m: &[[f64; 2]]) -> String {
        let text = |&point_m: &[f64; 2]| {
            let [x, y] = self.point(point_m);
            format!("{},{}", number(x), number(y))
        };
        points_m.iter().map(text).collect::<Vec<_>>().join(" ")
    }
}

/// The map of a mission; `None` if it has no places.
pub(crate) fn map(snapshot: &Snapshot, ground: Option<&Terrain>) -> Option<String> {
    let world = &snapshot.program.world;
    let view = view(world, ground)?;
    let [width, height] = view.size().map(number);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"Ubuntu, Inter, Arial, sans-serif\" \
         font-size=\"11\">\n<title>Map with the paths of the plan</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#f3f5f8\"/>\n"
    );
    if let Some(ground) = ground {
        write_ground(ground, &view, &mut out);
    }
    write_obstacles(world, &view, &mut out);
    write_paths(snapshot, &view, &mut out);
    write_places(world, &view, &mut out);
    write_scale(&view, &mut out);
    out.push_str("</svg>\n");
    Some(out)
}

fn view(world: &World, ground: Option<&Terrain>) -> Option<View> {
    if world.locations.is_empty() {
        return None;
    }
    if let Some(ground) = ground {
        let frame = ground.frame();
        return Some(View::new(frame.origin_m, frame.far_corner_m()));
    }
    let mut corners: Vec<[f64; 2]> = world.locations.iter().map(|location| location.position_m).collect();
    for obstacle in &world.obstacles {
        match &obstacle.shape {
            ObstacleShape::Circle { center_m, radius_m } => {
                corners.push(center_m.map(|middle| middle - radius_m));
                corners.push(center_m.map(|middle| middle + radius_m));
            }
            ObstacleShape::Polygon { corners_m } => corners.extend(corners_m),
        }
    }
    let least = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = ([least(0), least(1)], [most(0), most(1)]);
    let margin = 0.06 * (high[0] - low[0]).max(high[1] - low[1]).max(10.0);
    Some(View::new(low.map(|value| value - margin), high.map(|value| value + margin)))
}

/// Ground in squares, lit from the north-west. Squares of one shade that touch in a row are one rectangle.
fn write_ground(ground: &Terrain, view: &View, out: &mut String) {
    let [width_m, height_m] = [0, 1].map(|axis| view.high_m[axis] - view.low_m[axis]);
    let square_m = width_m.max(height_m) / SHADES;
    let (columns, rows) = ((width_m / square_m).round() as u32, (height_m / square_m).round() as u32);
    for row in 0..rows {
        let north_m = view.high_m[1] - (f64::from(row) + 0.5) * square_m;
        let shade_at =
            |column: u32| shade(ground, [view.low_m[0] + (f64::from(column) + 0.5) * square_m, north_m]);
        let mut column = 0;
        while column < columns {
            let shade = shade_at(column);
            let mut end = column + 1;
            while end < columns && shade_at(end) == shade {
                end += 1;
            }
            let side = square_m * view.scale;
            let color = format!("#{shade:02x}{shade:02x}{:02x}", shade.saturating_sub(6));
            // A little overlap hides the seams between squares.
            out.push_str(&format!(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{color}\"/>\n",
                number(f64::from(column) * side),
                number(f64::from(row) * side),
                number(f64::from(end - column) * side + 0.4),
                number(side + 0.4),
            ));
            column = end;
        }
    }
}

/// The brightness of the ground at a point, in steps.
fn shade(ground: &Terrain, point_m: [f64; 2]) -> u8 {
    let Some([east, north, up]) = ground.normal_at(point_m) else { return 0xD0 };
    // Light from the north-west, 45° high.
    let light = (-0.5 * east + 0.5 * north + std::f64::consts::FRAC_1_SQRT_2 * up).clamp(0.0, 1.0);
    let steps = (light * 32.0).round() / 32.0;
    (150.0 + 125.0 * steps).min(246.0) as u8
}

fn write_obstacles(world: &World, view: &View, out: &mut String) {
    const LOOK: &str = "fill=\"#b84300\" fill-opacity=\".22\" stroke=\"#b84300\"";
    for obstacle in &world.obstacles {
        let name = escaped(&obstacle.name.text);
        match &obstacle.shape {
            ObstacleShape::Circle { center_m, radius_m } => {
                let [x, y] = view.point(*center_m).map(number);
                let radius = number(radius_m * view.scale);
                out.push_str(&format!(
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {LOOK}><title>{name}</title></circle>\n"
                ));
            }
            ObstacleShape::Polygon { corners_m } => {
                let points = view.points(corners_m);
                out.push_str(&format!(
                    "<polygon points=\"{points}\" {LOOK}><title>{name}</title></polygon>\n"
                ));
            }
        }
    }
}

fn write_paths(snapshot: &Snapshot, view: &View, out: &mut String) {
    for (index, traverse) in snapshot.traverses.iter().enumerate() {
        let (color, dash) = PATHS[index % PATHS.len()];
        let dash = if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") };
        let name = snapshot
            .network
            .as_ref()
            .and_then(|network| network.occurrences.get(traverse.occurrence.index()))
            .map_or("", |occurrence| occurrence.name.as_str());
        let points_m: Vec<[f64; 2]> =
            traverse.legs.iter().flat_map(|leg| leg.points_m.iter().copied()).collect();
        out.push_str(&format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2.5\" \
             stroke-linejoin=\"round\"{dash}><title>{}</title></polyline>\n",
            view.points(&points_m),
            escaped(name)
        ));
    }
}

fn write_places(world: &World, view: &View, out: &mut String) {
    for location in &world.locations {
        let [x, y] = view.point(location.position_m);
        // Names stay inside the drawing.
        let (text_x, anchor) = if x > view.size()[0] * 0.8 { (x - 7.0, "end") } else { (x + 7.0, "start") };
        out.push_str(&format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"4\" fill=\"#fff\" stroke=\"#161d26\" stroke-width=\"1.5\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\" fill=\"#161d26\" stroke=\"#fff\" stroke-width=\"3\" \
             paint-order=\"stroke\">{}</text>\n",
            number(x),
            number(y),
            number(text_x),
            number(y - 6.0),
            escaped(&location.name.text)
        ));
    }
}

fn write_scale(view: &View, out: &mut String) {
    let length_m = round_step(view.high_m[0] - view.low_m[0], 6.0);
    let (length, y) = (length_m * view.scale, view.size()[1] - 14.0);
    out.push_str(&format!(
        "<path d=\"M14 {0}h{1}\" stroke=\"#161d26\" stroke-width=\"2\"/>\
         <text x=\"14\" y=\"{2}\" fill=\"#161d26\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">{3} m</text>\n",
        number(y),
        number(length),
        number(y - 5.0),
        number(length_m)
    ));
}

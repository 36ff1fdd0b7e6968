//! Seeded recipes of Mars-like terrain, and the named maps that example missions use.

use nalgebra::Point2;
use serde::Serialize;

use crate::crater::crater_population;
use crate::frame::GridFrame;
use crate::heightfield::Terrain;
use crate::noise::{fractal_noise, gradient_noise, ridged_noise, smooth_step};
use crate::random::Random;
use crate::rock::scatter_rocks;

/// How a map is made. The same recipe gives the same bits everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Recipe {
    /// The name by which a mission's `terrain` declaration asks for it.
    pub name: &'static str,
    /// A line for a list of maps.
    pub title: &'static str,
    /// The grid, with its south-west corner at the origin.
    pub frame: GridFrame,
    /// Everything random comes from this.
    pub seed: u64,
    pub relief: Relief,
    /// Impact craters.
    pub craters: Craters,
    pub dunes: Option<Dunes>,
    /// A river delta.
    pub fan: Option<Fan>,
    /// The share of the ground that rocks cover (Golombek and Rapp's k).
    pub rock_abundance: f64,
}

/// Fractal hills.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Relief {
    /// Height of the widest octave in meters.
    pub height_m: f64,
    /// Wavelength of the widest octave in meters.
    pub wavelength_m: f64,
    /// Number of octaves, each of half the wavelength.
    pub octaves: u32,
    /// Height of an octave over the height of the one before.
    pub gain: f64,
    /// Whether the hills have crests.
    pub ridged: bool,
}

/// A population of craters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Craters {
    pub count: u32,
    /// The least and the greatest diameter in meters.
    pub diameters_m: [f64; 2],
    /// The least and the greatest freshness: 1 is 0.2 diameters deep, 0 has vanished.
    pub freshness: [f64; 2],
}

/// Transverse dunes in patches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Dunes {
    /// Height of the crests in meters.
    pub height_m: f64,
    /// From crest to crest in meters.
    pub wavelength_m: f64,
    /// Where the wind blows to, in radians counter-clockwise from east.
    pub wind_rad: f64,
    /// The share of the map under sand, roughly, from 0 to 1.
    pub cover: f64,
}

/// A delta: a fan with a scarp at its front, cut by channels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fan {
    /// Where the river enters, as shares of the map's extent.
    pub apex: Point2<f64>,
    /// Length from the apex to the scarp in meters.
    pub length_m: f64,
    /// Height of the scarp in meters.
    pub height_m: f64,
    /// Depth of the channels in meters.
    pub channel_depth_m: f64,
}

const NO_CRATERS: Craters = Craters { count: 0, diameters_m: [1.0, 1.0], freshness: [0.0, 0.0] };

/// The maps that ship with Enroute.
pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "flat",
        title: "Flat ground without obstacles, 307 m × 307 m",
        frame: GridFrame::new(512, 512, 0.6),
        seed: 0,
        relief: Relief { height_m: 0.0, wavelength_m: 100.0, octaves: 0, gain: 0.5, ridged: false },
        craters: NO_CRATERS,
        dunes: None,
        fan: None,
        rock_abundance: 0.0,
    },
    Recipe {
        name: "tai-plain",
        title: "A cratered plain with scattered rocks, 307 m × 307 m",
        frame: GridFrame::new(512, 512, 0.6),
        seed: 2001,
        relief: Relief { height_m: 2.5, wavelength_m: 110.0, octaves: 7, gain: 0.4, ridged: false },
        craters: Craters { count: 90, diameters_m: [6.0, 60.0], freshness: [0.25, 1.0] },
        dunes: None,
        fan: None,
        rock_abundance: 0.05,
    },
    Recipe {
        name: "jezero-delta",
        title: "A delta with a scarp and channels at the foot of hills, 614 m × 614 m",
        frame: GridFrame::new(1024, 1024, 0.6),
        seed: 2020,
        relief: Relief { height_m: 5.0, wavelength_m: 240.0, octaves: 8, gain: 0.4, ridged: false },
        craters: Craters { count: 130, diameters_m: [6.0, 90.0], freshness: [0.15, 0.9] },
        dunes: Some(Dunes { height_m: 0.5, wavelength_m: 9.0, wind_rad: 0.6, cover: 0.2 }),
        fan: Some(Fan {
            apex: Point2::new(0.02, 0.62),
            length_m: 330.0,
            height_m: 14.0,
            channel_depth_m: 3.0,
        }),
        rock_abundance: 0.06,
    },
    Recipe {
        name: "gale-dunes",
        title: "Dune fields between low ridges, 307 m × 307 m",
        frame: GridFrame::new(512, 512, 0.6),
        seed: 2012,
        relief: Relief { height_m: 3.0, wavelength_m: 150.0, octaves: 7, gain: 0.42, ridged: true },
        craters: Craters { count: 14, diameters_m: [6.0, 30.0], freshness: [0.3, 0.9] },
        dunes: Some(Dunes { height_m: 1.6, wavelength_m: 16.0, wind_rad: 0.25, cover: 0.55 }),
        fan: None,
        rock_abundance: 0.03,
    },
    Recipe {
        name: "noachian-highland",
        title: "Old highland with many craters and rocks, 614 m × 614 m",
        frame: GridFrame::new(1024, 1024, 0.6),
        seed: 1976,
        relief: Relief { height_m: 6.0, wavelength_m: 200.0, octaves: 8, gain: 0.42, ridged: false },
        craters: Craters { count: 420, diameters_m: [6.0, 140.0], freshness: [0.1, 0.9] },
        dunes: None,
        fan: None,
        rock_abundance: 0.09,
    },
];

/// The names of the maps that ship with Enroute.
pub fn asset_names() -> impl Iterator<Item = &'static str> {
    RECIPES.iter().map(|recipe| recipe.name)
}

/// The map of this name (SPEC 1.8 `terrain`), or `None` when none has it. Making it takes up to a second: keep it.
pub fn asset(name: &str) -> Option<Terrain> {
    RECIPES.iter().find(|recipe| recipe.name == name).map(generate)
}

/// Rocks smaller than this are left out altogether: a rover drives over them.
const MIN_ROCK_M: f64 = 0.4;

/// Makes a map. Time is proportional to its cells and its number of octaves.
pub fn generate(recipe: &Recipe) -> Terrain {
    let frame = recipe.frame;
    let mut heights_m: Vec<f32> = (0..frame.cell_count())
        .map(|index| surface_height(recipe, frame.center_m(frame.cell(index))) as f32)
        .collect();
    let mut random = Random::from_seed(recipe.seed ^ 0x006d_6172_7300);
    let craters = recipe.craters;
    for crater in
        crater_population(&frame, craters.count, craters.diameters_m, craters.freshness, &mut random)
    {
        crater.press(&frame, &mut heights_m);
    }
    if let Some(dunes) = &recipe.dunes {
        for (index, height) in heights_m.iter_mut().enumerate() {
            *height += dune_height(dunes, recipe.seed as u32, frame.center_m(frame.cell(index))) as f32;
        }
    }
    let rocks = scatter_rocks(&frame, recipe.rock_abundance, MIN_ROCK_M, &mut random);
    Terrain::new(frame, heights_m).with_rocks(rocks)
}

/// Hills and delta at a point, in meters.
fn surface_height(recipe: &Recipe, point_m: Point2<f64>) -> f64 {
    let relief = recipe.relief;
    let seed = recipe.seed as u32;
    let wave = point_m / relief.wavelength_m;
    let noise = if relief.ridged { ridged_noise } else { fractal_noise };
    let hills = relief.height_m * noise(seed, wave.x, wave.y, relief.octaves, relief.gain);
    hills + recipe.fan.map_or(0.0, |fan| fan_height(&fan, &recipe.frame, seed, point_m))
}

/// Returns how far a delta raises a point, in meters.
fn fan_height(fan: &Fan, frame: &GridFrame, seed: u32, point_m: Point2<f64>) -> f64 {
    let (x, y) = (point_m.x, point_m.y);
    let offset = point_m.coords - fan.apex.coords.component_mul(&frame.extent_m());
    let distance = offset.norm();
    let bearing = libm::atan2(offset.y, offset.x);
    // The front is lobed: its distance from the apex varies with the bearing and a little from place to place.
    let lobes = 0.16 * gradient_noise(seed ^ 0xfa, bearing * 2.6, 0.5)
        + 0.05 * fractal_noise(seed ^ 0xfb, x / 40.0, y / 40.0, 3, 0.5);
    let front = fan.length_m * (1.0 + lobes) * (1.0 - 0.25 * bearing * bearing);
    // The scarp drops over a quarter to a half of the way that its height would need at 45 degrees.
    let scarp_width = fan.height_m * (2.6 + 2.2 * gradient_noise(seed ^ 0xfc, bearing * 4.0, 1.5));
    let plateau = 1.0 - smooth_step(front - scarp_width, front, distance);
    // Channels run down the fan: lines of constant meandering bearing.
    let meander = bearing * 5.0 + 0.5 * gradient_noise(seed ^ 0xfd, x / 70.0, y / 70.0);
    let channel = 1.0 - smooth_step(0.0, 0.28, gradient_noise(seed ^ 0xfe, meander, 2.5).abs());
    let fade_in = smooth_step(20.0, 90.0, distance);
    plateau * (fan.height_m * (1.0 - 0.3 * distance / fan.length_m) - fan.channel_depth_m * channel * fade_in)
}

/// Returns how far sand raises a point, in meters: crests across the wind, steeper in their lee.
fn dune_height(dunes: &Dunes, seed: u32, point_m: Point2<f64>) -> f64 {
    let (x, y) = (point_m.x, point_m.y);
    let patch = fractal_noise(seed ^ 0xd0, x / 90.0, y / 90.0, 3, 0.5);
    let cover = smooth_step(0.0, 0.35, patch + dunes.cover - 0.5);
    if cover == 0.0 {
        return 0.0;
    }
    let (along, across) = (libm::cos(dunes.wind_rad), libm::sin(dunes.wind_rad));
    let downwind = x * along + y * across;
    let warp = 1.4 * gradient_noise(seed ^ 0xd1, x / 45.0, y / 45.0);
    let phase = downwind / dunes.wavelength_m + warp;
    let share = phase - phase.floor();
    // Two thirds of a wave rise gently, the last third falls.
    let profile =
        if share < 0.66 { smooth_step(0.0, 0.66, share) } else { 1.0 - smooth_step(0.66, 1.0, share) };
    cover * dunes.height_m * profile * (0.75 + 0.25 * gradient_noise(seed ^ 0xd2, x / 20.0, y / 20.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occupancy::{CellState, Occupancy, Traversability};

    /// FNV-1a over the bits of the heights.
    fn fingerprint(terrain: &Terrain) -> u64 {
        terrain
            .heights_m()
            .iter()
            .flat_map(|height| height.to_bits().to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
            })
    }

    #[test]
    fn every_asset_can_be_made_and_mostly_driven_on() {
        let rover = Traversability::Ground { max_grade: 0.364, rock_diameter_m: 0.5 };
        for recipe in RECIPES {
            let terrain = asset(recipe.name).unwrap();
            let grid = Occupancy::of_terrain(&terrain, &[], &rover);
            let free = grid.states().iter().filter(|&&state| state == CellState::Free).count();
            let share = free as f64 / grid.states().len() as f64;
            let range = terrain.height_range_m().unwrap();
            assert!(share > 0.8, "{}: {share} free, heights {range:?}", recipe.name);
            if recipe.name != "flat" {
                assert!(share < 0.999, "{}: nothing to avoid, heights {range:?}", recipe.name);
            }
        }
    }

    #[test]
    fn a_recipe_gives_the_same_map_each_time_and_another_with_another_seed() {
        let recipe = RECIPES.iter().find(|recipe| recipe.name == "gale-dunes").unwrap();
        let first = generate(recipe);
        assert_eq!(fingerprint(&first), fingerprint(&generate(recipe)));
        assert_ne!(fingerprint(&first), fingerprint(&generate(&Recipe { seed: 1, ..*recipe })));
    }

    #[test]
    fn the_maps_that_missions_are_written_on_do_not_change() {
        // Computed natively and in wasm32, with the same result. A change here moves what missions and reports show.
        let expected = [
            ("flat", 0xa967_7706_9d62_2325),
            ("tai-plain", 0xeed1_5453_c1a5_2381),
            ("gale-dunes", 0x81f0_f90f_f56d_f6cf),
        ];
        for (name, fingerprint_of_map) in expected {
            assert_eq!(fingerprint(&asset(name).unwrap()), fingerprint_of_map, "{name}");
        }
    }

    #[test]
    fn an_unknown_name_has_no_map() {
        assert_eq!(asset("atlantis"), None);
    }
}

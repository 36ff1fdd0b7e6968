//! Which cells of a map a kind of vehicle can't be over, and for which reason.

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

use crate::frame::{Cell, GridFrame};
use crate::heightfield::Terrain;
use crate::obstacle::Obstacle;

/// What a vehicle asks of the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Traversability {
    /// It drives: obstacles, rocks, steep cells and cells without data are in its way.
    Ground {
        /// Meters up for each meter forward that it climbs at most.
        max_grade: f64,
        /// The least diameter in meters of a rock that it can't pass over.
        rock_diameter_m: f64,
    },
    /// It flies over obstacles: only ground that reaches above its lowest altitude is in its way, and cells without
    /// data, where the ground could be anywhere.
    Air {
        /// The greatest height of ground, in meters above the map's datum, that it flies over.
        max_ground_m: f64,
    },
}

/// What a cell is for a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum CellState {
    /// Nothing is in the way.
    Free,
    /// A declared obstacle, or one of an obstacle map.
    Obstacle,
    /// A rock on the map.
    Rock,
    /// Steeper than the vehicle climbs.
    Steep,
    /// Ground above the vehicle's altitude.
    High,
    /// The map has no height there.
    NoData,
}

impl CellState {
    /// In a mission author's words, to stand after "it is": for messages.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Obstacle => "in an obstacle",
            Self::Rock => "on a rock",
            Self::Steep => "on ground too steep for the vehicle",
            Self::High => "on ground above the vehicle's altitude",
            Self::NoData => "where the map has no data",
        }
    }
}

/// A grid of cells that are free or not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Occupancy {
    frame: GridFrame,
    states: Vec<CellState>,
}

impl Occupancy {
    /// A grid on which every cell is free.
    pub fn free(frame: GridFrame) -> Self {
        Self { frame, states: vec![CellState::Free; frame.cell_count()] }
    }

    /// A grid of obstacles, row by row from the south.
    ///
    /// # Panics
    /// When there is not one entry for each cell.
    pub fn from_obstacles(frame: GridFrame, occupied: &[bool]) -> Self {
        assert_eq!(occupied.len(), frame.cell_count(), "one entry for each cell");
        let state = |&occupied: &bool| if occupied { CellState::Obstacle } else { CellState::Free };
        Self { frame, states: occupied.iter().map(state).collect() }
    }

    /// Returns what the map and `obstacles`, which are closed to the vehicle, leave to it.
    pub fn of_terrain(terrain: &Terrain, obstacles: &[Obstacle], traversability: &Traversability) -> Self {
        let frame = *terrain.frame();
        let mut grid = Self::free(frame);
        let is_ground = matches!(traversability, Traversability::Ground { .. });
        for index in 0..frame.cell_count() {
            let cell = frame.cell(index);
            grid.states[index] = if terrain.is_no_data(cell) {
                CellState::NoData
            } else if is_ground && terrain.is_obstacle(cell) {
                CellState::Obstacle
            } else {
                ground_state(terrain, cell, index, traversability)
            };
        }
        if let Traversability::Ground { rock_diameter_m, .. } = traversability {
            for rock in terrain.rocks() {
                if rock.is_mapped() && rock.diameter_m >= *rock_diameter_m {
                    let disc = Obstacle::Circle { center_m: rock.center_m, radius_m: 0.5 * rock.diameter_m };
                    grid.mark(&disc, CellState::Rock);
                }
            }
        }
        for obstacle in obstacles {
            grid.mark(obstacle, CellState::Obstacle);
        }
        grid
    }

    /// Gives a state to every cell that a shape touches.
    pub fn mark(&mut self, shape: &Obstacle, state: CellState) {
        let Self { frame, states } = self;
        shape.for_each_cell(frame, |cell| states[frame.index(cell)] = state);
    }

    /// The part of the grid that is `across_m` wide and high around a place, as far as there is one, with each cell divided into
    /// `parts` × `parts` cells.
    pub fn around(&self, center_m: Point2<f64>, across_m: f64, parts: u32) -> Self {
        let corner = |sign: f64| self.frame.to_cells(center_m + Vector2::repeat(sign * 0.5 * across_m));
        let within = |cells: f64, size: u32| cells.clamp(0.0, f64::from(size)) as u32;
        let on_grid =
            |at: Point2<f64>| Point2::new(within(at.x, self.frame.width), within(at.y, self.frame.height));
        let low = on_grid(corner(-1.0).map(f64::floor));
        let high = on_grid(corner(1.0).map(f64::ceil));
        let frame = GridFrame {
            width: (high.x - low.x) * parts,
            height: (high.y - low.y) * parts,
            cell_size_m: self.frame.cell_size_m / f64::from(parts),
            origin_m: self.frame.to_meters(low.map(f64::from)),
        };
        let state = |index: usize| {
            let Cell { column, row } = frame.cell(index);
            self.state(Cell { column: low.x + column / parts, row: low.y + row / parts })
        };
        Self { frame, states: (0..frame.cell_count()).map(state).collect() }
    }

    /// Returns where the grid lies.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The states, row by row from the south.
    pub fn states(&self) -> &[CellState] {
        &self.states
    }

    /// The state of a cell of the grid.
    pub fn state(&self, cell: Cell) -> CellState {
        self.states[self.frame.index(cell)]
    }
}

fn ground_state(terrain: &Terrain, cell: Cell, index: usize, traversability: &Traversability) -> CellState {
    match *traversability {
        Traversability::Ground { max_grade, .. } => {
            if terrain.cell_gradient(cell).norm_squared() > max_grade * max_grade {
                CellState::Steep
            } else {
                CellState::Free
            }
        }
        Traversability::Air { max_ground_m } => {
            if f64::from(terrain.heights_m()[index]) > max_ground_m {
                CellState::High
            } else {
                CellState::Free
            }
        }
    }
}

//! How a search grew, sample by sample, so that it can be shown growing.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use terrain::ConfigurationSpace;

#[cfg(doc)]
use crate::query::Statistics;
use crate::query::{Failure, Growth, PlannerKind, Query, Settings};
use crate::search::Search;

/// All steps of a search. The same arguments give the same trace.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GrowthTrace {
    /// The root of each tree in meters: the start, and for a planner with two trees the goal.
    pub roots_m: Vec<Point2<f64>>,
    /// What each sample did, in order.
    pub steps: Vec<GrowthStep>,
}

/// What one sample did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrowthStep {
    /// The sample in meters.
    pub sample_m: Point2<f64>,
    /// The tree that was grown toward it, an index into [`GrowthTrace::roots_m`].
    pub tree: u32,
    /// Where the vertex of that tree is that was nearest to the sample, in meters.
    pub nearest_m: Point2<f64>,
    /// The vertices that were added, in order; none where an obstacle was in the way.
    pub added: Vec<GrownVertex>,
    /// Vertices that got another parent, as tree, vertex and parent: RRT* does this.
    pub rewired: Vec<[u32; 3]>,
    /// How many straight pieces of ground were checked for obstacles ([`Statistics::collision_checks`]).
    pub checks: u32,
    /// The first path, or a shorter one, that this sample led to, in meters.
    pub path_m: Option<Vec<Point2<f64>>>,
}

/// A vertex as it was added to its tree. Vertices are numbered by tree in the order in which they appear; the root is 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrownVertex {
    /// The tree, an index into [`GrowthTrace::roots_m`].
    pub tree: u32,
    /// Its parent's number in the same tree.
    pub parent: u32,
    /// Where its parent is, in meters.
    pub from_m: Point2<f64>,
    /// Where it is, in meters.
    pub point_m: Point2<f64>,
    /// The points on the way from its parent, without it, to the vertex; empty if the way is straight.
    pub curve_m: Vec<Point2<f64>>,
}

impl GrowthStep {
    /// Returns where the tree grew to from its nearest vertex, if nothing was in the way: one step toward the sample,
    /// in meters.
    pub fn steered_m(&self) -> Option<Point2<f64>> {
        self.added.iter().find(|grown| grown.tree == self.tree).map(|grown| grown.point_m)
    }
}

impl GrowthTrace {
    /// Vertices of all trees after the first `steps` steps, without the roots.
    pub fn grown(&self, steps: usize) -> impl Iterator<Item = &GrownVertex> {
        self.steps.iter().take(steps).flat_map(|step| &step.added)
    }

    /// The best path after the first `steps` steps.
    pub fn path_m(&self, steps: usize) -> Option<&[Point2<f64>]> {
        self.steps.iter().take(steps).rev().find_map(|step| step.path_m.as_deref())
    }
}

/// A search with what each of its samples did so far; it can be kept, and run on.
#[derive(Clone, Debug)]
pub struct TracedSearch {
    search: Search,
    planner: PlannerKind,
    /// The parents of the vertices of each tree.
    parents: Vec<Vec<Option<u32>>>,
    trace: GrowthTrace,
}

impl TracedSearch {
    /// Starts a search, or says at once why there is no path.
    pub fn new(space: &ConfigurationSpace, query: Query, settings: Settings) -> Result<Self, Failure> {
        let search = Search::new(space, query, settings)?;
        let roots_m = search.trees().iter().map(|tree| tree.vertices[0].point_m).collect();
        let parents = search.trees().iter().map(|_| vec![None]).collect();
        let trace = GrowthTrace { roots_m, steps: Vec::new() };
        Ok(Self { search, planner: settings.planner, parents, trace })
    }

    /// Returns what the samples did so far.
    pub const fn trace(&self) -> &GrowthTrace {
        &self.trace
    }

    /// Returns whether the search is over.
    pub fn is_finished(&self) -> bool {
        self.search.is_finished()
    }

    /// Draws one more sample. Linear in the trees for RRT*, whose vertices change parents, and in what is added for the
    /// others.
    pub fn step(&mut self, space: &ConfigurationSpace) {
        let checked_before = self.search.statistics().collision_checks;
        let event = self.search.step(space);
        let checks = self.search.statistics().collision_checks - checked_before;
        let (mut added, mut rewired) = (Vec::new(), Vec::new());
        for (number, (tree, known)) in self.search.trees().into_iter().zip(&mut self.parents).enumerate() {
            let number = number as u32;
            if self.planner == PlannerKind::RrtStar {
                for (index, (vertex, parent)) in tree.vertices.iter().zip(known.iter_mut()).enumerate() {
                    if let (true, Some(now)) = (vertex.parent != *parent, vertex.parent) {
                        *parent = Some(now);
                        rewired.push([number, index as u32, now]);
                    }
                }
            }
            for (index, vertex) in tree.vertices.iter().enumerate().skip(known.len()) {
                let parent = vertex.parent.unwrap_or_default();
                let from_m = tree.vertices[parent as usize].point_m;
                let curve_m = tree.curves.get(index).cloned().unwrap_or_default();
                added.push(GrownVertex { tree: number, parent, from_m, point_m: vertex.point_m, curve_m });
            }
            known.extend(tree.vertices[known.len()..].iter().map(|vertex| vertex.parent));
        }
        let is_found = matches!(event.growth, Growth::Found { .. });
        let path_m = self.search.path().filter(|_| is_found).map(|path| path.points_m);
        let tree = event.tree;
        let nearest_m = self.search.trees()[tree as usize].vertices[event.nearest as usize].point_m;
        self.trace.steps.push(GrowthStep {
            sample_m: event.sample_m,
            tree,
            nearest_m,
            added,
            rewired,
            checks,
            path_m,
        });
    }
}

/// Runs a search to its end, or for `most_steps` samples, and notes what each sample did.
pub fn trace(
    space: &ConfigurationSpace,
    query: Query,
    settings: Settings,
    most_steps: usize,
) -> Result<GrowthTrace, Failure> {
    let mut search = TracedSearch::new(space, query, settings)?;
    while !search.is_finished() && search.trace.steps.len() < most_steps {
        search.step(space);
    }
    Ok(search.trace)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::find_path;
    use terrain::{CellState, GridFrame, Obstacle, Occupancy};

    #[test]
    fn a_trace_ends_with_the_trees_and_the_path_of_the_search() {
        let mut occupancy = Occupancy::free(GridFrame::new(100, 100, 0.6));
        let disc = Obstacle::Circle { center_m: Point2::new(30.0, 30.0), radius_m: 9.0 };
        occupancy.mark(&disc, CellState::Obstacle);
        let space = ConfigurationSpace::new(occupancy, 0.7);
        let query = Query { start_m: Point2::new(6.0, 29.0), goal_m: Point2::new(54.0, 31.0) };
        for planner in PlannerKind::ALL {
            let settings = Settings { seed: 5, improving_samples: 200, ..Settings::of(planner) };
            let found = find_path(&space, query, &settings, None, &mut |_| false);
            let traced = trace(&space, query, settings, usize::MAX).expect("both ends are free");
            assert_eq!(found.seed, 5);
            assert_eq!(traced.steps.len(), found.statistics.samples as usize, "{planner:?}");
            let mut trees: Vec<Vec<(Point2<f64>, Option<u32>)>> =
                traced.roots_m.iter().map(|&root| vec![(root, None)]).collect();
            for step in &traced.steps {
                let near = |tree: &[(Point2<f64>, _)]| {
                    let measure = |(point, _): &(Point2<f64>, _)| (point - step.sample_m).norm();
                    tree.iter().map(measure).fold(f64::INFINITY, f64::min)
                };
                if planner != PlannerKind::Kinodynamic {
                    // A kinodynamic planner measures how far it is for a vehicle, which has to turn.
                    let nearest = near(&trees[step.tree as usize]);
                    assert!(((step.nearest_m - step.sample_m).norm() - nearest).abs() < 1e-9, "{planner:?}");
                    assert!(step.steered_m().is_none_or(|to| (to - step.nearest_m).norm() <= 6.0 + 1e-9));
                }
                for vertex in &step.added {
                    let tree = &mut trees[vertex.tree as usize];
                    assert_eq!(tree[vertex.parent as usize].0, vertex.from_m);
                    tree.push((vertex.point_m, Some(vertex.parent)));
                }
                for &[tree, vertex, parent] in &step.rewired {
                    trees[tree as usize][vertex as usize].1 = Some(parent);
                }
            }
            for (tree, expected) in trees.iter().zip(&found.trees) {
                let expected: Vec<_> =
                    expected.vertices.iter().map(|vertex| (vertex.point_m, vertex.parent)).collect();
                assert_eq!(*tree, expected, "{planner:?}");
            }
            let path = found.path.expect("there is a way around").points_m;
            assert_eq!(traced.path_m(usize::MAX), Some(path.as_slice()), "{planner:?}");
            assert_eq!(traced.path_m(0), None);
            let checks: u32 = traced.steps.iter().map(|step| step.checks).sum();
            assert_eq!(checks, found.statistics.collision_checks, "{planner:?}");
            let added = traced.grown(usize::MAX).count() as u32;
            assert!(checks >= added, "{planner:?}: each of {added} edges was checked, in {checks} checks");
        }
    }
}

//! Distances between single pairs of points, without a search of the whole network for each.
//!
//! On the elimination tree a shortest way leads up and then down, so that the points above both ends say what it is
//! (customizable contraction hierarchies; Dibbelt, Strasser and Wagner 2016): a query takes time proportional to the height
//! of the tree, which is logarithmic in the number of points where the network's tree width is bounded.

use std::collections::BTreeMap;

use crate::elimination::{EliminationTree, FREE, UpEdge, sum};
use crate::network::{Overflow, PointId, Stn};

/// The distances of one network, found when they are asked for.
///
/// ```
/// use stn::{INFINITE, PairDistances, PointId, Stn};
///
/// let [start, drive, end] = [PointId(0), PointId(1), PointId(2)];
/// let mut network = Stn::new(3);
/// network.constrain(start, drive, 0, Some(10), 0).unwrap();
/// network.constrain(drive, end, 20, None, 0).unwrap();
/// let distances = PairDistances::new(&network).unwrap();
/// assert_eq!(distances.between(end, start), Ok(Some(-20)));
/// assert_eq!(distances.between(start, end), Ok(Some(INFINITE)));
/// ```
#[derive(Clone, Debug)]
pub struct PairDistances {
    tree: EliminationTree,
}

impl PairDistances {
    /// Of a consistent network.
    pub fn new(stn: &Stn) -> Result<Self, Overflow> {
        EliminationTree::new(stn).map(|tree| Self { tree })
    }

    /// The least upper bound of `to − from`, [`crate::INFINITE`] where there is none. `None` where the way may lead through points
    /// with so many neighbors that the tree leaves them out: then a search has to find it.
    pub fn between(&self, from: PointId, to: PointId) -> Result<Option<i64>, Overflow> {
        let there = self.upwards(from.0, |edge| edge.up)?;
        let back = self.upwards(to.0, |edge| edge.down)?;
        let (Some(there), Some(back)) = (there, back) else { return Ok(None) };
        let mut least = FREE;
        for (&point, &up) in &there {
            if let Some(&down) = back.get(&point) {
                least = least.min(sum(up, down, point)?);
            }
        }
        Ok(Some(least))
    }

    /// Returns how far it is from a point to each of those above it, or back. `None` if its constraints lead to what is
    /// not in the tree.
    fn upwards(
        &self,
        point: u32,
        length: impl Fn(&UpEdge) -> i64,
    ) -> Result<Option<BTreeMap<u32, i64>>, Overflow> {
        if self.tree.is_core[point as usize] {
            return Ok(None);
        }
        let mut lengths = BTreeMap::from([(point, 0)]);
        for here in self.tree.chain(point) {
            let so_far = lengths.get(&here).copied();
            for edge in &self.tree.edges[here as usize] {
                if self.tree.is_core[edge.to as usize] {
                    return Ok(None);
                }
                let Some(so_far) = so_far else { continue };
                let reached = sum(so_far, length(edge), edge.to)?;
                let known = lengths.entry(edge.to).or_insert(FREE);
                *known = reached.min(*known);
            }
        }
        Ok(Some(lengths))
    }
}

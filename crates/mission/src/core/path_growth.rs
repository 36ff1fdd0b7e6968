//! The search for a leg's path as a session: it is kept with its trees, and goes on from where it is.

use std::sync::Arc;

use motion::{Query, Settings, TracedSearch};
use terrain::ConfigurationSpace;

use super::{ContentKey, Core, CoreHost};
use crate::path_growth::{GrowthStanding, MAX_SAMPLES, PathGrowth};
use crate::request::Response;

/// The search that was asked for last.
pub(super) struct Session {
    key: ContentKey,
    space: Arc<ConfigurationSpace>,
    query: Query,
    settings: Settings,
    search: Result<TracedSearch, String>,
}

/// Samples are drawn for about this long before an answer says what they did.
const PROGRESS_MILLIS: f64 = 60.0;

impl Core {
    /// Searches for a leg's path, to the end of the search.
    pub(super) fn grow_path(&mut self, wanted: &PathGrowth, host: &mut dyn CoreHost) {
        let Some((space, query, settings)) = self.search_of(wanted, host) else { return };
        let known = self.growth.take().filter(|known| {
            // Spaces are kept by what they are made of.
            Arc::ptr_eq(&known.space, &space) && known.query == query && known.settings == settings
        });
        let session = self.growth.insert(known.unwrap_or_else(|| Session {
            key: self.keys.fresh(),
            search: TracedSearch::new(&space, query, settings).map_err(|failure| failure.to_string()),
            space,
            query,
            settings,
        }));
        session.drive(wanted, host);
    }

    fn search_of(
        &mut self,
        wanted: &PathGrowth,
        host: &mut dyn CoreHost,
    ) -> Option<(Arc<ConfigurationSpace>, Query, Settings)> {
        let evaluated = self.evaluate(&wanted.update, host)?.ok()?;
        let network = &evaluated.planned.network;
        let has_name = |traverse: &&crate::snapshot::Traverse| {
            let occurrence = network.occurrences.get(traverse.occurrence.index());
            occurrence.is_some_and(|occurrence| occurrence.name == wanted.traverse)
        };
        let traverse = evaluated.planned.traverses.iter().find(has_name)?;
        let leg = traverse.legs.get(wanted.leg as usize)?;
        let query = Query { start_m: *leg.points_m.first()?, goal_m: *leg.points_m.last()? };
        let world = &evaluated.program.world;
        let vehicle = world.vehicles.get(*traverse.vehicles.first()? as usize)?;
        let model = motion::vehicle_model(&vehicle.model.text)?;
        let (key, map) = evaluated.ground.as_ref()?;
        let space = self.grounds.space(key, map, world, model).exact;
        let settings = Settings {
            seed: wanted.update.seed,
            greatest_samples: MAX_SAMPLES,
            limits: motion::DriveLimits::of(model),
            ..Settings::of(wanted.planner)
        };
        Some((space, query, settings))
    }
}

impl Session {
    fn drive(&mut self, wanted: &PathGrowth, host: &mut dyn CoreHost) {
        let mut first = if wanted.held_search == self.key { wanted.held as usize } else { 0 };
        let key = self.key;
        let mut send =
            |search: Result<&TracedSearch, &String>, is_complete: bool, host: &mut dyn CoreHost| {
                let steps = search.map_or(&[][..], |search| search.trace().steps.as_slice());
                let from = first.min(steps.len());
                first = steps.len();
                host.answer(Response::PathGrowth(Box::new(GrowthStanding {
                    revision: wanted.update.revision,
                    traverse: wanted.traverse.clone(),
                    leg: wanted.leg,
                    planner: wanted.planner,
                    search: key,
                    roots_m: search.map_or_else(|_| Vec::new(), |search| search.trace().roots_m.clone()),
                    first: from as u32,
                    steps: steps[from..].to_vec(),
                    is_complete,
                    refusal: search.err().cloned(),
                })));
            };
        let search = match &mut self.search {
            Ok(search) => search,
            Err(refusal) => return send(Err(refusal), true, host),
        };
        let mut answered_millis = host.now_millis();
        while !search.is_finished() {
            search.step(&self.space);
            // A later request goes on from here.
            if host.is_superseded() {
                return;
            }
            if host.now_millis() - answered_millis > PROGRESS_MILLIS {
                send(Ok(search), false, host);
                answered_millis = host.now_millis();
            }
        }
        send(Ok(search), true, host);
    }
}

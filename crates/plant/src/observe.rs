//! Naming states, commands and observations, and finding them by name.

use std::collections::BTreeMap;

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::model::{Commands, ComponentId, Model, Observation, VariableId};

impl Model {
    /// The modes of a state by component.
    pub fn state_names(&self, state: &State) -> BTreeMap<String, String> {
        self.component_ids()
            .filter_map(|id| {
                Some((self.component(id)?.name.to_string(), self.mode_name(id, state.mode(id)).to_owned()))
            })
            .collect()
    }

    /// A state from modes by component; components not named are in their initial modes. The error says what is wrong.
    pub fn state_from_names<'name>(
        &self,
        names: impl IntoIterator<Item = (&'name str, &'name str)>,
    ) -> Result<State, String> {
        let mut state = self.initial_state();
        for (name, mode) in names {
            let (component, mode) = self.component_mode(name, mode)?;
            state.set_mode(component, mode);
        }
        Ok(state)
    }

    /// A component and its mode by their names; the error says what is wrong, with what was probably meant.
    pub fn component_mode(&self, name: &str, mode: &str) -> Result<(ComponentId, u8), String> {
        let component = self.component_named(name).ok_or_else(|| {
            let known = self.components.iter().map(|component| component.name.as_str());
            format!("the model has no component `{name}`{}", meant(name, known))
        })?;
        let found = self.mode_named(component, mode).ok_or_else(|| {
            let known = self
                .component(component)
                .into_iter()
                .flat_map(|data| &data.modes)
                .map(|mode| mode.name.as_str());
            format!("`{name}` has no mode `{mode}`{}", meant(mode, known))
        })?;
        Ok((component, found))
    }

    /// The commands that are not idle, by component, or by full name where a component has several.
    pub fn command_names(&self, commands: &Commands) -> BTreeMap<String, String> {
        let mut names = BTreeMap::new();
        for (variable, &value) in
            self.command_variables.iter().zip(&commands.0).filter(|(_, value)| **value != 0)
        {
            let Some(component) = self.component(variable.component) else { continue };
            let name = if component.commands.len() == 1 { &component.name } else { &variable.name };
            let value = variable.values.get(value as usize).map(ToString::to_string).unwrap_or_default();
            names.insert(name.to_string(), value);
        }
        names
    }

    /// Commands by component or full name; all others are idle. The error says what is wrong.
    pub fn commands_from_names<'name>(
        &self,
        names: impl IntoIterator<Item = (&'name str, &'name str)>,
    ) -> Result<Commands, String> {
        let mut commands = self.idle();
        for (name, value) in names {
            let owned = |variable: &crate::CommandVariable| {
                variable.name == name
                    || self.component(variable.component).is_some_and(|component| component.name == name)
            };
            let mut known =
                self.command_variables.iter().enumerate().filter(|(_, variable)| owned(variable)).peekable();
            if known.peek().is_none() {
                let names = self
                    .command_variables
                    .iter()
                    .filter_map(|variable| Some(self.component(variable.component)?.name.as_str()));
                return Err(format!("no component `{name}` takes commands{}", meant(name, names)));
            }
            let offered: Vec<&str> = known
                .clone()
                .flat_map(|(_, variable)| &variable.values)
                .map(smol_str::SmolStr::as_str)
                .collect();
            let found = known.find_map(|(at, variable)| {
                Some((at, variable.values.iter().position(|known| known == value)?))
            });
            let Some((at, value)) = found else {
                return Err(format!("`{name}` has no command `{value}`{}", meant(value, offered)));
            };
            if let Some(slot) = commands.0.get_mut(at) {
                *slot = value as u8;
            }
        }
        Ok(commands)
    }

    /// The values of an observation by full variable name.
    pub fn observation_names(&self, observation: &Observation) -> BTreeMap<String, String> {
        observation
            .0
            .iter()
            .filter_map(|(id, value)| {
                let variable = self.variables.get(id.0 as usize)?;
                Some((variable.name.to_string(), variable.values.get(*value as usize)?.to_string()))
            })
            .collect()
    }

    /// An observation by full variable names; the error says what is wrong.
    pub fn observation_from_names<'name>(
        &self,
        names: impl IntoIterator<Item = (&'name str, &'name str)>,
    ) -> Result<Observation, String> {
        let mut observation = Observation::default();
        for (name, value) in names {
            let id = self.variable_named(name).ok_or_else(|| {
                let known = self.variables.iter().map(|variable| variable.name.as_str());
                format!("the model has no variable `{name}`{}", meant(name, known))
            })?;
            let values =
                self.variables.get(id.0 as usize).map_or(&[][..], |variable| variable.values.as_slice());
            let found = values.iter().position(|known| known == value).ok_or_else(|| {
                format!(
                    "`{name}` cannot be `{value}`{}",
                    meant(value, values.iter().map(smol_str::SmolStr::as_str))
                )
            })?;
            observation.0.insert(id, found as u8);
        }
        Ok(observation)
    }

    /// The variables whose values follow from a state's modes and an observation.
    pub fn entailed_values(&self, state: &State, observation: &Observation) -> Vec<(VariableId, u8)> {
        let mut domains = Domains::observed(self, observation);
        for island in &self.islands {
            // A contradiction entails anything; then only what is observed is reported.
            if Assumed::all(self, island, &state.0).propagate(&mut domains).is_err() {
                return observation.0.iter().map(|(variable, value)| (*variable, *value)).collect();
            }
        }
        (0..self.variables.len() as u32)
            .map(VariableId)
            .filter_map(|variable| {
                let set = domains.sets.get(self.variable_symbol(variable) as usize).copied()?;
                Some((variable, set.only()?))
            })
            .collect()
    }

    /// The modes in which a state differs from another one: `EngineA=Failed`.
    pub fn differences(&self, from: &State, to: &State) -> String {
        let name = |id: ComponentId| {
            let mode = to.mode(id);
            let component = self.component(id).filter(|_| mode != from.mode(id))?;
            Some(format!("{}={}", component.name, self.mode_name(id, mode)))
        };
        self.component_ids().filter_map(name).collect::<Vec<_>>().join(", ")
    }

    /// The sum of a state's names in one line.
    pub fn describe(&self, state: &State) -> String {
        let names: Vec<String> =
            self.state_names(state).into_iter().map(|(name, mode)| format!("{name}={mode}")).collect();
        names.join(", ")
    }
}

fn meant<'name>(word: &str, known: impl IntoIterator<Item = &'name str>) -> String {
    rmpl::control::nearest(word, known).map(|known| format!("; did you mean `{known}`?")).unwrap_or_default()
}

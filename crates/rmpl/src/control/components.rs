//! The components of a plant: those that are declared, each followed by its parts (SPEC 2.2).

use std::collections::BTreeMap;

use smol_str::{SmolStr, format_smolstr};

use super::inherit::{MergedClass, merge_all};
use super::syntax::{ControlFile, Initial, Name};
use crate::span::Span;

/// A plant of more components than this is refused: no author means it.
pub const MAX_COMPONENTS: usize = 20_000;

/// A component of a plant, declared by itself or as a part of another one.
#[derive(Clone, Debug)]
pub struct PlantComponent<'file> {
    /// Its name in the plant: that of a part follows its owner's, as in `P1.valve`.
    pub name: SmolStr,
    pub class: &'file Name,
    /// What its ports are connected to, and its parts, by place among the components.
    pub neighbors: Vec<(&'file SmolStr, usize)>,
    /// The modes in which it may start.
    pub initial: &'file Initial,
    /// Where it is declared.
    pub span: Span,
    /// The component that it is a part of.
    owner: Option<usize>,
    /// Its ports with what is written for them.
    written: &'file [(Name, Name)],
    /// Its parts, by name.
    parts: Vec<(&'file SmolStr, usize)>,
}

/// What is connected to a component by what is written for one of its ports.
type Connections<'file> = BTreeMap<(usize, &'file str), Option<usize>>;

/// All components of a plant.
#[derive(Clone, Debug, Default)]
pub struct PlantComponents<'file> {
    all: Vec<PlantComponent<'file>>,
    by_name: BTreeMap<SmolStr, usize>,
}

impl<'file> PlantComponents<'file> {
    /// The components of a file, each followed by its parts. With more than [`MAX_COMPONENTS`], no further parts are added.
    pub fn new(file: &'file ControlFile, classes: &BTreeMap<SmolStr, MergedClass<'file>>) -> Self {
        let mut components = Self::default();
        for instance in &file.instances {
            let declared = Declared {
                class: &instance.class,
                initial: &instance.initial,
                written: &instance.ports,
                span: instance.span,
            };
            components.add(&instance.name.text, None, &declared, classes, 0);
        }
        let mut known = Connections::new();
        for at in 0..components.all.len() {
            let component = &components.all[at];
            let ports = component.written.iter().filter_map(|(port, connected)| {
                Some((&port.text, components.connected(at, &connected.text, &mut known)?))
            });
            let neighbors: Vec<_> = ports.chain(component.parts.iter().copied()).collect();
            components.all[at].neighbors = neighbors;
        }
        components
    }

    /// The components in their order.
    pub fn all(&self) -> &[PlantComponent<'file>] {
        &self.all
    }

    /// The component of this name.
    pub fn named(&self, name: &str) -> Option<&PlantComponent<'file>> {
        self.all.get(*self.by_name.get(name)?)
    }

    /// The component that a path of ports and parts leads to, such as `valve.driver`; `self` is where it starts.
    pub fn reached(&self, from: &PlantComponent<'file>, path: &str) -> Option<&PlantComponent<'file>> {
        let mut at = *self.by_name.get(&from.name)?;
        if path != "self" {
            for step in path.split('.') {
                at = self.all[at].neighbors.iter().find(|(name, _)| *name == step)?.1;
            }
        }
        self.all.get(at)
    }

    fn add(
        &mut self,
        name: &SmolStr,
        owner: Option<usize>,
        declared: &Declared<'file>,
        classes: &BTreeMap<SmolStr, MergedClass<'file>>,
        depth: usize,
    ) -> usize {
        let at = self.all.len();
        self.by_name.entry(name.clone()).or_insert(at);
        self.all.push(PlantComponent {
            name: name.clone(),
            class: declared.class,
            neighbors: Vec::new(),
            initial: declared.initial,
            span: declared.span,
            owner,
            written: declared.written,
            parts: Vec::new(),
        });
        // A class inside itself is reported elsewhere.
        if depth > classes.len() {
            return at;
        }
        let parts = classes.get(&declared.class.text).map_or(&[][..], |class| class.parts.as_slice());
        for part in parts {
            if self.all.len() > MAX_COMPONENTS {
                break;
            }
            let declared =
                Declared { class: part.class, initial: part.initial, written: part.ports, span: part.span };
            let name = format_smolstr!("{name}.{}", part.name.text);
            let number = self.add(&name, Some(at), &declared, classes, depth + 1);
            self.all[at].parts.push((&part.name.text, number));
        }
        at
    }

    /// The place of what is written for a port of a component: for a part, in its owner's names. `None` if there is no such
    /// component, or if the ports lead in a circle.
    fn connected(&self, at: usize, written: &'file str, known: &mut Connections<'file>) -> Option<usize> {
        if let Some(place) = known.get(&(at, written)) {
            return *place;
        }
        // Asking again before the answer is known means a circle.
        known.insert((at, written), None);
        let place = self.connected_anew(at, written, known);
        known.insert((at, written), place);
        place
    }

    fn connected_anew(
        &self,
        at: usize,
        written: &'file str,
        known: &mut Connections<'file>,
    ) -> Option<usize> {
        let Some(owner) = self.all.get(at)?.owner else { return self.by_name.get(written).copied() };
        let mut found = owner;
        for (number, step) in written.split('.').enumerate() {
            if number == 0 && step == "self" {
                continue;
            }
            let component = self.all.get(found)?;
            let part = component.parts.iter().find(|(name, _)| *name == step).map(|(_, part)| *part);
            found = if let Some(part) = part {
                part
            } else {
                let (_, connected) = component.written.iter().find(|(port, _)| port.text == step)?;
                self.connected(found, &connected.text, known)?
            };
        }
        Some(found)
    }
}

/// A component of a plant, with what it can be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComponentModes {
    /// The component.
    pub name: SmolStr,
    /// Its modes, in the order of its class.
    pub modes: Vec<SmolStr>,
    /// The mode that it begins in; of a prior the most likely one, and of those that are equally likely the first.
    pub initial: SmolStr,
}

/// The components of a plant whose classes have modes, in textual order.
pub fn component_modes(file: &ControlFile) -> Vec<ComponentModes> {
    let (classes, _) = merge_all(file);
    let components = PlantComponents::new(file, &classes);
    let of = |component: &PlantComponent<'_>| {
        let class = classes.get(&component.class.text)?;
        let modes: Vec<SmolStr> = class.modes.iter().map(|(mode, _)| mode.text.clone()).collect();
        let initial = likeliest(component.initial, &modes)?;
        Some(ComponentModes { name: component.name.clone(), modes, initial })
    };
    components.all().iter().filter_map(of).collect()
}

/// The most likely first mode of a component, of equally likely ones the first; `modes` are those of its class.
fn likeliest(initial: &Initial, modes: &[SmolStr]) -> Option<SmolStr> {
    let named = match initial {
        Initial::Mode(mode) => modes.iter().find(|known| **known == mode.text),
        Initial::FirstMode | Initial::AnyMode => None,
        Initial::Prior(_) => {
            let prior = initial.prior();
            let weight =
                |mode: &SmolStr| prior.iter().find(|(known, _)| known == mode).map(|(_, weight)| *weight);
            // Of several greatest ones the last is taken.
            modes.iter().rev().filter(|mode| weight(mode).is_some()).max_by_key(|mode| weight(mode))
        }
    };
    named.or_else(|| modes.first()).cloned()
}

/// What a declaration says of a component.
struct Declared<'file> {
    class: &'file Name,
    initial: &'file Initial,
    written: &'file [(Name, Name)],
    span: Span,
}

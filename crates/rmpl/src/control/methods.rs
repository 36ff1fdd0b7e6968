//! Methods of classes as definitions: one for each component, in whose names it is written (SPEC 2.2).

use std::collections::BTreeMap;

use smol_str::{SmolStr, format_smolstr};

use super::components::{PlantComponent, PlantComponents};
use super::inherit::MergedClass;
use super::syntax::{Argument, Constraint, ConstraintKind, Definition, Expression, ExpressionKind, Name};
use crate::span::Span;

/// The methods of all components, called `P1.name`.
pub(super) fn definitions(
    components: &PlantComponents<'_>,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
) -> Vec<Definition> {
    let mut definitions = Vec::new();
    for component in components.all() {
        for method in classes.get(&component.class.text).into_iter().flat_map(|class| &class.methods) {
            let qualifier = Qualifier { components, classes, component, parameters: method.parameters };
            let mut body = method.body.clone();
            qualifier.expression(&mut body);
            definitions.push(Definition {
                name: qualified(&component.name, method.name),
                parameters: method.parameters.to_vec(),
                body,
                span: method.span,
            });
        }
    }
    definitions
}

/// The definitions without their spans, which would refer to another text.
pub fn without_places(mut definitions: Vec<Definition>) -> Vec<Definition> {
    for definition in &mut definitions {
        definition.span = Span::default();
        definition.name.span = Span::default();
        displace(&mut definition.body);
    }
    definitions
}

fn displace(expression: &mut Expression) {
    expression.span = Span::default();
    for constraint in expression.constraints_mut() {
        constraint.change(&mut |constraint| {
            constraint.span = Span::default();
            if let ConstraintKind::Equals { variable, value } = &mut constraint.kind {
                variable.span = Span::default();
                value.span = Span::default();
            }
        });
    }
    for part in expression.parts_mut() {
        displace(part);
    }
}

fn qualified(component: &str, name: &Name) -> Name {
    Name { text: format_smolstr!("{component}.{}", name.text), span: name.span }
}

/// Gives names inside a method their meaning for one component.
struct Qualifier<'method, 'file> {
    components: &'method PlantComponents<'file>,
    classes: &'method BTreeMap<SmolStr, MergedClass<'file>>,
    component: &'method PlantComponent<'file>,
    parameters: &'method [Name],
}

impl Qualifier<'_, '_> {
    fn expression(&self, expression: &mut Expression) {
        for constraint in expression.constraints_mut() {
            constraint.change(&mut |constraint| self.constraint(constraint));
        }
        if let ExpressionKind::Call { name, arguments, .. } = &mut expression.kind {
            if let Some(called) = self.method(&name.text).filter(|_| !self.is_parameter(name)) {
                name.text = called;
            }
            for argument in arguments {
                if let Argument::Word(word) = argument
                    && !self.is_parameter(word)
                    && let Some(known) = self.known(&word.text)
                {
                    word.text = known;
                }
            }
        }
        for part in expression.parts_mut() {
            self.expression(part);
        }
    }

    fn constraint(&self, constraint: &mut Constraint) {
        let ConstraintKind::Equals { variable, value } = &mut constraint.kind else { return };
        if self.is_parameter(variable) {
            return;
        }
        let is_value = self.values(&variable.text).is_some_and(|values| values.contains(&value.text));
        if !is_value
            && !self.is_parameter(value)
            && let Some(known) = self.known(&value.text)
        {
            value.text = known;
        }
        // A name that the component does not have cannot mean anything else.
        variable.text = self
            .known(&variable.text)
            .unwrap_or_else(|| format_smolstr!("{}.{}", self.component.name, variable.text));
    }

    fn is_parameter(&self, name: &Name) -> bool {
        self.parameters.iter().any(|parameter| parameter.text == name.text)
    }

    /// The name in the plant of a variable, part or port of the component, or of one that those lead to.
    fn known(&self, name: &str) -> Option<SmolStr> {
        if let Some(other) = self.components.reached(self.component, name) {
            return Some(other.name.clone());
        }
        let (owner, field) = self.owner(name)?;
        let class = self.classes.get(&owner.class.text)?;
        let is_field = class.variables.iter().any(|variable| variable.name.text == field);
        is_field.then(|| format_smolstr!("{}.{field}", owner.name))
    }

    /// The component that the last part of a name belongs to, and that part.
    fn owner<'name>(&self, name: &'name str) -> Option<(&PlantComponent<'_>, &'name str)> {
        match name.rsplit_once('.') {
            Some((path, field)) => Some((self.components.reached(self.component, path)?, field)),
            None => Some((self.component, name)),
        }
    }

    /// The name of a method of the component, or of one that its parts and ports lead to.
    fn method(&self, name: &str) -> Option<SmolStr> {
        let (owner, method) = self.owner(name)?;
        let class = self.classes.get(&owner.class.text)?;
        let is_method = class.methods.iter().any(|known| known.name.text == method);
        is_method.then(|| format_smolstr!("{}.{method}", owner.name))
    }

    /// The values of what a name represents: of a component its modes.
    fn values(&self, name: &str) -> Option<Vec<SmolStr>> {
        if let Some(other) = self.components.reached(self.component, name) {
            let class = self.classes.get(&other.class.text)?;
            return Some(class.modes.iter().map(|(mode, _)| mode.text.clone()).collect());
        }
        let (owner, field) = self.owner(name)?;
        let class = self.classes.get(&owner.class.text)?;
        let variable = class.variables.iter().find(|variable| variable.name.text == field)?;
        Some(variable.values.clone())
    }
}

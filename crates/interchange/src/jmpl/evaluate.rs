//! What names mean, and statements as constraints: relations are written out where they are called.

use std::collections::BTreeMap;

use super::formula::{Domain, Formula, Symbol};
use super::syntax::{
    Attribute, Class, Enum, Expression, File, Path, Place, Relation, Statement, StatementKind,
};

/// A class extends at most this many others, and relations call each other at most this deep.
const MAX_DEPTH: usize = 50;

/// All constraints together have at most this many parts.
pub(super) const MAX_PARTS: usize = 500_000;

/// A structure has at most this many attributes.
const MAX_ATTRIBUTES: usize = 10_000;

/// The type of an attribute.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind<'file> {
    Enum(&'file Enum),
    Class(&'file Class),
}

/// What a name represents.
#[derive(Clone, Debug)]
enum Value<'file> {
    Attribute { path: String, kind: Kind<'file>, is_mode: bool },
    Constant(String),
}

/// Where a statement is evaluated.
struct Scope<'file> {
    this: Value<'file>,
    parameters: BTreeMap<&'file str, Value<'file>>,
    depth: usize,
}

/// All declarations of some files.
#[derive(Default)]
pub(super) struct Names<'file> {
    enums: BTreeMap<&'file str, &'file Enum>,
    pub(super) classes: BTreeMap<&'file str, &'file Class>,
    /// Numbers by their names.
    numbers: BTreeMap<&'file str, &'file str>,
    /// Classes that are declared again, with the places where.
    pub(super) again: Vec<(&'file str, Place)>,
}

impl<'file> Names<'file> {
    /// Collects what files declare; of equal names the first counts.
    pub(super) fn new(files: &'file [File]) -> Self {
        let mut names = Self::default();
        for file in files {
            for declared in file.enums.iter().chain(file.classes.iter().flat_map(|class| &class.enums)) {
                names.numbers.extend(declared.numbers.iter().map(|(name, number)| (&**name, &**number)));
            }
            for declared in &file.enums {
                names.enums.entry(&declared.name).or_insert(declared);
            }
            for class in &file.classes {
                if names.classes.contains_key(&*class.name) {
                    names.again.push((&class.name, class.place));
                } else {
                    names.classes.insert(&class.name, class);
                }
            }
        }
        names
    }

    /// The number that a name represents.
    pub(super) fn number(&self, name: &str) -> Option<&'file str> {
        self.numbers.get(name).copied()
    }

    /// A class and what it extends, the most specific one first.
    pub(super) fn lineage(&self, class: &'file Class) -> Vec<&'file Class> {
        let parent = |class: &&'file Class| self.classes.get(class.parent.as_deref()?).copied();
        std::iter::successors(Some(class), parent).take(MAX_DEPTH).collect()
    }

    /// The attribute of a class, with the class that declares it.
    pub(super) fn attribute(
        &self,
        class: &'file Class,
        name: &str,
    ) -> Option<(&'file Class, &'file Attribute)> {
        self.lineage(class).into_iter().find_map(|class| {
            Some((class, class.attributes.iter().find(|attribute| attribute.name == name)?))
        })
    }

    /// The type of an attribute that a class declares.
    pub(super) fn kind(&self, class: &'file Class, attribute: &Attribute) -> Option<Kind<'file>> {
        let named = |declared: &&'file Enum| declared.name == attribute.kind;
        let own = self.lineage(class).into_iter().find_map(|class| class.enums.iter().find(named));
        let own = own.or_else(|| self.enums.get(&*attribute.kind).copied());
        own.map(Kind::Enum).or_else(|| self.classes.get(&*attribute.kind).copied().map(Kind::Class))
    }

    /// The class whose state vector a class has, and its modes; `None` without a state vector of one variable.
    pub(super) fn modes(&self, class: &'file Class) -> Option<(&'file Class, &'file Enum)> {
        let owner = self.lineage(class).into_iter().find(|class| !class.state.is_empty())?;
        let [variable] = &*owner.state else { return None };
        let (declaring, attribute) = self.attribute(owner, variable)?;
        match self.kind(declaring, attribute)? {
            Kind::Enum(modes) => Some((owner, modes)),
            Kind::Class(_) => None,
        }
    }

    /// Returns whether an attribute is a variable of the state vector.
    pub(super) fn is_state(&self, class: &'file Class, attribute: &str) -> bool {
        self.lineage(class).into_iter().any(|class| class.state.iter().any(|name| name == attribute))
    }

    /// The class that declares the attribute at a path first, and the attribute's name.
    pub(super) fn key(&self, class: &'file Class, path: &str) -> Option<(&'file str, &'file str)> {
        let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
        let (declaring, attribute) = self.attribute(class, first)?;
        if let Some(rest) = rest {
            let Kind::Class(inner) = self.kind(declaring, attribute)? else { return None };
            return self.key(inner, rest);
        }
        let all = self.lineage(class).into_iter().rev();
        let mut all = all.filter(|class| class.attributes.iter().any(|known| known.name == attribute.name));
        Some((&all.next()?.name, &attribute.name))
    }

    fn member(&self, of: &Value<'file>, name: &str) -> Option<Value<'file>> {
        let Value::Attribute { path, kind: Kind::Class(class), .. } = of else { return None };
        if self.is_state(class, name) {
            let (_, modes) = self.modes(class)?;
            return Some(Value::Attribute { path: path.clone(), kind: Kind::Enum(modes), is_mode: true });
        }
        let (declaring, attribute) = self.attribute(class, name)?;
        let kind = self.kind(declaring, attribute)?;
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        Some(Value::Attribute { path, kind, is_mode: false })
    }

    /// The attributes of a structure, at any depth, that have values; `None` if there are too many.
    fn leaves(&self, class: &'file Class) -> Option<BTreeMap<String, &'file Enum>> {
        let mut found = BTreeMap::new();
        let mut waiting = vec![(String::new(), class)];
        let mut visited = 0;
        while let Some((before, class)) = waiting.pop() {
            for declaring in self.lineage(class) {
                for attribute in &declaring.attributes {
                    visited += 1;
                    if visited > MAX_ATTRIBUTES {
                        return None;
                    }
                    let path = format!("{before}.{}", attribute.name);
                    match self.kind(declaring, attribute) {
                        Some(Kind::Enum(domain)) if !self.is_state(class, &attribute.name) => {
                            found.insert(path, domain);
                        }
                        Some(Kind::Class(inner)) => waiting.push((path, inner)),
                        _ => {}
                    }
                }
            }
        }
        Some(found)
    }
}

/// Evaluates statements, and collects what cannot be read.
pub(super) struct Evaluator<'file> {
    pub(super) names: Names<'file>,
    /// What is left out, with its place.
    pub(super) left_out: Vec<(Place, String)>,
    /// What is read in another way than it may be meant.
    pub(super) remarks: Vec<String>,
    parts: usize,
}

impl<'file> Evaluator<'file> {
    pub(super) const fn new(names: Names<'file>) -> Self {
        Self { names, left_out: Vec::new(), remarks: Vec::new(), parts: 0 }
    }

    /// Notes once that something is left out.
    pub(super) fn leave_out(&mut self, place: Place, what: String) {
        if !self.left_out.contains(&(place, what.clone())) {
            self.left_out.push((place, what));
        }
    }

    /// Notes a remark once.
    pub(super) fn remark(&mut self, what: String) {
        if !self.remarks.contains(&what) {
            self.remarks.push(what);
        }
    }

    /// Returns whether all constraints together are larger than is read.
    pub(super) const fn is_too_large(&self) -> bool {
        self.parts > MAX_PARTS
    }

    /// The constraint that statements of a class state together. A statement that cannot be read is left out.
    pub(super) fn constraint(
        &mut self,
        class: &'file Class,
        statements: &'file [Statement],
    ) -> Formula<'file> {
        let scope = own_scope(class);
        self.statements(statements, &scope, true).unwrap_or(Formula::Constant(true))
    }

    /// The constraint of the statements of a transition or a failure, none of which may be left out.
    pub(super) fn guard(
        &mut self,
        class: &'file Class,
        statements: &'file [Statement],
    ) -> Result<Formula<'file>, String> {
        self.statements(statements, &own_scope(class), false)
    }

    fn statements(
        &mut self,
        statements: &'file [Statement],
        scope: &Scope<'file>,
        may_leave_out: bool,
    ) -> Result<Formula<'file>, String> {
        let mut all = Vec::new();
        for statement in statements {
            match self.statement(statement, scope, may_leave_out) {
                Ok(formula) => all.push(formula),
                Err(what) if may_leave_out => self.leave_out(statement.place, what),
                Err(what) => return Err(what),
            }
        }
        Ok(Formula::All(all))
    }

    fn statement(
        &mut self,
        statement: &'file Statement,
        scope: &Scope<'file>,
        may_leave_out: bool,
    ) -> Result<Formula<'file>, String> {
        match &statement.kind {
            StatementKind::Group(group) => self.statements(group, scope, may_leave_out),
            StatementKind::Holds(expression) => self.expression(expression, scope),
            StatementKind::If { condition, then, otherwise } => {
                let condition = self.expression(condition, scope)?;
                let then = self.statements(std::slice::from_ref(then), scope, may_leave_out)?;
                let mut both = vec![condition.clone().implies(then)];
                if let Some(otherwise) = otherwise {
                    let otherwise = self.statements(std::slice::from_ref(otherwise), scope, may_leave_out)?;
                    both.push(Formula::Any(vec![condition, otherwise]));
                }
                Ok(Formula::All(both))
            }
            StatementKind::Iff { condition, body } => {
                let condition = self.expression(condition, scope)?;
                let body = self.statement(body, scope, false)?;
                let back = Formula::Any(vec![condition.clone(), Formula::Not(Box::new(body.clone()))]);
                Ok(Formula::All(vec![condition.implies(body), back]))
            }
            StatementKind::Switch { on, cases } => {
                let mut all = Vec::new();
                for (values, body) in cases {
                    let each =
                        values.iter().map(|value| self.equality(on, std::slice::from_ref(value), scope));
                    let case = Formula::Any(each.collect::<Result<_, _>>()?);
                    all.push(case.implies(self.statements(body, scope, may_leave_out)?));
                }
                Ok(Formula::All(all))
            }
        }
    }

    fn expression(
        &mut self,
        expression: &'file Expression,
        scope: &Scope<'file>,
    ) -> Result<Formula<'file>, String> {
        self.parts += 1;
        if self.is_too_large() {
            return Err("the constraints are too large when relations are written out".to_owned());
        }
        match expression {
            Expression::Any(parts) => {
                let parts = parts.iter().map(|part| self.expression(part, scope));
                Ok(Formula::Any(parts.collect::<Result<_, _>>()?))
            }
            Expression::All(parts) => {
                let parts = parts.iter().map(|part| self.expression(part, scope));
                Ok(Formula::All(parts.collect::<Result<_, _>>()?))
            }
            Expression::Not(inner) => Ok(Formula::Not(Box::new(self.expression(inner, scope)?))),
            Expression::Equal(left, right) => self.equality(left, right, scope),
            Expression::Call(path, arguments) => self.call(path, arguments, scope),
        }
    }

    /// Returns what a path represents: `None` if it is a single name that nothing has.
    fn value(&self, path: &[String], scope: &Scope<'file>) -> Result<Option<Value<'file>>, String> {
        let Some((first, rest)) = path.split_first() else { return Ok(None) };
        let start = if first == "this" {
            Some(scope.this.clone())
        } else {
            let parameter = scope.parameters.get(&**first).cloned();
            parameter.or_else(|| self.names.member(&scope.this, first))
        };
        let unknown = || format!("unknown name `{}`", path.join("."));
        let Some(mut value) = start else {
            return if rest.is_empty() { Ok(None) } else { Err(unknown()) };
        };
        for step in rest {
            value = self.names.member(&value, step).ok_or_else(unknown)?;
        }
        Ok(Some(value))
    }

    fn equality(
        &mut self,
        left: &[String],
        right: &[String],
        scope: &Scope<'file>,
    ) -> Result<Formula<'file>, String> {
        let constant = |path: &[String]| Value::Constant(path.join("."));
        let (first, second) = (self.value(left, scope)?, self.value(right, scope)?);
        if first.is_none() && second.is_none() {
            return Err(format!("unknown names `{}` and `{}`", left.join("."), right.join(".")));
        }
        // A value may have the name of an attribute.
        let mut others = Vec::new();
        if right.len() == 1 && second.is_some() {
            others.extend(first.clone().map(|first| (first, constant(right))));
        }
        if left.len() == 1 && first.is_some() {
            others.extend(second.clone().map(|second| (constant(left), second)));
        }
        let (first, second) =
            (first.unwrap_or_else(|| constant(left)), second.unwrap_or_else(|| constant(right)));
        self.equal(first, second).or_else(|what| {
            let other = others.into_iter().find_map(|(left, right)| self.equal(left, right).ok());
            other.ok_or(what)
        })
    }

    fn equal(&mut self, left: Value<'file>, right: Value<'file>) -> Result<Formula<'file>, String> {
        match (left, right) {
            (Value::Constant(left), Value::Constant(right)) => Ok(Formula::Constant(left == right)),
            (Value::Attribute { path, kind: Kind::Enum(domain), is_mode }, Value::Constant(value))
            | (Value::Constant(value), Value::Attribute { path, kind: Kind::Enum(domain), is_mode }) => {
                if !domain.values.contains(&value) {
                    return Err(format!("`{value}` is not a value of the type `{}`", domain.name));
                }
                Ok(Formula::Is { symbol: Symbol { path, is_mode }, value, domain: Domain(domain) })
            }
            (Value::Attribute { kind: Kind::Class(class), .. }, Value::Constant(value))
            | (Value::Constant(value), Value::Attribute { kind: Kind::Class(class), .. }) => {
                Err(format!("unknown name `{value}`, compared with a `{}`", class.name))
            }
            (
                Value::Attribute { path: left, kind: Kind::Enum(first), is_mode: is_left_mode },
                Value::Attribute { path: right, kind: Kind::Enum(second), is_mode: is_right_mode },
            ) => {
                if Domain(first) != Domain(second) {
                    return Err(format!(
                        "`{left}` and `{right}` have different types (`{}` and `{}`)",
                        first.name, second.name
                    ));
                }
                let left = Symbol { path: left, is_mode: is_left_mode };
                let right = Symbol { path: right, is_mode: is_right_mode };
                Ok(Formula::Same { left, right, domain: Domain(first) })
            }
            (
                Value::Attribute { path: left, kind: Kind::Class(first), .. },
                Value::Attribute { path: right, kind: Kind::Class(second), .. },
            ) => self.equal_structures((&left, first), (&right, second)),
            (Value::Attribute { path: left, .. }, Value::Attribute { path: right, .. }) => {
                Err(format!("`{left}` and `{right}` have different types"))
            }
        }
    }

    /// Structures are equal if all their attributes are.
    fn equal_structures(
        &mut self,
        (left, first): (&str, &'file Class),
        (right, second): (&str, &'file Class),
    ) -> Result<Formula<'file>, String> {
        let (Some(ours), Some(theirs)) = (self.names.leaves(first), self.names.leaves(second)) else {
            return Err(format!("`{left}` and `{right}` have more than {MAX_ATTRIBUTES} attributes"));
        };
        self.parts += ours.len();
        if ours.is_empty() || ours.len() != theirs.len() || !ours.keys().eq(theirs.keys()) {
            return Err(format!(
                "`{left}` and `{right}` have different types (`{}` and `{}`)",
                first.name, second.name
            ));
        }
        let inside = |before: &str, path: &str| {
            let path = if before.is_empty() { path.trim_start_matches('.') } else { path };
            Symbol { path: format!("{before}{path}"), is_mode: false }
        };
        let all = ours.iter().map(|(path, domain)| Formula::Same {
            left: inside(left, path),
            right: inside(right, path),
            domain: Domain(domain),
        });
        Ok(Formula::All(all.collect()))
    }

    fn call(
        &mut self,
        path: &'file Path,
        arguments: &'file [Path],
        scope: &Scope<'file>,
    ) -> Result<Formula<'file>, String> {
        let Some((name, receiver)) = path.split_last() else {
            return Err("a call without a name".to_owned());
        };
        let unknown = || format!("unknown relation `{}`", path.join("."));
        let this = if receiver.is_empty() {
            scope.this.clone()
        } else {
            self.value(receiver, scope)?.ok_or_else(unknown)?
        };
        let mut given = Vec::new();
        for argument in arguments {
            let value = self.value(argument, scope)?;
            given.push(value.unwrap_or_else(|| Value::Constant(argument.join("."))));
        }
        let Some(relation) = self.relation(&this, name) else {
            if name == "equal" && given.len() == 1 {
                self.remark("the relation `equal`, which no file declares, is read as `=`".to_owned());
                return self.equal(this, given.swap_remove(0));
            }
            return Err(unknown());
        };
        if relation.parameters.len() != given.len() {
            return Err(format!(
                "`{name}` takes {} arguments, but has {} here",
                relation.parameters.len(),
                given.len()
            ));
        }
        if scope.depth >= MAX_DEPTH {
            return Err(format!("the relation `{name}` calls itself"));
        }
        let parameters = relation.parameters.iter().map(String::as_str).zip(given).collect();
        let inner = Scope { this, parameters, depth: scope.depth + 1 };
        self.statements(&relation.body, &inner, false)
    }

    fn relation(&self, this: &Value<'file>, name: &str) -> Option<&'file Relation> {
        let Value::Attribute { kind, .. } = this else { return None };
        let named = |relation: &&'file Relation| relation.name == name;
        match kind {
            Kind::Enum(declared) => declared.relations.iter().find(named),
            Kind::Class(class) => {
                self.names.lineage(class).into_iter().find_map(|class| class.relations.iter().find(named))
            }
        }
    }
}

fn own_scope(class: &Class) -> Scope<'_> {
    let this = Value::Attribute { path: String::new(), kind: Kind::Class(class), is_mode: false };
    Scope { this, parameters: BTreeMap::new(), depth: 0 }
}

//! Flight rules in the mission's own language (SPEC 16.1): a condition on states, activities and amounts of resources, and
//! when it has to hold.
//!
//! ```
//! let mission = rmpl::parse(
//!     "state Mast : {UP, DOWN} = DOWN; resource Battery 0..100 = 60;
//!      primitive Drive()[5,9] consumes Battery 20; scenario Day[0,60] = { Drive() }",
//! );
//! let rule = rmpl::rule::read("never Drive while Mast=UP", &mission.program(), Default::default());
//! assert!(rule.is_ok());
//! let wrong = rmpl::rule::read("Battery >= 20 at end of Dirve", &mission.program(), Default::default());
//! assert_eq!(wrong.unwrap_err()[0].message, "unknown activity `Dirve`");
//! ```

use exact::{Bound, Rational, Time};
use smol_str::SmolStr;

use crate::analysis::constant::Constants;
use crate::analysis::edit_distance_at_most;
use crate::diagnostic::{Diagnostic, Severity};
use crate::diagnostics::{arity, syntax, undefined, value};
use crate::lower::bounds::expression;
use crate::lower::condition::literal;
use crate::parser::{parse_rule, replacement};
pub use crate::program::Order;
use crate::program::{Name, Program};
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

/// A flight rule, read in view of its mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// What has to hold.
    pub holds: Formula,
    /// While what; without it, throughout.
    pub during: Option<Formula>,
    /// At which instants.
    pub moment: Moment,
}

/// A condition of a rule.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A variable has one of these values; a Boolean condition has `true`.
    Is { variable: SmolStr, values: Vec<SmolStr> },
    /// An activity is under way.
    Underway(Activity),
    /// The level of a reservoir, or what is in use of another resource, compares so with an amount.
    Amount {
        resource: SmolStr,
        /// How it compares.
        order: Order,
        amount: Rational,
    },
    /// The condition does not hold.
    Not(Box<Formula>),
    /// All of them hold.
    All(Vec<Formula>),
    /// At least one holds.
    Any(Vec<Formula>),
}

/// Activities of a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Activity {
    /// The primitive or the activity.
    pub name: SmolStr,
    /// With these arguments; otherwise with any.
    pub arguments: Option<Vec<SmolStr>>,
}

/// When a rule has to hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Moment {
    /// At every instant of the mission.
    Throughout,
    /// From one time to another, counted from the start of the mission; the other does not belong to it.
    Within {
        /// The first time.
        from: Time,
        /// The time from which on it need not hold any more.
        to: Bound,
    },
    /// When each of these activities starts; without one, when the mission does.
    Start(Option<Activity>),
    /// When each of these activities ends; without one, when the mission does.
    End(Option<Activity>),
}

/// What a mission has without declaring it (SPEC 1.4).
#[derive(Clone, Copy, Debug, Default)]
pub struct Undeclared<'a> {
    /// Variables with an open domain.
    pub variables: &'a [SmolStr],
    /// Activities that are only called, with how many arguments.
    pub activities: &'a [(SmolStr, usize)],
    /// Which places see which locations, as far as the mission asks (SPEC 10.5).
    pub sights: &'a [Sight],
}

/// The places from which a vehicle sees a location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sight {
    /// `V.at` of the vehicle.
    pub variable: SmolStr,
    pub location: SmolStr,
    pub places: Vec<SmolStr>,
}

/// Reads a rule.
///
/// # Errors
/// What is wrong with it, each with its place in `text`.
pub fn read(text: &str, program: &Program, undeclared: Undeclared<'_>) -> Result<Rule, Vec<Diagnostic>> {
    let parsed = parse_rule(text);
    let mut diagnostics = parsed.diagnostics;
    if diagnostics.iter().any(|found| found.severity == Severity::Error) {
        return Err(diagnostics);
    }
    let root = parsed.tree.root(text, 0);
    let constants = Constants::new(program);
    let mut reader = Reader { program, undeclared, constants, diagnostics: Vec::new() };
    let rule = reader.rule(root);
    diagnostics.append(&mut reader.diagnostics);
    match rule {
        Some(rule) if diagnostics.is_empty() => Ok(rule),
        _ if diagnostics.is_empty() => {
            let whole = Span::new(0, text.len() as u32);
            Err(vec![Diagnostic::error(syntax::CODE, whole, "expected a condition such as `X=V`")])
        }
        _ => Err(diagnostics),
    }
}

struct Reader<'a> {
    program: &'a Program,
    undeclared: Undeclared<'a>,
    constants: Constants,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn rule(&mut self, node: SyntaxNode<'_>) -> Option<Rule> {
        let is_never = node.own_tokens().next().is_some_and(|token| token.text == "never");
        let mut conditions = node.children().filter(|child| is_condition(child.kind()));
        let holds = self.formula(conditions.next()?)?;
        let during = match conditions.next() {
            Some(during) => Some(self.formula(during)?),
            None => None,
        };
        let moment = match node.child(SyntaxKind::Moment) {
            Some(moment) => self.moment(moment)?,
            None => Moment::Throughout,
        };
        let holds = if is_never { Formula::Not(Box::new(holds)) } else { holds };
        Some(Rule { holds, during, moment })
    }

    fn moment(&mut self, node: SyntaxNode<'_>) -> Option<Moment> {
        let words: Vec<SyntaxToken<'_>> = node.own_tokens().filter(is_name).collect();
        if words.first()?.text == "from" {
            let mut times = node.children().filter_map(|child| Some((expression(child)?, child.span())));
            let (from, to) = (times.next()?, times.next()?);
            let [from, to] = [from, to].map(|(time, span)| (self.constants.evaluate(&time, &|_| None), span));
            return match (from, to) {
                ((Some(Bound::Finite(from)), _), (Some(to), _)) if Bound::Finite(from) < to => {
                    Some(Moment::Within { from, to })
                }
                ((Some(Bound::Finite(_)), _), (Some(_), span)) => {
                    self.report(syntax::CODE, span, "the end must be after the start");
                    None
                }
                ((_, span), (Some(_), _)) | (_, (_, span)) => {
                    self.report(
                        undefined::CODE,
                        span,
                        "expected a time: a number, or a constant of the mission",
                    );
                    None
                }
            };
        }
        let is_end = words.get(1)?.text == "end";
        let of = match words.get(3) {
            Some(name) => Some(self.activity(*name, node.child(SyntaxKind::Arguments))?),
            None => None,
        };
        Some(if is_end { Moment::End(of) } else { Moment::Start(of) })
    }

    fn formula(&mut self, node: SyntaxNode<'_>) -> Option<Formula> {
        let parts = |reader: &mut Self| -> Option<Vec<Formula>> {
            let parts = node.children().filter(|child| is_condition(child.kind()));
            parts.map(|part| reader.formula(part)).collect()
        };
        match node.kind() {
            SyntaxKind::AllOf => Some(Formula::All(parts(self)?)),
            SyntaxKind::AnyOf => Some(Formula::Any(parts(self)?)),
            SyntaxKind::NotOf => Some(Formula::Not(Box::new(parts(self)?.into_iter().next()?))),
            SyntaxKind::ConditionGroup => parts(self)?.into_iter().next(),
            _ => self.atom(node),
        }
    }

    /// One literal with its negations, an activity, or an amount.
    fn atom(&mut self, node: SyntaxNode<'_>) -> Option<Formula> {
        let is_negation =
            |token: &SyntaxToken<'_>| matches!(token.kind, SyntaxKind::NotKeyword | SyntaxKind::Bang);
        let is_denied = node.own_tokens().filter(is_negation).count() % 2 == 1;
        let denied = |formula| if is_denied { Formula::Not(Box::new(formula)) } else { formula };
        let name = node.own_tokens().find(is_name);
        if let Some(order) = node.token(SyntaxKind::Order) {
            let amount = node.children().find_map(|child| Some((expression(child)?, child.span())));
            // A vehicle's own resource is a name of two parts.
            let own = node.child(SyntaxKind::Dotted).map(|own| (own.text(), own.span()));
            let name = own.or(name.map(|name| (name.text, name.span)));
            return Some(denied(self.amount(name, node.span(), order, amount)?));
        }
        let arguments = node.child(SyntaxKind::Arguments);
        if arguments.is_some() || name.is_some_and(|name| name.kind == SyntaxKind::String) {
            return Some(denied(Formula::Underway(self.activity(name?, arguments)?)));
        }
        let found = literal(node)?;
        let (variable, span) = (found.variable.text.as_str(), found.variable.span);
        if found.values.is_empty() && self.is_activity(variable) {
            let activity = Activity { name: variable.into(), arguments: None };
            let formula = Formula::Underway(activity);
            return Some(if found.negated { Formula::Not(Box::new(formula)) } else { formula });
        }
        let (variable, values) = match &found.sees {
            Some(location) => self.sight(variable, location, found.span)?,
            None => self.variable(variable, span, &found.values)?,
        };
        let formula = Formula::Is { variable, values };
        Some(if found.negated { Formula::Not(Box::new(formula)) } else { formula })
    }

    fn amount(
        &mut self,
        name: Option<(&str, Span)>,
        span: Span,
        order: SyntaxToken<'_>,
        amount: Option<(crate::program::Expr, Span)>,
    ) -> Option<Formula> {
        let resources = || self.program.resources.iter().map(|it| it.name.text.as_str());
        let Some((name, _)) = name.filter(|(name, _)| resources().any(|it| it == *name)) else {
            let (written, place) = name.unwrap_or(("this", span));
            let nearest = nearest(written, resources());
            self.unknown(format!("unknown resource `{written}`"), place, nearest);
            return None;
        };
        let (amount, place) = amount?;
        let Some(Bound::Finite(amount)) = self.constants.evaluate(&amount, &|_| None) else {
            self.report(undefined::CODE, place, "expected an amount: a number, or a constant of the mission");
            return None;
        };
        let order = Order::by_symbol(order.text);
        Some(Formula::Amount { resource: name.into(), order, amount: amount.units() })
    }

    fn is_known(&self, variable: &str) -> bool {
        self.undeclared.variables.iter().any(|it| it == variable)
    }

    fn is_activity(&self, name: &str) -> bool {
        self.activities().any(|(it, _)| it == name)
    }

    /// The primitives and activities of the mission, with how many parameters they have.
    fn activities(&self) -> impl Iterator<Item = (&str, usize)> {
        let primitives = self.program.primitives.iter();
        let primitives = primitives.map(|it| (it.name.text.as_str(), it.formals.len()));
        let activities = self.program.activities.iter();
        let activities = activities.map(|it| (it.name.text.as_str(), it.formals.len()));
        let undeclared = self.undeclared.activities.iter().map(|(name, count)| (name.as_str(), *count));
        primitives.chain(activities).chain(undeclared)
    }

    fn activity(&mut self, token: SyntaxToken<'_>, arguments: Option<SyntaxNode<'_>>) -> Option<Activity> {
        let name = unquoted(token);
        let Some((_, formals)) = self.activities().find(|(it, _)| *it == name) else {
            // Arguments may be a part of a name from elsewhere, which is spaced as it likes.
            let letters = |text: &str| text.split_whitespace().collect::<String>();
            let written = arguments.map(|arguments| letters(arguments.text()));
            let is_meant =
                |it: &str| it.strip_prefix(name).is_some_and(|rest| written == Some(letters(rest)));
            let mut meant: Vec<&str> =
                self.activities().map(|(it, _)| it).filter(|it| is_meant(it)).collect();
            meant.sort_unstable();
            meant.dedup();
            if let [known] = meant[..] {
                return Some(Activity { name: known.into(), arguments: None });
            }
            let nearest = nearest(name, self.activities().map(|(it, _)| it));
            let nearest = nearest.map(|it| if name == token.text { it } else { format!("\"{it}\"") });
            self.unknown(format!("unknown activity `{name}`"), token.span, nearest);
            return None;
        };
        let Some(arguments) = arguments else {
            return Some(Activity { name: name.into(), arguments: None });
        };
        let given: Vec<SmolStr> = arguments
            .children()
            .filter(|child| child.kind() == SyntaxKind::Argument)
            .map(|argument| SmolStr::new(argument.text().trim()))
            .collect();
        // Empty parentheses represent any arguments, too.
        if !given.is_empty() && given.len() != formals {
            let words = if formals == 1 { "argument" } else { "arguments" };
            let message = format!("`{name}` has {formals} {words}");
            self.report(arity::CODE, arguments.span(), message);
            return None;
        }
        let arguments = (!given.is_empty()).then_some(given);
        Some(Activity { name: name.into(), arguments })
    }

    /// The places of a vehicle that see a location.
    fn sight(&mut self, variable: &str, location: &Name, span: Span) -> Option<(SmolStr, Vec<SmolStr>)> {
        let mut known = self.undeclared.sights.iter();
        let found = known.find(|it| it.variable == variable && it.location == location.text);
        if let Some(sight) = found {
            return Some((sight.variable.clone(), sight.places.clone()));
        }
        let vehicles = self.program.world.vehicles.iter();
        if !vehicles.clone().any(|it| variable.strip_suffix(".at") == Some(it.name.text.as_str())) {
            self.diagnostics.push(value::sight_of_no_place(variable, span, false));
        } else if self.program.world.locations.iter().all(|it| it.name.text != location.text) {
            let names = self.program.world.locations.iter().map(|it| it.name.text.as_str());
            let nearest = nearest(&location.text, names);
            self.diagnostics.push(value::no_location(&location.text, location.span, nearest.as_deref()));
        } else {
            let message =
                format!("the mission does not require `{variable} in visible({})` anywhere", location.text);
            let hint = "a rule can use a visibility condition only if the mission requires the same one";
            self.diagnostics.push(Diagnostic::error(undefined::CODE, span, message).with_hint(hint));
        }
        None
    }

    /// The variable and the values of a literal (SPEC 1.3).
    fn variable(&mut self, written: &str, span: Span, values: &[Name]) -> Option<(SmolStr, Vec<SmolStr>)> {
        if let Some(domain) = self.domain(written) {
            if values.is_empty() && !domain.iter().any(|it| it == "true") {
                let shown: Vec<&str> = domain.iter().map(SmolStr::as_str).collect();
                self.diagnostics.push(value::no_value(written, span, &shown));
                return None;
            }
            for wrong in values.iter().filter(|it| !domain.contains(&it.text)) {
                let shown: Vec<&str> = domain.iter().map(SmolStr::as_str).collect();
                let nearest = nearest(&wrong.text, shown.iter().copied());
                let found =
                    value::outside_domain(written, &wrong.text, wrong.span, &shown, nearest.as_deref());
                self.diagnostics.push(found);
            }
            return Some((written.into(), values_of(values)));
        }
        if values.is_empty()
            && let Some((stem, last)) = written.rsplit_once('_')
            && (self.domain(stem).is_some_and(|domain| domain.iter().any(|it| it == last))
                || (!self.is_known(written) && self.is_known(stem)))
        {
            return Some((stem.into(), vec![last.into()]));
        }
        if self.is_known(written) {
            return Some((written.into(), values_of(values)));
        }
        if self.program.resources.iter().any(|it| it.name.text == written) {
            let message =
                format!("`{written}` is a resource: compare it with an amount, as in `{written} >= 20`");
            self.report(syntax::CODE, span, message);
            return None;
        }
        let declared = self.program.variables.iter().map(|it| it.name.text.as_str());
        let nearest = nearest(written, declared.chain(self.activities().map(|(it, _)| it)));
        self.unknown(format!("unknown name `{written}`"), span, nearest);
        None
    }

    /// The values that a declared variable has.
    fn domain(&self, name: &str) -> Option<Vec<SmolStr>> {
        if let Some(variable) = self.program.variables.iter().find(|it| it.name.text == name) {
            return Some(variable.values.iter().map(|it| it.text.clone()).collect());
        }
        let vehicle = name.strip_suffix(".at")?;
        let world = &self.program.world;
        world.vehicles.iter().find(|it| it.name.text == vehicle)?;
        Some(world.locations.iter().map(|it| it.name.text.clone()).collect())
    }

    fn unknown(&mut self, message: String, span: Span, nearest: Option<String>) {
        let found = Diagnostic::error(undefined::CODE, span, message);
        self.diagnostics.push(match nearest {
            Some(nearest) => found.with_hint(format!("did you mean `{nearest}`?")).with_fix(replacement(
                format!("Change to `{nearest}`"),
                span,
                nearest,
            )),
            None => found,
        });
    }

    fn report(&mut self, code: crate::Code, span: Span, message: impl Into<String>) {
        self.diagnostics.push(Diagnostic::error(code, span, message));
    }
}

/// Names of networks from elsewhere stand in quotes where they are none of this language.
const fn is_name(token: &SyntaxToken<'_>) -> bool {
    matches!(token.kind, SyntaxKind::Name | SyntaxKind::String)
}

fn unquoted(name: SyntaxToken<'_>) -> &str {
    name.text.trim_matches('"')
}

fn values_of(values: &[Name]) -> Vec<SmolStr> {
    if values.is_empty() {
        return vec!["true".into()];
    }
    values.iter().map(|it| it.text.clone()).collect()
}

/// The name that differs least from `written`, if one is alike.
fn nearest<'a>(written: &str, names: impl Iterator<Item = &'a str>) -> Option<String> {
    let alike = names.filter_map(|name| Some((edit_distance_at_most(written, name, 2)?, name)));
    alike.min().map(|(_, name)| name.to_owned())
}

const fn is_condition(kind: SyntaxKind) -> bool {
    crate::lower::condition::is_condition(kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MISSION: &str = "var Comm : {UP, DOWN}; state Mast : {OUT, IN} = IN; const LEAST = 20;
resource Battery 0..100 = 60; location Base (0, 0); location Rock (9, 9); vehicle Rover1 : ATRV at Base;
primitive Drive(to)[5,9] moves Rover1 consumes Battery 20; primitive Dig()[1,2];
scenario Day[0,60] = { Drive(Rock); Dig(), LIGHT [1,1] }";

    fn read(text: &str) -> Result<Rule, Vec<String>> {
        let program = crate::parse(MISSION).program();
        let activities = [("Wait".into(), 0), ("Go To(A)".into(), 0), ("GoTo(A)".into(), 0)];
        let sights = [Sight {
            variable: "Rover1.at".into(),
            location: "Base".into(),
            places: vec!["Base".into(), "Rock".into()],
        }];
        let undeclared =
            Undeclared { variables: &["LIGHT".into()], activities: &activities, sights: &sights };
        let rule = super::read(text, &program, undeclared);
        rule.map_err(|found| {
            found.iter().map(|it| format!("{} {}: {}", it.span.start, it.code, it.message)).collect()
        })
    }

    fn is(variable: &str, value: &str) -> Formula {
        Formula::Is { variable: variable.into(), values: vec![value.into()] }
    }

    fn underway(name: &str) -> Formula {
        Formula::Underway(Activity { name: name.into(), arguments: None })
    }

    #[test]
    fn a_rule_is_a_condition_of_the_mission() {
        let rule = read("never Drive while Mast=OUT").expect("it is one");
        assert_eq!(rule.holds, Formula::Not(Box::new(underway("Drive"))));
        assert_eq!(rule.during, Some(is("Mast", "OUT")));
        assert_eq!(rule.moment, Moment::Throughout);
        let rule = read("not (Mast=OUT or Comm in {UP, DOWN}) and LIGHT").expect("it is one");
        let Formula::All(parts) = &rule.holds else { panic!("{rule:?}") };
        assert!(matches!(&parts[0], Formula::Not(inner) if matches!(**inner, Formula::Any(_))), "{parts:?}");
        assert_eq!(parts[1], is("LIGHT", "true"));
        assert_eq!(read("never Wait").expect("one").holds, Formula::Not(Box::new(underway("Wait"))));
        assert_eq!(read("Mast_OUT").expect("it splits").holds, is("Mast", "OUT"));
        assert_eq!(read("Mast!=OUT").expect("one").holds, Formula::Not(Box::new(is("Mast", "OUT"))));
    }

    #[test]
    fn names_from_elsewhere_stand_in_quotes() {
        let go = underway("Go To(A)");
        assert_eq!(
            read("never \"Go To(A)\" while LIGHT").expect("one").holds,
            Formula::Not(Box::new(go.clone()))
        );
        let both = read("not (\"Go To(A)\" and Dig) or LIGHT").expect("it is one").holds;
        let Formula::Any(parts) = &both else { panic!("{both:?}") };
        assert_eq!(parts[0], Formula::Not(Box::new(Formula::All(vec![go, underway("Dig")]))));
        let end = read("LIGHT at end of \"Go To(A)\"").expect("it is one").moment;
        assert_eq!(end, Moment::End(Some(Activity { name: "Go To(A)".into(), arguments: None })));
        assert_eq!(read("never GoTo(A)").expect("one").holds, Formula::Not(Box::new(underway("GoTo(A)"))));
        assert_eq!(read("\"Dig\"").expect("one").holds, underway("Dig"));
        assert_eq!(read("never \"Gone(B)\""), Err(vec!["6 E-UNDEF: unknown activity `Gone(B)`".to_owned()]));
        assert!(read("\"Go To(A)").is_err(), "the quotation is not closed");
    }

    #[test]
    fn a_vehicles_own_resources_and_states_are_named_with_it() {
        let mission = "location A (0, 0); vehicle S[1..2] : M at A; scenario Day[0,9] = { delay }
            model M { resource battery 0..9 = 5; state drill : {IN, OUT} = IN; }";
        let program = crate::parse(mission).program();
        let read = |text: &str| super::read(text, &program, Undeclared::default()).expect(text).holds;
        let amount = Rational::from_integer(3);
        let level = Formula::Amount { resource: "S[2].battery".into(), order: Order::AtLeast, amount };
        assert_eq!(read("S[2].battery >= 3"), level);
        assert_eq!(
            read("(S[1].drill = IN or S[2].battery >= 3)"),
            Formula::Any(vec![is("S[1].drill", "IN"), level])
        );
        let unknown = super::read("S[1].fuel >= 3", &program, Undeclared::default());
        assert_eq!(
            unknown.map_err(|it| it[0].message.clone()),
            Err("unknown resource `S[1].fuel`".to_owned())
        );
    }

    #[test]
    fn amounts_compare_with_numbers_and_constants() {
        let amount = |order, units: i64| Formula::Amount {
            resource: "Battery".into(),
            order,
            amount: Rational::from_integer(units),
        };
        assert_eq!(read("Battery >= 20").expect("one").holds, amount(Order::AtLeast, 20));
        assert_eq!(read("Battery>LEAST").expect("one").holds, amount(Order::Above, 20));
        let both = read("(Battery <= 2*LEAST and Mast=IN) or Battery < 10 at end").expect("one");
        let Formula::Any(parts) = both.holds else { panic!("{both:?}") };
        assert_eq!(parts[0], Formula::All(vec![amount(Order::AtMost, 40), is("Mast", "IN")]));
        assert_eq!((&parts[1], both.moment), (&amount(Order::Below, 10), Moment::End(None)));
    }

    #[test]
    fn moments() {
        let moment = |text: &str| read(text).map(|rule| rule.moment);
        let drive = |arguments: Option<&str>| Activity {
            name: "Drive".into(),
            arguments: arguments.map(|it| vec![it.into()]),
        };
        assert_eq!(moment("Rover1.at=Base at end"), Ok(Moment::End(None)));
        assert_eq!(moment("Battery > 50 at start of Drive"), Ok(Moment::Start(Some(drive(None)))));
        let end = moment("Rover1.at=Rock at end of Drive(Rock)");
        assert_eq!(end, Ok(Moment::End(Some(drive(Some("Rock"))))));
        let within = Moment::Within { from: Time::from(10), to: Bound::Finite(Time::from(60)) };
        assert_eq!(moment("Mast=IN from 10 to 1h"), Ok(within));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let wrong = |text: &str| read(text).expect_err("it is wrong");
        assert_eq!(wrong("Mast=UPP"), ["5 E-VALUE: `UPP` is not a value of `Mast`"]);
        assert_eq!(wrong("Batery >= 2"), ["0 E-UNDEF: unknown resource `Batery`"]);
        assert_eq!(wrong("never Drvie"), ["6 E-UNDEF: unknown name `Drvie`"]);
        assert_eq!(wrong("Drive(Rock, 2)"), ["5 E-ARITY: `Drive` has 1 argument"]);
        assert_eq!(
            wrong("Battery"),
            ["0 E-SYNTAX: `Battery` is a resource: compare it with an amount, as in `Battery >= 20`"]
        );
        assert_eq!(wrong("Mast=IN from 9 to 3"), ["18 E-SYNTAX: the end must be after the start"]);
        for text in ["", "Mast=IN and", "Mast=IN at noon", "Mast=IN; Comm=UP", "Battery >= ", "(Mast=IN"] {
            let found = wrong(text);
            assert!(found.len() == 1 && found[0].contains("E-SYNTAX"), "{text}: {found:?}");
        }
    }

    #[test]
    fn a_rule_asks_for_what_is_in_sight_where_the_mission_does() {
        let rule = read("always (Rover1.at in visible(Base)) and LIGHT").expect("it is one");
        let Formula::All(parts) = &rule.holds else { panic!("{rule:?}") };
        let places = vec!["Base".into(), "Rock".into()];
        assert_eq!(parts[0], Formula::Is { variable: "Rover1.at".into(), values: places });
        let wrong = |text: &str| read(text).expect_err("it is wrong");
        assert_eq!(
            wrong("Rover1.at in visible(Rock)"),
            ["0 E-UNDEF: the mission does not require `Rover1.at in visible(Rock)` anywhere"]
        );
        assert_eq!(wrong("Rover1.at in visible(Bace)"), ["21 E-VALUE: unknown location `Bace`"]);
        assert_eq!(
            wrong("Mast in visible(Base)"),
            ["0 E-VALUE: `Mast` cannot be in `visible(…)`: only the place of a vehicle can, as in `V.at`"]
        );
    }

    #[test]
    fn a_mission_requires_a_level_but_does_not_assert_one() {
        let found = crate::parse("resource A 0..9 = 5; scenario S[0,9] = { A < 3 }").diagnostics();
        assert!(found.iter().any(|it| it.code.0 == "E-VALUE"), "{found:?}");
        let found = crate::parse("resource A 0..9 = 5; scenario S[0,9] = { ask A < 9 }").diagnostics();
        assert!(found.is_empty(), "{found:?}");
    }
}

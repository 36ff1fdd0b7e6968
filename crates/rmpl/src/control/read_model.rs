//! Reading the model part: classes with their fields, components, and options (SPEC 2.2).

use crate::span::Span;

use super::keyword;
use super::lexer::TokenKind;
use super::read_program::Reader;
use super::suggest::nearest;
use super::syntax::{Class, Field, FieldKind, Initial, Instance, Name, ProgramOption};
use super::tree::{List, Node};

const FIELD_KEYWORDS: [&str; 9] =
    ["VAR", "COMMAND", "PORT", "PART", "METHOD", "MODE", "TRANSITION", "FAULT", "BEHAVIOR"];

impl Reader<'_> {
    /// Reads `(DEFCLASS name (supers) fields)`.
    pub(super) fn class(&mut self, list: &List) -> Option<Class> {
        let [_, name, Node::List(supers), fields @ ..] = list.items.as_slice() else {
            self.shape(
                "E-ARITY",
                list,
                "DEFCLASS takes a name, the classes it extends in parentheses, and fields",
                "(DEFCLASS Valve () (MODE Open true))",
            );
            return None;
        };
        let name = self.required_name(name, "the name of a class")?;
        let supers = self.names(&supers.items, "the name of a class");
        let fields = fields.iter().filter_map(|field| self.field(field)).collect();
        Some(Class { name, supers, fields, span: list.span })
    }

    /// Reads `(DEFINSTANCE name class (port component)… [INIT initial])`.
    pub(super) fn instance(&mut self, list: &List) -> Option<Instance> {
        let [_, name, class, rest @ ..] = list.items.as_slice() else {
            self.shape(
                "E-ARITY",
                list,
                "DEFINSTANCE takes a name, a class, and the components at its ports",
                "(DEFINSTANCE ValveA Valve (driver DriverA) INIT Closed)",
            );
            return None;
        };
        let name = self.required_name(name, "the name of a component")?;
        let class = self.required_name(class, "the name of a class")?;
        let (ports, initial) = self.connections(rest)?;
        Some(Instance { name, class, ports, initial, span: list.span })
    }

    /// Reads what follows the class of a component: `(port component)… [INIT initial]`.
    fn connections(&mut self, rest: &[Node]) -> Option<(Vec<(Name, Name)>, Initial)> {
        let (mut ports, mut initial) = (Vec::new(), Initial::FirstMode);
        let mut rest = rest;
        while let [node, after @ ..] = rest {
            rest = after;
            match node {
                Node::List(port) => {
                    if let [port, component] = port.items.as_slice() {
                        let port = self.required_name(port, "the name of a port")?;
                        let component = self.required_name(component, "the name of a component")?;
                        ports.push((port, component));
                    } else {
                        self.shape(
                            "E-ARITY",
                            port,
                            "a port takes its name and a component",
                            "(driver DriverA)",
                        );
                    }
                }
                Node::Leaf(_) if self.is_word(node, "INIT") => {
                    let length = rest.iter().take_while(|node| matches!(node, Node::Leaf(_))).count();
                    let (given, after) = rest.split_at(length);
                    initial = self.initial(node, given);
                    rest = after;
                }
                Node::Leaf(_) => {
                    self.error("E-SYNTAX", node.span(), "expected a port `(name component)` or `INIT mode`");
                }
            }
        }
        Some((ports, initial))
    }

    /// Reads what is after `INIT`: a mode, `*`, or modes with their probabilities.
    fn initial(&mut self, init: &Node, given: &[Node]) -> Initial {
        match given {
            [] => {
                self.error("E-ARITY", init.span(), "a mode is missing after INIT");
                Initial::FirstMode
            }
            [Node::Leaf(token)] if token.kind == TokenKind::Star => Initial::AnyMode,
            [mode] => self.required_name(mode, "a mode").map_or(Initial::FirstMode, Initial::Mode),
            _ => {
                let pairs = given.chunks(2).map(|pair| self.mode_with_probability(pair));
                pairs.collect::<Option<Vec<_>>>().map_or(Initial::FirstMode, Initial::Prior)
            }
        }
    }

    fn mode_with_probability(&mut self, pair: &[Node]) -> Option<(Name, Name)> {
        let mode = self.required_name(pair.first()?, "a mode")?;
        let Some(probability) = pair.get(1) else {
            self.error("E-ARITY", mode.span, "the probability of this mode is missing").hint =
                Some("a prior reads `INIT Off 0.9 Idle 0.1`".into());
            return None;
        };
        Some((mode, self.required_name(probability, "a probability")?))
    }

    /// Reads `(DEFOPTION name value)`.
    pub(super) fn option(&mut self, list: &List) -> Option<ProgramOption> {
        let [_, name, value] = list.items.as_slice() else {
            self.shape("E-ARITY", list, "DEFOPTION takes a name and a value", "(DEFOPTION entailment 0.95)");
            return None;
        };
        let name = self.required_name(name, "the name of an option")?;
        Some(ProgramOption { name, value: self.required_name(value, "a value")? })
    }

    fn field(&mut self, node: &Node) -> Option<Field> {
        let span = node.span();
        let Node::List(list) = node else {
            self.error("E-SYNTAX", span, "expected a field in parentheses").hint = Some(field_hint());
            return None;
        };
        let Some((word, word_span)) = list.items.first().and_then(|head| keyword::word(self.text, head))
        else {
            self.error("E-FORM", span, "a field must start with its kind").hint = Some(field_hint());
            return None;
        };
        let upper = word.to_ascii_uppercase();
        let kind = match upper.as_str() {
            "VAR" => self.variable(list),
            "COMMAND" => self.command(list),
            "PORT" => self.port(list),
            "PART" => self.component_part(list),
            "METHOD" => self.method(list),
            "BEHAVIOR" => self.behavior(list),
            "MODE" => self.mode(list),
            "TRANSITION" => self.transition(list),
            "FAULT" => self.fault(list),
            _ => {
                let hint = nearest(&upper, FIELD_KEYWORDS)
                    .map_or_else(field_hint, |known| format!("did you mean {known}?"));
                self.error("E-FORM", word_span, format!("unknown kind of field `{word}`")).hint = Some(hint);
                None
            }
        }?;
        Some(Field { kind, span })
    }

    fn variable(&mut self, list: &List) -> Option<FieldKind> {
        let [_, name, Node::List(values), rest @ ..] = list.items.as_slice() else {
            self.shape(
                "E-ARITY",
                list,
                "VAR takes a name and its values in braces",
                "(VAR thrust {zero full} OBSERVABLE)",
            );
            return None;
        };
        let name = self.required_name(name, "the name of a variable")?;
        let values = self.domain(values)?;
        let mut observable = false;
        let mut shows = None;
        let mut error = None;
        let mut rest = rest.iter();
        while let Some(node) = rest.next() {
            if self.is_word(node, "OBSERVABLE") {
                observable = true;
            } else if self.is_word(node, "SHOWS") {
                match rest.next() {
                    Some(value) => shows = self.required_name(value, "a value"),
                    None => {
                        self.error("E-ARITY", node.span(), "expected a value after SHOWS");
                    }
                }
            } else if self.is_word(node, "ERROR") {
                match rest.next() {
                    Some(probability) => error = self.required_name(probability, "a probability"),
                    None => {
                        self.error("E-ARITY", node.span(), "expected a probability after ERROR");
                    }
                }
            } else {
                self.error("E-SYNTAX", node.span(), "expected OBSERVABLE, SHOWS or ERROR after the values");
            }
        }
        if let Some(error) = error.as_ref().filter(|_| !observable) {
            self.error("E-FORM", error.span, "only an observable variable can have an ERROR").hint =
                Some("write OBSERVABLE before ERROR".into());
        }
        Some(FieldKind::Variable { name, values, observable, shows, error })
    }

    fn command(&mut self, list: &List) -> Option<FieldKind> {
        let [_, name, Node::List(values)] = list.items.as_slice() else {
            self.shape(
                "E-ARITY",
                list,
                "COMMAND takes a name and its values in braces, idle value first",
                "(COMMAND cmd {none open close})",
            );
            return None;
        };
        let name = self.required_name(name, "the name of a command")?;
        Some(FieldKind::Command { name, values: self.domain(values)? })
    }

    fn port(&mut self, list: &List) -> Option<FieldKind> {
        let [_, name, class] = list.items.as_slice() else {
            self.shape("E-ARITY", list, "PORT takes a name and a class", "(PORT driver Driver)");
            return None;
        };
        let name = self.required_name(name, "the name of a port")?;
        Some(FieldKind::Port { name, class: self.required_name(class, "the name of a class")? })
    }

    fn component_part(&mut self, list: &List) -> Option<FieldKind> {
        let [_, name, class, rest @ ..] = list.items.as_slice() else {
            self.shape(
                "E-ARITY",
                list,
                "PART takes a name, a class, and the components at its ports",
                "(PART valve Valve (driver driver) INIT Closed)",
            );
            return None;
        };
        let name = self.required_name(name, "the name of a part")?;
        let class = self.required_name(class, "the name of a class")?;
        let (ports, initial) = self.connections(rest)?;
        Some(FieldKind::Part { name, class, ports, initial })
    }

    fn method(&mut self, list: &List) -> Option<FieldKind> {
        let [_, name, Node::List(parameters), body @ ..] = list.items.as_slice() else {
            self.method_shape(list);
            return None;
        };
        let [body] = Self::parts_of(body)[..] else {
            self.method_shape(list);
            return None;
        };
        let name = self.required_name(name, "the name of a method")?;
        let parameters = self.names(&parameters.items, "the name of a parameter");
        for (at, parameter) in parameters.iter().enumerate() {
            if parameters.iter().take(at).any(|earlier| earlier.text == parameter.text) {
                let message = format!("`{}` has two parameters `{}`", name.text, parameter.text);
                self.error("E-DUP", parameter.span, message);
            }
        }
        self.parameters = parameters.iter().map(|parameter| parameter.text.clone()).collect();
        let body = self.part(body);
        self.parameters.clear();
        Some(FieldKind::Method { name, parameters, body })
    }

    fn behavior(&mut self, list: &List) -> Option<FieldKind> {
        if let Some((_, body)) = list.items.split_first()
            && let [body] = Self::parts_of(body)[..]
        {
            return Some(FieldKind::Behavior(self.part(body)));
        }
        self.shape("E-ARITY", list, "BEHAVIOR takes one expression", "(BEHAVIOR (ALWAYS (light = lit)))");
        None
    }

    fn method_shape(&mut self, list: &List) {
        self.shape(
            "E-ARITY",
            list,
            "METHOD takes a name, parameters in parentheses, and one expression",
            "(METHOD shut () (self = Closed))",
        );
    }

    fn mode(&mut self, list: &List) -> Option<FieldKind> {
        let [_, name, constraint] = list.items.as_slice() else {
            self.shape("E-ARITY", list, "MODE takes a name and a constraint", "(MODE Open true)");
            return None;
        };
        let name = self.required_name(name, "the name of a mode")?;
        Some(FieldKind::Mode { name, constraint: self.constraint(constraint) })
    }

    fn transition(&mut self, list: &List) -> Option<FieldKind> {
        let [_, from, to, guard, rest @ ..] = list.items.as_slice() else {
            self.transition_shape(list);
            return None;
        };
        if rest.len() > 1 {
            self.transition_shape(list);
            return None;
        }
        let from = self.origin(from)?;
        let to = self.required_name(to, "a mode")?;
        let guard = self.constraint(guard);
        let probability = match rest.first() {
            Some(given) => Some(self.required_name(given, "a probability")?),
            None => None,
        };
        Some(FieldKind::Transition { from, to, guard, probability })
    }

    fn fault(&mut self, list: &List) -> Option<FieldKind> {
        let [_, from, to, probability, rest @ ..] = list.items.as_slice() else {
            self.fault_shape(list);
            return None;
        };
        if rest.len() > 1 {
            self.fault_shape(list);
            return None;
        }
        let from = self.origin(from)?;
        let to = self.required_name(to, "a mode")?;
        let probability = self.required_name(probability, "a probability")?;
        let guard = rest.first().map(|guard| self.constraint(guard));
        Some(FieldKind::Fault { from, to, probability, guard })
    }

    /// Reads the mode that an arc leaves: `None` for `*`.
    #[expect(clippy::option_option, reason = "unreadable, all modes, or one of them")]
    fn origin(&mut self, node: &Node) -> Option<Option<Name>> {
        match node {
            Node::Leaf(token) if token.kind == TokenKind::Star => Some(None),
            _ => self.required_name(node, "a mode or `*`").map(Some),
        }
    }

    fn transition_shape(&mut self, list: &List) {
        self.shape(
            "E-ARITY",
            list,
            "TRANSITION takes two modes, a guard, and perhaps a probability",
            "(TRANSITION Closed Open (cmd = open) 0.9)",
        );
    }

    fn fault_shape(&mut self, list: &List) {
        self.shape(
            "E-ARITY",
            list,
            "FAULT takes two modes, a probability per step, and perhaps a guard",
            "(FAULT Open Stuck 0.01)",
        );
    }

    fn domain(&mut self, list: &List) -> Option<Vec<Name>> {
        let items: Vec<Node> = list.items.clone();
        let values = self.names(&items, "a value");
        if values.is_empty() {
            self.error("E-ARITY", list.span, "a domain needs at least one value");
            return None;
        }
        for (at, value) in values.iter().enumerate() {
            if values.iter().take(at).any(|earlier| earlier.text == value.text) {
                self.error("E-DUP", value.span, format!("the value `{}` is listed twice", value.text));
                return None;
            }
        }
        Some(values)
    }

    fn names(&mut self, items: &[Node], what: &str) -> Vec<Name> {
        items
            .iter()
            .filter(|node| !matches!(node, Node::Leaf(token) if token.kind == TokenKind::Comma))
            .filter_map(|node| self.required_name(node, what))
            .collect()
    }

    fn required_name(&mut self, node: &Node, what: &str) -> Option<Name> {
        let name = self.name(node);
        if name.is_none() {
            self.error("E-SYNTAX", node.span(), format!("expected {what}"));
        }
        name
    }

    fn is_word(&self, node: &Node, upper: &str) -> bool {
        keyword::word(self.text, node).is_some_and(|(word, _)| word.eq_ignore_ascii_case(upper))
    }

    fn shape(&mut self, code: &'static str, list: &List, message: &str, example: &str) {
        let span = list.items.first().map_or(list.span, |head| Span::new(list.span.start, head.span().end));
        self.error(code, span, message).hint = Some(format!("for example `{example}`"));
    }
}

fn field_hint() -> String {
    format!("use one of {}", FIELD_KEYWORDS.join(", "))
}

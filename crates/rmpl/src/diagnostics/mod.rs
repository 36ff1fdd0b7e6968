//! The kinds of diagnostic of SPEC 1.7, one file each: what it means, an example, its fix, and how it is worded.

pub mod ambiguous;
pub mod arity;
pub mod bounds;
pub mod choice;
pub mod constraint;
pub mod contingent;
pub mod controllability;
pub mod copy;
pub mod duplicate;
pub mod encounter;
pub mod exogenous;
pub mod fleet;
pub mod form;
pub mod kind;
pub mod lex;
pub mod limit;
pub mod liveness;
pub mod map;
pub mod mixed;
pub mod model;
pub mod network;
pub mod no_scenario;
pub mod option;
pub mod plant;
pub mod probability;
pub mod recursion;
pub mod resource;
pub mod similar;
pub mod size;
pub mod slack;
pub mod support;
pub mod syntax;
pub mod together;
pub mod traverse;
pub mod undefined;
pub mod unknown_name;
pub mod unreachable;
pub mod unreadable_network;
pub mod unused;
pub mod value;
pub mod window;

use crate::explanation::Explanation;

/// Every kind of diagnostic of both notations and of compilation, errors first.
pub const EXPLANATIONS: &[&Explanation] = &[
    &lex::EXPLANATION,
    &syntax::EXPLANATION,
    &duplicate::EXPLANATION,
    &undefined::EXPLANATION,
    &arity::EXPLANATION,
    &unknown_name::EXPLANATION,
    &bounds::EXPLANATION,
    &contingent::EXPLANATION,
    &value::EXPLANATION,
    &probability::EXPLANATION,
    &ambiguous::EXPLANATION,
    &recursion::EXPLANATION,
    &no_scenario::EXPLANATION,
    &limit::EXPLANATION,
    &size::EXPLANATION,
    &resource::EXPLANATION,
    &kind::EXPLANATION,
    &model::EXPLANATION,
    &constraint::EXPLANATION,
    &form::EXPLANATION,
    &unreadable_network::EXPLANATION,
    &undefined::WARNING_EXPLANATION,
    &similar::EXPLANATION,
    &mixed::EXPLANATION,
    &choice::EXPLANATION,
    &support::EXPLANATION,
    &together::EXPLANATION,
    &window::EXPLANATION,
    &slack::EXPLANATION,
    &unused::EXPLANATION,
    &copy::EXPLANATION,
    &option::EXPLANATION,
    &controllability::EXPLANATION,
    &exogenous::EXPLANATION,
    &traverse::EXPLANATION,
    &map::EXPLANATION,
    &encounter::EXPLANATION,
    &plant::EXPLANATION,
    &liveness::EXPLANATION,
    &unreachable::EXPLANATION,
    &network::EXPLANATION,
];

/// The manual page of a code such as `E-BOUNDS`; upper and lower case are the same.
pub fn explain(code: &str) -> Option<&'static Explanation> {
    EXPLANATIONS.iter().copied().find(|explanation| explanation.code.0.eq_ignore_ascii_case(code.trim()))
}

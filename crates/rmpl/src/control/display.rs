//! Constraints and guards in the short form of traces and drawings: `(A=x AND B=y)`, `~c=on`.

use std::fmt;

use super::syntax::{Constraint, ConstraintKind, Guard};

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joined = |f: &mut fmt::Formatter<'_>, parts: &[Self], joint: &str| {
            f.write_str("(")?;
            for (at, part) in parts.iter().enumerate() {
                if at > 0 {
                    write!(f, " {joint} ")?;
                }
                write!(f, "{part}")?;
            }
            f.write_str(")")
        };
        match &self.kind {
            ConstraintKind::True => f.write_str("true"),
            ConstraintKind::False => f.write_str("false"),
            ConstraintKind::Equals { variable, value } => write!(f, "{}={}", variable.text, value.text),
            ConstraintKind::Not(inner) => write!(f, "(NOT {inner})"),
            ConstraintKind::And(parts) => joined(f, parts, "AND"),
            ConstraintKind::Or(parts) => joined(f, parts, "OR"),
            ConstraintKind::Parameter(name) => f.write_str(&name.text),
            ConstraintKind::Unreadable => f.write_str("…"),
        }
    }
}

impl fmt::Display for Guard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bar = |is_barred: bool| if is_barred { "~" } else { "" };
        match &self.held {
            None => write!(f, "{}{}", bar(self.non_entailed), self.constraint),
            Some(held) => {
                let duration = &held.duration.text;
                let inner = bar(held.non_entailed);
                write!(f, "{}(HELD {duration} {inner}{})", bar(self.non_entailed), self.constraint)
            }
        }
    }
}

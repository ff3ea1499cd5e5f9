//! Expressions as text, with the least parentheses that both languages read alike.

/// How tightly the outermost operator of an expression binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    /// `c ? a : b`
    Conditional,
    /// `||`
    Or,
    /// `&&`
    And,
    /// `<`, `<=`, `==`: WGSL gives them one level, and they do not chain.
    Comparison,
    /// `+`, `-`
    Sum,
    /// `*`, `/`
    Product,
    /// `-a`, `!a`, and numbers below zero.
    Prefix,
    /// A name, a number, a call, a member.
    Atom,
}

/// An expression.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Expression {
    /// The text.
    pub text: String,
    /// Its outermost operator.
    pub level: Level,
}

impl Expression {
    /// A name, a number, a call: nothing that ever wants parentheses.
    pub fn atom(text: impl Into<String>) -> Expression {
        Expression { text: text.into(), level: Level::Atom }
    }

    /// A number, as the shortest decimal that is read back as the same `f32` and is not beyond the largest.
    pub fn number(x: f32) -> Expression {
        let level = if x.is_sign_negative() { Level::Prefix } else { Level::Atom };
        // The shortest decimal that means the largest number is a little larger than it: Tint refuses it and ANGLE warns.
        // This one means it too and is a little smaller.
        let text = format!("{x:?}").replace("3.4028235e38", "3.4028234e38");
        Expression { text, level }
    }

    /// `name(arguments)`
    pub fn call(name: &str, arguments: &[Expression]) -> Expression {
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        Expression::atom(format!("{name}({})", arguments.join(", ")))
    }

    /// `operator a`
    pub fn prefix(operator: &str, a: &Expression) -> Expression {
        // --a would be a decrement.
        Expression { text: format!("{operator}{}", a.at_least(Level::Atom)), level: Level::Prefix }
    }

    /// `a operator b`, where operators of one level are read from the left.
    pub fn infix(a: &Expression, operator: &str, b: &Expression, level: Level) -> Expression {
        let (left, right) = match level {
            Level::Sum => (Level::Sum, Level::Product),
            Level::Product => (Level::Product, Level::Prefix),
            _ => (Level::Sum, Level::Sum),
        };
        let text = format!("{} {operator} {}", a.at_least(left), b.at_least(right));
        Expression { text, level }
    }

    /// `a && b` or `a || b`: WGSL has no order between the two, so either in the other wants parentheses.
    pub fn logical(a: &Expression, operator: &str, b: &Expression, level: Level) -> Expression {
        let left = if a.level == level { a.text.clone() } else { a.at_least(Level::Comparison) };
        Expression { text: format!("{left} {operator} {}", b.at_least(Level::Comparison)), level }
    }

    /// `a.members`
    pub fn member(a: &Expression, members: &str) -> Expression {
        Expression::atom(format!("{}.{members}", a.at_least(Level::Atom)))
    }

    /// The text, in parentheses if it binds less tightly.
    pub fn at_least(&self, level: Level) -> String {
        if self.level >= level { self.text.clone() } else { format!("({})", self.text) }
    }
}

#[cfg(test)]
mod tests {
    use super::{Expression, Level};

    #[test]
    fn numbers() {
        let cases = [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (-2.5, "-2.5"),
            (0.1, "0.1"),
            (1e20, "1e20"),
            (1e-7, "1e-7"),
            (16777216.0, "16777216.0"),
            (f32::MAX, "3.4028234e38"),
            (f32::MIN, "-3.4028234e38"),
        ];
        for (x, text) in cases {
            assert_eq!(Expression::number(x).text, text);
            assert_eq!(text.parse(), Ok(x));
            assert!(text.parse::<f64>().unwrap().abs() <= f64::from(f32::MAX), "{text} overflows");
        }
    }

    #[test]
    fn parentheses() {
        let [a, b, c] = ["a", "b", "c"].map(Expression::atom);
        let sum = Expression::infix(&a, "+", &b, Level::Sum);
        let product = Expression::infix(&a, "*", &b, Level::Product);
        let less = Expression::infix(&sum, "<", &product, Level::Comparison);
        let both = Expression::logical(&less, "&&", &c, Level::And);
        let cases = [
            (Expression::infix(&sum, "-", &sum, Level::Sum), "a + b - (a + b)"),
            (Expression::infix(&product, "/", &product, Level::Product), "a * b / (a * b)"),
            (Expression::infix(&sum, "*", &c, Level::Product), "(a + b) * c"),
            (Expression::infix(&product, "+", &product, Level::Sum), "a * b + a * b"),
            (Expression::prefix("-", &Expression::prefix("-", &a)), "-(-a)"),
            (Expression::prefix("-", &Expression::number(-1.0)), "-(-1.0)"),
            (Expression::infix(&a, "*", &Expression::number(-1.0), Level::Product), "a * -1.0"),
            (both.clone(), "a + b < a * b && c"),
            (Expression::logical(&both, "&&", &c, Level::And), "a + b < a * b && c && c"),
            (
                Expression::logical(&both, "||", &both, Level::Or),
                "(a + b < a * b && c) || (a + b < a * b && c)",
            ),
            (Expression::infix(&less, "==", &less, Level::Comparison), "(a + b < a * b) == (a + b < a * b)"),
            (Expression::member(&sum, "xz"), "(a + b).xz"),
            (Expression::call("f", &[sum, less]), "f(a + b, a + b < a * b)"),
        ];
        for (expression, text) in cases {
            assert_eq!(expression.text, text);
        }
    }
}

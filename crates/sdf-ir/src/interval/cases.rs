//! Runs by cases: where a step, a comparison or an angle has two answers over a region, each is taken by itself.
//!
//! An interval that holds two neighbouring whole numbers says nothing of what both have in common: a cell's number that
//! is 3 or 4 puts a copy anywhere from the place of the third to that of the fourth. One run for each answer, and the
//! hull of their results, puts it at either place.

use super::bounds::Bounds;
use super::domain::Domain;
use super::number::Interval;
use crate::program::{Binary, Node, Unary, Value};
use std::f64::consts::PI;

/// The answers that one run takes, in the order in which they are asked for.
#[derive(Debug, Clone)]
pub(crate) struct Cases {
    answers: Vec<bool>,
    next: usize,
    /// Beyond so many nothing is taken apart.
    most: usize,
}

impl Cases {
    /// For the first run.
    pub fn new(most: usize) -> Cases {
        Cases { answers: Vec::new(), next: 0, most }
    }

    /// Goes on to the next run; says whether there is one.
    pub fn advance(&mut self) -> bool {
        while self.answers.last() == Some(&true) {
            self.answers.pop();
        }
        self.next = 0;
        match self.answers.last_mut() {
            Some(answer) => {
                *answer = true;
                true
            }
            None => false,
        }
    }

    /// What a node computes in this run; `at` says where its operands lie.
    pub fn answer<D: Domain>(&mut self, node: Node, computed: D, at: impl Fn(Value) -> Bounds) -> D {
        let bounds = computed.bounds();
        match node {
            Node::Unary(Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc, _) => {
                let mut parts = [Interval::ZERO; 3];
                let mut is_split = false;
                for (part, whole) in parts.iter_mut().zip(bounds.parts()) {
                    *part = *whole;
                    if whole.hi - whole.lo == 1.0
                        && let Some(answer) = self.decide()
                    {
                        let number = if answer { whole.hi } else { whole.lo };
                        *part = if number == 0.0 { Interval::ZERO } else { Interval::point(number) };
                        is_split = true;
                    }
                }
                if is_split { D::steady(&Bounds::vector(&parts[..bounds.size()])) } else { computed }
            }
            Node::Binary(Binary::Less | Binary::LessEqual | Binary::Equal, ..)
                if bounds.decided().is_none() =>
            {
                match self.decide() {
                    Some(answer) => D::steady(&Bounds::bool(Some(answer))),
                    None => computed,
                }
            }
            Node::Binary(Binary::Atan2, y, x) if at(x).number().hi < 0.0 => {
                let sides = turns(at(y).number(), &at(x));
                match sides.and_then(|sides| self.decide().map(|answer| sides[usize::from(answer)])) {
                    Some(side) => D::steady(&Bounds::float(side)),
                    None => computed,
                }
            }
            _ => computed,
        }
    }

    fn decide(&mut self) -> Option<bool> {
        if self.next == self.answers.len() {
            if self.next == self.most {
                return None;
            }
            self.answers.push(false);
        }
        self.next += 1;
        Some(self.answers[self.next - 1])
    }
}

/// The angles of points to the left of the origin, those below the axis and those above it; nothing if they all are on one
/// side.
fn turns(y: Interval, x: &Bounds) -> Option<[Interval; 2]> {
    if y.lo >= 0.0 || y.hi <= 0.0 {
        return None;
    }
    let least = f64::from_bits(1);
    let angles = |y: Interval| Bounds::binary(Binary::Atan2, &Bounds::float(y), x, false).number();
    let half = Interval::point(PI).widened();
    Some([
        angles(Interval::new(y.lo, -least)).hull(half.negated()),
        angles(Interval::new(least, y.hi)).hull(half),
    ])
}

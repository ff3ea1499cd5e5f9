//! What is known of a value over a region: where its components lie, and how long it is.

use super::number::Interval;
use crate::constant::Constant;
use crate::number::LARGEST;
use crate::program::Type;

/// What is known of a value over a region: an interval for each component, one for its Euclidean length, and for a
/// vec3 one for the length of each pair of components. A truth value is 0 or 1.
///
/// The lengths are those of the vector in exact arithmetic, and say more than the components do where a rotation
/// keeps them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    ty: Type,
    parts: [Interval; 3],
    length: Interval,
    /// The length of the two components that are not this one.
    across: [Interval; 3],
}

impl Bounds {
    /// A truth value that is known, or is not.
    pub fn bool(x: Option<bool>) -> Bounds {
        Bounds::of(Type::Bool, &[Interval::of_bool(x)])
    }

    /// A float.
    pub fn float(x: Interval) -> Bounds {
        Bounds::of(Type::Float, &[x])
    }

    /// A float, vec2 or vec3 whose components are these.
    pub fn vector(parts: &[Interval]) -> Bounds {
        Bounds::of(Type::of_size(parts.len()), parts)
    }

    /// The box from one corner to the other.
    pub fn between(lo: [f64; 3], hi: [f64; 3]) -> Bounds {
        Bounds::vector(&std::array::from_fn::<_, 3, _>(|i| Interval::new(lo[i], hi[i])))
    }

    /// One value alone.
    pub fn constant(c: Constant) -> Bounds {
        match c {
            Constant::Bool(x) => Bounds::bool(Some(x)),
            _ => {
                let mut parts = [Interval::ZERO; 3];
                for (part, x) in parts.iter_mut().zip(c.components()) {
                    *part = Interval::point(*x);
                }
                Bounds::vector(&parts[..c.components().len()])
            }
        }
    }

    /// Any value of the type.
    pub fn anything(ty: Type) -> Bounds {
        match ty {
            Type::Bool => Bounds::bool(None),
            _ => Bounds::vector(&[Interval::ALL; 3][..ty.size()]),
        }
    }

    pub(crate) fn of(ty: Type, components: &[Interval]) -> Bounds {
        let mut parts = [Interval::ZERO; 3];
        parts[..components.len()].copy_from_slice(components);
        let unknown = Interval::NOT_NEGATIVE;
        let mut bounds = Bounds { ty, parts, length: unknown, across: [unknown; 3] };
        bounds.settle();
        bounds
    }

    /// The type of the value.
    pub fn ty(&self) -> Type {
        self.ty
    }

    /// How many components there are.
    pub fn size(&self) -> usize {
        self.ty.size()
    }

    /// A component; a float stands for a vector of equal components.
    pub fn part(&self, i: usize) -> Interval {
        self.parts[if self.size() == 1 { 0 } else { i }]
    }

    /// All components.
    pub fn parts(&self) -> &[Interval] {
        &self.parts[..self.size()]
    }

    /// The float's interval, or that of the first component.
    pub fn number(&self) -> Interval {
        self.parts[0]
    }

    /// The Euclidean length; of a float its magnitude.
    pub fn length(&self) -> Interval {
        self.length
    }

    /// The length of the two components of a vec3 that are not component `i`: the distance from that axis.
    pub fn across(&self, i: usize) -> Interval {
        self.across[i]
    }

    /// The truth value, where it is known.
    pub fn decided(&self) -> Option<bool> {
        self.parts[0].decided()
    }

    /// Whether it is one value alone.
    pub fn is_point(&self) -> bool {
        self.parts().iter().all(|x| x.is_point())
    }

    /// Whether all components have bounds.
    pub fn is_finite(&self) -> bool {
        self.parts().iter().all(|x| x.is_finite())
    }

    /// Whether the value is among those, its lengths included.
    pub fn contains(&self, c: Constant) -> bool {
        match c {
            Constant::Bool(x) => self.ty == Type::Bool && self.parts[0].contains(f64::from(x)),
            _ => {
                let x = c.components();
                let length =
                    |x: &[f64]| Interval::point(x.iter().fold(0.0f64, |sum, x| sum.hypot(*x))).widened();
                let meets = |a: Interval, b: Interval| a.lo <= b.hi && b.lo <= a.hi;
                self.ty == c.ty()
                    && self.parts().iter().zip(x).all(|(part, x)| part.contains(*x))
                    && meets(self.length, length(x))
                    && (x.len() < 3
                        || (0..3).all(|i| meets(self.across[i], length(&[x[(i + 1) % 3], x[(i + 2) % 3]]))))
            }
        }
    }

    /// The same value, when its length is also known to be this.
    pub fn with_length(mut self, length: Interval) -> Bounds {
        self.length = self.length.intersect(length);
        self.settle();
        self
    }

    /// The same vec3, when the length of the components beside `i` is also known to be this.
    pub fn with_across(mut self, i: usize, length: Interval) -> Bounds {
        self.across[i] = self.across[i].intersect(length);
        self.settle();
        self
    }

    /// The same value, when it is also known to be among these.
    pub fn intersect(mut self, other: &Bounds) -> Bounds {
        for i in 0..self.size() {
            self.parts[i] = self.parts[i].intersect(other.parts[i]);
        }
        self.with_lengths_of(other)
    }

    /// A vector that is as long as another, altogether and in its pairs.
    pub(crate) fn with_lengths_of(mut self, other: &Bounds) -> Bounds {
        self.length = self.length.intersect(other.length);
        for i in 0..3 {
            self.across[i] = self.across[i].intersect(other.across[i]);
        }
        self.settle();
        self
    }

    /// The same vec3, when component `i` is also known to be this.
    pub(crate) fn with_part(mut self, i: usize, part: Interval) -> Bounds {
        self.parts[i] = self.parts[i].intersect(part);
        self.settle();
        self
    }

    /// All values of both.
    pub fn hull(&self, other: &Bounds) -> Bounds {
        let each = |a: [Interval; 3], b: [Interval; 3]| std::array::from_fn(|i| a[i].hull(b[i]));
        Bounds {
            ty: self.ty,
            parts: each(self.parts, other.parts),
            length: self.length.hull(other.length),
            across: each(self.across, other.across),
        }
    }

    /// Lets the components and the lengths tell each other what they know.
    fn settle(&mut self) {
        match self.ty {
            Type::Bool | Type::Float => self.length = self.parts[0].magnitude(),
            Type::Vec2 => {
                self.length = self.length.intersect(length_of(&self.parts[..2]));
                let most = Interval::symmetric(self.length.hi);
                for part in &mut self.parts[..2] {
                    *part = part.intersect(most);
                }
            }
            Type::Vec3 => self.settle_vec3(),
        }
    }

    fn settle_vec3(&mut self) {
        let squares = self.parts.map(Interval::squared);
        let mut square = self.length.squared().intersect(squares[0].plus(squares[1]).plus(squares[2]));
        for i in 0..3 {
            let pair = squares[(i + 1) % 3].plus(squares[(i + 2) % 3]);
            let rest = square.minus(squares[i]);
            let pair = self.across[i].squared().intersect(pair).intersect(rest);
            self.across[i] = self.across[i].intersect(pair.root());
            square = square.intersect(pair.plus(squares[i]));
        }
        self.length = self.length.intersect(square.root());
        for i in 0..3 {
            let most = self.across[(i + 1) % 3].hi.min(self.across[(i + 2) % 3].hi).min(self.length.hi);
            self.parts[i] = self.parts[i].intersect(Interval::symmetric(most));
        }
    }
}

/// The length of a vector of these components.
pub(crate) fn length_of(parts: &[Interval]) -> Interval {
    let mut square = Interval { lo: 0.0, hi: 0.0 };
    for part in parts {
        square = square.plus(part.squared());
    }
    let root = square.root();
    Interval { lo: root.lo + 0.0, hi: root.hi }
}

/// What the operation `Length` makes of a length: it saturates, and squares that are too small for an `f64` are lost.
pub(crate) fn computed_length(length: Interval) -> Interval {
    let Interval { lo, hi } = length.widened();
    let lost = 1e-161;
    let lo = if lo < 1e-140 { (lo - lost).max(0.0) } else { lo.min(LARGEST) };
    let hi = if length.hi == 0.0 {
        0.0
    } else if hi < 1e-140 {
        hi + lost
    } else {
        hi.min(LARGEST)
    };
    // A length is never -0.
    Interval { lo: lo + 0.0, hi }
}

//! Vectors of space, in `f64`.

/// A vector, a point or a colour.
pub type Vector = [f64; 3];

/// The sum.
pub fn plus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k])
}

/// The difference.
pub fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

/// A vector drawn longer.
pub fn times(a: Vector, by: f64) -> Vector {
    a.map(|x| x * by)
}

/// The products of the components.
pub fn scaled(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] * b[k])
}

/// The scalar product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// The vector product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length.
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length 1 in the same direction.
pub fn unit(a: Vector) -> Vector {
    times(a, 1.0 / length(a))
}

/// What lies between two, `share` of the way.
pub fn mixed(a: Vector, b: Vector, share: f64) -> Vector {
    plus(a, times(minus(b, a), share))
}

/// The largest difference of components.
pub fn difference(a: Vector, b: Vector) -> f64 {
    minus(a, b).into_iter().fold(0.0, |most, x| x.abs().max(most))
}

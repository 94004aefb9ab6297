//! Values in the attributes of a result.

/// A value in the attributes of a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Text.
    Text(String),
    /// Finite number.
    Number(f64),
}

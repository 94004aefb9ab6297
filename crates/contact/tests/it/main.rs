//! Integration tests in one binary: linking dozens of them takes longer than running them.

mod family;
mod film;
mod friction;
mod johnson;
mod lubricant;
mod reference;
mod restitution;
mod series;
mod validation_impact;

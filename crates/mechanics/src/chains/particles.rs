//! The particle chain: point masses at the rollers, joined by spring-damper links.

pub(crate) mod springs;

//! Chains as a family: one folder a member.

pub(crate) mod links;
pub(crate) mod particles;

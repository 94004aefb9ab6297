//! Integration tests in one binary: linking dozens of them takes longer than running them.

mod allocations;
mod articulation;
mod clashes;
mod instruction_sets;
mod linkages;
mod loads;
mod marine;
mod marine_statics;
mod modes_of_links;
mod oil;
mod pieces;
mod plucked;
mod points;
mod several_chains;
mod strands;

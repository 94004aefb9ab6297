//! Narrower registers than the widest of the processor.

use chaindrive_integrate::{InstructionSet, Registers};
use chaindrive_validation::run_again;

/// All tests of this program hold on the next narrower set of registers.
#[test]
fn all_of_it_holds_on_narrower_registers() {
    again(1);
}

#[test]
#[ignore = "takes as long again; `make validation` runs it"]
fn all_of_it_holds_on_all_narrower_registers() {
    again(usize::MAX);
}

/// Runs all other tests on so many narrower sets, the widest first.
fn again(sets: usize) {
    let own = Registers::in_use().set();
    let mut narrower: Vec<_> = InstructionSet::available()
        .filter(|set| *set < own)
        .collect();
    narrower.sort_by_key(|set| std::cmp::Reverse(*set));
    for set in narrower.into_iter().take(sets) {
        run_again("narrower_registers", InstructionSet::VARIABLE, set.name());
    }
}

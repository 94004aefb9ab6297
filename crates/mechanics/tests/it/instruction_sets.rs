//! Narrower registers than the widest of the processor.

use chaindrive_integrate::{InstructionSet, Registers};
use chaindrive_validation::run_again;

/// All tests of this program hold on every narrower set of registers.
#[test]
fn all_of_it_holds_on_narrower_registers() {
    let own = Registers::in_use().set();
    for set in InstructionSet::available().filter(|set| *set < own) {
        let but = "all_of_it_holds_on_narrower_registers";
        run_again(but, InstructionSet::VARIABLE, set.name());
    }
}

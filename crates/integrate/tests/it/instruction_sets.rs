//! Narrower registers than the widest of the processor.

use chaindrive_integrate::InstructionSet;
use chaindrive_validation::run_again;

#[test]
#[ignore = "a study: all tests of this program on all sets; on the next one kernels and a drive of `mechanics` are held"]
fn all_of_it_holds_on_all_narrower_registers() {
    let sets = InstructionSet::narrower().map(InstructionSet::name);
    run_again(&[], "narrower_registers", InstructionSet::VARIABLE, sets);
}

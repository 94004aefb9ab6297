//! Narrower registers than the widest of the processor.

use chaindrive_integrate::InstructionSet;
use chaindrive_validation::run_again;

/// All tests of this program hold on the next narrower set of registers.
#[test]
fn all_of_it_holds_on_narrower_registers() {
    let sets = InstructionSet::narrower().take(1);
    run_again(
        "narrower_registers",
        InstructionSet::VARIABLE,
        sets.map(InstructionSet::name),
    );
}

#[test]
#[ignore = "takes as long again; `make validation` runs it"]
fn all_of_it_holds_on_all_narrower_registers() {
    let sets = InstructionSet::narrower();
    run_again(
        "narrower_registers",
        InstructionSet::VARIABLE,
        sets.map(InstructionSet::name),
    );
}

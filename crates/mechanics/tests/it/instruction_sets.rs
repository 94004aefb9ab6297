//! Narrower registers than the widest of the processor.

use chaindrive_integrate::InstructionSet;
use chaindrive_validation::run_again;

/// One drive holds on the next narrower set of registers; its kernels are held in the library.
#[test]
fn a_drive_holds_on_narrower_registers() {
    on_narrower(&["several_chains"], 1);
}

#[test]
#[ignore = "a study: all tests of this program on all sets"]
fn all_of_it_holds_on_all_narrower_registers() {
    on_narrower(&[], usize::MAX);
}

fn on_narrower(only: &[&str], most: usize) {
    let sets = InstructionSet::narrower().take(most);
    let names = sets.map(InstructionSet::name);
    run_again(only, "narrower_registers", InstructionSet::VARIABLE, names);
}

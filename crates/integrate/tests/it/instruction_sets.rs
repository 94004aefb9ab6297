//! Narrower registers than the widest of the processor.

use chaindrive_integrate::{InstructionSet, Registers};

/// What lowers the instruction set lowers it for all tests of this program: they run again on every narrower one.
#[test]
fn all_of_it_holds_on_narrower_registers() {
    let own = Registers::in_use().set();
    for set in InstructionSet::available().filter(|set| *set < own) {
        let again = std::process::Command::new(std::env::current_exe().unwrap())
            .env(InstructionSet::VARIABLE, set.name())
            .args(["--skip", "all_of_it_holds_on_narrower_registers"])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&again.stdout);
        assert!(again.status.success(), "{set}: {told}");
        assert!(told.contains("test result: ok."), "{set}: {told}");
    }
}

//! Loads a unit and steps it: `importer UNIT.fmu INPUT OUTPUT`, with value references.
//!
//! Ten steps of 0.1 ms, the input at k in the k-th; the output after each is printed as the number of its bits.

use std::path::Path;

use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;

const STEPS: u32 = 10;
const STEP: f64 = 1e-4;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, input, output] = arguments.as_slice() else {
        panic!("importer UNIT.fmu INPUT OUTPUT");
    };
    let [input, output] = [input, output].map(|it| it.parse().expect("a value reference"));
    match FMU3Builder::new(&Path::new(path)) {
        Ok(unit) => three(&unit, input, output),
        Err(_) => two(path, input, output),
    }
}

fn three(unit: &FMU3Builder, input: u32, output: u32) {
    let ok = |status| assert_eq!(status, fmi3Status::Ok);
    let drive = unit.instantiate_cs("drive").expect("an instance");
    ok(drive.enterInitializationMode(None, 0.0, None));
    ok(drive.exitInitializationMode());
    let mut time = 0.0;
    for k in 0..STEPS {
        ok(drive.setFloat64(&[input], &[f64::from(k)]));
        let (mut event, mut end, mut early, mut reached) = (true, true, true, 0.0);
        let status = drive.doStep(
            time,
            STEP,
            false,
            &mut event,
            &mut end,
            &mut early,
            &mut reached,
        );
        ok(status);
        time += STEP;
        assert_eq!((event, end, early, reached), (false, false, false, time));
        let mut value = [0.0];
        ok(drive.getFloat64(&[output], &mut value));
        println!("{}", value[0].to_bits());
    }
    ok(drive.terminate());
}

fn two(path: &str, input: u32, output: u32) {
    let ok = |status| assert_eq!(status, fmi2Status::Ok);
    let unit = FMU2Builder::new(&Path::new(path)).expect("a unit of FMI 2 or 3");
    let drive = unit.instantiate_cs("drive").expect("an instance");
    ok(drive.setupExperiment(None, 0.0, None));
    ok(drive.enterInitializationMode());
    ok(drive.exitInitializationMode());
    let mut time = 0.0;
    for k in 0..STEPS {
        ok(drive.setReal(&[input], &[f64::from(k)]));
        ok(drive.doStep(time, STEP, 0));
        time += STEP;
        let mut value = [0.0];
        ok(drive.getReal(&[output], &mut value));
        println!("{}", value[0].to_bits());
    }
    ok(drive.terminate());
}

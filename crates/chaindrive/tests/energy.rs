//! The energy ledger of the marine drive: every joule is accounted for.

use std::error::Error;

use chaindrive::{Run, Scene, Simulation, Summary};

/// Largest residual and energy supplied \[J\] of a run of the marine drive.
fn ledger(run: &Run) -> Result<(f64, f64), Box<dyn Error>> {
    let drive = Scene::preset("marine_engine")?.drive()?;
    let mut simulation = Simulation::start(&drive, run)?;
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample()? {
        summary.push(sample);
    }
    Ok((summary.residual.abs(), summary.energy_supplied()))
}

/// Theory: the ledger of an exact motion closes; what is left is the error of the time stepping.
/// At the reference setting it is below 1e-5 of the energy supplied over one second.
#[test]
fn the_reference_run_accounts_for_its_energy() -> Result<(), Box<dyn Error>> {
    let (residual, supplied) = ledger(&Run::reference(1.0, 1e-2))?;
    let share = residual / supplied;
    println!("residual {residual:.3e} J of {supplied:.4e} J: {share:.2e}");
    // 5 kN m at 13.3 rad/s for a second
    assert!(supplied > 6e4, "{supplied}");
    assert!(share < 1e-5, "{residual} of {supplied}");
    Ok(())
}

/// Theory: Verlet and its trapezoidal ledger are of second order, so a quarter of the step leaves a
/// sixteenth of the residual.
#[test]
fn the_residual_of_verlet_falls_with_the_square_of_the_step() -> Result<(), Box<dyn Error>> {
    let at = |step: f64| {
        let run = Run {
            until: 0.05,
            every: 1e-3,
            step: Some(step),
            ..Run::default()
        };
        ledger(&run).map(|(residual, _)| residual)
    };
    let (coarse, fine) = (at(4e-6)?, at(1e-6)?);
    let order = (coarse / fine).log2() / 2.0;
    println!("residual {coarse:.3e} J at 4 µs, {fine:.3e} J at 1 µs: order {order:.2}");
    assert!((order - 2.0).abs() < 0.3, "{order}");
    Ok(())
}

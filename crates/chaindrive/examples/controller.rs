//! A controller at 1 kHz speeds a crank up by its torque and holds it: `cargo run --release --example controller`.

use std::f64::consts::TAU;
use std::io::Write;

use chaindrive::{Channel, Control, Run, Scene, Simulation};

/// Time between two looks \[s\].
const PERIOD: f64 = 1e-3;
/// Speed that is wanted \[rad/s\], clockwise.
const WANTED: f64 = -100.0 * TAU / 60.0;
/// Gain \[N m s\] and integral gain \[N m\].
const GAINS: [f64; 2] = [3e4, 3e5];
/// Torque at most \[N m\].
const LARGEST: f64 = 60e3;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::preset("marine_two_sprockets")?
        .without("sprockets.crank.motion")?
        .replace("sprockets.crank.inertia", "500 kg m^2")?;
    let mut simulation = Simulation::start(&scene.drive()?, &Run::default())?;
    let crank = Control::Torque("crank".into());
    let mut view = simulation.view(&[Channel::SprocketSpeed])?;
    let mut integral = 0.0;
    for period in 0..60 {
        simulation.move_to(f64::from(period) * PERIOD, &|| false)?;
        simulation.read_into(&mut view);
        let speed = view.values(0)[0];
        let error = WANTED - speed;
        let torque = GAINS[0] * error + GAINS[1] * integral;
        // Not while the torque is at its limit.
        if torque.abs() < LARGEST {
            integral += error * PERIOD;
        }
        let torque = torque.clamp(-LARGEST, LARGEST);
        simulation.set(&crank, torque)?;
        if period % 10 == 0 {
            let rpm = speed * 60.0 / TAU;
            writeln!(
                std::io::stdout(),
                "{period:3} ms  {rpm:7.1} rpm  {torque:8.0} N m"
            )?;
        }
    }
    Ok(())
}

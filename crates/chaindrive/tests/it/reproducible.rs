//! The same binary and scene give the same bits.

use std::error::Error;

use chaindrive::{Channel, Recording, Run, Scene, Simulation};

fn record(every: f64) -> Result<Recording, Box<dyn Error>> {
    let drive = Scene::preset("marine_engine")?.drive()?;
    let run = Run {
        until: 0.02,
        every,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run)?;
    let channels = [Channel::LinkTension, Channel::ContactForce];
    let mut recording = Recording::new(&channels, simulation.system());
    while let Some(sample) = simulation.next_sample()? {
        recording.push(sample);
    }
    Ok(recording)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn two_runs_agree_to_the_bit() -> Result<(), Box<dyn Error>> {
    let (first, second) = (record(1e-3)?, record(1e-3)?);
    for (a, b) in first.columns.iter().zip(&second.columns) {
        assert_eq!(bits(&a.values), bits(&b.values), "{}", a.channel.name());
    }
    Ok(())
}

/// Samples are interpolated between steps: asking for more of them moves nothing.
#[test]
fn recording_does_not_change_the_motion() -> Result<(), Box<dyn Error>> {
    let (coarse, fine) = (record(1e-3)?, record(2.5e-4)?);
    for (a, b) in coarse.columns.iter().zip(&fine.columns) {
        for (i, row) in a.values.chunks(a.width).enumerate() {
            let same = &b.values[4 * i * b.width..][..b.width];
            assert_eq!(bits(row), bits(same), "{} at sample {i}", a.channel.name());
        }
    }
    Ok(())
}

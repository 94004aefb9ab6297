//! Samples hold what a record asks for, and no more.

use std::convert::Infallible;

use chaindrive::record::{End, Provenance, Sink};
use chaindrive::{
    Channel, Memory, Report, Request, Scene, SettingValue, Settings, Simulation, execute,
};

use crate::live::{loose, preset};
use crate::run_in::{channel, ran};
use crate::two_sprockets::SOFT;

/// One channel or two of every kind of reading.
const ALONE: [&str; 8] = [
    "contact_force,link_tension",
    "span_tension",
    "contacts,contact_depth",
    "roller_x,sprocket_torque",
    "roller_vy",
    "energy_residual,energy_stores",
    "joint_force,joint_angle",
    "strand_tension_max",
];

fn recorded(scene: &Scene, settings: [(&str, &str); 3], names: &str) -> (Report, Memory) {
    ran(scene, &[&settings[..], &[("record", names)]].concat())
}

/// Other channels of a record change no bit of a channel, even where the run-in becomes the record.
#[test]
fn a_channel_is_the_same_alone_and_among_all() {
    let short = [("until", "1 ms"), ("every", "50 us"), ("run_in", "0 s")];
    let after = [("until", "50 ms"), ("every", "1 ms"), ("run_in", "auto")];
    let cases: [(fn() -> Scene, _); 5] = [
        (|| preset("industrial_16b"), short),
        (|| preset("timing_drive"), short),
        (|| preset("bicycle_crank"), short),
        (loose, short),
        (|| SOFT.scene(), after),
    ];
    for (scene, settings) in cases {
        let scene = scene();
        let (report, all) = recorded(&scene, settings, "all");
        let system = report.simulation.system();
        let is_there = |name: &&str| Channel::from_name(name).unwrap().is_of(system);
        let mut compared = 0;
        for names in ALONE.map(|names| names.split(',').filter(is_there).collect::<Vec<_>>()) {
            if names.is_empty() {
                continue;
            }
            let (_, few) = recorded(&scene, settings, &names.join(","));
            for name in names {
                let wanted = Channel::from_name(name).unwrap();
                let [few, all] = [&few, &all].map(|memory| channel(memory, wanted));
                assert!(few.len() >= 20 && few.len() == all.len(), "{name}");
                let is_same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
                assert!(few.iter().zip(all).all(is_same), "{name}");
                compared += 1;
            }
        }
        assert!(compared >= 9, "{compared} channels");
    }
}

/// Looks at every sample but the last.
#[derive(Default)]
struct Looking {
    samples: usize,
    empty: bool,
}

impl Sink for Looking {
    type Error = Infallible;

    fn begin(&mut self, _: &Simulation, _: &[Channel], _: &Provenance) -> Result<(), Infallible> {
        self.empty = true;
        Ok(())
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), Infallible> {
        let sample = simulation.observation();
        assert!(!sample.roller_x.is_empty() && !sample.contact_force.is_empty());
        if sample.time < 0.9e-3 {
            let unwanted = [&sample.roller_vx, &sample.strand_tension_max];
            self.empty &= unwanted.iter().all(|list| list.is_empty());
            self.samples += 1;
        }
        Ok(())
    }

    fn end(&mut self, _: &End<'_>) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn nobody_pays_for_channels_that_are_not_asked_for() {
    let settings = [("until", "1 ms"), ("every", "0.1 ms"), ("run_in", "0 s")];
    let settings = settings
        .iter()
        .fold(Settings::default(), |all, (key, value)| {
            all.with(key, SettingValue::Text((*value).to_owned()))
        });
    let scene = Scene::preset("industrial_16b").unwrap();
    let request = Request::new(&scene, &settings).unwrap().without_estimate();
    let mut sink = Looking::default();
    execute(&request, &mut sink, &|| false).unwrap();
    assert!(sink.empty && sink.samples == 9, "{} samples", sink.samples);
}

//! Limits of a real drive that a run exceeds, and requests that were probably not meant.

use chaindrive_contact::dissipation::FASTEST_IMPACT;
use chaindrive_mechanics::BodyImpacts;

use super::{DRIVES, LEAST_SAMPLES, MATTERS, Reason};
use crate::rating::Load;
use crate::summary::Ledger;
use crate::{Simulation, Summary};

/// Reasons against a run from the duty that it asks of the drive.
pub(super) fn found(summary: &Summary, simulation: &Simulation) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let loads = summary.carried();
    reasons.extend(loads.iter().filter_map(broken));
    reasons.extend(loads.iter().filter_map(pressed));
    let struck = simulation.system().struck();
    reasons.extend(deepest(&struck));
    reasons.extend(fastest(&struck));
    reasons.extend(load_that_drives(&summary.ledger()));
    if summary.kept {
        reasons.extend(samples_too_rare(
            summary.mesh_frequency(),
            simulation.every(),
        ));
    }
    let drive = &simulation.assembled().drive;
    let fights = drive.fights(0.0, simulation.time()).into_iter();
    reasons.extend(fights.map(|fight| Reason::MotionsFight { fight }));
    reasons
}

fn broken(load: &Load) -> Option<Reason> {
    let breaking = load.strength.breaking_load?;
    let tension = load.tension.greatest;
    (tension > breaking).then(|| Reason::AboveBreakingLoad {
        chain: load.chain.clone(),
        tension,
        breaking,
    })
}

fn pressed(load: &Load) -> Option<Reason> {
    (load.pressed > 0.0).then(|| Reason::LinksPressed {
        chain: load.chain.clone(),
        force: -load.tension.least,
        share: load.pressed,
    })
}

/// The contact that is farthest beyond the reach of its law.
fn deepest(struck: &[BodyImpacts]) -> Option<Reason> {
    let beyond = struck.iter().filter_map(|it| {
        let reach = it.reach?;
        let depth = it.impacts.deepest;
        (depth > reach).then_some((it, depth / reach))
    });
    let (worst, _) = beyond.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Reason::DeepContact {
        place: worst.place.clone(),
        depth: worst.impacts.deepest,
        reach: worst.reach?,
    })
}

/// The fastest impact, where that is beyond what a restitution stands for.
fn fastest(struck: &[BodyImpacts]) -> Option<Reason> {
    let mut struck = struck.iter();
    let first = struck.next()?;
    let worst = struck.fold(first, |most, it| {
        if it.impacts.fastest > most.impacts.fastest {
            it
        } else {
            most
        }
    });
    let speed = worst.impacts.fastest;
    (speed > FASTEST_IMPACT).then(|| Reason::FastImpact {
        place: worst.place.clone(),
        speed,
        limit: FASTEST_IMPACT,
    })
}

fn load_that_drives(ledger: &Ledger) -> Option<Reason> {
    let net = ledger.by_loads;
    let drives = net > DRIVES * ledger.loads_exchanged && net > MATTERS * ledger.moved;
    drives.then_some(Reason::LoadDrives { work: net })
}

/// The mesh of the fastest chain \[Hz\], sampled with an interval \[s\].
fn samples_too_rare(frequency: f64, every: f64) -> Option<Reason> {
    let samples = 1.0 / (frequency * every);
    (samples < LEAST_SAMPLES).then(|| Reason::SamplesRare {
        samples,
        every,
        needed: 1.0 / (LEAST_SAMPLES * frequency),
    })
}

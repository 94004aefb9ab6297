//! The numerics of a run: how it was stepped, what touched, and how exact it is.

use std::fmt::{self, Write as _};

use chaindrive_mechanics::Struck;

use crate::event::EventTable;
use crate::figure::{Measure, duration, figure, percent};
use crate::precision::{Choice, Judgement};
use crate::summary::Summary;
use crate::{Simulation, Verdict};

/// Notes of the verdict, contacts, energy, steps, choice of the method and errors of a run, as text.
pub fn numerics(
    verdict: &Verdict,
    summary: &Summary,
    simulation: &Simulation,
    choice: Option<&Choice>,
    judgement: Option<&Judgement>,
) -> String {
    let mut text = String::new();
    // Texts take whatever is written.
    let _ = told(&mut text, verdict, summary, simulation);
    if let Some(choice) = choice {
        let _ = write!(text, "\n{choice}");
    }
    match judgement {
        None | Some(Judgement::SwitchedOff) => text,
        Some(judgement) => format!("{text}\n{judgement}"),
    }
}

fn told(
    f: &mut String,
    verdict: &Verdict,
    summary: &Summary,
    simulation: &Simulation,
) -> fmt::Result {
    for reason in verdict.reasons.iter().chain(&verdict.notes) {
        writeln!(f, "{:25}{reason}", reason.name())?;
    }
    let forces = summary.forces();
    if forces.max > 0.0 {
        writeln!(
            f,
            "contact force [N]        p50 {}  p90 {}  p99 {}  max {}",
            figure(forces.p50),
            figure(forces.p90),
            figure(forces.p99),
            figure(forces.max)
        )?;
    }
    contacts(f, summary, simulation)?;
    touches(f, simulation)?;
    energy(f, summary)?;
    let statistics = simulation.statistics();
    let time = simulation.time();
    let steps = statistics.steps.max(1) as f64;
    writeln!(
        f,
        "stepping                 {} with {} steps of {} to {}, {} rejected, {} reduced",
        simulation.method().name(),
        statistics.steps,
        duration(statistics.smallest_step),
        duration(statistics.largest_step),
        statistics.rejections + statistics.error_rejections + statistics.newton_failures,
        statistics.reductions
    )?;
    let wall = simulation.stepping_time();
    write!(
        f,
        "speed                    {} × real time, {} ns per link and step, {wall:.3} s for {}",
        figure(time / wall),
        figure(wall * 1e9 / steps / simulation.system().links() as f64),
        duration(time)
    )
}

/// Energy supplied and lost, and what of it is unaccounted for.
fn energy(f: &mut String, summary: &Summary) -> fmt::Result {
    let ledger = summary.ledger();
    let told = |energy: f64| Measure::Energy.told(energy);
    let share = |of: f64| percent((summary.residual / of).abs());
    write!(
        f,
        "energy                   supplied {}, dissipated {}; unaccounted for {}",
        told(summary.energy_supplied()),
        told(summary.energy_dissipated()),
        told(summary.residual)
    )?;
    if ledger.moved > 0.0 {
        if ledger.losses > 0.0 {
            write!(f, ", {} of the losses", share(ledger.losses))?;
        }
        // What moves freely is judged by its motion: a ring that spins in balance moves no energy.
        if ledger.exchanged > 0.0 {
            write!(
                f,
                ", {} of the {} moved",
                share(ledger.moved),
                told(ledger.moved)
            )?;
        } else {
            write!(f, ", {} of the kinetic energy", share(ledger.kinetic))?;
        }
    }
    writeln!(f)
}

/// One line a kind of contact that was logged.
fn contacts(f: &mut String, summary: &Summary, simulation: &Simulation) -> fmt::Result {
    let found = summary.contacts(simulation);
    if found.iter().all(|contacts| contacts.count == 0) {
        return Ok(());
    }
    writeln!(
        f,
        "contacts                 number   mean peak [N]   max peak [N]   share of time a roller or joint"
    )?;
    let system = simulation.system();
    let places = [
        system.rollers(),
        system.rollers(),
        system.joints(),
        system.joints(),
    ];
    for ((name, contacts), places) in EventTable::KINDS.iter().zip(found).zip(places) {
        if contacts.count > 0 {
            let share = contacts.duration / (simulation.time() * places as f64);
            writeln!(
                f,
                "  {name:20} {:>8}   {:>13.1}   {:>12.1}   {:>10.2} %",
                contacts.count,
                contacts.mean(),
                contacts.greatest,
                100.0 * share
            )?;
        }
    }
    Ok(())
}

/// One line a place where something has touched since the start, logged or not: each impact, and each bounce.
fn touches(f: &mut String, simulation: &Simulation) -> fmt::Result {
    let struck = simulation.system().struck();
    let struck: Vec<_> = struck.iter().filter(|it| it.impacts.count > 0).collect();
    if struck.is_empty() {
        return Ok(());
    }
    writeln!(
        f,
        "touches and bounces      number   fastest [m/s]   deepest [µm]   below the floor of the law"
    )?;
    for Struck {
        place,
        impacts,
        floor,
        ..
    } in struck
    {
        let gentle = impacts.gentle as f64 / impacts.count as f64;
        writeln!(
            f,
            "  {place:20} {:>8}   {:>13.3}   {:>12.2}   {:.0} % below {floor} m/s",
            impacts.count,
            impacts.fastest,
            impacts.deepest * 1e6,
            100.0 * gentle
        )?;
    }
    Ok(())
}

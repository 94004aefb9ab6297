//! The numerics of a run: how it was stepped, what touched, and how exact it is.

use std::fmt::{self, Write as _};

use crate::event::EventTable;
use crate::figure::{Measure, duration, figure, percent};
use crate::precision::{Choice, Judgement};
use crate::sheet::{NAMES, aligned, lines};
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
    let mut text = aligned(text.trim_end(), NAMES);
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
        lines! { f; "{}\t{reason}", reason.name(); }
    }
    let forces = summary.forces();
    let quantiles = [forces.p50, forces.p90, forces.p99, forces.max];
    let [median, p90, p99, greatest] = quantiles.map(figure);
    if forces.max > 0.0 {
        lines! { f; "contact force [N]\tmedian {median}  p90 {p90}  p99 {p99}  greatest {greatest}"; }
    }
    contacts(f, summary, simulation)?;
    touches(f, simulation)?;
    energy(f, summary)?;
    let counts = simulation.statistics();
    let (time, wall) = (simulation.time(), simulation.stepping_time());
    let links = simulation.system().links() as f64;
    let of_a_link = figure(wall * 1e9 / counts.steps.max(1) as f64 / links);
    let [shortest, longest] = [counts.smallest_step, counts.largest_step].map(duration);
    let (method, steps) = (simulation.method().name(), counts.steps);
    let (rejected, reduced) = (counts.rejected(), counts.reductions);
    let (ratio, until) = (figure(time / wall), duration(time));
    lines! { f;
        "stepping\t{method} with {steps} steps of {shortest} to {longest}, {rejected} rejected, {reduced} reduced";
        "speed\t{ratio} × real time, {of_a_link} ns per link and step, {wall:.3} s for {until}";
    }
    Ok(())
}

/// Energy supplied and lost, and what of it is unaccounted for.
fn energy(f: &mut String, summary: &Summary) -> fmt::Result {
    let ledger = summary.ledger();
    let told = |energy: f64| Measure::Energy.told(energy);
    let share = |of: f64| percent((summary.residual / of).abs());
    let [supplied, lost] = [summary.energy_supplied(), summary.energy_dissipated()].map(told);
    let residual = told(summary.residual);
    let of_losses = if ledger.moved > 0.0 && ledger.losses > 0.0 {
        format!(", {} of the losses", share(ledger.losses))
    } else {
        String::new()
    };
    // What moves freely is judged by its motion: a ring that spins in balance moves no energy.
    let of_moved = if ledger.moved <= 0.0 {
        String::new()
    } else if ledger.exchanged > 0.0 {
        format!(
            ", {} of the {} moved",
            share(ledger.moved),
            told(ledger.moved)
        )
    } else {
        format!(", {} of the kinetic energy", share(ledger.kinetic))
    };
    lines! { f;
        "energy\tsupplied {supplied}, dissipated {lost}; unaccounted for {residual}{of_losses}{of_moved}";
    }
    Ok(())
}

/// One line a kind of contact that was logged.
fn contacts(f: &mut String, summary: &Summary, simulation: &Simulation) -> fmt::Result {
    let found = summary.contacts(simulation);
    if found.iter().all(|contacts| contacts.count == 0) {
        return Ok(());
    }
    lines! { f; "contacts\tnumber\tmean peak [N]\tmax peak [N]\tshare of time a roller or joint"; }
    let (system, time) = (simulation.system(), simulation.time());
    let [rollers, joints] = [system.rollers(), system.joints()];
    let places = [rollers, rollers, joints, joints];
    for ((name, of), places) in EventTable::KINDS.iter().zip(found).zip(places) {
        let share = 100.0 * (of.duration / (time * places as f64));
        if of.count > 0 {
            lines! { f;
                "  {name}\t{}\t{:.1}\t{:.1}\t{share:.2} %", of.count, of.mean(), of.greatest;
            }
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
    lines! { f; "touches and bounces\tnumber\tfastest [m/s]\tdeepest [µm]\tbelow the floor of the law"; }
    for it in struck {
        let (floor, of) = (it.floor, &it.impacts);
        let gentle = 100.0 * (of.gentle as f64 / of.count as f64);
        lines! { f;
            "  {}\t{}\t{:.3}\t{:.2}\t{gentle:.0} % below {floor} m/s", it.place, of.count, of.fastest, of.deepest * 1e6;
        }
    }
    Ok(())
}

//! The summary as text.

use std::fmt;

use chaindrive_mechanics::Struck;

use super::Summary;
use crate::Simulation;
use crate::precision::wording::duration;
use crate::record::EventTable;

/// A summary as text.
#[derive(Debug)]
pub struct Report<'a> {
    pub(super) summary: &'a Summary,
    pub(super) simulation: &'a Simulation,
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            summary,
            simulation,
        } = self;
        let statistics = simulation.statistics();
        let time = simulation.time();
        if !summary.spans.is_empty() {
            spans(f, summary)?;
        }
        let forces = summary.forces();
        if forces.max > 0.0 {
            writeln!(
                f,
                "contact force [N]        p50 {:.0}  p90 {:.0}  p99 {:.0}  max {:.0}",
                forces.p50, forces.p90, forces.p99, forces.max
            )?;
        }
        impacts(f, summary)?;
        contacts(f, summary, simulation)?;
        touches(f, simulation)?;
        losses(f, summary)?;
        energy(f, summary)?;
        let steps = statistics.steps.max(1) as f64;
        writeln!(
            f,
            "stepping                 {} with {} steps of {:.3e} to {:.3e} s, {} rejected, {} reduced",
            simulation.method().name(),
            statistics.steps,
            statistics.smallest_step,
            statistics.largest_step,
            statistics.rejections + statistics.error_rejections + statistics.newton_failures,
            statistics.reductions
        )?;
        let wall = simulation.stepping_time();
        write!(
            f,
            "speed                    {:.3} × real time, {:.2} ns per link and step, {:.3} s for {time:.4} s",
            time / wall,
            wall * 1e9 / steps / simulation.system().links() as f64,
            wall
        )
    }
}

/// One line a span, and one where the record is too short for intervals.
fn spans(f: &mut fmt::Formatter<'_>, summary: &Summary) -> fmt::Result {
    writeln!(
        f,
        "span tension [N]            mean   ± 95 %        std   ± 95 %         p1   ± 95 %        p99   ± 95 %      least   greatest"
    )?;
    let samples = summary.samples;
    for (span, known) in summary.spans.iter().zip(summary.steadiness()) {
        let Some(known) = known else {
            writeln!(f, "  {:22} no roller holds it in any sample", span.name)?;
            continue;
        };
        write!(f, "  {:22}", span.name)?;
        for it in [known.mean, known.deviation, known.p1, known.p99] {
            let half_width = match it.half_width {
                unknown if unknown.is_nan() => "unknown".to_owned(),
                half_width => format!("{half_width:.1}"),
            };
            write!(f, "  {:>9.1}  {half_width:>7}", it.value)?;
        }
        write!(f, "  {:>9.1}  {:>9.1}", span.least, span.greatest)?;
        if span.missing > 0 {
            let missing = span.missing;
            write!(f, "  no roller holds it in {missing} of {samples} samples")?;
        }
        writeln!(f)?;
    }
    if let Some(until) = summary.known_from() {
        let period = duration(summary.slowest_forcing());
        let until = duration(until);
        writeln!(
            f,
            "  intervals              unknown below three periods of {period}, the slowest forcing: --until \"{until}\""
        )?;
    }
    Ok(())
}

/// One line a kind of contact that was logged.
fn contacts(f: &mut fmt::Formatter<'_>, summary: &Summary, simulation: &Simulation) -> fmt::Result {
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

/// One line a sprocket that rollers came to.
fn impacts(f: &mut fmt::Formatter<'_>, summary: &Summary) -> fmt::Result {
    let struck = summary.impacts().iter().filter(|it| it.count > 0);
    let struck: Vec<_> = struck.collect();
    if struck.is_empty() {
        return Ok(());
    }
    writeln!(
        f,
        "impacts of rollers       number    p50 [N]    p99 [N]   greatest   impulse [N s]   closing [m/s]"
    )?;
    for it in struck {
        writeln!(
            f,
            "  {:20} {:>8}  {:>9.0}  {:>9.0}  {:>9.0}   {:>13.4}   {:>13.3}",
            it.sprocket,
            it.count,
            it.force(0.5),
            it.force(0.99),
            it.greatest,
            it.impulse(0.5),
            it.speed(0.5),
        )?;
    }
    Ok(())
}

/// One line a place where something has touched since the start, logged or not: each impact, and each bounce.
fn touches(f: &mut fmt::Formatter<'_>, simulation: &Simulation) -> fmt::Result {
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

/// Energy supplied and lost, the efficiency that follows, and power beside its rating.
fn energy(f: &mut fmt::Formatter<'_>, summary: &Summary) -> fmt::Result {
    let supplied = summary.energy_supplied();
    let moved = summary.energy_moved();
    let relative = if moved > 0.0 {
        let share = |of: f64| (summary.residual / of).abs();
        let of_losses = match summary.energy_dissipated() {
            losses if losses > 0.0 => format!(", {:.1e} of the losses", share(losses)),
            _ => String::new(),
        };
        let ledger = summary.ledger();
        // What moves freely is judged by its motion: a ring that spins in balance moves no energy.
        if ledger.exchanged > 0.0 {
            format!("{of_losses}, {:.1e} of the {moved:.4e} moved", share(moved))
        } else {
            format!(
                "{of_losses}, {:.1e} of the kinetic energy",
                share(ledger.kinetic)
            )
        }
    } else {
        String::new()
    };
    writeln!(
        f,
        "energy [J]               supplied {supplied:.4e}, dissipated {:.4e}; unaccounted for {:.2e}{relative}",
        summary.energy_dissipated(),
        summary.residual
    )?;
    if let Some([efficiency, uncertain]) = summary.ledger().efficiency() {
        let percent = 100.0 * efficiency;
        writeln!(
            f,
            "efficiency               {percent:.3} % ± {:.3} % by the energy unaccounted for",
            100.0 * uncertain
        )?;
    } else if summary.ledger().idles() && supplied > 0.0 {
        let kept = 100.0 * (1.0 - summary.energy_dissipated() / supplied);
        writeln!(
            f,
            "efficiency               none: nobody takes energy out; {:.1} % of the supplied is lost, {kept:.1} % stays in motion, height and springs",
            100.0 - kept
        )?;
    } else if supplied > 0.0 {
        writeln!(
            f,
            "efficiency               none: energy goes to and fro, and what goes one way is too little to be judged by"
        )?;
    }
    for rating in summary.ratings() {
        let (Some(rated), Some(sprocket)) = (rating.power(), &rating.sprocket) else {
            continue;
        };
        writeln!(
            f,
            "power                    {:.3} kW carried, {:.3} kW rated at the {} teeth of {}: {:.1} %",
            rating.carried * 1e-3,
            rated * 1e-3,
            sprocket.teeth,
            sprocket.name,
            100.0 * rating.utilisation().unwrap_or(f64::NAN)
        )?;
    }
    Ok(())
}

/// One line a place where energy is lost.
fn losses(f: &mut fmt::Formatter<'_>, summary: &Summary) -> fmt::Result {
    let lost = summary.losses();
    if lost.is_empty() {
        return Ok(());
    }
    writeln!(f, "losses                   energy [J]   share")?;
    let all = summary.energy_dissipated();
    for (place, lost) in lost {
        let share = 100.0 * lost / all;
        writeln!(f, "  {:20} {lost:>14.4e}   {share:>5.1} %", place.name())?;
    }
    Ok(())
}

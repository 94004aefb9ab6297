//! A description as text.

use std::f64::consts::TAU;
use std::fmt;

use crate::figure::{Measure, figure};

use super::{
    ChainFacts, Closing, ContactFacts, Cost, Description, LinkFacts, Model, RatedPower, SpanAtRest,
    counted,
};

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for chain in &self.chains {
            chain.fmt(f)?;
            self.route(chain, f)?;
        }
        self.shafts(f)?;
        for unlike in &self.tolerances {
            row(f, "not as drawn", &unlike.to_string())?;
        }
        for span in &self.out_of_line {
            row(f, "out of line", &span.to_string())?;
        }
        for stack in &self.stacks {
            let labels = ["behind the teeth"]
                .into_iter()
                .chain(std::iter::repeat(""));
            for (label, line) in labels.zip(stack.to_string().lines()) {
                row(f, label, line)?;
            }
        }
        if let Some(oil) = &self.oil {
            row(f, "oil", &oil.to_string())?;
        }
        for train in &self.free_trains {
            row(f, "turned by torques", &train.to_string())?;
        }
        self.statics(f)?;
        self.model.fmt(f)?;
        self.time_scales(f)?;
        self.polygon(f)?;
        self.cost(f)?;
        let mut warnings = self.warnings.iter();
        warnings.try_for_each(|warning| writeln!(f, "warning: {warning}"))
    }
}

impl fmt::Display for ChainFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let chain = self;
        match &chain.name {
            Some(name) => writeln!(f, "chain {name}")?,
            None => writeln!(f, "chain")?,
        }
        row(
            f,
            "links",
            &format!("{} of {:.4} mm", chain.links, chain.pitch * 1e3),
        )?;
        row(f, "model", &chain.bodies.to_string())?;
        let [least, most] = chain.roller_diameters.map(|it| it * 1e3);
        if least < most {
            row(
                f,
                "roller diameters",
                &format!("{least:.4} to {most:.4} mm"),
            )?;
        }
        row(
            f,
            "mass per length",
            &format!("{:.4} kg/m", chain.mass_per_length),
        )?;
        let stiffness = format!(
            "{} a link, {} a unit of strain{}",
            Measure::Stiffness.told(chain.link_stiffness),
            Measure::Force.told(chain.axial_stiffness),
            if chain.bodies.rollers.is_some() {
                ", while it is laid"
            } else {
                ""
            }
        );
        row(f, "axial stiffness", &stiffness)?;
        let along = format!("{:.0} m/s along", chain.longitudinal_wave_speed);
        let waves = match chain.transverse_wave_speeds {
            Some([least, most]) => format!("{along}, {least:.1} to {most:.1} m/s across, at rest"),
            None => along,
        };
        row(f, "wave speeds", &waves)?;
        match &chain.rated_power {
            Some(rated) => row(f, "rated power", &rated.to_string()),
            None => Ok(()),
        }
    }
}

impl Description {
    fn route(&self, chain: &ChainFacts, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(closing) = &chain.closing else {
            return Ok(());
        };
        writeln!(f, "route                      teeth   pitches   wrap [deg]")?;
        for stop in self.stops.iter().filter(|it| it.chain == chain.name) {
            let dash = || "–".to_owned();
            let teeth = stop.teeth.map_or_else(dash, |teeth| teeth.to_string());
            let wrap = stop
                .wrap
                .map_or_else(dash, |wrap| format!("{:.2}", wrap.to_degrees()));
            writeln!(
                f,
                "  {:22} {teeth:>7}  {:>8}  {wrap:>11}",
                stop.name, stop.pitches
            )?;
        }
        writeln!(
            f,
            "spans at rest            pitches   length [m]   tension [N]   first frequency [Hz]"
        )?;
        for SpanAtRest {
            name,
            pitches,
            length,
            tension,
            frequency,
            ..
        } in self.spans.iter().filter(|it| it.chain == chain.name)
        {
            let frequency = frequency.map_or_else(|| "–".to_owned(), |f| format!("{f:.2}"));
            writeln!(
                f,
                "  {name:22} {pitches:>7}   {length:>10.4}   {tension:>11.1}   {frequency:>20}"
            )?;
        }
        if let Some(against) = &chain.against_route {
            writeln!(f, "  {against}")?;
        }
        row(f, "closing", &closing.to_string())
    }

    fn shafts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.shafts.is_empty() {
            return Ok(());
        }
        writeln!(
            f,
            "shafts                inertia [kg m²]     speed [rpm]   sprockets; joined by"
        )?;
        for shaft in &self.shafts {
            let sprockets = match shaft.sprockets.as_slice() {
                [] => "–".to_owned(),
                names => names.join(", "),
            };
            let joins = match shaft.joined_by.as_slice() {
                [] => String::new(),
                names => format!("; {}", names.join(", ")),
            };
            writeln!(
                f,
                "  {:18} {:>16}   {:>13.2}   {sprockets}{joins}",
                shaft.name,
                figure(shaft.inertia),
                shaft.speed * 60.0 / TAU
            )?;
        }
        Ok(())
    }

    fn statics(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.statics.is_empty() {
            return Ok(());
        }
        // Rigid links take over where the springs have settled.
        let rigid = |chain: &ChainFacts| chain.bodies.rollers.is_some();
        let of = if self.chains.iter().any(rigid) {
            "statics, laid as springs "
        } else {
            "statics                  "
        };
        writeln!(f, "{of}iterations   span tensions [N]")?;
        for stage in &self.statics {
            let tensions = stage
                .span_tensions
                .iter()
                .map(|tension| format!("{tension:.1}"));
            let tensions = tensions.collect::<Vec<_>>().join("  ");
            writeln!(
                f,
                "  {:22} {:>10}   {tensions}",
                stage.stage, stage.iterations
            )?;
        }
        Ok(())
    }

    fn time_scales(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scales = &self.time_scales;
        writeln!(f, "time scales")?;
        row(
            f,
            "stiffest mode",
            &format!(
                "1/ω = {}, {} without its damping",
                Measure::Time.told(scales.stiffest),
                Measure::Time.told(scales.undamped)
            ),
        )?;
        row(f, "chain speed", &format!("{:.3} m/s", scales.chain_speed))?;
        for (name, frequency) in &scales.mesh_frequencies {
            row(f, &format!("mesh of {name}"), &format!("{frequency:.3} Hz"))?;
        }
        Ok(())
    }

    fn polygon(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.polygon.is_empty() {
            return Ok(());
        }
        writeln!(
            f,
            "polygon action of every strand, were it tight; the wheel it runs onto drives"
        )?;
        for pair in &self.polygon {
            let ratio = |ratio: f64| (ratio / pair.mean_ratio - 1.0) * 100.0;
            let closing = pair.closing_speed.map_or_else(String::new, |speed| {
                format!(", {speed:.4} m/s along the normal of the tooth")
            });
            let text = format!(
                "ratio {:.5} {:+.4} to {:+.4} %, error {} peak to peak, seating at {:.4} m/s{closing}, {:.2} Hz",
                pair.mean_ratio,
                ratio(pair.least_ratio),
                ratio(pair.greatest_ratio),
                turned(pair.transmission_error),
                pair.seating_velocity,
                pair.mesh_frequency
            );
            row(f, &format!("{} ← {}", pair.driver, pair.driven), &text)?;
        }
        Ok(())
    }

    fn cost(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cost = &self.cost;
        writeln!(f, "run")?;
        let mean = if cost.adaptive { "about " } else { "" };
        row(
            f,
            "method",
            &format!(
                "{}, step {mean}{}",
                cost.method,
                Measure::Time.told(cost.step)
            ),
        )?;
        if let Some(accuracy) = cost.unless_chosen_for {
            let text = format!(
                "by default; a run chooses them for an accuracy of {} %",
                accuracy * 100.0
            );
            row(f, "", &text)?;
        }
        let extent = format!(
            "{} s in {:.0} steps, {:.0} samples",
            cost.until, cost.steps, cost.samples
        );
        row(f, "extent", &extent)?;
        let time = format!(
            "about {}, {:.3} s for a second simulated; {} a step, mean of {}",
            duration(cost.run_time),
            cost.real_time_ratio,
            duration(cost.time_per_step),
            cost.measured
        );
        if let Some(before) = run_in(cost) {
            row(f, "run-in", &before)?;
        }
        row(f, "run time", &time)
    }
}

/// The run-in, if there is one.
fn run_in(cost: &Cost) -> Option<String> {
    let [least, most] = [cost.run_in_least, cost.run_in].map(|time| Measure::Time.told(time));
    if cost.run_in.is_nan() {
        let text = "until torques have brought the drive up to speed and the tensions are steady; how long that takes is not known before";
        return Some(text.to_owned());
    }
    let time = duration(cost.run_in_time);
    if cost.run_in <= cost.run_in_least {
        return (cost.run_in > 0.0).then(|| format!("{most} before the record, about {time}"));
    }
    let soonest = duration(cost.run_in_least_time);
    Some(format!(
        "until the tensions are steady: {least} simulated at least, about {soonest}; given up after {most}, about {time}"
    ))
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "model")?;
        let freedom = format!(
            "{}, of {} and",
            self.degrees_of_freedom,
            counted(self.rollers, "roller")
        );
        let bodies = format!(
            "{freedom} {} ({} driven), {}",
            counted(self.free_sprockets, "free sprocket"),
            self.driven_sprockets,
            counted(self.tensioners, "tensioner")
        );
        row(f, "degrees of freedom", &bodies)?;
        let guides = format!("{} fixed, {} moving", self.fixed_guides, self.moving_guides);
        row(f, "guides", &guides)?;
        row(
            f,
            "contact candidates",
            &format!("{} near a body", counted(self.candidates, "roller")),
        )?;
        for contact in &self.contacts {
            row(
                f,
                &format!("contact of {}", contact.pair),
                &contact.to_string(),
            )?;
        }
        if self.absent.is_empty() {
            return Ok(());
        }
        row(f, "absent", &self.absent.join(", "))
    }
}

impl fmt::Display for LinkFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(rollers) = self.rollers {
            let made = if self.model == "particles" {
                "point masses at rollers, bushes and pins, links as springs"
            } else {
                "rigid links"
            };
            write!(
                f,
                "{}: {made}, {}",
                self.model,
                counted(self.joints, "joint")
            )?;
            if let Some(gap) = self.joint_clearance {
                write!(f, " with {:.1} µm of radial play", gap * 1e6)?;
            }
            match (rollers, self.roller_clearance) {
                (_, Some(gap)) => write!(f, ", free rollers with {:.1} µm", gap * 1e6)?,
                ("none", _) => write!(f, ", no rollers")?,
                _ => write!(f, ", rollers lumped with their bushes")?,
            }
        } else if self.strands > 0 {
            let strands = counted(self.strands, "strand");
            let made = "point masses at the pins, links as springs side by side";
            write!(f, "{}: {made}, {strands}, no rollers", self.model)?;
        } else {
            let made = "point masses at the rollers, links as springs";
            write!(f, "{}: {made}", self.model)?;
        }
        if let (Some(friction), Some(pin)) = (&self.joint_friction, self.pin_diameter) {
            write!(f, "; pins of {:.2} mm rub, {friction}", pin * 1e3)?;
        }
        if self.joint_damping > 0.0 {
            write!(f, "; joints damp with {} N m s/rad", self.joint_damping)?;
        }
        if self.seal_torque > 0.0 {
            write!(f, "; seals hold {} N m", self.seal_torque)?;
        }
        Ok(())
    }
}

impl fmt::Display for Closing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "strain {} as laid, ", strained(self.strain))?;
        match (&self.adjusted, self.unit) {
            (None, _) => write!(f, "nothing adjusted"),
            (Some(name), "rad") => {
                write!(f, "{name} turned by {:.3}°", self.travel.to_degrees())
            }
            (Some(name), _) => write!(f, "{name} moved by {:.3} mm", self.travel * 1e3),
        }?;
        match self.growth {
            Some(growth) => write!(f, "; the housing then grew by {}", strained(growth)),
            None => Ok(()),
        }
    }
}

impl fmt::Display for RatedPower {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let strands = match self.strands {
            1 => "a single strand".to_owned(),
            several => counted(several as usize, "strand"),
        };
        let Some(power) = self.power else {
            return f.write_str(self.unrated.as_deref().unwrap_or("none"));
        };
        write!(
            f,
            "{:.3} kW at the {} teeth and {:.1} rpm of {}, ",
            power * 1e-3,
            self.teeth,
            self.speed.abs() * 60.0 / TAU,
            self.sprocket
        )?;
        if let Some(by) = self.limited_by {
            write!(f, "limited by {by}, ")?;
        }
        write!(f, "{strands}, service factor {}", self.service_factor)
    }
}

impl fmt::Display for ContactFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.elastic, self.dissipation)?;
        if let Some(restitution) = self.restitution {
            write!(f, " {restitution}")?;
        }
        if self.friction != "none" {
            write!(f, ", friction {}", self.friction)?;
        }
        if let Some(film) = self.film {
            write!(f, ", film of oil of {}", Measure::Length.told(film))?;
        }
        Ok(())
    }
}

/// A strain; rounding is none.
fn strained(strain: f64) -> String {
    if strain.abs() < 1e-10 {
        "0".to_owned()
    } else {
        format!("{} %", figure(100.0 * strain))
    }
}

/// An angle; rounding is none.
fn turned(angle: f64) -> String {
    if angle.abs() < 1e-10 {
        "0".to_owned()
    } else {
        Measure::Angle.told(angle)
    }
}

fn row(f: &mut fmt::Formatter<'_>, name: &str, text: &str) -> fmt::Result {
    writeln!(f, "  {name:22} {text}")
}

/// A duration in a unit that leaves a few digits before the point.
fn duration(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
    let fitting = units.into_iter().find(|(unit, _)| seconds >= *unit);
    let (unit, name) = fitting.unwrap_or((1e-9, "ns"));
    format!("{:.1} {name}", seconds / unit)
}

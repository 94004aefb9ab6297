//! A description as text.

use std::f64::consts::TAU;
use std::fmt::{self, Write as _};

use crate::figure::{Measure, figure};
use crate::sheet::{NAMES, aligned, lines};

use super::{
    ChainFacts, Closing, ContactFacts, Cost, Description, LinkFacts, Model, RatedPower, counted,
};

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sheet = String::new();
        for chain in &self.chains {
            chain.tell(&mut sheet)?;
            self.route(chain, &mut sheet)?;
        }
        self.shafts(&mut sheet)?;
        all(&mut sheet, "not as drawn", &self.tolerances)?;
        all(&mut sheet, "out of line", &self.out_of_line)?;
        for stack in &self.stacks {
            let text = stack.to_string().replace('\n', "\n  \t");
            all(&mut sheet, "behind the teeth", [text])?;
        }
        all(&mut sheet, "oil", &self.oil)?;
        all(&mut sheet, "turned by torques", &self.free_trains)?;
        all(&mut sheet, "forces from outside", &self.forces)?;
        self.statics(&mut sheet)?;
        self.model.tell(&mut sheet)?;
        self.time_scales(&mut sheet)?;
        self.polygon(&mut sheet)?;
        self.cost(&mut sheet)?;
        for warning in &self.warnings {
            writeln!(sheet, "warning: {warning}")?;
        }
        for remark in &self.against_practice {
            writeln!(sheet, "good practice: {remark}")?;
        }
        for note in &self.implausible {
            writeln!(sheet, "hardly plausible: {note}")?;
        }
        f.write_str(&aligned(&sheet, NAMES))
    }
}

/// A line a thing, all with one name.
fn all(
    sheet: &mut String,
    name: &str,
    things: impl IntoIterator<Item = impl fmt::Display>,
) -> fmt::Result {
    let mut things = things.into_iter();
    things.try_for_each(|it| writeln!(sheet, "  {name}\t{it}"))
}

/// A number, or the dash of none.
fn or_dash(number: Option<impl fmt::Display>) -> String {
    number.map_or_else(|| "–".to_owned(), |it| it.to_string())
}

impl ChainFacts {
    fn tell(&self, sheet: &mut String) -> fmt::Result {
        let laid = self.bodies.rollers.map_or("", |_| ", while it is laid");
        let [least, most] = self.roller_diameters.map(|it| it * 1e3);
        let link = Measure::Stiffness.told(self.link_stiffness);
        let strain = Measure::Force.told(self.axial_stiffness);
        let name = self.name.iter().map(|it| format!(" {it}"));
        lines! { sheet;
            "chain{}", name.collect::<String>();
            "  links\t{} of {:.4} mm", self.links, self.pitch * 1e3;
            "  model\t{}", self.bodies;
        }
        let varied = (least < most).then(|| format!("{least:.4} to {most:.4} mm"));
        all(sheet, "roller diameters", varied)?;
        let across = self
            .transverse_wave_speeds
            .map(|[least, most]| format!(", {least:.1} to {most:.1} m/s across, at rest"));
        lines! { sheet;
            "  mass per length\t{:.4} kg/m", self.mass_per_length;
            "  axial stiffness\t{link} a link, {strain} a unit of strain{laid}";
            "  wave speeds\t{:.0} m/s along{}", self.longitudinal_wave_speed, across.unwrap_or_default();
        }
        all(sheet, "rated power", &self.rated_power)
    }
}

impl Description {
    fn route(&self, chain: &ChainFacts, sheet: &mut String) -> fmt::Result {
        let Some(closing) = &chain.closing else {
            return Ok(());
        };
        lines! { sheet; "route\tteeth\tpitches\twrap [deg]"; }
        for stop in self.stops.iter().filter(|it| it.chain == chain.name) {
            let wrap = stop.wrap.map(|wrap| format!("{:.2}", wrap.to_degrees()));
            lines! { sheet;
                "  {}\t{}\t{}\t{}", stop.name, or_dash(stop.teeth), stop.pitches, or_dash(wrap);
            }
        }
        lines! { sheet; "spans at rest\tpitches\tlength [m]\ttension [N]\tfirst frequency [Hz]"; }
        for span in self.spans.iter().filter(|it| it.chain == chain.name) {
            let frequency = or_dash(span.frequency.map(|it| format!("{it:.2}")));
            lines! { sheet;
                "  {}\t{}\t{:.4}\t{:.1}\t{frequency}", span.name, span.pitches, span.length, span.tension;
            }
        }
        if let Some(against) = &chain.against_route {
            writeln!(sheet, "  {against}")?;
        }
        all(sheet, "closing", [closing])
    }

    fn shafts(&self, sheet: &mut String) -> fmt::Result {
        if self.shafts.is_empty() {
            return Ok(());
        }
        lines! { sheet; "shafts\tinertia [kg m²]\tspeed [rpm]\tsprockets; joined by"; }
        for shaft in &self.shafts {
            let sprockets = (!shaft.sprockets.is_empty()).then(|| shaft.sprockets.join(", "));
            let mut joined = or_dash(sprockets);
            if !shaft.joined_by.is_empty() {
                write!(joined, "; {}", shaft.joined_by.join(", "))?;
            }
            let (inertia, speed) = (figure(shaft.inertia), shaft.speed * 60.0 / TAU);
            lines! { sheet; "  {}\t{inertia}\t{speed:.2}\t{joined}", shaft.name; }
        }
        Ok(())
    }

    fn statics(&self, sheet: &mut String) -> fmt::Result {
        if self.statics.is_empty() {
            return Ok(());
        }
        // Rigid links take over where the springs have settled.
        let are_rigid = self.chains.iter().any(|it| it.bodies.rollers.is_some());
        let laid = if are_rigid { ", laid as springs" } else { "" };
        lines! { sheet; "statics{laid}\titerations\tspan tensions [N]"; }
        for stage in &self.statics {
            let tensions = stage.span_tensions.iter().map(|it| format!("\t{it:.1}"));
            let tensions: String = tensions.collect();
            lines! { sheet; "  {}\t{}{tensions}", stage.stage, stage.iterations; }
        }
        Ok(())
    }

    fn time_scales(&self, sheet: &mut String) -> fmt::Result {
        let scales = &self.time_scales;
        let [damped, undamped] =
            [scales.stiffest, scales.undamped].map(|it| Measure::Time.told(it));
        lines! { sheet;
            "time scales";
            "  stiffest mode\t1/ω = {damped}, {undamped} without its damping";
            "  chain speed\t{:.3} m/s", scales.chain_speed;
        }
        for (name, frequency) in &scales.mesh_frequencies {
            writeln!(sheet, "  mesh of {name}\t{frequency:.3} Hz")?;
        }
        Ok(())
    }

    fn polygon(&self, sheet: &mut String) -> fmt::Result {
        if self.polygon.is_empty() {
            return Ok(());
        }
        lines! { sheet; "polygon action of every strand, were it tight; the wheel it runs onto drives"; }
        for pair in &self.polygon {
            let mean = pair.mean_ratio;
            let [least, greatest] =
                [pair.least_ratio, pair.greatest_ratio].map(|it| (it / mean - 1.0) * 100.0);
            let closing = pair.closing_speed.map_or_else(String::new, |speed| {
                format!(", {speed:.4} m/s along the normal of the tooth")
            });
            let (error, seating) = (turned(pair.transmission_error), pair.seating_velocity);
            lines! { sheet;
                "  {} ← {}\tratio {mean:.5} {least:+.4} to {greatest:+.4} %, error {error} peak to peak, seating at {seating:.4} m/s{closing}, {:.2} Hz",
                    pair.driver, pair.driven, pair.mesh_frequency;
            }
        }
        Ok(())
    }

    fn cost(&self, sheet: &mut String) -> fmt::Result {
        let cost = &self.cost;
        let mean = if cost.adaptive { "about " } else { "" };
        lines! { sheet;
            "run";
            "  method\t{}, step {mean}{}", cost.method, Measure::Time.told(cost.step);
        }
        if let Some(accuracy) = cost.unless_chosen_for {
            let percent = accuracy * 100.0;
            lines! { sheet; "  \tby default; a run chooses them for an accuracy of {percent} %"; }
        }
        lines! { sheet;
            "  extent\t{} s in {:.0} steps, {:.0} samples", cost.until, cost.steps, cost.samples;
        }
        all(sheet, "run-in", run_in(cost))?;
        let [all_of_it, step] = [cost.run_time, cost.time_per_step].map(duration);
        lines! { sheet;
            "  run time\tabout {all_of_it}, {:.3} s for a second simulated; {step} a step, mean of {}", cost.real_time_ratio, cost.measured;
        }
        Ok(())
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

impl Model {
    fn tell(&self, sheet: &mut String) -> fmt::Result {
        let [rollers, candidates] = [self.rollers, self.candidates].map(|it| counted(it, "roller"));
        let sprockets = counted(self.free_sprockets, "free sprocket");
        let tensioners = counted(self.tensioners, "tensioner");
        lines! { sheet;
            "model";
            "  degrees of freedom\t{}, of {rollers} and {sprockets} ({} driven), {tensioners}", self.degrees_of_freedom, self.driven_sprockets;
            "  guides\t{} fixed, {} moving", self.fixed_guides, self.moving_guides;
            "  contact candidates\t{candidates} near a body";
        }
        for contact in &self.contacts {
            writeln!(sheet, "  contact of {}\t{contact}", contact.pair)?;
        }
        let absent = (!self.absent.is_empty()).then(|| self.absent.join(", "));
        all(sheet, "absent", absent)
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
        if let Some(growth) = self.growth {
            write!(f, "; the housing then grew by {}", strained(growth))?;
        }
        let Some(sag) = &self.sag else {
            return Ok(());
        };
        let [asked, shared, both] = [sag.asked, sag.shared, sag.asked * sag.asked / sag.shared];
        write!(
            f,
            "; {} sags by {:.1} mm where the others are taut, and by {:.1} mm where nothing pulls and all share the slack (`sag = \"{:.1} mm\"` makes that {:.1} mm)",
            sag.span,
            asked * 1e3,
            shared * 1e3,
            both * 1e3,
            asked * 1e3,
        )
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

/// A duration in a unit that leaves a few digits before the point.
fn duration(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
    let fitting = units.into_iter().find(|(unit, _)| seconds >= *unit);
    let (unit, name) = fitting.unwrap_or((1e-9, "ns"));
    format!("{:.1} {name}", seconds / unit)
}

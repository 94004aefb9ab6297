//! The list of variables of a drive.

use std::ffi::CString;

use chaindrive::channel::labels;
use chaindrive::{Channel, Control, Simulation};
use chaindrive_mechanics::{Input, Parts, Push, Support, System};

use crate::export::Facts;
use crate::signal::{Kind as Acts, Signal};
use crate::variable::{
    ANGLE, Causality, EXTRAPOLATION, HELD, Kind, Role, SCENE, SHAFT_INPUT, SPEED, TORQUE, Variable,
};

/// Channels whose entries are outputs unless others are asked for, where a drive has them.
const OUTPUTS: [Channel; 19] = [
    Channel::SprocketAngle,
    Channel::SprocketSpeed,
    Channel::SprocketTorque,
    Channel::SprocketForceX,
    Channel::SprocketForceY,
    Channel::SprocketX,
    Channel::SprocketY,
    Channel::ShaftAngle,
    Channel::ShaftSpeed,
    Channel::CouplingTorque,
    Channel::SpanTension,
    Channel::TensionerPosition,
    Channel::TensionerForce,
    Channel::EnergyKinetic,
    Channel::EnergyStored,
    Channel::EnergySupplied,
    Channel::EnergyResidual,
    Channel::EnergyFlows,
    Channel::EnergyLosses,
];

/// Channels that inputs look at, and those of the ledger.
const GAUGES: [Channel; 12] = [
    Channel::SprocketAngle,
    Channel::SprocketSpeed,
    Channel::SprocketTorque,
    Channel::SprocketX,
    Channel::SprocketY,
    Channel::ShaftAngle,
    Channel::ShaftSpeed,
    Channel::TensionerPosition,
    Channel::SpanTension,
    Channel::EnergyKinetic,
    Channel::EnergyResidual,
    Channel::EnergyFlows,
];

/// All variables of a drive, and what is behind them.
#[derive(Clone, Debug)]
pub(crate) struct Ports {
    pub(crate) variables: Vec<Variable>,
    pub(crate) signals: Vec<Signal>,
    /// Kind of drive of every shaft at the start.
    pub(crate) shafts: Vec<i64>,
    /// Channels that are read, one after the other.
    pub(crate) channels: Vec<Channel>,
}

/// Channels of outputs for a drive, where nobody asks for others.
pub(crate) fn usual(system: &System) -> Vec<Channel> {
    let of_it = OUTPUTS.into_iter().filter(|channel| channel.is_of(system));
    of_it.collect()
}

struct Builder<'a> {
    system: &'a System,
    parts: &'a Parts,
    /// Values at the start, and the channels that they are of.
    values: Vec<f64>,
    ports: Ports,
}

impl Ports {
    /// The variables of a drive at its start, with the entries of these channels as outputs.
    pub(crate) fn of(simulation: &Simulation, outputs: &[Channel], facts: &Facts) -> Self {
        let system = simulation.system();
        let mut channels = outputs.to_vec();
        let gauges = GAUGES.into_iter().filter(|channel| channel.is_of(system));
        let missing: Vec<_> = gauges.filter(|it| !outputs.contains(it)).collect();
        channels.extend(missing);
        let values = channels.iter().flat_map(|it| simulation.channel(*it));
        let mut builder = Builder {
            system,
            parts: simulation.assembled().drive.parts(),
            values: values.collect(),
            ports: Self {
                variables: Vec::new(),
                signals: Vec::new(),
                shafts: Vec::new(),
                channels,
            },
        };
        builder.add(
            "time",
            "time",
            real("s", None),
            Causality::Independent,
            Role::Time,
        );
        builder.shafts();
        builder.tensioners();
        builder.forces();
        builder.centres();
        builder.tunable();
        let held = Kind::Choice {
            of: &EXTRAPOLATION,
            start: HELD,
        };
        let text = EXTRAPOLATION.description;
        builder.add(
            "extrapolation",
            text,
            held,
            Causality::Tunable,
            Role::Extrapolation,
        );
        builder.add(
            "step_patience",
            "wall time after which a step is given up and taken back; 0: never",
            real("s", Some(0.0)),
            Causality::Tunable,
            Role::Patience,
        );
        for channel in outputs {
            builder.outputs(*channel);
        }
        let work = "work of the inputs on the drive since the start";
        builder.add(
            "coupling_energy",
            work,
            real("J", None),
            Causality::Output,
            Role::Work,
        );
        let error = "energy that was given and has not arrived, since inputs come late; negative where the coupling makes energy";
        let name = "coupling_energy_error";
        builder.add(
            name,
            error,
            real("J", None),
            Causality::Output,
            Role::WorkError,
        );
        builder.facts(facts);
        builder.ports
    }
}

fn real(unit: &str, start: Option<f64>) -> Kind {
    Kind::Real {
        unit: unit.to_owned(),
        start,
    }
}

impl Builder<'_> {
    fn add(
        &mut self,
        name: impl Into<String>,
        description: impl Into<String>,
        kind: Kind,
        causality: Causality,
        role: Role,
    ) {
        self.ports.variables.push(Variable {
            name: name.into(),
            description: description.into(),
            kind,
            causality,
            role,
        });
    }

    /// Place of the first entry of a channel among the values.
    fn first(&self, channel: Channel) -> Option<usize> {
        let channels = &self.ports.channels;
        let at = channels.iter().position(|it| *it == channel)?;
        let before = channels[..at].iter().map(|it| self.entries(*it));
        Some(before.sum())
    }

    fn entries(&self, channel: Channel) -> usize {
        labels(channel.axis(), self.system).map_or(1, |labels| labels.len())
    }

    fn value(&self, place: Option<usize>) -> f64 {
        place.map_or(0.0, |index| self.values[index])
    }

    fn signal(&mut self, name: String, description: String, unit: &str, signal: Signal) {
        let causality = match signal.kind {
            Acts::Parameter => Causality::Tunable,
            _ => Causality::Input,
        };
        let kind = real(unit, Some(signal.start));
        let role = Role::Signal(self.ports.signals.len());
        self.add(name, description, kind, causality, role);
        self.ports.signals.push(signal);
    }

    fn shafts(&mut self) {
        let named = self.system.shaft_names();
        for (index, shaft) in self.parts.shafts.iter().enumerate() {
            let wheels = self.parts.sprockets.iter().enumerate();
            let on_it: Vec<_> = wheels.filter(|(_, it)| it.shaft == index).collect();
            let entry = |by_name: Channel, by_wheel: Channel| {
                let own = shaft.name.as_ref();
                let own = own.and_then(|name| named.iter().position(|it| it == name));
                match (own, on_it.first()) {
                    (Some(own), _) => self.first(by_name).map(|first| first + own),
                    (None, Some((wheel, _))) => self.first(by_wheel).map(|first| first + wheel),
                    (None, None) => None,
                }
            };
            let place = entry(Channel::ShaftAngle, Channel::SprocketAngle);
            let speed = entry(Channel::ShaftSpeed, Channel::SprocketSpeed);
            let first = self.first(Channel::SprocketTorque).unwrap_or_default();
            let torques: Vec<_> = on_it.iter().map(|(wheel, _)| first + wheel).collect();
            let name = match (&shaft.name, on_it.first()) {
                (Some(name), _) => name.clone(),
                (None, Some((_, wheel))) => wheel.name.clone(),
                (None, None) => continue,
            };
            let free = self
                .system
                .refuses(Input::Torque { shaft: index })
                .is_none();
            let start = if free { TORQUE } else { SCENE };
            let at = self.ports.shafts.len();
            self.ports.shafts.push(start);
            let choice = Kind::Choice {
                of: &SHAFT_INPUT,
                start,
            };
            let text = format!("input that acts on {name}");
            self.add(
                format!("input[{name}]"),
                text,
                choice,
                Causality::Tunable,
                Role::Shaft(at),
            );
            let signal = |control: Control, kind, choice, start| Signal {
                control,
                kind,
                carried: None,
                shaft: Some((at, choice)),
                start,
                place,
                speed,
                torques: torques.clone(),
            };
            let torque = signal(Control::Torque(name.clone()), Acts::Torque, TORQUE, 0.0);
            let turning = self.value(speed);
            let turned = signal(Control::Speed(name.clone()), Acts::Speed, SPEED, turning);
            let angle = signal(
                Control::Angle(name.clone()),
                Acts::Angle,
                ANGLE,
                self.value(place),
            );
            let text = "counter-clockwise";
            let on = format!("torque on {name}, {text}, beside those of the scene");
            self.signal(format!("set_torque[{name}]"), on, "N m", torque);
            let on = format!("speed of {name}, {text}");
            self.signal(format!("set_speed[{name}]"), on, "rad/s", turned);
            let on = format!("angle of {name} since the start, {text}");
            self.signal(format!("set_angle[{name}]"), on, "rad", angle);
        }
    }

    fn tensioners(&mut self) {
        let units = self.system.tensioner_units();
        let first = self.first(Channel::TensionerPosition);
        for (index, tensioner) in self.parts.tensioners.iter().enumerate() {
            if self
                .system
                .refuses(Input::Force { tensioner: index })
                .is_some()
            {
                continue;
            }
            let name = &tensioner.name;
            let place = first.map(|first| first + index);
            let signal = Signal::force(Control::Force(name.clone()), place);
            let text = format!("force on {name} towards positive coordinates, beside its push");
            // What works along an angle is a torque.
            let unit = if units[index].0 == "rad" { "N m" } else { "N" };
            self.signal(format!("set_force[{name}]"), text, unit, signal);
        }
    }

    /// Forces on the centres of sprockets, and on carriers.
    fn forces(&mut self) {
        type Made = fn(String) -> Control;
        let axes: [(&str, Channel, Made); 2] = [
            ("x", Channel::SprocketX, Control::ForceX),
            ("y", Channel::SprocketY, Control::ForceY),
        ];
        let parts = self.parts;
        for (index, sprocket) in parts.sprockets.iter().enumerate() {
            for (along, channel, control) in axes {
                let place = self.first(channel).map(|first| first + index);
                let signal = Signal::force(control(sprocket.name.clone()), place);
                self.force(along, &sprocket.name, signal);
            }
        }
        let first = self.first(Channel::TensionerPosition);
        for (index, tensioner) in parts.tensioners.iter().enumerate() {
            for (axis, (along, _, control)) in axes.into_iter().enumerate() {
                let input = Input::CarrierForce {
                    tensioner: index,
                    axis,
                };
                if self.system.refuses(input).is_some() {
                    continue;
                }
                let name = format!("tensioners.{}", tensioner.name);
                let place = first.map(|first| first + index);
                let signal = Signal {
                    carried: Some((tensioner.clone(), axis)),
                    ..Signal::force(control(name.clone()), place)
                };
                self.force(along, &name, signal);
            }
        }
    }

    fn force(&mut self, along: &str, name: &str, signal: Signal) {
        let text = format!("force on {name} along {along}, beside those of the scene");
        self.signal(format!("set_force_{along}[{name}]"), text, "N", signal);
    }

    fn centres(&mut self) {
        for (index, sprocket) in self.parts.sprockets.iter().enumerate() {
            if sprocket.support != Support::Fixed {
                continue;
            }
            let name = &sprocket.name;
            let axes = [
                ("x", Channel::SprocketX, Control::CentreX(name.clone())),
                ("y", Channel::SprocketY, Control::CentreY(name.clone())),
            ];
            for (axis, channel, control) in axes {
                let place = self.first(channel).map(|first| first + index);
                let signal = Signal {
                    control,
                    kind: Acts::Centre,
                    carried: None,
                    shaft: None,
                    start: self.value(place),
                    place,
                    speed: None,
                    torques: Vec::new(),
                };
                let text = format!("centre of {name}, {axis}");
                self.signal(format!("set_centre_{axis}[{name}]"), text, "m", signal);
            }
        }
    }

    fn tunable(&mut self) {
        let units = self.system.tensioner_units();
        for tunable in &self.parts.tunable {
            let spring = |tensioner: usize| match &self.parts.tensioners[tensioner].push {
                Push::Spring(it) => (it.preload, it.stiffness, "N", "N/m"),
                Push::TorsionSpring(it) => (it.preload, it.stiffness, "N m", "N m/rad"),
                _ => (0.0, 0.0, units[tensioner].1, "1"),
            };
            let (start, unit) = match tunable.input {
                Input::Load { .. } => (1.0, "1"),
                Input::Preload { tensioner } => {
                    let (preload, _, unit, _) = spring(tensioner);
                    (preload, unit)
                }
                Input::Stiffness { tensioner } => {
                    let (_, stiffness, _, unit) = spring(tensioner);
                    (stiffness, unit)
                }
                // Nothing else is listed.
                _ => continue,
            };
            let signal = Signal {
                control: Control::Parameter(tunable.place.clone()),
                kind: Acts::Parameter,
                carried: None,
                shaft: None,
                start,
                place: None,
                speed: None,
                torques: Vec::new(),
            };
            let text = "parameter that the scene lists as tunable".to_owned();
            self.signal(tunable.place.clone(), text, unit, signal);
        }
    }

    fn outputs(&mut self, channel: Channel) {
        let Some(first) = self.first(channel) else {
            return;
        };
        let units = channel.units(self.system);
        let names = match labels(channel.axis(), self.system) {
            None => vec![channel.name().to_owned()],
            Some(labels) => labels
                .iter()
                .map(|label| format!("{}[{label}]", channel.name()))
                .collect(),
        };
        for (index, (name, unit)) in names.into_iter().zip(units).enumerate() {
            let role = Role::Value(first + index);
            self.add(
                name,
                channel.description(),
                real(unit, None),
                Causality::Output,
                role,
            );
        }
    }

    /// Adds the figures of the run at the export.
    fn facts(&mut self, facts: &Facts) {
        let mut text = |name: &str, description: &str, value: &str| {
            // A text of C ends at its first zero byte.
            let kind = Kind::Text(CString::new(value.replace('\0', " ")).unwrap_or_default());
            let name = format!("at_export.{name}");
            self.add(name, description, kind, Causality::Constant, Role::Constant);
        };
        text("build", "build that made this unit", &facts.build);
        if let Some(run) = &facts.run {
            text(
                "verdict",
                "verdict on a run of the scene at the export",
                &run.verdict,
            );
            text("verdict_note", "reasons of that verdict", &run.note);
            text(
                "horizon_note",
                "how far waveforms of that run can be followed",
                &run.horizon_note,
            );
            if run.horizon.is_some() {
                let horizon = real("s", run.horizon);
                let described = "time up to which waveforms of that run can be followed";
                let name = "at_export.waveform_horizon";
                self.add(
                    name,
                    described,
                    horizon,
                    Causality::Constant,
                    Role::Constant,
                );
            }
            let until = real("s", Some(run.until));
            let name = "at_export.until";
            self.add(
                name,
                "end of that run",
                until,
                Causality::Constant,
                Role::Constant,
            );
        }
    }
}

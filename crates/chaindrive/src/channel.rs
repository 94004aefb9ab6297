//! The channels: what a run can record, with names, units and dimensions.

use chaindrive_mechanics::{
    ChainSize, Energy, Flow, Observation, Parts, Place, Sights, Store, Support, System,
};

use crate::SimulationError;

macro_rules! axes {
    ($($variant:ident, $name:literal, $text:literal;)*) => {
        /// Things to which the entries of a channel belong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Axis {
            /// One number a sample.
            None,
            $(#[doc = $text] $variant,)*
        }

        impl Axis {
            /// All axes with labels.
            pub const ALL: [Self; 13] = [$(Self::$variant),*];

            /// Name of the dimension; none for a scalar channel.
            pub fn name(self) -> Option<&'static str> {
                match self {
                    Self::None => None,
                    $(Self::$variant => Some($name),)*
                }
            }
        }
    };
}

axes! {
    Roller, "roller", "One a roller.";
    Link, "link", "One a link.";
    Joint, "joint", "One a joint of a chain of rigid links.";
    Span, "span", "One a span between consecutive sprockets.";
    Sprocket, "sprocket", "One a sprocket.";
    Shaft, "shaft", "One a shaft that has a name.";
    Coupling, "coupling", "One a coupling.";
    Guide, "guide", "One a guide.";
    Tensioner, "tensioner", "One a tensioner.";
    OilColumn, "oil_column", "One a tensioner whose oil can be compressed.";
    Store, "store", "One a form of stored or kinetic energy.";
    Flow, "flow", "One a flow of energy.";
    Place, "place", "One a place where energy is lost.";
}

macro_rules! channels {
    ($($(#[$doc:meta])* $variant:ident, $name:literal, $unit:literal, $axis:ident, $text:literal;)*) => {
        /// A quantity that can be recorded.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Channel {
            $(#[doc = $text] $variant,)*
        }

        impl Channel {
            /// All channels.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Name in results.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// SI unit; of tensioners, that of sliders. See [`Self::units`].
            pub fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit),* }
            }

            /// Things to which the entries belong.
            pub fn axis(self) -> Axis {
                match self { $(Self::$variant => Axis::$axis),* }
            }

            /// One line of description.
            pub fn description(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }
        }
    };
}

channels! {
    SpanTension, "span_tension", "N", Span, "mean tension of the links between two sprockets";
    LinkTension, "link_tension", "N", Link, "tension of every link, damping included";
    StrandTensionMax, "strand_tension_max", "N", Link, "greatest tension of the strands of every link, damping included";
    StrandTensionMin, "strand_tension_min", "N", Link, "least tension of the strands of every link, damping included";
    LinkAngle, "link_angle", "rad", Link, "direction of every rigid link";
    JointForce, "joint_force", "N", Joint, "force on the pin";
    JointForceX, "joint_force_x", "N", Joint, "force on the pin, x";
    JointForceY, "joint_force_y", "N", Joint, "force on the pin, y";
    JointDepth, "joint_depth", "m", Joint, "indentation of pin and bush";
    JointOffsetX, "joint_offset_x", "m", Joint, "eccentricity of the pin in its bush, x";
    JointOffsetY, "joint_offset_y", "m", Joint, "eccentricity of the pin in its bush, y";
    JointAngle, "joint_angle", "rad", Joint, "direction of the link with the pin from that with the bush";
    BushForce, "bush_force", "N", Joint, "force of the free roller on its bush";
    BushForceX, "bush_force_x", "N", Joint, "force of the free roller on its bush, x";
    BushForceY, "bush_force_y", "N", Joint, "force of the free roller on its bush, y";
    BushDepth, "bush_depth", "m", Joint, "indentation of bush and free roller";
    BushOffsetX, "bush_offset_x", "m", Joint, "eccentricity of the bush in its free roller, x";
    BushOffsetY, "bush_offset_y", "m", Joint, "eccentricity of the bush in its free roller, y";
    FilmThickness, "film_thickness", "m", Roller, "oil between roller and teeth above the roughness; zero where metal bears";
    ContactForce, "contact_force", "N", Roller, "normal force between roller and teeth";
    ContactDepth, "contact_depth", "m", Sprocket, "deepest indentation on the sprocket";
    Contacts, "contacts", "1", Sprocket, "number of closed contacts on the sprocket";
    RollerX, "roller_x", "m", Roller, "roller centre, x";
    RollerY, "roller_y", "m", Roller, "roller centre, y";
    RollerVx, "roller_vx", "m/s", Roller, "roller velocity, x";
    RollerVy, "roller_vy", "m/s", Roller, "roller velocity, y";
    SprocketAngle, "sprocket_angle", "rad", Sprocket, "rotation since the start, counter-clockwise";
    SprocketSpeed, "sprocket_speed", "rad/s", Sprocket, "angular speed, counter-clockwise";
    SprocketTorque, "sprocket_torque", "N m", Sprocket, "torque of the chain on the sprocket";
    SprocketForceX, "sprocket_force_x", "N", Sprocket, "resultant of the chain on the sprocket, x";
    SprocketForceY, "sprocket_force_y", "N", Sprocket, "resultant of the chain on the sprocket, y";
    CentreForceX, "centre_force_x", "N", Sprocket, "force from outside on the sprocket centre, x";
    CentreForceY, "centre_force_y", "N", Sprocket, "force from outside on the sprocket centre, y";
    SupportForceX, "support_force_x", "N", Sprocket, "force of its support on the sprocket centre, x";
    SupportForceY, "support_force_y", "N", Sprocket, "force of its support on the sprocket centre, y";
    SprocketX, "sprocket_x", "m", Sprocket, "sprocket centre, x";
    SprocketY, "sprocket_y", "m", Sprocket, "sprocket centre, y";
    ShaftAngle, "shaft_angle", "rad", Shaft, "rotation since the start, counter-clockwise";
    ShaftSpeed, "shaft_speed", "rad/s", Shaft, "angular speed, counter-clockwise";
    CouplingTorque, "coupling_torque", "N m", Coupling, "torque of the coupling on its first shaft";
    GuideForceX, "guide_force_x", "N", Guide, "resultant of the chain on the guide, x";
    GuideForceY, "guide_force_y", "N", Guide, "resultant of the chain on the guide, y";
    TensionerPosition, "tensioner_position", "m", Tensioner, "travel of a slider in m, or angle of an arm in rad";
    TensionerForce, "tensioner_force", "N", Tensioner, "push of the tensioner in N, or torque of a bare arm in N m";
    CarrierForceX, "carrier_force_x", "N", Tensioner, "force from outside on the tensioner itself, x";
    CarrierForceY, "carrier_force_y", "N", Tensioner, "force from outside on the tensioner itself, y";
    OilPressure, "oil_pressure", "Pa", OilColumn, "pressure of compressible oil in a tensioner above that of the air";
    EnergyKinetic, "energy_kinetic", "J", None, "kinetic energy";
    EnergyStored, "energy_stored", "J", None, "potential energy of springs, contacts and weight";
    EnergyDissipated, "energy_dissipated", "J", None, "energy lost since the start";
    EnergySupplied, "energy_supplied", "J", None, "energy supplied since the start, loads subtracted";
    EnergyResidual, "energy_residual", "J", None, "energy unaccounted for since the start";
    EnergyStores, "energy_stores", "J", Store, "energy by form";
    EnergyFlows, "energy_flows", "J", Flow, "energy that has flowed since the start, by element";
    EnergyLosses, "energy_losses", "J", Place, "energy lost since the start, by place: together energy_dissipated";
}

impl Channel {
    /// Channels that a run records unless others are asked for.
    pub const DEFAULT: [Self; 12] = [
        Self::SpanTension,
        Self::ContactForce,
        Self::RollerX,
        Self::RollerY,
        Self::SprocketAngle,
        Self::SprocketSpeed,
        Self::SprocketTorque,
        Self::EnergyKinetic,
        Self::EnergyStored,
        Self::EnergyDissipated,
        Self::EnergySupplied,
        Self::EnergyResidual,
    ];

    /// Channels that a run records beside [`DEFAULT`](Self::DEFAULT) unless asked otherwise, where tensioners or centres move: with both the pose
    /// of every sample is known.
    pub const WHERE_BODIES_MOVE: [Self; 3] =
        [Self::SprocketX, Self::SprocketY, Self::TensionerPosition];

    /// Channels that a run records beside [`DEFAULT`](Self::DEFAULT) unless asked otherwise, where a scene has forces on centres or on carriers.
    pub const WHERE_FORCES_ACT: [Self; 4] = [
        Self::CentreForceX,
        Self::CentreForceY,
        Self::CarrierForceX,
        Self::CarrierForceY,
    ];

    /// The drive has forces of this channel.
    fn is_forced(self, drive: &Parts) -> bool {
        match self {
            Self::CentreForceX | Self::CentreForceY => {
                drive.sprockets.iter().any(|it| !it.forces.is_empty())
            }
            _ => drive.tensioners.iter().any(|it| !it.forces.is_empty()),
        }
    }

    /// Channels that a run of a drive records unless others are asked for.
    pub fn defaults(drive: &Parts) -> Vec<Self> {
        let mut channels = Self::DEFAULT.to_vec();
        let mut sprockets = drive.sprockets.iter();
        let moved = sprockets.any(|sprocket| sprocket.support != Support::Fixed);
        let moving = Self::WHERE_BODIES_MOVE.into_iter();
        channels.extend(moving.filter(|channel| match channel {
            Self::TensionerPosition => !drive.tensioners.is_empty(),
            _ => moved,
        }));
        let forced = Self::WHERE_FORCES_ACT.into_iter();
        channels.extend(forced.filter(|channel| channel.is_forced(drive)));
        channels
    }

    /// The channel of a name.
    ///
    /// # Errors
    /// [`SimulationError::UnknownChannel`] with the nearest name.
    pub fn from_name(name: &str) -> Result<Self, SimulationError> {
        let found = Self::ALL
            .iter()
            .copied()
            .find(|channel| channel.name() == name);
        found.ok_or_else(|| {
            let near = |c: &&Self| strsim::jaro_winkler(c.name(), name);
            let best = Self::ALL.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
            SimulationError::UnknownChannel {
                name: name.to_owned(),
                suggestion: best.filter(|c| near(c) > 0.8).map(|c| c.name().to_owned()),
                known: Self::ALL
                    .iter()
                    .map(|c| c.name())
                    .collect::<Vec<_>>()
                    .join(", "),
            }
        })
    }

    /// SI unit of every entry in a system, one for a scalar: those of tensioners depend on what carries them.
    pub fn units(self, system: &System) -> Vec<&'static str> {
        let tensioners = || system.tensioner_units().into_iter();
        match self {
            Self::TensionerPosition => tensioners().map(|(position, _)| position).collect(),
            Self::TensionerForce => tensioners().map(|(_, force)| force).collect(),
            _ => {
                let entries = labels(self.axis(), system).map_or(1, |labels| labels.len());
                vec![self.unit(); entries]
            }
        }
    }

    /// The attribute that tells the unit of all entries in a system; where they differ, all of them in the order of the labels.
    pub fn unit_attribute(self, system: &System) -> (&'static str, String) {
        let unit = self.unit_in(system);
        (unit_attribute(&unit), unit)
    }

    /// The unit of all entries in a system; where they differ, all of them in the order of the labels.
    pub fn unit_in(self, system: &System) -> String {
        let units = self.units(system);
        match units.first() {
            None => self.unit().to_owned(),
            Some(first) if units.iter().all(|unit| unit == first) => (*first).to_owned(),
            Some(_) => units.join(", "),
        }
    }

    /// Whether it tells of bushes in free rollers.
    fn is_of_bushes(self) -> bool {
        matches!(
            self,
            Self::BushForce
                | Self::BushForceX
                | Self::BushForceY
                | Self::BushDepth
                | Self::BushOffsetX
                | Self::BushOffsetY
        )
    }

    /// Whether a system has what the channel records: joints and directions of links belong to rigid
    /// links, tensions of strands to chains that have some, shafts and couplings are those that a scene names.
    pub fn is_of(self, system: &System) -> bool {
        match self.axis() {
            Axis::Joint if self.is_of_bushes() => system.has_free_rollers(),
            Axis::Joint => system.joints() > 0,
            Axis::Link => match self {
                Self::LinkAngle => system.joints() > 0,
                Self::StrandTensionMax | Self::StrandTensionMin => system.has_strands(),
                _ => true,
            },
            Axis::Roller => !matches!(self, Self::FilmThickness) || system.has_films(),
            Axis::Shaft => !system.shaft_names().is_empty(),
            Axis::Coupling => !system.coupling_names().is_empty(),
            _ => true,
        }
    }

    /// The channels of some names for a system, each once; `all` are those that it has.
    ///
    /// # Errors
    /// As [`Channel::from_name`], and [`SimulationError::AbsentChannel`] for one that the system does
    /// not have.
    pub fn chosen(
        names: &[impl AsRef<str>],
        system: &System,
    ) -> Result<Vec<Self>, SimulationError> {
        let mut channels = Vec::new();
        for name in names {
            if name.as_ref() == "all" {
                let all = Self::ALL.iter().filter(|channel| channel.is_of(system));
                channels.extend(all.copied());
                continue;
            }
            let channel = Self::from_name(name.as_ref())?;
            if !channel.is_of(system) {
                return Err(SimulationError::AbsentChannel {
                    name: channel.name(),
                });
            }
            channels.push(channel);
        }
        let mut seen = Vec::new();
        channels.retain(|channel| {
            let new = !seen.contains(channel);
            seen.push(*channel);
            new
        });
        Ok(channels)
    }

    /// Names the first of some names that is neither `all` nor that of a channel.
    ///
    /// # Errors
    /// As [`Channel::from_name`].
    pub fn check(names: &[impl AsRef<str>]) -> Result<(), SimulationError> {
        let names = names
            .iter()
            .map(AsRef::as_ref)
            .filter(|name| *name != "all");
        names
            .map(Self::from_name)
            .try_for_each(|found| found.map(drop))
    }

    /// Sights that it needs of a state.
    pub(crate) fn sights(self) -> Sights {
        match self {
            Self::Contacts
            | Self::ContactDepth
            | Self::FilmThickness
            | Self::SupportForceX
            | Self::SupportForceY => Sights::LAWS,
            Self::StrandTensionMax | Self::StrandTensionMin => Sights::LAWS.and(Sights::STRANDS),
            Self::EnergyKinetic
            | Self::EnergyStored
            | Self::EnergyDissipated
            | Self::EnergySupplied
            | Self::EnergyResidual
            | Self::EnergyStores
            | Self::EnergyFlows
            | Self::EnergyLosses => Sights::ENERGIES,
            Self::SpanTension => Sights::SPANS,
            Self::RollerX | Self::RollerY => Sights::PLACES,
            Self::RollerVx | Self::RollerVy => Sights::VELOCITIES,
            Self::LinkAngle => Sights::JOINTS,
            _ if self.axis() == Axis::Joint => Sights::JOINTS,
            _ => Sights::default(),
        }
    }

    /// Sights that several need.
    pub(crate) fn sights_of(channels: &[Self]) -> Sights {
        let each = channels.iter().map(|it| it.sights());
        each.fold(Sights::default(), Sights::and)
    }

    /// Appends the entries of one sample; `start` is the energy of the first sample.
    pub fn read(self, sample: &Observation, start: &Energy, to: &mut Vec<f64>) {
        let energy = &sample.energy;
        match self {
            Self::SpanTension => to.extend(&sample.span_tension),
            Self::LinkTension => to.extend(&sample.link_tension),
            Self::StrandTensionMax => to.extend(&sample.strand_tension_max),
            Self::StrandTensionMin => to.extend(&sample.strand_tension_min),
            Self::LinkAngle => to.extend(&sample.link_angle),
            Self::JointForce => to.extend(&sample.joint_force),
            Self::JointForceX => to.extend(&sample.joint_force_x),
            Self::JointForceY => to.extend(&sample.joint_force_y),
            Self::JointDepth => to.extend(&sample.joint_depth),
            Self::JointOffsetX => to.extend(&sample.joint_offset_x),
            Self::JointOffsetY => to.extend(&sample.joint_offset_y),
            Self::JointAngle => to.extend(&sample.joint_angle),
            Self::BushForce => to.extend(&sample.bush_force),
            Self::BushForceX => to.extend(&sample.bush_force_x),
            Self::BushForceY => to.extend(&sample.bush_force_y),
            Self::BushDepth => to.extend(&sample.bush_depth),
            Self::BushOffsetX => to.extend(&sample.bush_offset_x),
            Self::BushOffsetY => to.extend(&sample.bush_offset_y),
            Self::FilmThickness => to.extend(&sample.film_thickness),
            Self::ContactForce => to.extend(&sample.contact_force),
            Self::ContactDepth => to.extend(&sample.contact_depth),
            Self::Contacts => to.extend(&sample.contacts),
            Self::RollerX => to.extend(&sample.roller_x),
            Self::RollerY => to.extend(&sample.roller_y),
            Self::RollerVx => to.extend(&sample.roller_vx),
            Self::RollerVy => to.extend(&sample.roller_vy),
            Self::SprocketAngle => to.extend(&sample.sprocket_angle),
            Self::SprocketSpeed => to.extend(&sample.sprocket_speed),
            Self::SprocketTorque => to.extend(&sample.sprocket_torque),
            Self::SprocketForceX => to.extend(&sample.sprocket_force_x),
            Self::SprocketForceY => to.extend(&sample.sprocket_force_y),
            Self::CentreForceX => to.extend(&sample.centre_force_x),
            Self::CentreForceY => to.extend(&sample.centre_force_y),
            Self::SupportForceX => to.extend(&sample.support_force_x),
            Self::SupportForceY => to.extend(&sample.support_force_y),
            Self::SprocketX => to.extend(&sample.sprocket_x),
            Self::SprocketY => to.extend(&sample.sprocket_y),
            Self::ShaftAngle => to.extend(&sample.shaft_angle),
            Self::ShaftSpeed => to.extend(&sample.shaft_speed),
            Self::CouplingTorque => to.extend(&sample.coupling_torque),
            Self::GuideForceX => to.extend(&sample.guide_force_x),
            Self::GuideForceY => to.extend(&sample.guide_force_y),
            Self::TensionerPosition => to.extend(&sample.tensioner_position),
            Self::TensionerForce => to.extend(&sample.tensioner_force),
            Self::CarrierForceX => to.extend(&sample.carrier_force_x),
            Self::CarrierForceY => to.extend(&sample.carrier_force_y),
            Self::OilPressure => to.extend(&sample.oil_pressure),
            Self::EnergyKinetic => to.push(energy.kinetic()),
            Self::EnergyStored => to.push(energy.stored()),
            Self::EnergyDissipated => to.push(energy.dissipated()),
            Self::EnergySupplied => to.push(energy.supplied()),
            Self::EnergyResidual => to.push(energy.residual(start)),
            Self::EnergyStores => to.extend(Store::ALL.map(|store| energy.store(store))),
            Self::EnergyFlows => to.extend(Flow::ALL.map(|flow| energy.flow(flow))),
            Self::EnergyLosses => to.extend(energy.losses()),
        }
    }
}

impl Axis {
    /// Labels that are numbers, not names.
    pub fn is_numbered(self) -> bool {
        matches!(self, Self::Roller | Self::Link | Self::Joint)
    }

    /// Name of the coordinate that tells the chain of every entry.
    pub fn chain_coordinate(self) -> Option<&'static str> {
        match self {
            Self::Roller => Some("roller_chain"),
            Self::Link => Some("link_chain"),
            Self::Joint => Some("joint_chain"),
            Self::Span => Some("span_chain"),
            _ => None,
        }
    }
}

/// The attribute that tells a unit: `units`, which readers take for one unit, or `entry_units` for the units of several entries
/// and for one that hangs on an exponent n.
pub fn unit_attribute(unit: &str) -> &'static str {
    if [", ", " or ", "^n"].iter().any(|it| unit.contains(it)) {
        "entry_units"
    } else {
        "units"
    }
}

/// The chain that every entry along an axis belongs to, by name; none where there is one chain only, and along axes that do not
/// run over chains.
pub fn chains_along(axis: Axis, system: &System) -> Option<Vec<String>> {
    let count: fn(&ChainSize) -> usize = match axis {
        Axis::Roller => |size| size.rollers,
        Axis::Link => |size| size.links,
        Axis::Joint => |size| size.joints,
        Axis::Span => |size| size.spans,
        _ => return None,
    };
    let chains = system.chain_sizes();
    let several = chains.len() > 1;
    let repeated = |(name, size): (String, ChainSize)| vec![name; count(&size)];
    several.then(|| chains.into_iter().flat_map(repeated).collect())
}

/// Labels along an axis: names, or numbers from 0 for rollers, links and joints; `None` for a scalar.
pub fn labels(axis: Axis, system: &System) -> Option<Vec<String>> {
    let numbers = |count: usize| (0..count).map(|i| i.to_string()).collect();
    match axis {
        Axis::None => None,
        Axis::Roller => Some(numbers(system.rollers())),
        Axis::Link => Some(numbers(system.links())),
        Axis::Joint => Some(numbers(system.joints())),
        Axis::Span => Some(system.span_names()),
        Axis::Sprocket => Some(system.sprocket_names()),
        Axis::Shaft => Some(system.shaft_names()),
        Axis::Coupling => Some(system.coupling_names()),
        Axis::Guide => Some(system.guide_names()),
        Axis::Tensioner => Some(system.tensioner_names()),
        Axis::OilColumn => Some(system.oil_column_names()),
        Axis::Store => Some(Store::ALL.iter().map(|s| s.name().to_owned()).collect()),
        Axis::Place => Some(Place::ALL.iter().map(|p| p.name().to_owned()).collect()),
        Axis::Flow => Some(Flow::ALL.iter().map(|f| f.name().to_owned()).collect()),
    }
}

//! The energy ledger: what is stored, what is lost, what comes in.
//!
//! ```text
//! residual = (kinetic + stored)(t) − (kinetic + stored)(0) − supplied + dissipated
//! ```
//!
//! Stores are functions of the state; flows are powers that the time stepping integrates along
//! with the motion, each from the force element's own law, so that the residual tests both.

use serde::{Deserialize, Serialize};

/// Forms of energy that a state holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Store {
    /// Kinetic energy of the rollers.
    Chain,
    /// Kinetic energy of the sprockets, rotation and centre, and of their shafts.
    Sprockets,
    /// Kinetic energy of the tensioners.
    Carriers,
    /// Stretch of the links.
    Links,
    /// Indentation of pins, bushes and rollers, and deflection of what sticks in joints.
    Joints,
    /// Indentation of rollers and teeth.
    Teeth,
    /// Indentation of chain and guides.
    Guides,
    /// Weight.
    Gravity,
    /// Bearing springs and couplings.
    Supports,
    /// Tensioner springs.
    Tensioners,
}

/// Powers that change the energy of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Loss in the link dampers.
    LinkLoss,
    /// Loss by drag of oil or air across the links.
    DragLoss,
    /// Loss in impacts of pins in bushes.
    JointLoss,
    /// Loss where links turn against each other: friction of pins in bushes, and viscous damping there.
    ArticulationLoss,
    /// Loss in impacts of bushes in free rollers.
    RollerLoss,
    /// Loss by friction of bushes in free rollers.
    RollerFriction,
    /// Loss by seals of joints.
    SealLoss,
    /// Loss by plates that rub where the chain runs out of line.
    OffsetLoss,
    /// Loss in roller-tooth impacts.
    ToothLoss,
    /// Loss by friction on teeth.
    ToothFriction,
    /// Loss in chain-guide impacts.
    GuideLoss,
    /// Loss by friction on guides.
    GuideFriction,
    /// Loss in the dampers of bearings and couplings.
    SupportLoss,
    /// Loss in tensioners.
    TensionerLoss,
    /// Work of prescribed rotations.
    Driver,
    /// Work of prescribed centres, guides and chain ends.
    Motions,
    /// Work of driving torques and of forces on chain ends.
    DriveTorque,
    /// Work of load torques, negative while they resist.
    Load,
    /// Loss by friction in the bearings of shafts.
    BearingLoss,
    /// Loss by drag of oil and air on shafts.
    ShaftDragLoss,
    /// Work of forces from outside on centres and carriers.
    Forces,
}

/// Places where a drive loses energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Pins in bushes, and what damps there.
    Joints,
    /// Free rollers on their bushes.
    Rollers,
    /// Seals of joints.
    Seals,
    /// Plates on teeth and on each other, where the chain runs out of line.
    Offset,
    /// Rollers on teeth.
    Teeth,
    /// Chain on guides.
    Guides,
    /// Links between their joints, damped along themselves and dragged across.
    Spans,
    /// Tensioners.
    Tensioners,
    /// Dampers of bearings on springs, and couplings.
    Supports,
    /// Friction in the bearings of shafts.
    Bearings,
    /// Oil and air around shafts.
    Shafts,
}

impl Place {
    /// All places, in the order of [`Energy::losses`].
    pub const ALL: [Self; 11] = [
        Self::Joints,
        Self::Rollers,
        Self::Seals,
        Self::Offset,
        Self::Teeth,
        Self::Guides,
        Self::Spans,
        Self::Tensioners,
        Self::Supports,
        Self::Bearings,
        Self::Shafts,
    ];

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Joints => "joints",
            Self::Rollers => "rollers",
            Self::Seals => "seals",
            Self::Offset => "offset",
            Self::Teeth => "teeth",
            Self::Guides => "guides",
            Self::Spans => "spans",
            Self::Tensioners => "tensioners",
            Self::Supports => "supports",
            Self::Bearings => "bearings",
            Self::Shafts => "shafts",
        }
    }
}

impl Store {
    /// All stores, in the order of [`Energy::stores`].
    pub const ALL: [Self; 10] = [
        Self::Chain,
        Self::Sprockets,
        Self::Carriers,
        Self::Links,
        Self::Joints,
        Self::Teeth,
        Self::Guides,
        Self::Gravity,
        Self::Supports,
        Self::Tensioners,
    ];

    /// Whether it is energy of motion.
    pub fn is_kinetic(self) -> bool {
        matches!(self, Self::Chain | Self::Sprockets | Self::Carriers)
    }

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chain => "chain_kinetic",
            Self::Sprockets => "sprockets_kinetic",
            Self::Carriers => "tensioners_kinetic",
            Self::Links => "links_stored",
            Self::Joints => "joints_stored",
            Self::Teeth => "teeth_stored",
            Self::Guides => "guides_stored",
            Self::Gravity => "gravity_stored",
            Self::Supports => "supports_stored",
            Self::Tensioners => "tensioners_stored",
        }
    }
}

impl Flow {
    /// All flows, in the order of [`Energy::flows`].
    pub const ALL: [Self; 21] = [
        Self::LinkLoss,
        Self::DragLoss,
        Self::JointLoss,
        Self::ArticulationLoss,
        Self::RollerLoss,
        Self::RollerFriction,
        Self::SealLoss,
        Self::OffsetLoss,
        Self::ToothLoss,
        Self::ToothFriction,
        Self::GuideLoss,
        Self::GuideFriction,
        Self::SupportLoss,
        Self::TensionerLoss,
        Self::Driver,
        Self::Motions,
        Self::DriveTorque,
        Self::Load,
        Self::BearingLoss,
        Self::ShaftDragLoss,
        Self::Forces,
    ];

    /// Whether the flow takes energy away.
    pub fn is_loss(self) -> bool {
        self.place().is_some()
    }

    /// Place at which energy is lost; none for what comes in or goes out.
    pub fn place(self) -> Option<Place> {
        match self {
            Self::JointLoss | Self::ArticulationLoss => Some(Place::Joints),
            Self::RollerLoss | Self::RollerFriction => Some(Place::Rollers),
            Self::SealLoss => Some(Place::Seals),
            Self::OffsetLoss => Some(Place::Offset),
            Self::ToothLoss | Self::ToothFriction => Some(Place::Teeth),
            Self::GuideLoss | Self::GuideFriction => Some(Place::Guides),
            Self::LinkLoss | Self::DragLoss => Some(Place::Spans),
            Self::TensionerLoss => Some(Place::Tensioners),
            Self::SupportLoss => Some(Place::Supports),
            Self::BearingLoss => Some(Place::Bearings),
            Self::ShaftDragLoss => Some(Place::Shafts),
            Self::Driver | Self::Motions | Self::DriveTorque | Self::Load | Self::Forces => None,
        }
    }

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::LinkLoss => "links_dissipated",
            Self::DragLoss => "drag_dissipated",
            Self::JointLoss => "joints_dissipated",
            Self::ArticulationLoss => "articulation_dissipated",
            Self::RollerLoss => "rollers_dissipated",
            Self::RollerFriction => "rollers_friction_dissipated",
            Self::SealLoss => "seals_dissipated",
            Self::OffsetLoss => "offset_dissipated",
            Self::ToothLoss => "teeth_dissipated",
            Self::ToothFriction => "teeth_friction_dissipated",
            Self::GuideLoss => "guides_dissipated",
            Self::GuideFriction => "guides_friction_dissipated",
            Self::SupportLoss => "supports_dissipated",
            Self::TensionerLoss => "tensioners_dissipated",
            Self::Driver => "driver_supplied",
            Self::Motions => "motions_supplied",
            Self::DriveTorque => "torques_supplied",
            Self::Load => "load_supplied",
            Self::BearingLoss => "bearings_dissipated",
            Self::ShaftDragLoss => "shafts_dissipated",
            Self::Forces => "forces_supplied",
        }
    }
}

/// The ledger at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Energies \[J\] in the order of [`Store::ALL`].
    pub stores: [f64; Store::ALL.len()],
    /// Energies that have flowed since the start \[J\] in the order of [`Flow::ALL`].
    pub flows: [f64; Flow::ALL.len()],
}

impl Energy {
    /// One store \[J\].
    pub fn store(&self, store: Store) -> f64 {
        self.stores[store as usize]
    }

    /// One flow \[J\].
    pub fn flow(&self, flow: Flow) -> f64 {
        self.flows[flow as usize]
    }

    /// Kinetic energy \[J\].
    pub fn kinetic(&self) -> f64 {
        Store::ALL
            .iter()
            .filter(|s| s.is_kinetic())
            .map(|&s| self.store(s))
            .sum()
    }

    /// Potential energy \[J\].
    pub fn stored(&self) -> f64 {
        Store::ALL
            .iter()
            .filter(|s| !s.is_kinetic())
            .map(|&s| self.store(s))
            .sum()
    }

    /// Energy lost since the start \[J\].
    pub fn dissipated(&self) -> f64 {
        Flow::ALL
            .iter()
            .filter(|f| f.is_loss())
            .map(|&f| self.flow(f))
            .sum()
    }

    /// Energy lost since the start \[J\] in the order of [`Place::ALL`]: together [`dissipated`](Self::dissipated).
    pub fn losses(&self) -> [f64; Place::ALL.len()] {
        let mut losses = [0.0; Place::ALL.len()];
        for flow in Flow::ALL {
            if let Some(place) = flow.place() {
                losses[place as usize] += self.flow(flow);
            }
        }
        losses
    }

    /// Energy supplied since the start, loads subtracted \[J\].
    pub fn supplied(&self) -> f64 {
        Flow::ALL
            .iter()
            .filter(|f| !f.is_loss())
            .map(|&f| self.flow(f))
            .sum()
    }

    /// Puts what the springs of friction in joints hold among the stores: it went into the joints, and is not lost yet.
    pub(crate) fn hold_in_joints(&mut self, stored: f64) {
        self.stores[Store::Joints as usize] += stored;
        self.flows[Flow::ArticulationLoss as usize] -= stored;
    }

    /// Energy unaccounted for since `start` \[J\]: the error of the time stepping.
    pub fn residual(&self, start: &Self) -> f64 {
        // R = ΔE_kin + ΔE_pot − W_in + W_loss
        (self.kinetic() - start.kinetic()) + (self.stored() - start.stored())
            - (self.supplied() - start.supplied())
            + (self.dissipated() - start.dissipated())
    }
}

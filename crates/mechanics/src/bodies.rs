//! Wheels, rails and carriers, compiled: where they are and how they move.

mod anchor;
mod carried;
mod contacts;
mod equations;
mod forces;
mod group;
mod inputs;
mod shafts;
mod slide;
mod surroundings;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Moment, Weights};

pub(crate) use anchor::Anchor;
pub(crate) use contacts::{BodyContacts, GuideContacts, RailContact, WheelContacts};
pub(crate) use group::GroupBodies;
pub use inputs::Input;
pub(crate) use inputs::Inputs;
pub(crate) use shafts::{Shaft, Turn, TurnedBy};
pub(crate) use slide::Slide;
pub(crate) use surroundings::Surroundings;

use crate::accounts::AccountSizes;
use crate::contact::Frame;
use crate::kinematics::Kinematics;
use crate::seam::Rates;
use crate::tensioner::Slopes;
use crate::{Coupling, Forces, Motion, ShaftLoss};

/// Bodies that chains touch.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    pub(crate) wheels: Vec<Wheel>,
    pub(crate) rails: Vec<Rail>,
    pub(crate) slides: Vec<Slide>,
    pub(crate) shafts: Vec<Shaft>,
    pub(crate) couplings: Vec<Coupling>,
    pub(crate) gravity: Vector,
    /// Index of their first coordinate in the state, after those of all chains.
    pub(crate) first: usize,
    /// Number of first-order states.
    pub(crate) states: usize,
    /// Mass or inertia that goes with each of them \[kg or kg m²\].
    pub(crate) inertias: Vec<f64>,
    /// ω² and damping rate of the quickest of them, but for what states of pushes add.
    pub(crate) rates: [f64; 2],
    /// Inputs from outside.
    pub(crate) inputs: Inputs,
    /// Accounts that are kept.
    pub(crate) accounts: AccountSizes,
}

/// A sprocket in the system.
#[derive(Clone, Debug)]
pub(crate) struct Wheel {
    pub(crate) name: String,
    /// Centre and gap angle at assembly.
    pub(crate) centre: Point,
    pub(crate) angle: f64,
    /// The angle of its first gap.
    pub(crate) turn: Turn,
    /// Index of its shaft.
    pub(crate) shaft: usize,
    pub(crate) support: WheelSupport,
    /// Forces on its centre from outside.
    pub(crate) forces: Forces,
    /// Its own inertia \[kg m²\].
    pub(crate) inertia: f64,
    pub(crate) mass: f64,
    /// Mobility of the rim under a force at the teeth \[1/kg\]: R²/J of a free shaft, 1/m of a free centre.
    pub(crate) mobility: f64,
    pub(crate) teeth: u32,
    pub(crate) pitch_radius: f64,
    pub(crate) pitch: f64,
    /// Centre of the teeth from the axis, in the frame of the teeth \[m\].
    pub(crate) eccentricity: Vector,
    /// +1 where the chain turns counter-clockwise around the wheel.
    pub(crate) sense: f64,
    /// Losses of its shaft that its load has to do with.
    pub(crate) loss: ShaftLoss,
}

/// Support of a wheel's centre.
#[derive(Clone, Debug)]
pub(crate) enum WheelSupport {
    Fixed,
    Prescribed {
        x: Motion,
        y: Motion,
    },
    /// Degrees of freedom `dof` (x) and `dof + 1` (y).
    Springs {
        dof: usize,
        stiffness: [f64; 2],
        damping: [f64; 2],
    },
    Carried(usize),
}

/// A guide in the system.
#[derive(Clone, Debug)]
pub(crate) struct Rail {
    pub(crate) name: String,
    pub(crate) support: RailSupport,
    /// Largest mobility of its face \[1/kg\].
    pub(crate) mobility: f64,
}

/// Support of a rail.
#[derive(Clone, Debug)]
pub(crate) enum RailSupport {
    Fixed,
    Prescribed { x: Motion, y: Motion },
    Carried(usize),
}

impl Bodies {
    /// Frame of a wheel's teeth; the anchor lies near its angle.
    #[inline(always)]
    pub(crate) fn wheel_frame(&self, wheel: usize, anchor: &Anchor, at: Moment<'_>) -> Frame {
        let wheel = &self.wheels[wheel];
        let kinematics = wheel.kinematics(at.t, at.q, at.v);
        let (origin, velocity, _) = wheel.centre_kinematics(at.t, at.q, at.v, &self.slides);
        let turn = anchor.turn(kinematics.position);
        Frame {
            origin,
            eccentric: wheel.eccentric(turn),
            turn,
            velocity,
            spin: kinematics.rate,
        }
    }

    /// Frame of a rail's face.
    pub(crate) fn rail_frame(&self, rail: usize, at: Moment<'_>) -> Frame {
        self.rails[rail].frame(at.t, at.q, at.v, &self.slides)
    }

    /// Centre of a wheel.
    pub(crate) fn wheel_centre(&self, wheel: usize, at: Moment<'_>) -> Point {
        let (centre, _, _) = self.wheels[wheel].centre_kinematics(at.t, at.q, at.v, &self.slides);
        centre
    }

    /// ω² and damping rate of every body by itself, the largest of each; `pushes` of every tensioner and damping of
    /// every loss at the last evaluation.
    pub(crate) fn own_rates(&self, pushes: &[Slopes], resisting: &[f64]) -> Rates {
        let [mut squared, predicted] = self.rates;
        let mut damping = predicted;
        for (turn, resists) in self.resisted().zip(resisting) {
            // Most have no losses.
            if *resists > 0.0
                && let Some((dof, ratio)) = turn.turned_by()
            {
                damping = damping.max(ratio * ratio * resists / self.inertia(dof));
            }
        }
        let predicted = damping;
        for (slide, state) in self.slides.iter().zip(pushes) {
            damping = damping.max(slide.own_damping());
            if slide.state.is_some() {
                let [trapped, settling] = state.largest;
                squared = squared.max(slide.own_rate() + trapped / slide.inertia);
                damping = damping.max(settling);
            }
        }
        Rates {
            squared,
            damping,
            predicted,
            carried: squared,
        }
    }

    /// The same without what states of pushes add: it never changes.
    fn constant_rates(&self) -> [f64; 2] {
        let (mut squared, mut damping) = (0.0_f64, 0.0_f64);
        for wheel in &self.wheels {
            let [own, drag] = wheel.own_rates();
            squared = squared.max(own);
            damping = damping.max(drag);
        }
        for shaft in &self.shafts {
            if let Some((dof, ratio)) = shaft.turn.turned_by() {
                damping = damping.max(ratio * ratio * shaft.drag() / self.inertia(dof));
            }
        }
        for coupling in &self.couplings {
            let ends = coupling.shafts.map(|index| {
                let turned = self.shafts[index].turn.turned_by();
                turned.map_or(0.0, |(dof, ratio)| ratio * ratio / self.inertia(dof))
            });
            // k (φ₁ − φ₀)² ≤ 2 k (φ₀² + φ₁²), exactly the sum for two shafts alone
            let light = ends[0] + ends[1];
            squared = squared.max(coupling.stiffness * light);
            damping = damping.max(coupling.damping * light);
        }
        for slide in &self.slides {
            squared = squared.max(slide.own_rate());
        }
        [squared, damping]
    }

    /// Gives every push with a state its place among the first-order states, in the order of the tensioners.
    pub(crate) fn number_states(&mut self) {
        self.states = 0;
        for slide in &mut self.slides {
            slide.state = slide.push.settled(0.0).map(|_| self.states);
            self.states += usize::from(slide.state.is_some());
        }
    }

    /// Moves all coordinates to begin at `first`.
    pub(crate) fn move_to(&mut self, first: usize) {
        let old = std::mem::replace(&mut self.first, first);
        let shift = |dof: &mut usize| *dof = *dof - old + first;
        for turn in self.turns_mut() {
            turn.move_dof(|dof| dof - old + first);
        }
        for wheel in &mut self.wheels {
            if let WheelSupport::Springs { dof, .. } = &mut wheel.support {
                shift(dof);
            }
        }
        for slide in &mut self.slides {
            if let Some(dof) = &mut slide.dof {
                shift(dof);
            }
        }
    }

    /// Visits (entry of the state, mass or inertia) of everything that moves with a coordinate.
    fn each_inertia(&self, mut visit: impl FnMut(usize, f64)) {
        for shaft in &self.shafts {
            if let Some((dof, ratio)) = shaft.turn.coordinate() {
                visit(dof, ratio * ratio * shaft.inertia);
            }
        }
        for wheel in &self.wheels {
            if let Some((dof, ratio)) = wheel.turn.coordinate() {
                visit(dof, ratio * ratio * wheel.inertia);
            }
            if let WheelSupport::Springs { dof, .. } = wheel.support {
                visit(dof, wheel.mass);
                visit(dof + 1, wheel.mass);
            }
        }
        for slide in &self.slides {
            if let Some(dof) = slide.dof {
                visit(dof, slide.inertia);
            }
        }
    }

    /// Works out the inertias of all coordinates, of which there are `count`.
    pub(crate) fn weigh(&mut self, count: usize) {
        let mut inertias = vec![0.0; count];
        self.each_inertia(|dof, inertia| inertias[dof - self.first] += inertia);
        self.inertias = inertias;
        self.renew_rates();
    }

    /// Works out what follows from the inertias, and from what moves by itself.
    pub(crate) fn renew_rates(&mut self) {
        let mobilities: Vec<f64> = self.wheels.iter().map(|it| self.mobility(it)).collect();
        for (wheel, mobility) in self.wheels.iter_mut().zip(mobilities) {
            wheel.mobility = mobility;
        }
        self.rates = self.constant_rates();
    }

    /// Bearings, tensioners and shafts: visits (entry of the state, c C + k K) of what they have of their own, with the slopes of the
    /// pushes and the damping of the losses at the last evaluation.
    pub(crate) fn each_support(
        &self,
        weights: Weights,
        pushes: &[Slopes],
        resisting: &[f64],
        mut visit: impl FnMut(usize, f64),
    ) {
        let mut visit = |dof: usize, stiffness: f64, damping: f64| {
            visit(
                dof,
                weights.stiffness * stiffness + weights.damping * damping,
            );
        };
        for shaft in &self.shafts {
            if let Some((dof, ratio)) = shaft.turn.turned_by() {
                visit(dof, 0.0, ratio * ratio * shaft.drag());
            }
        }
        for (turn, resists) in self.resisted().zip(resisting) {
            if let (Some((dof, ratio)), true) = (turn.turned_by(), *resists > 0.0) {
                visit(dof, 0.0, ratio * ratio * resists);
            }
        }
        for wheel in &self.wheels {
            if let WheelSupport::Springs {
                dof,
                stiffness,
                damping,
            } = &wheel.support
            {
                for axis in 0..2 {
                    visit(dof + axis, stiffness[axis], damping[axis]);
                }
            }
        }
        for (i, slide) in self.slides.iter().enumerate() {
            let Some(dof) = slide.dof else { continue };
            let lever = slide.carrier.extension(0.0).lever;
            let squared = lever * lever;
            let state = pushes.get(i).copied().unwrap_or_default();
            visit(
                dof,
                slide.push.stiffness(0.0) * squared + state.within(weights.damping),
                slide.push.damping() * squared,
            );
        }
    }

    /// Description of a coordinate, in words.
    pub(crate) fn name(&self, dof: usize) -> String {
        let shaft = || {
            let index = self.shafts.iter().position(|s| s.led() == Some(dof))?;
            let called = if let Some(name) = &self.shafts[index].name {
                format!("shaft `{name}`")
            } else {
                let wheel = self.wheels.iter().find(|wheel| wheel.shaft == index)?;
                format!("sprocket `{}`", wheel.name)
            };
            Some(format!("the angle of {called}"))
        };
        let wheel = self.wheels.iter().find_map(|wheel| match wheel.support {
            WheelSupport::Springs { dof: centre, .. } if (centre..centre + 2).contains(&dof) => {
                Some(format!("the centre of sprocket `{}`", wheel.name))
            }
            _ => None,
        });
        let slide = self.slides.iter().find(|slide| slide.dof == Some(dof));
        wheel
            .or_else(shaft)
            .or_else(|| slide.map(|slide| format!("tensioner `{}`", slide.name)))
            .unwrap_or_else(|| format!("coordinate {dof}"))
    }
}

impl Wheel {
    /// Angle of the first gap axis and its rates at time `t`.
    #[inline(always)]
    pub(crate) fn kinematics(&self, t: f64, q: &[f64], v: &[f64]) -> Kinematics {
        self.turn.kinematics(t, q, v)
    }

    /// Centre of the teeth from the axis \[m\], where the frame of the teeth has this cosine and sine.
    #[inline(always)]
    pub(crate) fn eccentric(&self, [c, s]: [f64; 2]) -> Vector {
        let [x, y] = [self.eccentricity.x, self.eccentricity.y];
        Vector::new(c * x - s * y, s * x + c * y)
    }

    /// The tensioner that carries it.
    pub(crate) fn carried(&self) -> Option<usize> {
        match self.support {
            WheelSupport::Carried(index) => Some(index),
            _ => None,
        }
    }

    /// Place, velocity and prescribed acceleration of the centre.
    #[inline(always)]
    pub(crate) fn centre_kinematics(
        &self,
        t: f64,
        q: &[f64],
        v: &[f64],
        slides: &[Slide],
    ) -> (Point, Vector, Vector) {
        let still = Vector::zeros();
        match &self.support {
            WheelSupport::Fixed => (self.centre, still, still),
            WheelSupport::Prescribed { x, y } => {
                let (x, y) = (x.at(t), y.at(t));
                (
                    self.centre + Vector::new(x.position, y.position),
                    Vector::new(x.rate, y.rate),
                    Vector::new(x.acceleration, y.acceleration),
                )
            }
            WheelSupport::Springs { dof, .. } => (
                Point::new(q[*dof], q[dof + 1]),
                Vector::new(v[*dof], v[dof + 1]),
                still,
            ),
            WheelSupport::Carried(index) => {
                let slide = &slides[*index];
                let (place, velocity) = slide.carry(slide.pose(q, v), self.centre);
                (place, velocity, still)
            }
        }
    }
}

impl Bodies {
    /// Mobility of the rim of a wheel under a force at the teeth.
    fn mobility(&self, wheel: &Wheel) -> f64 {
        let turning = match wheel.turn.turned_by() {
            // Rim and coordinate differ by the ratio.
            Some((dof, ratio)) => (wheel.pitch_radius * ratio).powi(2) / self.inertia(dof),
            None => 0.0,
        };
        let moving = match &wheel.support {
            WheelSupport::Fixed | WheelSupport::Prescribed { .. } => 0.0,
            WheelSupport::Springs { .. } => 1.0 / wheel.mass,
            WheelSupport::Carried(index) => self.slides[*index].mobility(wheel.centre),
        };
        turning + moving
    }
}

impl Wheel {
    /// ω² and damping rate of the wheel on its own bearing.
    pub(crate) fn own_rates(&self) -> [f64; 2] {
        let mut rates = [0.0_f64; 2];
        if let WheelSupport::Springs {
            stiffness, damping, ..
        } = &self.support
        {
            rates[0] = stiffness[0].max(stiffness[1]) / self.mass;
            rates[1] = damping[0].max(damping[1]) / self.mass;
        }
        rates
    }
}

impl Rail {
    /// The tensioner that carries it.
    pub(crate) fn carried(&self) -> Option<usize> {
        match self.support {
            RailSupport::Carried(index) => Some(index),
            _ => None,
        }
    }

    /// The frame of the face, and its reference origin, at time `t`.
    pub(crate) fn frame(&self, t: f64, q: &[f64], v: &[f64], slides: &[Slide]) -> Frame {
        match &self.support {
            RailSupport::Fixed => Frame::fixed(),
            RailSupport::Prescribed { x, y } => {
                let (x, y) = (x.at(t), y.at(t));
                Frame {
                    origin: Point::new(x.position, y.position),
                    velocity: Vector::new(x.rate, y.rate),
                    ..Frame::fixed()
                }
            }
            RailSupport::Carried(index) => {
                let slide = &slides[*index];
                let pose = slide.pose(q, v);
                let (origin, velocity) = slide.carry(pose, slide.carrier.origin());
                let turning = slide.carrier.turning();
                let angle = turning * pose.coordinate;
                Frame {
                    origin,
                    eccentric: Vector::zeros(),
                    turn: [angle.cos(), angle.sin()],
                    velocity,
                    spin: turning * pose.rate,
                }
            }
        }
    }
}

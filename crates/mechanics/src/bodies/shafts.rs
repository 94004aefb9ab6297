//! Shafts, compiled: what turns, and what turns with it.

use chaindrive_integrate::Moment;

use super::Bodies;
use crate::motion::Kinematics;
use crate::{Coupling, Motion, ShaftLoss, Torque};

/// How an angle follows from time or state.
///
/// ```text
/// θ = z + i x,   x: a motion given in time, or a coordinate
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Turn {
    pub(crate) by: TurnedBy,
    /// Ratio i \[–\].
    pub(crate) ratio: f64,
    /// Angle z at x = 0 \[rad\].
    pub(crate) zero: f64,
}

/// Drive of a train of shafts.
#[derive(Clone, Debug)]
pub(crate) enum TurnedBy {
    Motion(Motion),
    /// An entry of the state.
    Coordinate(usize),
}

impl Turn {
    /// The angle and its rates; the acceleration is known where the motion is.
    #[inline(always)]
    pub(crate) fn kinematics(&self, t: f64, q: &[f64], v: &[f64]) -> Kinematics {
        let of = match &self.by {
            TurnedBy::Coordinate(dof) => Kinematics {
                position: q[*dof],
                rate: v[*dof],
                acceleration: 0.0,
            },
            TurnedBy::Motion(motion) => motion.at(t),
        };
        Kinematics {
            position: self.zero + self.ratio * of.position,
            rate: self.ratio * of.rate,
            acceleration: self.ratio * of.acceleration,
        }
    }

    /// The coordinate that turns it, and how far it turns with that; none where the angle is given in time.
    #[inline(always)]
    pub(crate) fn turned_by(&self) -> Option<(usize, f64)> {
        match self.by {
            TurnedBy::Coordinate(dof) => Some((dof, self.ratio)),
            TurnedBy::Motion(_) => None,
        }
    }

    /// Moves the coordinate.
    pub(crate) fn move_dof(&mut self, place: impl FnOnce(usize) -> usize) {
        if let TurnedBy::Coordinate(dof) = &mut self.by {
            *dof = place(*dof);
        }
    }

    /// Holds what moves in time.
    pub(crate) fn hold(&mut self) {
        if let TurnedBy::Motion(motion) = &mut self.by {
            *motion = Motion::Held;
        }
    }
}

/// A shaft in the system.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    /// Its name; none where it is that of its only sprocket.
    pub(crate) name: Option<String>,
    /// Its rotation since the assembly.
    pub(crate) turn: Turn,
    /// Length that turns the coordinate of its train into metres: the largest pitch radius in it \[m\].
    pub(crate) lever: f64,
    /// Whether its coordinate is that of its train.
    pub(crate) leads: bool,
    /// Inertia beside that of its sprockets \[kg m²\].
    pub(crate) inertia: f64,
    pub(crate) drive: Vec<Torque>,
    pub(crate) load: Vec<Torque>,
    /// Losses beside those at its sprockets.
    pub(crate) loss: ShaftLoss,
}

impl Shaft {
    /// All torques on it.
    pub(crate) fn torques(&self) -> impl Iterator<Item = &Torque> {
        self.drive.iter().chain(&self.load)
    }

    /// Linear resistance of all torques \[N m s\].
    pub(crate) fn drag(&self) -> f64 {
        self.torques().map(Torque::drag).sum()
    }

    /// The coordinate of a train, for the shaft that leads it.
    pub(crate) fn led(&self) -> Option<usize> {
        self.turn
            .turned_by()
            .filter(|_| self.leads)
            .map(|(dof, _)| dof)
    }
}

impl Bodies {
    /// Inertia that goes with a coordinate \[kg or kg m²\].
    pub(crate) fn inertia(&self, dof: usize) -> f64 {
        self.inertias[dof - self.first]
    }

    /// Sum of torques on a shaft that turns so \[N m\].
    pub(crate) fn torque(&self, torques: &[Torque], turning: Kinematics, at: Moment<'_>) -> f64 {
        let angle = |torque: &Torque| match torque.follows() {
            Some(shaft) => {
                self.shafts[shaft]
                    .turn
                    .kinematics(at.t, at.q, at.v)
                    .position
            }
            None => turning.position,
        };
        let all = torques.iter();
        all.map(|torque| torque.at(at.t, angle(torque), turning.rate))
            .sum()
    }

    /// What turns under losses, in the order of their damping: sprockets, then shafts.
    pub(crate) fn resisted(&self) -> impl Iterator<Item = &Turn> {
        let wheels = self.wheels.iter().map(|wheel| &wheel.turn);
        wheels.chain(self.shafts.iter().map(|shaft| &shaft.turn))
    }

    /// Torque of all losses of a shaft at a speed \[N m\], under the weight of its sprockets: no chain pulls.
    pub(crate) fn idle_torque(&self, shaft: usize, speed: f64) -> f64 {
        let on_it = self.wheels.iter().filter(|wheel| wheel.shaft == shaft);
        let at_wheels = on_it.map(|it| it.loss.act(it.mass * self.gravity.norm(), speed));
        let own = self.shafts[shaft].loss.act(0.0, speed);
        let all = at_wheels.chain(std::iter::once(own));
        all.map(|it| it.torques[0] + it.torques[1]).sum()
    }

    /// Everything that turns.
    pub(crate) fn turns_mut(&mut self) -> impl Iterator<Item = &mut Turn> {
        let wheels = self.wheels.iter_mut().map(|wheel| &mut wheel.turn);
        let shafts = self.shafts.iter_mut().map(|shaft| &mut shaft.turn);
        wheels.chain(shafts)
    }

    /// Twist φ of a coupling and its rate.
    pub(crate) fn twist(&self, coupling: &Coupling, at: Moment<'_>) -> [f64; 2] {
        let [from, to] = coupling.shafts.map(|index| {
            let kinematics = self.shafts[index].turn.kinematics(at.t, at.q, at.v);
            [kinematics.position, kinematics.rate]
        });
        [to[0] - from[0], to[1] - from[1]]
    }

    /// Coordinates that twist a coupling, with ∂φ/∂q.
    pub(crate) fn twisted_by(&self, coupling: &Coupling) -> impl Iterator<Item = (usize, f64)> {
        let ends = coupling.shafts.into_iter().zip([-1.0, 1.0]);
        ends.filter_map(|(index, sign)| {
            let turned = self.shafts[index].turn.turned_by();
            turned.map(|(dof, ratio)| (dof, sign * ratio))
        })
    }

    /// Torque of a coupling, M = k φ + c φ̇ \[N m\], and the rate of its twist.
    pub(crate) fn coupling_torque(&self, coupling: &Coupling, at: Moment<'_>) -> [f64; 2] {
        let [twist, rate] = self.twist(coupling, at);
        [coupling.stiffness * twist + coupling.damping * rate, rate]
    }
}

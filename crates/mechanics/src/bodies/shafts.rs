//! Shafts, compiled: what turns, and what turns with it.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::{Bodies, Wheel, WheelSupport};
use crate::course::Path;
use crate::kinematics::Kinematics;
use crate::{Coupling, Motion, ShaftLoss, Torque};

/// Angle of a shaft as a function of time or state.
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
    /// Index of the shaft that leads its train.
    pub(crate) train: usize,
}

/// Drive of a train of shafts.
#[derive(Clone, Debug)]
pub(crate) enum TurnedBy {
    Motion(Motion),
    /// An entry of the state.
    Coordinate(usize),
    /// A course that somebody has set, in the place of an entry of the state.
    Driven {
        dof: usize,
        path: Box<Path>,
    },
}

impl Turn {
    /// The angle and its rates; the acceleration is known where the motion is.
    #[inline(always)]
    pub(crate) fn kinematics(&self, t: f64, q: &[f64], v: &[f64]) -> Kinematics {
        let of = self.driving(t, q, v);
        Kinematics {
            position: self.zero + self.ratio * of.position,
            rate: self.ratio * of.rate,
            acceleration: self.ratio * of.acceleration,
        }
    }

    /// Motion or coordinate x, with its rates.
    #[inline(always)]
    pub(crate) fn driving(&self, t: f64, q: &[f64], v: &[f64]) -> Kinematics {
        match &self.by {
            TurnedBy::Motion(motion) => motion.at(t),
            TurnedBy::Driven { path, .. } if t >= path.since() => path.at(t),
            // A course begins at the end of a step: within that the coordinate still turned it.
            TurnedBy::Coordinate(dof) | TurnedBy::Driven { dof, .. } => Kinematics {
                position: q[*dof],
                rate: v[*dof],
                acceleration: 0.0,
            },
        }
    }

    /// The entry of the state that goes with it, and how far it turns with that, whether that moves by itself or not.
    pub(crate) fn coordinate(&self) -> Option<(usize, f64)> {
        match self.by {
            TurnedBy::Coordinate(dof) | TurnedBy::Driven { dof, .. } => Some((dof, self.ratio)),
            TurnedBy::Motion(_) => None,
        }
    }

    /// The coordinate that turns it, and how far it turns with that; none where the angle is given in time.
    #[inline(always)]
    pub(crate) fn turned_by(&self) -> Option<(usize, f64)> {
        match self.by {
            TurnedBy::Coordinate(dof) => Some((dof, self.ratio)),
            TurnedBy::Motion(_) | TurnedBy::Driven { .. } => None,
        }
    }

    /// Moves the coordinate.
    pub(crate) fn move_dof(&mut self, place: impl FnOnce(usize) -> usize) {
        if let TurnedBy::Coordinate(dof) | TurnedBy::Driven { dof, .. } = &mut self.by {
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
    /// Factor on its loads \[–\].
    pub(crate) load_factor: f64,
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
        let sum = |torques: &[Torque]| torques.iter().map(Torque::drag).sum::<f64>();
        sum(&self.drive) + self.load_factor * sum(&self.load)
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
    /// Lets a course turn a train, or its coordinate again.
    pub(crate) fn turn_by(&mut self, train: usize, path: Option<Path>) {
        for turn in self.turns_mut().filter(|turn| turn.train == train) {
            turn.by = match (&turn.by, path) {
                (TurnedBy::Motion(_), Some(path)) => {
                    TurnedBy::Motion(Motion::Onward(Box::new(path)))
                }
                (TurnedBy::Coordinate(dof) | TurnedBy::Driven { dof, .. }, Some(path)) => {
                    let (dof, path) = (*dof, Box::new(path));
                    TurnedBy::Driven { dof, path }
                }
                (TurnedBy::Driven { dof, .. }, None) => TurnedBy::Coordinate(*dof),
                (TurnedBy::Motion(_) | TurnedBy::Coordinate(_), None) => continue,
            };
        }
        self.renew_rates();
    }

    /// Goes on after the ramps that end at a time \[s\]; whether there are any.
    pub(crate) fn arrive(&mut self, t: f64) -> bool {
        let mut arrives = false;
        for turn in self.turns_mut() {
            if let TurnedBy::Driven { path, .. } | TurnedBy::Motion(Motion::Onward(path)) =
                &mut turn.by
            {
                arrives |= path.arrive(t);
            }
        }
        for wheel in &mut self.wheels {
            if let WheelSupport::Prescribed { x, y } = &mut wheel.support {
                for motion in [x, y] {
                    if let Motion::Onward(path) = motion {
                        arrives |= path.arrive(t);
                    }
                }
            }
        }
        arrives
    }

    /// Inertia of all that turns with a train, reduced to what turns it \[kg m²\].
    pub(crate) fn train_inertia(&self, train: usize) -> f64 {
        let wheels = self.wheels.iter().map(|it| (&it.turn, it.inertia));
        let shafts = self.shafts.iter().map(|it| (&it.turn, it.inertia));
        let all = wheels.chain(shafts);
        // Σ i² J
        all.filter(|(turn, _)| turn.train == train)
            .map(|(turn, inertia)| turn.ratio * turn.ratio * inertia)
            .sum()
    }

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

    /// Angles subject to losses, in the order of their damping: sprockets, then shafts.
    pub(crate) fn resisted(&self) -> impl Iterator<Item = &Turn> {
        let wheels = self.wheels.iter().map(|wheel| &wheel.turn);
        wheels.chain(self.shafts.iter().map(|shaft| &shaft.turn))
    }

    /// Torque of all losses of a shaft at a time and a speed \[N m\], under the weight of its sprockets and the mean force on them: no chain pulls.
    pub(crate) fn idle_torque(&self, shaft: usize, t: f64, speed: f64) -> f64 {
        let on_it = self.wheels.iter().filter(|wheel| wheel.shaft == shaft);
        let carried = |it: &Wheel| {
            if it.forces.is_empty() {
                return it.mass * self.gravity.norm();
            }
            let force = Vector::from(it.forces.sum(|action| action.mean(t)));
            (self.gravity * it.mass + force).norm()
        };
        let at_wheels = on_it.map(|it| it.loss.act(carried(it), speed));
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

//! The questions to every chain, whatever it is made of.
//!
//! A member answers those without an answer here; the answers that are given here hold for every member that keeps them.

use chaindrive_contact::PreparedLaw;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Moment, Weights};

use super::series::Series;
use crate::bodies::{GroupBodies, Surroundings};
use crate::contact::{Frame, PlateContact, Touch};
use crate::energy::Energy;
use crate::seam::{Load, Loads, Moving, Observation, Pose, Rates, Sum, Unknown};
use crate::watch::range_of;

/// A chain in motion. States come as the chain's own part.
pub(crate) trait Makeup: Statics {
    /// Findings and work space of an evaluation.
    type Work;

    /// Whether [`solve`](Self::solve) knows the equations of an implicit step.
    const SOLVES: bool = false;

    /// Whether it wants to know the faces of bodies that its rollers press on, beside the forces.
    const READS_FACES: bool = false;

    fn series(&self) -> &Series;

    fn series_mut(&mut self) -> &mut Series;

    /// Number of coordinates.
    fn coordinates(&self) -> usize;

    /// Description of a coordinate, in words.
    fn name(&self, coordinate: usize) -> String;

    /// Mass or inertia that goes with every coordinate \[kg or kg m²\].
    fn inertias(&self) -> Vec<f64>;

    /// Gives rollers at these places these velocities.
    fn set_off(&self, places: &[Point], velocities: &[Vector], v: &mut [f64]);

    /// Pose of the rollers.
    fn pose<'a>(&self, at: Moment<'a>, work: &'a mut Self::Work) -> Pose<'a>;

    /// Accelerations of the chain, its powers, and what the bodies feel of it.
    ///
    /// The frames of the contacts stand in the loads; powers are added to those of others.
    fn evaluate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        loads: &mut Loads,
        work: &mut Self::Work,
    );

    /// ω² and damping rate D of the stiffest mode, bodies by themselves left out.
    fn rates(&self, around: Surroundings<'_>, loads: &Loads, work: &mut Self::Work) -> Rates;

    /// Appends the tension of every link \[N\].
    fn tensions(&self, at: Moment<'_>, work: &Self::Work, out: &mut Vec<f64>);

    /// The same in place of what is in the list, with the least and the greatest of them; asked for at every step, and rounded as is quickest.
    fn tensions_of_step(&self, at: Moment<'_>, work: &Self::Work, out: &mut Vec<f64>) -> [f64; 2] {
        out.clear();
        self.tensions(at, work, out);
        range_of(out)
    }

    /// Appends what belongs to the chain, forces apart.
    fn observe(&self, at: Moment<'_>, work: &Self::Work, out: &mut Observation);

    /// Adds kinetic energy, weight, and what links or joints store.
    fn energies(&self, at: Moment<'_>, gravity: Vector, work: &Self::Work, out: &mut Energy);

    /// Appends tensions of links, and forces of joints if it has any.
    fn observe_forces(&self, at: Moment<'_>, work: &Self::Work, out: &mut Observation) {
        self.tensions(at, work, &mut out.link_tension);
    }

    /// Joints that have a state of their own: none where links are springs between rollers.
    fn joints(&self) -> usize {
        0
    }

    /// Whether the tension of its links follows from the places of their ends.
    fn has_springs(&self) -> bool {
        true
    }

    /// Strands side by side that share the tension of its links; none where they are not told apart.
    fn strands(&self) -> usize {
        0
    }

    /// Laws of pins in bushes with clearance, and of bushes in free rollers.
    fn bearing_laws(&self) -> [Option<PreparedLaw>; 2] {
        [None, None]
    }

    /// Energy stored in the contacts of link plates with a guide \[J\].
    fn plate_energy(
        &self,
        at: Moment<'_>,
        (plates, touch): (&PlateContact, &Touch),
        frame: &Frame,
        _work: &Self::Work,
    ) -> f64 {
        let pin = |link, end| self.pin_moving(at.q, link, end).place;
        plates.stored(pin, frame, touch)
    }

    /// Puts coordinates that are given in time where they are at t.
    fn drive_ends(&self, _t: f64, _q: &mut [f64], _v: &mut [f64]) {}

    /// Whether damping is so stiff in it that a method had better take it implicitly: that of contacts between bodies is, that of springs
    /// between rollers is not. `touches`: whether there are sprockets or guides that it can touch.
    fn damps_stiffly(&self, _touches: bool) -> bool {
        false
    }

    /// Whether reactions hold its joints: forces that follow from a state by themselves, without a law.
    fn has_reactions(&self) -> bool {
        false
    }

    /// Rids the reactions in the joints of what draws these together where the time stepping has let them open.
    fn show_reactions(&self, _at: Moment<'_>, _work: &mut Self::Work) {}

    /// Frequency \[1/s\] of what every method takes explicitly, beside the mode of [`rates`](Self::rates).
    fn stabilisation(&self) -> f64 {
        0.0
    }

    /// x ← (M + c C + k K)⁻¹ M x over the chain and, after it, the bodies of its group; false where there is no answer.
    fn solve(
        &self,
        _bodies: GroupBodies<'_>,
        _weights: Weights,
        _work: &mut Self::Work,
        _x: &mut [f64],
    ) -> bool {
        false
    }

    /// Largest force in a link or contact \[N\].
    fn pressed(&self, at: Moment<'_>, work: &Self::Work) -> f64 {
        let mut tensions = Vec::new();
        self.tensions(at, work, &mut tensions);
        tensions.iter().fold(0.0, |m, t| f64::max(m, t.abs()))
    }
}

/// A chain as it is laid and settled: forces in equilibrium, and their derivatives.
pub(crate) trait Statics {
    /// Coordinates that are unknown in equilibrium, which are those that can move, in an order that keeps neighbours together.
    fn unknowns(&self) -> Vec<Unknown>;

    /// Derivatives of the circle that runs on the teeth by the coordinates.
    fn roller_moving(&self, q: &[f64], roller: usize) -> Moving;

    /// Derivatives of the first (0) or second (1) pin of a link by the coordinates.
    fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving;

    /// Adds the energy of links or joints, weight, and forces at the ends.
    fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>);

    /// Stiffness of the stiffest link or joint \[N/m\].
    fn stiffest_spring(&self) -> f64;

    /// Mass of the chain, and of its heaviest roller or body \[kg\].
    fn weights(&self) -> [f64; 2];

    /// Length of the chain without load, in nominal pitches a link.
    fn elongation(&self) -> f64;

    /// Makes every link longer by `change` \[m\].
    fn lengthen(&mut self, change: f64);

    /// Largest force out of balance that accelerates a roller or body \[N\].
    fn imbalance(&self, a: &[f64]) -> f64;

    /// Share of a step that moves nothing too far.
    fn reach(&self, step: &[f64]) -> f64;

    /// Moves every roller or body along x and y by what `shift` says.
    fn nudge(&self, q: &mut [f64], shift: impl FnMut() -> f64);

    /// Gives copies of coordinates the values of their originals.
    fn copy_ghosts(&self, _values: &mut [f64]) {}

    /// Whether joints must find their places after the chain was laid: those with play lie somewhere in their bushes.
    fn has_play(&self) -> bool {
        false
    }

    /// Visits the joints that no energy but a condition holds together: the pin and its hole, where they move.
    fn each_hinge(&self, _q: &[f64], _visit: impl FnMut([Moving; 2])) {}

    /// Brings velocities of the chain and, after it, the bodies to where no joint opens.
    fn close_in_motion(&self, _begin: f64, _bodies: GroupBodies<'_>, _q: &[f64], _v: &mut [f64]) {}
}

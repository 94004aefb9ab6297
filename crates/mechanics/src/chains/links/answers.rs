//! Answers of rigid links in motion to the questions of every chain.

use chaindrive_contact::PreparedLaw;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Moment, Weights};

use super::{Hinges, Joining, Linkage, Work};
use crate::bodies::{GroupBodies, Surroundings};
use crate::chains::makeup::Makeup;
use crate::chains::series::Series;
use crate::contact::{Frame, PlateContact, Touch};
use crate::energy::Energy;
use crate::seam::{Loads, Observation, Pose, Rates};

impl Makeup for Linkage {
    type Work = Work;

    const SOLVES: bool = true;
    const READS_FACES: bool = true;

    fn series(&self) -> &Series {
        &self.series
    }

    fn series_mut(&mut self) -> &mut Series {
        &mut self.series
    }

    fn coordinates(&self) -> usize {
        3 * self.bodies.len()
    }

    fn name(&self, coordinate: usize) -> String {
        let body = coordinate / 3;
        let axis = ["x", "y", "its angle"][coordinate % 3];
        if body < self.series.links {
            format!("link {body} along {axis}")
        } else {
            format!("free roller {} along {axis}", body - self.series.links)
        }
    }

    fn inertias(&self) -> Vec<f64> {
        let bodies = self.bodies.iter();
        bodies
            .flat_map(|body| [body.mass, body.mass, body.inertia])
            .collect()
    }

    fn set_off(&self, places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        self.move_with(places, velocities, v);
    }

    fn pose<'a>(&self, at: Moment<'a>, work: &'a mut Work) -> Pose<'a> {
        let posture = &mut work.joint_state.posture;
        self.pose_links(at, posture);
        posture.pose()
    }

    fn evaluate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        loads: &mut Loads,
        work: &mut Work,
    ) {
        self.accelerate(around, at, a, rates, (loads, work));
    }

    fn rates(&self, around: Surroundings<'_>, _loads: &Loads, work: &mut Work) -> Rates {
        self.stiffest_mode(around, work)
    }

    fn tensions(&self, _at: Moment<'_>, work: &Work, out: &mut Vec<f64>) {
        self.link_tensions(&work.joint_state, out);
    }

    fn observe(&self, at: Moment<'_>, work: &Work, out: &mut Observation) {
        self.observe_motion(at, work, out);
    }

    fn energies(&self, at: Moment<'_>, gravity: Vector, work: &Work, out: &mut Energy) {
        self.add_energies(at, gravity, &work.joints, out);
    }

    fn observe_forces(&self, at: Moment<'_>, work: &Work, out: &mut Observation) {
        self.tensions(at, work, &mut out.link_tension);
        self.observe_joints(&work.joint_state, out);
    }

    fn joints(&self) -> usize {
        self.joints.len()
    }

    fn has_springs(&self) -> bool {
        false
    }

    fn bearing_laws(&self) -> [Option<PreparedLaw>; 2] {
        let pins = match &self.joining {
            Joining::Hinges(_) => None,
            Joining::Clearance(bearing) => Some(bearing.law),
        };
        let free = self.free_rollers.as_ref();
        [pins, free.map(|free| free.bearing.law)]
    }

    /// As the last evaluation has them, to the last bit.
    fn plate_energy(
        &self,
        _at: Moment<'_>,
        (plates, touch): (&PlateContact, &Touch),
        frame: &Frame,
        work: &Work,
    ) -> f64 {
        let posture = &work.joint_state.posture;
        let pin = |link, end| posture.tip(link, end).place;
        plates.stored(pin, frame, touch)
    }

    fn damps_stiffly(&self, touches: bool) -> bool {
        let joints = matches!(self.joining, Joining::Clearance(_));
        touches || joints || self.free_rollers.is_some()
    }

    fn has_reactions(&self) -> bool {
        matches!(self.joining, Joining::Hinges(_))
    }

    fn show_reactions(&self, at: Moment<'_>, work: &mut Work) {
        if self.has_reactions() {
            Hinges::undrawn(self, at, &mut work.joint_state);
        }
    }

    fn stabilisation(&self) -> f64 {
        self.explicit_rate()
    }

    fn solve(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        work: &mut Work,
        x: &mut [f64],
    ) -> bool {
        self.implicit_step(bodies, weights, work, x)
    }

    /// Largest force of a contact \[N\].
    fn pressed(&self, _at: Moment<'_>, work: &Work) -> f64 {
        let mut pressed = 0.0_f64;
        self.each_element(&work.joint_state, |element| {
            pressed = pressed.max(element.force);
        });
        pressed
    }
}

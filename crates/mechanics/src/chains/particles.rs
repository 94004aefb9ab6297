//! The particle chain: point masses at the rollers, joined by spring-damper links.
//!
//! ```text
//! q = [ x of the rollers | y of the rollers ]
//! ```
//!
//! The roller arrays are padded to whole lanes. After the last roller of a closed chain stand
//! copies of the first ones; they are given the accelerations of their originals and so follow
//! them bit by bit, and the loops never wrap around.

pub(super) mod articulation;
mod build;
mod drag;
mod ends;
pub(super) mod forces;
pub(super) mod springs;
mod statics;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment, Prediction};
use serde::{Deserialize, Serialize};

use drag::Drag;

use crate::bodies::Surroundings;
use crate::chains::makeup::{Makeup, Statics};
use crate::chains::series::Series;
use crate::contact::Rollers;
use crate::energy::{Energy, Store};
use crate::joints::{JointFindings, Resistance};
use crate::seam::{Loads, Observation, Pose, Rates};

pub(super) use springs::{Links, Pulls, Turning};

/// Rollers as point masses, links as spring-dampers.
#[derive(Clone, Debug)]
pub(crate) struct Particles {
    pub(super) series: Series,
    pub(super) links: Links,
    /// Drag across the links, if any.
    drag: Option<Drag>,
    /// Masses \[kg\] and inverse masses \[1/kg\] of the rollers; held ends have none of the latter.
    pub(super) masses: Array,
    pub(super) inverse_masses: Array,
    /// Inverse mass of the lightest roller \[1/kg\].
    lightest: f64,
    /// ω² of the links alone and twice their damping rate.
    link_rates: [f64; 2],
}

/// Findings in the joints, and how the links turn where something resists that.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Work {
    pub(crate) joints: JointFindings,
    #[serde(skip)]
    turning: Turning,
}

impl Particles {
    #[inline(always)]
    pub(super) fn view<'a>(
        &'a self,
        at: Moment<'a>,
        prediction: Option<Prediction<'_>>,
        a: &'a mut [f64],
    ) -> Rollers<'a> {
        let Moment { q, v, .. } = at;
        let n = self.series.stride;
        let (ax, rest) = a.split_at_mut(n);
        Rollers {
            x: &q[..n],
            y: &q[n..2 * n],
            vx: &v[..n],
            vy: &v[n..2 * n],
            ax,
            ay: &mut rest[..n],
            inverse_mass: &self.inverse_masses[..n],
            spin: &[],
            half_step: prediction.map_or(0.0, |prediction| prediction.half_step),
        }
    }

    /// Place of one roller.
    pub(super) fn place(&self, q: &[f64], roller: usize) -> Point {
        Point::new(q[roller], q[self.series.stride + roller])
    }

    /// Place and velocity of one roller; the index after the last link of a closed chain means its
    /// first roller.
    #[inline(always)]
    pub(super) fn pin(&self, at: Moment<'_>, roller: usize) -> (Point, Vector) {
        let velocity = Vector::new(at.v[roller], at.v[self.series.stride + roller]);
        (self.place(at.q, roller), velocity)
    }

    /// Adds kinetic energy, weight, and what joints store.
    pub(super) fn add_energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        resistance: &Resistance,
        out: &mut Energy,
    ) {
        let n = self.series.stride;
        let columns = [&at.q[..n], &at.q[n..2 * n], &at.v[..n], &at.v[n..2 * n]];
        let [mut kinetic, mut weight] =
            [Store::Chain, Store::Gravity].map(|store| out.stores[store as usize]);
        for roller in 0..self.series.rollers.min(n) {
            let mass = self.masses[roller];
            let [x, y, vx, vy] = columns.map(|column| column[roller]);
            kinetic += 0.5 * mass * Vector::new(vx, vy).norm_squared();
            weight += -mass * gravity.dot(&Vector::new(x, y));
        }
        out.stores[Store::Chain as usize] = kinetic;
        out.stores[Store::Gravity as usize] = weight;
        out.hold_in_joints(resistance.stored);
    }

    /// Distance of the ends of a link \[m\].
    pub(super) fn length(&self, at: Moment<'_>, link: usize) -> f64 {
        (self.place(at.q, link + 1) - self.place(at.q, link)).norm()
    }

    /// The ends of a link, with their velocities.
    #[inline(always)]
    pub(super) fn pins(&self, at: Moment<'_>, link: usize) -> [(Point, Vector); 2] {
        [self.pin(at, link), self.pin(at, link + 1)]
    }

    /// ω² and D as estimated from the links, the deepest contact and the damping.
    ///
    /// ```text
    /// ω_s = D + √(D² + ω²),   ω² = max Σ k/m + max k_c/m,   D = Σ d/m
    /// ```
    ///
    /// The damping rate enters because Verlet's predicted velocity limits h D to 1; that of teeth and guides along their normals does not, where
    /// it is taken at the end of the step.
    ///
    /// `across`: the mobility of what rubs on bodies, in that of the rollers.
    pub(super) fn stiffest_mode(
        &self,
        around: Surroundings<'_>,
        loads: &Loads,
        resistance: &Resistance,
        across: f64,
    ) -> Rates {
        let Surroundings {
            bodies, contacts, ..
        } = around;
        let [mut squared, mut damping] = self.link_rates;
        // Across the links, where these have no stiffness of their own: the stiffer of both counts.
        let [bending, drag] = self.joint_rates(resistance);
        squared = squared.max(bending);
        let dragged = self.drag.as_ref();
        let dragged = dragged.map_or(0.0, |it| it.rate(&self.links, self.lightest));
        damping = damping.max(drag + dragged);
        let (mut contact, mut drag, mut predicted) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (on, wrench) in contacts.teeth.iter().zip(&loads.wheel_wrenches) {
            let stiffness = on.contacts.surface.stiffness(wrench.depth);
            let mobility = bodies.wheels[on.wheel].mobility;
            let shared = mobility * on.contacts.candidates as f64;
            contact = contact.max(stiffness * (self.lightest + shared));
            let rubbing = across * self.lightest + shared;
            drag = drag.max(wrench.damping * rubbing);
            predicted = predicted.max(wrench.across * rubbing);
        }
        for (on, wrench) in contacts.rails.iter().zip(&loads.rail_wrenches) {
            let stiffness = on.contact.surface().stiffness(wrench.depth);
            contact = contact.max(stiffness * self.lightest);
            let rubbing = across * self.lightest;
            drag = drag.max(wrench.damping * rubbing);
            predicted = predicted.max(wrench.across * rubbing);
        }
        Rates {
            squared: squared + contact,
            damping: damping + drag,
            predicted: damping + predicted,
            carried: squared + contact,
        }
    }
}

impl Makeup for Particles {
    type Work = Work;

    fn series(&self) -> &Series {
        &self.series
    }

    fn series_mut(&mut self) -> &mut Series {
        &mut self.series
    }

    fn coordinates(&self) -> usize {
        2 * self.series.stride
    }

    fn name(&self, coordinate: usize) -> String {
        let n = self.series.stride;
        let axis = if coordinate < n { "x" } else { "y" };
        let roller = coordinate % n % self.series.rollers;
        format!("roller {roller} along {axis}")
    }

    fn inertias(&self) -> Vec<f64> {
        [&*self.masses, &self.masses].concat()
    }

    /// Copies after the last roller get the velocities of their originals.
    fn set_off(&self, _places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        for (i, velocity) in velocities.iter().enumerate() {
            v[i] = velocity.x;
            v[self.series.stride + i] = velocity.y;
        }
        self.copy_ghosts(v);
    }

    fn pose<'a>(&self, at: Moment<'a>, _work: &'a mut Work) -> Pose<'a> {
        Pose::of_first(at, self.series.stride)
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

    fn rates(&self, around: Surroundings<'_>, loads: &Loads, work: &mut Work) -> Rates {
        self.stiffest_mode(around, loads, &work.joints.resistance, 1.0)
    }

    fn tensions(&self, at: Moment<'_>, _work: &Work, out: &mut Vec<f64>) {
        let links = (0..self.links.count).map(|link| {
            let pins = [self.pin(at, link), self.pin(at, link + 1)];
            self.links.tension(link, pins)
        });
        out.extend(links);
    }

    fn tensions_of_step(&self, at: Moment<'_>, work: &Work, out: &mut Vec<f64>) -> [f64; 2] {
        let n = self.series.stride;
        let columns = [&at.q[..n], &at.q[n..2 * n], &at.v[..n], &at.v[n..2 * n]];
        out.resize(self.links.rest.len(), 0.0);
        let pulls = springs::pulls(&self.links, columns, &work.turning, out);
        let range = self.series.registers.dispatch(pulls);
        out.truncate(self.links.count);
        range
    }

    fn observe(&self, at: Moment<'_>, _work: &Work, out: &mut Observation) {
        out.add_rollers(Pose::of_first(at, self.series.stride), self.series.rollers);
    }

    fn energies(&self, at: Moment<'_>, gravity: Vector, work: &Work, out: &mut Energy) {
        self.add_energies(at, gravity, &work.joints.resistance, out);
        let links =
            (0..self.links.count).map(|link| self.links.stored(link, self.length(at, link)));
        out.stores[Store::Links as usize] += links.sum::<f64>();
    }

    fn drive_ends(&self, t: f64, q: &mut [f64], v: &mut [f64]) {
        self.put_ends(t, q, v);
    }
}

//! The particle chain: point masses at the rollers, joined by spring-damper links.
//!
//! ```text
//! q = [ x of the rollers | y of the rollers ]
//! ```
//!
//! The roller arrays are padded to whole lanes. Behind the last roller of a closed chain stand
//! copies of the first ones; they are given the accelerations of their originals and so follow
//! them bit by bit, and the loops never wrap around.

pub(super) mod articulation;
mod build;
mod drag;
mod ends;
pub(super) mod forces;
mod observe;
mod set_off;
pub(super) mod springs;
mod statics;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment, Prediction, Registers};

use drag::Drag;

use super::Record;
use crate::bodies::Surroundings;
use crate::chains::held_end::HeldEnd;
use crate::contact::{PlatePlaces, Rollers};
use crate::joints::Joints;
use crate::seam::{Pose, Rates};

pub(super) use springs::Links;
pub(super) use springs::Turning;

/// Rollers as point masses, links as spring-dampers.
#[derive(Clone, Debug)]
pub(crate) struct Particles {
    pub(super) links: Links,
    /// Resistance of the joints, if there is any.
    pub(super) joints: Option<Joints>,
    /// Drag across the links, if any.
    drag: Option<Drag>,
    pub(super) rollers: usize,
    /// Distance from the x to the y block of the state.
    pub(super) stride: usize,
    pub(super) pitch: f64,
    /// Masses \[kg\] and inverse masses \[1/kg\] of the rollers; held ends have none of the latter.
    pub(super) masses: Array,
    pub(super) inverse_masses: Array,
    pub(super) ends: Vec<HeldEnd>,
    /// Inverse mass of the lightest roller \[1/kg\].
    lightest: f64,
    /// ω² of the links alone and twice their damping rate.
    link_rates: [f64; 2],
    pub(super) registers: Registers,
}

/// The plates of the particle chain: link i between roller i and the next.
impl PlatePlaces for Rollers<'_> {
    fn place(&self, link: usize, end: usize) -> Point {
        self.place(link + end)
    }
}

impl Particles {
    pub(super) fn coordinates(&self) -> usize {
        2 * self.stride
    }

    pub(super) fn free_coordinates(&self) -> usize {
        let free = |i: &usize| self.inverse_masses[*i] > 0.0;
        2 * (0..self.rollers).filter(free).count()
    }

    pub(super) fn name(&self, coordinate: usize) -> String {
        let n = self.stride;
        let axis = if coordinate < n { "x" } else { "y" };
        format!("roller {} along {axis}", coordinate % n % self.rollers)
    }

    pub(super) fn inertias(&self) -> Vec<f64> {
        [&*self.masses, &self.masses].concat()
    }

    pub(super) fn rollers(&self) -> usize {
        self.rollers
    }

    pub(super) fn links(&self) -> usize {
        self.links.count
    }

    pub(super) fn pitch(&self) -> f64 {
        self.pitch
    }

    pub(super) fn elongation(&self) -> f64 {
        let rest: f64 = self.links.rest[..self.links.count].iter().sum();
        let nominal = self.links.count as f64 * self.pitch;
        rest / nominal
    }

    #[inline(always)]
    pub(super) fn view<'a>(
        &'a self,
        at: Moment<'a>,
        prediction: Option<Prediction<'_>>,
        a: &'a mut [f64],
    ) -> Rollers<'a> {
        let Moment { q, v, .. } = at;
        let n = self.stride;
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
        Point::new(q[roller], q[self.stride + roller])
    }

    /// Place and velocity of one roller; the index behind the last link of a closed chain means its
    /// first roller.
    pub(super) fn pin(&self, at: Moment<'_>, roller: usize) -> (Point, Vector) {
        let velocity = Vector::new(at.v[roller], at.v[self.stride + roller]);
        (self.place(at.q, roller), velocity)
    }

    pub(super) fn pose<'a>(&self, at: Moment<'a>, _record: &'a mut Record) -> Pose<'a> {
        let n = self.stride;
        Pose {
            x: &at.q[..n],
            y: &at.q[n..2 * n],
            vx: &at.v[..n],
            vy: &at.v[n..2 * n],
        }
    }

    /// ω² and D as estimated from the links, the deepest contact and the damping.
    ///
    /// ```text
    /// ω_s = D + √(D² + ω²),   ω² = max Σ k/m + max k_c/m,   D = Σ d/m
    /// ```
    ///
    /// The damping rate enters because Verlet's predicted velocity limits h D to 1; that of teeth and guides along their normals does not, where
    /// it is taken at the end of the step.
    pub(super) fn rates(&self, around: Surroundings<'_>, record: &mut Record) -> Rates {
        let Surroundings {
            bodies, contacts, ..
        } = around;
        let [mut squared, mut damping] = self.link_rates;
        // Across the links, where these have no stiffness of their own: the stiffer of both counts.
        let [across, drag] = self.joint_rates(&record.resistance);
        squared = squared.max(across);
        let dragged = self.drag.as_ref();
        let dragged = dragged.map_or(0.0, |it| it.rate(&self.links, self.lightest));
        damping = damping.max(drag + dragged);
        let (mut contact, mut drag, mut predicted) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (on, wrench) in contacts.teeth.iter().zip(&record.loads.wheel_wrenches) {
            let stiffness = on.contacts.surface.stiffness(wrench.depth);
            let mobility = bodies.wheels[on.wheel].mobility;
            let shared = mobility * on.contacts.candidates as f64;
            contact = contact.max(stiffness * (self.lightest + shared));
            drag = drag.max(wrench.damping * (self.lightest + shared));
            predicted = predicted.max(wrench.across * (self.lightest + shared));
        }
        for (on, wrench) in contacts.rails.iter().zip(&record.loads.rail_wrenches) {
            let stiffness = on.contact.surface().stiffness(wrench.depth);
            contact = contact.max(stiffness * self.lightest);
            let damped = wrench.damping * self.lightest;
            drag = drag.max(damped);
            predicted = predicted.max(wrench.across * self.lightest);
        }
        Rates {
            squared: squared + contact,
            damping: damping + drag,
            predicted: damping + predicted,
            carried: squared + contact,
        }
    }

    /// Moves every roller that is not held; copies behind the last one follow.
    pub(super) fn nudge(&self, q: &mut [f64], mut shift: impl FnMut() -> f64) {
        let n = self.stride;
        for i in 0..self.rollers {
            let (x, y) = (shift(), shift());
            if self.inverse_masses[i] > 0.0 {
                q[i] += x;
                q[n + i] += y;
            }
        }
        self.copy_ghosts(q);
    }

    /// Gives the copies behind the last roller of a closed chain the values of their originals.
    pub(super) fn copy_ghosts(&self, values: &mut [f64]) {
        if self.links.closed {
            let n = self.stride;
            for ghost in self.rollers..n {
                values[ghost] = values[ghost % self.rollers];
                values[n + ghost] = values[n + ghost % self.rollers];
            }
        }
    }
}

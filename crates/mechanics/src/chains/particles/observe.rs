//! Quantities that can be read off a particle chain.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::Particles;
use crate::chains::Record;
use crate::contact::{Frame, PlateContact};
use crate::energy::{Energy, Store};
use crate::seam::Observation;

impl Particles {
    pub(crate) fn observe(&self, at: Moment<'_>, _record: &Record, out: &mut Observation) {
        let n = self.stride;
        let count = self.rollers;
        out.roller_x.extend_from_slice(&at.q[..count]);
        out.roller_y.extend_from_slice(&at.q[n..n + count]);
        out.roller_vx.extend_from_slice(&at.v[..count]);
        out.roller_vy.extend_from_slice(&at.v[n..n + count]);
    }

    /// Appends the tensions of the links.
    pub(crate) fn observe_forces(&self, at: Moment<'_>, record: &Record, out: &mut Observation) {
        out.link_tension.extend(self.tensions(at, record));
    }

    /// Tension of every link \[N\].
    pub(crate) fn tensions(&self, at: Moment<'_>, _record: &Record) -> Vec<f64> {
        let links = (0..self.links.count).map(|link| {
            let pins = [self.pin(at, link), self.pin(at, link + 1)];
            self.links.tension(link, pins)
        });
        links.collect()
    }

    pub(crate) fn energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        record: &Record,
        out: &mut Energy,
    ) {
        let mut none = vec![0.0; self.coordinates()];
        let rollers = self.view(at, None, &mut none);
        let mut add = |store: Store, value: f64| out.stores[store as usize] += value;
        for i in 0..self.rollers {
            let mass = self.masses[i];
            add(
                Store::Chain,
                0.5 * mass * rollers.velocity(i).norm_squared(),
            );
            add(
                Store::Gravity,
                -mass * gravity.dot(&rollers.place(i).coords),
            );
        }
        add(Store::Links, self.links.stored(&rollers));
        out.hold_in_joints(record.resistance.stored);
    }

    pub(crate) fn plate_energy(
        &self,
        at: Moment<'_>,
        plates: &PlateContact,
        frame: &Frame,
        _record: &Record,
    ) -> f64 {
        let mut none = vec![0.0; self.coordinates()];
        let rollers = self.view(at, None, &mut none);
        plates.stored(&rollers, frame, self.links.count)
    }
}

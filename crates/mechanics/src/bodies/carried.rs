//! What the equations of a step add to works, losses and impulses.

use super::{Bodies, BodyContacts, RailSupport, WheelSupport};
use crate::accounts::{AccountRates, Source};
use crate::contact::Frame;
use crate::energy::Flow;
use crate::seam::Carried;

impl Bodies {
    /// Adds what a chain does beside its forces, in the step that was solved last.
    ///
    /// ```text
    /// W = −M ω − F·v     more, by what is moved as given
    /// ```
    pub(crate) fn add_carried(
        &self,
        contacts: &BodyContacts,
        carried: &Carried,
        frames: &[Frame],
        quadratures: &mut [f64],
    ) {
        let (flows, rest) = quadratures.split_at_mut(Flow::ALL.len());
        let [pins, bushes] = carried.joints;
        flows[Flow::JointLoss as usize] += pins;
        flows[Flow::RollerLoss as usize] += bushes;
        let accounts = &mut self.accounts.rates(&mut rest[..self.accounts.length()]);
        let mut mounts = carried.mounts.iter().zip(frames);
        for (on, (by, frame)) in contacts.teeth.iter().zip(&mut mounts) {
            let wheel = &self.wheels[on.wheel];
            let work = by.moment * frame.spin;
            let given = wheel.turn.turned_by().is_none();
            flows[Flow::ToothLoss as usize] += by.lost;
            if given {
                flows[Flow::Driver as usize] -= work;
            }
            if let WheelSupport::Prescribed { .. } = &wheel.support {
                flows[Flow::Motions as usize] -= by.push.dot(&frame.velocity);
            }
            if accounts.are_kept() {
                let impulse = [by.push.x, by.push.y, by.moment];
                accounts.strike(on.wheel, wheel.shaft, frame.spin, impulse);
                if given {
                    self.supply(wheel.shaft, -work, accounts);
                }
            }
        }
        for (on, (by, frame)) in contacts.rails.iter().zip(mounts) {
            flows[Flow::GuideLoss as usize] += by.lost;
            if let RailSupport::Prescribed { .. } = &self.rails[on.rail].support {
                flows[Flow::Motions as usize] -= by.push.dot(&frame.velocity);
            }
            if accounts.are_kept() {
                accounts.strike_guide(on.rail, [by.push.x, by.push.y], by.lost);
            }
        }
    }

    /// Adds work of a given motion on a shaft, which comes through the gears of its train.
    fn supply(&self, shaft: usize, work: f64, accounts: &mut AccountRates<'_>) {
        let leader = self.shafts[shaft].turn.train;
        accounts.add(leader, Source::Motion, work);
        accounts.add(leader, Source::Gears, -work);
        accounts.add(shaft, Source::Gears, work);
    }
}

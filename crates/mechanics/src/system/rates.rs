//! Time scales: how long a step may be.

use super::{RailContact, Record, System};

/// Accepted steps after which the time scale is worked out again. Rarer, and impacts of pins get steps that are too long.
const STEPS_PER_SCALE: u32 = 8;

impl System {
    pub(super) fn renew_time_scales(&mut self, record: &Record) {
        // Stiffness changes little from one step to the next, and the bound has a reserve.
        if !self.renew.1.is_multiple_of(STEPS_PER_SCALE) {
            return;
        }
        let scales = match &self.linkage {
            Some(linkage) => linkage.stiffest(self, &record.play),
            None => [self.stiffest(record); 2],
        };
        self.time_scale = scales[0];
        if let Some(linkage) = &mut self.linkage {
            linkage.time_scales = scales;
        }
    }

    /// 1/ω of the stiffest mode as estimated from the links, the deepest contact and the damping.
    ///
    /// ```text
    /// ω_s = D + √(D² + ω²),   ω² = max Σ k/m + max k_c/m,   D = Σ d/m
    /// ```
    ///
    /// The damping rate enters because Verlet's predicted velocity limits h D to 1.
    fn stiffest(&self, record: &Record) -> f64 {
        let [mut squared, mut damping] = self.link_rates;
        let (mut contact, mut drag) = (0.0_f64, 0.0_f64);
        for (wheel, wrench) in self.wheels.iter().zip(&record.wheel_wrenches) {
            let stiffness = wheel.contacts.surface.stiffness(wrench.depth);
            let seated: usize = wheel.contacts.runs.iter().map(|run| run.count).sum();
            let mobility = wheel.mobility(&self.slides);
            let shared = mobility * seated as f64;
            contact = contact.max(stiffness * (self.lightest + shared));
            drag = drag.max(wrench.damping * (self.lightest + shared));
        }
        for (rail, wrench) in self.rails.iter().zip(&record.rail_wrenches) {
            let surface = match &rail.contact {
                RailContact::Circles(contacts) => &contacts.surface,
                RailContact::Plates(plates) => &plates.surface,
            };
            contact = contact.max(surface.stiffness(wrench.depth) * self.lightest);
            drag = drag.max(wrench.damping * self.lightest);
        }
        squared += contact;
        damping += drag;
        for wheel in &self.wheels {
            let [own, drag] = wheel.own_rates();
            squared = squared.max(own);
            damping = damping.max(drag);
        }
        for slide in &self.slides {
            let (_, lever) = slide.carrier.extension(0.0);
            let light = lever * lever / slide.inertia;
            squared = squared.max(slide.push.stiffness() * light);
            damping = damping.max(slide.push.damping() * light);
        }
        1.0 / (damping + (damping * damping + squared).sqrt())
    }
}

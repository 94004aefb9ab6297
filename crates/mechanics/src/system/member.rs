//! A chain in its drive: its part of the state, its contacts, its windows.

use std::ops::Range;

use chaindrive_integrate::{Moment, Prediction};

use super::offset_spans::OffsetSpans;
use crate::bodies::Surroundings;
use crate::bodies::{Bodies, BodyContacts, Wheel};
use crate::chains::{Chain, Record};
use crate::contact::Impacts;
use crate::seam::{Loads, Rates};

/// One chain and what it touches.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    /// Its name; none where there is one chain only.
    pub(crate) name: Option<String>,
    pub(crate) chain: Chain,
    /// Its entries of the state.
    pub(crate) entries: Range<usize>,
    /// First coordinate of the bodies of its group, counted from that of all bodies.
    pub(crate) first_body: usize,
    pub(crate) contacts: BodyContacts,
    /// Sprockets in path order, for the naming of spans.
    pub(crate) route: Vec<usize>,
    /// Its spans out of line, if it has any.
    pub(super) sideways: Option<OffsetSpans>,
    /// When the windows are renewed: latest time, and accepted steps to go.
    pub(super) renew: (f64, u32),
    /// ω² and damping rate of the stiffest mode.
    pub(crate) rates: Rates,
    /// Impacts since the start: pins in bushes, bushes in rollers.
    pub(crate) joint_impacts: [Impacts; 2],
}

/// Accepted steps after which the windows are renewed at the latest.
const STEPS_PER_WINDOW: u32 = 256;

/// Accepted steps after which the time scale is worked out again. Rarer, and impacts of pins get steps that are too long.
const STEPS_PER_SCALE: u32 = 8;

impl Member {
    pub(crate) fn new(
        chain: Chain,
        first: usize,
        mut contacts: BodyContacts,
        route: Vec<usize>,
    ) -> Self {
        contacts.write_faces(chain.reads_faces());
        Self {
            name: None,
            entries: first..first + chain.coordinates(),
            first_body: 0,
            chain,
            contacts,
            route,
            sideways: None,
            renew: (0.0, 0),
            rates: Rates::default(),
            joint_impacts: Default::default(),
        }
    }

    /// The chain's own part of a moment.
    #[inline(always)]
    pub(crate) fn own<'a>(&self, at: Moment<'a>) -> Moment<'a> {
        Moment {
            t: at.t,
            q: &at.q[self.entries.clone()],
            v: &at.v[self.entries.clone()],
            z: &[],
        }
    }

    /// Accelerations of the chain; powers are added.
    #[inline]
    pub(crate) fn evaluate(
        &self,
        bodies: &Bodies,
        at: Moment<'_>,
        prediction: Option<Prediction<'_>>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Record,
    ) {
        // Frames are in memory well before the kernel loads them again.
        self.contacts.frames(bodies, at, &mut record.loads.frames);
        if self.chain.can_solve() {
            let Loads { frames, ways, .. } = &mut record.loads;
            self.contacts.ways(bodies, at, frames, ways);
        }
        let around = Surroundings {
            bodies,
            first: bodies.first + self.first_body,
            contacts: &self.contacts,
            prediction,
        };
        let a = &mut a[self.entries.clone()];
        self.chain.evaluate(around, self.own(at), a, rates, record);
    }

    /// Takes over what was found at an accepted state.
    pub(crate) fn commit(&mut self, t: f64, record: &mut Record, bodies: &Bodies) {
        self.contacts.commit(t, &mut record.loads);
        for (impacts, (begun, depth)) in self.joint_impacts.iter_mut().zip(record.joints()) {
            impacts.note(&begun, depth);
        }
        // Stiffness changes little from one step to the next, and the bound has a reserve.
        if self.renew.1.is_multiple_of(STEPS_PER_SCALE) {
            self.rates = self.rates_at(bodies, record);
        }
    }

    /// ω² and damping rate of the stiffest mode at an evaluation.
    pub(crate) fn rates_at(&self, bodies: &Bodies, record: &mut Record) -> Rates {
        let around = Surroundings {
            bodies,
            first: bodies.first + self.first_body,
            contacts: &self.contacts,
            prediction: None,
        };
        self.chain.rates(around, record)
    }

    /// Radius \[m\] of the circle on which the rollers of a wheel lie: its pitch circle, or that of a worn chain, which
    /// rides higher by as much as it is longer.
    pub(crate) fn riding_radius(&self, wheel: &Wheel) -> f64 {
        // R ℓ/p
        wheel.pitch_radius * self.chain.elongation().max(1.0)
    }

    /// Last roller on the sprocket where a span begins, and first one on the next, by what lies on every sprocket; none where nothing does.
    pub(crate) fn span_ends(
        &self,
        seats: &[Option<(usize, usize)>],
        span: usize,
    ) -> Option<(usize, usize)> {
        let seat_on = |k: usize| {
            let wheel = self.route[k % self.route.len()];
            let mut teeth = self.contacts.teeth.iter();
            seats[teeth.position(|on| on.wheel == wheel)?]
        };
        let ((_, last), (first, _)) = (seat_on(span)?, seat_on(span + 1)?);
        Some((last, first))
    }

    /// Counts an accepted step, and renews the windows when it is time.
    pub(crate) fn look_around(&mut self, bodies: &Bodies, at: Moment<'_>, record: &mut Record) {
        self.renew.1 = self.renew.1.saturating_sub(1);
        if at.t >= self.renew.0 || self.renew.1 == 0 {
            self.renew_windows(bodies, at, record);
        }
    }

    pub(crate) fn renew_windows(&mut self, bodies: &Bodies, at: Moment<'_>, record: &mut Record) {
        let margin = 0.5 * self.chain.pitch();
        let own = self.own(at);
        let pose = self.chain.pose(own, record);
        let rollers = self.chain.rollers();
        let speed = self.contacts.renew(bodies, at, pose, rollers, margin);
        // No roller may cross half the margin before the next look.
        self.renew = (
            at.t + 0.5 * margin / speed.max(f64::MIN_POSITIVE),
            STEPS_PER_WINDOW,
        );
        self.press_sideways();
    }

    /// Tells the joints which of them are pressed sideways.
    pub(super) fn press_sideways(&mut self) {
        if let Some(sideways) = &mut self.sideways {
            sideways.look(&self.route, &self.contacts.teeth, self.chain.rollers());
            let closed = self.chain.is_closed();
            self.chain
                .press_sideways(|joint| sideways.at(joint, closed));
        }
    }

    /// The counts of the chain, in one order.
    pub(crate) fn impacts(&self) -> impl Iterator<Item = &Impacts> {
        let teeth = self.contacts.teeth.iter().map(|on| &on.impacts);
        let rails = self.contacts.rails.iter().map(|on| &on.impacts);
        teeth.chain(rails).chain(&self.joint_impacts)
    }

    /// The same, to change it.
    pub(crate) fn impacts_mut(&mut self) -> impl Iterator<Item = &mut Impacts> {
        let teeth = self.contacts.teeth.iter_mut().map(|on| &mut on.impacts);
        let rails = self.contacts.rails.iter_mut().map(|on| &mut on.impacts);
        teeth.chain(rails).chain(&mut self.joint_impacts)
    }
}

//! One evaluation of the particle chain: links, teeth, guides, ends.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;
use pulp::Simd;

use super::springs::Turning;
use super::{Particles, articulation};
use crate::bodies::{RailContact, Surroundings};
use crate::chains::kernel::Kernel;
use crate::chains::particles::Work;
use crate::contact::{OfPins, PinAccelerations, PlatePins, Rollers, pressing};
use crate::energy::Flow;
use crate::joints::Resistance;
use crate::lanes::Wide;
use crate::seam::Loads;

impl Particles {
    pub(super) fn accelerate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        (loads, work): (&mut Loads, &mut Work),
    ) {
        self.dispatch(around, at, a, rates, (loads, &mut *work));
        let pull = |link, pins| self.links.tension(link, pins);
        let gravity = around.bodies.gravity;
        let joints = (&work.turning, &work.joints.resistance);
        self.finish(gravity, at, a, rates, joints, pull);
    }

    /// Lets copies follow the first rollers of a closed chain, and holds the ends of another, whose links pull as `pull` says \[N\].
    pub(in crate::chains) fn finish(
        &self,
        gravity: Vector,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        joints: (&Turning, &Resistance),
        pull: impl Fn(usize, [(Point, Vector); 2]) -> f64,
    ) {
        let n = self.series.stride;
        if self.links.closed {
            // A ghost after the first turn copies one of the turn before.
            for ghost in self.series.rollers..n {
                a[ghost] = a[ghost - self.series.rollers];
                a[n + ghost] = a[n + ghost - self.series.rollers];
            }
        } else {
            self.hold_ends(gravity, at, a, rates, joints, pull);
            a[self.series.rollers..n].fill(0.0);
            a[n + self.series.rollers..2 * n].fill(0.0);
        }
    }

    /// Adds the forces of what is around the chain: oil or air, and bodies.
    #[inline(always)]
    pub(in crate::chains) fn meet<S: Simd>(
        &self,
        w: Wide<S>,
        around: Surroundings<'_>,
        t: f64,
        rollers: &mut Rollers<'_>,
        rates: &mut [f64],
        loads: &mut Loads,
    ) {
        let links = &self.links;
        if let Some(drag) = &self.drag {
            rates[Flow::DragLoss as usize] += drag.act(w, links, rollers);
        }
        touch_bodies(w, around, t, rollers, rates, loads);
        if links.closed {
            // The roller after the last link is the first one again, and has to be where plates push it.
            let count = links.count;
            let before = [rollers.ax[0], rollers.ay[0]];
            [rollers.ax[count], rollers.ay[count]] = before;
            plate_forces(w, around, t, rollers, rates, loads);
            rollers.ax[0] += rollers.ax[count] - before[0];
            rollers.ay[0] += rollers.ay[count] - before[1];
        } else {
            plate_forces(w, around, t, rollers, rates, loads);
        }
    }
}

/// Contacts of the rollers with wheels and guides.
#[inline(always)]
pub(in crate::chains) fn touch_bodies<S: Simd>(
    w: Wide<S>,
    around: Surroundings<'_>,
    t: f64,
    rollers: &mut Rollers<'_>,
    rates: &mut [f64],
    loads: &mut Loads,
) {
    let Surroundings {
        bodies, contacts, ..
    } = around;
    // One call of the kernel serves wheels and rails: it is inlined, and long.
    let wheels = contacts.teeth.len();
    for i in 0..wheels + contacts.rails.len() {
        let (contacts, yielding, (touch, wrench)) = if i < wheels {
            let on = &contacts.teeth[i];
            // All that may press on the wheel count, whether they do or not.
            let yielding = bodies.wheels[on.wheel].mobility * on.contacts.candidates as f64;
            let answer = (&mut loads.teeth[i], &mut loads.wheel_wrenches[i]);
            (&on.contacts, yielding, answer)
        } else {
            let on = &contacts.rails[i - wheels];
            let RailContact::Circles(contacts) = &on.contact else {
                continue;
            };
            let yielding = bodies.rails[on.rail].mobility * contacts.candidates as f64;
            let rail = i - wheels;
            let answer = (&mut loads.rails[rail], &mut loads.rail_wrenches[rail]);
            (contacts, yielding, answer)
        };
        let yielding = Some(yielding);
        contacts.act(w, t, &loads.frames[i], rollers, yielding, touch, wrench);
        let [loss, friction] = if i < wheels {
            [Flow::ToothLoss, Flow::ToothFriction]
        } else {
            [Flow::GuideLoss, Flow::GuideFriction]
        };
        // Losses of teeth and guides are told apart.
        rates[loss as usize] += wrench.normal_loss;
        rates[friction as usize] += wrench.friction_loss;
    }
}

/// Contacts of link plates with guides.
#[inline(always)]
pub(in crate::chains) fn plate_forces<S: Simd>(
    w: Wide<S>,
    around: Surroundings<'_>,
    t: f64,
    pins: &mut impl PlatePins,
    rates: &mut [f64],
    loads: &mut Loads,
) {
    let frames = &loads.frames[around.contacts.teeth.len()..];
    for (i, (on, frame)) in around.contacts.rails.iter().zip(frames).enumerate() {
        let RailContact::Plates(plates) = &on.contact else {
            continue;
        };
        // A call of its own: the kernel stays short where no plate touches.
        let wrench = w.call(pressing(
            plates,
            t,
            *frame,
            &mut *pins,
            around.bodies.rails[on.rail].mobility,
            &mut loads.rails[i],
        ));
        rates[Flow::GuideLoss as usize] += wrench.normal_loss;
        rates[Flow::GuideFriction as usize] += wrench.friction_loss;
        loads.rail_wrenches[i] = wrench;
    }
}

/// The plates of the particle chain: link i between roller i and the next.
impl PlatePins for Rollers<'_> {
    #[inline(always)]
    fn places<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S> {
        between(w, [self.x, self.y], link)
    }

    #[inline(always)]
    fn velocities<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S> {
        between(w, [self.vx, self.vy], link)
    }

    #[inline(always)]
    fn drawn<S: Simd>(&self, w: Wide<S>, link: usize) -> Option<PinAccelerations<S>> {
        Some(PinAccelerations {
            by: between(w, [self.ax, self.ay], link),
            inverse_masses: [
                w.load(self.inverse_mass, link),
                w.load(self.inverse_mass, link + 1),
            ],
            half_step: self.half_step,
        })
    }

    #[inline(always)]
    fn push<S: Simd>(&mut self, w: Wide<S>, link: usize, [first, second]: OfPins<S>) {
        for (roller, [fx, fy]) in [(link, first), (link + 1, second)] {
            let inverse_mass = w.load(self.inverse_mass, roller);
            (w.load(self.ax, roller) + fx * inverse_mass).store(self.ax, roller);
            (w.load(self.ay, roller) + fy * inverse_mass).store(self.ay, roller);
        }
    }
}

/// Values of the rollers at both ends of a lane of links.
#[inline(always)]
fn between<S: Simd>(w: Wide<S>, [x, y]: [&[f64]; 2], link: usize) -> OfPins<S> {
    [
        [w.load(x, link), w.load(y, link)],
        [w.load(x, link + 1), w.load(y, link + 1)],
    ]
}

impl Kernel for Particles {
    #[inline(always)]
    fn forces<S: Simd>(
        &self,
        w: Wide<S>,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        (loads, work): (&mut Loads, &mut Work),
    ) {
        let Work {
            joints: found,
            turning,
        } = work;
        let mut rollers = self.view(at, around.prediction, a);
        let gravity = [around.bodies.gravity.x, around.bodies.gravity.y];
        let links = &self.links;
        // Links first: they set accelerations, and all others add to them.
        let loss = if let Some(joints) = &self.series.joints {
            let loss = links.act::<S, true>(w, &mut rollers, gravity, turning);
            let found = (turning, &mut found.resistance);
            articulation::act(joints, w, at.t, links, found, &mut rollers).add_to(rates);
            loss
        } else {
            links.act::<S, false>(w, &mut rollers, gravity, turning)
        };
        rates[Flow::LinkLoss as usize] += loss;
        self.meet(w, around, at.t, &mut rollers, rates, loads);
    }
}

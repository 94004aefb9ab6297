//! A bush chain of strands side by side: point masses at common pins, plates that share the load, bushes that turn with their links.
//!
//! A particle chain stands inside. It has the pins and their contacts, and all strands together as its links.

mod bushes;
pub(crate) mod model;
mod pack;
mod statics;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::kernel::Kernel;
use super::makeup::Makeup;
use super::particles::{Particles, Turning, articulation};
use super::series::Series;
use crate::bodies::Surroundings;
use crate::energy::{Energy, Flow, Store};
use crate::joints::JointFindings;
use crate::lanes::Wide;
use crate::seam::{Loads, Observation, Pose, Rates};

use model::BushStrands;
use pack::Pack;

/// Joints as point masses, links as springs side by side.
#[derive(Clone, Debug)]
pub(crate) struct Strands {
    chain: Particles,
    pack: Pack,
    /// The inner link that the bush of a joint belongs to.
    bearers: Vec<usize>,
    /// Mobility of the place where a bush rubs, in that of its joint \[–\].
    across: f64,
}

/// Findings in the joints, and how links and bushes turn.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Work {
    pub(crate) joints: JointFindings,
    #[serde(skip)]
    turning: Turning,
    #[serde(skip)]
    spin: Array,
}

impl Strands {
    /// In the place of particles that stand for all strands together, with bushes of this radius \[m\].
    pub(super) fn new(chain: Particles, model: &BushStrands, radius: f64) -> Self {
        // J M⁻¹ Jᵀ: t + r n/ℓ at the joint of the bush, −r n/ℓ at the other end of its link
        let lever = radius / chain.series.pitch;
        Self {
            pack: Pack::new(model, &chain.links),
            bearers: bushes::bearers(model, &chain),
            across: (1.0 + lever) * (1.0 + lever) + lever * lever,
            chain,
        }
    }

    /// Tensions of all strands of a link \[N\].
    fn shares(&self, at: Moment<'_>, link: usize) -> impl Iterator<Item = f64> {
        let pins = self.chain.pins(at, link);
        self.pack.tensions(&self.chain.links, link, pins)
    }
}

impl Makeup for Strands {
    type Work = Work;

    /// Friction on a bush turns its link.
    const READS_FACES: bool = true;

    fn series(&self) -> &Series {
        self.chain.series()
    }

    fn series_mut(&mut self) -> &mut Series {
        self.chain.series_mut()
    }

    fn coordinates(&self) -> usize {
        self.chain.coordinates()
    }

    fn name(&self, coordinate: usize) -> String {
        self.chain.name(coordinate).replace("roller", "bush")
    }

    fn inertias(&self) -> Vec<f64> {
        self.chain.inertias()
    }

    fn set_off(&self, places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        self.chain.set_off(places, velocities, v);
    }

    fn pose<'a>(&self, at: Moment<'a>, _work: &'a mut Work) -> Pose<'a> {
        Pose::of_first(at, self.chain.series.stride)
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
        self.dispatch(around, at, a, rates, (loads, work));
        let pull = |link, pins| self.pack.tension(&self.chain.links, link, pins);
        let joints = (&work.turning, &work.joints.resistance);
        let gravity = around.bodies.gravity;
        self.chain.finish(gravity, at, a, rates, joints, pull);
    }

    fn rates(&self, around: Surroundings<'_>, loads: &Loads, work: &mut Work) -> Rates {
        let resistance = &work.joints.resistance;
        self.chain
            .stiffest_mode(around, loads, resistance, self.across)
    }

    fn tensions(&self, at: Moment<'_>, _work: &Work, out: &mut Vec<f64>) {
        let links = 0..self.chain.series.links;
        out.extend(links.map(|link| self.shares(at, link).sum::<f64>()));
    }

    fn observe(&self, at: Moment<'_>, _work: &Work, out: &mut Observation) {
        let Series {
            rollers,
            links,
            stride,
            ..
        } = self.chain.series;
        out.add_rollers(Pose::of_first(at, stride), rollers);
        for link in 0..links {
            let ends = |[least, most]: [f64; 2], t: f64| [least.min(t), most.max(t)];
            let [least, most] = self
                .shares(at, link)
                .fold([f64::INFINITY, f64::NEG_INFINITY], ends);
            out.strand_tension_min.push(least);
            out.strand_tension_max.push(most);
        }
    }

    fn energies(&self, at: Moment<'_>, gravity: Vector, work: &Work, out: &mut Energy) {
        let (chain, links) = (&self.chain, 0..self.chain.series.links);
        chain.add_energies(at, gravity, &work.joints.resistance, out);
        let stored = links.map(|link| self.pack.stored(&chain.links, link, chain.length(at, link)));
        out.stores[Store::Links as usize] += stored.sum::<f64>();
    }

    fn strands(&self) -> usize {
        self.pack.count()
    }

    fn drive_ends(&self, t: f64, q: &mut [f64], v: &mut [f64]) {
        self.chain.drive_ends(t, q, v);
    }
}

impl Kernel for Strands {
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
        let Self { chain, pack, .. } = self;
        let Work {
            joints,
            turning,
            spin,
        } = work;
        let links = &chain.links;
        let gravity = [around.bodies.gravity.x, around.bodies.gravity.y];
        let mut bushes = chain.view(at, around.prediction, a);
        rates[Flow::LinkLoss as usize] +=
            links.act_by::<S, true>(w, pack, &mut bushes, gravity, turning);
        self.spin(turning, around.contacts, loads, spin);
        if let Some(resisting) = &chain.series.joints {
            let found = (&mut *turning, &mut joints.resistance);
            articulation::act(resisting, w, at.t, links, found, &mut bushes).add_to(rates);
        }
        bushes.spin = spin;
        chain.meet(w, around, at.t, &mut bushes, rates, loads);
        self.turn(turning, around.contacts, loads, a);
    }
}

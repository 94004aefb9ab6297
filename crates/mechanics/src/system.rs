//! The compiled drive: chains and bodies, evaluated by the time stepping.
//!
//! ```text
//! q = [ coordinates of the first chain | of the next ones | tensioners, shafts, sprocket centres ]
//! ```

mod build;
mod group;
mod independent_systems;
mod inputs;
mod member;
mod memory;
mod offset_spans;
mod pull;
mod solve;
mod watching;

use chaindrive_geometry::Point;
use chaindrive_integrate::{
    Continuity, IntegrationError, Moment, Prediction, Registers, SecondOrderSystem, State, Step,
    Stepper, Verdict, Weights,
};
use serde::{Deserialize, Serialize};

use crate::AssemblyError;
use crate::applied;
use crate::bodies::Bodies;
use crate::chains::{self, Chain, ChainAsLaid};
use crate::contact::Wrench;
use crate::energy::Flow;
use crate::seam::{EventLog, Rates};
use crate::tensioner::Slopes;
use crate::watch::Watch;

pub(crate) use build::{LaidChain, LaidDrive};
pub(crate) use group::Group;
pub(crate) use member::Member;
pub use memory::SystemMemory;

/// A drive ready to move.
#[derive(Clone, Debug)]
pub struct System {
    pub(crate) chains: Vec<Member>,
    pub(crate) bodies: Bodies,
    pub(crate) dofs: usize,
    /// Groups of parts that nothing joins with each other.
    pub(crate) groups: Vec<Group>,
    /// The log of contacts, where one is kept.
    pub(crate) events: Option<EventLog>,
    /// Forces at the ends of the last steps.
    pub(crate) applied: applied::AppliedForces,
    /// 1/ω of the stiffest mode \[s\]: damping included, without that of teeth on particles, without any, and without any and the springs
    /// that steps of one solution carry.
    time_scales: [f64; 4],
    /// Deepest first penetration accepted \[m\], when steps are to be rejected for it.
    onset_depth: Option<f64>,
    /// Time at which it was assembled \[s\].
    pub(crate) begin: f64,
    /// The watch on its steps, where one is kept.
    pub(crate) watch: Option<Box<Watch>>,
}

/// Results of one evaluation: contact states, work space and loads of the bodies.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Record {
    pub(crate) chains: Vec<chains::Record>,
    /// Loads of all chains together on every wheel and rail.
    pub(crate) wheel_wrenches: Vec<Wrench>,
    pub(crate) rail_wrenches: Vec<Wrench>,
    /// Derivatives of pushes with a state, for every tensioner.
    pub(crate) pushes: Vec<Slopes>,
    /// Damping of the losses at every wheel, then of those of every shaft \[N m s\].
    pub(crate) resisting: Vec<f64>,
    /// Work space of readings.
    #[serde(skip)]
    pub(crate) reading: Reading,
}

/// Work space of readings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reading {
    pub(crate) a: Vec<f64>,
    pub(crate) rates: Vec<f64>,
    /// First and last roller on every sprocket of a chain.
    pub(crate) seats: Vec<Option<(usize, usize)>>,
    pub(crate) seated: Vec<usize>,
}

impl System {
    /// Rejects steps in which a contact begins deeper than `depth` \[m\]; `None` accepts any.
    pub fn set_onset_depth(&mut self, depth: Option<f64>) {
        self.onset_depth = depth;
    }

    /// Keeps the forces of contacts and joints as steps apply them, of every step that ends at a time \[s\] or later: what is
    /// [observed](Self::observe) within the last step then has them.
    pub fn keep_forces_from(&mut self, from: f64) {
        self.applied.keep_from(from);
    }

    /// Computes the forces on other registers than those in use: to see what wider lanes gain, and that they agree.
    pub fn compute_on(&mut self, registers: Registers) {
        for member in &mut self.chains {
            member.chain.compute_on(registers);
        }
    }

    /// Takes one step ([`Stepper::advance`]), as it is compiled here, beside the forces: a crate that calls the generic one
    /// compiles it anew, and as well as that crate is optimised.
    ///
    /// What a try finds stands in the record of its evaluation. `commit`, called for the accepted one alone, takes contacts from
    /// there into the memory: a rejected step leaves no trace.
    ///
    /// # Errors
    /// Those of [`Stepper::advance`].
    #[inline(never)]
    pub fn advance(
        &mut self,
        stepper: &mut Stepper<Self>,
        state: &mut State,
    ) -> Result<Step, IntegrationError> {
        stepper.advance(self, state)
    }

    /// Deepest penetration at which a contact may begin \[m\], if there is a limit.
    pub fn onset_depth(&self) -> Option<f64> {
        self.onset_depth
    }

    /// Largest pitch of a chain \[m\].
    pub fn pitch(&self) -> f64 {
        self.chains
            .iter()
            .map(|member| member.chain.pitch())
            .fold(0.0, f64::max)
    }

    /// Whether there is oil between some rollers and teeth.
    pub fn has_films(&self) -> bool {
        let mut teeth = self.chains.iter().flat_map(|it| &it.contacts.teeth);
        teeth.any(|on| on.contacts.surface.film.is_some())
    }

    /// Whether a chain has damping so stiff that a method had better take it implicitly, and all chains let one do so.
    pub fn prefers_implicit_damping(&self) -> bool {
        let mut chains = self.chains.iter();
        self.can_solve() && chains.any(|member| member.chain.damps_stiffly(member.contacts.any()))
    }

    /// Number of rollers of all chains.
    pub fn rollers(&self) -> usize {
        self.sum(Chain::rollers)
    }

    /// Number of links of all chains.
    pub fn links(&self) -> usize {
        self.sum(Chain::links)
    }

    /// Number of joints that have a state of their own: those of rigid links.
    pub fn joints(&self) -> usize {
        self.sum(Chain::joints)
    }

    /// Whether a chain has pins with play in their bushes.
    pub fn has_play(&self) -> bool {
        self.chains.iter().any(|member| member.chain.has_play())
    }

    /// Whether a chain has rollers that are bodies of their own.
    pub fn has_free_rollers(&self) -> bool {
        let mut chains = self.chains.iter();
        chains.any(|member| member.chain.bearing_laws()[1].is_some())
    }

    /// Whether a chain has strands that share its tension.
    pub fn has_strands(&self) -> bool {
        self.chains.iter().any(|member| member.chain.strands() > 0)
    }

    /// The error of statics that end without an equilibrium.
    pub(crate) fn no_equilibrium(
        &self,
        stage: &'static str,
        residual: f64,
        iterations: usize,
    ) -> AssemblyError {
        AssemblyError::NoEquilibrium {
            stage,
            residual,
            iterations,
            tensioned: !self.bodies.slides.is_empty(),
            pull: None,
        }
    }

    /// Degrees of freedom that move: those of held rollers do not count.
    pub fn free_dofs(&self) -> usize {
        self.sum(Chain::free_coordinates) + (self.dofs - self.bodies.first)
    }

    fn sum(&self, of: impl Fn(&Chain) -> usize) -> usize {
        self.chains.iter().map(|member| of(&member.chain)).sum()
    }

    /// Rollers that were tested against some body in the present windows, and bodies.
    pub fn candidates(&self) -> usize {
        self.chains
            .iter()
            .flat_map(|member| member.contacts.circles())
            .map(|contacts| contacts.candidates)
            .sum()
    }

    /// Lays the contact windows and takes the state as the first accepted one.
    pub(crate) fn start(&mut self, t: f64, q: &mut [f64], v: &mut [f64], z: &[f64]) {
        let mut record = self.new_record();
        for member in &mut self.chains {
            member.contacts.set_clock(t);
            member.chain.set_clock(t);
        }
        for (member, record) in self.chains.iter_mut().zip(&mut record.chains) {
            member.renew_windows(&self.bodies, Moment { t, q, v, z }, record);
        }
        let mut a = vec![0.0; self.dofs];
        let mut rates = vec![0.0; self.quadratures() + self.bodies.states];
        self.evaluate(Moment { t, q, v, z }, &mut a, &mut rates, &mut record);
        self.commit(t, q, v, &mut record);
    }

    /// Lays the contact windows anew where everything rests.
    pub(crate) fn look_around(&mut self, q: &[f64], record: &mut Record) {
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(self.begin, q, &still);
        for (member, record) in self.chains.iter_mut().zip(&mut record.chains) {
            member.renew_windows(&self.bodies, at, record);
        }
    }

    /// Where the rollers of every chain are \[m\].
    pub(crate) fn roller_places(&self, at: Moment<'_>) -> Vec<Vec<Point>> {
        let mut record = self.new_record();
        let chains = self.chains.iter().zip(&mut record.chains);
        chains
            .map(|(member, record)| {
                let pose = member.chain.pose(member.own(at), record);
                let places = pose.x.iter().zip(pose.y).take(member.chain.rollers());
                places.map(|(&x, &y)| Point::new(x, y)).collect()
            })
            .collect()
    }

    /// First-order states that belong to a place at rest: nothing flows.
    pub(crate) fn settled_states(&self, q: &[f64]) -> Vec<f64> {
        let still = vec![0.0; q.len()];
        let slides = self.bodies.slides.iter();
        slides
            .filter_map(|slide| slide.settled(slide.pose(q, &still)))
            .collect()
    }

    /// Speed of the fastest roller \[m/s\].
    pub fn fastest_roller(&self, at: Moment<'_>) -> f64 {
        let mut record = self.new_record();
        let chains = self.chains.iter().zip(&mut record.chains);
        chains
            .map(|(member, record)| {
                let pose = member.chain.pose(member.own(at), record);
                let speeds = pose.vx.iter().zip(pose.vy).map(|(x, y)| x.hypot(*y));
                speeds.take(member.chain.rollers()).fold(0.0, f64::max)
            })
            .fold(0.0, f64::max)
    }

    /// Puts another chain in the place of one, with its coordinates and velocities.
    pub(crate) fn replace_chain(
        &mut self,
        index: usize,
        chain: Chain,
        [q, v]: [&mut Vec<f64>; 2],
        [chain_q, chain_v]: [Vec<f64>; 2],
    ) {
        let old = self.chains[index].entries.clone();
        let grown = |entry: usize| entry - old.end + old.start + chain_q.len();
        for member in &mut self.chains[index + 1..] {
            member.entries = grown(member.entries.start)..grown(member.entries.end);
        }
        self.bodies.move_to(grown(self.bodies.first));
        self.dofs = grown(self.dofs);
        let member = &mut self.chains[index];
        member.entries = old.start..old.start + chain_q.len();
        member.contacts.write_faces(chain.reads_faces());
        member.chain = chain;
        q.splice(old.clone(), chain_q);
        v.splice(old, chain_v);
    }

    /// Puts what a chain is made of where its laid particles are; whether that is something else.
    pub(crate) fn put_in_place(
        &mut self,
        index: usize,
        laid: &ChainAsLaid<'_>,
        [q, v]: [&mut Vec<f64>; 2],
    ) -> bool {
        let member = &self.chains[index];
        let at = Moment::stateless(self.begin, q, v);
        let entries = member.entries.clone();
        let bodies = self.group_bodies(self.group_of(index));
        let placed = member.chain.put_in_place(entries, bodies, laid, at);
        let Some((chain, own)) = placed else {
            return false;
        };
        self.replace_chain(index, chain, [q, v], own);
        true
    }

    /// Brings velocities to where no joint opens.
    pub(crate) fn close_in_motion(&self, q: &[f64], v: &mut [f64]) {
        for (index, member) in self.chains.iter().enumerate() {
            let entries = member.entries.clone();
            let group = self.group_bodies(self.group_of(index));
            let mut own = [&v[entries.clone()], &v[group.range()]].concat();
            member
                .chain
                .close_in_motion(self.begin, group, &q[entries.clone()], &mut own);
            let (chain, bodies) = own.split_at(entries.len());
            v[entries].copy_from_slice(chain);
            v[group.range()].copy_from_slice(bodies);
        }
    }

    /// Mass or inertia that goes with every entry of the state \[kg or kg m²\].
    pub(crate) fn inertias(&self) -> Vec<f64> {
        let chains = self
            .chains
            .iter()
            .flat_map(|member| member.chain.inertias());
        chains.chain(self.bodies.inertias.iter().copied()).collect()
    }

    /// ω² and damping rate of the stiffest mode at an evaluation.
    pub(crate) fn rates(&self, record: &mut Record) -> Rates {
        let chains = self.chains.iter().zip(&mut record.chains);
        let rates = chains.map(|(member, record)| member.rates_at(&self.bodies, record));
        rates.fold(
            self.bodies.own_rates(&record.pushes, &record.resisting),
            Rates::max,
        )
    }

    /// Accelerations and powers at a moment.
    fn respond(
        &self,
        at: Moment<'_>,
        prediction: Option<Prediction<'_>>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Record,
    ) {
        rates.fill(0.0);
        a[self.bodies.first..].fill(0.0);
        for (member, record) in self.chains.iter().zip(&mut record.chains) {
            member.evaluate(&self.bodies, at, prediction, a, rates, record);
        }
        self.pull(at, a, rates);
        self.gather(record);
        let wrenches = [&record.wheel_wrenches, &record.rail_wrenches];
        let wrenches = wrenches.map(Vec::as_slice);
        let found = (
            record.pushes.as_mut_slice(),
            record.resisting.as_mut_slice(),
        );
        self.bodies
            .accelerate(at, prediction, a, rates, wrenches, found);
    }

    /// Adds up what the chains do to the bodies.
    fn gather(&self, record: &mut Record) {
        for (member, chain) in self.chains.iter().zip(&record.chains) {
            let loads = &chain.loads;
            for (on, wrench) in member.contacts.teeth.iter().zip(&loads.wheel_wrenches) {
                take(&mut record.wheel_wrenches[on.wheel], wrench, on.first);
            }
            for (on, wrench) in member.contacts.rails.iter().zip(&loads.rail_wrenches) {
                take(&mut record.rail_wrenches[on.rail], wrench, on.first);
            }
        }
    }

    /// ω² and D of everything, as the time scales 1/(D + √(D² + ω²)) and 1/ω.
    fn renew_time_scales(&mut self, pushes: &[Slopes], resisting: &[f64]) {
        let own = self.bodies.own_rates(pushes, resisting);
        let all = self.chains.iter().map(|member| member.rates);
        let Rates {
            squared,
            damping,
            predicted,
            carried,
        } = all.fold(own, Rates::max);
        // τ = 1/(D + √(D² + ω²))
        let scale = |damping: f64| 1.0 / (damping + (damping * damping + squared).sqrt());
        let explicit = self
            .chains
            .iter()
            .map(|member| member.chain.stabilisation());
        let explicit = explicit.fold(0.0, f64::max);
        self.time_scales = [
            scale(damping),
            scale(predicted),
            1.0 / explicit.max(squared.sqrt()),
            1.0 / explicit.max(carried.sqrt()),
        ];
    }
}

/// The first chain at a body sets what it feels, others add to it.
fn take(sum: &mut Wrench, wrench: &Wrench, first: bool) {
    if first {
        sum.force = wrench.force;
        sum.moment = wrench.moment;
        sum.depth = wrench.depth;
        sum.normal_loss = wrench.normal_loss;
        sum.friction_loss = wrench.friction_loss;
        return;
    }
    for axis in 0..2 {
        sum.force[axis] += wrench.force[axis];
    }
    sum.moment += wrench.moment;
    sum.depth = sum.depth.max(wrench.depth);
    sum.normal_loss += wrench.normal_loss;
    sum.friction_loss += wrench.friction_loss;
}

impl SecondOrderSystem for System {
    type Record = Record;

    fn new_record(&self) -> Record {
        let records = self.chains.iter().map(|m| chains::Record::new(&m.contacts));
        Record {
            chains: records.collect(),
            wheel_wrenches: vec![Wrench::default(); self.bodies.wheels.len()],
            rail_wrenches: vec![Wrench::default(); self.bodies.rails.len()],
            pushes: vec![Slopes::default(); self.bodies.slides.len()],
            resisting: vec![0.0; self.bodies.wheels.len() + self.bodies.shafts.len()],
            reading: Reading::default(),
        }
    }

    fn dofs(&self) -> usize {
        self.dofs
    }

    fn quadratures(&self) -> usize {
        Flow::ALL.len() + self.bodies.accounts.length()
    }

    fn states(&self) -> usize {
        self.bodies.states
    }

    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], record: &mut Record) {
        self.respond(at, None, a, rates, record);
    }

    fn evaluate_predicted(
        &self,
        at: Moment<'_>,
        prediction: Prediction<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Record,
    ) {
        self.respond(at, Some(prediction), a, rates, record);
    }

    fn inspect(&self, h: f64, end: &Record) -> Verdict {
        let Some(allowed) = self.onset_depth else {
            return Verdict::Accept;
        };
        let mut share = f64::INFINITY;
        let firsts = end.chains.iter().flat_map(chains::Record::onsets);
        for (depth, before) in firsts.filter(|&(depth, _)| depth > allowed) {
            // Land with the gap half the allowed depth beyond touch, by the secant.
            let beyond = 0.5 * allowed / depth;
            share = share.min(before + (1.0 - before) * beyond);
        }
        if share < 1.0 {
            Verdict::Retry { at_most: h * share }
        } else {
            Verdict::Accept
        }
    }

    fn commit(&mut self, t: f64, q: &mut [f64], v: &mut [f64], end: &mut Record) -> Continuity {
        self.follow(t, q, v);
        if self.applied.wants(t) {
            self.note_applied(Moment { t, q, v, z: &[] }, end);
        }
        if let Some(mut watch) = self.watch.take() {
            watch.see(self, Moment { t, q, v, z: &[] }, end);
            self.watch = Some(watch);
        }
        for (member, record) in self.chains.iter_mut().zip(&mut end.chains) {
            member.commit(t, record, &self.bodies);
        }
        self.renew_time_scales(&end.pushes, &end.resisting);
        for (member, record) in self.chains.iter_mut().zip(&mut end.chains) {
            let entries = member.entries.clone();
            let (q, v) = (&mut q[entries.clone()], &mut v[entries]);
            member.chain.commit(t, q, v, record);
        }
        self.note_events(t);
        for (member, record) in self.chains.iter_mut().zip(&mut end.chains) {
            member.look_around(&self.bodies, Moment { t, q, v, z: &[] }, record);
        }
        if let Some(mut watch) = self.watch.take() {
            watch.look(self, Moment { t, q, v, z: &[] }, end);
            self.watch = Some(watch);
        }
        if self.take_due(t, q, v) {
            Continuity::Jump
        } else {
            Continuity::Smooth
        }
    }

    fn next_event(&self, t: f64) -> f64 {
        self.event_after(t)
    }

    fn time_scale(&self) -> f64 {
        self.time_scales[0]
    }

    fn predicted_time_scale(&self) -> f64 {
        self.time_scales[1]
    }

    fn undamped_time_scale(&self) -> f64 {
        self.time_scales[2]
    }

    fn carried_time_scale(&self) -> f64 {
        self.time_scales[3]
    }

    fn can_solve(&self) -> bool {
        self.chains.iter().all(|member| member.chain.can_solve())
    }

    fn solve(&self, weights: Weights, record: &mut Record, x: &mut [f64]) -> bool {
        self.solve_step(weights, record, x)
    }

    fn add_solved(&self, record: &Record, quadratures: &mut [f64]) {
        for (member, record) in self.chains.iter().zip(&record.chains) {
            let frames = &record.loads.frames;
            self.bodies
                .add_carried(&member.contacts, record.carried(), frames, quadratures);
        }
    }
}

//! Quantities that can be read off a state: tensions, forces, positions, energies.

mod ledger;
mod names;
mod supports;

use chaindrive_geometry::Point;
use chaindrive_integrate::{Moment, SecondOrderSystem};

use crate::applied::{LISTS, StepEnd, blended};
use crate::bodies::WheelContacts;
use crate::contact::MemoryField;
use crate::seam::Observation;
use crate::system::{Member, Reading, Record, System};

pub use names::ChainSize;

/// Readings of a state that are made where somebody wants them: a set. Forces that steps applied, motions of bodies and tensions of links are
/// always among them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sights(u8);

impl Sights {
    /// Answers of the laws: contacts, their depths, films.
    pub const LAWS: Self = Self(1);
    /// The energy ledger.
    pub const ENERGIES: Self = Self(1 << 1);
    /// Tensions of spans.
    pub const SPANS: Self = Self(1 << 2);
    /// Places of rollers.
    pub const PLACES: Self = Self(1 << 3);
    /// Velocities of rollers.
    pub const VELOCITIES: Self = Self(1 << 4);
    /// Tensions of the strands of every link.
    pub const STRANDS: Self = Self(1 << 5);
    /// How links and joints stand that have a state of their own.
    pub const JOINTS: Self = Self(1 << 6);
    /// Everything.
    pub const ALL: Self = Self((1 << 7) - 1);

    /// The sights of both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether some of these are wanted.
    pub const fn has(self, some: Self) -> bool {
        self.0 & some.0 != 0
    }
}

impl System {
    /// Reads everything off a state between or at accepted steps.
    ///
    /// Evaluates the forces once, on `record` as work space; the system does not change. Forces of contacts and joints are those that
    /// steps applied, where they are [kept](Self::keep_forces_from), and else those of the laws at this state.
    pub fn observe(
        &self,
        at: Moment<'_>,
        flows: &[f64],
        record: &mut Record,
        out: &mut Observation,
    ) {
        self.observe_some(Sights::ALL, at, flows, record, out);
    }

    /// Reads off what is wanted, as [`observe`](Self::observe) does; the rest is not to be used, and lists of links and rollers that nobody
    /// wants are empty.
    ///
    /// The laws are evaluated for their own answers and for energies alone, where links are springs and the forces that steps applied are kept.
    pub fn observe_some(
        &self,
        sights: Sights,
        at: Moment<'_>,
        flows: &[f64],
        record: &mut Record,
        out: &mut Observation,
    ) {
        let known = || self.chains.iter().all(|member| member.chain.has_springs());
        let applied = self.applied.around(at.t);
        let evaluates =
            sights.has(Sights::LAWS.and(Sights::ENERGIES)) || applied.is_none() || !known();
        if evaluates {
            let mut reading = std::mem::take(&mut record.reading);
            reading.a.resize(self.dofs, 0.0);
            let states = self.quadratures() + self.bodies.states;
            reading.rates.resize(states, 0.0);
            self.evaluate(at, &mut reading.a, &mut reading.rates, record);
            record.reading = reading;
        }
        out.time = at.t;
        out.clear_chains();
        let mut links = 0;
        for (member, record) in self.chains.iter().zip(&mut record.chains) {
            if evaluates {
                member.chain.show_reactions(member.own(at), record);
            }
            member.chain.observe(member.own(at), record, out);
            links += member.chain.links();
            if sights.has(Sights::STRANDS) {
                out.strand_tension_max.resize(links, f64::NAN);
                out.strand_tension_min.resize(links, f64::NAN);
            }
        }
        for list in forces(out) {
            list.clear();
        }
        for (member, record) in self.chains.iter().zip(&record.chains) {
            member.chain.observe_forces(member.own(at), record, out);
        }
        match applied {
            Some(around) => self.blend_forces(around, out),
            None => self.observe_loads(record, out),
        }
        set_lengths(&mut out.joint_force, &out.joint_force_x, &out.joint_force_y);
        set_lengths(&mut out.bush_force, &out.bush_force_x, &out.bush_force_y);
        self.observe_sprockets(at, record, out);
        let accelerations = evaluates.then_some(&record.reading.a[..]);
        self.observe_supports(at, accelerations, out);
        if sights.has(Sights::LAWS) {
            self.observe_contacts(record, out);
        }
        if sights.has(Sights::SPANS) {
            self.observe_spans(&mut record.reading, out);
        }
        self.observe_shafts(at, out);
        self.observe_tensioners(at, out);
        if sights.has(Sights::ENERGIES) {
            out.energy = self.energy(at, flows, record);
        }
        out.forget_all_but(sights);
    }

    /// Appends the loads of sprockets and guides and the forces of contacts, as an evaluation in the present windows has them.
    fn observe_loads(&self, record: &Record, out: &mut Observation) {
        for wrench in &record.wheel_wrenches {
            out.sprocket_torque.push(wrench.moment);
            out.sprocket_force_x.push(wrench.force[0]);
            out.sprocket_force_y.push(wrench.force[1]);
        }
        for wrench in &record.rail_wrenches {
            out.guide_force_x.push(wrench.force[0]);
            out.guide_force_y.push(wrench.force[1]);
        }
        out.contact_force.resize(self.rollers(), 0.0);
        let mut first = 0;
        for (member, record) in self.chains.iter().zip(&record.chains) {
            let own = &mut out.contact_force[first..][..member.chain.rollers()];
            for (on, touch) in member.contacts.teeth.iter().zip(&record.loads.teeth) {
                on.contacts.add_forces(&touch.state, own);
            }
            first += own.len();
        }
    }

    /// Keeps the forces of a step that is accepted, as `record` has them: tensions of links that are springs are none of them.
    pub(crate) fn note_applied(&mut self, at: Moment<'_>, record: &Record) {
        let mut applied = std::mem::take(&mut self.applied);
        applied.push(at.t, |lists| {
            let mut seen = Observation::default();
            let mut lend = |seen: &mut Observation| {
                let pairs = forces(seen).into_iter().zip(&mut *lists);
                pairs.for_each(|(list, kept)| std::mem::swap(list, kept));
            };
            lend(&mut seen);
            for list in forces(&mut seen) {
                list.clear();
            }
            let mut links = 0;
            for (member, record) in self.chains.iter().zip(&record.chains) {
                let chain = &member.chain;
                links += chain.links();
                if !chain.has_springs() || chain.joints() > 0 {
                    chain.observe_forces(member.own(at), record, &mut seen);
                }
                seen.link_tension.resize(links, 0.0);
            }
            self.observe_loads(record, &mut seen);
            lend(&mut seen);
        });
        self.applied = applied;
    }

    /// Puts the forces that steps applied in the place of those of the laws, or where there are none yet. The tension of links that are
    /// springs is that of their law, and reactions of chains that touch nothing are those of the state at t.
    fn blend_forces(&self, (share, ends): (f64, &[StepEnd; 2]), out: &mut Observation) {
        let [before, now] = ends;
        for (index, list) in forces(out).into_iter().enumerate() {
            let [before, now] = [before, now].map(|end| end.lists[index].as_slice());
            let is_tension = index == LINK_TENSION;
            if !is_tension && !JOINT_FORCES.contains(&index) {
                list.resize(now.len(), 0.0);
                blended(share, before, now, list);
                continue;
            }
            let mut first = 0;
            for member in &self.chains {
                let chain = &member.chain;
                let count = if is_tension {
                    chain.links()
                } else {
                    chain.joints()
                };
                let own = first..first + count;
                first = own.end;
                let reacts = chain.has_reactions() && !member.contacts.any();
                if !(reacts || is_tension && chain.has_springs()) {
                    // A drive begins with one end alone.
                    let before = before.get(own.clone()).unwrap_or_default();
                    blended(share, before, &now[own.clone()], &mut list[own]);
                }
            }
        }
    }

    fn observe_sprockets(&self, at: Moment<'_>, record: &Record, out: &mut Observation) {
        for values in [
            &mut out.contact_depth,
            &mut out.contacts,
            &mut out.sprocket_angle,
            &mut out.sprocket_speed,
            &mut out.sprocket_x,
            &mut out.sprocket_y,
        ] {
            values.clear();
        }
        for (wheel, wrench) in self.bodies.wheels.iter().zip(&record.wheel_wrenches) {
            let kinematics = wheel.kinematics(at.t, at.q, at.v);
            let (centre, _, _) = wheel.centre_kinematics(at.t, at.q, at.v, &self.bodies.slides);
            out.contacts.push(0.0);
            out.contact_depth.push(wrench.depth);
            out.sprocket_angle.push(kinematics.position - wheel.angle);
            out.sprocket_speed.push(kinematics.rate);
            out.sprocket_x.push(centre.x);
            out.sprocket_y.push(centre.y);
        }
    }

    /// Contacts of the sprockets, and films in them.
    fn observe_contacts(&self, record: &Record, out: &mut Observation) {
        out.film_thickness.clear();
        if self.has_films() {
            out.film_thickness.resize(self.rollers(), f64::NAN);
        }
        let mut first = 0;
        for (member, record) in self.chains.iter().zip(&record.chains) {
            for (on, touch) in member.contacts.teeth.iter().zip(&record.loads.teeth) {
                let slots = on.contacts.slots;
                on.contacts.for_each_slot(|slot, roller| {
                    for slot in (0..on.contacts.sides()).map(|side| side * slots + slot) {
                        if touch.state.get(MemoryField::Gap, slot) < 0.0 {
                            out.contacts[on.wheel] += 1.0;
                            if let Some(film) = on.contacts.film(&touch.state, slot) {
                                let thinnest = &mut out.film_thickness[first + roller];
                                *thinnest = film.min(*thinnest);
                            }
                        }
                    }
                });
            }
            first += member.chain.rollers();
        }
    }

    /// Mean tension from the last roller on one sprocket to the first roller on the next.
    fn observe_spans(&self, reading: &mut Reading, out: &mut Observation) {
        let Reading { seats, seated, .. } = reading;
        out.span_tension.clear();
        let (mut first_roller, mut first_link) = (0, 0);
        for member in &self.chains {
            let rollers = member.chain.rollers();
            let links = member.chain.links();
            let teeth = member.contacts.teeth.iter();
            seats.clear();
            for on in teeth {
                let [x, y] = [out.sprocket_x[on.wheel], out.sprocket_y[on.wheel]];
                let place = |i: usize| {
                    let i = first_roller + i;
                    Point::new(out.roller_x[i], out.roller_y[i])
                };
                seats.push(self.seated(member, on, seated, Point::new(x, y), place));
            }
            for i in 0..member.route.len() {
                let tension = match member.span_ends(seats, i) {
                    Some((last, first)) => {
                        let count = (first + rollers - last) % rollers;
                        let sum: f64 = (0..count)
                            .map(|k| out.link_tension[first_link + (last + k) % links])
                            .sum();
                        sum / count.max(1) as f64
                    }
                    None => f64::NAN,
                };
                out.span_tension.push(tension);
            }
            first_roller += rollers;
            first_link += links;
        }
    }

    /// First and last roller, in path order, that lie on a sprocket: on its pitch circle, or as far outside as wear
    /// lifts the chain. `place`: where the rollers of the chain are.
    pub(crate) fn seated(
        &self,
        member: &Member,
        on: &WheelContacts,
        seated: &mut Vec<usize>,
        centre: Point,
        place: impl Fn(usize) -> Point,
    ) -> Option<(usize, usize)> {
        let rollers = member.chain.rollers();
        let pitch = member.chain.pitch();
        // Half a pitch along the tangent a roller is p²/8R outside the circle on which it rides.
        let circle = member.riding_radius(&self.bodies.wheels[on.wheel]);
        let reach = circle + pitch * pitch / (8.0 * circle);
        let on_circle = |i: &usize| (place(*i) - centre).norm_squared() < reach * reach;
        seated.clear();
        on.contacts.for_each_slot(|_, roller| seated.push(roller));
        seated.sort_unstable();
        seated.retain(on_circle);
        // The wrap begins after the widest stretch of rollers that are elsewhere.
        let count = seated.len();
        (0..count)
            .map(|k| {
                let before = seated[(k + count - 1) % count];
                let stretch = (seated[k] + rollers - before - 1) % rollers;
                (stretch, k)
            })
            .max()
            .map(|(_, k)| (seated[k], seated[(k + count - 1) % count]))
    }

    fn observe_shafts(&self, at: Moment<'_>, out: &mut Observation) {
        out.shaft_angle.clear();
        out.shaft_speed.clear();
        out.coupling_torque.clear();
        for shaft in self.bodies.shafts.iter().filter(|it| it.name.is_some()) {
            let kinematics = shaft.turn.kinematics(at.t, at.q, at.v);
            out.shaft_angle.push(kinematics.position);
            out.shaft_speed.push(kinematics.rate);
        }
        for coupling in &self.bodies.couplings {
            let [torque, _] = self.bodies.coupling_torque(coupling, at);
            out.coupling_torque.push(torque);
        }
    }

    fn observe_tensioners(&self, at: Moment<'_>, out: &mut Observation) {
        out.tensioner_position.clear();
        out.tensioner_force.clear();
        out.oil_pressure.clear();
        for slide in &self.bodies.slides {
            let pose = slide.pose(at.q, at.v);
            let (push, _) = slide.pushed(pose, slide.state(at.z));
            out.tensioner_position.push(pose.coordinate);
            out.tensioner_force.push(push.elastic + push.damping);
            out.oil_pressure.extend(slide.pressure(pose, at.z));
        }
    }
}

impl Observation {
    /// Empties the lists of rollers, links and joints that nobody wants: whoever keeps a reading keeps none of them.
    fn forget_all_but(&mut self, sights: Sights) {
        let forget = |of: Sights, lists: &mut [&mut Vec<f64>]| {
            if sights.has(of) {
                return;
            }
            for list in lists {
                list.clear();
            }
        };
        forget(Sights::LAWS, &mut [&mut self.film_thickness]);
        forget(Sights::SPANS, &mut [&mut self.span_tension]);
        forget(
            Sights::PLACES,
            &mut [&mut self.roller_x, &mut self.roller_y],
        );
        forget(
            Sights::VELOCITIES,
            &mut [&mut self.roller_vx, &mut self.roller_vy],
        );
        forget(
            Sights::STRANDS,
            &mut [&mut self.strand_tension_max, &mut self.strand_tension_min],
        );
        forget(
            Sights::JOINTS,
            &mut [
                &mut self.link_angle,
                &mut self.joint_offset_x,
                &mut self.joint_offset_y,
                &mut self.joint_force_x,
                &mut self.joint_force_y,
                &mut self.joint_force,
                &mut self.joint_angle,
                &mut self.joint_depth,
                &mut self.bush_offset_x,
                &mut self.bush_offset_y,
                &mut self.bush_force_x,
                &mut self.bush_force_y,
                &mut self.bush_force,
                &mut self.bush_depth,
            ],
        );
    }
}

/// The lists of an observation that are forces of contacts and joints, or follow from them.
fn forces(out: &mut Observation) -> [&mut Vec<f64>; LISTS] {
    [
        &mut out.contact_force,
        &mut out.sprocket_torque,
        &mut out.sprocket_force_x,
        &mut out.sprocket_force_y,
        &mut out.guide_force_x,
        &mut out.guide_force_y,
        &mut out.link_tension,
        &mut out.joint_force_x,
        &mut out.joint_force_y,
        &mut out.bush_force_x,
        &mut out.bush_force_y,
    ]
}

/// Places of the tensions of links and of the forces of joints among them. Some chains have those of the laws there.
const LINK_TENSION: usize = 6;
const JOINT_FORCES: [usize; 2] = [7, 8];

/// Lengths of vectors.
fn set_lengths(to: &mut Vec<f64>, x: &[f64], y: &[f64]) {
    to.clear();
    to.extend(x.iter().zip(y).map(|(x, y)| x.hypot(*y)));
}

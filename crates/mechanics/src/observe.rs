//! Quantities that can be read off a state: tensions, forces, positions, energies.

use chaindrive_geometry::Point;
use chaindrive_integrate::{Moment, SecondOrderSystem};

use crate::applied::{LISTS, blended};
use crate::bodies::{RailContact, WheelContacts, WheelSupport};
use crate::contact::MemoryField;
use crate::energy::{Energy, Flow, Store};
use crate::seam::Observation;
use crate::system::{Member, Reading, Record, System};
use crate::tensioner::ReducedInertia;

/// Size of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChainSize {
    /// Rollers.
    pub rollers: usize,
    /// Links.
    pub links: usize,
    /// Joints with a state of their own.
    pub joints: usize,
    /// Spans between sprockets.
    pub spans: usize,
}

/// Readings of a state beside places, speeds and forces that steps applied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sights {
    /// Answers of the laws: contacts and their depths, films, energies.
    pub laws: bool,
    /// Tensions of spans.
    pub spans: bool,
}

impl Sights {
    /// Everything.
    pub const ALL: Self = Self {
        laws: true,
        spans: true,
    };

    /// The sights of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            laws: self.laws || other.laws,
            spans: self.spans || other.spans,
        }
    }
}

impl System {
    /// Names of the spans: "from-to" for consecutive sprockets of the route.
    pub fn span_names(&self) -> Vec<String> {
        let routes = self.chains.iter().map(|member| &member.route);
        routes
            .flat_map(|route| {
                let name = |k: usize| &self.bodies.wheels[route[k % route.len()]].name;
                (0..route.len()).map(move |i| format!("{}-{}", name(i), name(i + 1)))
            })
            .collect()
    }

    /// Sprockets at both ends of every span, by index, in the order of [`span_names`](Self::span_names).
    pub fn span_sprockets(&self) -> Vec<[usize; 2]> {
        let routes = self.chains.iter().map(|member| &member.route);
        routes
            .flat_map(|route| (0..route.len()).map(|i| [route[i], route[(i + 1) % route.len()]]))
            .collect()
    }

    /// Number of sprockets that turn by themselves, and of those whose rotation is given, directly or through gears.
    pub fn turning_sprockets(&self) -> [usize; 2] {
        let wheels = &self.bodies.wheels;
        let free = wheels.iter().filter(|it| it.turn.turned_by().is_some());
        let free = free.count();
        [free, wheels.len() - free]
    }

    /// Names of the chains, empty where there is one only; and how many rollers, links, joints and spans each has.
    pub fn chain_sizes(&self) -> Vec<(String, ChainSize)> {
        let size = |member: &Member| ChainSize {
            rollers: member.chain.rollers(),
            links: member.chain.links(),
            joints: member.chain.joints(),
            spans: member.route.len(),
        };
        let members = self.chains.iter();
        members
            .map(|member| (member.name.clone().unwrap_or_default(), size(member)))
            .collect()
    }

    /// Names of the shafts that have one, those that carry no more than a sprocket of their own left out.
    pub fn shaft_names(&self) -> Vec<String> {
        let shafts = self.bodies.shafts.iter();
        shafts.filter_map(|shaft| shaft.name.clone()).collect()
    }

    /// The shaft of a name, or that of the sprocket of a name.
    pub fn shaft_named(&self, name: &str) -> Option<usize> {
        let mut shafts = self.bodies.shafts.iter();
        let own = shafts.position(|shaft| shaft.name.as_deref() == Some(name));
        let wheel = || self.bodies.wheels.iter().find(|wheel| wheel.name == name);
        own.or_else(|| wheel().map(|wheel| wheel.shaft))
    }

    /// The sprocket of a name.
    pub fn sprocket_named(&self, name: &str) -> Option<usize> {
        let mut wheels = self.bodies.wheels.iter();
        wheels.position(|wheel| wheel.name == name)
    }

    /// The tensioner of a name.
    pub fn tensioner_named(&self, name: &str) -> Option<usize> {
        let mut slides = self.bodies.slides.iter();
        slides.position(|slide| slide.name == name)
    }

    /// Names of the couplings.
    pub fn coupling_names(&self) -> Vec<String> {
        let couplings = self.bodies.couplings.iter();
        couplings.map(|coupling| coupling.name.clone()).collect()
    }

    /// Names of the sprockets.
    pub fn sprocket_names(&self) -> Vec<String> {
        self.bodies
            .wheels
            .iter()
            .map(|wheel| wheel.name.clone())
            .collect()
    }

    /// Names of the guides.
    pub fn guide_names(&self) -> Vec<String> {
        self.bodies
            .rails
            .iter()
            .map(|rail| rail.name.clone())
            .collect()
    }

    /// Names of the tensioners.
    pub fn tensioner_names(&self) -> Vec<String> {
        self.bodies
            .slides
            .iter()
            .map(|slide| slide.name.clone())
            .collect()
    }

    /// Names of the tensioners whose oil can be compressed.
    pub fn oil_column_names(&self) -> Vec<String> {
        let slides = self.bodies.slides.iter();
        let columns = slides.filter(|slide| slide.push.pressure(0.0, 0.0).is_some());
        columns.map(|slide| slide.name.clone()).collect()
    }

    /// SI units of the position and of the push of every tensioner.
    pub fn tensioner_units(&self) -> Vec<(&'static str, &'static str)> {
        let carriers = self.bodies.slides.iter().map(|slide| &slide.carrier);
        carriers
            .map(|carrier| (carrier.coordinate_unit(), carrier.push_unit()))
            .collect()
    }

    /// Where in the drive a coordinate of the state belongs, in words.
    pub fn place(&self, dof: usize) -> String {
        let chain = self.chains.iter().find(|m| m.entries.contains(&dof));
        match chain {
            Some(member) => {
                let place = member.chain.name(dof - member.entries.start);
                match &member.name {
                    Some(name) => format!("{place}, in chain `{name}`"),
                    None => place,
                }
            }
            None => self.bodies.name(dof),
        }
    }

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

    /// Reads off what is wanted, as [`observe`](Self::observe) does; the rest is not to be used.
    ///
    /// Places, speeds and forces that steps applied need no evaluation of the laws.
    pub fn observe_some(
        &self,
        sights: Sights,
        at: Moment<'_>,
        flows: &[f64],
        record: &mut Record,
        out: &mut Observation,
    ) {
        let known = || self.chains.iter().all(|member| member.chain.has_springs());
        let evaluates = sights.laws || self.applied.around(at.t).is_none() || !known();
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
            out.strand_tension_max.resize(links, f64::NAN);
            out.strand_tension_min.resize(links, f64::NAN);
        }
        self.observe_forces(at, record, evaluates, out);
        self.blend_forces(at.t, out);
        set_lengths(&mut out.joint_force, &out.joint_force_x, &out.joint_force_y);
        set_lengths(&mut out.bush_force, &out.bush_force_x, &out.bush_force_y);
        self.observe_sprockets(at, record, out);
        if evaluates {
            self.observe_contacts(record, out);
        }
        if sights.spans {
            self.observe_spans(&mut record.reading, out);
        }
        self.observe_shafts(at, out);
        self.observe_tensioners(at, out);
        if sights.laws {
            out.energy = self.energy(at, flows, record);
        }
    }

    /// Forces of contacts and joints, as a record has them; zero for rollers where it was not evaluated in the present windows.
    fn observe_forces(
        &self,
        at: Moment<'_>,
        record: &Record,
        evaluated: bool,
        out: &mut Observation,
    ) {
        for list in forces(out) {
            list.clear();
        }
        for (member, record) in self.chains.iter().zip(&record.chains) {
            member.chain.observe_forces(member.own(at), record, out);
        }
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
        if !evaluated {
            return;
        }
        let mut first = 0;
        for (member, record) in self.chains.iter().zip(&record.chains) {
            for (on, touch) in member.contacts.teeth.iter().zip(&record.loads.teeth) {
                let slots = on.contacts.slots;
                on.contacts.for_each_slot(|slot, roller| {
                    for side in 0..on.contacts.sides() {
                        let force = touch.state.get(MemoryField::Force, side * slots + slot);
                        out.contact_force[first + roller] += force;
                    }
                });
            }
            first += member.chain.rollers();
        }
    }

    /// Keeps the forces of a step that is accepted, as `record` has them.
    pub(crate) fn note_applied(&mut self, at: Moment<'_>, record: &Record) {
        let mut applied = std::mem::take(&mut self.applied);
        applied.push(at.t, |lists| {
            let mut seen = Observation::default();
            let mut lend = |seen: &mut Observation| {
                let pairs = forces(seen).into_iter().zip(&mut *lists);
                pairs.for_each(|(list, kept)| std::mem::swap(list, kept));
            };
            lend(&mut seen);
            self.observe_forces(at, record, true, &mut seen);
            lend(&mut seen);
        });
        self.applied = applied;
    }

    /// Puts the forces that steps applied in the place of those of the laws, where they are known. The tension of links that are
    /// springs is that of their law, and reactions of chains that touch nothing are those of the state at t.
    fn blend_forces(&self, t: f64, out: &mut Observation) {
        let Some((share, [before, now])) = self.applied.around(t) else {
            return;
        };
        for (index, list) in forces(out).into_iter().enumerate() {
            let [before, now] = [before, now].map(|end| end.lists[index].as_slice());
            let is_tension = index == LINK_TENSION;
            if !is_tension && !JOINT_FORCES.contains(&index) {
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

    /// The energy ledger of a state that `record` was evaluated at.
    fn energy(&self, at: Moment<'_>, flows: &[f64], record: &Record) -> Energy {
        let mut energy = Energy::default();
        energy.flows.copy_from_slice(&flows[..Flow::ALL.len()]);
        let bodies = &self.bodies;
        for (flow, jumps) in [Flow::Driver, Flow::DriveTorque]
            .into_iter()
            .zip(bodies.inputs.jumps)
        {
            energy.flows[flow as usize] += jumps.until(at.t);
        }
        for (member, record) in self.chains.iter().zip(&record.chains) {
            let own = member.own(at);
            member
                .chain
                .energies(own, bodies.gravity, record, &mut energy);
        }
        let mut add = |store: Store, value: f64| energy.stores[store as usize] += value;
        for wheel in &bodies.wheels {
            let kinematics = wheel.kinematics(at.t, at.q, at.v);
            let (centre, velocity, _) = wheel.centre_kinematics(at.t, at.q, at.v, &bodies.slides);
            let moves = !matches!(wheel.support, WheelSupport::Fixed);
            if wheel.inertia > 0.0 {
                add(
                    Store::Sprockets,
                    0.5 * wheel.inertia * kinematics.rate * kinematics.rate,
                );
            }
            // What a tensioner carries is in the tensioner's inertia and weights.
            if moves && !matches!(wheel.support, WheelSupport::Carried(_)) {
                add(Store::Sprockets, 0.5 * wheel.mass * velocity.norm_squared());
                add(
                    Store::Gravity,
                    -wheel.mass * bodies.gravity.dot(&centre.coords),
                );
            }
            if let WheelSupport::Springs { stiffness, .. } = &wheel.support {
                for axis in 0..2 {
                    let away = centre[axis] - wheel.centre[axis];
                    add(Store::Supports, 0.5 * stiffness[axis] * away * away);
                }
            }
        }
        for (member, record) in self.chains.iter().zip(&record.chains) {
            for (on, touch) in member.contacts.teeth.iter().zip(&record.loads.teeth) {
                add(Store::Teeth, on.contacts.stored(touch));
            }
            for (i, on) in member.contacts.rails.iter().enumerate() {
                let stored = match &on.contact {
                    RailContact::Circles(contacts) => contacts.stored(&record.loads.rails[i]),
                    RailContact::Plates(plates) => {
                        let frame = bodies.rail_frame(on.rail, at);
                        let own = member.own(at);
                        member.chain.plate_energy(own, plates, &frame, record)
                    }
                };
                add(Store::Guides, stored);
            }
        }
        for shaft in bodies.shafts.iter().filter(|shaft| shaft.inertia > 0.0) {
            let rate = shaft.turn.kinematics(at.t, at.q, at.v).rate;
            add(Store::Sprockets, 0.5 * shaft.inertia * rate * rate);
        }
        for coupling in &bodies.couplings {
            let [twist, _] = bodies.twist(coupling, at);
            // U = ½ k φ²
            add(Store::Supports, 0.5 * coupling.stiffness * twist * twist);
        }
        for slide in &bodies.slides {
            let pose = slide.pose(at.q, at.v);
            let ReducedInertia { inertia, .. } = slide.reduced(pose);
            add(Store::Carriers, 0.5 * inertia * pose.rate * pose.rate);
            add(Store::Tensioners, slide.stored(pose, at.z));
            if slide.dof.is_some() {
                for (mass, place) in slide.weights() {
                    let (place, _) = slide.carry(pose, place);
                    add(Store::Gravity, -mass * bodies.gravity.dot(&place.coords));
                }
            }
        }
        energy
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

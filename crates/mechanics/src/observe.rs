//! What can be read off a state: tensions, forces, positions, energies.

use chaindrive_geometry::Point;
use chaindrive_integrate::{Moment, SecondOrderSystem};

use crate::contact::{Frame, PlateContact};
use crate::energy::{Energy, Flow, Store};
use crate::linkage::rates::LinkPlaces;
use crate::system::{Pins, RailContact, Record, Wheel, WheelRotation, WheelSupport};
use crate::{Carrier, System};

/// Everything that can be read off one state. SI units; arrays in the order of the drive.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// Time \[s\].
    pub time: f64,
    /// Roller coordinates x and y \[m\], (rollers,) each.
    pub roller_x: Vec<f64>,
    /// See `roller_x`.
    pub roller_y: Vec<f64>,
    /// Roller velocities \[m/s\], (rollers,) each.
    pub roller_vx: Vec<f64>,
    /// See `roller_vx`.
    pub roller_vy: Vec<f64>,
    /// Direction of every rigid link \[rad\], (links,); empty for particles, like all that follows of joints.
    pub link_angle: Vec<f64>,
    /// Eccentricity of every pin, seen from the centre of its bush, x and y \[m\], (joints,) each;
    /// NaN where the chain ends.
    pub joint_offset_x: Vec<f64>,
    /// See `joint_offset_x`.
    pub joint_offset_y: Vec<f64>,
    /// Force on every pin, x and y \[N\], (joints,) each.
    pub joint_force_x: Vec<f64>,
    /// See `joint_force_x`.
    pub joint_force_y: Vec<f64>,
    /// Its magnitude \[N\], (joints,).
    pub joint_force: Vec<f64>,
    /// Direction of the link with the pin from that with the bush \[rad\], (joints,).
    pub joint_angle: Vec<f64>,
    /// Indentation of pin and bush \[m\], (joints,).
    pub joint_depth: Vec<f64>,
    /// Tension of every link, damping included \[N\], (links,).
    pub link_tension: Vec<f64>,
    /// Mean tension of the links between consecutive sprockets of the route \[N\], (spans,).
    pub span_tension: Vec<f64>,
    /// Normal force between every roller and the teeth \[N\], (rollers,).
    pub contact_force: Vec<f64>,
    /// Deepest indentation on every sprocket \[m\], (sprockets,).
    pub contact_depth: Vec<f64>,
    /// Closed contacts on every sprocket, (sprockets,).
    pub contacts: Vec<f64>,
    /// Resultant of the chain on every guide, x and y \[N\], (guides,) each.
    pub guide_force_x: Vec<f64>,
    /// See `guide_force_x`.
    pub guide_force_y: Vec<f64>,
    /// Rotation since the start \[rad\], (sprockets,).
    pub sprocket_angle: Vec<f64>,
    /// Speed \[rad/s\], (sprockets,).
    pub sprocket_speed: Vec<f64>,
    /// Torque of the chain on every sprocket \[N m\], (sprockets,).
    pub sprocket_torque: Vec<f64>,
    /// Resultant of the chain on every sprocket \[N\], (sprockets,) each.
    pub sprocket_force_x: Vec<f64>,
    /// See `sprocket_force_x`.
    pub sprocket_force_y: Vec<f64>,
    /// Centres \[m\], (sprockets,) each.
    pub sprocket_x: Vec<f64>,
    /// See `sprocket_x`.
    pub sprocket_y: Vec<f64>,
    /// Coordinate of every tensioner \[m or rad\], (tensioners,).
    pub tensioner_position: Vec<f64>,
    /// Push of every tensioner \[N or N m\], (tensioners,).
    pub tensioner_force: Vec<f64>,
    /// The energy ledger.
    pub energy: Energy,
}

impl System {
    /// Names of the spans: "from-to" for consecutive sprockets of the route.
    pub fn span_names(&self) -> Vec<String> {
        let n = self.route.len();
        (0..n)
            .map(|i| {
                let name = |k: usize| &self.wheels[self.route[k % n]].name;
                format!("{}-{}", name(i), name(i + 1))
            })
            .collect()
    }

    /// Number of joints of a chain of rigid links; zero for particles.
    pub fn joints(&self) -> usize {
        self.linkage
            .as_ref()
            .map_or(0, |linkage| linkage.joints.len())
    }

    /// Names of the sprockets.
    pub fn sprocket_names(&self) -> Vec<String> {
        self.wheels.iter().map(|wheel| wheel.name.clone()).collect()
    }

    /// Names of the guides.
    pub fn guide_names(&self) -> Vec<String> {
        self.rails.iter().map(|rail| rail.name.clone()).collect()
    }

    /// Names of the tensioners.
    pub fn tensioner_names(&self) -> Vec<String> {
        self.slides.iter().map(|slide| slide.name.clone()).collect()
    }

    /// Where in the drive a coordinate of the state belongs, in words.
    pub fn place(&self, dof: usize) -> String {
        let n = self.stride;
        if let Some(linkage) = &self.linkage
            && dof < linkage.dofs()
        {
            let body = dof / 3;
            let axis = ["x", "y", "its angle"][dof % 3];
            return if body < linkage.links {
                format!("link {body} along {axis}")
            } else {
                format!("free roller {} along {axis}", body - linkage.links)
            };
        }
        if self.linkage.is_none() && dof < 2 * n {
            let axis = if dof < n { "x" } else { "y" };
            return format!("roller {} along {axis}", dof % n % self.rollers);
        }
        let wheel = self
            .wheels
            .iter()
            .find_map(|wheel| match (&wheel.rotation, &wheel.support) {
                (WheelRotation::Free { dof: angle, .. }, _) if *angle == dof => {
                    Some(format!("the angle of sprocket `{}`", wheel.name))
                }
                (_, WheelSupport::Springs { dof: centre, .. })
                    if (*centre..centre + 2).contains(&dof) =>
                {
                    Some(format!("the centre of sprocket `{}`", wheel.name))
                }
                _ => None,
            });
        let slide = self.slides.iter().find(|slide| slide.dof == Some(dof));
        wheel
            .or_else(|| slide.map(|slide| format!("tensioner `{}`", slide.name)))
            .unwrap_or_else(|| format!("coordinate {dof}"))
    }

    /// Reads everything off a state between or at accepted steps.
    ///
    /// Evaluates the forces once, on `record` as work space; the system does not change.
    pub fn observe(
        &self,
        at: Moment<'_>,
        flows: &[f64],
        record: &mut Record,
        out: &mut Observation,
    ) {
        let mut a = vec![0.0; self.dofs];
        let mut rates = vec![0.0; Flow::ALL.len()];
        self.evaluate(at, &mut a, &mut rates, record);
        out.time = at.t;
        if let Some(linkage) = &self.linkage {
            linkage.observe(at, &record.play, out);
        } else {
            self.observe_particles(at, out);
        }
        self.observe_sprockets(at, record, out);
        self.observe_spans(out);
        Self::observe_guides(record, out);
        self.observe_tensioners(at, out);
        out.energy = self.energy(at, flows, record);
    }

    fn observe_particles(&self, at: Moment<'_>, out: &mut Observation) {
        let n = self.stride;
        let count = self.rollers;
        let copy = |to: &mut Vec<f64>, from: &[f64]| {
            to.clear();
            to.extend_from_slice(from);
        };
        copy(&mut out.roller_x, &at.q[..count]);
        copy(&mut out.roller_y, &at.q[n..n + count]);
        copy(&mut out.roller_vx, &at.v[..count]);
        copy(&mut out.roller_vy, &at.v[n..n + count]);
        out.link_tension.clear();
        out.link_tension.extend((0..self.links.count).map(|link| {
            self.links
                .tension(link, [self.pin(at, link), self.pin(at, link + 1)])
        }));
    }

    fn observe_sprockets(&self, at: Moment<'_>, record: &Record, out: &mut Observation) {
        out.contact_force.clear();
        out.contact_force.resize(self.rollers, 0.0);
        for values in [
            &mut out.contact_depth,
            &mut out.contacts,
            &mut out.sprocket_angle,
            &mut out.sprocket_speed,
            &mut out.sprocket_torque,
            &mut out.sprocket_force_x,
            &mut out.sprocket_force_y,
            &mut out.sprocket_x,
            &mut out.sprocket_y,
        ] {
            values.clear();
        }
        for ((wheel, wrench), touch) in self
            .wheels
            .iter()
            .zip(&record.wheel_wrenches)
            .zip(&record.teeth)
        {
            let (frame, course, _) = self.wheel_frame(wheel, at);
            let slots = wheel.contacts.slots;
            let mut closed = 0.0;
            wheel.contacts.for_each_slot(|slot, roller| {
                for side in 0..wheel.contacts.sides() {
                    let force = touch.state.force[side * slots + slot];
                    out.contact_force[roller] += force;
                    if touch.state.gap[side * slots + slot] < 0.0 {
                        closed += 1.0;
                    }
                }
            });
            out.contacts.push(closed);
            out.contact_depth.push(wrench.depth);
            out.sprocket_angle.push(course.position - wheel.angle);
            out.sprocket_speed.push(course.rate);
            out.sprocket_torque.push(wrench.moment);
            out.sprocket_force_x.push(wrench.force[0]);
            out.sprocket_force_y.push(wrench.force[1]);
            out.sprocket_x.push(frame.origin.x);
            out.sprocket_y.push(frame.origin.y);
        }
    }

    /// Mean tension from the last roller on one sprocket to the first roller on the next.
    fn observe_spans(&self, out: &mut Observation) {
        out.span_tension.clear();
        let seats: Vec<Option<(usize, usize)>> = self
            .route
            .iter()
            .map(|&wheel| {
                let centre = Point::new(out.sprocket_x[wheel], out.sprocket_y[wheel]);
                self.seated(wheel, centre, out)
            })
            .collect();
        for i in 0..seats.len() {
            let next = (i + 1) % seats.len();
            let tension = match (seats[i], seats[next]) {
                (Some((_, last)), Some((first, _))) => {
                    let links = (first + self.rollers - last) % self.rollers;
                    let sum: f64 = (0..links)
                        .map(|k| out.link_tension[(last + k) % self.links.count])
                        .sum();
                    sum / links.max(1) as f64
                }
                _ => f64::NAN,
            };
            out.span_tension.push(tension);
        }
    }

    /// Radius \[m\] of the circle on which the rollers of a wheel lie: its pitch circle, or that of a worn chain, which
    /// rides higher by as much as it is longer.
    pub(crate) fn riding_radius(&self, wheel: &Wheel) -> f64 {
        let rest: f64 = self.links.rest[..self.links.count].iter().sum();
        let nominal = self.links.count as f64 * self.pitch;
        // R ℓ/p
        wheel.pitch_radius * (rest / nominal).max(1.0)
    }

    /// First and last roller, in path order, that lie on a sprocket: on its pitch circle, or as far outside as wear
    /// lifts the chain.
    fn seated(&self, wheel: usize, centre: Point, out: &Observation) -> Option<(usize, usize)> {
        let wheel = &self.wheels[wheel];
        // Half a pitch along the tangent a roller is p²/8R outside the circle on which it rides.
        let circle = self.riding_radius(wheel);
        let reach = circle + self.pitch * self.pitch / (8.0 * circle);
        let on = |i: &usize| {
            let d = Point::new(out.roller_x[*i], out.roller_y[*i]) - centre;
            d.norm_squared() < reach * reach
        };
        let mut seated = Vec::new();
        wheel
            .contacts
            .for_each_slot(|_, roller| seated.push(roller));
        seated.sort_unstable();
        seated.retain(on);
        // The wrap begins behind the widest stretch of rollers that are elsewhere.
        let count = seated.len();
        (0..count)
            .map(|k| {
                let before = seated[(k + count - 1) % count];
                let stretch = (seated[k] + self.rollers - before - 1) % self.rollers;
                (stretch, k)
            })
            .max()
            .map(|(_, k)| (seated[k], seated[(k + count - 1) % count]))
    }

    fn observe_guides(record: &Record, out: &mut Observation) {
        out.guide_force_x.clear();
        out.guide_force_y.clear();
        for wrench in &record.rail_wrenches {
            out.guide_force_x.push(wrench.force[0]);
            out.guide_force_y.push(wrench.force[1]);
        }
    }

    fn observe_tensioners(&self, at: Moment<'_>, out: &mut Observation) {
        out.tensioner_position.clear();
        out.tensioner_force.clear();
        for slide in &self.slides {
            let pose = slide.pose(at.q, at.v);
            let (extension, lever) = slide.carrier.extension(pose.coordinate);
            let push = slide.push.force(extension, lever * pose.rate);
            out.tensioner_position.push(pose.coordinate);
            out.tensioner_force.push(push.elastic + push.damping);
        }
    }

    /// The energy ledger of a state that `record` was evaluated at.
    fn energy(&self, at: Moment<'_>, flows: &[f64], record: &Record) -> Energy {
        let mut energy = Energy::default();
        energy.flows.copy_from_slice(flows);
        match &self.linkage {
            Some(linkage) => linkage.energies(at, self.gravity, &record.play, &mut energy),
            None => self.particle_energies(at, &mut energy),
        }
        let mut add = |store: Store, value: f64| energy.stores[store as usize] += value;
        for (wheel, touch) in self.wheels.iter().zip(&record.teeth) {
            let (frame, course, _) = self.wheel_frame(wheel, at);
            let moves = !matches!(wheel.support, WheelSupport::Fixed);
            let spins = wheel.inertia > 0.0 || matches!(wheel.rotation, WheelRotation::Free { .. });
            if spins {
                add(
                    Store::Sprockets,
                    0.5 * wheel.inertia * course.rate * course.rate,
                );
            }
            // What a tensioner carries is in the tensioner's inertia and weights.
            if moves && !matches!(wheel.support, WheelSupport::Carried(_)) {
                add(
                    Store::Sprockets,
                    0.5 * wheel.mass * frame.velocity.norm_squared(),
                );
                add(
                    Store::Gravity,
                    -wheel.mass * self.gravity.dot(&frame.origin.coords),
                );
            }
            if let WheelSupport::Springs { stiffness, .. } = &wheel.support {
                for axis in 0..2 {
                    let away = frame.origin[axis] - wheel.centre[axis];
                    add(Store::Supports, 0.5 * stiffness[axis] * away * away);
                }
            }
            add(Store::Teeth, wheel.contacts.stored(touch));
        }
        for (i, rail) in self.rails.iter().enumerate() {
            let stored = match &rail.contact {
                RailContact::Circles(contacts) => contacts.stored(&record.circles[i]),
                RailContact::Plates(plates) => {
                    let frame = rail.frame(at.t, at.q, at.v, &self.slides);
                    self.plate_energy(at, plates, &frame, record)
                }
            };
            add(Store::Guides, stored);
        }
        for slide in &self.slides {
            let pose = slide.pose(at.q, at.v);
            add(Store::Carriers, 0.5 * slide.inertia * pose.rate * pose.rate);
            let (extension, _) = slide.carrier.extension(pose.coordinate);
            add(Store::Tensioners, slide.push.energy(extension));
            for (mass, place) in &slide.weights {
                let (place, _) = slide.carry(pose, *place);
                let fixed = slide.dof.is_none() && matches!(slide.carrier, Carrier::Arm { .. });
                if !fixed {
                    add(Store::Gravity, -mass * self.gravity.dot(&place.coords));
                }
            }
        }
        energy
    }

    fn particle_energies(&self, at: Moment<'_>, energy: &mut Energy) {
        let mut none = vec![0.0; self.dofs];
        let rollers = self.view(at.q, at.v, &mut none);
        let mut add = |store: Store, value: f64| energy.stores[store as usize] += value;
        for i in 0..self.rollers {
            let mass = self.masses[i];
            add(
                Store::Chain,
                0.5 * mass * rollers.velocity(i).norm_squared(),
            );
            add(
                Store::Gravity,
                -mass * self.gravity.dot(&rollers.place(i).coords),
            );
        }
        add(Store::Links, self.links.stored(&rollers));
    }

    fn plate_energy(
        &self,
        at: Moment<'_>,
        plates: &PlateContact,
        frame: &Frame,
        record: &Record,
    ) -> f64 {
        if self.linkage.is_some() {
            return plates.stored(&LinkPlaces(&record.play), frame, self.links.count);
        }
        let mut none = vec![0.0; self.dofs];
        let mut rollers = self.view(at.q, at.v, &mut none);
        let pins = Pins {
            rollers: &mut rollers,
            count: self.rollers,
        };
        plates.stored(&pins, frame, self.links.count)
    }
}

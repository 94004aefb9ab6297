//! The compiled drive: flat arrays, evaluated by the time stepping.
//!
//! ```text
//! q = [ x of the rollers | y of the rollers | sprocket angles, centres, tensioners ]
//! ```
//!
//! The roller arrays are padded to whole lanes. Behind the last roller of a closed chain stand
//! copies of the first ones; they are given the accelerations of their originals and so follow
//! them bit by bit, and the loops never wrap around.

mod bodies;
mod build;
mod equations;
mod rates;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Continuity, Moment, SecondOrderSystem, Verdict, Weights};
use pulp::{Arch, Scalar128b, Simd, WithSimd};

pub(crate) use bodies::{
    Anchor, Rail, RailContact, RailSupport, Slide, Wheel, WheelRotation, WheelSupport,
};
pub(crate) use build::Laid;

use crate::contact::{ContactMemory, Frame, Places, PlatePins, PlatePlaces, Touch, Wrench};
use crate::energy::Flow;
use crate::events::EventLog;
use crate::lanes::Wide;
use crate::linkage::{Felt, Impulses, Linkage, Play, Posture};
use crate::links::Links;
use crate::motion::Course;
use crate::{End, Motion};

/// A drive ready to move.
#[derive(Clone, Debug)]
pub struct System {
    pub(crate) links: Links,
    pub(crate) rollers: usize,
    /// Distance from the x to the y block of the state.
    pub(crate) stride: usize,
    pub(crate) dofs: usize,
    /// Masses \[kg\] and inverse masses \[1/kg\] of the rollers; held ends have none of the latter.
    pub(crate) masses: Vec<f64>,
    pub(crate) inverse_masses: Vec<f64>,
    pub(crate) gravity: Vector,
    pub(crate) wheels: Vec<Wheel>,
    pub(crate) rails: Vec<Rail>,
    pub(crate) slides: Vec<Slide>,
    pub(crate) ends: Vec<HeldEnd>,
    pub(crate) pitch: f64,
    /// Sprockets in path order, for the naming of spans.
    pub(crate) route: Vec<usize>,
    /// Inverse mass of the lightest roller \[1/kg\].
    pub(crate) lightest: f64,
    /// ω² of the links alone and twice their damping rate.
    pub(crate) link_rates: [f64; 2],
    /// The chain as rigid links, where the scene asks for them; it then replaces the rollers at the
    /// beginning of the state.
    pub(crate) linkage: Option<Linkage>,
    /// Masses and inertias of what stands behind the chain in the state, for rigid links.
    pub(crate) border_inertias: Vec<f64>,
    /// The log of contacts, where one is kept.
    pub(crate) events: Option<EventLog>,
    time_scale: f64,
    /// Deepest first penetration accepted \[m\], when steps are to be rejected for it.
    onset_depth: Option<f64>,
    /// When the windows are renewed: latest time, and accepted steps to go.
    renew: (f64, u32),
    arch: Arch,
    /// Whether to compute as on a processor without AVX2.
    oldest: bool,
}

/// An end roller whose motion or load is given.
#[derive(Clone, Debug)]
pub(crate) struct HeldEnd {
    pub(crate) roller: usize,
    pub(crate) end: End,
    /// Where it was laid.
    pub(crate) place: Point,
}

/// What one evaluation leaves behind: contact states, work space and what the bodies felt.
#[derive(Clone, Debug, Default)]
#[expect(
    clippy::vec_box,
    reason = "what changes hands at every step is a pointer, not seven vectors"
)]
pub struct Record {
    pub(crate) teeth: Vec<Box<Touch>>,
    pub(crate) circles: Vec<Box<Touch>>,
    pub(crate) plates: Vec<ContactMemory>,
    pub(crate) wheel_wrenches: Vec<Wrench>,
    pub(crate) rail_wrenches: Vec<Wrench>,
    /// Frames of the wheels, then of the rails.
    frames: Vec<Frame>,
    pub(crate) play: Play,
    impulses: Impulses,
}

impl Record {
    /// The chain of rigid links, and what it touches.
    pub(crate) fn split(&mut self) -> (&mut Play, Felt<'_>) {
        let felt = Felt {
            teeth: &mut self.teeth,
            circles: &mut self.circles,
            plates: &mut self.plates,
            wheel_wrenches: &mut self.wheel_wrenches,
            rail_wrenches: &mut self.rail_wrenches,
        };
        (&mut self.play, felt)
    }
}

/// The rollers' part of a state, and of its accelerations.
#[derive(Debug)]
pub(crate) struct Rollers<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) vx: &'a [f64],
    pub(crate) vy: &'a [f64],
    pub(crate) ax: &'a mut [f64],
    pub(crate) ay: &'a mut [f64],
    pub(crate) inverse_mass: &'a [f64],
    /// Angular speeds of the circles that touch \[rad/s\]; empty where none of them turns.
    pub(crate) spin: &'a [f64],
}

impl Rollers<'_> {
    #[inline(always)]
    pub(crate) fn place(&self, roller: usize) -> Point {
        Point::new(self.x[roller], self.y[roller])
    }

    #[inline(always)]
    pub(crate) fn velocity(&self, roller: usize) -> Vector {
        Vector::new(self.vx[roller], self.vy[roller])
    }
}

/// The plates of the particle chain: link i between roller i and the next.
pub(crate) struct Pins<'a, 'b> {
    pub(crate) rollers: &'b mut Rollers<'a>,
    pub(crate) count: usize,
}

impl PlatePlaces for Pins<'_, '_> {
    fn place(&self, link: usize, end: usize) -> Point {
        self.rollers.place(link + end)
    }
}

impl PlatePins for Pins<'_, '_> {
    fn velocity(&self, link: usize, end: usize) -> Vector {
        self.rollers.velocity(link + end)
    }

    fn push(&mut self, link: usize, end: usize, force: Vector) {
        // Behind the last roller of a closed chain its copies are only looked at.
        let roller = (link + end) % self.count;
        self.rollers.ax[roller] += force.x * self.rollers.inverse_mass[roller];
        self.rollers.ay[roller] += force.y * self.rollers.inverse_mass[roller];
    }
}

/// Accepted steps after which the windows are renewed at the latest.
const STEPS_PER_WINDOW: u32 = 256;

impl System {
    /// Rejects steps in which a contact begins deeper than `depth` \[m\]; `None` accepts any.
    pub fn set_onset_depth(&mut self, depth: Option<f64>) {
        self.onset_depth = depth;
    }

    /// Computes the forces on particles as the oldest processor of this kind would, by twos: to see what wider lanes
    /// gain.
    pub fn compute_by_twos(&mut self) {
        self.oldest = true;
    }

    /// Deepest penetration at which a contact may begin \[m\], if there is a limit.
    pub fn onset_depth(&self) -> Option<f64> {
        self.onset_depth
    }

    /// Pitch of the chain \[m\].
    pub fn pitch(&self) -> f64 {
        self.pitch
    }

    /// Number of rollers.
    pub fn rollers(&self) -> usize {
        self.rollers
    }

    /// Number of links.
    pub fn links(&self) -> usize {
        self.links.count
    }

    /// Degrees of freedom that move: rollers that are not held count two.
    pub fn free_dofs(&self) -> usize {
        if self.linkage.is_some() {
            return self.dofs;
        }
        2 * (0..self.rollers)
            .filter(|&i| self.inverse_masses[i] > 0.0)
            .count()
            + (self.dofs - 2 * self.stride)
    }

    /// Rollers that were tested against some body in the present windows, and bodies.
    pub fn candidates(&self) -> usize {
        let teeth = self.wheels.iter().map(|w| &w.contacts);
        let circles = self.rails.iter().filter_map(|rail| match &rail.contact {
            RailContact::Circles(contacts) => Some(contacts),
            RailContact::Plates(_) => None,
        });
        teeth
            .chain(circles)
            .flat_map(|c| &c.runs)
            .map(|run| run.count)
            .sum()
    }

    #[inline(always)]
    pub(crate) fn view<'a>(&'a self, q: &'a [f64], v: &'a [f64], a: &'a mut [f64]) -> Rollers<'a> {
        let n = self.stride;
        let (ax, rest) = a.split_at_mut(n);
        Rollers {
            x: &q[..n],
            y: &q[n..2 * n],
            vx: &v[..n],
            vy: &v[n..2 * n],
            ax,
            ay: &mut rest[..n],
            inverse_mass: &self.inverse_masses[..n],
            spin: &[],
        }
    }

    /// Place and velocity of one roller; the index behind the last link of a closed chain means its
    /// first roller.
    pub(crate) fn pin(&self, at: Moment<'_>, roller: usize) -> (Point, Vector) {
        let n = self.stride;
        (
            Point::new(at.q[roller], at.q[n + roller]),
            Vector::new(at.v[roller], at.v[n + roller]),
        )
    }

    /// Frame of a wheel and the course of its angle.
    #[inline(always)]
    pub(crate) fn wheel_frame(&self, wheel: &Wheel, at: Moment<'_>) -> (Frame, Course, Vector) {
        let course = wheel.course(at.t, at.q, at.v);
        let (origin, velocity, acceleration) = wheel.centre_course(at.t, at.q, at.v, &self.slides);
        let frame = Frame {
            origin,
            turn: wheel.anchor.turn(course.position),
            velocity,
            spin: course.rate,
        };
        (frame, course, acceleration)
    }

    #[inline(always)]
    fn forces<S: Simd>(
        &self,
        w: Wide<S>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Record,
    ) {
        rates.fill(0.0);
        a[2 * self.stride..].fill(0.0);
        let mut rollers = self.view(at.q, at.v, a);
        let gravity = [self.gravity.x, self.gravity.y];
        rates[Flow::LinkLoss as usize] = self.links.act(w, &mut rollers, gravity);
        // Frames are in memory well before the kernel loads them again.
        let wheels = self.wheels.len();
        for (frame, wheel) in record.frames.iter_mut().zip(&self.wheels) {
            (*frame, _, _) = self.wheel_frame(wheel, at);
        }
        for (frame, rail) in record.frames[wheels..].iter_mut().zip(&self.rails) {
            *frame = rail.frame(at.t, at.q, at.v, &self.slides);
        }
        // One call of the kernel serves wheels and rails: it is inlined, and long.
        for i in 0..wheels + self.rails.len() {
            let (contacts, touch) = if i < wheels {
                (&self.wheels[i].contacts, &mut record.teeth[i])
            } else {
                let RailContact::Circles(contacts) = &self.rails[i - wheels].contact else {
                    continue;
                };
                (contacts, &mut record.circles[i - wheels])
            };
            let wrench = contacts.act(w, at.t, &record.frames[i], &mut rollers, touch);
            let loss = if i < wheels {
                Flow::ToothLoss
            } else {
                Flow::GuideLoss
            };
            rates[loss as usize] += wrench.normal_loss;
            rates[Flow::FrictionLoss as usize] += wrench.friction_loss;
            if i < wheels {
                record.wheel_wrenches[i] = wrench;
            } else {
                record.rail_wrenches[i - wheels] = wrench;
            }
        }
    }

    /// Contacts of link plates with guides.
    fn plate_forces(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], record: &mut Record) {
        let mut rollers = self.view(at.q, at.v, a);
        for (i, rail) in self.rails.iter().enumerate() {
            let RailContact::Plates(plates) = &rail.contact else {
                continue;
            };
            let frame = rail.frame(at.t, at.q, at.v, &self.slides);
            let mut pins = Pins {
                rollers: &mut rollers,
                count: self.rollers,
            };
            let wrench = plates.act(
                at.t,
                &frame,
                &mut pins,
                self.links.count,
                &mut record.plates[i],
            );
            rates[Flow::GuideLoss as usize] += wrench.normal_loss;
            rates[Flow::FrictionLoss as usize] += wrench.friction_loss;
            record.rail_wrenches[i] = wrench;
        }
    }

    /// Lays the contact windows and takes the state as the first accepted one.
    pub(crate) fn start(&mut self, t: f64, q: &mut [f64], v: &mut [f64]) {
        for wheel in &mut self.wheels {
            wheel.anchor = Anchor::at(wheel.course(t, q, v).position);
        }
        let mut record = self.new_record();
        self.renew_windows(Moment { t, q, v }, &mut record.play.posture);
        let mut a = vec![0.0; self.dofs];
        let mut rates = vec![0.0; Flow::ALL.len()];
        self.evaluate(Moment { t, q, v }, &mut a, &mut rates, &mut record);
        self.commit(t, q, v, &mut record);
    }

    fn renew_windows(&mut self, at: Moment<'_>, posture: &mut Posture) {
        let n = self.stride;
        let [x, y, vx, vy] = if let Some(linkage) = &self.linkage {
            linkage.pose(at, posture);
            [&posture.x, &posture.y, &posture.vx, &posture.vy].map(Vec::as_slice)
        } else {
            let (q, v) = (at.q, at.v);
            [&q[..n], &q[n..2 * n], &v[..n], &v[n..2 * n]]
        };
        let fastest = vx[..self.rollers]
            .iter()
            .zip(vy)
            .map(|(x, y)| x * x + y * y)
            .fold(0.0, f64::max)
            .sqrt();
        let mut speed = fastest;
        let margin = 0.5 * self.pitch;
        let places = Places {
            x,
            y,
            count: self.rollers,
        };
        for i in 0..self.wheels.len() {
            let course = self.wheels[i].course(at.t, at.q, at.v);
            self.wheels[i].anchor = Anchor::at(course.position);
            let (frame, _, _) = self.wheel_frame(&self.wheels[i], at);
            let rim = course.rate.abs() * self.wheels[i].pitch_radius + frame.velocity.norm();
            speed = speed.max(fastest + rim);
            self.wheels[i].contacts.renew(&frame, places, margin);
        }
        for i in 0..self.rails.len() {
            let frame = self.rails[i].frame(at.t, at.q, at.v, &self.slides);
            if let RailContact::Circles(contacts) = &mut self.rails[i].contact {
                contacts.renew(&frame, places, margin);
            }
        }
        // No roller may cross half the margin before the next look.
        self.renew = (
            at.t + 0.5 * margin / speed.max(f64::MIN_POSITIVE),
            STEPS_PER_WINDOW,
        );
    }
}

/// The kernels as one call, compiled for every kind of processor.
struct Forces<'a> {
    system: &'a System,
    at: Moment<'a>,
    a: &'a mut [f64],
    rates: &'a mut [f64],
    record: &'a mut Record,
}

impl WithSimd for Forces<'_> {
    type Output = ();

    // A call that is not inlined would be compiled for the oldest processor only.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.system
            .forces(Wide(simd), self.at, self.a, self.rates, self.record);
    }
}

impl SecondOrderSystem for System {
    type Record = Record;

    fn new_record(&self) -> Record {
        let touches = |count: usize| vec![Box::<Touch>::default(); count];
        Record {
            teeth: touches(self.wheels.len()),
            circles: touches(self.rails.len()),
            plates: vec![ContactMemory::default(); self.rails.len()],
            wheel_wrenches: vec![Wrench::default(); self.wheels.len()],
            rail_wrenches: vec![Wrench::default(); self.rails.len()],
            frames: vec![Frame::fixed(); self.wheels.len() + self.rails.len()],
            play: Play::default(),
            impulses: Impulses::default(),
        }
    }

    fn dofs(&self) -> usize {
        self.dofs
    }

    fn quadratures(&self) -> usize {
        Flow::ALL.len()
    }

    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], record: &mut Record) {
        if let Some(linkage) = &self.linkage {
            linkage.evaluate(self, at, a, rates, record);
            self.bodies(at, a, rates, record);
            return;
        }
        if self.oldest {
            self.forces(Wide(Scalar128b), at, a, rates, record);
        } else {
            self.arch.dispatch(Forces {
                system: self,
                at,
                a: &mut *a,
                rates: &mut *rates,
                record: &mut *record,
            });
        }
        self.plate_forces(at, a, rates, record);
        self.bodies(at, a, rates, record);
        if self.links.closed {
            let n = self.stride;
            // A ghost behind the first turn copies one of the turn before.
            for ghost in self.rollers..n {
                a[ghost] = a[ghost - self.rollers];
                a[n + ghost] = a[n + ghost - self.rollers];
            }
        } else {
            self.hold_ends(at, a, rates);
            let n = self.stride;
            a[self.rollers..n].fill(0.0);
            a[n + self.rollers..2 * n].fill(0.0);
        }
    }

    fn inspect(&self, h: f64, end: &Record) -> Verdict {
        let Some(allowed) = self.onset_depth else {
            return Verdict::Accept;
        };
        let wrenches = end.wheel_wrenches.iter().chain(&end.rail_wrenches);
        let mut share = f64::INFINITY;
        let joints = &end.play.tally;
        let firsts = wrenches
            .map(|w| (w.first_depth, w.first_share))
            .chain([(joints.first_depth, joints.first_share)]);
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
        for (wheel, touch) in self.wheels.iter_mut().zip(&mut end.teeth) {
            std::mem::swap(&mut wheel.contacts.memory, touch);
            wheel.contacts.accepted = t;
        }
        for (i, rail) in self.rails.iter_mut().enumerate() {
            match &mut rail.contact {
                RailContact::Circles(contacts) => {
                    std::mem::swap(&mut contacts.memory, &mut end.circles[i]);
                    contacts.accepted = t;
                }
                RailContact::Plates(plates) => {
                    std::mem::swap(&mut plates.memory, &mut end.plates[i]);
                    plates.accepted = t;
                }
            }
        }
        if let Some(linkage) = &mut self.linkage {
            std::mem::swap(&mut linkage.memory, &mut end.play.memory);
        }
        self.renew_time_scales(end);
        self.note_events(t);
        let n = self.stride;
        for held in self.ends.iter().filter(|_| self.linkage.is_none()) {
            if let End::Driven { x, y } = &held.end {
                let (x, y): (Course, Course) = (Motion::at(x, t), y.at(t));
                q[held.roller] = held.place.x + x.position;
                q[n + held.roller] = held.place.y + y.position;
                v[held.roller] = x.rate;
                v[n + held.roller] = y.rate;
            }
        }
        self.renew.1 = self.renew.1.saturating_sub(1);
        if t >= self.renew.0 || self.renew.1 == 0 {
            self.renew_windows(Moment { t, q, v }, &mut end.play.posture);
        }
        Continuity::Smooth
    }

    fn time_scale(&self) -> f64 {
        self.time_scale
    }

    fn undamped_time_scale(&self) -> f64 {
        match &self.linkage {
            Some(linkage) => linkage.time_scales[1],
            None => self.time_scale,
        }
    }

    fn can_solve(&self) -> bool {
        self.linkage.is_some()
    }

    fn solve(&self, weights: Weights, record: &mut Record, x: &mut [f64]) -> bool {
        match &self.linkage {
            Some(linkage) => {
                linkage.solve(self, weights, &mut record.play, &mut record.impulses, x)
            }
            None => false,
        }
    }
}

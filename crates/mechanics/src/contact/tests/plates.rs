//! Plates in lanes against plates one by one, and lanes that rest.

use chaindrive_contact::friction::Coulomb;
use chaindrive_geometry::{ArcSpline, bar, rail};
use chaindrive_integrate::Registers;
use pulp::WithSimd;

use super::*;

use crate::contact::{Places, PlateContact, Rollers, pressing};
use crate::lanes::padded;
use crate::profile::RailFace;
use crate::surface::Surface;

impl Rollers<'_> {
    fn place(&self, roller: usize) -> Point {
        Point::new(self.x[roller], self.y[roller])
    }

    fn velocity(&self, roller: usize) -> Vector {
        Vector::new(self.vx[roller], self.vy[roller])
    }
}

const PITCH: f64 = 0.01;
const HALF_HEIGHT: f64 = 0.004;
const FRICTION: Coulomb = Coulomb {
    coefficient: 0.2,
    slip_speed: 0.1,
};

/// A slack run of rollers beside a face.
struct Slack {
    links: usize,
    columns: [Vec<f64>; 4],
    thrust: [Vec<f64>; 2],
    inverse_mass: Vec<f64>,
}

impl Slack {
    fn new(links: usize) -> Self {
        let size = padded(links + 1) + LANES;
        Self {
            links,
            columns: [(); 4].map(|()| vec![0.0; size]),
            thrust: [(); 2].map(|()| vec![0.0; size]),
            inverse_mass: vec![1.0; size],
        }
    }

    fn set(&mut self, roller: usize, place: Point, velocity: Vector) {
        let values = [place.x, place.y, velocity.x, velocity.y];
        for (column, value) in self.columns.iter_mut().zip(values) {
            column[roller] = value;
        }
    }

    fn rollers(&mut self) -> Rollers<'_> {
        let [x, y, vx, vy] = &self.columns;
        let [ax, ay] = &mut self.thrust;
        Rollers {
            x,
            y,
            vx,
            vy,
            ax,
            ay,
            inverse_mass: &self.inverse_mass,
            spin: &[],
            half_step: 0.0,
        }
    }

    fn places(&self) -> Places<'_> {
        Places {
            x: &self.columns[0],
            y: &self.columns[1],
            count: self.links + 1,
        }
    }
}

fn plates(face: &ArcSpline, links: usize) -> PlateContact {
    let surface = Surface {
        law: Law {
            series: None,
            elastic: Elastic::Power(Power::linear(STIFFNESS)),
            dissipation: Dissipation::None,
            onset_floor: 0.01,
        },
        friction: Friction::Coulomb(FRICTION),
        film: None,
    };
    let ends = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Point::new(x, x));
    let bounds = face.pieces().iter().fold(ends, |[low, high], piece| {
        let around = piece.aabb();
        [low.inf(&around.min), high.sup(&around.max)]
    });
    let row = RailFace::new(face.pieces());
    PlateContact::new(row, Point::origin(), bounds, surface, HALF_HEIGHT, links)
}

/// What plates do that are looked at one by one: forces on the rollers, and force, moment, loss and depth of the body.
fn one_by_one(plates: &PlateContact, frame: &Frame, slack: &mut Slack) -> (Vec<Vector>, [f64; 5]) {
    let links = slack.links;
    let rollers = slack.rollers();
    let mut forces = vec![Vector::zeros(); links + 1];
    let mut sums = [0.0; 5];
    for link in 0..links {
        let pins = [0, 1].map(|end| rollers.place(link + end));
        let [a, b] = pins.map(|pin| frame.local(pin, plates.reference));
        let point = plates.nearest(a, b);
        let depth = -point.probe.gap;
        if depth <= 0.0 {
            continue;
        }
        let shares = [1.0 - point.share, point.share];
        let normal = frame.outward(point.probe.normal);
        let tangent = Vector::new(-normal.y, normal.x);
        let d = pins[0] + (pins[1] - pins[0]) * point.share - frame.origin;
        // u = v − v_o − ω ẑ × d
        let u = rollers.velocity(link) * shares[0] + rollers.velocity(link + 1) * shares[1]
            - frame.velocity
            - Vector::new(-d.y, d.x) * frame.spin;
        let force = point.weight * STIFFNESS * depth;
        let slip = tangent.dot(&u) + frame.spin * HALF_HEIGHT;
        // R = −μ F v/√(v² + v_s²)
        let rub = -FRICTION.coefficient * force * slip / slip.hypot(FRICTION.slip_speed);
        let push = normal * force + tangent * rub;
        for (pin, share) in shares.into_iter().enumerate() {
            forces[link + pin] += push * share;
        }
        let foot = d - normal * HALF_HEIGHT;
        let own = [-push.x, -push.y, -foot.perp(&push), -rub * slip];
        for (sum, own) in sums.iter_mut().zip(own) {
            *sum += own;
        }
        sums[4] = sums[4].max(depth);
    }
    (forces, sums)
}

/// Faces that bulge, with a straight, with many pieces, and of more than a quarter turn.
fn faces() -> Vec<ArcSpline> {
    let (left, right) = (Point::new(0.0, 0.0), Point::new(0.3, 0.0));
    let points = [[0.3, 0.0], [0.2, 0.012], [0.1, 0.01], [0.0, 0.0]].map(|[x, y]| Point::new(x, y));
    let mut pen = Pen {
        at: right,
        heading: 3.0,
        pieces: Vec::new(),
    };
    for piece in 0..24 {
        pen.arc(0.4 + 0.02 * f64::from(piece % 3), 0.015);
    }
    vec![
        bar(right, left, 0.02, 0.6).expect("a bar"),
        rail(&points, &[0.3, 0.2]).expect("a rail"),
        rail(&points, &[0.0, 0.0]).expect("a rail with edges"),
        ArcSpline::open(&pen.pieces).expect("a fitted face"),
        bar(right, left, 0.05, 2.4).expect("a round bar"),
    ]
}

/// Forces of lanes of any width on a zigzag of links along a body in motion are those of plates one by one, but for rounding.
#[test]
fn lanes_of_plates_press_as_plates_one_by_one() {
    let mut dice = Dice(3);
    for (which, face) in faces().iter().enumerate() {
        let (mut closed, mut eyes) = (0, 0);
        for _ in 0..60 {
            let links = 29;
            let mut slack = Slack::new(links);
            let angle = dice.between(-0.5, 0.5);
            let frame = Frame {
                origin: Point::new(dice.between(-0.1, 0.1), dice.between(-0.1, 0.1)),
                turn: [angle.cos(), angle.sin()],
                velocity: Vector::new(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0)),
                spin: dice.between(-5.0, 5.0),
                ..Frame::fixed()
            };
            let length = face.length();
            for roller in 0..padded(links + 1) + LANES {
                let along = length * (1.05 - 1.1 * roller as f64 / links as f64);
                let foot = face.nearest(face.point_at(along.clamp(0.0, length)), 1.0);
                let foot = foot.expect("on the face");
                let beyond = Vector::x() * (along - along.clamp(0.0, length));
                let away = HALF_HEIGHT + dice.between(-3e-4, 2e-4);
                let place = foot.point + foot.normal * away - beyond;
                let place = frame.origin + frame.outward(place - Point::origin());
                let velocity = Vector::new(dice.between(-5.0, 5.0), dice.between(-1.0, 1.0));
                slack.set(roller, place, velocity);
            }
            let mut plates = plates(face, links);
            plates.renew(&frame, slack.places(), 0.5 * PITCH);
            let (expected, sums) = one_by_one(&plates, &frame, &mut slack);
            closed += expected.iter().filter(|force| force.norm() > 0.0).count();
            eyes += usize::from(sums[4] > 0.0);
            let largest = expected.iter().map(Vector::norm).fold(1.0, f64::max);
            for width in 0..3 {
                for thrust in &mut slack.thrust {
                    thrust.fill(0.0);
                }
                let mut touch = Touch::default();
                let pins = &mut slack.rollers();
                let press = pressing(&plates, 1e-6, frame, pins, 0.0, &mut touch);
                let wrench = match width {
                    0 => Registers::in_use().dispatch(press),
                    1 => press.with_simd(pulp::Scalar128b),
                    _ => press.with_simd(pulp::Scalar),
                };
                for (roller, expected) in expected.iter().enumerate() {
                    let [x, y] = [0, 1].map(|axis| slack.thrust[axis][roller]);
                    let off = (Vector::new(x, y) - expected).norm();
                    assert!(off < 1e-9 * largest, "face {which}, roller {roller}: {off}");
                }
                let behind = slack.thrust.iter().flat_map(|all| &all[links + 1..]);
                assert!(behind.fold(0.0, |m: f64, a| m.max(a.abs())) < f64::MIN_POSITIVE);
                let [fx, fy] = wrench.force;
                let found = [fx, fy, wrench.moment, wrench.friction_loss, wrench.depth];
                for (found, expected) in found.into_iter().zip(sums) {
                    let off = (found - expected).abs();
                    assert!(off < 1e-8 * largest, "face {which}: {found} {expected}");
                }
            }
        }
        assert!(closed > 300 && eyes > 50, "face {which}: {closed} {eyes}");
    }
}

/// Links run along a bar at 6 m/s and fall on it: a contact is seen in the very step in which the distance says that there is one,
/// though most lanes are at rest.
#[test]
fn no_plate_touches_unseen() {
    let links = 24;
    let face = bar(Point::new(0.4, 0.0), Point::new(-0.4, 0.0), 0.02, 0.4).expect("a bar");
    let mut plates = plates(&face, links);
    let mut slack = Slack::new(links);
    let mut touch = Box::<Touch>::default();
    let (mut rested, mut touched) = (0, 0);
    let top = face.point_at(0.5 * face.length()).y;
    // To the end of this the first plates sink in by less than what still counts as near.
    for step in 0..700 {
        let t = f64::from(step) * 1e-5;
        for roller in 0..padded(links + 1) + LANES {
            let i = roller as f64;
            let (rise, fall) = (0.05 * (3.0 * i).cos(), -300.0);
            let height = top + HALF_HEIGHT + 1e-3 + 0.0005 * i + 3e-3 * (0.2 * i).sin();
            let place = Point::new(0.3 - 0.02 * i - 6.0 * t, height + rise * t + fall * t * t);
            slack.set(roller, place, Vector::new(-6.0, rise + 2.0 * fall * t));
        }
        if step % 64 == 0 {
            plates.renew(&Frame::fixed(), slack.places(), 0.1);
        }
        rested += plates.memory.wake.iter().filter(|wake| **wake > t).count();
        slack.thrust[0].fill(0.0);
        slack.thrust[1].fill(-600.0);
        Registers::in_use().dispatch(pressing(
            &plates,
            t,
            Frame::fixed(),
            &mut slack.rollers(),
            0.0,
            &mut touch,
        ));
        std::mem::swap(&mut plates.memory, &mut touch);
        plates.accepted = t;
        let rollers = slack.rollers();
        for link in 0..links {
            let [a, b] = [0, 1].map(|end| rollers.place(link + end));
            let inside = plates.nearest(a, b).probe.gap < 0.0;
            let seen = plates.memory.state.closed(link).is_some();
            assert_eq!(inside, seen, "link {link} at {t}");
            touched += usize::from(seen);
        }
    }
    assert!(rested > 200, "{rested}");
    assert!(touched > 1000, "{touched}");
}

//! Roller, bush and pin of particle chains as points of their own.

use crate::pieces;
use crate::pieces::{alone, body, laid, observed};

use chaindrive_contact::dissipation::Exact;
use chaindrive_contact::elastic::{CylinderLaw, Cylinders, Johnson};
use chaindrive_contact::{Dissipation, Elastic, Friction, Law};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Weights};
use chaindrive_mechanics::{
    Assembled, Chain, ChainModel, Clearance, Ends, FreeRoller, Joint, Motion, PointJoints,
    RigidLinks, RollerModel, Rotation, Shaft, Sprocket, Surface, System,
};

/// A chain 56B-1 of the catalogue, and joints with next to no play.
const PITCH: f64 = 88.9e-3;
const ROLLER_DIAMETER: f64 = 53.98e-3;
const STIFFNESS: f64 = 815e6;
const INNER: f64 = 2.161;
const OUTER: f64 = 3.359;
const ROLLER: f64 = 0.4208;
const CLOSED: f64 = 0.1e-6;
const MODULUS: f64 = 113.7e9;

fn steel(elastic: Elastic, restitution: f64, series: Option<f64>) -> Surface {
    Surface {
        law: Law {
            elastic,
            series,
            dissipation: Dissipation::Exact(Exact { restitution }),
            onset_floor: 0.05,
        },
        friction: Friction::None,
        film: None,
    }
}

/// The law of a bore that is 50 µm wider, whatever the play.
fn bearing(radius: f64, length: f64, series: Option<f64>) -> Surface {
    let pair = Cylinders::pin_in_hole(radius + 50e-6, radius, length, MODULUS);
    let law = CylinderLaw::Conformal.between(&pair);
    steel(law.expect("the radii fit"), 0.7, series)
}

fn joint(play: f64, series: Option<f64>) -> Clearance {
    let pin_radius = 17.16e-3;
    Clearance {
        pin_radius,
        bore_radius: pin_radius + play,
        surface: bearing(pin_radius, 80e-3, series),
    }
}

fn roller(play: f64) -> FreeRoller {
    let bush_radius = 19.7e-3;
    FreeRoller {
        mass: ROLLER,
        inertia: 2.366e-4,
        bush_radius,
        bore_radius: bush_radius + play,
        surface: bearing(bush_radius, 53.3e-3, None),
    }
}

/// Stiffness that a link needs beside its joint \[N/m\].
fn beside(play: f64) -> f64 {
    let alone = joint(play, None).surface.law.stiffness(1e-6);
    1.0 / (1.0 / STIFFNESS - 1.0 / alone)
}

/// Half of it behind the pins, half in the links.
fn points(play: f64) -> ChainModel {
    ChainModel::Points(PointJoints {
        inner: INNER,
        outer: OUTER,
        outer_first: false,
        joint: joint(play, Some(2.0 * beside(play))),
        roller: roller(play),
    })
}

/// Rigid links with all of it behind their pins.
fn links(play: f64) -> ChainModel {
    ChainModel::Rigid(RigidLinks {
        inner: body(INNER, 0.005_423),
        outer: body(OUTER, 0.007_835),
        outer_first: false,
        joint: Joint::Clearance(joint(play, Some(beside(play)))),
        rollers: RollerModel::Free(roller(play)),
    })
}

fn chain(model: ChainModel, links: usize) -> Chain {
    let of = [PITCH, ROLLER + 0.5 * (INNER + OUTER), STIFFNESS];
    pieces::links(links, of, [ROLLER_DIAMETER, 77.8e-3], Ends::Closed, model)
}

fn assembled(
    chain: Chain,
    positions: Vec<Point>,
    velocities: Vec<Vector>,
    sprockets: Vec<Sprocket>,
) -> Assembled {
    let count = sprockets.len();
    let mut parts = alone(vec![laid(chain, positions, velocities)]);
    parts.chains[0].sprockets = (0..count).collect();
    parts.sprockets = sprockets;
    parts.shafts = vec![Shaft::of_one(Rotation::Prescribed(Motion::Held)); count];
    pieces::assembled(parts)
}

/// A ring of four links, flat as a leaf, that meets a gap of a sprocket with one joint.
fn leaf(model: ChainModel, speed: f64) -> Assembled {
    let near = 0.5 * PITCH / (std::f64::consts::PI / 48.0).sin() + 0.2e-3;
    let (s, c) = 20_f64.to_radians().sin_cos();
    let positions = [(0.0, 0.0), (s, c), (2.0 * s, 0.0), (s, -c)];
    let positions = positions.map(|(x, y)| Point::new(near + PITCH * x, PITCH * y));
    let seat = Johnson::flat(0.5 * ROLLER_DIAMETER, 50e-3, MODULUS);
    let surface = steel(Elastic::Johnson(seat), 0.8, None);
    let sprocket = pieces::sprocket("still", 48, [PITCH, ROLLER_DIAMETER], [0.0; 2], surface);
    let velocities = vec![Vector::new(-speed, 0.0); 4];
    assembled(
        chain(model, 4),
        positions.to_vec(),
        velocities,
        vec![sprocket],
    )
}

/// Greatest force of the first contact \[N\]; it is over when the tooth has been left for 50 µs.
fn peak(assembled: Assembled, method: Method) -> f64 {
    let Assembled {
        mut system, q, v, ..
    } = assembled;
    let mut state = State::new(0.0, q, v);
    let mut stepper = method
        .start(&mut system, &mut state)
        .expect("the step is short enough");
    let flows = vec![0.0; system.quadratures()];
    let (mut peak, mut left) = (0.0_f64, f64::INFINITY);
    while state.t < left {
        assert!(state.t < 0.02, "no contact");
        stepper
            .advance(&mut system, &mut state)
            .expect("the step is short enough");
        let force = observed(&system, &state, &flows).contact_force[0];
        if force > 0.0 {
            left = state.t + 50e-6;
        }
        peak = peak.max(force);
    }
    peak
}

/// The peak of one isolated seating is that of free rollers on rigid links within a tenth, and the step of implicit damping that the
/// joints allow finds it within a tenth as well.
#[test]
fn isolated_seatings_strike_as_those_of_free_rollers() {
    for speed in [0.2, 0.5, 1.0, 3.0] {
        let fine = Method::ImplicitDamping { step: 2e-7 };
        let coarse = Method::ImplicitDamping { step: 2e-6 };
        let expected = peak(leaf(links(CLOSED), speed), fine);
        let found = peak(leaf(points(CLOSED), speed), fine);
        let stepped = peak(leaf(points(CLOSED), speed), coarse);
        println!(
            "{speed} m/s: {found:.0} N, {stepped:.0} N in steps of 2 µs, free rollers {expected:.0} N"
        );
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "{speed} m/s: {found}, not {expected}"
        );
        assert!(
            (stepped / found - 1.0).abs() < 0.1,
            "{speed} m/s: {stepped}, not {found}"
        );
    }
}

/// A ring with play, no sprocket, and joints that fly against each other.
fn ring() -> Assembled {
    let links = 8;
    let circle = 0.5 * PITCH / (std::f64::consts::PI / 8.0).sin();
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / links as f64;
    let at = |i: usize| Point::new(circle * angle(i).cos(), circle * angle(i).sin());
    let speed = |i: usize| Vector::new((2.3 * i as f64).sin(), (1.7 * i as f64).cos()) * 0.5;
    let positions = (0..links).map(at).collect();
    let velocities = (0..links).map(speed).collect();
    assembled(
        chain(points(50e-6), links),
        positions,
        velocities,
        Vec::new(),
    )
}

/// Impulses of all points \[N s\]: x and y blocks alternate, copies after the originals left out.
fn momentum(assembled: &Assembled, v: &[f64]) -> [f64; 2] {
    let stride = v.len() / 6;
    let mut sum = [0.0; 2];
    for block in 0..3 {
        for joint in 0..8 {
            let mass = match block {
                0 => ROLLER,
                // Link 0 is an inner one: the end after an even joint is a bush.
                block if (block == 2) == (joint % 2 == 0) => 0.5 * INNER,
                _ => 0.5 * OUTER,
            };
            for (axis, sum) in sum.iter_mut().enumerate() {
                *sum += mass * v[(2 * block + axis) * stride + joint];
            }
        }
    }
    assert_eq!(v.len(), assembled.v.len());
    sum
}

/// Impacts in the joints move no momentum, whatever an implicit step makes of them, and what is lost in them is in the ledger: what is
/// open falls with the step.
#[test]
fn joints_keep_momentum_and_the_ledger_closes() {
    let mut before = f64::INFINITY;
    for step in [2e-6, 0.5e-6] {
        let start = ring();
        let pushed = momentum(&start, &start.v);
        let mut system = start.system.clone();
        let mut state = State::new(0.0, start.q.clone(), start.v.clone());
        let mut flows = vec![0.0; system.quadratures()];
        let first = observed(&system, &state, &flows).energy;
        let mut stepper = Method::ImplicitDamping { step }
            .start(&mut system, &mut state)
            .expect("the step is short enough");
        while state.t < 5e-3 {
            stepper
                .advance(&mut system, &mut state)
                .expect("the step is short enough");
        }
        for (now, then) in momentum(&start, &state.v).iter().zip(pushed) {
            assert!((now - then).abs() < 1e-10 * 20.0, "{now} N s, not {then}");
        }
        state.quadratures_at(state.t, &mut flows);
        let last = observed(&system, &state, &flows).energy;
        let open = last.residual(&first).abs() / last.dissipated();
        println!(
            "{step} s: {} J lost, {open:.2e} of it open",
            last.dissipated()
        );
        assert!(
            last.dissipated() > 0.5 && open < 0.6 * before,
            "{open}, {before}"
        );
        before = open;
    }
    assert!(before < 0.02, "{before}");
}

/// The solution of an implicit step is that of the whole matrix, whose damping is taken from the forces.
#[test]
fn joints_are_solved_exactly() {
    let start = ring();
    let mut system = start.system.clone();
    let mut state = State::new(0.0, start.q.clone(), start.v.clone());
    let mut stepper = Method::ImplicitDamping { step: 1e-6 }
        .start(&mut system, &mut state)
        .expect("the step is short enough");
    let flows = vec![0.0; system.quadratures()];
    let striking = |system: &System, state: &State| {
        let forces = observed(system, state, &flows).joint_force;
        forces.iter().filter(|force| **force > 1000.0).count() > 1
    };
    while !striking(&system, &state) {
        assert!(state.t < 0.02, "no joint strikes");
        stepper
            .advance(&mut system, &mut state)
            .expect("the step is short enough");
    }
    let forces = |system: &System, v: &[f64], record: &mut _| {
        let mut a = vec![0.0; v.len()];
        let mut rates = vec![0.0; system.quadratures()];
        let at = Moment {
            t: state.t,
            q: &state.q,
            v,
            z: &[],
        };
        system.evaluate(at, &mut a, &mut rates, record);
        a
    };
    let mut record = system.new_record();
    let still = forces(&system, &state.v, &mut record);
    let c = 3e-6;
    let mut x = vec![0.0; still.len()];
    // Copies after the originals go with them.
    let stride = x.len() / 6;
    for (i, x) in x.iter_mut().enumerate() {
        *x = (0.7 * (i / stride * 8 + i % stride % 8) as f64).sin();
    }
    let asked = x.clone();
    let weights = Weights {
        once: false,
        damping: c,
        stiffness: 0.0,
    };
    assert!(system.solve(weights, &mut record, &mut x));
    // x − c ∂a/∂v x = b
    let small = 1e-7;
    let moved: Vec<f64> = state.v.iter().zip(&x).map(|(v, x)| v + small * x).collect();
    let answer = forces(&system, &moved, &mut system.new_record());
    let mut felt = 0.0_f64;
    for block in 0..6 {
        for joint in 0..8 {
            let i = block * stride + joint;
            let slope = (answer[i] - still[i]) / small;
            felt = felt.max((c * slope).abs());
            let open = x[i] - c * slope - asked[i];
            assert!(open.abs() < 1e-5, "{block} {joint}: {open}");
        }
    }
    assert!(felt > 0.1, "no joint is closed: {felt}");
}

/// Largest eigenvalue of −∂a/∂q at a state, by power iteration on differences of accelerations.
fn stiffest(system: &System, state: &State) -> f64 {
    let accelerations = |q: &[f64]| {
        let mut a = vec![0.0; q.len()];
        let mut rates = vec![0.0; system.quadratures()];
        let at = Moment {
            t: state.t,
            q,
            v: &state.v,
            z: &[],
        };
        system.evaluate(at, &mut a, &mut rates, &mut system.new_record());
        a
    };
    let still = accelerations(&state.q);
    let stride = still.len() / 6;
    let start = |i: usize| (0.7 * (i / stride * 8 + i % stride % 8) as f64).sin();
    let mut x: Vec<f64> = (0..still.len()).map(start).collect();
    let mut value = 0.0;
    for _ in 0..40 {
        let largest = x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Copies after the originals move with them; a hundredth of a nanometre leaves contacts what they are.
        let moved = |(q, x): (&f64, &f64)| q + 1e-11 * x / largest;
        let moved: Vec<f64> = state.q.iter().zip(&x).map(moved).collect();
        let there = accelerations(&moved);
        let next: Vec<f64> = still
            .iter()
            .zip(&there)
            .map(|(a, b)| (a - b) / 1e-11)
            .collect();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        value = norm(&next) * largest / norm(&x);
        x = next;
    }
    value
}

/// The bound of the steps is not below the stiffest mode that the joints have while they strike, nor far above it.
#[test]
fn steps_are_bounded_by_the_stiffest_mode() {
    let start = ring();
    let mut system = start.system.clone();
    let mut state = State::new(0.0, start.q.clone(), start.v.clone());
    let mut stepper = Method::ImplicitDamping { step: 1e-6 }
        .start(&mut system, &mut state)
        .expect("the step is short enough");
    let (mut found, mut bound) = (0.0_f64, 0.0_f64);
    for step in 0..2000 {
        stepper
            .advance(&mut system, &mut state)
            .expect("the step is short enough");
        bound = bound.max(system.undamped_time_scale().powi(-2));
        if step % 5 == 0 {
            found = found.max(stiffest(&system, &state));
        }
    }
    println!("stiffest mode {found:.3e}/s², bound {bound:.3e}/s²");
    assert!(found > 1e10, "no joint is closed: {found:e}");
    assert!(bound > 0.99 * found, "{bound:e} is below {found:e}");
    assert!(bound < 3.0 * found, "{bound:e} is far above {found:e}");
}

//! Rigid links about their settled state, against closed forms; how they are laid, and what stops them.

use crate::pieces;
use crate::pieces::{assembled, body, laid, linear, seen, smooth};

use std::f64::consts::{PI, TAU};

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Method, State};
use chaindrive_mechanics::{
    Assembled, ChainModel, Clearance, End, Ends, Joint, Observation, Parts, RigidLinks, RollerModel,
};

const PITCH: f64 = 0.0127;
const MASS: f64 = 4e-3;
/// Stiffness of links while they are laid, and of pins in their bushes \[N/m\].
const STIFFNESS: f64 = 5e7;
const CLEARANCE: f64 = 1e-6;

/// Links of mass m, with the inertia of two halves of it at the joints.
fn links(joint: Joint, inertia: f64) -> ChainModel {
    let body = body(MASS, inertia);
    ChainModel::Rigid(RigidLinks {
        inner: body,
        outer: body,
        outer_first: false,
        joint,
        rollers: RollerModel::Lumped { mass: 0.0 },
    })
}

fn clearance() -> Joint {
    Joint::Clearance(Clearance {
        pin_radius: 2e-3 - CLEARANCE,
        bore_radius: 2e-3,
        surface: smooth(linear(STIFFNESS)),
    })
}

/// A chain at given places, on its own.
fn alone(
    model: ChainModel,
    ends: Ends,
    positions: Vec<Point>,
    velocities: Vec<Vector>,
    gravity: Vector,
) -> Parts {
    let rollers = positions.len();
    let count = rollers - usize::from(ends != Ends::Closed);
    let of = [PITCH, MASS, STIFFNESS];
    let mut chain = pieces::links(count, of, [7.75e-3, 9.6e-3], ends, model);
    if chain.ends != Ends::Closed {
        chain.masses[0] *= 0.5;
        chain.masses[rollers - 1] *= 0.5;
    }
    Parts {
        settle: true,
        gravity,
        ..pieces::alone(vec![laid(chain, positions, velocities)])
    }
}

/// A straight strand of `count` links.
fn strand(
    model: ChainModel,
    count: usize,
    ends: [End; 2],
    along: Vector,
    gravity: Vector,
) -> Parts {
    let positions = (0..=count)
        .map(|i| Point::origin() + along * (PITCH * i as f64))
        .collect();
    let still = vec![Vector::zeros(); count + 1];
    alone(model, Ends::Open(ends), positions, still, gravity)
}

/// A taut strand that is free to swing at its pulled end, whatever it is made of.
///
/// ```text
/// f_k = 2 √(T/(m p)) sin((2k − 1) π/(4n))/2π
/// ```
///
/// Half a string with both ends held: its n point masses m stand a pitch p apart, the last one halved.
#[test]
fn a_taut_strand_swings_alike_whatever_it_is_made_of() {
    let (count, tension) = (8, 100.0);
    let exact: Vec<f64> = (1..=count)
        .map(|k| {
            let angle = (2 * k - 1) as f64 * PI / (4 * count) as f64;
            2.0 * (tension / (MASS * PITCH)).sqrt() * angle.sin() / TAU
        })
        .collect();
    let halves = 0.25 * MASS * PITCH * PITCH;
    // By how much a link gives, in pitches, and the play.
    let stretch = tension / (STIFFNESS * PITCH);
    let play = CLEARANCE / PITCH;
    for (model, tolerance) in [
        (links(Joint::Ideal, halves), 1e-9),
        (ChainModel::Particles, 2.0 * stretch),
        (links(clearance(), halves), 4.0 * (stretch + play)),
    ] {
        let pulled = End::Pulled {
            force: Vector::new(tension, 0.0),
        };
        let ideal = matches!(&model, ChainModel::Rigid(links) if links.joint == Joint::Ideal);
        let ends = [End::Fixed, pulled];
        let assembled = assembled(strand(model, count, ends, Vector::x(), Vector::zeros()));
        let modes = assembled.modes().unwrap_or_else(|error| panic!("{error}"));
        if ideal {
            assert_eq!(modes.modes.len(), count, "one mode a link is left free");
        }
        assert!(modes.is_stable());
        for (mode, exact) in modes.modes.iter().zip(&exact) {
            let error = (mode.frequency / exact - 1.0).abs();
            assert!(
                error < tolerance,
                "{} Hz, not {exact}: {error:.1e}",
                mode.frequency
            );
            assert!(mode.roller_x.iter().all(|x| x.abs() < 1e-6));
            assert!(mode.roller_y[count].abs() > 1.0);
        }
    }
}

/// Two uniform bars that hang: ω² = (3 ± 6/√7) g/p.
#[test]
fn two_hanging_bars_have_their_closed_frequencies() {
    let bars = links(Joint::Ideal, MASS * PITCH * PITCH / 12.0);
    let down = Vector::new(0.0, -1.0);
    let gravity = Vector::new(0.0, -9.81);
    let hanging = strand(bars, 2, [End::Fixed, End::Free], down, gravity);
    let modes = assembled(hanging).modes().unwrap();
    let exact = [-1.0, 1.0].map(|sign| {
        let factor = 3.0 + sign * 6.0 / 7.0_f64.sqrt();
        (factor * 9.81 / PITCH).sqrt() / TAU
    });
    assert_eq!(modes.modes.len(), 2);
    for (found, exact) in modes.frequencies().iter().zip(exact) {
        assert!(
            (found / exact - 1.0).abs() < 1e-9,
            "{found} Hz, not {exact}"
        );
    }
}

/// A strand that is straight between two supports cannot be held by forces: the run stops, it does not fall apart.
#[test]
fn a_singular_strand_stops_the_run() {
    let ends = [End::Fixed, End::Fixed];
    let bars = links(Joint::Ideal, 1e-7);
    let mut parts = strand(bars, 6, ends, Vector::x(), Vector::new(0.0, -9.81));
    parts.settle = false;
    let Assembled {
        mut system, q, v, ..
    } = assembled(parts);
    let mut state = State::new(0.0, q, v);
    let method = Method::Rk4 { step: 1e-5 };
    let error = method.start(&mut system, &mut state).err();
    assert!(error.is_some(), "a strand without forces");
}

/// A spinning ring of rigid links begins with the forces that it keeps: its joints are laid closed, however far the particles
/// had stretched that it was laid as.
///
/// ```text
/// F = m ω² r/(2 sin(π/n)),   r = p/(2 tan(π/n)): half the centrifugal force of a link goes through each of its joints
/// ```
#[test]
fn a_ring_is_laid_closed() {
    let (seen, exact) = spinning(Joint::Ideal, 1.003);
    for i in 0..RING {
        let apart = seen.joint_offset_x[i].hypot(seen.joint_offset_y[i]);
        assert!(apart < 1e-14, "{apart} m");
    }
    let half = PI / RING as f64;
    let place = Vector::new(seen.roller_x[0], seen.roller_y[0]);
    let regular = place.norm() * half.sin() / (0.5 * PITCH) - 1.0;
    assert!(regular.abs() < 1e-7, "{regular}");
    for force in &seen.joint_force {
        assert!((force / exact - 1.0).abs() < 1e-6, "{force} N, not {exact}");
    }
}

/// The same with clearance, laid as particles that their pull has stretched (defect A15): pins are seated as deep as it presses
/// them, and not by as much as the particles had stretched.
///
/// ```text
/// T = m ω² R/(2 sin(π/n)),   R = p s/(2 sin(π/n)),   p s = p + T/k:   s = K/(K − 1),   K = 4 k sin²(π/n)/(m ω²)
/// ```
#[test]
fn pins_of_a_ring_are_laid_where_they_carry_it() {
    let half = PI / RING as f64;
    let ratio = LAID * 4.0 * half.sin().powi(2) / (MASS * SPIN * SPIN);
    let (seen, exact) = spinning(clearance(), ratio / (ratio - 1.0));
    for force in &seen.joint_force {
        assert!((force / exact - 1.0).abs() < 0.01, "{force} N, not {exact}");
    }
}

const RING: usize = 24;
/// Speed of rings \[rad/s\].
const SPIN: f64 = 300.0;
/// Stiffness of links with which rings are laid \[N/m\].
const LAID: f64 = 1e6;

/// A ring of links at its start, laid `stretched`, and the force in its joints \[N\].
fn spinning(joint: Joint, stretched: f64) -> (Observation, f64) {
    let circle = 0.5 * PITCH * stretched / (PI / RING as f64).sin();
    let places: Vec<Point> = (0..RING)
        .map(|i| {
            let angle = TAU * i as f64 / RING as f64;
            Point::new(circle * angle.cos(), circle * angle.sin())
        })
        .collect();
    let velocities = places
        .iter()
        .map(|at| Vector::new(-at.y, at.x) * SPIN)
        .collect();
    let bars = links(joint, 1e-7);
    let mut parts = alone(bars, Ends::Closed, places, velocities, Vector::zeros());
    parts.settle = false;
    parts.chains[0].chain.stiffness.fill(LAID);
    let seen = seen(&assembled(parts));
    let half = PI / RING as f64;
    let place = Vector::new(seen.roller_x[0], seen.roller_y[0]);
    let speed = Vector::new(seen.roller_vx[0], seen.roller_vy[0]).norm() / place.norm();
    let radius = 0.5 * PITCH / half.tan();
    let exact = MASS * speed * speed * radius / (2.0 * half.sin());
    (seen, exact)
}

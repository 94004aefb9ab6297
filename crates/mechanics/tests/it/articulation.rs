//! Friction and damping in the joints of every chain model: momentum, energy.
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::pieces;
use crate::pieces::{alone, body, laid, linear, smooth};

use std::f64::consts::{PI, TAU};

use chaindrive_contact::Friction;
use chaindrive_contact::friction::{Coulomb, SpringSlider};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State};
use chaindrive_mechanics::{
    Articulation, Assembled, Chain, ChainModel, Clearance, End, Ends, Energy, Flow, Joint,
    Observation, RigidLinks, RollerModel, Surface,
};

/// A chain of a marine engine, 56B: pitch \[m\], mass of a link \[kg\], stiffness \[N/m\].
const PITCH: f64 = 0.0889;
const MASS: f64 = 3.0;
const STIFFNESS: f64 = 1e9;
/// Stiffness of links that keep the tension of a plucked strand what it is \[N/m\].
const SOFT: f64 = 2e6;
/// Radius of the pin \[m\], and μ.
const RADIUS: f64 = 0.012;
const FRICTION: f64 = 0.1;

fn spring_slider(coefficient: f64) -> Friction {
    Friction::SpringSlider(SpringSlider {
        coefficient,
        // As a torsional spring σ = 1e6 N m/rad.
        stiffness: 1e6 / (RADIUS * RADIUS),
    })
}

fn articulation(friction: Friction, damping: f64) -> Articulation {
    Articulation {
        friction,
        radius: RADIUS,
        damping,
        seal: 0.0,
        lateral: None,
    }
}

fn assembled(chain: Chain, positions: Vec<Point>, velocities: Vec<Vector>) -> Assembled {
    pieces::assembled(alone(vec![laid(chain, positions, velocities)]))
}

fn chain(
    links: usize,
    [length, stiffness]: [f64; 2],
    ends: Ends,
    articulation: Option<Articulation>,
) -> Chain {
    let of = [PITCH, MASS, stiffness];
    Chain {
        lengths: vec![length; links],
        articulation,
        ..pieces::links(links, of, [0.05, 0.08], ends, ChainModel::Particles)
    }
}

/// A strand between two fixed ends under a tension, plucked to the shape of its first mode.
fn plucked(
    links: usize,
    tension: f64,
    amplitude: f64,
    articulation: Option<Articulation>,
) -> Assembled {
    let positions = (0..=links)
        .map(|i| {
            let across = amplitude * (PI * i as f64 / links as f64).sin();
            Point::new(PITCH * i as f64, across)
        })
        .collect();
    let free = PITCH - tension / SOFT;
    let ends = Ends::Open([End::Fixed, End::Fixed]);
    let still = vec![Vector::zeros(); links + 1];
    assembled(
        chain(links, [free, SOFT], ends, articulation),
        positions,
        still,
    )
}

fn energy(assembled: &Assembled, at: Moment<'_>, flows: &[f64]) -> Energy {
    let mut out = Observation::default();
    let system = &assembled.system;
    system.observe(at, flows, &mut system.new_record(), &mut out);
    out.energy
}

/// Steps of Verlet's method until a time, each seen.
fn run(assembled: Assembled, step: f64, until: f64, mut see: impl FnMut(&State)) -> Assembled {
    let mut assembled = assembled;
    let system = &mut assembled.system;
    let mut state = State::new(0.0, assembled.q, assembled.v);
    let mut stepper = Method::Verlet { step }
        .start(system, &mut state)
        .expect("the step is stable");
    while state.t < until {
        stepper.advance(system, &mut state).expect("stays finite");
        see(&state);
    }
    (assembled.q, assembled.v) = (state.q.to_vec(), state.v.to_vec());
    assembled
}

/// Rigid links of the same chain.
fn rigid(joint: Joint) -> ChainModel {
    let body = body(MASS, MASS * PITCH * PITCH / 10.0);
    ChainModel::Rigid(RigidLinks {
        inner: body,
        outer: body,
        outer_first: false,
        joint,
        rollers: RollerModel::Bush,
    })
}

/// Pins in bushes that are a little wider.
fn clearance(friction: Friction) -> Joint {
    Joint::Clearance(Clearance {
        pin_radius: RADIUS,
        bore_radius: 1.01 * RADIUS,
        surface: Surface {
            friction,
            ..smooth(linear(STIFFNESS))
        },
    })
}

/// A ring that is neither round nor at rest, and spins: every joint turns, every link pulls.
fn ring(model: ChainModel, articulation: Option<Articulation>) -> Assembled {
    let links = 20;
    let circle = 0.5 * PITCH / (PI / links as f64).sin();
    let angle = |i: usize| TAU * i as f64 / links as f64;
    let places = (0..links).map(|i| {
        let r = circle * (1.0 + 1e-4 * (3.0 * angle(i)).sin());
        Point::new(r * angle(i).cos(), r * angle(i).sin())
    });
    let positions: Vec<Point> = places.collect();
    let velocities = positions.iter().enumerate().map(|(i, place)| {
        let swinging = Vector::new((2.0 * angle(i)).sin(), 0.7 * (3.0 * angle(i)).cos());
        Vector::new(-place.y, place.x) * 30.0 + swinging
    });
    let velocities: Vec<Vector> = velocities.collect();
    let chain = Chain {
        model,
        ..chain(links, [PITCH, STIFFNESS], Ends::Closed, articulation)
    };
    assembled(chain, positions, velocities)
}

/// What a model of a chain is called, and its ring with joints that resist.
type Resisting = (&'static str, ChainModel, Option<Articulation>);

/// Every chain model with every friction that its joints may have, and damping.
fn resisting() -> Vec<Resisting> {
    let mut all = vec![(
        "clearance",
        rigid(clearance(Friction::None)),
        Some(articulation(Friction::None, 30.0)),
    )];
    let mut frictions = Friction::specimens();
    frictions.push(spring_slider(FRICTION));
    for friction in frictions {
        let joints = Some(articulation(friction, 30.0));
        all.push(("particles", ChainModel::Particles, joints));
        all.push(("ideal", rigid(Joint::Ideal), joints));
    }
    all
}

/// Whatever a free ring does, its joints push against nothing but each other.
#[test]
fn joints_keep_momentum_and_lose_what_they_say() {
    for (name, model, joints) in resisting() {
        let what = format!("{name}, {joints:?}");
        let (with, without) = (ring(model.clone(), joints), ring(model.clone(), None));
        let rates = |assembled: &Assembled, dt: f64| {
            let system = &assembled.system;
            let (mut a, mut rates) = (vec![0.0; system.dofs()], vec![0.0; system.quadratures()]);
            let at = Moment {
                t: dt,
                q: &assembled.q,
                v: &assembled.v,
                z: &[],
            };
            system.evaluate(at, &mut a, &mut rates, &mut system.new_record());
            (a, rates[Flow::ArticulationLoss as usize])
        };
        let dt = 1e-5;
        let ((a, loss), (bare, _)) = (rates(&with, dt), rates(&without, dt));
        let (links, stride) = (20, with.system.dofs() / 2);
        let particles = model == ChainModel::Particles;
        let (mut force, mut moment, mut power, mut size) = (Vector::zeros(), 0.0, 0.0, 0.0_f64);
        for i in 0..links {
            let [x, y] = if particles {
                [i, stride + i]
            } else {
                [3 * i, 3 * i + 1]
            };
            let f = Vector::new(a[x] - bare[x], a[y] - bare[y]) * MASS;
            force += f;
            moment += with.q[x] * f.y - with.q[y] * f.x;
            power += f.dot(&Vector::new(with.v[x], with.v[y]));
            size = size.max(f.norm());
            if !particles {
                let torque = (a[3 * i + 2] - bare[3 * i + 2]) * MASS * PITCH * PITCH / 10.0;
                moment += torque;
                power += torque * with.v[3 * i + 2];
                size = size.max(torque.abs() / PITCH);
            }
        }
        assert!(size > 100.0 && loss > 1.0, "{what}: {size} N, {loss} W");
        // Differences of large accelerations times a mass.
        let rounding = 1e-12 * bare.iter().fold(0.0, |most: f64, a| most.max(a.abs())) * MASS;
        assert!(force.norm() < rounding, "{what}: {force:?}");
        assert!(moment.abs() < rounding, "{what}: {moment}");
        // Ideal joints stand still against each other to the rounding of the velocities.
        assert!(
            (power + loss).abs() < 1e-9 * loss + rounding,
            "{what}: {power} W and {loss} W"
        );
    }
}

/// What goes into the joints of a ring is lost or held, in every chain model.
#[test]
fn the_ledger_of_a_ring_closes_in_every_model() {
    let friction = spring_slider(FRICTION);
    let cases = [
        (
            "particles",
            ChainModel::Particles,
            Some(articulation(friction, 5.0)),
            2e-6,
        ),
        (
            "ideal",
            rigid(Joint::Ideal),
            Some(articulation(friction, 5.0)),
            2e-6,
        ),
        (
            "clearance",
            rigid(clearance(friction)),
            Some(articulation(Friction::None, 5.0)),
            2e-6,
        ),
    ];
    for (name, model, joints, step) in cases {
        let start = ring(model, joints);
        let flows = vec![0.0; start.system.quadratures()];
        let at = |assembled: &Assembled, t: f64, flows: &[f64]| {
            let moment = Moment {
                t,
                q: &assembled.q,
                v: &assembled.v,
                z: &[],
            };
            energy(assembled, moment, flows)
        };
        let before = at(&start, 0.0, &flows);
        let (mut t, mut paid) = (0.0, flows);
        let end = run(start, step, 0.02, |state| {
            t = state.t;
            paid.copy_from_slice(&state.quadratures);
        });
        let after = at(&end, t, &paid);
        let lost = after.flow(Flow::ArticulationLoss);
        let open = after.residual(&before).abs() / lost;
        println!("{name}: {lost} J lost, {open:.1e} of it open");
        assert!(lost > 1.0 && open < 5e-3, "{name}: {lost} J, {open}");
    }
}

/// The ledger of a strand that friction brings to rest closes, with second order in the step where the law is smooth.
#[test]
fn the_ledger_of_a_strand_with_friction_closes() {
    let smooth = Friction::Coulomb(Coulomb {
        coefficient: FRICTION,
        slip_speed: 0.5 * RADIUS,
    });
    for (friction, tolerance) in [(smooth, 2e-3), (spring_slider(FRICTION), 2e-3)] {
        let open = |step: f64| {
            let strand = plucked(20, 40e3, 0.02, Some(articulation(friction, 0.0)));
            let flows = vec![0.0; strand.system.quadratures()];
            let at = |assembled: &Assembled, t: f64, flows: &[f64]| {
                let moment = Moment {
                    t,
                    q: &assembled.q,
                    v: &assembled.v,
                    z: &[],
                };
                energy(assembled, moment, flows)
            };
            let start = at(&strand, 0.0, &flows);
            let (mut t, mut paid) = (0.0, flows);
            let end = run(strand, step, 0.15, |state| {
                t = state.t;
                paid.copy_from_slice(&state.quadratures);
            });
            let end = at(&end, t, &paid);
            let lost = end.flow(Flow::ArticulationLoss);
            assert!(lost > 5.0, "{lost} J");
            end.residual(&start).abs() / lost
        };
        let coarse = open(4e-6);
        assert!(coarse < tolerance, "{friction:?}: {coarse}");
    }
}

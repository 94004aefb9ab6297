//! Laws that every chain of rigid links keeps: momentum, energy to the order of the method, and the same motion by all
//! methods.
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;
use crate::linkages;

use chaindrive::Assembled;
use chaindrive_contact::friction::Coulomb;
use chaindrive_contact::{Dissipation, Friction, dissipation::LankaraniNikravesh};
use chaindrive_integrate::Method;
use chaindrive_mechanics::{Joint, LinkBody, Surface};
use dynamics::{brief, slope};
use linkages::{Bench, Strand, bars, circle, clearance, surface};

const MASSES: [LinkBody; 2] = [
    LinkBody {
        mass: 0.010,
        inertia: 2e-6,
        centre: chaindrive_geometry::Vector::new(1e-3, -5e-4),
    },
    LinkBody {
        mass: 0.014,
        inertia: 3e-6,
        centre: chaindrive_geometry::Vector::new(-5e-4, 2e-4),
    },
];

/// A closed chain of twelve unequal links in free flight, spinning and out of shape.
fn ring(joint: Joint) -> Assembled {
    let pitch = 0.03;
    let mut ring = Strand::ring(pitch, MASSES[0], circle(12, pitch));
    ring.links = bars(MASSES[0]);
    ring.links.outer = MASSES[1];
    ring.links.joint = joint;
    // Spin, flight, and a swinging of the joints that a closed chain allows.
    ring.velocities = ring
        .places
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let a = 0.2 * if i % 2 == 0 { 1.0 } else { -1.0 };
            let radius = p[0].hypot(p[1]);
            [
                0.3 - 20.0 * p[1] + a * p[0] / radius,
                -0.1 + 20.0 * p[0] + a * p[1] / radius,
            ]
        })
        .collect();
    ring.assemble()
}

/// Momentum (x, y), angular momentum about the origin, and the sums of the magnitudes of their parts.
fn momenta(bench: &Bench) -> ([f64; 3], [f64; 2]) {
    let mut sums = ([0.0; 3], [0.0; 2]);
    for link in 0..12 {
        let LinkBody { mass, inertia, .. } = MASSES[link % 2];
        let [[x, y, _], [vx, vy, spin]] = bench.body(link);
        let turn = mass * (x * vy - y * vx) + inertia * spin;
        for (sum, part) in sums.0.iter_mut().zip([mass * vx, mass * vy, turn]) {
            *sum += part;
        }
        sums.1[0] += mass * vx.hypot(vy);
        sums.1[1] += mass * x.hypot(y) * vx.hypot(vy) + inertia * spin.abs();
    }
    sums
}

/// Largest change of momentum and angular momentum, relative, over `steps` steps.
fn momentum_drift(joint: Joint, method: Method, steps: u32) -> [f64; 2] {
    let mut bench = Bench::start(ring(joint), method);
    let (begin, size) = momenta(&bench);
    let mut drift = [0.0_f64; 2];
    for _ in 0..steps {
        bench.advance();
        let (now, _) = momenta(&bench);
        drift[0] = drift[0].max((now[0] - begin[0]).hypot(now[1] - begin[1]) / size[0]);
        drift[1] = drift[1].max((now[2] - begin[2]).abs() / size[1]);
    }
    drift
}

fn lossy(friction: Friction) -> Surface {
    let mut surface = surface(1e8, 1.5);
    surface.law.dissipation =
        Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.7 });
    surface.law.onset_floor = 1e-3;
    Surface {
        friction,
        ..surface
    }
}

/// Joint forces come in pairs, whatever the loss and the friction. Ideal joints turn a little with what the step leaves
/// of their gap, and methods of second order with their own error.
#[test]
fn a_free_ring_keeps_its_momentum() {
    let rough = Friction::Coulomb(Coulomb {
        coefficient: 0.2,
        slip_speed: 1e-2,
    });
    let joints = [
        ("ideal", Joint::Ideal, [1e-7; 4]),
        (
            "loose",
            clearance(3e-3, 1e-4, lossy(Friction::None)),
            [1e-13, 1e-13, 1e-13, 1e-8],
        ),
        (
            "rough",
            clearance(3e-3, 1e-4, lossy(rough)),
            [1e-13, 1e-13, 1e-13, 1e-8],
        ),
    ];
    for (name, joint, turning) in joints {
        for (method, turning) in methods(2e-6).into_iter().zip(turning) {
            let drift = momentum_drift(joint, method, 10_000);
            println!("{name}, {}: momentum {}", method.name(), brief(&drift));
            assert!(drift[0] < 1e-13, "{drift:?}");
            assert!(drift[1] < turning, "{drift:?}");
        }
    }
}

fn methods(step: f64) -> [Method; 4] {
    [
        Method::Rk4 { step },
        Method::Verlet { step },
        Method::ImplicitDamping { step },
        Method::GeneralizedAlpha {
            step,
            spectral_radius: 0.8,
        },
    ]
}

/// A ring that spins so fast that all its joints, with a little clearance, stay pressed: a smooth motion.
fn pressed_ring(joint: Joint) -> Assembled {
    let (pitch, spin) = (0.03, 400.0);
    let stretch = if joint == Joint::Ideal { 0.0 } else { 3e-6 };
    let mut ring = Strand::ring(pitch, MASSES[0], circle(12, pitch + stretch));
    ring.links.outer = MASSES[1];
    ring.links.joint = joint;
    let whirl = |p: &[f64; 2]| [-spin * p[1], spin * p[0]];
    ring.velocities = ring.places.iter().map(whirl).collect();
    ring.assemble()
}

/// Error of the positions at the end against `exact`, and of the energy ledger relative to the kinetic energy.
fn errors(joint: Joint, method: Method, until: f64, exact: &[f64]) -> [f64; 2] {
    let mut bench = Bench::start(pressed_ring(joint), method);
    let start = bench.look().energy;
    bench.until(until);
    let residual = bench.look().energy.residual(&start) / start.kinetic();
    let far = bench.state.q.iter().zip(exact);
    [
        far.fold(0.0, |worst, (q, exact)| (q - exact).abs().max(worst)),
        residual.abs(),
    ]
}

/// All methods run into the same motion, each as fast as its order, and the ledger of energy closes alike.
#[test]
fn methods_agree_and_the_ledger_closes_to_their_order() {
    let mut sprung = surface(1e8, 1.0);
    sprung.law.dissipation =
        Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.7 });
    sprung.law.onset_floor = 0.2;
    for (name, joint) in [
        ("ideal", Joint::Ideal),
        ("loose", clearance(3e-3, 1e-6, sprung)),
    ] {
        let steps = if joint == Joint::Ideal {
            [4e-5, 2e-5, 1e-5, 5e-6]
        } else {
            [1e-6, 5e-7, 2.5e-7, 1.25e-7]
        };
        let until = 200.0 * steps[0];
        let fine = Method::Rk4 {
            step: 0.25 * steps[3],
        };
        let mut reference = Bench::start(pressed_ring(joint), fine);
        reference.until(until);
        for number in 0..4 {
            let found = steps.map(|step| {
                let method = methods(step)[number];
                (step, errors(joint, method, until, &reference.state.q))
            });
            let method = methods(steps[0])[number];
            let order = [0, 1].map(|k| {
                let points = found.map(|(step, errors)| (step.log2(), errors[k].log2()));
                slope(&points)
            });
            println!(
                "{name}, {}: orders {order:.2?}, smallest {}",
                method.name(),
                brief(&found[3].1)
            );
            let expected = f64::from(method.order()) - 0.3;
            assert!(order.iter().all(|&order| order > expected), "{order:?}");
            assert!(found[3].1.iter().all(|&error| error < 5e-3), "{found:?}");
        }
    }
}

/// Velocities that ideal joints do not allow are brought together before the run, by impulses in pairs.
#[test]
fn joints_brought_together_keep_momentum() {
    let pitch = 0.03;
    let mut ring = Strand::ring(pitch, MASSES[0], circle(12, pitch));
    ring.links.outer = MASSES[1];
    // Anything: places of the golden angle.
    ring.velocities = (0..12)
        .map(|i| (2.4 * f64::from(i)).sin_cos())
        .map(|(s, c)| [0.3 + s, c - 0.1])
        .collect();
    let mut before = ([0.0; 3], 0.0);
    for link in 0..12 {
        let LinkBody {
            mass,
            inertia,
            centre,
        } = MASSES[link % 2];
        let next = (link + 1) % 12;
        let [p, v] = [&ring.places, &ring.velocities].map(|z| [z[link], z[next]]);
        let along = [(p[1][0] - p[0][0]) / pitch, (p[1][1] - p[0][1]) / pitch];
        let spin = (along[0] * (v[1][1] - v[0][1]) - along[1] * (v[1][0] - v[0][0])) / pitch;
        let arm = [
            along[0] * centre.x - along[1] * centre.y,
            along[1] * centre.x + along[0] * centre.y,
        ];
        let place = [0, 1].map(|k| 0.5 * (p[0][k] + p[1][k]) + arm[k]);
        let speed = [
            0.5 * (v[0][0] + v[1][0]) - spin * arm[1],
            0.5 * (v[0][1] + v[1][1]) + spin * arm[0],
        ];
        let turn = mass * (place[0] * speed[1] - place[1] * speed[0]) + inertia * spin;
        for (sum, part) in before
            .0
            .iter_mut()
            .zip([mass * speed[0], mass * speed[1], turn])
        {
            *sum += part;
        }
        before.1 += mass * speed[0].hypot(speed[1]);
    }
    let bench = Bench::start(ring.assemble(), Method::Rk4 { step: 1e-6 });
    let (after, size) = momenta(&bench);
    let linear = (after[0] - before.0[0]).hypot(after[1] - before.0[1]) / size[0];
    let turning = (after[2] - before.0[2]).abs() / size[1];
    println!(
        "brought together: momentum {linear:.1e}, angular {turning:.1e}, {:.3} of the speed kept",
        size[0] / before.1
    );
    assert!(size[0] < 0.9 * before.1, "the joints had nothing to do");
    assert!(linear < 1e-6 && turning < 1e-6, "{linear:e} {turning:e}");
}

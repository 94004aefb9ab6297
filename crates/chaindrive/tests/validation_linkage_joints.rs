//! Pins in their bushes: rows of masses (C09), a shaken bush (S09), an oversize bush (S11), static offset (S13),
//! friction work (F01), and the restitution that every dissipation delivers in a joint.
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

mod dynamics;
mod linkages;
mod reference;

use std::f64::consts::{PI, TAU};

use chaindrive_contact::dissipation::{Exact, Viscous};
use chaindrive_contact::friction::Coulomb;
use chaindrive_contact::{Dissipation, Friction};
use chaindrive_integrate::Method;
use chaindrive_mechanics::{End, Flow, LinkBody, Surface};
use dynamics::brief;
use linkages::{Bench, Strand, body, clearance, harmonic, surface};
use reference::Reference;

/// One outer link of length `length` between its pins, the first one in a bush on the ground.
///
/// Its centre of mass lies `below` behind that pin, and at the start the pin stands `offset` from the bush's centre.
fn hung(length: f64, below: f64, gap: f64, offset: f64, bar: LinkBody, ends: [End; 2]) -> Strand {
    let mut strand = Strand::straight(1, length + 2.0 * gap, bar, ends);
    // The link lies in the middle between the two places.
    strand.places[1][0] = length + 2.0 * offset;
    strand.links.outer_first = true;
    strand.links.outer.centre = [below - 0.5 * length, 0.0].into();
    strand
}

/// The row is a taut strand: its links hang together by pins that just touch, and the first is pulled away.
#[test]
fn c09_a_mass_strikes_a_row_of_equal_masses() {
    let case = Reference::read("C09");
    let expected = case.table("expected.velocities");
    let mut worst = 0.0_f64;
    for (row, input) in case.table("inputs.rows").iter().enumerate() {
        let (count, exponent) = (input[0] as usize, input[1]);
        let (pitch, mass) = (0.1, 0.01);
        // Hard enough for all to be over before the last has crossed its bush.
        let (gap, stiffness) = (5e-3, 1e3 * 10_f64.powf(6.0 * (exponent - 0.5)));
        let mut strand = Strand::straight(count, pitch, body(mass, 1e-5), [End::Free, End::Free]);
        strand.links.joint = clearance(0.01, gap, surface(stiffness, exponent));
        let mut assembled = strand.assemble();
        assembled.v[0] = -1.0;
        let mut bench = Bench::start(assembled, Method::Rk4 { step: 2e-7 });
        bench.until(3e-3);
        for (mass, expected) in expected[row].iter().enumerate() {
            // Leftwards here.
            worst = worst.max((-bench.body(mass)[1][0] - expected).abs());
        }
    }
    println!("C09: {worst:.1e}");
    assert!(worst < case.number("tolerance.absolute"), "{worst}");
}

#[test]
fn s09_a_free_pin_in_a_shaken_bush() {
    let case = Reference::read("S09");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (amplitude, frequency, gap) = (input("A"), input("f"), input("c"));
    let circular = TAU * frequency;
    let phase = case.number("expected.phase_of_bush_at_impact_rad");
    let speed = case.number("expected.pin_speed");
    let mut stiff = surface(1e12, 1.5);
    let restitution = input("e");
    stiff.law.dissipation = Dissipation::Exact(Exact { restitution });
    // The clock starts at the impact on the left side, half a period after the one on the right.
    let shaking = End::Driven {
        x: harmonic(amplitude, frequency, phase + PI),
        y: chaindrive_mechanics::Motion::Held,
    };
    let mut strand = hung(0.1, 0.0, gap, -gap, body(0.01, 1e-5), [shaking, End::Free]);
    strand.links.joint = clearance(0.01, gap, stiff);
    let mut assembled = strand.assemble();
    // Away from the wall that it has just left.
    assembled.v[0] = speed;
    let mut bench = Bench::start(assembled, Method::Rk4 { step: 1e-7 });
    let cycles = 12_u32;
    let (mut worst, mut impacts) = ([0.0_f64; 3], 0_u32);
    let mut before = 0.0;
    let mut side = 1.0;
    while bench.state.t < f64::from(cycles) / frequency {
        let v = bench.body(0)[1][0];
        bench.advance();
        let t = bench.state.t;
        let bush = amplitude * ((circular * t + phase + PI).sin() - (phase + PI).sin());
        let offset = bench.body(0)[0][0] - bush;
        let past = side * offset - gap;
        if past > 0.0 && before <= 0.0 {
            let touch = t - 1e-7 * past / (past - before);
            let ideal = 0.5 * f64::from(impacts + 1) / frequency;
            worst[0] = worst[0].max(circular * (touch - ideal).abs() / phase);
            worst[1] = worst[1].max((v.abs() / speed - 1.0).abs());
            let wall = amplitude * circular * (circular * touch + phase + PI).cos();
            let approach = (v - wall).abs() / case.number("expected.approach_speed");
            worst[2] = worst[2].max((approach - 1.0).abs());
            impacts += 1;
            side = -side;
        }
        before = side * offset - gap;
    }
    println!(
        "S09: {impacts} impacts, phase, speed, approach {}",
        brief(&worst)
    );
    assert!((23..=24).contains(&impacts), "{impacts}");
    let tolerance = case.number("tolerance.relative");
    assert!(worst.iter().all(|&worst| worst < tolerance), "{worst:?}");
}

/// Frequency \[Hz\] of an angle that oscillates about zero, from its first and last rising zero.
fn frequency(mut bench: Bench, until: f64, of: impl Fn(&Bench) -> f64) -> f64 {
    let (mut first, mut last, mut count) = (0.0, 0.0, -1.0);
    while bench.state.t < until {
        let (t, angle) = (bench.state.t, of(&bench));
        bench.advance();
        let next = of(&bench);
        if angle < 0.0 && next >= 0.0 {
            last = t + (bench.state.t - t) * angle / (angle - next);
            if count < 0.0 {
                first = last;
            }
            count += 1.0;
        }
    }
    count / (last - first)
}

/// A pendulum in its bush, with its pin turned about the bush and its body by small angles \[rad\] from where they hang.
fn pendulum(case: &Reference, friction: Friction, [pin, swing]: [f64; 2], step: f64) -> Bench {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (mass, gap, gravity, below) = (input("m"), input("c"), input("g"), input("l"));
    let stiffness = 1e7;
    let ends = [End::Fixed, End::Free];
    let mut strand = hung(0.2, below, gap, 0.0, body(mass, input("J")), ends);
    let surface = Surface {
        friction,
        ..surface(stiffness, 1.0)
    };
    strand.links.joint = clearance(input("R_journal"), gap, surface);
    strand.gravity = [0.0, -gravity];
    let mut assembled = strand.assemble();
    let sink = gap + mass * gravity / stiffness;
    let angle = swing - 0.5 * PI;
    assembled.q = vec![
        sink * pin.sin() + below * angle.cos(),
        -sink * pin.cos() + below * angle.sin(),
        angle,
    ];
    Bench::start(assembled, Method::Rk4 { step })
}

fn swing(bench: &Bench) -> f64 {
    bench.body(0)[0][2] + 0.5 * PI
}

#[test]
fn s11_a_pendulum_in_an_oversize_bush() {
    let case = Reference::read("S11");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (mass, gap, below) = (input("m"), input("c"), input("l"));
    let expected = case.list("expected.f_frictionless_Hz");
    let mut errors = Vec::new();
    for (mode, expected) in expected.iter().enumerate() {
        // g θ_pin = ω² (c θ_pin + l θ_body): the shape of the mode
        let squared = (TAU * expected).powi(2);
        let ratio = squared * below / (input("g") - squared * gap);
        let shape = if ratio.abs() > 1.0 {
            [1e-3, 1e-3 / ratio]
        } else {
            [1e-3 * ratio, 1e-3]
        };
        let bench = pendulum(&case, Friction::None, shape, 1e-5);
        let found = frequency(bench, [6.0, 0.2][mode] / 1.835, swing);
        errors.push(found / expected - 1.0);
    }
    // Rolling: the pin turns in the bush as the body swings, r θ_body = c θ_pin.
    let rough = Friction::Coulomb(Coulomb {
        coefficient: 1.0,
        slip_speed: 1e-4,
    });
    let radius = input("R_journal");
    let small = 1e-3;
    let bench = pendulum(&case, rough, [-small * radius / gap, small], 1e-6);
    let rolling = frequency(bench, 0.8, swing) / case.number("expected.f_rolling_Hz") - 1.0;
    println!(
        "S11: frictionless {}, rolling {rolling:.1e}",
        brief(&errors)
    );
    let tolerance = case.number("tolerance.frictionless");
    assert!(
        errors.iter().all(|error| error.abs() < tolerance),
        "{errors:?}"
    );
    assert!(
        rolling.abs() < case.number("tolerance.rolling"),
        "{rolling}"
    );
    let _ = mass;
}

#[test]
fn s13_the_offset_of_a_pin_that_is_pulled() {
    let case = Reference::read("S13");
    let mut worst = 0.0_f64;
    for (row, input) in case.table("inputs.rows").iter().enumerate() {
        let [gap, force, stiffness, exponent] = input[..] else {
            panic!("four inputs")
        };
        let pull = End::Pulled {
            force: [force, 0.0].into(),
        };
        let mut strand = hung(
            0.1,
            0.05,
            gap,
            0.5 * gap,
            body(0.01, 1e-5),
            [End::Fixed, pull],
        );
        strand.links.joint = clearance(0.01, gap, surface(stiffness, exponent));
        strand.settle = true;
        let mut bench = Bench::start(strand.assemble(), Method::Rk4 { step: 1e-9 });
        let offset = bench.look().joint_offset_x[0];
        let expected = case.list("expected.offset")[row];
        worst = worst.max((offset / expected - 1.0).abs());
    }
    println!("S13: {worst:.1e}");
    assert!(worst < case.number("tolerance.relative"), "{worst}");
}

/// A taut link whose far end is led around the near one turns in both of its bushes under constant tension.
#[test]
fn f01_friction_work_of_an_articulation() {
    let case = Reference::read("F01");
    let mut errors = Vec::new();
    for (row, input) in case.table("inputs.rows").iter().enumerate() {
        let [tension, radius, coefficient, teeth] = input[..] else {
            panic!("four inputs")
        };
        let (length, gap, stiffness, spin): (f64, f64, f64, f64) = (0.1, 1e-6, 1e9, 20.0);
        // The pins stand turned in their bushes by the angle of friction.
        let tilt = coefficient.atan();
        let reach = length + 2.0 * (gap + tension * tilt.cos() / stiffness) * tilt.cos();
        let led = End::Driven {
            x: harmonic(reach, spin / TAU, 0.5 * PI),
            y: harmonic(reach, spin / TAU, 0.0),
        };
        let mut strand = hung(
            length,
            0.5 * length,
            gap,
            0.0,
            body(0.01, 1e-5),
            [End::Fixed, led],
        );
        strand.places[1][0] = reach;
        strand.velocities[1] = [0.0, spin * reach];
        let mut rough = Surface {
            friction: Friction::Coulomb(Coulomb {
                coefficient,
                slip_speed: 1e-3 * spin * radius,
            }),
            ..surface(stiffness, 1.0)
        };
        rough.law.dissipation = Dissipation::Viscous(Viscous { damping: 3e3 });
        strand.links.joint = clearance(radius, gap, rough);
        let mut bench = Bench::start(strand.assemble(), Method::ImplicitDamping { step: 1e-7 });
        let (mut pull, mut looks) = (0.0, 0.0);
        let until = TAU / teeth / spin;
        for part in 1..=20 {
            bench.until(0.05 * until * f64::from(part));
            pull += bench.look().joint_force[0];
            looks += 1.0;
        }
        let seen = bench.look();
        let turned = seen.link_angle[0];
        let work = seen.energy.flow(Flow::FrictionLoss) / 2.0;
        let pull = pull / looks / tension - 1.0;
        assert!(pull.abs() < 2e-3, "the tension is off by {pull:e}");
        assert!((turned * teeth / TAU - 1.0).abs() < 1e-4);
        errors.push(work / case.list("expected.work")[row] - 1.0);
    }
    println!("F01: {}", brief(&errors));
    let tolerance = case.number("tolerance.relative");
    assert!(
        errors.iter().all(|error| error.abs() < tolerance),
        "{errors:?}"
    );
}

/// A pin with the centre of mass of its link is thrown at its bush: the restitution is that of the table, which an
/// independent program worked out from the closed form.
#[test]
fn a_pin_thrown_at_its_bush_returns_with_the_restitution_of_its_law() {
    let table = include_str!("../../contact/tests/data/restitution.csv");
    let (gap, speed) = (1e-4, 0.5);
    let (mut worst, mut laws) = (0.0_f64, 0);
    for line in table.lines().skip(1) {
        let row: Vec<&str> = line.split(',').collect();
        let number = |i: usize| -> f64 { row[i].parse().expect("a number") };
        let index = NAMES
            .iter()
            .position(|name| *name == row[0])
            .expect("a known law");
        let mut surface = surface(1e8, 1.0);
        surface.law.dissipation = Dissipation::hysteretic(number(1))[index];
        let mut strand = hung(
            0.1,
            0.0,
            gap,
            gap,
            body(0.01, 1e-5),
            [End::Fixed, End::Free],
        );
        strand.links.joint = clearance(0.01, gap, surface);
        let mut assembled = strand.assemble();
        assembled.q[0] -= 1e-8;
        assembled.v[0] = speed;
        let mut bench = Bench::start(assembled, Method::Rk4 { step: 2e-8 });
        let start = bench.body(0)[0][0];
        while bench.body(0)[0][0] >= start {
            bench.advance();
        }
        let error = -bench.body(0)[1][0] / speed - number(3);
        worst = worst.max(error.abs());
        laws += 1;
        assert!(error.abs() < 1e-4, "{line}: {error:e}");
    }
    println!("restitution of {laws} laws in a joint: {worst:.1e}");
}

/// In the order of `Dissipation::hysteretic`.
const NAMES: [&str; 9] = [
    "exact",
    "hunt_crossley",
    "lankarani_nikravesh",
    "lee_wang",
    "herbert_mcwhannell",
    "gonthier",
    "zhiying_qishao",
    "flores",
    "hu_guo",
];

//! Drives that the passing of their teeth excites (validation cases V14, V15).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

mod dynamics;
mod reference;

use std::f64::consts::{PI, TAU};

use dynamics::{mean, range, run};
use reference::Reference;

/// Root of the mean square of the sway at the middle of the tight span, while `teeth` pass.
fn sway(row: &[f64], rpm: f64) -> f64 {
    let [teeth, pitch, span, tension, line_mass, ..] = row[..] else {
        panic!("six inputs")
    };
    let radius = 0.5 * pitch / (PI / teeth).sin();
    let speed = rpm * TAU / 60.0;
    // A fifth of a millimetre off, so that the lower span hangs.
    let distance = span * pitch - 2e-4;
    let torque = tension * radius;
    let until = 24.0 / (teeth * rpm / 60.0);
    let text = format!(
        r#"
        [chain]
        pitch = {pitch}
        links = {links}
        mass = {mass}
        stiffness = 2e7
        damping_ratio = 0.05
        roller_diameter = {roller}
        [contact.teeth]
        law = {{ kind = "linear", stiffness = 1e8 }}
        restitution = 0.5
        [[sprockets]]
        name = "driver"
        teeth = {teeth}
        centre = [0, 0]
        motion = {{ kind = "constant", speed = {speed} }}
        [[sprockets]]
        name = "driven"
        teeth = {teeth}
        centre = [{distance}, 0]
        inertia = 2e-4
        load = [{{ kind = "constant", torque = {load} }}]
        [route]
        stops = ["driven", "driver"]
        [run]
        until = {until}
        every = {every}
        "#,
        links = (teeth + 2.0 * span).round(),
        mass = line_mass * pitch,
        roller = 0.67 * pitch,
        load = -torque,
        every = until / 2400.0,
    );
    let mut heights = Vec::new();
    run(&text, |sample| {
        // The rollers of the upper span on both sides of its middle.
        let middle = 0.5 * distance;
        let n = sample.roller_x.len();
        let crossing = (0..n).find(|&i| {
            let (a, b) = (
                sample.roller_x[i] - middle,
                sample.roller_x[(i + 1) % n] - middle,
            );
            a * b <= 0.0 && sample.roller_y[i] > 0.0
        });
        let i = crossing.expect("the upper span passes its middle");
        let (a, b) = (
            sample.roller_x[i] - middle,
            sample.roller_x[(i + 1) % n] - middle,
        );
        let (p, q) = (sample.roller_y[i], sample.roller_y[(i + 1) % n]);
        heights.push((p * b - q * a) / (b - a));
    });
    let average = mean(&heights);
    let squares: Vec<f64> = heights.iter().map(|y| (y - average).powi(2)).collect();
    mean(&squares).sqrt()
}

/// `cargo test --release -p chaindrive --test validation_dynamics_resonance -- --ignored`
#[test]
#[ignore = "seventeen runs"]
fn v14_speed_of_direct_resonance() {
    let case = Reference::read("V14");
    let row = &case.table("inputs.rows")[0];
    let expected = case.table("expected.rows")[0][0];
    let rpm = |i: i32| expected * (1.0 + 0.02 * f64::from(i));
    let found: Vec<(i32, f64)> = (-8..=8).map(|i| (i, sway(row, rpm(i)))).collect();
    for (i, sway) in &found {
        println!("V14: {:.1} rpm: {:.3} mm", rpm(*i), 1e3 * sway);
    }
    let peak = found
        .iter()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |best| best.0);
    println!("V14: peak at {:.1} rpm for {expected:.1} rpm", rpm(peak));
    assert!((rpm(peak) / expected - 1.0).abs() < case.number("tolerance.relative"));
}

/// Range of the driven wheel's motion over that of the kinematic one, and of the tension \[N\].
fn forced(case: &Reference, rpm: f64) -> (f64, f64) {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (teeth, pitch, inertia) = (input("z1"), input("pitch"), input("J2"));
    let radius = 0.5 * pitch / (PI / teeth).sin();
    let speed = rpm * TAU / 60.0;
    let span = input("C") / pitch;
    // The seated links at both ends give as much as one and a half free ones.
    let stiffness = input("k_span") * (span + 1.5);
    let damping = 2.0 * input("zeta") * input("wn") * inertia / radius.powi(2) * (span + 1.5);
    let tension = 250.0;
    let period = 60.0 / (teeth * rpm);
    // Three times the decay time of the free vibration, in whole teeth.
    let settled = (3.0 / (input("zeta") * input("wn")) / period).ceil() * period;
    let text = format!(
        r#"
        settle = false
        [chain]
        pitch = {pitch}
        links = {links}
        mass = 1e-3
        stiffness = {stiffness}
        damping = {damping}
        roller_diameter = {roller}
        [contact.teeth]
        law = {{ kind = "linear", stiffness = 2e8 }}
        damping = 100
        [[sprockets]]
        name = "driver"
        teeth = {teeth}
        tooth = {{ kind = "circular", seat_radius = {seat} }}
        centre = [0, 0]
        motion = {{ kind = "constant", speed = {speed} }}
        [[sprockets]]
        name = "driven"
        teeth = {teeth}
        tooth = {{ kind = "circular", seat_radius = {seat} }}
        centre = [{distance}, 0]
        inertia = {inertia}
        load = [{{ kind = "ramp", torque = {load}, duration = {ramp} }}]
        [route]
        stops = ["driven", "driver"]
        [run]
        until = {until}
        every = {every}
        "#,
        links = (teeth + 2.0 * span).round(),
        roller = 0.6 * pitch,
        seat = 0.3 * pitch,
        distance = input("C") - 1e-4,
        load = -tension * radius,
        ramp = 0.3 * settled,
        until = settled + 4.0 * period,
        every = period / 200.0,
    );
    let (mut motion, mut pull) = (Vec::new(), Vec::new());
    run(&text, |sample| {
        if sample.time > settled - 1e-9 {
            motion.push(sample.sprocket_angle[1] - sample.sprocket_angle[0]);
            pull.push(sample.span_tension[0].max(sample.span_tension[1]));
        }
    });
    (range(&motion), range(&pull))
}

#[test]
#[ignore = "four slow runs"]
fn v15_forced_vibration_of_the_driven_wheel() {
    let case = Reference::read("V15");
    let free = Reference::read("K03").number("expected.summary.te_ptp_rad");
    let rows = case.table("inputs.rows");
    let expected = case.table("expected.rows");
    for (row, expected) in rows.iter().zip(expected) {
        if ![0.5, 0.8, 1.3, 2.0].contains(&row[0]) {
            continue;
        }
        let (motion, pull) = forced(&case, expected[0]);
        let errors = [motion / free / expected[2] - 1.0, pull / expected[3] - 1.0];
        println!(
            "V15: r = {}: motion {:.1e}, ripple {:.1e}",
            row[0], errors[0], errors[1]
        );
    }
}

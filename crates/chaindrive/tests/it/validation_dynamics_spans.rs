//! Spans that are pumped, spans that move, and wheels on two spans (validation cases V05, V06,
//! V13).

use crate::dynamics;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

use chaindrive::Scene;
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use dynamics::{numbers, pairs, run, run_open, strongest};

/// Share of the first mode in the transverse motion of a strand with both ends on the x axis.
fn first_mode(y: &[f64]) -> f64 {
    let n = y.len() - 1;
    let parts = y.iter().enumerate();
    let sum: f64 = parts
        .map(|(i, y)| y * (PI * i as f64 / n as f64).sin())
        .sum();
    2.0 * sum / n as f64
}

/// Growth rate \[1/s\] of the first mode of a strand whose tension is pumped.
///
/// Sampled once a pump period τ, the mode obeys aₖ₊₁ + aₖ₋₁ = 2 cosh(μ τ) aₖ or, below a
/// half-frequency resonance, −2 cosh(μ τ) aₖ: Floquet's theorem without a fit to a growing envelope.
fn growth(f1: f64, depth: f64, ratio: f64) -> f64 {
    let (n, pitch, mass, stiffness) = (20_u32, 0.0127, 0.008_89, 2e8);
    // f₁ = (1/π) √(T/(m p)) sin(π/2n)
    let tension = mass * pitch * (PI * f1 / (PI / f64::from(2 * n)).sin()).powi(2);
    let stretch = depth * tension * f64::from(n) / stiffness;
    let frequency = ratio * f1;
    let length = f64::from(n) * pitch;
    // Half the pump swing beyond the mean, where the motion begins.
    let place = |i: u32| {
        let share = f64::from(i) / f64::from(n);
        [share * (length + stretch), 1e-7 * (PI * share).sin()]
    };
    let rest = pitch - tension / stiffness;
    let scene = format!(
        r#"
        gravity = [0, 0]
        settle = false
        [chain]
        pitch = {pitch}
        inner_pitch = {rest}
        outer_pitch = {rest}
        links = {n}
        mass = {mass}
        stiffness = {stiffness}
        damping_ratio = 0.1
        [[chain.ends]]
        kind = "fixed"
        [[chain.ends]]
        kind = "driven"
        x = {{ kind = "harmonics", terms = [{{ amplitude = {stretch}, frequency = {frequency}, phase = "90 deg" }}] }}
        [chain.start]
        kind = "points"
        positions = {positions}
        [run]
        until = {until}
        every = {every}
        "#,
        positions = pairs((0..=n).map(place)),
        until = 10.0 / frequency,
        every = 1.0 / frequency,
    );
    let mut a = Vec::new();
    run(&scene, |sample| a.push(first_mode(&sample.roller_y)));
    // 2 cosh(μ τ) by least squares.
    let (mut above, mut below) = (0.0, 0.0);
    for w in a.windows(3) {
        above += (w[0] + w[2]) * w[1];
        below += w[1] * w[1];
    }
    let trace = (0.5 * above / below).abs();
    frequency * trace.max(1.0).acosh()
}

#[test]
fn v13_growth_of_a_pumped_span() {
    let case = Case::read("V13");
    let f1 = case.number("inputs.f1");
    let allowed = case.number("tolerance.relative");
    let rows = case.table("inputs.rows");
    for (row, expected) in rows.iter().zip(case.table("expected.rows")) {
        let (depth, ratio, expected) = (row[0], row[1], expected[0]);
        let found = growth(f1, depth, ratio);
        let largest = 0.25 * depth * TAU * f1;
        let tolerance = if expected > 0.0 {
            Relative(allowed)
        } else {
            Absolute(allowed * largest)
        };
        let quantity = format!("growth rate, depth {depth}, Ω = {ratio} ω₁");
        case.judge(&quantity, "1/s", found, expected, tolerance);
    }
}

/// First frequency \[Hz\] of a span between two small eyelets through which a strand runs.
///
/// An eyelet is a pair of rods that the link plates touch from both sides.
fn moving(length: f64, tension: f64, line_mass: f64, v: f64, expected: f64) -> f64 {
    let pitch = match line_mass {
        m if m < 1.0 => 0.0127,
        m if m < 10.0 => 0.019_05,
        _ => 0.0889,
    };
    let mass = line_mass * pitch;
    let stiffness = 5e3 * tension / pitch;
    let (periods, height) = (6.0, 0.8 * pitch);
    let until = periods / expected;
    let behind = ((v * until / pitch).ceil() + 4.0) * pitch;
    let mut count: u32 = 4;
    while f64::from(count - 4) * pitch < behind + length {
        count += 1;
    }
    let amplitude = 1e-4 * length;
    let state = |i: u32| {
        let x = f64::from(i) * pitch - behind;
        let phase = PI * x / length;
        if x > 0.0 && x < length {
            let y = amplitude * phase.sin();
            // At rest as seen from the eyelets: ẏ = v y'
            ([x, y], [v, v * amplitude * PI / length * phase.cos()])
        } else {
            ([x, 0.0], [v, 0.0])
        }
    };
    let mut guides = String::new();
    for (name, x, side) in [
        ("in-below", 0.0, -1.0),
        ("in-above", 0.0, 1.0),
        ("out-below", length, -1.0),
        ("out-above", length, 1.0),
    ] {
        let radius = 0.1 * pitch;
        // Pressed on by a little, so that the span never parts from the rods.
        let y = side * (0.5 * height + radius - 1e-6 * pitch);
        write!(
            guides,
            r#"
            [[guides]]
            name = "{name}"
            touches = "plates"
            face = {{ kind = "arc", centre = [{x}, {y}], radius = {radius}, from = {from}, to = {to} }}
            "#,
            from = -side * FRAC_PI_2 - 0.5,
            to = -side * FRAC_PI_2 + 0.5,
        )
        .expect("a text grows");
    }
    let scene = format!(
        r#"
        gravity = [0, 0]
        settle = false
        [chain]
        pitch = {pitch}
        inner_pitch = {rest}
        outer_pitch = {rest}
        links = {links}
        mass = {mass}
        stiffness = {stiffness}
        roller_diameter = {roller}
        plate_height = {height}
        ends = [
            {{ kind = "driven", x = {{ kind = "constant", speed = {v} }} }},
            {{ kind = "driven", x = {{ kind = "constant", speed = {v} }} }},
        ]
        [chain.start]
        kind = "points"
        positions = {positions}
        velocities = {velocities}
        [contact.guides]
        law = {{ kind = "linear", stiffness = {stiffness} }}
        damping = 0
        {guides}
        [run]
        until = {until}
        every = {every}
        step = {step}
        "#,
        rest = pitch - tension / stiffness,
        links = count - 1,
        roller = 0.6 * pitch,
        positions = pairs((0..count).map(|i| state(i).0)),
        velocities = pairs((0..count).map(|i| state(i).1)),
        // At the default step, twelve times this, links that pass under the rods gain 10 mJ, 3000 times the energy of the swing.
        step = 0.02 * (mass / stiffness).sqrt(),
        every = until / 600.0,
    );
    let mut mode = Vec::new();
    let (_, open) = run_open(&scene, |sample| {
        let places = sample.roller_x.iter().zip(&sample.roller_y);
        let inside = places.filter(|(x, _)| (0.0..length).contains(*x));
        mode.push(inside.map(|(x, y)| y * (PI * x / length).sin()).sum());
    });
    // Of the µJ of its swing.
    assert!(open < 0.1, "{open}");
    strongest(&mode, until / 600.0, (0.7 * expected, 1.3 * expected))
}

#[test]
fn v05_frequency_of_a_moving_span() {
    frequencies_of_moving_spans(0..1);
}

#[test]
#[ignore = "slow"]
fn v05_frequencies_of_faster_spans() {
    frequencies_of_moving_spans(1..usize::MAX);
}

fn frequencies_of_moving_spans(judged: std::ops::Range<usize>) {
    let case = Case::read("V05");
    let rows = case.table("inputs.rows");
    let rows = rows.iter().zip(case.table("expected.rows")).enumerate();
    for (_, (row, expected)) in rows.filter(|(at, _)| judged.contains(at)) {
        let expected = expected[0];
        let found = moving(row[0], row[1], row[2], row[3], expected);
        let tolerance = Relative(case.number("tolerance.relative"));
        case.judge("first frequency", "Hz", found, expected, tolerance);
    }
}

#[test]
fn v06_two_free_wheels_twist_on_a_taut_chain() {
    let case = Case::read("V06");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let expected = case.number("expected.f_Hz");
    // Seventeen teeth at R₁; the second wheel of twice as many is 0.4 % smaller than 2 R₁.
    let (z1, z2, span) = (17.0, 34.0, 20.0);
    let pitch = 2.0 * input("R1") * (PI / z1).sin();
    let links = z1 / 2.0 + z2 / 2.0 + 2.0 * span + 0.5;
    let scene_of = |distance: f64, adjust: &str| {
        format!(
            r#"
        gravity = [0, 0]
        [chain]
        pitch = {pitch}
        links = {links}
        mass = 1e-5
        stiffness = 2e7
        damping = 0
        roller_diameter = {roller}
        [contact.teeth]
        law = {{ kind = "linear", stiffness = 1e9 }}
        damping = 0
        [[sprockets]]
        name = "small"
        teeth = {z1}
        tooth = {{ kind = "circular", seat_radius = {seat} }}
        centre = [0, 0]
        inertia = {j1}
        drive = [
            {{ kind = "ramp", torque = 1, duration = 1e-4 }},
            {{ kind = "ramp", torque = -1, start = 1e-4, duration = 1e-4 }},
        ]
        [[sprockets]]
        name = "large"
        teeth = {z2}
        tooth = {{ kind = "circular", seat_radius = {seat} }}
        centre = [{distance}, 0]
        inertia = {j2}
        [route]
        {adjust}
        [run]
        until = {until}
        every = {every}
        "#,
            roller = 0.6 * pitch,
            seat = 0.3 * pitch,
            j1 = input("J1"),
            j2 = input("J2"),
            until = 8.0 / expected,
            every = 0.01 / expected,
        )
    };
    let adjust = format!(
        "adjust = {{ kind = 'sprocket', name = 'large', direction = [1, 0], within = {pitch} }}"
    );
    let text = scene_of(span * pitch, &adjust);
    let scene = Scene::from_text(&text, "v06.toml").unwrap_or_else(|error| panic!("{error}"));
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let laid = &drive.layouts().expect("the chain closes")[0];
    let (places, fitting) = (&laid.positions, laid.fitting.as_ref());
    let fitting = fitting.expect("it runs around sprockets");
    let distance = span * pitch + fitting.travel;
    let radii = [z1, z2].map(|z| pitch / (2.0 * (PI / z).sin()));
    let seated = |x: f64, y: f64| {
        let off = [x.hypot(y) - radii[0], (x - distance).hypot(y) - radii[1]];
        off.iter().any(|off| off.abs() < 1e-6 * pitch)
    };
    let seated: Vec<bool> = places.iter().map(|p| seated(p.x, p.y)).collect();
    // The links of the spans share the stiffness of each; seated ones do not give. All of them
    // are drawn to one pitch by the same tension.
    let n = seated.len();
    assert_eq!(fitting.spans[0], fitting.spans[1]);
    let free = input("k_tight") * f64::from(fitting.spans[0]);
    let stiff = |i: usize| seated[i] && seated[(i + 1) % n];
    let stiffness: Vec<f64> = (0..n).map(|i| if stiff(i) { 1e9 } else { free }).collect();
    let lengths = numbers(stiffness.iter().map(|k| pitch - 500.0 / k));
    let stiffness = numbers(stiffness);
    let text = scene_of(distance, "").replace(
        "stiffness = 2e7",
        &format!("stiffnesses = {stiffness}\npitches = {lengths}"),
    );
    let mut twist = Vec::new();
    run(&text, |sample| {
        let speed = &sample.sprocket_speed;
        twist.push(radii[0] * speed[0] - radii[1] * speed[1]);
        let least = sample
            .link_tension
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        assert!(least > 0.0, "a link is slack: {least} N");
    });
    let found = strongest(&twist, 0.01 / expected, (0.8 * expected, 1.2 * expected));
    let tolerance = Relative(case.number("tolerance.relative"));
    case.judge("frequency of the twist", "Hz", found, expected, tolerance);
}

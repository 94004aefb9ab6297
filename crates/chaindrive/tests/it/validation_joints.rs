//! Rigid links and joints with play, one at a time (validation cases E02, X01, S09, S11, S13, C07, C08, F01).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;

use std::f64::consts::{PI, TAU};

use chaindrive::{ContactEvent, Flow, Observation};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use dynamics::{run, run_open};

/// Largest distance \[m\] of a pin of five falling bars from its reference.
fn falling_bars(id: &str, method: &str, step: f64) -> f64 {
    let case = Case::read(id);
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (n, p) = (input("N"), input("pitch"));
    let body = format!("{{ mass = {}, inertia = {} }}", input("m"), input("J"));
    let scene = format!(
        r#"
        gravity = [0, {g}]
        settle = false
        [chain]
        model = "ideal-joints"
        rollers = "none"
        pitch = {p}
        links = {n}
        stiffness = 1e6
        inner = {body}
        outer = {body}
        ends = ["fixed", "free"]
        start = {{ kind = "line", from = [0, 0], to = [{length}, 0] }}
        [run]
        until = {until}
        every = 0.05
        method = "{method}"
        step = {step}
        "#,
        g = -input("g"),
        length = n * p,
        until = case.number("tolerance.until"),
    );
    let times = case.list("expected.t");
    let (x, y) = (case.table("expected.x"), case.table("expected.y"));
    let (mut worst, mut judged): (f64, usize) = (0.0, 0);
    run(&scene, |sample| {
        let Some(k) = times.iter().position(|t| (t - sample.time).abs() < 1e-9) else {
            return;
        };
        judged += 1;
        for i in 0..x[k].len() {
            let d = [
                sample.roller_x[i + 1] - x[k][i],
                sample.roller_y[i + 1] - y[k][i],
            ];
            worst = worst.max(d[0].hypot(d[1]));
        }
    });
    assert!(judged >= 2, "{judged}");
    worst
}

#[test]
fn e02_x01_hinged_bars_let_go_from_the_horizontal() {
    for id in ["E02", "X01"] {
        let case = Case::read(id);
        let worst = falling_bars(id, "rk4", 1e-4);
        let tolerance = Absolute(case.number("tolerance.position"));
        let quantity = "largest distance of a pin from its place";
        case.judge(quantity, "m", worst, 0.0, tolerance);
    }
}

/// The hinges hold with the implicit method of second order as well.
#[test]
fn hinges_hold_with_generalized_alpha() {
    let coarse = falling_bars("E02", "generalized-alpha", 4e-4);
    let fine = falling_bars("E02", "generalized-alpha", 1e-4);
    println!("generalized-alpha: {coarse:.1e} and {fine:.1e} m");
    assert!(fine < 0.3 * coarse && fine < 2e-6, "{coarse} {fine}");
}

/// One outer link with its pin in a bush of the frame.
fn one_link(what: &str) -> String {
    format!(
        r#"
        [chain]
        model = "clearance-joints"
        rollers = "none"
        outer_first = true
        links = 1
        roller_diameter = 0.03
        {what}
        "#
    )
}

#[test]
fn s13_static_offset_of_a_pin() {
    let case = Case::read("S13");
    for row in case.table("expected.rows") {
        let [c, force, k, n, offset] = row[..] else {
            panic!("five columns")
        };
        let scene = one_link(&format!(
            r#"
            pitch = 0.02
            joint = {{ pin_diameter = 0.01, clearance = {c}, length = 0.01 }}
            inner = {{ mass = 0.05, inertia = 4e-5 }}
            outer = {{ mass = 0.05, inertia = 4e-5 }}
            ends = ["fixed", {{ kind = "pulled", force = [{force}, 0] }}]
            start = {{ kind = "line", from = [0, 0], to = [0.02, 0] }}
            [contact.joints]
            law = {{ kind = "power", stiffness = {k}, exponent = {n} }}
            [run]
            until = 1e-5
            every = 1e-5
            "#
        ));
        let scene = format!("gravity = [0, 0]\n{scene}");
        let mut found = f64::NAN;
        run_open(&scene, |sample| {
            if sample.time <= 0.0 {
                found = sample.joint_offset_x[0];
            }
        });
        let tolerance = Relative(case.number("tolerance.relative"));
        case.judge("offset of the pin", "m", found, offset, tolerance);
    }
}

/// Times of the upward zero crossings of a signal.
fn crossings(signal: &[(f64, f64)]) -> Vec<f64> {
    let pairs = signal
        .windows(2)
        .filter(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0);
    pairs
        .map(|pair| {
            let [(t0, y0), (t1, y1)] = [pair[0], pair[1]];
            t0 + (t1 - t0) * y0 / (y0 - y1)
        })
        .collect()
}

fn frequency(signal: &[(f64, f64)]) -> f64 {
    let times = crossings(signal);
    (times.len() - 1) as f64 / (times[times.len() - 1] - times[0])
}

/// The pendulum of case S11: angle of the link from the vertical, and the eccentricity across, over time.
fn pendulum(case: &Case, until: f64, rates: [f64; 2], friction: &str) -> [Vec<(f64, f64)>; 2] {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    // An outer link is shorter than the pitch by its play at both ends.
    let (c, l) = (input("c"), input("l"));
    let length = 0.1 + 2.0 * c;
    // Pin and link end move with the eccentricity's and the link's own rates.
    let pin = c * rates[0];
    let scene = one_link(&format!(
        r#"
        pitch = {length}
        joint = {{ pin_diameter = {d}, clearance = {c}, length = 0.01 }}
        inner = {{ mass = {m}, inertia = {j} }}
        outer = {{ mass = {m}, inertia = {j}, centre = [{centre}, 0] }}
        ends = ["fixed", "free"]
        [chain.start]
        kind = "points"
        positions = [[0, 0], [0, {below}]]
        velocities = [[{pin}, 0], [{end}, 0]]
        [contact.joints]
        law = {{ kind = "linear", stiffness = 2e6 }}
        dissipation = "none"
        {friction}
        [run]
        until = {until}
        every = 5e-4
        method = "implicit-damping"
        step = 2e-5
        "#,
        d = 2.0 * input("R_journal"),
        m = input("m"),
        j = input("J"),
        centre = l - 0.05,
        below = -length,
        end = pin + length * rates[1],
    ));
    let scene = format!("gravity = [0, {}]\n{scene}", -input("g"));
    let mut signals = [Vec::new(), Vec::new()];
    run(&scene, |sample: &Observation| {
        signals[0].push((sample.time, sample.link_angle[0] + 0.5 * PI));
        signals[1].push((sample.time, sample.joint_offset_x[0]));
    });
    signals
}

#[test]
fn s11_pendulum_in_an_oversize_bush() {
    let case = Case::read("S11");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let expected = |name: &str| case.number(&format!("expected.{name}"));
    // Rates of link and eccentricity in a mode: φ/α = (g/ω² − c)/l
    let shape = |f: f64| (input("g") / (TAU * f).powi(2) - input("c")) / input("l");
    for (name, tolerance, until, signal) in [
        ("low", "frictionless", 3.0, 0),
        ("high", "frictionless", 1.0, 1),
    ] {
        let f = expected(name);
        let alpha = if name == "low" { 0.01 } else { 0.1 };
        let rates = [alpha * TAU * f * 0.1, alpha * TAU * f * 0.1 * shape(f)];
        let signals = pendulum(&case, until, rates, "");
        let found = frequency(&signals[signal]);
        let tolerance = Relative(case.number(&format!("tolerance.{tolerance}")));
        let quantity = format!("{name} frequency");
        case.judge(&quantity, "Hz", found, f, tolerance);
    }
    // Rolling: c α' = −R_j φ' without slip; LuGre's bristles hold.
    let friction = r#"friction = { kind = "lugre", static_coefficient = 2.0, coefficient = 2.0, stiffness = 1e6, damping = 300 }"#;
    let f = expected("rolling");
    let phi = 1e-3 * f;
    let alpha = -phi * input("R_journal") / input("c");
    let signals = pendulum(&case, 1.5, [alpha, phi], friction);
    let found = frequency(&signals[0]);
    let tolerance = Relative(case.number("tolerance.rolling"));
    case.judge("frequency of rolling", "Hz", found, f, tolerance);
}

#[test]
fn s09_free_pin_in_a_shaken_bush() {
    let case = Case::read("S09");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let expected = |name: &str| case.number(&format!("expected.{name}"));
    let (amplitude, f, c) = (input("A"), input("f"), input("c"));
    let (phase, speed, omega) = (expected("phase"), expected("pin_speed"), TAU * f);
    // After the impact at the right the pin flies left; the run begins where it passes the bush's centre.
    let apart = |t: f64| {
        let bush = amplitude * (omega * t + phase).sin();
        amplitude * phase.sin() + c - speed * t - bush
    };
    let (mut low, mut high) = (0.0, 0.5 / f);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if apart(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let begin = omega * low + phase;
    let scene = one_link(&format!(
        r#"
        pitch = 0.02
        joint = {{ pin_diameter = 0.01, clearance = {c}, length = 0.01 }}
        inner = {{ mass = 0.01, inertia = 1e-6 }}
        outer = {{ mass = 0.01, inertia = 1e-6, centre = [-0.01, 0] }}
        ends = [{{ kind = "driven", x = {{ kind = "harmonics", terms = [
            {{ amplitude = {amplitude}, frequency = {f}, phase = {begin} }}] }} }}, "free"]
        [chain.start]
        kind = "points"
        positions = [[0, 0], [0.02, 0]]
        velocities = [[{v}, 0], [{v}, 0]]
        [contact.joints]
        law = {{ kind = "power", stiffness = 5e9, exponent = 1.5 }}
        dissipation = "exact"
        restitution = {e}
        onset_floor = 1e-3
        [run]
        until = 0.4
        every = 1e-2
        events = ["joints"]
        method = "rk4"
        step = 2e-7
        "#,
        v = -speed,
        e = input("e"),
    ));
    let scene = format!("gravity = [0, 0]\nsettle = false\n{scene}");
    let mut events: Vec<ContactEvent> = Vec::new();
    let mut simulation = dynamics::start(&scene);
    while let Ok(Some(_)) = simulation.next_sample() {
        events.extend(simulation.events());
    }
    assert!(
        events.len() >= 36,
        "{} impacts in twenty cycles",
        events.len()
    );
    let tolerance = Relative(case.number("tolerance.relative"));
    for event in &events[events.len() - 20..] {
        // Half-way through the contact, on either side.
        let at = 0.5 * (event.start + event.end);
        let after = (omega * at + begin - phase).rem_euclid(PI);
        let found = phase + if after < 0.5 * PI { after } else { after - PI };
        case.judge("phase of an impact", "rad", found, phase, tolerance);
        let (found, expected) = (event.onset_speed, expected("approach_speed"));
        case.judge("approach speed", "m/s", found, expected, tolerance);
    }
}

/// A disc on a flat guide: one link of a bush chain whose mass is all at its first bush.
fn disc(
    m: f64,
    r: f64,
    kappa: f64,
    velocity: [f64; 2],
    spin: f64,
    height: f64,
    rest: &str,
) -> String {
    let length = 0.05;
    format!(
        r#"
        settle = false
        [chain]
        model = "clearance-joints"
        rollers = "none"
        outer_first = false
        pitch = {length}
        links = 1
        roller_diameter = {d}
        joint = {{ pin_diameter = 0.004, clearance = 1e-5, length = 0.01 }}
        inner = {{ mass = {m}, inertia = {j}, centre = [{centre}, 0] }}
        outer = {{ mass = {m}, inertia = {j} }}
        ends = ["free", "free"]
        [chain.start]
        kind = "points"
        positions = [[0, {height}], [0, {top}]]
        velocities = [[{vx}, {vy}], [{tx}, {vy}]]
        [[guides]]
        name = "bar"
        face = {{ kind = "bar", start = [-1, 0], end = [3, 0], end_radius = 0.01, end_angle = 0.1 }}
        {rest}
        "#,
        d = 2.0 * r,
        j = kappa * m * r * r,
        centre = -0.5 * length,
        top = height + length,
        vx = velocity[0],
        vy = velocity[1],
        tx = velocity[0] - spin * length,
    )
}

#[test]
fn c07_oblique_impact_of_a_disc() {
    let case = Case::read("C07");
    for row in case.table("expected.rows") {
        let [
            m,
            r,
            kappa,
            vn,
            vt,
            spin,
            e,
            mu,
            vn_after,
            vt_after,
            spin_after,
        ] = row[..]
        else {
            panic!("eleven columns")
        };
        let scene = disc(
            m,
            r,
            kappa,
            [vt, -vn],
            spin,
            r + 1e-5,
            &format!(
                r#"
                [contact.guides]
                law = {{ kind = "power", stiffness = 5e9, exponent = 1.5 }}
                dissipation = "exact"
                restitution = {e}
                onset_floor = 1e-3
                friction = {{ coefficient = {mu}, slip_speed = 1e-3 }}
                [run]
                until = 2e-3
                every = 1e-4
                method = "rk4"
                step = 5e-8
                "#
            ),
        );
        let scene = format!("gravity = [0, 0]\n{scene}");
        let mut after = [0.0; 3];
        let mut angles = Vec::new();
        run(&scene, |sample| {
            after[0] = sample.roller_vy[0];
            after[1] = sample.roller_vx[0];
            angles.push((sample.time, sample.link_angle[0]));
        });
        let [(t0, a0), (t1, a1)] = [angles[angles.len() - 2], angles[angles.len() - 1]];
        after[2] = (a1 - a0) / (t1 - t0);
        let tolerance = Relative(case.number("tolerance.relative"));
        for (quantity, unit, found, expected) in [
            ("normal speed after", "m/s", after[0], vn_after),
            ("tangential speed after", "m/s", after[1], vt_after),
            ("spin after", "rad/s", after[2], spin_after),
        ] {
            case.judge(quantity, unit, found, expected, tolerance);
        }
    }
}

#[test]
fn c08_disc_slides_until_it_rolls() {
    let case = Case::read("C08");
    let g = case.number("inputs.g");
    for row in case.table("expected.rows") {
        let [kappa, v0, mu, v_roll, t_slip, x_slip] = row[..] else {
            panic!("six columns")
        };
        // So large that it turns by less than a right angle: the far end of the link stays off the guide.
        let (m, r, k) = (0.01, 1.0, 1e6);
        // Starts at its static indentation.
        let height = r - m * g / k;
        let scene = disc(
            m,
            r,
            kappa,
            [v0, 0.0],
            0.0,
            height,
            &format!(
                r#"
                [contact.guides]
                law = {{ kind = "linear", stiffness = {k} }}
                restitution = 0.5
                friction = {{ coefficient = {mu}, slip_speed = 1e-5 }}
                [run]
                until = {until}
                every = 1e-3
                method = "implicit-damping"
                step = 2e-5
                "#,
                until = 1.3 * t_slip,
            ),
        );
        let scene = format!("gravity = [0, {}]\n{scene}", -g);
        let mut track = Vec::new();
        run(&scene, |sample| {
            track.push((sample.time, sample.roller_x[0], sample.roller_vx[0]));
        });
        let rolling = track[track.len() - 1].2;
        // The speed falls along a straight line until it stays: where the line meets the final speed.
        let early = track[track.len() / 4];
        let slope = (early.2 - v0) / early.0;
        let slipped = (rolling - v0) / slope;
        let place = track
            .iter()
            .rev()
            .find(|(t, _, _)| *t <= slipped)
            .expect("it began to slip");
        let way = place.1 + rolling * (slipped - place.0);
        let tolerance = Relative(case.number("tolerance.relative"));
        for (quantity, unit, found, expected) in [
            ("speed of rolling", "m/s", rolling, v_roll),
            ("time of slipping", "s", slipped, t_slip),
            ("way of slipping", "m", way, x_slip),
        ] {
            case.judge(quantity, unit, found, expected, tolerance);
        }
    }
}

#[test]
fn f01_friction_work_of_one_articulation() {
    let case = Case::read("F01");
    for row in case.table("expected.rows") {
        let [tension, radius, mu, _, angle, work] = row[..] else {
            panic!("six columns")
        };
        // A link held between two bushes, the second of which swings around the first: two joints turn.
        let (length, c, k, rate) = (0.02, 5e-6, 1e8, 20.0);
        let reach = length + 2.0 * tension / k;
        let scene = one_link(&format!(
            r#"
            pitch = {length}
            joint = {{ pin_diameter = {d}, clearance = {c}, length = 0.01 }}
            inner = {{ mass = 1e-3, inertia = 1e-7 }}
            outer = {{ mass = 1e-3, inertia = 1e-7 }}
            ends = ["fixed", {{ kind = "driven",
                x = {{ kind = "harmonics", terms = [{{ amplitude = {reach}, frequency = {f}, phase = {quarter} }}] }},
                y = {{ kind = "harmonics", terms = [{{ amplitude = {reach}, frequency = {f}, phase = 0 }}] }} }}]
            [chain.start]
            kind = "points"
            positions = [[0, 0], [{reach}, 0]]
            velocities = [[0, 0], [0, {speed}]]
            [contact.joints]
            law = {{ kind = "linear", stiffness = {k} }}
            restitution = 0.5
            dissipation = "lankarani-nikravesh"
            friction = {{ coefficient = {mu}, slip_speed = 5e-5 }}
            [run]
            until = {until}
            every = {every}
            method = "generalized-alpha"
            step = 1e-6
            "#,
            d = 2.0 * radius,
            f = rate / TAU,
            quarter = 0.5 * PI,
            speed = rate * reach,
            until = angle / rate,
            every = angle / rate / 200.0,
        ));
        let scene = format!("gravity = [0, 0]\nsettle = false\n{scene}");
        let (mut lost, mut sum, mut count) = (0.0, 0.0, 0.0);
        run(&scene, |sample| {
            lost = sample.energy.flow(Flow::ArticulationLoss);
            sum += sample.joint_force[0];
            count += 1.0;
        });
        // Two joints, and the tension that the run really had.
        let expected = 2.0 * work * (sum / count) / tension;
        let tolerance = Relative(case.number("tolerance.relative"));
        let quantity = "work of two articulations at the tension of the run";
        case.judge(quantity, "J", lost, expected, tolerance);
        assert!((sum / count / tension - 1.0).abs() < 0.05);
    }
}

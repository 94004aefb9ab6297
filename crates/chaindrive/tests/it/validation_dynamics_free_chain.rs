//! Chains in free flight and in free fall (validation cases E01, E04, E06).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;

use std::f64::consts::{PI, TAU};

use chaindrive::Observation;
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::Absolute;
use dynamics::{energy, pairs, run, slope};

/// The closed chain of case E04, stepped by `stepping`.
fn twelve_springs(case: &Case, until: f64, every: f64, stepping: &str) -> String {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (n, p, s) = (input("N"), input("pitch"), input("s"));
    let radius = p / (2.0 * (PI / n).sin());
    let angles: Vec<f64> = (0..12).map(|i| TAU * f64::from(i) / n).collect();
    let place = |t: &f64| {
        [
            radius * (1.0 + 0.05 * (2.0 * t).cos()) * t.cos(),
            radius * (1.0 - 0.03 * (3.0 * t).sin()) * t.sin(),
        ]
    };
    let velocity = |t: &f64| [0.4 + s * (2.0 * t).sin(), -0.2 + s * (3.0 * t).cos()];
    format!(
        r#"
        gravity = [0, 0]
        settle = false
        [chain]
        pitch = {p}
        links = {n}
        mass = {m}
        stiffness = {k}
        damping = 0
        [chain.start]
        kind = "points"
        positions = {positions}
        velocities = {velocities}
        [run]
        until = {until}
        every = {every}
        {stepping}
        "#,
        m = input("m"),
        k = input("k"),
        positions = pairs(angles.iter().map(place)),
        velocities = pairs(angles.iter().map(velocity)),
    )
}

/// Momentum (x, y) and angular momentum, and the sums of the magnitudes of their parts.
fn momenta(mass: f64, at: &Observation) -> ([f64; 3], [f64; 2]) {
    let mut sums = ([0.0; 3], [0.0; 2]);
    for i in 0..at.roller_x.len() {
        let (x, y) = (at.roller_x[i], at.roller_y[i]);
        let (vx, vy) = (at.roller_vx[i], at.roller_vy[i]);
        let part = [mass * vx, mass * vy, mass * (x * vy - y * vx)];
        (0..3).for_each(|k| sums.0[k] += part[k]);
        sums.1[0] += mass * vx.hypot(vy);
        sums.1[1] += mass * x.hypot(y) * vx.hypot(vy);
    }
    sums
}

#[test]
fn e04_a_closed_chain_of_springs_in_free_flight() {
    let case = Case::read("E04");
    let mass = case.number("inputs.m");
    let end = case.number("inputs.T");
    let scene = twelve_springs(&case, end, 1e-3, "method = 'rk4'\nstep = 1e-6");
    let mut first = None;
    let (mut drift, mut last) = ([0.0_f64; 2], Observation::default());
    run(&scene, |sample| {
        let (now, size) = momenta(mass, sample);
        let (begin, _) = *first.get_or_insert((now, size));
        let linear = (now[0] - begin[0]).hypot(now[1] - begin[1]) / size[0];
        drift[0] = drift[0].max(linear);
        drift[1] = drift[1].max((now[2] - begin[2]).abs() / size[1]);
        last.clone_from(sample);
    });
    let (begin, _) = first.expect("there are samples");
    let judge = |quantity: &str, unit: &str, found, expected, tolerance: f64| {
        case.judge(quantity, unit, found, expected, Absolute(tolerance));
    };
    let momentum = case.list("expected.momentum");
    judge("momentum along x", "kg m/s", begin[0], momentum[0], 1e-11);
    judge("momentum along y", "kg m/s", begin[1], momentum[1], 1e-11);
    let angular = case.number("expected.angular_momentum");
    judge("angular momentum", "kg m²/s", begin[2], angular, 1e-14);
    let expected = case.number("expected.energy");
    judge("energy", "J", energy(&last), expected, 1e-9);
    let mut error: f64 = 0.0;
    for (i, place) in case.table("expected.x_end").iter().enumerate() {
        error = error.max((last.roller_x[i] - place[0]).hypot(last.roller_y[i] - place[1]));
    }
    let allowed = case.number("tolerance.momentum");
    judge(
        "largest change of the momentum, relative",
        "",
        drift[0],
        0.0,
        allowed,
    );
    let name = "largest change of the angular momentum, relative";
    judge(name, "", drift[1], 0.0, allowed);
    let allowed = case.number("tolerance.position");
    judge(
        "largest distance of a roller from its place",
        "m",
        error,
        0.0,
        allowed,
    );
}

/// Largest energy error of case E04 for one step.
fn energy_error(case: &Case, method: &str, step: f64) -> f64 {
    // Without bounds on its error the adaptive method keeps to its longest step.
    let free = if method == "dormand-prince" {
        "tolerance = 1"
    } else {
        ""
    };
    let stepping = format!("method = '{method}'\nstep = {step}\n{free}");
    let scene = twelve_springs(case, case.number("inputs.T"), step, &stepping);
    let mut start = None;
    let mut worst: f64 = 0.0;
    run(&scene, |sample| {
        let begin = *start.get_or_insert(energy(sample));
        worst = worst.max((energy(sample) - begin).abs());
    });
    worst
}

#[test]
fn e06_energy_errors_shrink_as_the_order_says() {
    let (case, flight) = (Case::read("E06"), Case::read("E04"));
    let allowed = case.number("tolerance.slope");
    let order = |method: &str, key: &str| {
        let steps = case.list(&format!("inputs.steps [s].{key}"));
        let errors = steps.iter().map(|&step| {
            let error = energy_error(&flight, method, step);
            (step.log2(), error.log2())
        });
        slope(&errors.collect::<Vec<_>>())
    };
    for (method, key) in [("verlet", "verlet"), ("dormand-prince", "dormand_prince")] {
        let expected = case.number(&format!("expected.slope.{key}"));
        let quantity = format!("order of the energy error, {method}");
        case.judge(
            &quantity,
            "",
            order(method, key),
            expected,
            Absolute(allowed),
        );
    }
    // What swings back has the fourth order, what is lost for good the fifth: (ωh)⁶/72 of a mode's energy a step.
    let [swings, lost] = [0, 1].map(|i| case.number(&format!("expected.slope.rk4.{i}")));
    let between = Absolute(0.5 * (lost - swings) + allowed);
    let (found, middle) = (order("rk4", "rk4"), 0.5 * (swings + lost));
    case.judge("order of the energy error, rk4", "", found, middle, between);
}

/// Largest distance \[m\] of a roller of case E01 from its reference, up to a time.
fn fall(case: &Case, stiffness: f64, step: f64) -> f64 {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let scene = format!(
        r#"
        gravity = [0, {g}]
        settle = false
        [chain]
        pitch = {p}
        links = {n}
        mass = {m}
        stiffness = {stiffness}
        damping = 0
        ends = ["fixed", "free"]
        start = {{ kind = "line", from = [0, 0], to = [{length}, 0] }}
        [run]
        until = {until}
        every = 0.05
        method = "rk4"
        step = {step}
        "#,
        g = -input("g"),
        p = input("pitch"),
        n = input("N"),
        m = input("m"),
        length = input("N") * input("pitch"),
        until = case.number("tolerance.until"),
    );
    let times = case.list("expected.t");
    let (x, y) = (case.table("expected.x"), case.table("expected.y"));
    let mut worst: f64 = 0.0;
    let mut judged = 0;
    run(&scene, |sample| {
        let Some(k) = times.iter().position(|t| (t - sample.time).abs() < 1e-9) else {
            return;
        };
        judged += 1;
        for i in 0..x[k].len() {
            let (dx, dy) = (
                sample.roller_x[i + 1] - x[k][i],
                sample.roller_y[i + 1] - y[k][i],
            );
            worst = worst.max(dx.hypot(dy));
        }
    });
    assert_eq!(judged, 3);
    worst
}

/// Spring links err by T/k: ten times the stiffness, a tenth of the error.
#[test]
fn e01_hinged_point_masses_let_go_from_the_horizontal() {
    let case = Case::read("E01");
    let (soft, stiff) = (fall(&case, 1e8, 4e-6), fall(&case, 1e9, 1.2e-6));
    println!("E01: {soft:.1e} m at 1e8 N/m, {stiff:.1e} m at 1e9 N/m");
    assert!((5.0..20.0).contains(&(soft / stiff)), "{}", soft / stiff);
    let tolerance = Absolute(case.number("tolerance.position"));
    let quantity = "largest distance of a pin from its place, spring links";
    case.judge(quantity, "m", stiff, 0.0, tolerance);
}

/// The ring of case E04 for many Verlet steps: the energy error stays within the bound of the
/// first thousandth, and does not grow.
fn long_flight(steps: u32) {
    let case = Case::read("E04");
    let step = 5e-6;
    let until = step * f64::from(steps);
    // A sample every few hundred steps, never in time with them.
    let every = 337.0 * step;
    let stepping = format!("method = 'verlet'\nstep = {step}");
    let scene = twelve_springs(&case, until, every, &stepping);
    let mut errors = Vec::new();
    let mut start = None;
    run(&scene, |sample| {
        let begin = *start.get_or_insert(energy(sample));
        errors.push((sample.time / until, energy(sample) / begin - 1.0));
    });
    let drift = slope(&errors);
    let worst = |from: f64, to: f64| {
        let errors = errors.iter().filter(|(t, _)| (from..to).contains(t));
        errors.map(|(_, error)| error.abs()).fold(0.0, f64::max)
    };
    let (early, late) = (worst(0.0, 0.1), worst(0.9, 1.1));
    println!("{steps} steps: largest error {early:.1e} early, {late:.1e} late; drift {drift:.1e}");
    assert!(late < 1.5 * early, "{late} after {early}");
    assert!(drift.abs() < 0.1 * early, "{drift}");
}

#[test]
fn a_ring_keeps_its_energy_for_a_hundred_thousand_steps() {
    long_flight(100_000);
}

/// `cargo test --release -p chaindrive --test it -- --ignored validation_dynamics_free_chain`
#[test]
#[ignore = "ten million steps"]
fn a_ring_keeps_its_energy_for_ten_million_steps() {
    long_flight(10_000_000);
}

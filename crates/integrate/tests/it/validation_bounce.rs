//! A lossless bouncing mass keeps its height (validation case E07).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::problems;

use chaindrive_integrate::{Method, State, Stepper};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use problems::bounce::Bounce;

/// One row of the reference: inputs and expectations.
struct Row {
    stiffness: f64,
    exponent: f64,
    mass: f64,
    height: f64,
    impact_speed: f64,
    first_contact: f64,
    contact_time: f64,
    penetration: f64,
    second_contact: f64,
}

fn rows(case: &Case) -> Vec<Row> {
    let (inputs, expected) = (case.table("inputs.rows"), case.table("expected.rows"));
    let rows = inputs.iter().zip(&expected);
    rows.map(|(i, e)| Row {
        stiffness: i[0],
        exponent: i[1],
        mass: i[2],
        height: i[3],
        impact_speed: e[0],
        first_contact: e[1],
        contact_time: e[2],
        penetration: e[3],
        second_contact: e[4],
    })
    .collect()
}

/// Result of a run of many bounces.
struct Found {
    /// Times \[s\] the surface was passed, downwards and upwards in turn.
    passages: Vec<f64>,
    deepest: f64,
    apex_error: f64,
    evaluations: u64,
    onset_error: f64,
}

/// Time \[s\] of zero gap within the last step, by bisection of the interpolated motion.
fn passage(state: &State) -> f64 {
    let (mut from, mut to) = state.interval();
    let (mut q, mut v) = ([0.0], [0.0]);
    state.at(from, &mut q, &mut v);
    let sign = q[0].signum();
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        state.at(middle, &mut q, &mut v);
        if q[0] * sign > 0.0 {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

fn bounce(row: &Row, method: Method, tolerance: f64, bounces: usize) -> Found {
    let mut system = Bounce::new(row.stiffness, row.exponent, row.mass);
    system.tolerance = tolerance;
    let mut state = State::new(0.0, vec![row.height], vec![0.0]);
    let mut stepper: Stepper<Bounce> = method.start(&mut system, &mut state).expect("starts");
    let (mut passages, mut deepest) = (Vec::new(), 0.0_f64);
    let mut inside = false;
    // To the apex after the last bounce.
    while passages.len() < 2 * bounces || state.v[0] > 0.0 {
        stepper.advance(&mut system, &mut state).expect("advances");
        if (state.q[0] < 0.0) != inside {
            inside = !inside;
            passages.push(passage(&state));
        }
        if inside {
            deepest = deepest.max(-state.q[0]);
        }
    }
    Found {
        passages,
        deepest,
        apex_error: system.apex(state.q[0], state.v[0]) / row.height - 1.0,
        evaluations: stepper.statistics().evaluations,
        onset_error: system.onsets[0] / row.impact_speed - 1.0,
    }
}

fn judge_times(case: &Case, method: &str, row: &Row, found: &Found) {
    let tolerance = Relative(case.number("tolerance.times"));
    let p = &found.passages;
    for (name, got, expected) in [
        ("first contact", p[0], row.first_contact),
        ("contact time", p[1] - p[0], row.contact_time),
        ("second contact", p[2], row.second_contact),
    ] {
        let quantity = format!("{name}, {method}");
        case.judge(&quantity, "s", got, expected, tolerance);
    }
}

fn judge_apex(case: &Case, method: &str, found: &Found, tolerance: f64) {
    let quantity = format!("change of the height in 100 bounces, {method}");
    case.judge(&quantity, "", found.apex_error, 0.0, Absolute(tolerance));
}

fn report(name: &str, row: &Row, found: &Found) {
    println!(
        "{name}, n = {}: apex {:.1e}, onset {:.1e}, {} evaluations",
        row.exponent, found.apex_error, found.onset_error, found.evaluations
    );
}

/// Fixed steps of a 270th of the contact, no rejection.
#[test]
fn height_after_a_hundred_bounces_with_fixed_steps() {
    let case = Case::read("E07");
    let row = &rows(&case)[0];
    let method = Method::Rk4 { step: 1e-6 };
    let found = bounce(row, method, f64::INFINITY, 100);
    report("Runge-Kutta 4", row, &found);
    let name = "Runge-Kutta of order 4";
    let apex = case.number("tolerance.apex_after_100_bounces");
    judge_apex(&case, name, &found, apex);
    let speed = row.impact_speed * (1.0 + found.onset_error);
    let quantity = format!("impact speed, {name}");
    case.judge(&quantity, "m/s", speed, row.impact_speed, Relative(1e-7));
    let quantity = format!("penetration, {name}");
    let depth = found.deepest;
    case.judge(&quantity, "m", depth, row.penetration, Relative(1e-5));
    judge_times(&case, name, row, &found);
}

/// Error control and rejected first penetrations: the same for all rows at a fraction of the cost.
#[test]
fn height_after_a_hundred_bounces_with_error_control() {
    let case = Case::read("E07");
    for row in rows(&case) {
        let method = Method::DormandPrince {
            relative: 0.0,
            absolute: 1e-9 * row.penetration,
            absolute_rate: 1e-11 * row.impact_speed,
            max_step: 1e-3,
        };
        let found = bounce(&row, method, 1e-3 * row.penetration, 100);
        report("Dormand-Prince", &row, &found);
        let name = "error control";
        let apex = case.number("tolerance.apex_after_100_bounces");
        judge_apex(&case, name, &found, apex);
        judge_times(&case, name, &row, &found);
    }
}

/// Verlet loses nothing either: it conserves a neighbouring energy.
#[test]
fn height_after_a_hundred_bounces_with_verlet() {
    let case = Case::read("E07");
    let row = &rows(&case)[0];
    let found = bounce(row, Method::Verlet { step: 2e-6 }, f64::INFINITY, 100);
    report("Verlet", row, &found);
    judge_apex(&case, "Verlet", &found, 1e-3);
}

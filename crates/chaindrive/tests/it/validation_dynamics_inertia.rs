//! Tension from motion: running drives and loops that run along themselves (validation cases T04,
//! T05).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;

use std::f64::consts::{PI, TAU};

use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use dynamics::{mean, pairs, run};

/// Means of the running drive of case T04 over its last turn.
struct Running {
    slack: f64,
    tight: f64,
    torque: f64,
    thrust: f64,
}

/// Two wheels of `TEETH` teeth, `SPAN` pitches apart: a parallelogram without polygon action, and
/// with so many teeth that the spans are hardly shaken.
const TEETH: u32 = 48;
const SPAN: u32 = 16;

/// A drive at chain speed `v`, its second wheel on a slide that is pushed outward by `push`.
fn running(pitch: f64, line_mass: f64, v: f64, push: f64, torque: f64) -> Running {
    let turn = f64::from(2 * SPAN + TEETH) * pitch / v;
    let speed = TAU * v / (f64::from(TEETH) * pitch);
    let mass = line_mass * pitch;
    // A tension of 2.5 mu v² stretches the links by half a thousandth.
    let stiffness = 5e3 * line_mass * v * v / pitch;
    let slider = 100.0 * mass;
    let damping = (2.0 * stiffness / f64::from(SPAN) * slider).sqrt();
    // Slow against the passing of the teeth, and well damped.
    let radius = pitch / (2.0 * (PI / f64::from(TEETH)).sin());
    let inertia = 100.0 * mass * radius * radius;
    let damper = inertia * v / pitch;
    let scene = format!(
        r#"
        gravity = [0, 0]
        [chain]
        pitch = {pitch}
        links = {links}
        mass = {mass}
        stiffness = {stiffness}
        damping_ratio = 0.1
        roller_diameter = {roller}
        [[sprockets]]
        name = "driver"
        teeth = {TEETH}
        centre = [0, 0]
        motion = {{ kind = "ramp", from = 0, to = {speed}, duration = {ramp} }}
        [[sprockets]]
        name = "driven"
        teeth = {TEETH}
        centre = [{distance}, 0]
        inertia = {inertia}
        mass = {slider}
        # A dynamometer: it damps the rotation about the speed it is set to.
        drive = [{{ kind = "ramp", torque = {setting}, duration = {ramp} }}]
        load = [{{ kind = "constant", torque = {load} }}, {{ kind = "resistance", linear = {damper} }}]
        support = {{ kind = "tensioner", name = "slide" }}
        [[tensioners]]
        name = "slide"
        carrier = {{ kind = "slider", direction = [1, 0], mass = {slider} }}
        push = {{ kind = "spring", preload = {push}, damping = {damping} }}
        [route]
        pretension = {pretension}
        [run]
        until = {until}
        every = {every}
        "#,
        links = 2 * SPAN + TEETH,
        roller = 0.6 * pitch,
        ramp = 2.0 * turn,
        distance = f64::from(SPAN) * pitch,
        setting = damper * speed,
        load = -torque,
        pretension = 0.5 * push,
        until = 7.0 * turn,
        every = turn / 10000.0,
    );
    let mut seen: [Vec<f64>; 4] = Default::default();
    run(&scene, |sample| {
        if sample.time > 4.0 * turn {
            let values = [
                sample.span_tension[0],
                sample.span_tension[1],
                sample.sprocket_torque[1],
                -sample.sprocket_force_x[1],
            ];
            seen.iter_mut().zip(values).for_each(|(s, x)| s.push(x));
        }
    });
    let [slack, tight, torque, thrust] = seen.map(|values| mean(&values));
    Running {
        slack,
        tight,
        torque,
        thrust,
    }
}

/// Drives of all rows are one drive on other scales.
#[test]
fn t04_centrifugal_tension_of_a_running_drive() {
    centrifugal_tension(1);
}

#[test]
#[ignore = "a study: every row of the case"]
fn t04_centrifugal_tension_at_every_scale() {
    centrifugal_tension(usize::MAX);
}

/// Judges the first rows of case T04.
fn centrifugal_tension(rows: usize) {
    let case = Case::read("T04");
    let allowed = case.number("tolerance.relative");
    let inputs = case.table("inputs.rows");
    let judged = inputs.iter().zip(case.table("expected.rows")).take(rows);
    for (input, expected) in judged {
        let (line_mass, v, extra) = (input[0], input[1], expected[0]);
        // The pitch of a chain of about this mass.
        let pitch = match line_mass {
            m if m < 0.5 => 0.009_525,
            m if m < 1.0 => 0.0127,
            m if m < 10.0 => 0.019_05,
            _ => 0.0889,
        };
        // The chain pulls as a string at the radius z p/2π that its speed is reckoned with.
        let lever = f64::from(TEETH) * pitch / TAU;
        let (push, torque) = (3.0 * extra, extra * lever);
        let found = running(pitch, line_mass, v, push, torque);
        let tight = 0.5 * (push + torque / lever) + extra;
        let slack = 0.5 * (push - torque / lever) + extra;
        let judge = |quantity: &str, unit: &str, found, expected| {
            case.judge(quantity, unit, found, expected, Relative(allowed));
        };
        judge("tension of the tight span", "N", found.tight, tight);
        judge("tension of the slack span", "N", found.slack, slack);
        let centrifugal = 0.5 * (found.tight + found.slack - found.thrust);
        judge("centrifugal tension", "N", centrifugal, extra);
        let pull = lever * (found.tight - found.slack);
        judge("torque against the pull", "N m", found.torque, pull);
    }
}

/// Parameters of `count` points on the ellipse (2b cos t, b sin t) with chords of `pitch`, and by
/// how much the last chord passes the first point.
fn chords(b: f64, count: u32, pitch: f64) -> (Vec<f64>, f64) {
    let place = |t: f64| [2.0 * b * t.cos(), b * t.sin()];
    let mut at = 0.0;
    let mut parameters = vec![at];
    for _ in 0..count {
        let from = place(at);
        let chord = |t: f64| (place(t)[0] - from[0]).hypot(place(t)[1] - from[1]) - pitch;
        let (mut low, mut high) = (at, at + 2.0 * pitch / b);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if chord(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        at = 0.5 * (low + high);
        parameters.push(at);
    }
    let last = parameters.pop().unwrap_or_default();
    (parameters, last - TAU)
}

/// Distance of a point from the ellipse (2b cos t, b sin t).
fn off_ellipse(b: f64, x: f64, y: f64) -> f64 {
    let distance = |t: f64| (2.0 * b * t.cos() - x).hypot(b * t.sin() - y);
    let mut at = (2.0 * y).atan2(x);
    let mut step = 0.05;
    while step > 1e-9 {
        let best = [-step, 0.0, step].map(|s| at + s);
        let nearest = best
            .into_iter()
            .min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        let moved = nearest.unwrap_or(at);
        if (moved - at).abs() < 0.5 * step {
            step *= 0.5;
        }
        at = moved;
    }
    distance(at)
}

#[test]
fn t05_an_elliptic_loop_runs_along_itself() {
    let case = Case::read("T05");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (n, pitch, v) = (120, input("pitch"), input("v0"));
    let (mut low, mut high) = (0.05, 0.5);
    for _ in 0..80 {
        let b = 0.5 * (low + high);
        // A wider ellipse takes more chords.
        if chords(b, n, pitch).1 > 0.0 {
            low = b;
        } else {
            high = b;
        }
    }
    let b = 0.5 * (low + high);
    let (parameters, _) = chords(b, n, pitch);
    let expected = case.number("expected.tension");
    let stiffness = 1e6;
    let tangent = |t: &f64| {
        let (x, y) = (-2.0 * t.sin(), t.cos());
        [v * x / x.hypot(y), v * y / x.hypot(y)]
    };
    let turn = f64::from(n) * pitch / v;
    let scene = format!(
        r#"
        gravity = [0, 0]
        settle = false
        [chain]
        pitch = {pitch}
        inner_pitch = {rest}
        outer_pitch = {rest}
        links = {n}
        mass = {m}
        stiffness = {stiffness}
        damping = 0
        [chain.start]
        kind = "points"
        positions = {positions}
        velocities = {velocities}
        [run]
        until = {until}
        every = {every}
        "#,
        // Stretched to one pitch by the tension it runs at.
        rest = pitch - expected / stiffness,
        m = input("m"),
        positions = pairs(parameters.iter().map(|t| [2.0 * b * t.cos(), b * t.sin()])),
        velocities = pairs(parameters.iter().map(tangent)),
        until = turn,
        every = turn / 2000.0,
    );
    let mut tensions = Vec::new();
    let (mut half, mut whole) = (0.0_f64, 0.0_f64);
    run(&scene, |sample| {
        tensions.push(mean(&sample.link_tension));
        let off = sample.roller_x.iter().zip(&sample.roller_y);
        let off = off.map(|(x, y)| off_ellipse(b, *x, *y)).fold(0.0, f64::max);
        whole = whole.max(off / b);
        if sample.time < 0.5 * turn {
            half = half.max(off / b);
        }
    });
    println!("T05: shape {half:.1e} b after half a turn, {whole:.1e} b after one");
    let tolerance = Relative(case.number("tolerance.tension"));
    case.judge("mean tension", "N", mean(&tensions), expected, tolerance);
    let tolerance = Absolute(case.number("tolerance.shape"));
    let quantity = "largest distance of a pin from the ellipse in half a turn";
    case.judge(quantity, "b", half, 0.0, tolerance);
}

//! Rollers that fall on guides (validation cases E07, I07).

use crate::dynamics;

use std::f64::consts::PI;

use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use dynamics::{energy, start};

/// Two rollers on one link, a height above a bar, on which they bounce without loss.
fn bouncing(gravity: f64, row: &[f64], run: &str) -> String {
    let [stiffness, exponent, mass, height] = row[..] else {
        panic!("four inputs")
    };
    format!(
        r#"
        gravity = [0, {gravity}]
        settle = false
        [chain]
        pitch = 0.1
        links = 1
        mass = {mass}
        stiffness = 100
        damping = 0
        roller_diameter = 0.01
        ends = ["free", "free"]
        start = {{ kind = "line", from = [0, {y}], to = [0.1, {y}] }}
        [contact.guides]
        law = {{ kind = "power", stiffness = {stiffness}, exponent = {exponent} }}
        damping = 0
        [[guides]]
        name = "floor"
        face = {{ kind = "bar", start = [-0.5, 0], end = [0.5, 0] }}
        [run]
        {run}
        "#,
        gravity = -gravity,
        y = 0.005 + height,
    )
}

#[test]
fn e07_a_link_bounces_without_loss() {
    let case = Case::read("E07");
    let gravity = case.number("inputs.g");
    let rows = case.table("inputs.rows");
    for (row, expected) in rows.iter().zip(case.table("expected.rows")) {
        let [_, first, contact, deepest, second] = expected[..] else {
            panic!("five results")
        };
        let period = second - first;
        let stepping = "method = 'dormand-prince'\ntolerance = 1e-13\nonset_depth = '1 nm'";

        // Passages of the surface, around the first bounce and the next touch.
        let until = 1.02 * second;
        let text = bouncing(
            gravity,
            row,
            &format!("until = {until}\nevery = {until}\nstep = 1e-3\n{stepping}"),
        );
        let mut simulation = start(&text);
        let (mut passages, mut depth) = (Vec::new(), 0.0_f64);
        let at_first = simulation.advance_to(0.0).expect("it hangs").energy;
        let fallen = row[2] * gravity * row[3];
        for (begin, parts) in [(first, 240), (second, 40)] {
            let mut before = (0.0, row[3], 0.0);
            for part in -20..=parts {
                let time = begin + contact * f64::from(part) / 200.0;
                let sample = simulation.advance_to(time).expect("it flies");
                let at = (sample.time, sample.roller_y[0] - 0.005, sample.roller_vy[0]);
                depth = depth.max(-at.1);
                if part > -20 && (at.1 < 0.0) != (before.1 < 0.0) {
                    passages.push(touch(before, at));
                }
                before = at;
                assert!((sample.roller_y[1] - sample.roller_y[0]).abs() < 1e-12);
                let open = sample.energy.residual(&at_first);
                assert!(open.abs() < 0.01 * fallen, "{open} of {fallen} J");
            }
        }
        let times = [
            passages[0] - first,
            passages[1] - passages[0] - contact,
            passages[2] - second,
        ];
        let tolerance = Absolute(case.number("tolerance.times"));
        let name = "errors of the times of contact, a link on a bar";
        case.judge_each(name, "s", &times, &[0.0; 3], tolerance);
        let name = "penetration, a link on a bar";
        case.judge(name, "m", depth, deepest, Relative(1e-4));

        // The energy after a hundred bounces is that of the apex.
        let until = first + 99.5 * period;
        let text = bouncing(
            gravity,
            row,
            &format!("until = {until}\nevery = {until}\nstep = 1e-3\n{stepping}"),
        );
        let mut simulation = start(&text);
        let mut apex = [0.0; 2];
        for apex in &mut apex {
            let sample = simulation
                .next_sample()
                .expect("it runs")
                .expect("two samples");
            let (y, v) = (sample.roller_y[0] - 0.005, sample.roller_vy[0]);
            *apex = y + 0.5 * v * v / gravity;
        }
        let error = apex[1] / apex[0] - 1.0;
        let tolerance = Absolute(case.number("tolerance.apex_after_100_bounces"));
        let name = "change of the height in 100 bounces, a link on a bar";
        case.judge(name, "", error, 0.0, tolerance);
    }
}

/// Time of zero gap between two samples (time, gap, speed), on the cubic through them.
fn touch(a: (f64, f64, f64), b: (f64, f64, f64)) -> f64 {
    let h = b.0 - a.0;
    let gap = |s: f64| {
        let (s2, s3) = (s * s, s * s * s);
        (2.0 * s3 - 3.0 * s2 + 1.0) * a.1
            + (s3 - 2.0 * s2 + s) * h * a.2
            + (3.0 * s2 - 2.0 * s3) * b.1
            + (s3 - s2) * h * b.2
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (gap(middle) < 0.0) == (a.1 < 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    a.0 + 0.5 * (low + high) * h
}

/// A hinged link is a point of mass m_eff at the end of a massless one; the contact delivers the
/// restitution that it is measured to have.
#[test]
fn i07_a_hinged_link_falls_on_a_seat() {
    let case = Case::read("I07");
    let rows = case.table("inputs.rows");
    let allowed = case.number("tolerance.relative");
    for (row, expected) in rows.iter().zip(case.table("expected.rows")) {
        let [_, _, pitch, v, e] = row[..] else {
            panic!("five inputs")
        };
        let [mass, impulse, loss] = expected[..] else {
            panic!("three results")
        };
        let stiffness = mass * (v / (1e-5 * pitch)).powi(2);
        let radius = 0.3 * pitch;
        let contact = PI * (mass / stiffness).sqrt();
        let text = format!(
            r#"
            gravity = [0, 0]
            settle = false
            [chain]
            pitch = {pitch}
            links = 1
            masses = [{mass}, {mass}]
            stiffness = {stiffness}
            damping = 0
            roller_diameter = {diameter}
            ends = ["fixed", "free"]
            [chain.start]
            kind = "points"
            positions = [[0, {gap}], [{pitch}, {gap}]]
            velocities = [[0, 0], [0, {down}]]
            [contact.guides]
            law = {{ kind = "linear", stiffness = {stiffness} }}
            {dissipation}
            [[guides]]
            name = "seat"
            face = {{ kind = "bar", start = [{from}, {below}], end = [{to}, {below}] }}
            [run]
            until = {until}
            every = {until}
            method = "rk4"
            step = {step}
            "#,
            diameter = 2.0 * radius,
            gap = 0.1 * contact * v,
            down = -v,
            below = -radius,
            from = 0.8 * pitch,
            to = 1.2 * pitch,
            until = 60.0 * contact,
            step = contact / 500.0,
            dissipation = dissipation(e, mass, stiffness),
        );
        let mut simulation = start(&text);
        let mut seen = Vec::new();
        while let Some(sample) = simulation.next_sample().expect("it runs") {
            let speed = sample.roller_vx[1].hypot(sample.roller_vy[1]);
            seen.push((speed * sample.roller_vy[1].signum(), energy(sample)));
        }
        let found = mass * (seen[1].0 - seen[0].0);
        case.judge("impulse", "N s", found, impulse, Relative(allowed));
        let found = seen[0].1 - seen[1].1;
        case.judge("energy lost", "J", found, loss, Relative(allowed));
    }
}

/// Damping of a contact with a linear stiffness that returns e.
///
/// A viscous damper would pull before the surfaces part, where its force is cut off:
///
/// ```text
/// e = exp(−ζ/√(1 − ζ²) (π − atan(2ζ√(1 − ζ²)/(1 − 2ζ²))))
/// ```
///
/// T. Schwager and T. Pöschel, *Granular Matter* **9**, 2007, 465–469. A ratio of 20 returns less
/// than a thousandth.
fn dissipation(e: f64, mass: f64, stiffness: f64) -> String {
    let returned = |ratio: f64| {
        let root = (1.0 - ratio * ratio).sqrt();
        let angle = (2.0 * ratio * root).atan2(1.0 - 2.0 * ratio * ratio);
        (-ratio / root * (PI - angle)).exp()
    };
    let (mut low, mut high) = (0.0, 0.99);
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if returned(middle) > e {
            low = middle;
        } else {
            high = middle;
        }
    }
    let ratio = if e > 0.0 { low } else { 20.0 };
    format!("damping = {}", 2.0 * ratio * (mass * stiffness).sqrt())
}

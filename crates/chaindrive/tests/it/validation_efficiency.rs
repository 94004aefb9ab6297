//! Losses of a drive whose joints rub (validation case F02).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;
use crate::reference;

use chaindrive::Flow;
use dynamics::run;
use reference::Reference;

#[test]
fn f02_friction_of_the_joints() {
    let case = Reference::read("F02");
    for row in case.table("expected.rows") {
        let [z1, z2, p, r, mu, tight, slack, _] = row[..] else {
            panic!("eight columns")
        };
        let radius = |z: f64| 0.5 * p / (std::f64::consts::PI / z).sin();
        // Equal wheels: the strands are as long as the centres are apart; links in an even number.
        let span = if z1 % 2.0 > 0.5 { 14.5 } else { 14.0 };
        let centres = span * p;
        let links = 2.0 * span + z1;
        let speed = 20.0;
        let scene = format!(
            r#"
            gravity = [0, 0]
            [chain]
            model = "clearance-joints"
            pitch = {p}
            links = {links}
            roller_diameter = 0.00851
            joint = {{ pin_diameter = {d}, clearance = 5e-6, length = 0.009 }}
            roller = {{ mass = 1.4e-3, length = 0.0078 }}
            inner = {{ mass = 6.6e-3, inertia = 3.5e-7 }}
            outer = {{ mass = 8.1e-3, inertia = 3.8e-7 }}
            [contact.joints]
            friction = {{ coefficient = {mu}, slip_speed = 2e-4 }}
            [[sprockets]]
            name = "driver"
            teeth = {z1}
            centre = [0, 0]
            motion = {{ kind = "constant", speed = -{speed} }}
            [[sprockets]]
            name = "driven"
            teeth = {z2}
            centre = [-{centres}, 0]
            inertia = 0.01
            load = [{{ kind = "constant", torque = {torque} }}]
            [route]
            pretension = {pretension}
            [run]
            until = 0.06
            every = 1e-4
            step = 4e-7
            "#,
            d = 2.0 * r,
            torque = (tight - slack) * radius(z2),
            pretension = 0.5 * (tight + slack),
        );
        let (mut start, mut end, mut sums) = (None, (0.0, 0.0), [0.0; 3]);
        run(&scene, |sample| {
            if sample.time < 0.02 {
                return;
            }
            let lost = sample.energy.flow(Flow::FrictionLoss);
            start.get_or_insert((sample.time, lost));
            end = (sample.time, lost);
            sums[0] += sample.span_tension[0];
            sums[1] += sample.span_tension[1];
            sums[2] += 1.0;
        });
        let start = start.expect("the run goes on past its start");
        let tensions = [sums[0] / sums[2], sums[1] / sums[2]];
        // W per pitch = 2π r sin(atan μ) (1/z1 + 1/z2) (Tt + Ts), at v/p pitches a second
        let pitches = speed * z1 / std::f64::consts::TAU * (end.0 - start.0);
        let expected = std::f64::consts::TAU
            * r
            * mu.atan().sin()
            * (1.0 / z1 + 1.0 / z2)
            * (tensions[0] + tensions[1])
            * pitches;
        let found = end.1 - start.1;
        let error = found / expected - 1.0;
        println!(
            "F02: {z1}/{z2}, {tensions:.0?} N: {found:.4} J against {expected:.4}: {error:+.3}"
        );
        assert!(
            error.abs() < case.number("tolerance.relative"),
            "{row:?}: {error}"
        );
    }
}

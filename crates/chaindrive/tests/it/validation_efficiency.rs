//! Losses of a drive whose joints rub (validation case F02).

use crate::dynamics;

use chaindrive::Flow;
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::Relative;
use dynamics::run;

/// The chain of F02 in a model, with the diameter of its pins \[m\] and a coefficient of friction.
fn chain(model: &str, [links, pitch]: [f64; 2], pin: f64, friction: f64) -> String {
    let rigid = "
        roller = { mass = 1.4e-3, length = 0.0078 }
        inner = { mass = 6.6e-3, inertia = 3.5e-7 }
        outer = { mass = 8.1e-3, inertia = 3.8e-7 }";
    let (rest, joint, law) = match model {
        "clearance-joints" => (
            rigid,
            ", clearance = 5e-6, length = 0.009",
            "slip_speed = 2e-4",
        ),
        "ideal-joints" => (rigid, "", "kind = \"spring-slider\", stiffness = 1e8"),
        _ => (
            "mass = 8.75e-3\nstiffness = 20e6",
            "",
            "kind = \"spring-slider\"",
        ),
    };
    // On harder teeth rigid links have nothing that gives way to the polygon of seventeen teeth, and pull ten times their pretension.
    let teeth = if model == "ideal-joints" {
        "[contact.teeth]
        law = { kind = \"linear\", stiffness = 1e8 }"
    } else {
        ""
    };
    format!(
        "[chain]
        model = \"{model}\"
        pitch = {pitch}
        links = {links}
        roller_diameter = 0.00851
        joint = {{ pin_diameter = {pin}{joint} }}
        {rest}
        {teeth}
        [contact.joints]
        friction = {{ coefficient = {friction}, {law} }}",
    )
}

/// The tensions are those of the run; the loss is that of the joints alone, in every chain model.
#[test]
fn f02_friction_of_the_joints() {
    joints_of("particles");
}

#[test]
#[ignore = "slow"]
fn f02_friction_of_the_joints_of_rigid_links() {
    for model in ["clearance-joints", "ideal-joints"] {
        joints_of(model);
    }
}

fn joints_of(model: &str) {
    let case = Case::read("F02");
    for row in case.table("expected.rows") {
        let [z1, z2, p, r, mu, tight, slack, _] = row[..] else {
            panic!("eight columns")
        };
        let radius = |z: f64| 0.5 * p / (std::f64::consts::PI / z).sin();
        // Equal wheels: the strands are as long as the centres are apart; links in an even number.
        let span = if z1 % 2.0 > 0.5 { 14.5 } else { 14.0 };
        let centres = span * p;
        let links = 2.0 * span + z1;
        // Slow: at 20 rad/s the strands swing, and pull 4 % more friction out of the joints than their mean tension.
        let speed = 4.0;
        let tooth = std::f64::consts::TAU / (z1 * speed);
        let scene = format!(
            r#"
            gravity = [0, 0]
            {chain}
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
            until = {until}
            every = 1e-4
            step = {step}
            "#,
            chain = chain(model, [links, p], 2.0 * r, mu),
            torque = (tight - slack) * radius(z2),
            pretension = 0.5 * (tight + slack),
            until = 3.0 * tooth,
            step = if model == "clearance-joints" {
                4e-7
            } else {
                1e-6
            },
        );
        let (mut start, mut end, mut sums) = (None, (0.0, 0.0), [0.0; 3]);
        run(&scene, |sample| {
            // Two teeth, after the first.
            if sample.time < tooth - 1e-9 {
                return;
            }
            let lost = sample.energy.flow(Flow::ArticulationLoss);
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
        let tolerance = Relative(case.number("tolerance.relative"));
        let quantity = format!("loss of the joints, {model}");
        case.judge(&quantity, "J", found, expected, tolerance);
    }
}

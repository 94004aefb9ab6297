//! Chains of thousands of links: they settle in as few steps as short ones, and where they sag to.

use chaindrive::{Assembled, Run, Scene, Simulation};

/// Two sprockets of forty teeth and so many links 16B-1 that pull with 1 kN before they weigh anything.
fn two_sprockets(links: usize) -> String {
    format!(
        r#"
        [chain]
        type = "16B-1"
        mass = "0.07 kg"
        stiffness = "160 MN/m"
        links = {links}
        [[sprockets]]
        name = "a"
        teeth = 40
        centre = ["0 m", "0 m"]
        motion = {{ kind = "constant", speed = "60 rpm" }}
        [[sprockets]]
        name = "b"
        teeth = 40
        centre = ["{} m", "0 m"]
        inertia = "1 kg m^2"
        load = [{{ kind = "constant", torque = "-100 N m" }}]
        [route]
        pretension = "1000 N"
        adjust = {{ kind = "sprocket", name = "b", direction = [1, 0], within = "20 mm" }}
        "#,
        apart(links) - 0.0005
    )
}

/// Distance of the sprockets \[m\].
fn apart(links: usize) -> f64 {
    (links as f64 - 40.0) * 0.0254 / 2.0
}

fn assembled(text: &str) -> Assembled {
    let scene = Scene::from_text(text, "scene.toml").expect("a scene");
    scene.drive().expect("a drive").assemble().expect("statics")
}

/// # Source
/// H. M. Irvine, *Cable Structures*, MIT Press, 1981, section 2.2: a flat parabola that stretches carries
/// T³ − T₀ T² = E A w² L²/24, less the share of the links that lie on sprockets and stretch as well.
#[test]
fn a_long_span_pulls_as_an_elastic_parabola() {
    for links in [500, 2000] {
        let drive = assembled(&two_sprockets(links));
        let gravity = drive.statics.iter().find(|it| it.stage == "gravity");
        let gravity = gravity.expect("the chain weighs something");
        let found = gravity.tensions.iter().sum::<f64>() / links as f64;
        let weight = 0.07 / 0.0254 * 9.80665 * apart(links);
        let in_spans = 1.0 - 40.0 / links as f64;
        let stretched = in_spans * 160e6 * 0.0254 * weight.powi(2) / 24.0;
        let mut between = [1e3_f64, 1e5];
        for _ in 0..60 {
            let middle = 0.5 * (between[0] + between[1]);
            let short = middle.powi(3) - 1000.0 * middle.powi(2) < stretched;
            between[usize::from(!short)] = middle;
        }
        let parabola = between[0];
        assert!(
            (found / parabola - 1.0).abs() < 0.005,
            "{links}: {found} N for {parabola}"
        );
    }
}

#[test]
fn a_chain_eight_times_as_long_takes_few_more_steps_to_settle() {
    let iterations = |links| {
        let drive = assembled(&two_sprockets(links));
        drive
            .statics
            .iter()
            .map(|it| it.iterations)
            .max()
            .expect("stages")
    };
    let [short, long] = [250, 2000].map(iterations);
    assert!(long < 4 * short, "{long} and {short}");
}

/// A conveyor whose empty run hangs 20 mm above its rail before it sags.
#[test]
fn a_chain_comes_to_rest_on_a_rail_far_below_it() {
    let drive = assembled(
        r#"
        [chain]
        type = "20B-1"
        mass = "0.45 kg"
        links = 204
        [[sprockets]]
        name = "drive"
        teeth = 16
        centre = ["0 m", "0 m"]
        motion = { kind = "constant", speed = "60 rpm" }
        [[sprockets]]
        name = "tail"
        teeth = 16
        centre = ["2.9814 m", "0 m"]
        mass = "12 kg"
        inertia = "0.1 kg m^2"
        support = { kind = "tensioner", name = "take-up" }
        [[tensioners]]
        name = "take-up"
        carrier = { kind = "slider", direction = [1, 0], mass = "10 kg" }
        push = { kind = "spring", preload = "3 kN", stiffness = "20 kN/m", damping = "4 kN s/m" }
        [[guides]]
        name = "rail"
        face = { kind = "bar", start = ["2.7 m", "0.0718 m"], end = ["0.3 m", "0.0718 m"], end_radius = "1 m", end_angle = "3 deg", material = "left" }
        [[guides]]
        name = "return"
        face = { kind = "bar", start = ["0.3 m", "-0.1108 m"], end = ["2.7 m", "-0.1108 m"], end_radius = "1 m", end_angle = "3 deg", material = "right" }
        [route]
        adjust = { kind = "slider", name = "take-up", within = "40 mm" }
        "#,
    );
    // A roller of 19.05 mm lies on the rail, pressed in by its weight of 4.4 N.
    let mut simulation = Simulation::from_assembled(drive, &Run::default()).expect("a simulation");
    let seen = simulation.next_sample().expect("a sample").expect("no end");
    let rollers = seen.roller_x.iter().zip(&seen.roller_y);
    let middle = rollers.filter(|(x, y)| **y < 0.0 && (**x - 1.5).abs() < 0.5);
    let heights: Vec<f64> = middle.map(|(_, y)| y + 0.1108 - 0.009_525).collect();
    assert!(heights.len() > 25);
    for height in heights {
        assert!(height.abs() < 2e-5, "{height} m above the rail");
    }
}

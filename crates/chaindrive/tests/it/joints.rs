//! Joints that resist, as scenes describe them: friction of every chain model, and what it does to a plucked strand.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::PI;

use chaindrive::{Channel, Flow, Run, Scene, Simulation};
use chaindrive_contact::Law;
use chaindrive_mechanics::{ChainModel, Joint, Observation, Surface};

use crate::dynamics::{self, pairs};

/// Links of the strand, its tension \[N\], and μ r with the pin of 56B-1 \[m\].
const LINKS: u32 = 31;
const TENSION: f64 = 30e3;
const LEVER: f64 = 0.1 * 0.5 * 0.034_32;

/// A strand of 56B-1 with soft links, plucked to the shape of its first mode.
fn strand(joint: &str) -> String {
    let (pitch, stiffness) = (0.0889, 2e6);
    let amplitude = 45.0 * LEVER;
    let place = |i: u32| {
        let share = f64::from(i) / f64::from(LINKS);
        [f64::from(i) * pitch, amplitude * (PI * share).sin()]
    };
    format!(
        r#"
        gravity = [0, 0]
        settle = false
        [chain]
        type = "56B-1"
        links = {LINKS}
        inner_pitch = {rest}
        outer_pitch = {rest}
        mass = 3
        stiffness = {stiffness}
        damping_ratio = 0
        ends = [{{ kind = "fixed" }}, {{ kind = "fixed" }}]
        {joint}
        [chain.start]
        kind = "points"
        positions = {positions}
        [run]
        until = {until}
        every = 2e-4
        step = 2e-5
        "#,
        rest = pitch - TENSION / stiffness,
        positions = pairs((0..=LINKS).map(place)),
        until = 4.3 * 2.0 * f64::from(LINKS) * (pitch * 3.0 / TENSION).sqrt(),
    )
}

/// Greatest amplitudes of the first mode, one a half cycle, and the loss in the joints \[J\].
fn swings(scene: &str) -> (Vec<f64>, f64) {
    let (mut peaks, mut last, mut lost) = (Vec::new(), [0.0_f64; 2], 0.0);
    dynamics::run(scene, |sample| {
        let parts = sample.roller_y.iter().enumerate();
        let sum: f64 = parts
            .map(|(i, y)| y * (PI * i as f64 / f64::from(LINKS)).sin())
            .sum();
        let now = 2.0 * sum / f64::from(LINKS);
        if last[1].abs() > last[0].abs() && last[1].abs() >= now.abs() {
            peaks.push(last[1].abs());
        }
        last = [last[1], now];
        lost = sample.energy.flow(Flow::ArticulationLoss);
    });
    (peaks, lost)
}

/// Friction takes 4.5 μ r a cycle from a strand, with the pin of the catalogue; without friction it swings on.
#[test]
fn a_plucked_strand_comes_to_rest() {
    let joint = r#"joint.contact.friction = { kind = "spring-slider", coefficient = 0.1, stiffness = "5 GN/m" }"#;
    let (peaks, lost) = swings(&strand(joint));
    let found = (peaks[2] - peaks[6]) / 2.0 / LEVER;
    assert!((found - 4.5).abs() < 0.25, "{found} μ r a cycle, {peaks:?}");
    assert!(lost > 10.0, "{lost} J");
    let (peaks, lost) = swings(&strand("joint.contact.friction = \"none\""));
    assert!(
        peaks[6] > 0.98 * peaks[0] && lost.abs() < 1e-9,
        "{peaks:?}, {lost} J"
    );
}

/// A scene with a chain of the catalogue around two sprockets.
fn drive(model: &str) -> Scene {
    let text = format!(
        r#"
        [chain]
        type = "16B-1"
        model = "{model}"
        [[sprockets]]
        name = "driver"
        teeth = 19
        centre = ["0 m", "0 m"]
        motion = {{ kind = "constant", speed = "300 rpm" }}
        [[sprockets]]
        name = "driven"
        teeth = 57
        centre = ["1.03 m", "0 m"]
        inertia = "1.5 kg m^2"
        load = [{{ kind = "constant", torque = "-1433 N m" }}]
        [run]
        until = "1 ms"
        "#
    );
    Scene::from_text(&text, "drive.toml").unwrap()
}

/// Where the catalogue knows the pin, joints rub: by the same keys in every model, each default with its reason.
#[test]
fn joints_of_the_catalogue_rub_in_every_model() {
    for model in ["particles", "ideal-joints", "clearance-joints"] {
        let resolved = drive(model).resolved().unwrap().text().to_owned();
        assert!(resolved.contains("spring-slider"), "{model}: {resolved}");
        assert!(
            resolved.contains("pin_diameter = 0.00828"),
            "{model}: {resolved}"
        );
        assert!(
            resolved.contains("boundary lubrication"),
            "{model}: {resolved}"
        );
        // What a contact resists across, or what leaves the steps of springs as they are.
        let held = if model == "clearance-joints" {
            "0.82 link stiffnesses"
        } else {
            "0.1 link stiffnesses times the pitch over the radius of the pin, squared"
        };
        assert!(resolved.contains(held), "{model}: {resolved}");
        assert!(
            resolved.contains("start = \"quiet\""),
            "{model}: {resolved}"
        );
    }
}

/// Keys that a pin needs are asked for, and those that only pins with clearance have are refused.
#[test]
fn joints_say_what_they_need() {
    let of_dimensions = r#"
        [chain]
        pitch = "25.4 mm"
        links = 120
        mass = "69 g"
        stiffness = "160 MN/m"
        roller_diameter = "15.88 mm"
        "#;
    let drive = drive("particles").text().to_owned();
    let bare = drive.replace(
        "[chain]\n        type = \"16B-1\"\n        model = \"particles\"",
        of_dimensions,
    );
    let wrong = |more: &str| {
        let scene = Scene::from_text(&format!("{bare}\n{more}"), "drive.toml").unwrap();
        scene.drive().unwrap_err().to_string()
    };
    let message = wrong("[contact.joints]\nfriction = { coefficient = 0.1 }");
    assert!(message.contains("chain.joint.pin_diameter"), "{message}");
    let message = wrong("[chain.joint]\nclearance = \"0.05 mm\"");
    assert!(message.contains("only pins with clearance"), "{message}");
    let message =
        wrong("[contact.teeth]\nfriction = { kind = \"spring-slider\", coefficient = 0.1 }");
    assert!(
        message.contains("contact.teeth.friction.stiffness"),
        "{message}"
    );
}

/// The surface of joints with play in them.
fn surface(scene: &Scene) -> Surface {
    let drive = scene.drive().unwrap();
    let ChainModel::Rigid(links) = &drive.chains[0].chain.model else {
        panic!("links with play are rigid");
    };
    match links.joint {
        Joint::Clearance(joint) => joint.surface,
        Joint::Ideal => panic!("they have play"),
    }
}

/// Stiffness \[N/m\] at a load.
fn under(law: &Law, load: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e-3);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if law.elastic_force(middle) < load {
            low = middle;
        } else {
            high = middle;
        }
    }
    law.stiffness(low)
}

/// Between its pins a link of 081 has the stiffness of the catalogue, 48 MN/m, plates and joint together, from 3 to 12 % of its
/// breaking load; where it bears little the joint gives more. Its joint alone has eleven times that, which is all that there is where plates are rigid.
#[test]
fn links_with_play_have_the_stiffness_of_the_catalogue() {
    let bicycle = Scene::preset("bicycle").unwrap();
    let law = surface(&bicycle).law;
    for load in [250.0, 500.0, 1000.0] {
        let stiffness = under(&law, load);
        assert!(
            (stiffness / 48e6 - 1.0).abs() < 0.02,
            "{load}: {stiffness:e}"
        );
    }
    let rigid = surface(&bicycle.replace("contact.joints.series", "0").unwrap()).law;
    assert_eq!(rigid.series, None);
    assert!(under(&rigid, 500.0) > 450e6);
}

/// Rigid links whose pins have no play, and yield as the catalogue says, are the particle chain but for their moments of inertia: the
/// spans have the same tension at rest, and in the mean of six teeth. Ideal joints, whose links do not yield, have hundreds of newtons more.
#[test]
fn joints_without_play_are_those_of_the_elastic_chain() {
    let bicycle = Scene::preset("bicycle").unwrap();
    let without_play = bicycle.replace("chain.joint.clearance", "\"0 mm\"");
    let without_play = without_play.unwrap();
    let particles = bicycle.replace("chain.model", "particles").unwrap();
    let spans = |scene: &Scene| {
        let run = Run {
            until: 0.15,
            every: 5e-5,
            ..Run::default()
        };
        let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
        let (mut at_rest, mut sums, mut samples) = (None, [0.0; 2], 0.0);
        while let Some(sample) = simulation.next_sample().unwrap() {
            at_rest.get_or_insert([sample.span_tension[0], sample.span_tension[1]]);
            // The last six teeth, of which 66 pass in a second.
            if sample.time > 0.15 - 6.0 / 66.0 {
                samples += 1.0;
                sums[0] += sample.span_tension[0];
                sums[1] += sample.span_tension[1];
            }
        }
        (at_rest.unwrap(), sums.map(|sum| sum / samples))
    };
    let (rest, mean) = spans(&without_play);
    let (as_rest, as_mean) = spans(&particles);
    for span in 0..2 {
        assert!(
            (rest[span] / as_rest[span] - 1.0).abs() < 0.01,
            "{rest:?} {as_rest:?}"
        );
        assert!(
            (mean[span] / as_mean[span] - 1.0).abs() < 0.01,
            "{mean:?} {as_mean:?}"
        );
    }
    let ChainModel::Rigid(links) = &without_play.drive().unwrap().chains[0].chain.model else {
        panic!("rigid links");
    };
    let Joint::Clearance(joint) = &links.joint else {
        panic!("pins that yield");
    };
    assert_eq!(
        (joint.gap(), under(&joint.surface.law, 60.0)),
        (0.0, 47.65e6)
    );
    let written_out = without_play.resolved().unwrap().drive().unwrap();
    assert_eq!(
        written_out.chains[0].chain,
        without_play.drive().unwrap().chains[0].chain
    );
}

/// A drive as statics leaves it.
fn at_rest(scene: &Scene) -> Observation {
    let run = Run {
        until: 1e-6,
        every: 1e-6,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    simulation.next_sample().unwrap().unwrap().clone()
}

/// Play lets a loaded chain walk around its sprockets before it holds, farther the harder it is pulled, up to loads above its breaking load: statics finds
/// the tight side that the torque asks for, and that of the same chain without play. Torque over pitch radius is the authority; a tenth covers the polygon,
/// the weight and the first teeth.
#[test]
fn chains_with_play_settle_under_any_load() {
    let bicycle = Scene::preset("bicycle").unwrap();
    let radius = 0.5 * 0.0127 / (PI / 18.0).sin();
    for torque in [60.0, 100.0, 364.0] {
        let load = format!("[{{ kind = 'constant', torque = '{torque} N m' }}]");
        let loose = bicycle.replace("sprockets.rear.load", &load).unwrap();
        let rigid = loose.replace("chain.model", "particles").unwrap();
        let tight = |scene: &Scene| {
            let tensions = at_rest(scene).span_tension;
            tensions.into_iter().fold(0.0, f64::max)
        };
        let (found, without_play, asked) = (tight(&loose), tight(&rigid), torque / radius);
        assert!(
            (found / asked - 1.0).abs() < 0.1,
            "{torque} N m: {found} N, {asked} N"
        );
        assert!(
            (found / without_play - 1.0).abs() < 0.03,
            "{torque} N m: {found} N, {without_play} N"
        );
    }
}

/// Play between bushes and rollers makes the circles smaller on which the bushes run, and the chain so much shorter: in the mean of its links
/// it is as tight as that of lumped rollers, as long as neither load nor weight moves the bushes. The spans are a little tighter, as rollers
/// that climb the flanks take tension off the links between them. Version 0.1 laid half a newton a µm of play into this chain.
#[test]
fn chains_of_free_rollers_are_as_tight_as_those_of_lumped_ones() {
    let lumped = Scene::preset("bicycle").unwrap();
    let lumped = lumped.replace("sprockets.rear.load", "[]").unwrap();
    let lumped = lumped.replace("gravity", "[0, 0]").unwrap();
    let tensions = |scene: &Scene| {
        let sample = at_rest(scene);
        let links = sample.link_tension.iter().sum::<f64>() / sample.link_tension.len() as f64;
        [links, sample.span_tension[0], sample.span_tension[1]]
    };
    let known = tensions(&lumped);
    for play in ["10 um", "50 um", "200 um"] {
        let free = lumped
            .replace("chain.rollers", "free")
            .and_then(|scene| scene.replace("chain.roller", &format!("{{ clearance = '{play}' }}")))
            .unwrap();
        let found = tensions(&free);
        assert!(
            (found[0] / known[0] - 1.0).abs() < 0.02,
            "{play}: {found:?} N, {known:?} N"
        );
        for span in 1..3 {
            assert!(
                (found[span] / known[span] - 1.0).abs() < 0.15,
                "{play}: {found:?} N, {known:?} N"
            );
        }
    }
}

/// A free roller is light: what the tooth presses on it, it presses on its bush, which lies as deep in it as its law says.
#[test]
fn bushes_in_free_rollers_are_told_of() {
    let lumped = Scene::preset("bicycle").unwrap();
    let free = lumped
        .replace("chain.rollers", "free")
        .and_then(|scene| scene.replace("chain.roller", "{ clearance = '50 µm' }"))
        .unwrap();
    let run = Run {
        until: 1e-4,
        every: 1e-4,
        ..Run::default()
    };
    let simulation = Simulation::start(&free.drive().unwrap(), &run).unwrap();
    let mut started = simulation.clone();
    let sample = started.next_sample().unwrap().unwrap();
    let most = sample.contact_force.iter().copied().fold(0.0, f64::max);
    assert!(most > 20.0, "{most} N");
    let mut pressed = 0;
    for joint in 0..simulation.system().joints() {
        let (force, depth) = (sample.bush_force[joint], sample.bush_depth[joint]);
        let offset = sample.bush_offset_x[joint].hypot(sample.bush_offset_y[joint]);
        let by_parts = sample.bush_force_x[joint].hypot(sample.bush_force_y[joint]);
        assert!((by_parts - force).abs() <= 1e-12 * force);
        assert_eq!(depth > 0.0, force > 0.0, "{joint}");
        if sample.contact_force[joint] > 0.2 * most {
            pressed += 1;
            let by_tooth = sample.contact_force[joint];
            assert!(
                (force / by_tooth - 1.0).abs() < 0.05,
                "{joint}: {force} N, {by_tooth} N"
            );
            // |e| = c + δ
            assert!(
                (offset - 50e-6 - depth).abs() < 1e-12,
                "{joint}: {offset} m"
            );
        }
    }
    assert!(pressed > 5, "{pressed}");
    assert!(Channel::BushForce.is_of(simulation.system()));
    let lumped = Simulation::start(&lumped.drive().unwrap(), &run).unwrap();
    assert!(!Channel::BushForce.is_of(lumped.system()));
    let refused = Channel::chosen(&["bush_depth"], lumped.system()).unwrap_err();
    assert!(refused.to_string().contains("bush_depth"), "{refused}");
}

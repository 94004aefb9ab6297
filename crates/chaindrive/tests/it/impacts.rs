//! Impacts of rollers that come to a sprocket: one a passage, as fast and as strong as theory and the log of contacts have it.

use std::f64::consts::TAU;

use chaindrive::{ContactEvent, ContactPair, Drive, EventKinds, Impact, Run, Scene, Simulation};

/// Impacts and contacts of a run.
fn struck(drive: &Drive, until: f64, step: Option<f64>) -> (Vec<Impact>, Vec<ContactEvent>) {
    let run = Run {
        until,
        every: until / 200.0,
        step,
        events: EventKinds {
            teeth: true,
            ..EventKinds::default()
        },
        ..Run::default()
    };
    let mut simulation = Simulation::start(drive, &run).unwrap_or_else(|error| panic!("{error}"));
    let (mut impacts, mut events) = (Vec::new(), Vec::new());
    while simulation
        .next_sample()
        .expect("the motion stays finite")
        .is_some()
    {
        impacts.extend_from_slice(simulation.impacts());
        events.extend_from_slice(simulation.events());
    }
    events.extend(simulation.outstanding_events());
    (impacts, events)
}

fn preset(name: &str) -> Drive {
    let drive = Scene::preset(name).and_then(|scene| scene.drive());
    drive.unwrap_or_else(|error| panic!("{error}"))
}

/// Every tooth that passes takes one roller, which strikes once, however often it bounces.
#[test]
fn a_roller_strikes_once_a_passage() {
    for (name, until) in [("marine_two_sprockets", 0.3), ("industrial_16b", 0.3)] {
        let drive = preset(name);
        let (impacts, _) = struck(&drive, until, None);
        let start = drive.assemble().unwrap_or_else(|error| panic!("{error}"));
        let speeds = start.mean_speeds();
        for (index, sprocket) in drive.sprockets.iter().enumerate() {
            let passed = f64::from(sprocket.gap.teeth) * speeds[index].abs() * until / TAU;
            let found = impacts.iter().filter(|it| it.sprocket == index).count() as f64;
            // Rollers that are near at the start have come, and the last ones have not parted.
            assert!(
                found > 10.0 && found > passed - 6.0 && found < passed + 1.0,
                "{name}, sprocket {index}: {found} impacts, {passed} teeth"
            );
        }
        // No roller strikes twice within half a circuit.
        for (i, one) in impacts.iter().enumerate() {
            let same = |it: &&Impact| it.sprocket == one.sprocket && it.roller == one.roller;
            let again = impacts[i + 1..].iter().find(same);
            assert!(
                again.is_none_or(|it| it.time - one.time > 0.02),
                "{one:?}, {again:?}"
            );
        }
    }
}

/// An impact is a contact of the log: it begins with it, as fast, and is no stronger.
#[test]
fn an_impact_is_the_first_contact_of_the_log() {
    let (impacts, events) = struck(&preset("industrial_16b"), 0.2, None);
    assert!(impacts.len() > 20, "{}", impacts.len());
    for impact in impacts {
        let pair = ContactPair::Tooth {
            sprocket: impact.sprocket,
            roller: impact.roller,
        };
        let near = |it: &&ContactEvent| it.pair == pair && (it.start - impact.time).abs() < 1e-12;
        let event = events
            .iter()
            .find(near)
            .unwrap_or_else(|| panic!("{impact:?} is not logged"));
        assert!(
            (event.onset_speed - impact.speed).abs() < 1e-12,
            "{impact:?}, {event:?}"
        );
        assert!(
            impact.peak_force <= event.peak_force,
            "{impact:?}, {event:?}"
        );
        assert!(impact.impulse > 0.0, "{impact:?}");
    }
}

/// Theory: a point mass that meets a fixed tooth without friction leaves it with e times its speed,
///
/// ```text
/// J = (1 + e) m v
/// ```
#[test]
fn the_impulse_is_that_of_the_restitution() {
    let (mass, restitution) = (0.009, 0.6);
    let scene = format!(
        r#"
        settle = false
        gravity = [0, 0]
        [chain]
        pitch = 0.0127
        links = 1
        mass = {mass}
        stiffness = 1
        roller_diameter = 0.00851
        ends = ["free", "free"]
        [chain.start]
        kind = "points"
        positions = [[0.003, 0.06], [0.003, 0.0727]]
        velocities = [[0, -1], [0, -1]]
        [contact.teeth]
        law = {{ kind = "power", stiffness = 1e10, exponent = 1.5 }}
        restitution = {restitution}
        [[sprockets]]
        name = "locked"
        teeth = 17
        centre = [0, 0]
        motion = "held"
        "#
    );
    let drive = Scene::from_text(&scene, "drop.toml").and_then(|scene| scene.drive());
    let drive = drive.unwrap_or_else(|error| panic!("{error}"));
    let (impacts, _) = struck(&drive, 0.04, Some(2e-8));
    let first = impacts.first().expect("the roller falls onto a tooth");
    assert!(first.speed > 0.3 && first.speed <= 1.0, "{first:?}");
    let expected = (1.0 + restitution) * mass * first.speed;
    assert!(
        (first.impulse / expected - 1.0).abs() < 0.005,
        "{} N s, not {expected} N s",
        first.impulse
    );
    // A second roller comes after it.
    assert!(impacts.len() <= 2, "{impacts:?}");
}

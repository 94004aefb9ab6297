//! A run's word about its own exactness, against more exact runs.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::precision::{Divergence, Estimate, estimate, horizon};
use chaindrive::record::{Ending, Existing, Provenance, ZarrWriter};
use chaindrive::{
    Channel, Judgement, Memory, Request, Run, Scene, SettingValue, Settings, Simulation,
    SimulationError, Stepping, execute,
};

use crate::judged::bare;

fn never() -> bool {
    false
}

fn judged(scene: &str, run: &Run) -> Estimate {
    let start = bare(scene).drive().unwrap().assemble();
    estimate(&start.unwrap(), run, &never).unwrap()
}

/// Tensions of the spans, sampled over some time \[N\]; the first is the tight one.
fn tensions(scene: &str, run: &Run, nudge: f64) -> Vec<[f64; 2]> {
    let start = bare(scene).drive().unwrap().assemble();
    let start = start.unwrap().nudged(nudge);
    let mut simulation = Simulation::from_assembled(start, run).unwrap();
    let mut found = Vec::new();
    while let Some(sample) = simulation.next_sample().unwrap() {
        found.push([sample.span_tension[0], sample.span_tension[1]]);
    }
    found
}

/// The error that a run reports is that which a reference finds: within a factor of two, as orders between one and
/// two allow for the difference from half the step.
#[test]
fn the_estimate_agrees_with_a_reference() {
    let scene = "marine_two_sprockets";
    let step = 1.9e-5;
    let run = Run {
        until: 0.06,
        step: Some(step),
        ..Run::default()
    };
    let own = judged(scene, &run);
    let sampled = Run {
        until: own.window,
        every: own.window / 128.0,
        ..run
    };
    let reference = Run {
        stepping: Stepping::Rk4,
        step: Some(0.25 * step),
        onset_depth: Some(1e-7),
        ..sampled.clone()
    };
    let (found, exact) = (
        tensions(scene, &sampled, 0.0),
        tensions(scene, &reference, 0.0),
    );
    let square = found.iter().zip(&exact).map(|(a, b)| (a[0] - b[0]).powi(2));
    let error = (square.sum::<f64>() / found.len() as f64).sqrt();
    let mean = exact.as_flattened().iter().sum::<f64>() / (2 * exact.len()) as f64;
    let ratio = own.tight_tension / (error / mean);
    assert!((0.5..1.3).contains(&ratio), "{ratio}");
}

/// The twins of a slack chain agree to 1 % of the mean tension until the horizon, and not long after it.
#[test]
fn the_horizon_is_where_twins_part() {
    let scene = "bicycle_slack";
    let run = Run {
        until: 8e-3,
        step: Some(2e-6),
        ..Run::default()
    };
    let estimate = judged(scene, &run);
    let Divergence::Measured { at } = estimate.horizon.tight else {
        panic!("{:?}", estimate.horizon);
    };
    let sampled = Run {
        every: 8e-3 / 256.0,
        ..run.clone()
    };
    let (a, b) = (
        tensions(scene, &sampled, 0.0),
        tensions(scene, &sampled, 1e-12),
    );
    let apart = |until: f64| {
        let pairs = a.iter().zip(&b).enumerate();
        let within = pairs.take_while(|(i, _)| (*i as f64) * sampled.every < until);
        within
            .map(|(_, (a, b))| (a[0] - b[0]).abs())
            .fold(0.0, f64::max)
    };
    let mean = a.as_flattened().iter().sum::<f64>() / (2 * a.len()) as f64;
    assert!(apart(at) < 0.0101 * mean);
    assert!(apart(8e-3) > 0.01 * mean);
    assert!(
        estimate.waveform.unwrap() <= at,
        "an error grows like a twin"
    );
}

/// A free ring is integrable: nothing grows, and no horizon is claimed.
#[test]
fn a_regular_motion_has_no_horizon() {
    let run = Run {
        until: 0.05,
        ..Run::default()
    };
    let estimate = judged("spinning_ring", &run);
    assert!(matches!(estimate.horizon.all, Divergence::None { largest } if largest < 1e-8));
    assert_eq!(estimate.waveform, None);
    assert!(estimate.force[0].difference.is_nan(), "nothing touches");
    assert!(estimate.tension > 0.0 && estimate.tension < 1e-3);
}

/// Half the step quarters the error of Verlet on a smooth motion.
#[test]
fn a_smaller_step_has_a_smaller_error() {
    let error = |step: f64| {
        let run = Run {
            until: 0.02,
            step: Some(step),
            ..Run::default()
        };
        judged("spinning_ring", &run).tension
    };
    let ratio = error(4e-5) / error(2e-5);
    assert!((3.5..4.5).contains(&ratio), "{ratio}");
}

#[test]
fn the_cost_does_not_depend_on_the_length_of_the_run() {
    let of = |until: f64| {
        let run = Run {
            until,
            ..Run::default()
        };
        judged("marine_two_sprockets", &run)
    };
    let (short, long) = (of(0.5), of(500.0));
    assert_eq!(short.evaluations, long.evaluations);
    assert!(long.evaluations < 41_000);
    assert_eq!(short.tension.to_bits(), long.tension.to_bits());
    // A run shorter than the window is judged over all of it.
    assert!((of(2e-3).window - 2e-3).abs() < 1e-12);
}

#[test]
fn methods_with_error_control_are_compared_with_a_tenth_of_the_tolerance() {
    let run = Run {
        until: 2e-3,
        stepping: Stepping::DormandPrince,
        tolerance: 1e-5,
        ..Run::default()
    };
    let estimate = judged("spinning_ring", &run);
    assert_eq!(estimate.shadow, "a tenth of the tolerance");
    assert!(estimate.tension > 0.0);
    let run = Run {
        onset_depth: Some(1e-6),
        ..run
    };
    let estimate = judged("spinning_ring", &run);
    assert_eq!(
        estimate.shadow,
        "a tenth of the tolerance and of the onset depth"
    );
}

#[test]
fn an_estimate_that_is_stopped_says_so() {
    let scene = Scene::preset("spinning_ring").unwrap();
    let run = Run {
        until: 1e-3,
        ..Run::default()
    };
    let start = scene.drive().unwrap().assemble().unwrap();
    let stopped = estimate(&start, &run, &|| true);
    assert!(matches!(stopped, Err(SimulationError::Interrupted)));
    let simulation = Simulation::from_assembled(start, &run).unwrap();
    let judgement = Judgement::of(&simulation, &run, &|| true);
    assert_eq!(judgement, Judgement::Interrupted);
    assert!(judgement.to_string().contains("interrupted"));
}

/// Attributes of the group and of one channel.
fn stored(path: &std::path::Path, name: &str) -> serde_json::Value {
    let text = std::fs::read(path.join(name).join("zarr.json")).unwrap();
    let document: serde_json::Value = serde_json::from_slice(&text).unwrap();
    document["attributes"].clone()
}

/// An estimate after a choice goes on with its short runs: the same numbers, for less.
#[test]
fn an_estimate_behind_a_choice_is_that_of_the_run_for_less() {
    let settings = Settings::default()
        .with("until", SettingValue::Number(0.1))
        .with("run_in", SettingValue::Number(0.0));
    for scene in ["marine_two_sprockets", "bicycle"] {
        let request = Request::new(&Scene::preset(scene).unwrap(), &settings).unwrap();
        let report = execute(&request, &mut Memory::default(), &never).unwrap();
        let told = report.judgement.unwrap().estimate().unwrap().clone();
        let alone = estimate(report.simulation.assembled(), &report.run, &never).unwrap();
        let (spent, of) = (told.evaluations as f64, alone.evaluations as f64);
        // Of eight half windows, one of the run itself and two of its shadow were there.
        assert!(
            (0.5..0.7).contains(&(spent / of)),
            "{scene}: {spent} of {of}"
        );
        assert_eq!(
            told,
            Estimate {
                evaluations: told.evaluations,
                ..alone
            }
        );
    }
}

#[test]
fn a_stored_result_carries_its_error_and_its_horizon() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slack.zarr");
    let scene = bare("bicycle_slack");
    let run = Run {
        until: 6e-3,
        every: 1e-3,
        step: Some(2e-6),
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let channels = [Channel::SpanTension];
    let provenance = Provenance::of(&scene, &run);
    let mut writer =
        ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    while simulation.next_sample().unwrap().is_some() {
        writer.push(&simulation).unwrap();
    }
    let judgement = Judgement::of(&simulation, &run, &never);
    writer.judge(&judgement);
    writer.finish(&simulation, &Ending::Complete).unwrap();

    let attributes = stored(&path, "");
    assert_eq!(attributes["error_estimate"], "made");
    for (name, value) in judgement.attributes() {
        assert_eq!(attributes[&name], value, "{name}");
    }
    assert!(attributes["error_span_tension"].as_f64().unwrap() > 0.0);
    let horizon = judgement.horizon_of(Channel::SpanTension).unwrap();
    assert!(horizon.at < 6e-3);
    let span = stored(&path, "span_tension");
    assert_eq!(span["waveform_horizon"], horizon.at);
    assert_eq!(span["waveform_horizon_of"], "span_tension");
}

/// Twins are the same drive, less than 1e-12 m elsewhere: particles with the copies of a closed chain, and links.
#[test]
fn a_twin_starts_a_picometre_away() {
    for scene in ["marine_two_sprockets", "bicycle"] {
        let start = Scene::preset(scene).unwrap().drive().unwrap().assemble();
        let start = start.unwrap();
        let twin = start.nudged(1e-12);
        let shifts: Vec<f64> = twin.q.iter().zip(&start.q).map(|(a, b)| a - b).collect();
        // Coordinates of some metres round to 4e-16 m.
        assert!(
            shifts.iter().all(|shift| shift.abs() <= 1.001e-12),
            "{scene}"
        );
        let moved = shifts.iter().filter(|shift| **shift != 0.0).count();
        assert!(moved > start.system.rollers(), "{scene}: {moved}");
        assert_eq!(start.nudged(1e-12).q, twin.q, "the pattern is fixed");
        assert_eq!(twin.v, start.v);
    }
}

/// Followed for longer, the extrapolated horizon of the marine engine becomes a measured one of the same size.
#[test]
fn extrapolation_finds_the_size_of_the_horizon() {
    let scene = Scene::preset("marine_engine_bare").unwrap();
    // With the other pretension twins part too late for the short time to tell.
    let scene = scene.replace("route.pretension_at", "\"phase\"").unwrap();
    let start = scene.drive().unwrap();
    let start = start.assemble().unwrap();
    let run = Run::default();
    let short = horizon(&start, &run, 0.07, &never).unwrap();
    let long = horizon(&start, &run, 0.4, &never).unwrap();
    assert!(
        matches!(short.all, Divergence::Extrapolated { .. }),
        "{short:?}"
    );
    assert!(matches!(long.all, Divergence::Measured { .. }), "{long:?}");
    let ratio = short.all.time().unwrap() / long.all.time().unwrap();
    assert!((0.4..2.5).contains(&ratio), "{ratio}");
}

//! Descriptions agree with closed forms.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::{Description, Memory, Request, Run, Scene, Settings, Stepping, execute};
use chaindrive_geometry::Point;
use chaindrive_mechanics::Clash;

use crate::judged::{finished, page, preset, run};

fn describe(preset: &str) -> Description {
    let scene = Scene::preset(preset).unwrap();
    let run = Run::suggested(&scene.run_defaults());
    Description::of(&scene.drive().unwrap(), &run).unwrap()
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= relative * expected.abs(),
        "{found} instead of {expected}"
    );
}

#[test]
fn the_marine_engine() {
    let it = describe("marine_engine_bare");
    assert_eq!(it.chains[0].links, 122);
    close(it.chains[0].mass_per_length, 3.01 / 0.0889, 1e-12);
    close(
        it.chains[0].longitudinal_wave_speed,
        0.0889 * (815e6_f64 / 3.01).sqrt(),
        1e-12,
    );

    // A loop turns once: the wraps of sprockets that are all inside add up to a full turn.
    let wraps: f64 = it.stops.iter().filter_map(|stop| stop.wrap).sum();
    close(wraps, std::f64::consts::TAU, 1e-9);
    let pitches = |seated: u32, spans: usize| seated as usize + spans;
    let seated = it.stops.iter().map(|stop| stop.pitches).sum();
    assert_eq!(
        pitches(seated, it.spans.iter().map(|span| span.pitches).sum()),
        122
    );
    for span in &it.spans {
        // f = √(T/μ) / 2L
        let speed = (span.tension / it.chains[0].mass_per_length).sqrt();
        close(span.frequency.unwrap(), speed / (2.0 * span.length), 1e-12);
    }

    // The load of 5 kN m on 48 teeth hangs between the two strands of the camshaft.
    let radius = 0.5 * 0.0889 / (std::f64::consts::PI / 48.0).sin();
    let across = it.spans[0].tension - it.spans[1].tension;
    let weight = 9.81 * it.chains[0].mass_per_length * (it.spans[0].length + it.spans[1].length);
    assert!(
        (across - 5e3 / radius).abs() < weight,
        "{across} N, {weight} N of it may be weight"
    );

    let (name, mesh) = &it.time_scales.mesh_frequencies[0];
    assert_eq!(name, "crank");
    close(*mesh, 48.0 * 127.0 / 60.0, 1e-12);
    assert_eq!(it.polygon.len(), 4);
    for pair in &it.polygon {
        assert!(pair.least_ratio < pair.mean_ratio && pair.mean_ratio < pair.greatest_ratio);
    }
    assert!(it.cost.steps > 1e3 && it.cost.run_time > 0.0);
}

#[test]
fn a_drive_without_a_route() {
    let it = describe("spinning_ring");
    assert!(it.stops.is_empty() && it.spans.is_empty() && it.polygon.is_empty());
    assert_eq!(it.model.degrees_of_freedom, 40);
    assert!(it.model.absent.contains(&"sprockets"));
    let text = it.to_string();
    assert!(
        text.contains("absent                 sprockets, guides"),
        "{text}"
    );
}

/// What a description calls absent, and is no body, the page of a run tells as left out: friction on rails where they have none.
#[test]
fn a_page_tells_what_the_model_leaves_out() {
    let rubs = ("contact.guides.friction", "{ coefficient = 0.1 }");
    for (changes, left_out) in [
        (
            &[][..],
            "oil between rollers and teeth, friction on teeth, friction on guides, damping of the links, run-out and pitch errors of sprockets, friction of the bearings of shafts, drag of oil and air on shafts, bending of pins and bushes behind the teeth",
        ),
        (
            &[rubs][..],
            "oil between rollers and teeth, friction on teeth, damping of the links, run-out and pitch errors of sprockets, friction of the bearings of shafts, drag of oil and air on shafts, bending of pins and bushes behind the teeth",
        ),
    ] {
        let scene = preset("marine_engine", changes);
        let run = run(1e-4, 2.0);
        let drive = scene.drive().unwrap();
        let it = Description::of(&drive, &run).unwrap();
        assert_eq!(it.model.absent.join(", "), left_out);
        let (simulation, summary) = finished(&scene, &run);
        let page = page(&summary, &simulation);
        let told = format!("\n  The model leaves out {left_out}.\n");
        assert!(page.contains(&told), "{page}");
    }
}

/// A step of a thousand links with play takes a tenth of a second: nobody waits for four hundred of them to learn the cost.
#[test]
fn the_cost_of_large_chains_is_measured_in_bounded_time() {
    let scene = Scene::preset("bicycle").unwrap();
    let scene = scene.replace("chain.links", "1000").unwrap();
    let away = "['-6.150144624366 m', '0 m']";
    let scene = scene.replace("sprockets.rear.centre", away).unwrap();
    let drive = scene.replace("settle", "false").unwrap().drive().unwrap();
    let run = Run {
        stepping: Stepping::GeneralizedAlpha,
        ..Run::default()
    };
    let cost = Description::of(&drive, &run).unwrap().cost;
    assert!((1..400).contains(&cost.measured), "{}", cost.measured);
    assert!(cost.time_per_step > 0.0 && cost.run_time > 1.0);
}

/// Settling takes far longer than describing: a drive that stands already is described as it stands.
#[test]
fn an_assembled_drive_is_described_without_settling_it_again() {
    let scene = Scene::preset("spinning_ring").unwrap();
    let run = Run::suggested(&scene.run_defaults());
    let mut start = scene.drive().unwrap().assemble().unwrap();
    // Settled anew, it would forget this.
    start.warnings = vec![Clash::Sprockets {
        first: "a".into(),
        second: "b".into(),
        depth: 1e-3,
        at: Point::origin(),
    }];
    let told = Description::of_assembled(&start, &run).unwrap();
    assert_eq!(told.warnings, [start.warnings[0].to_string()]);
    let anew = Description::of(&start.drive, &run).unwrap();
    let facts = |it: &Description| (it.chains.clone(), it.spans.clone(), it.statics.clone());
    assert_eq!(facts(&told), facts(&anew));
}

/// Names of spans follow the order of the stops, whichever way the chain runs: the description and the page say where these differ.
#[test]
fn a_chain_that_runs_against_its_route_is_told() {
    let drive = |speed: &str, side: &str| {
        let text = format!(
            "chain = {{ type = '08B-1', links = 32 }}
            [[sprockets]]
            name = 'a'
            teeth = 11
            side = '{side}'
            centre = [0, 0]
            motion = {{ kind = 'constant', speed = '{speed}' }}
            [[sprockets]]
            name = 'b'
            teeth = 11
            side = '{side}'
            centre = ['133.34999 mm', 0]
            inertia = 1e-3
            [route]
            stops = ['a', 'b']
            [run]
            until = '5 ms'\nevery = '1 ms'\nrun_in = 0"
        );
        Scene::from_text(&text, "test").unwrap()
    };
    let told = |scene: &Scene| {
        let run = Run::suggested(&scene.run_defaults());
        let described = Description::of(&scene.drive().unwrap(), &run).unwrap();
        let against = described.chains[0].against_route.clone();
        let text = described.to_string();
        assert!(against.iter().all(|it| text.contains(it)), "{text}");
        let request = Request::new(scene, &Settings::default()).unwrap();
        let report = execute(
            &request.with_default_step(),
            &mut Memory::default(),
            &|| false,
        );
        let page = report.unwrap().attributes["summary"].to_string();
        let is_told = page.contains("runs against the order of its route");
        assert_eq!(is_told, against.is_some(), "{page}");
        against
    };
    let against =
        "The chain runs against the order of its route: span a-b leads from b to a.".to_owned();
    assert_eq!(told(&drive("300 rpm", "left")), None);
    assert_eq!(told(&drive("-300 rpm", "left")), Some(against));
    // With the sprockets on the other side of the route, names follow the chain again.
    assert_eq!(told(&drive("-300 rpm", "right")), None);
}

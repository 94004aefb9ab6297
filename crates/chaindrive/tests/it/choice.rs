//! The method and step that an accuracy chooses keep it, by the judgement of runs that had no part in the choice.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::precision::{ACCURACY, Choice, Promise, Quantity, choose};
use chaindrive::{
    Assembled, ImpactStatistics, Memory, Request, Run, Scene, SettingValue, Settings, Simulation,
    SimulationError, Stepping, Summary, Trust, execute,
};
use chaindrive_integrate::SecondOrderSystem;

use crate::judged::bare;

fn start(scene: &str) -> Assembled {
    let drive = Scene::preset(scene).unwrap().drive().unwrap();
    drive.assemble().unwrap()
}

fn chosen(start: &Assembled, accuracy: f64) -> Choice {
    chosen_until(start, accuracy, 0.1)
}

fn chosen_until(start: &Assembled, accuracy: f64, until: f64) -> Choice {
    let run = Run {
        until,
        ..Run::default()
    };
    choose(start, &run, accuracy, &|| false).unwrap()
}

/// Tensions of the spans at 64 moments of a window \[N\].
fn tensions(start: &Assembled, run: &Run, until: f64) -> Vec<Vec<f64>> {
    let run = Run {
        until,
        every: until / 64.0,
        ..run.clone()
    };
    let mut simulation = Simulation::from_assembled(start.clone(), &run).unwrap();
    let mut found = Vec::new();
    while let Some(sample) = simulation.next_sample().unwrap() {
        found.push(sample.span_tension.clone());
    }
    found
}

/// Error of the tight span, the first one of all these drives, over the mean tension of all spans.
fn error(start: &Assembled, choice: &Choice, reference: &Run, until: f64) -> f64 {
    let found = tensions(start, &choice.run, until);
    let exact = tensions(start, reference, until);
    let square: f64 = found
        .iter()
        .zip(&exact)
        .map(|(a, b)| (a[0] - b[0]).powi(2))
        .sum();
    let all: f64 = exact.iter().flatten().sum();
    let mean = all / exact.iter().flatten().count() as f64;
    (square / found.len() as f64).sqrt() / mean
}

#[test]
fn the_marine_drives_keep_what_was_asked() {
    for scene in ["marine_two_sprockets", "marine_engine_bare"] {
        let start = start(scene);
        for accuracy in [0.01, 0.001] {
            // Within the horizon of both.
            let choice = chosen_until(&start, accuracy, 8e-3);
            assert!(choice.kept, "{scene}: {choice}");
            assert_eq!(choice.promise, Promise::Waveform);
            assert!(choice.error <= accuracy);
            let reference = Run {
                stepping: Stepping::Rk4,
                step: Some(2e-6),
                onset_depth: Some(1e-8),
                ..Run::default()
            };
            let error = error(&start, &choice, &reference, choice.window);
            assert!(error <= accuracy, "{scene}: {error:.1e}, {choice}");
            assert!(error > 1e-9, "the reference is another run");
        }
    }
}

/// The teeth of a timing drive damp deep, slow contacts, and its plunger the arm, several times as fast as an explicit step could
/// follow: the step chosen is longer than that, and the run is that of RK4, which follows.
#[test]
fn stiff_damping_does_not_shorten_the_step() {
    let start = start("timing_drive");
    let choice = chosen(&start, ACCURACY);
    assert!(choice.kept, "{choice}");
    let step = choice.run.step.unwrap();
    let explicit = 2.0 * start.system.time_scale();
    assert!(step > 2.0 * explicit, "{step:e} s, {explicit:e} s");
    let reference = Run {
        stepping: Stepping::Rk4,
        step: Some(0.5 * start.system.time_scale()),
        ..Run::default()
    };
    let error = error(&start, &choice, &reference, 0.2 * choice.window);
    assert!((1e-9..=ACCURACY).contains(&error), "{error:.1e}, {choice}");
}

/// RK4 resolves the joints' damping, which the method chosen treats implicitly: two independent ways.
#[test]
fn the_bicycle_keeps_what_was_asked() {
    let start = start("bicycle");
    let choice = chosen(&start, ACCURACY);
    assert!(choice.kept, "{choice}");
    assert_eq!(choice.run.stepping, Stepping::ImplicitDamping);
    let reference = Run {
        stepping: Stepping::Rk4,
        step: Some(0.35e-6),
        ..Run::default()
    };
    // Half the window: RK4 takes twenty times as long as the run.
    let until = 0.5 * choice.window;
    let error = error(&start, &choice, &reference, until);
    assert!((1e-9..=ACCURACY).contains(&error), "{error:.1e}, {choice}");
}

/// A slack chain's twins part within the window: statistics are promised, and the reason says so. They do without friction
/// in the joints.
#[test]
fn beyond_the_horizon_statistics_are_promised() {
    let start = bare("bicycle_slack").drive().unwrap().assemble().unwrap();
    let choice = chosen(&start, ACCURACY);
    assert_eq!(choice.promise, Promise::Statistics);
    assert!(choice.to_string().contains("chaotic"), "{choice}");
}

#[test]
fn more_accuracy_takes_more_work_and_the_answer_is_always_the_same() {
    let start = start("marine_two_sprockets");
    let work = |choice: &Choice| choice.trials.last().unwrap().work;
    let [coarse, fine] = [0.05, 1e-3].map(|accuracy| chosen(&start, accuracy));
    assert!(work(&fine) > work(&coarse), "{coarse}\n{fine}");
    assert!(coarse.trials.len() < fine.trials.len());
    assert_eq!(chosen(&start, 1e-3), fine);
}

/// One evaluation a step: a candidate and its judge with half the step. Nothing turns on a twin.
#[test]
fn what_the_choice_cost_is_counted() {
    let choice = chosen(&start("marine_two_sprockets"), 0.05);
    assert_eq!(choice.trials.len(), 1, "{choice}");
    let expected = choice.window * 3.0 / choice.trials[0].step;
    let share = choice.evaluations as f64 / expected;
    assert!((share - 1.0).abs() < 0.02, "{share}");
}

#[test]
fn what_cannot_be_reached_is_said() {
    let choice = chosen(&start("spinning_ring"), 1e-15);
    assert!(!choice.kept);
    assert!(choice.error > 1e-15 && choice.error < 1e-6, "{choice}");
    assert!(choice.to_string().contains("is not reached"), "{choice}");
}

#[test]
fn an_accuracy_is_a_share() {
    let ring = start("spinning_ring");
    for accuracy in [0.0, -0.1, 1.0, f64::NAN] {
        let refused = choose(&ring, &Run::default(), accuracy, &|| false);
        assert!(matches!(
            refused,
            Err(SimulationError::Setting {
                name: "accuracy",
                ..
            })
        ));
    }
    let stopped = choose(&ring, &Run::default(), 0.01, &|| true);
    assert!(matches!(stopped, Err(SimulationError::Interrupted)));
}

/// The word of a scene or a caller about the method is kept; only what is left open is chosen.
#[test]
fn a_scene_with_a_step_keeps_it() {
    let wanted = |text: &str| {
        let scene = Scene::preset("spinning_ring").unwrap();
        let scene = match text.split_once('=') {
            Some((path, value)) => scene.replace(path, value).unwrap(),
            None => scene,
        };
        scene.run_defaults().chosen_accuracy()
    };
    assert_eq!(wanted(""), Some(ACCURACY));
    assert_eq!(wanted("run.accuracy=0.2 %"), Some(0.002));
    assert_eq!(wanted("run.step=1 us"), None);
    assert_eq!(wanted("run.method=rk4"), None);
    assert_eq!(wanted("run.tolerance=1e-6"), None);
    assert_eq!(wanted("run.onset_depth=1 um"), None);
}

/// Energy lost over a window, and what is unaccounted for \[J\].
fn lost(start: &Assembled, run: &Run, until: f64) -> [f64; 2] {
    let run = Run {
        until,
        every: until,
        ..run.clone()
    };
    let mut simulation = Simulation::from_assembled(start.clone(), &run).unwrap();
    let first = simulation.next_sample().unwrap().unwrap().energy;
    let last = simulation.next_sample().unwrap().unwrap().energy;
    let residual = simulation.energy_residual().abs();
    [last.dissipated() - first.dissipated(), residual]
}

/// The losses of a run by the method chosen are those of one sixteen times as fine, and its ledger closes as well.
#[test]
fn losses_are_kept_where_they_are_asked_for() {
    let start = start("industrial_16b");
    let of_losses = |accuracy: f64| {
        let run = Run {
            until: 1.0,
            ..Run::default()
        };
        choose(&start, &run, (accuracy, Quantity::Losses), &|| false).unwrap()
    };
    let choice = of_losses(0.02);
    assert!(choice.kept && choice.promise == Promise::Losses, "{choice}");
    assert!(
        choice.reason().contains("that keeps the losses within"),
        "{choice}"
    );
    let fine = Run {
        step: choice.run.step.map(|step| step / 16.0),
        ..choice.run.clone()
    };
    let [found, residual] = lost(&start, &choice.run, choice.window);
    let [exact, _] = lost(&start, &fine, choice.window);
    assert!((found / exact - 1.0).abs() < 0.02, "{found} J, {exact} J");
    assert!(residual < 0.02 * exact, "{residual} J of {exact} J");
    let never = of_losses(1e-12);
    assert!(!never.kept && never.error < 0.02, "{never}");
}

/// Impacts by the method chosen are those of a run eight times as fine: median and 99th percentile of the forces, median of the impulses.
#[test]
fn impacts_are_kept_where_they_are_asked_for() {
    let start = start("marine_engine");
    let run = Run {
        until: 0.6,
        ..Run::default()
    };
    let accuracy = (0.03, Quantity::Impacts);
    let choice = choose(&start, &run, accuracy, &|| false).unwrap();
    assert!(
        choice.kept && choice.promise == Promise::Impacts,
        "{choice}"
    );
    let fine = Run {
        step: choice.run.step.map(|step| step / 8.0),
        ..choice.run.clone()
    };
    let exact = impacts(&start, &fine);
    for (found, exact) in impacts(&start, &choice.run).iter().zip(exact) {
        for ((name, found), (_, exact)) in found.iter().zip(exact) {
            let apart = (found / exact - 1.0).abs();
            assert!(apart < 0.03, "{name}: {found}, {exact}");
        }
    }
    // Nothing strikes in a ring that hangs in the air.
    let ring = self::start("spinning_ring");
    let run = Run::default();
    let choice = choose(&ring, &run, accuracy, &|| false).unwrap();
    assert_eq!(choice.promise, Promise::Nothing);
}

/// Force p50 and p99 and impulse of the impacts on every sprocket.
fn impacts(start: &Assembled, run: &Run) -> Vec<Vec<(&'static str, f64)>> {
    let mut simulation = Simulation::from_assembled(start.clone(), run).unwrap();
    let mut summary = Summary::new(&simulation);
    while simulation.next_sample().unwrap().is_some() {
        summary.strike(simulation.impacts());
    }
    let of = |it: &ImpactStatistics| {
        vec![
            ("force p50", it.force(0.5)),
            ("force p99", it.force(0.99)),
            ("impulse p50", it.impulse(0.5)),
        ]
    };
    let struck = summary.impacts().iter().filter(|it| it.count > 0);
    struck.map(of).collect()
}

/// What an estimate says of impacts at the default step, against a run eight times as fine: hardly ever less than half of the error, in the
/// middle not much more than it. The reference errs by less than 1 %, which an error is not told from.
#[test]
fn errors_of_impacts_are_those_of_the_step() {
    let (mut ratios, mut too_small) = (Vec::new(), 0);
    for (name, until) in [("marine_engine", 0.6), ("timing_drive", 0.066)] {
        let start = start(name);
        let run = Run {
            until,
            ..Run::default()
        };
        let run = choose(&start, &run, 0.01, &|| false).unwrap().run;
        let said = chaindrive::precision::estimate(&start, &run, &|| false).unwrap();
        let fine = Run {
            step: run.step.map(|step| step / 8.0),
            ..run.clone()
        };
        let exact = impacts(&start, &fine);
        for (place, found) in impacts(&start, &run).iter().enumerate() {
            let said = &said.impacts[place];
            assert!(said.compared >= 3, "{said:?}");
            let stated = [said.p50, said.p99, said.impulse];
            for ((stated, (_, found)), (_, exact)) in stated.iter().zip(found).zip(&exact[place]) {
                let apart = (found / exact - 1.0).abs();
                too_small += usize::from(*stated < 0.5 * apart - 0.01);
                ratios.push(stated / apart);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    assert!(too_small == 0, "{ratios:?}");
    let median = ratios[ratios.len() / 2];
    assert!((0.7..2.5).contains(&median), "{median} of {ratios:?}");
}

#[test]
fn what_loses_nothing_has_no_losses_to_keep() {
    let ring = Scene::preset("spinning_ring").unwrap();
    let ring = ring.replace("run.accuracy_of", "losses").unwrap();
    let settings = Settings::default().with("accuracy", SettingValue::Number(0.01));
    let request = Request::new(&ring, &settings).unwrap();
    assert_eq!(request.accuracy_of, Quantity::Losses);
    let start = ring.drive().unwrap().assemble().unwrap();
    let accuracy = (0.01, request.accuracy_of);
    let choice = choose(&start, &request.run, accuracy, &|| false).unwrap();
    assert_eq!(choice.promise, Promise::Nothing);
}

/// Joints with play, friction and springs behind: long steps keep the waveform and the energy, as far as `docs/clearance-joints.md` says.
/// Measured 0.07 to 0.16 % over 10 to 30 ms; with stiffness and sticking explicit a step of 8 µs erred by 0.6 % over 10 ms.
#[test]
fn clearance_joints_keep_the_tension_with_long_steps() {
    let start = start("bicycle");
    let by = |stepping, step| Run {
        stepping,
        step: Some(step),
        ..Run::default()
    };
    let until = 5e-3;
    let exact = tensions(&start, &by(Stepping::Rk4, 2e-7), until);
    let found = tensions(&start, &by(Stepping::ImplicitDamping, 8e-6), until);
    let mean = exact.iter().map(|spans| spans[0]).sum::<f64>() / exact.len() as f64;
    let pairs = found.iter().zip(&exact);
    let square: f64 = pairs.map(|(a, b)| (a[0] - b[0]).powi(2)).sum();
    let error = (square / found.len() as f64).sqrt() / mean;
    assert!(error < 2.5e-3, "{error}");
}

/// Impacts at 100 rad/s are shorter than a step of the calm drive, which leaves a tenth of the energy open: the choice takes less than half
/// of it.
#[test]
fn steps_whose_energy_does_not_add_up_are_not_chosen() {
    let step = |scene: &Scene| {
        let start = scene.drive().unwrap().assemble().unwrap();
        chosen_until(&start, 0.01, 0.03).run.step.unwrap()
    };
    let calm = Scene::preset("bicycle").unwrap();
    let fast = calm
        .replace("sprockets.chainring.motion.speed", "-100 rad/s")
        .unwrap();
    let [calm, fast] = [calm, fast].map(|scene| step(&scene));
    assert!(calm > 8e-6, "{calm}");
    assert!(fast < 0.5 * calm, "{fast}");
}

/// Where the waveform of the motorcycle's tension would allow twice the step, half of its losses would be open.
#[test]
fn no_run_is_chosen_whose_losses_nobody_would_trust() {
    let scene = Scene::preset("motorcycle").unwrap();
    let settings = Settings::default()
        .with("until", SettingValue::Number(0.05))
        .with("run_in", SettingValue::Number(0.0));
    let request = Request::new(&scene, &settings).unwrap().without_estimate();
    let report = execute(&request, &mut Memory::default(), &|| false).unwrap();
    let choice = report.choice.unwrap();
    assert!(choice.kept && choice.error <= 0.01, "{choice}");
    assert_ne!(report.verdict.trust, Trust::Distrusted, "{choice}");
    let energy = report.simulation.observation().energy;
    let open = report.simulation.energy_residual().abs() / energy.dissipated();
    // Not so much less that a far smaller step was taken than is needed.
    assert!((0.01..0.4).contains(&open), "{open}");
}

//! The account of steps: works of shafts, impulses of bodies, extremes; whoever samples, and when.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::time::Duration;

use chaindrive::record::Summary;
use chaindrive::{Period, Run, RunIn, Scene, Simulation, Source, Stepping};
use chaindrive_mechanics::Extremes;

use super::two_sprockets::{SOFT, TwoSprockets};

/// A run to its end, with all its periods as one.
fn whole(scene: &Scene, run: &Run) -> (Simulation, Summary, Period) {
    let run = Run {
        watched: true,
        ..run.clone()
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let mut summary = Summary::new(&simulation);
    let mut periods = Vec::new();
    while simulation.next_sample().unwrap().is_some() {
        summary.take(&simulation);
        periods.extend_from_slice(simulation.periods());
    }
    // To the end, which need not be a sample.
    while !simulation.advance(Duration::MAX).unwrap() {}
    summary.end(&simulation);
    periods.extend(simulation.outstanding_periods());
    let whole = periods.into_iter().reduce(|all, next| all.and(&next));
    (simulation, summary, whole.unwrap())
}

/// Speeds of all shafts now \[rad/s\].
fn speeds(simulation: &Simulation) -> Vec<f64> {
    let drive = &simulation.assembled().drive;
    let seen = simulation.observation();
    let names = simulation.system().shaft_names();
    let of = |(index, shaft): (usize, &chaindrive_mechanics::Shaft)| {
        let sprocket = drive.sprockets.iter().position(|it| it.shaft == index);
        sprocket.map_or_else(
            || {
                let name = shaft.name.as_ref().unwrap();
                seen.shaft_speed[names.iter().position(|it| it == name).unwrap()]
            },
            |sprocket| seen.sprocket_speed[sprocket],
        )
    };
    drive.shafts.iter().enumerate().map(of).collect()
}

/// Works of all sources on a shaft are the change of its kinetic energy, to the residual of the run.
fn shafts_balance(scene: &Scene, run: &Run) -> Period {
    let watched = Run {
        watched: true,
        ..run.clone()
    };
    let drive = scene.drive().unwrap();
    let mut before = Simulation::start(&drive, &watched).unwrap();
    before.next_sample().unwrap();
    let start = speeds(&before);
    let (simulation, summary, period) = whole(scene, run);
    let reached = simulation.observation().time;
    assert!((period.time[1] - reached).abs() < 1e-12 && period.time[0].abs() < 1e-12);
    let ledger = summary.ledger();
    let relative = (ledger.residual / ledger.moved).abs();
    let ends = speeds(&simulation);
    for (index, account) in period.accounts.shafts.iter().enumerate() {
        let on_it = drive.sprockets.iter().filter(|it| it.shaft == index);
        let inertia = drive.shafts[index].inertia + on_it.map(|it| it.inertia).sum::<f64>();
        let gained = 0.5 * inertia * (ends[index].powi(2) - start[index].powi(2));
        let turned_over: f64 = account.works.iter().map(|it| it.abs()).sum();
        let open = (account.total() - gained).abs() / turned_over.max(gained.abs());
        let allowed = (10.0 * relative).max(1e-6);
        assert!(
            open < allowed || turned_over == 0.0,
            "shaft {index}: {open} of {allowed}, {account:?}"
        );
    }
    period
}

fn work(period: &Period, shaft: usize, source: Source) -> f64 {
    period.accounts.shafts[shaft].work(source)
}

fn short(until: f64, step: f64) -> Run {
    Run {
        until,
        every: until / 8.0,
        step: Some(step),
        stepping: Stepping::Verlet,
        run_in: RunIn::None,
        ..Run::default()
    }
}

/// A pair of gears hands on what its shaft gets, a coupling what it does not keep or lose, two chains what the shaft between them turns over: each shaft
/// balances by itself.
#[test]
fn each_shaft_balances() {
    let geared = TwoSprockets {
        after: "[route]\npretension = \"600 N\"
            [[shafts]]\nname = \"pump\"\ninertia = 1e-3\nload = [{ kind = \"constant\", torque = 5 }]
            [[gears]]\nname = \"pump drive\"\nbetween = [\"driven\", \"pump\"]\nteeth = [30, 20]",
        ..SOFT
    };
    let coupled = TwoSprockets {
        after: "[route]\npretension = \"600 N\"
            [[shafts]]\nname = \"fan\"\ninertia = 1e-2\nload = [{ kind = \"constant\", torque = -5 }]
            [[couplings]]\nname = \"tyre\"\nbetween = [\"driven\", \"fan\"]\nstiffness = 500\ndamping = 0.5",
        ..SOFT
    };
    for scene in [geared.scene(), coupled.scene()] {
        let period = shafts_balance(&scene, &short(0.02, 5e-6));
        // The motion that is given supplies what the chain takes.
        let [motion, chain] = [Source::Motion, Source::Chains].map(|it| work(&period, 0, it));
        assert!(motion > 0.0 && (motion + chain).abs() < 1e-9 * motion);
    }
    let period = shafts_balance(&geared.scene(), &short(0.02, 5e-6));
    let [driven, pump] = [1, 2].map(|shaft| work(&period, shaft, Source::Gears));
    assert!((driven + pump).abs() < 1e-9 * driven.abs() && pump.abs() > 0.01);
    let two_stages = Scene::preset("two_stage_timing").unwrap();
    shafts_balance(&two_stages, &short(5e-3, 1e-6));
}

/// Numbers of the account: means, then extremes with their times.
fn numbers(summary: &Summary) -> Vec<f64> {
    let bodies = summary.bodies();
    let both = |it: &Extremes| [it.least, it.least_at, it.greatest, it.greatest_at];
    let mut numbers = Vec::new();
    for it in &bodies.sprockets {
        numbers.extend([it.speed, it.torque, it.power]);
        numbers.extend(it.force.mean);
        for seen in [&it.force.extremes, &it.contact, &it.speeds, &it.lag] {
            numbers.extend(both(seen));
        }
        numbers.extend(it.force.usual_greatest.map(|it| it.value));
    }
    for (_, force) in &bodies.guides {
        numbers.extend(force.mean);
        numbers.extend(both(&force.extremes));
    }
    for it in &bodies.tensioners {
        numbers.extend([it.mean, it.push]);
        numbers.extend(both(&it.travel));
    }
    numbers.extend(both(&summary.link_tension()));
    numbers.extend([summary.energy_supplied(), summary.energy_dissipated()]);
    numbers.push(summary.duration());
    for span in summary.steadiness().into_iter().flatten() {
        for it in [span.mean, span.deviation, span.p1, span.p99] {
            numbers.extend([it.value, it.half_width]);
        }
    }
    numbers
}

/// Samples at any interval, a mesh period and 1.01 of it among them, move neither means nor extremes nor statistics of spans. The shafts balance.
fn samples_move_nothing(preset: &str, until: f64, step: f64, stepping: Stepping) {
    let scene = Scene::preset(preset).unwrap();
    let drive = scene.drive().unwrap();
    let mesh = drive.assemble().unwrap().fastest_tooth();
    let mut found: Vec<(u64, Vec<f64>)> = Vec::new();
    let default = until / 100.0;
    let intervals = [default, default / 2.0, default / 3.0, mesh, 1.01 * mesh];
    for every in intervals {
        let run = Run {
            every: every.min(until),
            until,
            stepping,
            run_in: RunIn::Time(until / 4.0),
            ..short(until, step)
        };
        let (simulation, summary, _) = whole(&scene, &run);
        found.push((simulation.statistics().steps, numbers(&summary)));
    }
    let (steps, first) = &found[0];
    assert!(first.iter().filter(|it| it.is_finite()).count() > 20);
    for (other, numbers) in &found {
        assert_eq!(steps, other, "{preset}");
        for (place, (a, b)) in first.iter().zip(numbers).enumerate() {
            let same = a.to_bits() == b.to_bits() || (a - b).abs() <= 1e-12 * a.abs();
            assert!(same, "{preset}, number {place}: {a} {b}");
        }
    }
    let run = Run {
        stepping,
        ..short(until, step)
    };
    shafts_balance(&scene, &run);
}

#[test]
fn no_statement_knows_the_samples() {
    samples_move_nothing("timing_drive", 8e-3, 3e-6, Stepping::Verlet);
    samples_move_nothing("industrial_16b", 0.02, 1e-5, Stepping::Verlet);
}

#[test]
#[ignore = "slow: every driven preset, with intervals"]
fn no_statement_of_any_preset_knows_the_samples() {
    use Stepping::{ImplicitDamping, Verlet};
    for (preset, until, step, stepping) in [
        ("timing_drive", 0.05, 3e-6, Verlet),
        ("two_stage_timing", 0.03, 2e-6, Verlet),
        ("industrial_16b", 0.1, 1e-5, Verlet),
        ("marine_two_sprockets", 0.05, 1e-5, Verlet),
        ("marine_engine", 0.4, 8e-6, Verlet),
        ("marine_engine_bare", 0.1, 8e-6, Verlet),
        ("marine_engine_oil", 0.1, 8e-6, Verlet),
        ("bicycle", 0.05, 2e-6, ImplicitDamping),
        ("bicycle_crank", 0.05, 2e-6, ImplicitDamping),
        ("bicycle_slack", 0.05, 2e-6, ImplicitDamping),
        ("bicycle_derailleur", 0.05, 4e-6, Verlet),
        ("motorcycle", 0.02, 2e-6, ImplicitDamping),
    ] {
        samples_move_nothing(preset, until, step, stepping);
    }
}

/// S1: samples at the mesh period made 15.251 kW of a driver's 15.076, and 249.3 N of the 244.0 N of its slack side.
#[test]
fn a_mesh_period_between_samples_makes_no_power() {
    let scene = Scene::preset("industrial_16b").unwrap();
    let run = Run {
        every: 2.631_578_9e-3,
        run_in: RunIn::Time(0.1),
        ..short(0.2, 1e-5)
    };
    let (_, summary, period) = whole(&scene, &run);
    let sprockets = summary.bodies().sprockets;
    let lost: f64 = summary.energy_dissipated() / period.length();
    let [driver, driven] = [0, 1].map(|it| sprockets[it].power.abs());
    assert!(driver > driven, "{driver} {driven}");
    // What the driver gives and the driven takes not is lost in the chain, but for what springs keep.
    assert!(
        (driver - driven - lost).abs() < 0.002 * driver,
        "{driver} {driven} {lost}"
    );
}

/// S2: no sample lies beyond the extremes of steps.
#[test]
fn extremes_hold_those_of_samples() {
    let scene = Scene::preset("marine_two_sprockets").unwrap();
    let run = Run {
        every: 5e-5,
        ..short(0.02, 1e-5)
    };
    let drive = scene.drive().unwrap();
    let watched = Run {
        watched: true,
        ..run
    };
    let mut simulation = Simulation::start(&drive, &watched).unwrap();
    let mut summary = Summary::new(&simulation);
    let mut sampled = [0.0_f64; 3];
    while let Some(seen) = simulation.next_sample().unwrap() {
        let force = seen.sprocket_force_x[0].hypot(seen.sprocket_force_y[0]);
        let link = seen.link_tension.iter().copied().fold(0.0, f64::max);
        let contact = seen.contact_force.iter().copied().fold(0.0, f64::max);
        for (greatest, value) in sampled.iter_mut().zip([force, link, contact]) {
            *greatest = greatest.max(value);
        }
        summary.take(&simulation);
    }
    summary.end(&simulation);
    let followed = [
        summary.bodies().sprockets[0].force.extremes.greatest,
        summary.link_tension().greatest,
        summary.greatest_contact(),
    ];
    for (k, (sampled, followed)) in sampled.iter().zip(followed).enumerate() {
        // Between steps forces are blended, and a spring may be a hair longer than at either end.
        assert!(
            followed > (1.0 - 1e-3) * sampled,
            "{k}: {sampled} {followed}"
        );
        assert!(followed < 2.0 * sampled, "{k}: {sampled} {followed}");
    }
}

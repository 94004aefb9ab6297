//! Many drives at once are the same drives one at a time, in their order, and none is lost.

use std::error::Error;
use std::sync::atomic::AtomicBool;

use chaindrive::record::SpanStatistics;
use chaindrive::scene::{Datum, Scene};
use chaindrive::sweep::{Account, Answer, Coordinate, Coordinator, Go, Outcome, ResultQuantity};
use chaindrive::sweep::{Setting, Statistic, Sweep, SweepArrays, SweepError, SweepMemory, Worker};
use chaindrive::{Channel, Run, Simulation, Summary};

type Checked = Result<(), Box<dyn Error>>;

fn texts<const N: usize>(path: &str, values: [&str; N]) -> (String, Vec<Setting>) {
    let settings = values.map(|value| Setting::Text(value.to_owned()));
    (path.to_owned(), settings.to_vec())
}

fn marine(until: &str) -> Result<Scene, Box<dyn Error>> {
    let scene = Scene::preset("marine_two_sprockets")?;
    Ok(scene
        .replace("run.until", until)?
        .replace("run.run_in", "0 s")?)
}

fn speed_and_pretension() -> [(String, Vec<Setting>); 2] {
    [
        texts(
            "sprockets.crank.motion.speed",
            ["-80 rpm", "-100 rpm", "-127 rpm"],
        ),
        texts("route.pretension", ["10 kN", "15 kN"]),
    ]
}

/// The outcomes without their times, as bits.
fn bits(outcome: &Outcome) -> Vec<(&'static str, Vec<u64>)> {
    let Outcome::Done(account) = outcome else {
        return Vec::new();
    };
    let same = |quantity: ResultQuantity| !matches!(quantity, ResultQuantity::Statistic(it) if it.is_measured());
    let entries = account.entries.iter().filter(|it| same(it.quantity));
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect();
    entries
        .map(|it| (it.quantity.name(), bits(&it.values)))
        .collect()
}

#[test]
fn any_number_of_threads_gives_the_bits_of_the_runs_one_by_one() -> Checked {
    let record = ["link_tension".to_owned()];
    let sweep = Sweep::new(&marine("4 ms")?, &speed_and_pretension(), &record)?;
    let never = AtomicBool::new(false);
    let alone: Vec<Outcome> = (0..sweep.len())
        .map(|i| sweep.carry_out(i, &never))
        .collect();
    for jobs in [1, 2, 5] {
        let together = sweep.run(Some(jobs), |_| Go::On)?;
        for (index, (one, other)) in alone.iter().zip(&together).enumerate() {
            assert!(!bits(one).is_empty());
            assert_eq!(bits(one), bits(other), "variant {index} on {jobs} threads");
        }
    }
    // Tasks of any size, whose answers travel as bytes.
    for size in [1, 4, 6] {
        let mut memory = SweepMemory::new(&sweep, size);
        let worker = Worker::in_memory(sweep.recipe(), size)?;
        for task in memory.open_tasks()?.into_iter().rev() {
            let answer = worker.carry_out(task, &never)?.unwrap_or_default();
            memory.take(Answer::from_bytes(&answer.to_bytes())?)?;
        }
        for (one, other) in alone.iter().zip(&memory.into_outcomes()) {
            assert_eq!(bits(one), bits(other), "tasks of {size}");
        }
    }
    Ok(())
}

/// The last variant by hand: scene, simulation, summary.
#[test]
fn a_variant_is_the_run_of_its_scene() -> Checked {
    let record = ["span_tension".to_owned()];
    let sweep = Sweep::new(&marine("4 ms")?, &speed_and_pretension(), &record)?;
    let outcomes = sweep.run(Some(2), |_| Go::On)?;
    let scene = marine("4 ms")?
        .replace("sprockets.crank.motion.speed", "-127 rpm")?
        .replace("route.pretension", "15 kN")?;
    let step = match &outcomes[5] {
        Outcome::Done(account) => account
            .entries
            .iter()
            .find(|it| it.quantity.name() == "step_chosen"),
        _ => None,
    };
    let run = Run {
        watched: true,
        step: step.map(|it| it.values[0]),
        ..Run::suggested(&scene.run_defaults())
    };
    let mut simulation = Simulation::start(&scene.drive()?, &run)?;
    let mut summary = Summary::new(&simulation);
    let mut tension = Vec::new();
    while simulation.next_sample()?.is_some() {
        summary.take(&simulation);
        tension.extend_from_slice(&simulation.observation().span_tension);
    }
    summary.end(&simulation);
    let stacked = sweep.stack(&outcomes);
    let last = |quantity: ResultQuantity| {
        let found = stacked.quantities.iter().find(|it| it.quantity == quantity);
        let values = found.map(|it| it.values.chunks(it.values.len() / 6).last());
        values.flatten().unwrap_or_default().to_vec()
    };
    assert_eq!(last(ResultQuantity::Channel(Channel::SpanTension)), tension);
    let means: Vec<f64> = summary.spans.iter().map(SpanStatistics::mean).collect();
    assert_eq!(
        last(ResultQuantity::Statistic(Statistic::SpanTensionMean)),
        means
    );
    let largest = ResultQuantity::Statistic(Statistic::ContactForceMax);
    assert_eq!(last(largest), [summary.greatest_contact()]);
    Ok(())
}

/// A value that one path puts in and another one replaces would be the same in every variant.
#[test]
fn a_path_that_another_one_replaces_is_refused() -> Checked {
    let steps = texts("run.step", ["1 us", "2 us"]);
    let tables = texts("run", ["{}", "{ method = 'rk4' }"]);
    let scene = marine("1 ms")?;
    let covered = Sweep::new(&scene, &[steps.clone(), tables.clone()], &[]);
    assert!(matches!(covered, Err(SweepError::Covered { .. })));
    assert_eq!(Sweep::new(&scene, &[tables, steps.clone()], &[])?.len(), 4);

    let asking = scene.replace("run.accuracy", "1 %")?;
    let chosen = Sweep::new(&asking, std::slice::from_ref(&steps), &[]);
    assert!(matches!(chosen, Err(SweepError::Chosen { .. })));
    for vary in [
        [steps.clone(), texts("run.accuracy", ["1 %", "2 %"])],
        [texts("run.accuracy", ["1 %", "2 %"]), steps.clone()],
    ] {
        let chosen = Sweep::new(&scene, &vary, &[]);
        assert!(matches!(chosen, Err(SweepError::Chosen { .. })));
    }
    Ok(())
}

#[test]
fn dimensions_are_named_by_the_end_of_their_path_and_keep_si_values() -> Checked {
    let vary = [
        texts("sprockets.crank.motion.speed", ["-60 rpm", "-120 rpm"]),
        texts("sprockets.crank.teeth", ["60", "59"]),
        texts("sprockets[1].teeth", ["40"]),
        texts("run.method", ["verlet", "rk4"]),
        texts("gravity", ["[0, 0]", "[0, -9.81]"]),
        texts("gravity[1]", ["-1 m/s^2"]),
        texts("chain.links", ["112"]),
    ];
    let sweep = Sweep::new(&marine("1 ms")?, &vary, &[])?;
    let names: Vec<&str> = sweep.dimensions().iter().map(|d| d.name.as_str()).collect();
    let expected = [
        "speed",
        "crank_teeth",
        "sprockets_1_teeth",
        "method",
        "gravity",
        "gravity_1",
        "links",
    ];
    assert_eq!(names, expected);
    let turn = -2.0 * std::f64::consts::PI;
    let values = |index: usize| &sweep.dimensions()[index].values;
    assert_eq!(values(0), &Coordinate::Numbers(vec![turn, 2.0 * turn]));
    assert_eq!(values(1), &Coordinate::Whole(vec![60, 59]));
    assert_eq!(
        values(3),
        &Coordinate::Texts(vec!["verlet".into(), "rk4".into()])
    );
    assert_eq!(
        values(4),
        &Coordinate::Texts(vec!["[0, 0]".into(), "[0, -9.81]".into()])
    );
    assert_eq!(sweep.dimensions()[0].unit, Some("rad/s"));
    assert_eq!(sweep.dimensions()[1].unit, None);
    // The last path varies fastest.
    assert_eq!(sweep.indices(1), [0, 0, 0, 0, 1, 0, 0]);
    let second = sweep.variant(2)?;
    assert_eq!(second.datum("run.method"), Some(Datum::Text("rk4".into())));
    Ok(())
}

fn texts_of(stacked: &SweepArrays, name: &str) -> Vec<String> {
    let found = stacked.texts.iter().find(|it| it.name == name);
    found.map(|it| it.texts.clone()).unwrap_or_default()
}

/// 111 links are too few for two sprockets at this distance; a torque that no machine has ends a run.
#[test]
fn a_variant_that_fails_leaves_a_message_and_the_others() -> Checked {
    let scene = marine("1 ms")?.replace("settle", "false")?;
    let vary = [
        texts("chain.links", ["112", "60"]),
        texts("sprockets.camshaft.load[0].torque", ["5 kN m", "1e200 N m"]),
    ];
    let sweep = Sweep::new(&scene, &vary, &["link_tension".to_owned()])?;
    let outcomes = sweep.run(None, |_| Go::On)?;
    let stacked = sweep.stack(&outcomes);
    let texts = |name| texts_of(&stacked, name);
    let errors = texts("error");
    assert_eq!(errors[0], "");
    assert!(errors[1].contains("no longer finite"), "{errors:?}");
    for error in &errors[2..] {
        assert!(error.contains("links"), "{error}");
    }
    assert_eq!(texts("verdict"), ["caution", "", "", ""]);
    assert_eq!(
        texts("reasons"),
        ["too-short statistics-unknown not-estimated", "", "", ""]
    );
    for it in &stacked.quantities {
        let mut blocks = it.values.chunks(it.values.len() / 4);
        let good = blocks.next().unwrap_or_default();
        let name = it.quantity.name();
        if name.ends_with("half_width") || name.starts_with("impact_") && name != "impact_count" {
            // So few samples say nothing about their mean, and no impact has ended.
            assert!(it.values.iter().all(|value| value.is_nan()), "{name}");
            continue;
        }
        assert!(
            !good.is_empty() && good.iter().all(|value| value.is_finite()),
            "{name}"
        );
        assert!(blocks.flatten().all(|value| value.is_nan()), "{name}");
    }
    Ok(())
}

/// Rings of 20 and 24 links, runs of 2 and 3 ms: what one has less is NaN.
#[test]
fn the_longest_run_and_the_longest_chain_decide_about_the_size() -> Checked {
    let scene = Scene::preset("spinning_ring")?.replace("run.every", "1 ms")?;
    let vary = [
        texts("chain.links", ["24", "20"]),
        texts("run.until", ["2 ms", "3 ms"]),
    ];
    let sweep = Sweep::new(&scene, &vary, &["link_tension".to_owned()])?;
    let stacked = sweep.stack(&sweep.run(Some(2), |_| Go::On)?);
    let tension = ResultQuantity::Channel(Channel::LinkTension);
    let found = stacked.quantities.iter().find(|it| it.quantity == tension);
    let found = found.ok_or("the channel that was asked for")?;
    assert_eq!(found.dims, ["links", "until", "time", "link"]);
    assert_eq!(found.shape, [2, 2, 4, 24]);
    assert_eq!(stacked.time.as_deref().map(<[f64]>::len), Some(4));
    let at = |links: usize, until: usize, time: usize, link: usize| {
        found.values[((links * 2 + until) * 4 + time) * 24 + link]
    };
    assert!(at(0, 1, 3, 23).is_finite() && at(1, 1, 3, 19).is_finite());
    assert!(at(0, 0, 3, 0).is_nan() && at(1, 1, 0, 20).is_nan());
    Ok(())
}

#[test]
fn stopped_it_keeps_what_is_finished() -> Checked {
    let scene = Scene::preset("spinning_ring")?;
    let vary = [texts(
        "run.until",
        ["1 ms", "2 ms", "1e4 s", "2e4 s", "3e4 s"],
    )];
    let sweep = Sweep::new(&scene, &vary, &[])?;
    let enough = |progress: chaindrive::sweep::Progress<'_>| {
        if progress.finished < 2 {
            Go::On
        } else {
            Go::NoFurther
        }
    };
    let outcomes = sweep.run(Some(2), enough)?;
    assert!(
        outcomes[..2]
            .iter()
            .all(|it| matches!(it, Outcome::Done(_)))
    );
    assert!(outcomes[2..].iter().all(|it| *it == Outcome::Open));
    let errors = texts_of(&sweep.stack(&outcomes), "error");
    assert!(
        errors[1].is_empty() && errors[4].contains("stopped"),
        "{errors:?}"
    );
    Ok(())
}

#[test]
fn what_is_not_of_a_scene_is_refused_before_anything_runs() -> Checked {
    let scene = marine("1 ms")?;
    let refuse = |vary: &[(String, Vec<Setting>)], record: &[&str]| {
        let record: Vec<String> = record.iter().map(|&name| name.to_owned()).collect();
        Sweep::new(&scene, vary, &record)
            .map(drop)
            .map_err(|error| error.to_string())
    };
    let cases = [
        (vec![], vec![], "nothing is varied"),
        (vec![texts("chain.links", [])], vec![], "no values"),
        (vec![texts("chain.lynx", ["3"])], vec![], "lynx"),
        (vec![texts("sprockets.crnk.teeth", ["3"])], vec![], "crank"),
        (
            vec![texts("route.pretension", ["1 kN", "2 mm"])],
            vec![],
            "is a length",
        ),
        (
            vec![texts("route.pretension", ["1 kN", "1000 N"])],
            vec![],
            "the value 1000.0 stands twice",
        ),
        (
            vec![
                texts("sprockets.crank.teeth", ["60"]),
                texts("sprockets[0].teeth", ["61"]),
            ],
            vec![],
            "varied twice",
        ),
        (
            vec![texts("chain.links", ["112"])],
            vec!["link_tensoin"],
            "did you mean",
        ),
        (
            vec![texts("run.every", ["1 ms", "2 ms"])],
            vec!["link_tension"],
            "interval between samples",
        ),
    ];
    for (vary, record, words) in cases {
        let message = refuse(&vary, &record).err().ok_or(words)?;
        assert!(message.contains(words), "{message}");
    }
    let many: Vec<Setting> = (0..2000).map(|n| Setting::Json(n.into())).collect();
    let vary = [
        ("chain.links".to_owned(), many.clone()),
        ("sprockets.crank.teeth".to_owned(), many),
    ];
    let refused = Sweep::new(&scene, &vary, &[]);
    assert!(matches!(refused, Err(SweepError::TooMany { .. })));
    Ok(())
}

#[test]
fn a_range_has_both_ends_and_equal_distances() -> Checked {
    let scene = marine("1 ms")?;
    let speed = "sprockets.crank.motion.speed";
    let range = Setting::range(&scene, speed, "-80 rpm", "-140 rpm", 4)?;
    let by_hand = texts(speed, ["-80 rpm", "-100 rpm", "-120 rpm", "-140 rpm"]).1;
    let numbers = |settings| -> Result<Vec<f64>, Box<dyn Error>> {
        let sweep = Sweep::new(&scene, &[(speed.to_owned(), settings)], &[])?;
        match &sweep.dimensions()[0].values {
            Coordinate::Numbers(numbers) => Ok(numbers.clone()),
            other => Err(format!("{other:?}").into()),
        }
    };
    let (range, by_hand) = (numbers(range)?, numbers(by_hand)?);
    assert_eq!((range[0], range[3]), (by_hand[0], by_hand[3]));
    let close = |(one, other): (&f64, &f64)| (one - other).abs() < 1e-14;
    assert!(range.iter().zip(&by_hand).all(close));

    let teeth = Setting::range(&scene, "sprockets.crank.teeth", "60", "54", 4)?;
    let expected = [60, 58, 56, 54].map(|teeth| Setting::Json(teeth.into()));
    assert_eq!(teeth, expected);
    let zero = Setting::range(&scene, "route.pretension", "0", "1 kN", 2)?;
    assert_eq!(zero[0], Setting::Json(0.0.into()));

    let cases = [
        (speed, "-80", "-140 rpm", 4, "give `-80` its unit too"),
        (speed, "-80 rpm", "-140 rpm", 1, "2 to"),
        (speed, "-80 rpm", "-140 mm", 4, "is a length"),
        ("sprockets.crank.teeth", "60", "54", 3, ""),
        ("sprockets.crank.teeth", "60", "54", 5, "do not fit evenly"),
        ("sprockets.crank.name", "one", "two", 5, "no number"),
        ("sprockets.crnk.teeth", "1", "2", 2, "crank"),
    ];
    for (path, first, last, count, words) in cases {
        match Setting::range(&scene, path, first, last, count) {
            Ok(_) => assert_eq!(words, "", "{path} = {first}..{last}/{count}"),
            Err(error) => {
                let message = error.to_string();
                assert!(!words.is_empty() && message.contains(words), "{message}");
            }
        }
    }
    Ok(())
}

#[test]
fn the_report_tells_every_variant_or_the_extremes_of_many() -> Checked {
    let scene = Scene::preset("spinning_ring")?.replace("run.until", "1 ms")?;
    let path = "chain.start.speed";
    let speeds = texts(path, ["300 rad/s", "400 rad/s", "1e300 rad/s"]);
    let sweep = Sweep::new(&scene, &[speeds], &[])?;
    let outcomes = sweep.run(None, |_| Go::On)?;
    let report = sweep.report(&outcomes).to_string();
    let lines: Vec<&str> = report.lines().collect();
    assert!(lines[0].contains("speed [rad/s]"), "{report}");
    assert!(lines[1].trim_start().starts_with("300 "), "{report}");
    assert!(lines[3].ends_with("failed"), "{report}");
    assert_eq!(lines[4], "variants: 2 of 3 done, 1 failed");
    let failures = sweep.failures(&outcomes);
    assert!(failures.len() == 1 && failures[0].starts_with("speed = 1.0e300 rad/s: "));

    let many = Setting::range(&scene, path, "300 rad/s", "349 rad/s", 50)?;
    let sweep = Sweep::new(&scene, &[(path.to_owned(), many)], &[])?;
    let report = sweep.report(&sweep.run(None, |_| Go::On)?).to_string();
    let told = |heading: &str| {
        let lines = report.lines().filter(|line| line.starts_with(heading));
        lines.count()
    };
    assert_eq!(told("unaccounted [J]"), 2, "least and greatest: {report}");
    assert_eq!(told("span max"), 0, "a ring has no spans: {report}");
    assert_eq!(report.lines().last(), Some("variants: 50 of 50 done"));
    Ok(())
}

#[test]
fn logged_contacts_are_counted_by_kind() -> Checked {
    let scene = marine("2 ms")?.replace("run.events", "[\"teeth\"]")?;
    let vary = [texts("route.pretension", ["10 kN", "20 kN"])];
    let sweep = Sweep::new(&scene, &vary, &[])?;
    let stacked = sweep.stack(&sweep.run(None, |_| Go::On)?);
    let count = ResultQuantity::from_name("contact_count").ok_or("a statistic")?;
    let found = stacked.quantities.iter().find(|it| it.quantity == count);
    let found = found.ok_or("contacts were logged")?;
    assert_eq!(found.dims, ["pretension", "contact_kind"]);
    assert!(found.values[0] > 40.0 && found.values[1] == 0.0);
    Ok(())
}

/// An account that comes back from elsewhere stacks like one that never left.
#[test]
fn quantities_are_found_by_their_names() {
    for &statistic in Statistic::ALL {
        let quantity = ResultQuantity::Statistic(statistic);
        assert_eq!(ResultQuantity::from_name(quantity.name()), Some(quantity));
    }
    for &channel in Channel::ALL {
        let quantity = ResultQuantity::Channel(channel);
        assert_eq!(ResultQuantity::from_name(quantity.name()), Some(quantity));
    }
    assert_eq!(Account::default().labels_along("span"), None);
}

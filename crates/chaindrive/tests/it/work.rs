//! The work-precision study: what it measures is what theory and other runs say, and twice the same.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::precision::{Divergence, Row, Study, Table, Variant, work_precision};
use chaindrive::{Assembled, Run, SimulationError, Stepping};

use crate::judged::bare;

fn start(scene: &str) -> Assembled {
    bare(scene).drive().unwrap().assemble().unwrap()
}

fn variant(stepping: Stepping, step: f64) -> Variant {
    Variant {
        stepping,
        step: Some(step),
        tolerance: None,
        onset_depth: None,
    }
}

fn studied(scene: &str, until: f64, variants: Vec<Variant>) -> Table {
    let study = Study {
        variants,
        until: Some(until),
        repeats: 1,
        replicates: 1,
    };
    work_precision(&start(scene), &Run::default(), &study, &|| false).unwrap()
}

/// The numbers of a row but its times, as bits.
fn bits(row: &Row) -> Vec<u64> {
    let timed = ["wall", "cpu", "real_time_factor"];
    let numbers = row.numbers();
    let kept = numbers.iter().filter(|n| !timed.contains(&n.name));
    kept.map(|number| number.value.to_bits()).collect()
}

#[test]
fn everything_but_the_times_is_the_same_to_the_last_bit() {
    let study = || {
        let variants = vec![
            variant(Stepping::Verlet, 1e-5),
            variant(Stepping::Rk4, 5e-6),
        ];
        studied("marine_two_sprockets", 4e-3, variants)
    };
    let (first, second) = (study(), study());
    for (a, b) in first.rows.iter().zip(&second.rows) {
        assert_eq!(bits(a), bits(b));
        assert!(a.wall > 0.0 && a.cpu >= 0.0);
    }
    assert_eq!(first.horizon, second.horizon);
    for (a, b) in [
        (first.agreement, second.agreement),
        (first.spread, second.spread),
    ] {
        assert_eq!(
            a.columns().map(|(_, value)| value.to_bits()),
            b.columns().map(|(_, value)| value.to_bits())
        );
    }
}

/// On the smooth motion of a free ring the table shows the orders that theory promises: two and four.
#[test]
fn smooth_motion_shows_the_orders_of_the_methods() {
    for (stepping, step, order) in [(Stepping::Verlet, 4e-5, 2.0), (Stepping::Rk4, 8e-5, 4.0)] {
        let variants = vec![variant(stepping, step), variant(stepping, 0.5 * step)];
        let table = studied("spinning_ring", 0.01, variants);
        let [coarse, fine] = [0, 1].map(|row: usize| table.rows[row].errors.tension);
        let found = (coarse / fine).log2();
        assert!((found - order).abs() < 0.3, "{stepping:?}: {found}");
    }
}

/// Reference and check, methods of different families, agree far below the errors of the rows.
#[test]
fn the_reference_is_confirmed_by_another_method() {
    let table = studied(
        "marine_two_sprockets",
        6e-3,
        vec![
            variant(Stepping::Verlet, 3e-5),
            variant(Stepping::Verlet, 1.5e-5),
        ],
    );
    assert_ne!(table.reference.stepping, table.check.stepping);
    let [coarse, fine] = [0, 1].map(|row: usize| &table.rows[row]);
    assert!(table.agreement.tension < 0.05 * fine.errors.tension);
    assert!(fine.errors.tension < coarse.errors.tension);
    assert!(fine.statistics.evaluations > coarse.statistics.evaluations);
    assert!(!coarse.reference_limited);
    assert!(table.mean_tension > 10e3 && table.mean_tension < 30e3);
}

#[test]
fn a_method_that_fails_keeps_its_row_and_its_message() {
    let table = studied(
        "spinning_ring",
        2e-3,
        vec![
            variant(Stepping::Verlet, 1.0),
            variant(Stepping::ImplicitDamping, 1e-6),
            variant(Stepping::Verlet, 1e-5),
        ],
    );
    assert_eq!(table.rows.len(), 3);
    let [large, implicit, sound] = [0, 1, 2].map(|row: usize| &table.rows[row]);
    assert!(
        large.failure.as_deref().unwrap().contains("step"),
        "{large:?}"
    );
    assert!(implicit.remark().contains("choose verlet"), "{implicit:?}");
    assert_eq!(sound.failure, None);
    let mut csv = Vec::new();
    table.write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let heading = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 3 + 2, "and agreement and spread");
    let cell = |row: usize, name: &str| {
        let column = heading.iter().position(|cell| cell == name).unwrap();
        rows[row][column].to_owned()
    };
    assert_eq!(cell(0, "wall"), "");
    assert!(cell(0, "remark").contains("step"));
    let error: f64 = cell(2, "error_span_tension").parse().unwrap();
    assert_eq!(error.to_bits(), sound.errors.tension.to_bits());
    assert_eq!(cell(2, "steps"), sound.statistics.steps.to_string());
    assert!(table.to_string().contains("verlet, step 10 µs"));
}

/// The twins of the slack bicycle part within the window: pointwise errors end there, and the statistics of the
/// replicates differ by more than rounding.
#[test]
fn beyond_the_horizon_replicates_give_the_spread() {
    let table = studied(
        "bicycle_slack",
        8e-3,
        vec![variant(Stepping::ImplicitDamping, 2e-6)],
    );
    assert!(matches!(table.horizon.all, Divergence::Measured { at } if at < 8e-3));
    assert!(table.spread.rms > 1e-6, "{:?}", table.spread);
    let row = &table.rows[0];
    assert!(row.errors.tight_tension > 0.0 && row.errors.tight_tension < 0.05);
    assert!(row.statistics.solves > 0);
}

#[test]
fn settings_out_of_range_are_refused() {
    let ring = start("spinning_ring");
    let refused = |study: Study| work_precision(&ring, &Run::default(), &study, &|| false);
    for (name, study) in [
        (
            "repeats",
            Study {
                repeats: 0,
                ..Study::default()
            },
        ),
        (
            "replicates",
            Study {
                replicates: 0,
                ..Study::default()
            },
        ),
        (
            "until",
            Study {
                until: Some(-1.0),
                ..Study::default()
            },
        ),
    ] {
        let error = refused(study).unwrap_err();
        assert!(matches!(error, SimulationError::Setting { name: named, .. } if named == name));
    }
    let stopped = work_precision(&ring, &Run::default(), &Study::default(), &|| true);
    assert!(matches!(stopped, Err(SimulationError::Interrupted)));
}

//! Thresholds of the energy balance at which the verdict turns against a run.

use super::*;
use chaindrive_mechanics::MotionConflict;

use crate::precision::Gap;
use crate::summary::ConfidenceInterval;

/// A drive that takes in 100 J and loses 2 J.
fn ledger_with(residual: f64) -> Ledger {
    Ledger {
        residual,
        losses: 2.0,
        moved: 100.0,
        supplied: 100.0,
        delivered: 98.0,
        supplied_back: 0.0,
        delivered_back: 0.0,
        exchanged: 198.0,
        by_loads: -98.0,
        loads_exchanged: 98.0,
        kinetic: 10.0,
        rounding: 1e-9,
        teeth: 1000.0,
    }
}

fn names(found: &Ledger, steps: u64) -> Vec<&'static str> {
    ledger(found, steps).iter().map(Reason::name).collect()
}

/// Defect A5: 1.1 J out of nowhere are 1 % of the energy moved, and more than half of the losses.
#[test]
fn what_is_missing_is_judged_by_the_losses() {
    assert!(names(&ledger_with(0.19), 1000).is_empty());
    assert_eq!(names(&ledger_with(-0.21), 1000), ["losses-uncertain"]);
    assert_eq!(names(&ledger_with(0.99), 1000), ["losses-uncertain"]);
    assert_eq!(names(&ledger_with(-1.01), 1000), ["losses-wrong"]);
    assert_eq!(names(&ledger_with(-9.9), 1000), ["losses-wrong"]);
    assert_eq!(names(&ledger_with(-10.1), 1000), ["energy-missing"]);
}

/// A drive without losses to speak of may err by a ten-thousandth of what it transmits.
#[test]
fn losses_too_small_to_matter_are_taken_for_a_ten_thousandth() {
    let frictionless = |residual| Ledger {
        losses: 0.0,
        ..ledger_with(residual)
    };
    assert!(names(&frictionless(-0.9e-3), 1000).is_empty());
    assert_eq!(names(&frictionless(-1.1e-3), 1000), ["losses-uncertain"]);
    assert_eq!(names(&frictionless(-5.1e-3), 1000), ["losses-wrong"]);
}

#[test]
fn more_out_than_in_is_distrusted() {
    let both = ["losses-wrong", "efficiency-above-one"];
    assert_eq!(names(&ledger_with(2.1), 1000), both);
    assert_eq!(names(&ledger_with(1.9), 1000), ["losses-wrong"]);
    // A driver that swings to and fro supplies next to nothing in the end.
    let swinging = Ledger {
        supplied: 10.0,
        supplied_back: 90.0,
        ..ledger_with(2.1)
    };
    assert_eq!(names(&swinging, 1000), ["losses-wrong"]);
}

/// Defect: 1 ns of a drive had an efficiency of 1639 %, since springs in which friction stands gave back what they had taken before.
#[test]
fn a_start_has_no_efficiency() {
    let short = Ledger {
        teeth: 2.9,
        ..ledger_with(0.0)
    };
    let springs = Ledger {
        losses: -2.0,
        delivered: 102.0,
        ..ledger_with(0.0)
    };
    let spun_up = Ledger {
        delivered: 48.0,
        ..ledger_with(0.0)
    };
    for (ledger, why) in [
        (short, "three teeth"),
        (springs, "gave back"),
        (spun_up, "motion"),
    ] {
        assert!(ledger.efficiency().is_none());
        assert!(ledger.unknown().unwrap().contains(why), "{why}");
    }
    let unknown_teeth = Ledger {
        teeth: f64::NAN,
        ..ledger_with(0.0)
    };
    assert!(unknown_teeth.efficiency().is_some());
}

/// Valves give back over their cams what was put into their springs. Of the 100 J that were put in for good a record has up to 20 more or less, by
/// where within a swing it ends: 2 J lost of 80 to 120 are 1.67 to 2.5 %.
#[test]
fn what_goes_to_and_fro_makes_an_efficiency_uncertain_and_not_unknown() {
    let valves = |back: f64| Ledger {
        supplied_back: back,
        delivered_back: back,
        exchanged: 2000.0,
        ..ledger_with(0.0)
    };
    let [efficiency, uncertain] = valves(20.0).efficiency().unwrap();
    assert!((efficiency - 0.98).abs() < 1e-12 && (uncertain - 0.004).abs() < 1e-12);
    assert_eq!(valves(20.0).unknown(), None);
    // More comes back at times than is taken out in the end; or the losses are a fifth, and 51 J of 100 J swing.
    let lossy = Ledger {
        losses: 20.0,
        delivered: 80.0,
        ..valves(51.0)
    };
    for unknown in [valves(99.0), lossy] {
        assert!(unknown.efficiency().is_none());
        assert!(unknown.unknown().unwrap().contains("to and fro"));
    }
}

/// A free motion loses little and transmits nothing: a thousandth of what swings may be missing.
#[test]
fn a_free_motion_is_judged_by_what_swings() {
    let free = |residual| Ledger {
        losses: 1e-3,
        supplied: 0.0,
        exchanged: 0.0,
        ..ledger_with(residual)
    };
    assert!(names(&free(0.1), 1000).is_empty());
    assert_eq!(names(&free(10.1), 1000), ["energy-missing"]);
    // A ring that spins in balance: nothing swings but the error.
    let spinning = |residual| Ledger {
        moved: 0.4,
        kinetic: 32.0,
        ..free(residual)
    };
    assert!(names(&spinning(0.3), 1000).is_empty());
    assert_eq!(names(&spinning(0.33), 1000), ["energy-missing"]);
}

/// Defect D: a window of nanoseconds was called untrustworthy for the error of its first step.
#[test]
fn a_few_steps_are_too_few_to_judge_the_energy_by() {
    assert_eq!(names(&ledger_with(50.0), 31), ["too-short"]);
    assert_eq!(names(&ledger_with(50.0), 32)[0], "energy-missing");
    assert!(names(&ledger_with(1e-10), 5).is_empty(), "rounding");
}

#[test]
fn an_energy_that_is_not_a_number_is_missing() {
    let found = ledger(&ledger_with(f64::NAN), 1000);
    assert_eq!(found[0].name(), "energy-missing");
    assert_eq!(found[0].trust(), Trust::Distrusted);
}

#[test]
fn the_worst_reason_decides_and_comes_first() {
    let caution = Reason::TooShort { steps: 3 };
    let worst = Reason::NotFinite { samples: 1 };
    let verdict = Verdict::from_reasons(vec![caution.clone(), worst.clone()]);
    assert_eq!(verdict.trust, Trust::Distrusted);
    assert_eq!(verdict.reasons, [worst, caution.clone()]);
    assert_eq!(verdict.attributes()["reasons"], "not-finite too-short");
    assert!(verdict.warning().is_some_and(|line| !line.contains("few")));

    let cautious = Verdict::from_reasons(vec![caution]);
    assert_eq!((cautious.trust, cautious.warning()), (Trust::Caution, None));
    let sound = Verdict::from_reasons(Vec::new());
    assert_eq!(sound.trust, Trust::Trusted);
    assert_eq!(sound.to_string(), "verdict                  trusted");
}

/// A span with a mean, and a steady state of 1000 N that begins after 0.6 s.
fn reached(mean: f64, half_width: f64) -> (&'static str, Steadiness, f64) {
    let known = |value| ConfidenceInterval { value, half_width };
    let found = Steadiness {
        mean: known(mean),
        deviation: known(10.0),
        p1: known(970.0),
        p99: known(1030.0),
        settled: 1000.0,
        from: 0.6,
        is_steady: true,
    };
    ("a-b", found, 1000.0)
}

#[test]
fn means_of_a_steady_state_are_not_spoken_against() {
    assert_eq!(steadiness(&[reached(1004.0, 5.0)], None, 1.0), []);
    assert_eq!(steadiness(&[], None, 1.0), []);
}

#[test]
fn a_start_that_counts_is_told() {
    let reasons = steadiness(&[reached(1003.0, 5.0), reached(1020.0, 5.0)], None, 1.0);
    let [Reason::StartCounts { until, shift, .. }] = reasons[..] else {
        panic!("{reasons:?}");
    };
    assert!((until - 0.6).abs() < 1e-12 && (shift - 0.02).abs() < 1e-12);
}

#[test]
fn what_is_not_steady_is_told_alone() {
    let mut drifting = reached(1020.0, 80.0);
    drifting.1.is_steady = false;
    let reasons = steadiness(&[reached(1020.0, 80.0), drifting], None, 1.0);
    assert!(
        matches!(reasons[..], [Reason::NotSteady { .. }]),
        "{reasons:?}"
    );
}

#[test]
fn intervals_that_are_wide_or_missing_are_told() {
    let reasons = steadiness(&[reached(1000.0, 51.0)], None, 1.0);
    assert!(
        matches!(reasons[..], [Reason::MeansUncertain { .. }]),
        "{reasons:?}"
    );
    let reasons = steadiness(&[reached(1000.0, f64::NAN)], Some(0.3), 1.0);
    assert_eq!(reasons, [Reason::StatisticsUnknown { until: 0.3 }]);
}

/// One of each reason.
fn specimens() -> Vec<Reason> {
    let span = || "a-b".to_owned();
    let none = String::new;
    let pressed = |share| Reason::LinksPressed {
        chain: none(),
        force: 100.0,
        share,
    };
    vec![
        Reason::NotFinite { samples: 3 },
        Reason::EnergyMissing { of_moved: 0.2 },
        Reason::LossesWrong { of_losses: 0.7 },
        Reason::LossesUncertain { of_losses: 0.2 },
        Reason::EfficiencyAboveOne { efficiency: 1.01 },
        Reason::TooShort { steps: 3 },
        Reason::SpanRarelyHeld {
            span: span(),
            share: 0.7,
        },
        Reason::SpanNotHeld {
            span: span(),
            share: 0.1,
        },
        Reason::NotSteady { span: span() },
        Reason::StartCounts {
            span: span(),
            until: 0.1,
            shift: 0.02,
        },
        Reason::NotRunIn { time: 3.0 },
        Reason::MeansUncertain {
            span: span(),
            width: 0.1,
            until: 4.0,
        },
        Reason::MeansInexact { error: 0.1 },
        Reason::StatisticsUnknown { until: 2.0 },
        Reason::AccuracyMissed {
            accuracy: 0.01,
            error: 0.02,
            was_chosen: true,
        },
        Reason::AccuracyMissed {
            accuracy: 0.01,
            error: 0.02,
            was_chosen: false,
        },
        Reason::AboveBreakingLoad {
            chain: none(),
            tension: 1e4,
            breaking: 9e3,
        },
        Reason::DeepContact {
            place: span(),
            depth: 1e-4,
            reach: 5e-5,
        },
        Reason::FastImpact {
            place: span(),
            speed: 4.0,
            limit: 3.0,
        },
        Reason::LoadDrives { work: 12.0 },
        Reason::SamplesRare {
            samples: 1.0,
            every: 1e-2,
            needed: 5e-3,
        },
        Reason::MotionsFight {
            fight: MotionConflict {
                sprockets: ["a", "b"].map(str::to_owned),
                teeth: 3.0,
            },
        },
        Reason::NotEstimated {
            why: "switched off".to_owned(),
        },
        pressed(0.1),
        pressed(0.001),
        Reason::SpansNotExamined {
            gap: Gap {
                span: span(),
                from: 0.1,
                until: 0.2,
            },
        },
        Reason::HorizonWithinRun {
            spans: None,
            links: None,
        },
        Reason::NotExamined {
            window: 0.01,
            until: 1.0,
        },
    ]
}

/// Every reason has its rule and says what it makes of a result; what its reader can act on ends with what to type.
#[test]
fn every_reason_has_a_rule_and_ends_with_what_to_type() {
    let rules = Verdict::rules();
    let mut without: Vec<_> = rules.iter().map(|rule| rule.name).collect();
    for reason in specimens() {
        let rule = rules.iter().find(|rule| rule.name == reason.name());
        let rule = rule.unwrap_or_else(|| panic!("no rule for {reason:?}"));
        without.retain(|name| *name != rule.name);
        let words = reason.to_string();
        if reason.trust() == Trust::Trusted {
            assert!(!words.contains(": --"), "{words}");
            continue;
        }
        assert_eq!(rule.trust, reason.trust(), "{reason:?}");
        let remedy = words.rsplit_once(": ").map_or("", |(_, remedy)| remedy);
        let is_told = [
            "--",
            "chaindrive design",
            "give one of them a load",
            "turn its sign",
        ];
        assert!(is_told.iter().any(|it| remedy.contains(it)), "{words}");
    }
    assert!(without.is_empty(), "{without:?}");
}

/// The rules as the documentation has them; `UPDATE_DOCS=1` writes them.
#[test]
fn the_documentation_has_the_rules() {
    let rows = Verdict::rules().into_iter().map(|rule| {
        let word = match rule.trust {
            Trust::Trusted => "note",
            other => other.name(),
        };
        let Rule {
            name, when, source, ..
        } = rule;
        format!("| `{name}` | {word} | {when} | {source} |\n")
    });
    let rows: String = rows.collect();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/verdict.md");
    let page = std::fs::read_to_string(path).unwrap();
    let head = "| reason | verdict | when | threshold from |\n|---|---|---|---|\n";
    let (before, rest) = page.split_once(head).unwrap();
    let (found, after) = rest.split_once("\n\n").unwrap();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, format!("{before}{head}{rows}\n{after}")).unwrap();
        return;
    }
    assert_eq!(format!("{found}\n"), rows, "UPDATE_DOCS=1 writes it anew");
}

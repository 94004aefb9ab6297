//! Every limit by hand, and the verdict that some make.

use super::*;

/// Value by value: what keeps a limit, what is warned of, what fails, from the bounds of the table.
#[test]
fn every_limit_is_the_one_of_its_table() {
    let cases: [(Limit, f64, CheckOutcome); 29] = [
        (Limit::StaticSafety, 7.0, CheckOutcome::Pass),
        (Limit::StaticSafety, 6.99, CheckOutcome::Warning),
        (Limit::StaticSafety, 2.99, CheckOutcome::Fail),
        (Limit::DynamicSafety, 7.0, CheckOutcome::Pass),
        (Limit::DynamicSafety, 5.0, CheckOutcome::Warning),
        (Limit::DynamicSafety, 4.99, CheckOutcome::Fail),
        (Limit::BearingPressure, 30.0, CheckOutcome::Pass),
        (Limit::BearingPressure, 30.1, CheckOutcome::Warning),
        (Limit::BearingPressure, 60.1, CheckOutcome::Fail),
        (Limit::RatedPower, 100.0, CheckOutcome::Pass),
        (Limit::RatedPower, 100.1, CheckOutcome::Fail),
        (Limit::TwinPower, 497.0, CheckOutcome::Warning),
        (Limit::TwinPower, 99.0, CheckOutcome::Pass),
        (Limit::Speed, 101.0, CheckOutcome::Fail),
        (Limit::OutOfLine, 0.2, CheckOutcome::Pass),
        (Limit::OutOfLine, 0.21, CheckOutcome::Warning),
        (Limit::Wear, 80.0, CheckOutcome::Pass),
        (Limit::Wear, 80.1, CheckOutcome::Warning),
        (Limit::Wear, 100.1, CheckOutcome::Fail),
        (Limit::Wrap, 119.9, CheckOutcome::Warning),
        (Limit::Wrap, 120.0, CheckOutcome::Pass),
        (Limit::Teeth, 17.0, CheckOutcome::Pass),
        (Limit::Teeth, 9.0, CheckOutcome::Warning),
        (Limit::Ratio, 7.0, CheckOutcome::Pass),
        (Limit::Ratio, 8.0, CheckOutcome::Warning),
        (Limit::Centres, 29.9, CheckOutcome::Warning),
        (Limit::Centres, 30.0, CheckOutcome::Pass),
        (Limit::Centres, 50.1, CheckOutcome::Warning),
        (Limit::Wrap, f64::NAN, CheckOutcome::NotJudged),
    ];
    for (limit, value, outcome) in cases {
        let check = Check::of(limit, "", value);
        assert_eq!(check.outcome, outcome, "{check}");
    }
    for limit in Limit::ALL {
        let tried = cases.iter().any(|(of, ..)| of == limit);
        assert!(tried && !limit.source().is_empty(), "{}", limit.name());
        // What does not fail a chain never says so.
        assert!(
            limit.failure().is_some() || Check::of(*limit, "", 1e9).outcome != CheckOutcome::Fail
        );
    }
}

#[test]
fn the_worst_comes_first_and_what_is_not_known_is_no_pass() {
    let unknown = || Check::not_judged(Limit::StaticSafety, "", "no breaking load");
    let good = || Check::of(Limit::Ratio, "", 2.0);
    let found = ChainVerdict::of_checks(vec![good(), unknown()]);
    assert_eq!(found.outcome(), CheckOutcome::NotJudged);
    let strong = Check::of(Limit::DynamicSafety, "", 9.0);
    let found = ChainVerdict::of_checks(vec![good(), unknown(), strong.clone()]);
    assert_eq!(found.outcome(), CheckOutcome::Pass);
    let warned = Check::of(Limit::Wrap, "driver", 106.0);
    let weak = Check::of(Limit::DynamicSafety, "left", 4.0);
    let found = ChainVerdict::of_checks(vec![good(), warned, weak, strong]);
    assert_eq!(found.outcome(), CheckOutcome::Fail);
    let written = found.written();
    assert_eq!(written.reasons, "dynamic-safety wrap");
    assert!(
        written.note.starts_with("dynamic safety factor"),
        "{}",
        written.note
    );
    assert!(
        written
            .note
            .contains("wrap of the smallest sprocket that carries power of driver: 106"),
        "{}",
        written.note
    );
}

//! The verdict on the chains of presets under their own loads; `tests/python/test_chain_verdict.py` has them under more.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::{
    ChainVerdict, CheckOutcome, Memory, Request, Scene, SettingValue, Settings, execute,
};

use super::judged::preset;

fn chains(scene: &Scene, until: &str) -> ChainVerdict {
    let settings = [("until", until), ("run_in", "0.05"), ("method", "verlet")];
    let settings = settings
        .into_iter()
        .fold(Settings::default(), |settings, (name, value)| {
            settings.with(name, SettingValue::written(value))
        });
    let request = Request::new(scene, &settings).unwrap().without_estimate();
    let report = execute(&request, &mut Memory::default(), &|| false).unwrap();
    report.verdict.chains
}

/// By hand, from catalogue and loads. `industrial_16b`: 60 kN over some 6.5 kN, pins of 210 mm² (31 N/mm²), 15 kW beside
/// the 12.2 kW of number 80; nobody knows the strength of the timing chain, and a guided drive is not held against rules for plain ones.
#[test]
fn presets_get_what_a_hand_computation_gives() {
    for (name, until, outcome, reasons) in [
        (
            "industrial_16b",
            "0.1",
            CheckOutcome::Warning,
            "bearing-pressure twin-power",
        ),
        ("timing_drive", "0.02", CheckOutcome::NotJudged, ""),
        ("marine_two_sprockets", "0.1", CheckOutcome::Pass, ""),
    ] {
        let found = chains(&preset(name, &[]), until);
        assert_eq!(found.outcome(), outcome, "{name}: {:?}", found.checks);
        assert_eq!(found.written().reasons, reasons, "{name}");
    }
}

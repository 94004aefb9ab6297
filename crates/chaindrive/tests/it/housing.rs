//! Housings that grow after the chain was fitted.

use chaindrive::describe::spans_at_rest;
use chaindrive::{Description, Run, Scene};

const PITCH: f64 = 12.7e-3;
const TEETH: f64 = 20.0;
const LINKS: f64 = 80.0;
/// Centre distance \[m\] of two equal sprockets: 2 C = (n − z) p.
const CENTRES: f64 = 0.5 * (LINKS - TEETH) * PITCH;

fn scene(chain: &str, tighten: &str, housing: &str) -> Scene {
    let text = format!(
        r#"
        gravity = [0, 0]
        [chain]
        links = {LINKS}
        {chain}
        [[sprockets]]
        name = "driver"
        teeth = {TEETH}
        centre = [0, 0]
        motion = {{ kind = "constant", speed = 0 }}
        [[sprockets]]
        name = "driven"
        teeth = {TEETH}
        centre = [-{CENTRES}, 0]
        inertia = "0.01 kg m^2"
        [route]
        pretension = "300 N"
        tighten = "{tighten}"
        adjust = {{ kind = "sprocket", name = "driven", direction = [-1, 0], within = "10 mm" }}
        {housing}
        "#
    );
    Scene::from_text(&text, "test.toml").expect("a scene")
}

fn tension(scene: &Scene) -> f64 {
    tensions(scene)[0]
}

/// Mean tension of the spans, and of all links \[N\].
fn tensions(scene: &Scene) -> [f64; 2] {
    let drive = scene.drive().expect("a drive");
    let assembled = drive.assemble().unwrap_or_else(|error| panic!("{error}"));
    let spans = spans_at_rest(&drive, &assembled);
    let links = &assembled.statics.last().expect("settled").tensions;
    let of_links = links.iter().sum::<f64>() / links.len() as f64;
    [0.5 * (spans[0].tension + spans[1].tension), of_links]
}

const WARM: &str = r#"
    [housing]
    expansion = "aluminium"
    temperature = "90 degC""#;

/// Links that stretch, and teeth that hardly yield.
const SPRINGS: &str = r#"
    pitch = "12.7 mm"
    mass = "9 g"
    stiffness = "20 MN/m"
    roller_diameter = "7.92 mm"
    [contact.teeth]
    law = { kind = "linear", stiffness = "1e10 N/m" }"#;

/// A loop of links is stretched by what both spans grow; a steel housing does nothing.
///
/// ```text
/// ΔT = k 2 g C/n,   g = (23e-6 − 11.5e-6) · 70
/// ```
///
/// That is the mean of all links, within what rollers climb the flanks. Those of spans pull by up to 3 % more, for on the wheels teeth bear a part.
#[test]
fn a_warm_housing_stretches_the_chain() {
    let growth = 11.5e-6 * 70.0;
    let expected = 20e6 * 2.0 * growth * CENTRES / LINKS;
    for tighten in ["rest-length", "travel"] {
        let cold = tensions(&scene(SPRINGS, tighten, ""));
        let warm = tensions(&scene(SPRINGS, tighten, WARM));
        let [in_spans, of_links] = [0, 1].map(|i| (warm[i] - cold[i]) / expected);
        println!("{tighten}: {in_spans:.4} {of_links:.4}");
        assert!((of_links - 1.0).abs() < 0.01, "{tighten}: {of_links}");
        assert!((in_spans - 1.0).abs() < 0.04, "{tighten}: {in_spans}");
        let steel = WARM.replace("aluminium", "steel");
        let same = tension(&scene(SPRINGS, tighten, &steel));
        assert_eq!(same.to_bits(), cold[0].to_bits());
    }
}

/// Pins with play, and joints that only turn, carry what springs do, as far as these have the stiffness of the whole.
#[test]
fn other_chains_are_stretched_as_well() {
    let grown = |model: &str| {
        let chain = format!("type = \"08B-1\"\nmodel = \"{model}\"");
        let [cold, warm] = ["", WARM].map(|it| tension(&scene(&chain, "rest-length", it)));
        println!("{model}: {cold} {warm}");
        warm - cold
    };
    let springs = grown("particles");
    assert!(springs > 50.0, "{springs}");
    let play = grown("clearance-joints");
    assert!((play / springs - 1.0).abs() < 0.2, "{play} {springs}");
    // The teeth alone yield.
    let ideal = grown("ideal-joints");
    assert!(ideal > springs, "{ideal} {springs}");
}

/// g < 0: the chain keeps what is left of its pretension.
#[test]
fn a_cold_housing_slackens_the_chain() {
    let cold = WARM.replace("90 degC", "-60 degC");
    let expected = 20e6 * 2.0 * 11.5e-6 * 80.0 * CENTRES / LINKS;
    let [before, left] = ["", &cold].map(|it| tension(&scene(SPRINGS, "rest-length", it)));
    let less = before - left;
    assert!(
        (less / expected - 1.0).abs() < 0.04,
        "{less} for {expected}"
    );
}

#[test]
fn the_growth_is_told() {
    let drive = scene(SPRINGS, "travel", WARM).drive().unwrap();
    let text = Description::of(&drive, &Run::default())
        .unwrap()
        .to_string();
    assert!(text.contains("the housing then grew by"), "{text}");
    let bad = scene(SPRINGS, "travel", "").text().to_owned() + &WARM.replace("90 degC", "900 degC");
    let error = Scene::from_text(&bad, "test.toml")
        .err()
        .map(|it| it.to_string());
    let error = error.unwrap_or_default();
    assert!(error.contains("housing.temperature"), "{error}");
}

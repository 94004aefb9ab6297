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
/// That is the mean of all links but for rollers that climb the flanks: 0.9 % more with shorter links, 3.8 % with a travel. Spans pull more than that, for
/// teeth bear a part on the wheels: by n/(n − z) if no link stretched there. The exact tensions are those of centres that moved, below.
#[test]
fn a_warm_housing_stretches_the_chain() {
    let growth = 11.5e-6 * 70.0;
    let expected = 20e6 * 2.0 * growth * CENTRES / LINKS;
    for tighten in ["rest-length", "travel"] {
        let cold = tensions(&scene(SPRINGS, tighten, ""));
        let warm = tensions(&scene(SPRINGS, tighten, WARM));
        let [in_spans, of_links] = [0, 1].map(|i| (warm[i] - cold[i]) / expected);
        println!("{tighten}: {in_spans:.4} {of_links:.4}");
        assert!((of_links - 1.0).abs() < 0.05, "{tighten}: {of_links}");
        let most = LINKS / (LINKS - TEETH);
        assert!((1.0..most).contains(&in_spans), "{tighten}: {in_spans}");
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

/// A drive of sprockets (teeth, centre \[mm\]), the last one loaded by a torque, with a chain of so many links of a pitch \[mm\].
fn drive(sprockets: &[(u32, [f64; 2])], links: u32, pitch: f64, more: &str) -> Scene {
    let mut text = format!(
        "{more}\n[chain]\nlinks = {links}\npitch = \"{pitch:.12} mm\"\nmass = \"9 g\"\nstiffness = \"20 MN/m\"\nroller_diameter = \"7.92 mm\"\n"
    );
    let last = sprockets.len() - 1;
    for (place, (teeth, [x, y])) in sprockets.iter().enumerate() {
        let turned = match place {
            0 => "motion = \"held\"",
            _ if place == last => "inertia = 0.02\nload = [{ kind = \"constant\", torque = 6 }]",
            _ => "inertia = 0.02",
        };
        let sprocket = format!(
            "[[sprockets]]\nname = \"s{place}\"\nteeth = {teeth}\ncentre = [\"{x:.12} mm\", \"{y:.12} mm\"]\n{turned}\n"
        );
        text.push_str(&sprocket);
    }
    Scene::from_text(&text, "test.toml").expect("a scene")
}

/// Spans of a drive whose housing grows pull as those of the same links on centres that stand apart, which are what they are by hand.
#[test]
fn growth_is_that_of_centres_which_move() {
    let growth = 11.5e-6 * 70.0;
    let cold = WARM.replace("90 degC", "-50 degC");
    let two = |teeth: [u32; 2], x: f64, y: f64| vec![(teeth[0], [0.0, 0.0]), (teeth[1], [x, y])];
    let three = vec![(20, [0.0, 0.0]), (25, [330.0, 10.0]), (17, [120.0, 230.0])];
    let taut = "pretension = 600\npretension_at = \"phase\"";
    for (what, sprockets, links, fit, housing, growth, gravity) in [
        (
            "equal",
            two([30, 30], 12.0 * 12.7, 0.0),
            54,
            taut,
            WARM,
            growth,
            0.0,
        ),
        (
            "unequal",
            two([17, 38], 321.0, 60.0),
            80,
            taut,
            WARM,
            growth,
            9.81,
        ),
        ("three", three, 92, taut, WARM, growth, 9.81),
        (
            "cold",
            two([20, 30], 420.0, 0.0),
            92,
            taut,
            &cold,
            -growth,
            9.81,
        ),
    ] {
        let moves = "adjust = { kind = \"sprocket\", name = \"s1\", direction = [1, 0], within = \"12 mm\" }";
        let more = format!(
            "gravity = [0, -{gravity}]\n[route]\n{fit}\ntighten = \"travel\"\n{moves}\n{housing}"
        );
        let warm = spans(&drive(&sprockets, links, 12.7, &more));
        // As it was fitted.
        let fitted = drive(&sprockets, links, 12.7, &more.replace(housing, ""));
        let assembled = fitted.drive().unwrap().assemble().unwrap();
        let travel = assembled.fittings[0].as_ref().expect("a route").travel;
        let mut moved = sprockets.clone();
        moved[1].1[0] += travel * 1e3;
        for (_, centre) in &mut moved {
            *centre = centre.map(|it| it * (1.0 + growth));
        }
        let more = format!("gravity = [0, -{gravity}]");
        let right = spans(&drive(&moved, links, 12.7, &more));
        println!(
            "{what}: {warm:?} for {right:?}; before {:?}",
            spans(&fitted)
        );
        for (found, right) in warm.iter().zip(&right) {
            assert!(
                (found / right - 1.0).abs() < 0.01,
                "{what}: {found} {right}"
            );
        }
    }
}

fn spans(scene: &Scene) -> Vec<f64> {
    let drive = scene.drive().expect("a drive");
    let assembled = drive.assemble().unwrap_or_else(|error| panic!("{error}"));
    let spans = spans_at_rest(&drive, &assembled);
    spans.iter().map(|it| it.tension).collect()
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

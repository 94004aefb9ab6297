//! Oil in seats, bushes and on guides of whole drives: accounted for, and refused where it has no place.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::Scene;
use chaindrive_mechanics::Place;

use crate::dynamics::run_open;
use crate::two_sprockets::{TwoSprockets, steady};

const FILM: &str = "film = { thickness = \"20 µm\", viscosity = \"0.05 Pa s\" }";

/// A drive whose teeth, chain and guides have these keys.
fn drive(teeth: &str, chain: &str, more: &str, step: f64) -> String {
    TwoSprockets {
        before: "gravity = [0, -9.81]",
        links: 46.0,
        chain: &format!("type = \"16B-1\"\n{chain}"),
        teeth: [20.0, 30.0],
        centre: [-0.261, 0.0],
        driver: &steady(20.0),
        inertia: 0.02,
        driven: "load = [{ kind = \"constant\", torque = \"-100 N m\" }]",
        after: &format!("[contact.teeth]\n{teeth}\n{more}"),
        until: 20e-3,
        every: 0.2e-3,
        run: &format!("run_in = \"10 ms\"\nstep = {step:e}"),
        ..TwoSprockets::NOTHING
    }
    .text()
}

const PARTICLES: &str = "stiffness = \"20 MN/m\"";
const PLAY: &str = "model = \"clearance-joints\"";
const GUIDE: &str = r#"
        [[guides]]
        name = "rail"
        face = { kind = "on-span", between = ["driven", "driver"], material = "left", from = "35 %", to = "65 %", bow = "1 mm", end_radius = "0.05 m", end_angle = "10 deg" }
"#;

/// Energy that is unaccounted for, over what moves; what is lost in each place \[W\]; films that were seen \[m\].
fn found(text: &str) -> (f64, impl Fn(Place) -> f64 + use<>, Vec<f64>) {
    let (mut samples, mut films) = (Vec::new(), Vec::new());
    let (_, open) = run_open(text, |seen| {
        samples.push((seen.time, seen.energy.losses()));
        films.extend(seen.film_thickness.iter().filter(|film| !film.is_nan()));
    });
    let [(begin, before), (end, after)] = [samples[0], samples[samples.len() - 1]];
    let lost = move |place: Place| {
        let index = Place::ALL.iter().position(|it| *it == place).unwrap();
        (after[index] - before[index]) / (end - begin)
    };
    (open, lost, films)
}

/// The ledger closes with oil wherever it can be, in links that are springs and in rigid ones; half the step changes the loss of the teeth little.
#[test]
fn what_oil_takes_is_accounted_for() {
    let linear = format!("law = {{ kind = \"linear\", stiffness = \"100 MN/m\" }}\n{FILM}");
    let bushes = format!("[contact.joints]\n{FILM}");
    let rails = format!("[contact.guides]\n{FILM}\n{GUIDE}");
    let cases = [
        (&linear, PARTICLES, String::new()),
        (&linear, PARTICLES, rails),
        (&linear, PLAY, bushes),
    ];
    for (teeth, chain, more) in cases {
        let mut teeth_lose = [0.0; 2];
        for (lose, step) in teeth_lose.iter_mut().zip([4e-6, 2e-6]) {
            let (open, lost, films) = found(&drive(teeth, chain, &more, step));
            assert!(open < 1e-3, "{chain} {step}: {open}");
            *lose = lost(Place::Teeth);
            assert!(*lose > 0.1, "{chain}: {lose}");
            let within = films.iter().filter(|film| **film > 0.0).count();
            assert!(films.iter().all(|film| (0.0..=20e-6).contains(film)));
            assert!(within > 100, "{within} of {}", films.len());
            if more.contains("rail") {
                assert!(lost(Place::Guides) > 0.0);
            }
        }
        let [coarse, fine] = teeth_lose;
        assert!(
            (coarse / fine - 1.0).abs() < 0.05,
            "{chain}: {teeth_lose:?}"
        );
    }
}

/// Oil beside what it takes the place of, and where nothing is between surfaces, is refused with a way out.
#[test]
fn oil_without_a_place_is_refused() {
    let both = format!("restitution = 0.5\n{FILM}");
    let dry = "film = { thickness = \"20 µm\" }";
    let thin = "film = { thickness = \"0 µm\", viscosity = \"0.05 Pa s\" }";
    let joint = format!("{PARTICLES}\njoint = {{ contact = {{ {FILM} }} }}");
    let full = format!("{PLAY}\njoint = {{ clearance = 0, contact = {{ {FILM} }} }}");
    for (teeth, chain, path, told) in [
        (
            both.as_str(),
            PARTICLES,
            "contact.teeth.film",
            "what an impact leaves follows",
        ),
        (dry, PARTICLES, "contact.teeth.film.viscosity", "lubricant"),
        (
            thin,
            PARTICLES,
            "contact.teeth.film.thickness",
            "must be positive",
        ),
        ("", joint.as_str(), "chain.joint.contact.film", "clearance"),
        (
            "",
            full.as_str(),
            "chain.joint.contact.film",
            "no room for oil",
        ),
    ] {
        let error = Scene::from_text(&drive(teeth, chain, "", 4e-6), "case.toml")
            .and_then(|scene| scene.drive())
            .unwrap_err()
            .to_string();
        assert!(error.contains(path) && error.contains(told), "{error}");
    }
}

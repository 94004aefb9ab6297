//! The order of precedence when a run is asked for, and refusals before it begins.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::{
    Memory, Request, RequestError, RunError, Scene, SettingValue, Settings, SimulationError,
    Stepping, Stop, execute,
};

fn scene(run: &[(&str, &str)]) -> Scene {
    let ring = Scene::preset("spinning_ring").unwrap();
    run.iter().fold(ring, |scene, (key, value)| {
        scene.replace(&format!("run.{key}"), value).unwrap()
    })
}

fn given(settings: &[(&str, &str)]) -> Settings {
    settings
        .iter()
        .fold(Settings::default(), |all, (key, value)| {
            all.with(key, SettingValue::Text((*value).to_owned()))
        })
}

/// An argument goes before the scene, the scene before the defaults; what belongs together goes together.
#[test]
fn one_precedence() {
    use Stepping::{Auto, Rk4, Verlet};
    let merged = |run: &[(&str, &str)], settings: &[(&str, &str)]| {
        let request = Request::new(&scene(run), &given(settings)).unwrap();
        let run = request.run;
        (run.stepping, run.step, run.onset_depth, request.accuracy)
    };
    let rk4 = [("method", "rk4"), ("step", "10 us")];
    let step = Some(1e-5);
    assert_eq!(merged(&[], &[]), (Auto, None, None, Some(0.01)));
    assert_eq!(merged(&rk4, &[]), (Rk4, step, None, None));
    // The step of the scene goes with the method of the scene.
    assert_eq!(
        merged(&rk4, &[("method", "verlet")]),
        (Verlet, None, None, None)
    );
    assert_eq!(merged(&rk4, &[("method", "rk4")]), (Rk4, step, None, None));
    assert_eq!(
        merged(&[("step", "10 us")], &[("method", "auto")]),
        (Auto, step, None, None)
    );
    assert_eq!(
        merged(&rk4, &[("step", "1 us")]),
        (Rk4, Some(1e-6), None, None)
    );
    // An accuracy chooses; what it would choose takes its place, and the other way round.
    let depth = [("onset_depth", "1 um")];
    assert_eq!(
        merged(&rk4, &[("accuracy", "2%")]),
        (Auto, None, None, Some(0.02))
    );
    assert_eq!(
        merged(&[("accuracy", "2%")], &depth),
        (Auto, None, Some(1e-6), None)
    );
    assert_eq!(
        merged(&[("accuracy", "2%")], &[]),
        (Auto, None, None, Some(0.02))
    );
}

#[test]
fn two_that_exclude_each_other_are_refused() {
    let refused = |settings| Request::new(&scene(&[]), &settings).unwrap_err();
    let both = given(&[("accuracy", "2%"), ("step", "1 us")]);
    assert!(matches!(
        refused(both),
        RequestError::Setting(SimulationError::Conflict { given: "step" })
    ));
    let number = Settings::default().with("step", SettingValue::Number(f64::NAN));
    assert!(refused(number).to_string().contains("step = NaN"));
    let method = refused(given(&[("method", "euler")])).to_string();
    assert!(method.contains("no method is named `euler`"), "{method}");
}

/// A chain faster than sound in steel never comes to an end of its run.
#[test]
fn a_chain_faster_than_strain_is_refused() {
    let drive = Scene::preset("marine_two_sprockets").unwrap();
    let drive = drive
        .replace("sprockets.crank.motion.speed", "-9e10 rpm")
        .unwrap();
    let settings = given(&[("until", "1 ms"), ("method", "dormand-prince")]);
    let request = Request::new(&drive, &settings).unwrap();
    let refused = execute(&request, &mut Memory::default(), &|| false).unwrap_err();
    assert!(matches!(
        refused,
        RunError::Start(SimulationError::TooFast { .. })
    ));
    assert!(refused.to_string().contains("unit of its speed"));
}

const STRAND: &str = r#"
    gravity = [0, -9.81]
    settle = false
    [chain]
    model = "ideal-joints"
    rollers = "none"
    pitch = 0.02
    links = 2
    stiffness = 1e9
    inner = { mass = 0.02, inertia = 1e-6 }
    outer = { mass = 0.02, inertia = 1e-6 }
    ends = ["fixed", "free"]
    start = { kind = "line", from = [0, 0], to = [0.04, 0] }
"#;

/// A strand of ideal joints that touches nothing has a step of its own, whatever is recorded.
#[test]
fn a_free_strand_of_ideal_joints_keeps_its_energy() {
    let scene = Scene::from_text(STRAND, "strand").unwrap();
    for every in ["1 ms", "20 ms"] {
        for method in ["auto", "verlet", "rk4", "dormand-prince"] {
            let settings = given(&[("until", "300 ms"), ("every", every), ("method", method)]);
            let request = Request::new(&scene, &settings).unwrap().without_estimate();
            let report = execute(&request, &mut Memory::default(), &|| false).unwrap();
            assert!(matches!(report.stop, Stop::End), "{method}");
            let (moved, residual) = (report.summary.energy_moved(), report.summary.residual);
            assert!(
                residual.abs() < 0.02 * moved,
                "{method}, every {every}: {residual} J of {moved} J"
            );
        }
    }
}

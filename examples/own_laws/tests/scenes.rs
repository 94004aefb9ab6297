//! Laws of another program, asked through scenes.

use std::process::Command;
use std::sync::Once;

use chaindrive::laws::pushes::PushLaw;
use chaindrive::record::Existing;
use chaindrive::scene::schema;
use chaindrive::sweep::{Coordinator as _, Go, Setting, Sweep, SweepStore, Worker};
use chaindrive::{Build, Description, Run, Scene, Simulation, Snapshot};
use own_laws::{GasSpring, Winkler};

type Outcome = Result<(), Box<dyn std::error::Error>>;

const TEETH: &str = "contact.teeth.law";
const RUBBING: &str = "contact.teeth.friction";
const PUSH: &str = "tensioners.tightener.push";

const WINKLER: &str = r#"{ kind = "winkler", modulus = "200 GPa", thickness = "2 mm", length = "60 mm", radius = "30 mm" }"#;
const STRIBECK: &str = r#"{ kind = "stribeck-speed", static_coefficient = 0.15, coefficient = 0.08, stribeck_speed = "0.2 m/s", transition_speed = "1 cm/s" }"#;
const GAS: &str = r#"{ kind = "gas-spring", preload = "23.65 kN", length = "33.1 mm", exponent = 1.4, damping = "20 kN s/m" }"#;

/// A preset with other laws; all laws are registered.
fn scene(preset: &str, laws: &[(&str, &str)]) -> Result<Scene, chaindrive::scene::SceneError> {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| own_laws::register().expect("nothing was read before"));
    laws.iter()
        .try_fold(Scene::preset(preset)?, |scene, (place, law)| {
            scene.replace(place, law)
        })
}

fn moved(scene: &Scene, until: f64) -> Result<Simulation, Box<dyn std::error::Error>> {
    let run = Run {
        until,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive()?, &run)?;
    simulation.advance_to(until)?;
    Ok(simulation)
}

/// A Winkler layer is a power of 3/2: the kernel that asks the law contact by contact gives the motion of the one that knows the power.
#[test]
fn a_layer_moves_the_chain_as_the_power_that_it_is() -> Outcome {
    let layer = Winkler {
        modulus: 200e9,
        thickness: 2e-3,
        length: 60e-3,
        radius: 30e-3,
    };
    let power = format!(
        "{{ kind = \"power\", stiffness = {}, exponent = 1.5 }}",
        layer.scale()
    );
    let [own, known] = [WINKLER, &power].map(|law| {
        let scene = scene("marine_two_sprockets", &[(TEETH, law)])?;
        Ok::<_, Box<dyn std::error::Error>>(moved(&scene, 5e-3)?.observation().link_tension.clone())
    });
    for (own, known) in own?.iter().zip(&known?) {
        assert!(
            (own - known).abs() < 1e-6 * known.abs().max(1e3),
            "{own} {known}"
        );
    }
    Ok(())
}

/// What friction of teeth takes is in the ledger, and nothing else is missing.
#[test]
fn friction_loses_energy_and_the_ledger_closes() -> Outcome {
    let simulation = moved(
        &scene("marine_two_sprockets", &[(RUBBING, STRIBECK)])?,
        10e-3,
    )?;
    let energy = &simulation.observation().energy;
    let lost = energy.flow(chaindrive::Flow::ToothFriction);
    assert!(lost > 0.0, "{lost}");
    let residual = simulation.energy_residual().abs();
    assert!(residual < 0.05 * lost, "{residual} J of {lost} J");
    Ok(())
}

/// Statics and motion find the gas spring; force, stiffness and energy of it belong together.
#[test]
fn a_gas_spring_holds_the_tightener() -> Outcome {
    let gas = GasSpring {
        preload: 23.65e3,
        length: 33.1e-3,
        exponent: 1.4,
        damping: 20e3,
    };
    let (x, h) = (-4e-3, 1e-7);
    let by = |f: &dyn Fn(f64) -> f64| (f(x + h) - f(x - h)) / (2.0 * h);
    let force = |x| gas.force(x, 0.0, 0.0).elastic;
    let stiffness = -by(&force);
    assert!((gas.stiffness(x) / stiffness - 1.0).abs() < 1e-6);
    assert!((-by(&|x| gas.energy(x, 0.0)) / force(x) - 1.0).abs() < 1e-6);

    let simulation = moved(&scene("marine_engine", &[(PUSH, GAS)])?, 2e-3)?;
    let pushes = &simulation.observation().tensioner_force;
    assert!((pushes[0] / gas.preload - 1.0).abs() < 0.2, "{pushes:?}");
    Ok(())
}

#[test]
fn describe_and_schema_know_them() -> Outcome {
    let laws = [(TEETH, WINKLER), (RUBBING, STRIBECK)];
    let drive = scene("marine_two_sprockets", &laws)?.drive()?;
    let described = Description::of(&drive, &Run::default())?;
    let teeth = &described.model.contacts[0];
    assert_eq!(
        (teeth.elastic.as_str(), teeth.friction.as_str()),
        ("winkler", "stribeck-speed")
    );

    let schema = schema();
    for (family, kind, key) in [
        ("Elastic", "winkler", "modulus"),
        ("Friction", "stribeck-speed", "stribeck_speed"),
        ("Push", "gas-spring", "preload"),
    ] {
        let kinds = schema["$defs"][family]["oneOf"].as_array();
        let own = kinds.into_iter().flatten();
        let mut own = own.filter(|it| it["properties"]["kind"]["const"] == kind);
        let key = &own.next().expect("its kind")["properties"][key];
        assert_eq!(key["exclusiveMinimum"], 0);
        assert!(key["x-unit"].is_string(), "{key}");
    }
    Ok(())
}

/// Units, ranges, names of keys and kinds, and the law's own rule: as with laws of the library.
#[test]
fn mistakes_are_told_in_the_usual_words() {
    for (place, right, wrong, words) in [
        (TEETH, "\"2 mm\"", "\"2 kg\"", "`2 kg` is a mass"),
        (
            TEETH,
            "\"2 mm\"",
            "\"-2 mm\"",
            "-0.002, must be positive [m]",
        ),
        (TEETH, "thickness", "thicknes", "did you mean `thickness`?"),
        (TEETH, "winkler", "winkel", "did you mean `winkler`?"),
        (TEETH, "winkler", "mattress", "cylindrical, winkler"),
        (PUSH, "1.4", "0.9", "0.9, must be at least 1"),
        (
            RUBBING,
            "0.15",
            "0.05",
            "0.05, must be at least the kinetic coefficient",
        ),
    ] {
        let law = match place {
            TEETH => WINKLER,
            PUSH => GAS,
            _ => STRIBECK,
        };
        let wrong = law.replace(right, wrong);
        let refused = scene("marine_engine", &[(place, &wrong)]).and_then(|scene| scene.drive());
        let told = refused.expect_err("it is wrong").to_string();
        assert!(told.contains(words), "{told}");
    }
}

/// Runs `without_the_laws` in a process of its own.
#[test]
fn a_program_without_the_laws_does_not_go_on() -> Outcome {
    let folder = std::env::temp_dir().join(format!("own-laws-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let scene = scene("marine_two_sprockets", &[(RUBBING, STRIBECK)])?
        .replace("run.until", "1 ms")?
        .replace("run.run_in", "0 s")?;
    assert!(Build::here().id.contains("+friction:stribeck-speed=1"));
    std::fs::write(
        folder.join("snapshot"),
        moved(&scene, 1e-3)?.snapshot().to_bytes(),
    )?;
    let speeds = ["60 rpm", "70 rpm"].map(|speed| Setting::Text(speed.into()));
    let sweep = Sweep::new(
        &scene,
        &[("sprockets.crank.motion.speed".into(), speeds.to_vec())],
        &[],
    )?;
    let sample = sweep.time_sample(Some(1), || Go::On)?;
    let store = folder.join("sweep.zarr");
    SweepStore::begin(store.as_path(), &sweep, &sample, Existing::Keep)?
        .run(Some(1), &mut |_| Go::On)?;
    let child = Command::new(std::env::current_exe()?)
        .args(["--ignored", "--exact", "without_the_laws"])
        .env("OWN_LAWS_FOLDER", &folder)
        .output()?;
    std::fs::remove_dir_all(&folder)?;
    assert!(
        child.status.success(),
        "{}",
        String::from_utf8_lossy(&child.stdout)
    );
    Ok(())
}

#[test]
#[ignore = "run by another test, in a process that registers nothing"]
fn without_the_laws() -> Outcome {
    let folder = std::path::PathBuf::from(std::env::var("OWN_LAWS_FOLDER")?);
    let snapshot = Snapshot::from_bytes(&std::fs::read(folder.join("snapshot"))?);
    let worker = Worker::open(folder.join("sweep.zarr").as_path());
    for told in [
        snapshot.expect_err("its law is missing").to_string(),
        worker.expect_err("its law is missing").to_string(),
    ] {
        assert!(told.contains("it has the law `"), "{told}");
        assert!(told.contains("here is no law of that name"), "{told}");
    }
    Ok(())
}

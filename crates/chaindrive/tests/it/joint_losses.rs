//! Losses of joints beside the friction of a line of contact: worn-in pins, oil, seals, plates out of line.

use std::f64::consts::{FRAC_PI_2, PI};

use chaindrive::{Description, Run, Scene};
use chaindrive_mechanics::Place;

use crate::dynamics::{run, run_open};

/// Speed of the driver \[rad/s\], and radius of the pin \[m\].
const SPEED: f64 = 2.0;
const PIN: f64 = 4.14e-3;
const PITCH: f64 = 25.4e-3;
const TEETH: [f64; 2] = [20.0, 30.0];
const CENTRES: f64 = 0.766;
/// Sum of the speeds of the sprockets \[rad/s\]: a joint turns by 2π/z at each end of a span, z ω/2π times a second.
const TURNS: f64 = SPEED * (1.0 + TEETH[0] / TEETH[1]);

/// Mean powers lost \[W\] by pins, seals and plates, and mean tensions \[N\] of the spans.
struct Found {
    pins: f64,
    seals: f64,
    plates: f64,
    tensions: [f64; 2],
}

/// A drive with these keys in its chain, joints and driver.
fn drive(chain: &str, joint: &str, driver: &str) -> String {
    let model = if chain.contains("model") {
        ""
    } else {
        "mass = \"0.07 kg\"\ndamping_ratio = 0.1\ndrag = \"20 N s/m^2\""
    };
    format!(
        r#"
        gravity = [0, -9.81]
        [chain]
        pitch = "{PITCH} m"
        links = 86
        stiffness = "20 MN/m"
        roller_diameter = "15.88 mm"
        plate_height = "21 mm"
        {model}
        {chain}
        [chain.joint]
        pin_diameter = "{} m"
        {joint}
        [contact.teeth]
        law = {{ kind = "linear", stiffness = "100 MN/m" }}
        restitution = 0.5
        [[sprockets]]
        name = "driver"
        teeth = 20
        centre = [0, 0]
        motion = {{ kind = "constant", speed = "{SPEED} rad/s" }}
        {driver}
        [[sprockets]]
        name = "driven"
        teeth = 30
        centre = ["-{CENTRES} m", 0]
        inertia = "0.02 kg m^2"
        load = [{{ kind = "constant", torque = "-100 N m" }}]
        [run]
        until = "0.9 s"
        every = "5 ms"
        run_in = "0.3 s"
        "#,
        2.0 * PIN
    )
}

const RUBS: &str = "contact = { friction = { kind = \"spring-slider\", coefficient = 0.1, stiffness = \"75 MN/m\" } }";

fn found(text: &str) -> Found {
    let mut samples = Vec::new();
    run_open(text, |seen| {
        let tensions = [seen.span_tension[0], seen.span_tension[1]];
        samples.push((seen.time, seen.energy.losses(), tensions));
    });
    let [(begin, before, _), (end, after, _)] = [samples[0], samples[samples.len() - 1]];
    let power = |place: Place| (after[place as usize] - before[place as usize]) / (end - begin);
    let mean =
        |span: usize| samples.iter().map(|it| it.2[span]).sum::<f64>() / samples.len() as f64;
    Found {
        pins: power(Place::Joints),
        seals: power(Place::Seals),
        plates: power(Place::Offset),
        tensions: [mean(0), mean(1)],
    }
}

/// μ κ is all that the friction knows: κ of a pressure that is uniform over half of the pin is π/2, and of a cosine 4/π.
#[test]
fn worn_in_pins_rub_by_the_sum_of_their_pressures() {
    let rubs = |coefficient: f64, factor: &str| {
        let joint = RUBS.replace("0.1,", &format!("{coefficient:?},"));
        found(&drive("", &format!("{joint}\n{factor}"), "")).pins
    };
    for (word, factor) in [("line", 1.0), ("cosine", 4.0 / PI), ("uniform", FRAC_PI_2)] {
        let [by_word, by_hand] = [
            rubs(0.1, &format!("pressure_factor = \"{word}\"")),
            rubs(0.1 * factor, ""),
        ];
        assert_eq!(by_word.to_bits(), by_hand.to_bits(), "{word}");
    }
}

/// ```text
/// P = 2 M_seal Σ ω       at any tension
/// ```
///
/// by hand: every joint turns by 2π/z twice at a sprocket. Strands swing, and joints turn by a few per cent more.
#[test]
fn seals_take_their_torque_at_every_turn() {
    let rigid = r#"model = "clearance-joints"
        rollers = "none"
        inner = { mass = "0.07 kg", inertia = "6e-6 kg m^2" }
        outer = { mass = "0.07 kg", inertia = "6e-6 kg m^2" }"#;
    let ideal = rigid.replace("clearance", "ideal");
    let play = "clearance = \"20 um\"\nlength = \"25 mm\"";
    for (chain, joint) in [
        ("", RUBS),
        ("", "contact = { friction = { kind = \"none\" } }"),
        (
            "model = \"bush-strands\"\nstrands = 1\nmass = \"0.07 kg\"\ndamping_ratio = 0.1",
            RUBS,
        ),
        (rigid, play),
        (&ideal, ""),
    ] {
        let sealed = format!("seal_torque = \"0.3 N m\"\n{joint}");
        let found = found(&drive(chain, &sealed, ""));
        let expected = 2.0 * 0.3 * TURNS;
        println!("{:.4} {expected:.4} W {chain:.22}", found.seals);
        let more = found.seals / expected - 1.0;
        assert!((-0.01..0.12).contains(&more), "{more} {chain}");
        assert!(found.plates.abs() <= 0.0);
    }
    // What resists is made up for by the motor.
    run(
        &drive("", &format!("seal_torque = \"0.3 N m\"\n{RUBS}"), ""),
        |_| {},
    );
}

/// ```text
/// P = μ_s h tan γ Σ T ω       beside μ r Σ T ω of the pins
/// ```
///
/// Even in the offset, zero in line and within the play, and as much of the losses of the pins as μ_s h tan γ is of μ r.
#[test]
fn plates_rub_where_the_chain_runs_out_of_line() {
    let of = |offset: f64, play: f64| {
        let chain =
            format!("lateral = {{ friction = 0.2, lever = \"9 mm\", play = \"{play} mm\" }}");
        found(&drive(&chain, RUBS, &format!("lateral = \"{offset} mm\"")))
    };
    let radius = |teeth: f64| 0.5 * PITCH / (PI / teeth).sin();
    let across = radius(TEETH[1]) - radius(TEETH[0]);
    let length = (CENTRES * CENTRES - across * across).sqrt();
    assert!(of(0.0, 0.0).plates.abs() <= 0.0);
    assert!(of(4.0, 4.0).plates.abs() <= 0.0);
    for (offset, play) in [(4.0, 0.0), (16.0, 6.0)] {
        let [one, other] = [of(offset, play), of(-offset, play)];
        assert_eq!(one.plates.to_bits(), other.plates.to_bits(), "even");
        let slope = 1e-3 * (offset - play) / length;
        let of_pins = 0.2 * 9e-3 * slope / (0.1 * PIN);
        let share = one.plates / one.pins / of_pins;
        // But for what the springs hold at either end of the record.
        assert!((share - 1.0).abs() < 1e-3, "{share}");
        let by_hand = 0.2 * 9e-3 * slope * TURNS * one.tensions.iter().sum::<f64>();
        println!("{:.4e} {by_hand:.4e} W", one.plates);
        // Particles take the mean of the tensions on both sides of a joint, one of which is on the teeth.
        assert!((0.88..1.02).contains(&(one.plates / by_hand)));
    }
}

/// Without viscosity a lubricated pin is a spring and slider, without metal a dashpot 2 π η L r²/ψ; between the two it loses what its curve
/// says of the tensions of the spans.
#[test]
fn lubricated_pins_follow_their_curve() {
    let oiled = |coefficient: f64, viscosity: f64| {
        let law = format!(
            "contact = {{ friction = {{ kind = \"stribeck\", coefficient = {coefficient:?}, viscosity = {viscosity:?}, length = \"25 mm\", relative_clearance = 0.005, stiffness = \"75 MN/m\" }} }}"
        );
        found(&drive("", &law, ""))
    };
    let dry = found(&drive("", RUBS, ""));
    assert_eq!(oiled(0.1, 0.0).pins.to_bits(), dry.pins.to_bits());

    let viscosity = 2.0;
    let damping = 2.0 * PI * viscosity * 25e-3 / 0.005 * PIN * PIN;
    let viscous =
        format!("damping = {damping:?}\ncontact = {{ friction = {{ kind = \"none\" }} }}");
    let [oil, dashpot] = [oiled(0.0, viscosity), found(&drive("", &viscous, ""))];
    assert!((oil.pins / dashpot.pins - 1.0).abs() < 1e-6);

    // Of the tension of a span a joint that turns at its end has the share that dry friction shows, for it has the mean of two links.
    let speeds = [SPEED, SPEED * TEETH[0] / TEETH[1]];
    let whole = 0.1 * PIN * dry.tensions.iter().sum::<f64>() * speeds.iter().sum::<f64>();
    let share = dry.pins / whole;
    assert!((0.88..1.0).contains(&share), "{share}");
    for viscosity in [0.02, 0.2, 2.0] {
        let found = oiled(0.1, viscosity);
        let mut by_hand = 0.0;
        for tension in found.tensions.map(|it| share * it) {
            for speed in speeds {
                let hersey = 2.0 * viscosity * speed * PIN * 25e-3 / tension;
                let friction = 0.1 / (1.0 + (hersey / 1e-6).powi(2)) + PI * hersey / 0.005;
                by_hand += friction * PIN * tension * speed;
            }
        }
        println!("{viscosity} Pa s: {:.4} {by_hand:.4} W", found.pins);
        assert!((0.92..1.03).contains(&(found.pins / by_hand)));
    }
}

/// What a drive has of it is described.
#[test]
fn spans_out_of_line_are_described() {
    let joint = format!("{RUBS}\nseal_torque = \"0.1 N m\"");
    let text = drive("", &joint, "lateral = \"4 mm\"");
    let drive = Scene::from_text(&text, "case.toml")
        .unwrap()
        .drive()
        .unwrap();
    let told = Description::of(&drive, &Run::default())
        .unwrap()
        .to_string();
    let span = "span driver-driven: 4.00 mm out of line on 764.9 mm, 0.52 % of the centre distance";
    assert!(
        told.contains(span) && told.contains("seals hold 0.1 N m"),
        "{told}"
    );
}

/// Every mistake is found where it stands.
#[test]
fn mistakes_in_joints_are_told() {
    let cases = [
        (
            "seal_torque = \"0.1 N m\"\ncontact = { friction = { kind = \"coulomb\", coefficient = 0.1 } }",
            "chain.joint.contact.friction",
            "take `spring-slider` or `stribeck`",
        ),
        (
            "pressure_factor = 0.5",
            "chain.joint.pressure_factor",
            "at least 1",
        ),
        (
            "seal_torque = \"-0.1 N m\"",
            "chain.joint.seal_torque",
            "not negative",
        ),
        (
            "contact = { friction = { kind = \"stribeck\", coefficient = 0.1, viscosity = 0.1 } }",
            "chain.joint.contact.friction.length",
            "missing",
        ),
    ];
    for (joint, path, told) in cases {
        let error = Scene::from_text(&drive("", joint, ""), "case.toml")
            .and_then(|scene| scene.drive())
            .unwrap_err()
            .to_string();
        assert!(error.contains(path) && error.contains(told), "{error}");
    }
}

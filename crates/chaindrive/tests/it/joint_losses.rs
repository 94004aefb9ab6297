//! Losses of joints beside the friction of a line of contact: worn-in pins, oil, seals, plates out of line.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use chaindrive::{Description, Run, Scene};
use chaindrive_mechanics::Place;

use crate::dynamics::run_open;
use crate::two_sprockets::{TwoSprockets, steady};

/// Speed of the driver \[rad/s\], and radius of the pin \[m\].
const SPEED: f64 = 6.0;
const PIN: f64 = 4.14e-3;
const PITCH: f64 = 25.4e-3;
const TEETH: [f64; 2] = [20.0, 30.0];
/// Centre distance \[m\]: 46 links have a fifth of a pitch to hang.
const CENTRES: f64 = 0.261;
/// Sum of the speeds of the sprockets \[rad/s\]: a joint turns by 2π/z at each end of a span, z ω/2π times a second.
const TURNS: f64 = SPEED * (1.0 + TEETH[0] / TEETH[1]);
/// Record of four teeth \[s\], of which means are taken, and of some hundred steps.
const FOUR_TEETH: f64 = 4.0 * TAU / (TEETH[0] * SPEED);
const SHORT: f64 = 2e-3;

/// Mean powers lost \[W\] by pins, seals and plates, mean tensions \[N\] of the spans, and the share of the energy that is unaccounted for.
struct Found {
    pins: f64,
    seals: f64,
    plates: f64,
    tensions: [f64; 2],
    open: f64,
}

/// A drive with these keys in its chain, joints and driver.
fn drive(chain: &str, joint: &str, driver: &str, time: f64) -> String {
    let model = if chain.contains("model") {
        ""
    } else {
        "mass = \"0.07 kg\"\ndamping_ratio = 0.1\ndrag = \"20 N s/m^2\""
    };
    let joint = format!("[chain.joint]\npin_diameter = \"{} m\"\n{joint}", 2.0 * PIN);
    TwoSprockets {
        before: "gravity = [0, -9.81]",
        pitch: PITCH,
        links: 46.0,
        stiffness: 20e6,
        roller: 15.88e-3,
        chain: &format!("plate_height = \"21 mm\"\n{model}\n{chain}\n{joint}"),
        contact: 100e6,
        teeth_keys: "restitution = 0.5",
        teeth: TEETH,
        centre: [-CENTRES, 0.0],
        driver: &format!("{}\n{driver}", steady(SPEED)),
        inertia: 0.02,
        driven: "load = [{ kind = \"constant\", torque = \"-100 N m\" }]",
        until: time,
        every: time / 100.0,
        run: &format!("run_in = {}", 0.3 * time),
        ..TwoSprockets::NOTHING
    }
    .text()
}

const RUBS: &str = "contact = { friction = { kind = \"spring-slider\", coefficient = 0.1, stiffness = \"75 MN/m\" } }";

fn found(text: &str) -> Found {
    let mut samples = Vec::new();
    let (_, open) = run_open(text, |seen| {
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
        open,
    }
}

/// μ κ is all that the friction knows: κ of a pressure that is uniform over half of the pin is π/2, and of a cosine 4/π.
#[test]
fn worn_in_pins_rub_by_the_sum_of_their_pressures() {
    let rubs = |coefficient: f64, factor: &str| {
        let joint = RUBS.replace("0.1,", &format!("{coefficient:?},"));
        found(&drive("", &format!("{joint}\n{factor}"), "", SHORT)).pins
    };
    for (word, factor) in [("line", 1.0), ("cosine", 4.0 / PI), ("uniform", FRAC_PI_2)] {
        let [by_word, by_hand] = [
            rubs(0.1, &format!("pressure_factor = \"{word}\"")),
            rubs(0.1 * factor, ""),
        ];
        assert_eq!(by_word.to_bits(), by_hand.to_bits(), "{word}");
        assert!(by_word > 0.0, "{word}");
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
        let found = found(&drive(chain, &sealed, "", FOUR_TEETH));
        let expected = 2.0 * 0.3 * TURNS;
        println!("{:.4} {expected:.4} W {chain:.22}", found.seals);
        let more = found.seals / expected - 1.0;
        assert!((-0.01..0.12).contains(&more), "{more} {chain}");
        assert!(found.plates.abs() <= 0.0);
        // What resists is made up for by the motor.
        assert!(found.open < 0.01, "{} {chain}", found.open);
    }
}

/// ```text
/// P = μ_s h tan γ Σ T ω       beside μ r Σ T ω of the pins
/// ```
///
/// Even in the offset, zero in line and within the play, and as much of the losses of the pins as μ_s h tan γ is of μ r.
#[test]
fn plates_rub_where_the_chain_runs_out_of_line() {
    let of = |offset: f64, play: f64, time: f64| {
        let chain =
            format!("lateral = {{ friction = 0.2, lever = \"9 mm\", play = \"{play} mm\" }}");
        let offset = format!("lateral = \"{offset} mm\"");
        found(&drive(&chain, RUBS, &offset, time))
    };
    let radius = |teeth: f64| 0.5 * PITCH / (PI / teeth).sin();
    let across = radius(TEETH[1]) - radius(TEETH[0]);
    let length = (CENTRES * CENTRES - across * across).sqrt();
    assert!(of(0.0, 0.0, SHORT).plates.abs() <= 0.0);
    assert!(of(4.0, 4.0, SHORT).plates.abs() <= 0.0);
    for (offset, play) in [(1.5, 0.0), (6.0, 2.5)] {
        let [right, left] = [offset, -offset].map(|it| of(it, play, SHORT).plates);
        assert!(right.to_bits() == left.to_bits() && right > 0.0, "even");
        let one = of(offset, play, FOUR_TEETH);
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
    let oiled = |coefficient: f64, viscosity: f64, time: f64| {
        let law = format!(
            "contact = {{ friction = {{ kind = \"stribeck\", coefficient = {coefficient:?}, viscosity = {viscosity:?}, length = \"25 mm\", relative_clearance = 0.005, stiffness = \"75 MN/m\" }} }}"
        );
        found(&drive("", &law, "", time))
    };
    let [oil, dry] = [oiled(0.1, 0.0, SHORT), found(&drive("", RUBS, "", SHORT))];
    assert_eq!(oil.pins.to_bits(), dry.pins.to_bits());

    let viscosity = 2.0;
    let damping = 2.0 * PI * viscosity * 25e-3 / 0.005 * PIN * PIN;
    let viscous =
        format!("damping = {damping:?}\ncontact = {{ friction = {{ kind = \"none\" }} }}");
    let dashpot = found(&drive("", &viscous, "", SHORT));
    let oil = oiled(0.0, viscosity, SHORT);
    assert!((oil.pins / dashpot.pins - 1.0).abs() < 1e-6);

    // Of the tension of a span a joint that turns at its end has the share that dry friction shows, for it has the mean of two links.
    let dry = found(&drive("", RUBS, "", FOUR_TEETH));
    let speeds = [SPEED, SPEED * TEETH[0] / TEETH[1]];
    let whole = 0.1 * PIN * dry.tensions.iter().sum::<f64>() * speeds.iter().sum::<f64>();
    let share = dry.pins / whole;
    assert!((0.88..1.0).contains(&share), "{share}");
    for viscosity in [0.007, 0.07, 0.7] {
        let found = oiled(0.1, viscosity, FOUR_TEETH);
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
    let text = drive("", &joint, "lateral = \"4 mm\"", SHORT);
    let drive = Scene::from_text(&text, "case.toml")
        .unwrap()
        .drive()
        .unwrap();
    let told = Description::of(&drive, &Run::default())
        .unwrap()
        .to_string();
    let span = "span driver-driven: 4.00 mm out of line on 257.9 mm, 1.53 % of the centre distance";
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
        let error = Scene::from_text(&drive("", joint, "", SHORT), "case.toml")
            .and_then(|scene| scene.drive())
            .unwrap_err()
            .to_string();
        assert!(error.contains(path) && error.contains(told), "{error}");
    }
}

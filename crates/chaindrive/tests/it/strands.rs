//! Bush chains of several strands, as scenes describe them and as they run.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::PI;

use chaindrive::{Channel, Flow, Observation, Scene, SimulationError};

use crate::dynamics::{run, run_open, start};
use crate::mistakes::{Mistake, all_found};

/// Two strands of unlike lengths around two sprockets that rub.
const UNLIKE: &str = r#"
[chain]
model = "bush-strands"
strands = 2
strand_elongations = [0, 0.1e-2]
strand_stiffnesses = [1, 0.9]
pitch = "9.525 mm"
links = 60
mass = "3.6 g"
stiffness = "25 MN/m"
damping = "20 N s/m"
roller_diameter = "5.08 mm"
breaking_load = "9 kN"
joint = { clearance = "20 um" }
[contact.teeth]
law = { kind = "linear", stiffness = "80 MN/m" }
restitution = 0.8
friction = { coefficient = 0.1 }
[[sprockets]]
name = "driver"
teeth = 20
centre = ["0 mm", "0 mm"]
motion = { kind = "constant", speed = "600 rpm" }
[[sprockets]]
name = "driven"
teeth = 20
centre = ["190.5 mm", "0 mm"]
inertia = "0.002 kg m^2"
load = [{ kind = "constant", torque = "-20 N m" }]
[route]
pretension = "400 N"
[run]
until = "10 ms"
every = "0.5 ms"
step = "1 us"
"#;

/// The scene with some of it replaced.
fn with(changes: &[(&str, &str)]) -> String {
    let mut text = UNLIKE.to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    text
}

fn read(text: &str) -> Scene {
    Scene::from_text(text, "strands").unwrap()
}

/// Nothing but the number of strands.
const EVEN: [(&str, &str); 2] = [
    ("strand_elongations = [0, 0.1e-2]\n", ""),
    ("strand_stiffnesses = [1, 0.9]\n", ""),
];

/// What a scene says of one strand becomes what all have together.
///
/// ```text
/// m = n m₁,   k = Σ κ_s k₁,   p = Σ κ_s p_s/Σ κ_s
/// F = min over s of Σ_j k_j max(ℓ − p_j, 0),   ℓ = p_s + F₁/k_s
/// ```
#[test]
fn strands_are_described_one_by_one() {
    let drive = read(UNLIKE).drive().unwrap();
    let chain = &drive.chains[0].chain;
    let close = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found}");
    close(chain.masses[0], 2.0 * 3.6e-3);
    close(chain.stiffness[0], 1.9 * 25e6);
    close(chain.damping[0], 1.9 * 20.0);
    let pitch = 9.525e-3;
    close(chain.lengths[0], pitch * (1.0 + 0.9 * 0.1e-2 / 1.9));
    // The new strand breaks first, when the worn one bears k₂ (F₁/k₁ − Δp).
    let worn = 0.9 * 25e6 * (9e3 / 25e6 - 0.1e-2 * pitch);
    close(chain.strength.breaking_load.unwrap(), 9e3 + worn);
    assert_eq!(chain.strength.strands, 2);
}

/// A chain of the catalogue is a single strand; two have twice as much of everything, the stack behind the teeth included.
#[test]
fn strands_of_the_catalogue_are_single_ones() {
    let of = |strands: u32| {
        let named = format!(
            "type = \"06C-1\"\nmodel = \"bush-strands\"\nstrands = {strands}\nlinks = 60\ndamping_ratio = 0.03\n"
        );
        let text = UNLIKE;
        let (_, rest) = text.split_once("[contact.teeth]").unwrap();
        let drive = read(&format!("[chain]\n{named}[contact.teeth]{rest}"))
            .drive()
            .unwrap();
        let chain = &drive.chains[0].chain;
        let behind = drive.sprockets[0].surface.law.series.unwrap();
        let breaking = chain.strength.breaking_load.unwrap();
        [
            chain.masses[0],
            chain.stiffness[0],
            chain.damping[0],
            breaking,
            behind,
        ]
    };
    for (two, one) in of(2).into_iter().zip(of(1)) {
        assert!((two / one - 2.0).abs() < 1e-12, "{two}, {one}");
    }
}

/// Two equal strands move as one that is twice as heavy and twice as stiff.
#[test]
fn equal_strands_move_as_one() {
    let double = [
        ("strands = 2", "strands = 1"),
        ("mass = \"3.6 g\"", "mass = \"7.2 g\""),
        ("25 MN/m", "50 MN/m"),
        ("20 N s/m", "40 N s/m"),
    ];
    let last = |changes: &[(&str, &str)]| {
        let mut last = Observation::default();
        run(&with(changes), |sample| last = sample.clone());
        last
    };
    let two = last(&EVEN);
    let one = last(&[&EVEN[..], &double].concat());
    for (two, one) in two.roller_x.iter().zip(&one.roller_x) {
        assert!((two - one).abs() < 1e-9 * 9.525e-3, "{two} m, {one} m");
    }
    for (two, one) in two.link_tension.iter().zip(&one.link_tension) {
        assert!((two - one).abs() < 1e-9 * 400.0, "{two} N, {one} N");
    }
    for (most, all) in two.strand_tension_max.iter().zip(&two.link_tension) {
        assert!(
            (2.0 * most - all).abs() < 1e-9 * 400.0,
            "{most} N of {all} N"
        );
    }
}

/// Every joule is accounted for: strands that come loose and bear again, bushes that rub and turn their links. What is left is the
/// error of the steps, of first order where friction and contacts begin.
#[test]
fn the_ledger_of_unlike_strands_closes() {
    let open = |step: &str| {
        let (mut loose, mut shared) = (0, 0);
        let text = with(&[("step = \"1 us\"", &format!("step = \"{step}\""))]);
        let (_, open) = run_open(&text, |sample| {
            for ((most, least), all) in sample
                .strand_tension_max
                .iter()
                .zip(&sample.strand_tension_min)
                .zip(&sample.link_tension)
            {
                assert!((most + least - all).abs() < 1e-9 * 400.0, "{most}, {least}");
                if least.abs() < 0.05 * most {
                    loose += 1;
                } else {
                    shared += 1;
                }
            }
        });
        assert!(
            loose > 100 && shared > 100,
            "{loose} loose, {shared} shared"
        );
        open
    };
    let [coarse, fine] = ["1 us", "0.25 us"].map(open);
    println!("open {coarse:.2e} at 1 µs, {fine:.2e} at 0.25 µs");
    assert!(coarse < 1e-3, "{coarse}");
    assert!(fine < 0.5 * coarse, "{coarse}, then {fine}");
}

/// A circle that does not turn rubs in its seat as long as it lies there, a bush only while its link turns into the arc and out of it.
///
/// ```text
/// particles:  P = μ r ω Σ N = μ r ω T φ                     φ: wrap, Σ N = T φ
/// bushes:     P = μ r T ∫ α dα · 2 · ω z/(4π) = μ r ω T π/z    α to 2π/z, in and out, every second joint
/// ```
#[test]
fn bushes_rub_while_their_links_turn() {
    let power = |model: &str| {
        let text = with(&[
            EVEN[0],
            EVEN[1],
            (
                "model = \"bush-strands\"\nstrands = 2\n",
                &format!("model = \"{model}\"\nstrands = 1\n"),
            ),
            ("joint = { clearance = \"20 um\" }\n", ""),
            (
                "load = [{ kind = \"constant\", torque = \"-20 N m\" }]\n",
                "",
            ),
            // Slow against the slip, so that friction is all there.
            (
                "coefficient = 0.1",
                "coefficient = 0.1, slip_speed = \"8 mm/s\"",
            ),
            ("1 us", "0.4 us"),
            ("600 rpm", "150 rpm"),
            ("400 N", "1 kN"),
            ("10 ms", "60 ms"),
        ]);
        let (mut energy, mut tension) = (Vec::new(), Vec::new());
        run(&text, |sample| {
            energy.push(sample.energy.flow(Flow::ToothFriction));
            tension.push(0.5 * sample.span_tension.iter().sum::<f64>());
        });
        let [begin, end] = [40, 120];
        let mean = tension[begin..end].iter().sum::<f64>() / (end - begin) as f64;
        // μ r ω T on two sprockets, with μ at a slip of r ω
        let slip = 2.54e-3 * 150.0 * PI / 30.0;
        let unit = 2.0 * 0.1 * slip / slip.hypot(8e-3) * slip * mean;
        (energy[end] - energy[begin]) / 40e-3 / unit
    };
    let [particles, bushes] = ["particles", "bush-strands"].map(power);
    println!("particles {particles}, bushes {bushes} of μ r ω T");
    assert!((particles / PI - 1.0).abs() < 0.1, "{particles}");
    assert!((bushes / (PI / 20.0) - 1.0).abs() < 0.1, "{bushes}");
}

/// The channels of strands belong to chains that tell them apart.
#[test]
fn tensions_of_strands_are_channels_of_strands() {
    let names = ["strand_tension_max", "strand_tension_min"];
    let simulation = start(UNLIKE);
    let found = Channel::chosen(&names, &simulation.assembled().system).unwrap();
    assert_eq!(
        found,
        [Channel::StrandTensionMax, Channel::StrandTensionMin]
    );
    let particles = start(&with(&[
        EVEN[0],
        EVEN[1],
        ("model = \"bush-strands\"\n", ""),
        ("joint = { clearance = \"20 um\" }\n", ""),
    ]));
    let absent = Channel::chosen(&names, &particles.assembled().system);
    assert!(matches!(absent, Err(SimulationError::AbsentChannel { .. })));
}

#[rustfmt::skip]
const CASES: &[Mistake] = &[
    ("strands = 2\n", "", "chain.strands", 2, "give the number of strands"),
    ("[0, 0.1e-2]", "[0]", "chain.strand_elongations", 5, "1 values, needed are 2"),
    ("[1, 0.9]", "[1, 0.9, 1]", "chain.strand_stiffnesses", 6, "3 values, needed are 2"),
    ("[0, 0.1e-2]", "[0, 0.6]", "chain.strand_elongations[1]", 5, "must be at most 0.5"),
    ("[1, 0.9]", "[1, 0]", "chain.strand_stiffnesses[1]", 6, "must be positive"),
    ("\"bush-strands\"", "\"particles\"", "chain.strand_elongations", 5, "only bush strands share loads"),
    ("links = 60", "links = 61", "chain.links", 8, "inner and outer links alternate"),
    ("links = 60", "links = 60\nrollers = \"lumped\"", "chain.rollers", 9, "a chain of bush strands has none"),
    ("links = 60", "links = 60\nroller = { mass = \"1 g\" }", "chain.roller", 9, "a chain of bush strands has none"),
    ("links = 60", "links = 60\ninner = { mass = \"1 g\" }", "chain.inner", 9, "a chain of bush strands has none"),
    ("\"20 um\"", "\"-20 um\"", "chain.joint.clearance", 14, "not negative"),
    ("clearance = \"20 um\"", "length = \"4 mm\"", "chain.joint.length", 14, "only pins with clearance have one"),
];

#[test]
fn mistakes_in_strands_are_found() {
    all_found(UNLIKE, CASES, |found, expected| found == expected, 3);
}

//! Static states from scene texts against closed forms and an independent energy minimisation:
//! cases L01 to L10, V09 and V10.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;

use chaindrive::{Observation, Run, Scene, Simulation};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};

/// The settled state of a scene.
#[track_caller]
fn settled(scene: &str) -> Observation {
    let scene = Scene::from_text(scene, "scene").unwrap_or_else(|error| panic!("{error}"));
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let run = Run {
        until: 1e-6,
        every: 1e-6,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run).unwrap_or_else(|error| panic!("{error}"));
    let first = simulation.next_sample().expect("the state is finite");
    first.expect("a run begins with a sample").clone()
}

/// Ten rollers on a locked sprocket, pulled at both ends.
fn engaged(case: &Case) -> String {
    let input = |key: &str| case.number(&format!("inputs.{key}"));
    let (teeth, rollers) = (input("teeth"), input("rollers"));
    let pitch = input("sprocket_pitch");
    let radius = 0.5 * pitch / (PI / teeth).sin();
    let mut places = String::new();
    for j in 0..case.list("expected.contact_force").len() {
        let (sine, cosine) = (FRAC_PI_2 + 2.0 * PI * j as f64 / teeth).sin_cos();
        write!(places, "[{}, {}], ", radius * cosine, radius * sine).expect("a text grows");
    }
    format!(
        r#"
        gravity = [0, 0]

        [chain]
        pitch = {pitch}
        links = {}
        elongation = {}
        mass = "8.89 g"
        stiffness = {}
        roller_diameter = {}
        ends = [
            {{ kind = "pulled", force = [{}, 0] }},
            {{ kind = "pulled", force = [{}, 0] }},
        ]
        start = {{ kind = "points", positions = [{places}] }}

        [[sprockets]]
        name = "locked"
        teeth = {teeth}
        centre = [0, 0]
        motion = "held"
        tooth = {{ kind = "iso606", gap = {}, tip = "max", seat = "pitch" }}

        [contact.teeth]
        law = {{ kind = "linear", stiffness = {} }}
        "#,
        rollers - 1.0,
        input("chain_pitch") / pitch - 1.0,
        input("link_stiffness"),
        input("roller_diameter"),
        input("T0"),
        input("Tn"),
        input("gap"),
        input("contact_stiffness"),
    )
}

/// The tensions, forces and places of least energy, for six sets of loads and gaps.
#[test]
fn engaged_rollers_share_the_load_as_the_energy_minimum_does() {
    for id in ["L03", "L04", "L05", "L06", "L07", "L10"] {
        let case = Case::read(id);
        let found = settled(&engaged(&case));
        let tolerance = case.number("tolerance");
        let relative = Relative(tolerance);
        let expected = case.list("expected.link_tension");
        let tensions = &found.link_tension;
        case.judge_each("link tensions", "N", tensions, &expected, relative);
        let expected = case.list("expected.contact_force");
        let forces = &found.contact_force;
        case.judge_each("contact forces", "N", forces, &expected, relative);
        let places = case.table("expected.roller_xy");
        let [x, y] = [0, 1].map(|axis| places.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let pitch = case.number("inputs.sprocket_pitch");
        let places = Absolute(tolerance * pitch);
        case.judge_each("places along x", "m", &found.roller_x, &x, places);
        case.judge_each("places along y", "m", &found.roller_y, &y, places);
        // Nothing remains of the torque where the pulls are equal.
        let pull = case.number("inputs.T0") * x[0].hypot(y[0]);
        let expected = [case.number("expected.sprocket_torque")];
        let (torque, allowed) = (&found.sprocket_torque, Absolute(tolerance * pull));
        case.judge_each("torque", "N m", torque, &expected, allowed);
    }
}

/// A strand around a locked sprocket with straight flanks: every roller touches the flank on the
/// tight side at the pressure angle φ, with its pin on the pitch circle.
///
/// ```text
///      flanks at ±β from the gap axis, pins at ψ beside it on the tight side:
///      β = α + φ + ψ,   α = π/z,   y₀ = R (cos ψ − sin ψ / tan β)
/// ```
///
/// y₀ is the apex of the lines on which the pins can lie. The first roller is pulled along the link
/// that would precede it; the last one along the link that would follow, or held on the
/// pitch circle, so that the pull at it is an answer.
fn straight_flanks(teeth: f64, phi: f64, pulls: [f64; 2], links: usize) -> String {
    let pulled = |force: f64, angle: f64| {
        let (x, y) = (force * angle.cos(), force * angle.sin());
        format!(r#"{{ kind = "pulled", force = [{x}, {y}] }}"#)
    };
    let pitch = 0.0127;
    let radius = 0.15 * pitch;
    let alpha = PI / teeth;
    let psi = 0.05 * alpha;
    let beta = alpha + phi + psi;
    let pitch_radius = 0.5 * pitch / alpha.sin();
    let apex = pitch_radius * (psi.cos() - psi.sin() / beta.tan());
    // From the bottom of the gap, r / sin β below the apex, to the tooth centre line.
    let bottom = apex - radius / beta.sin();
    let run = bottom * alpha.sin() / (beta - alpha).sin();
    let tip = [run * beta.sin(), bottom + run * beta.cos()];
    let mut places = String::new();
    for j in 0..=links {
        let (sine, cosine) = (FRAC_PI_2 + 2.0 * alpha * j as f64).sin_cos();
        write!(
            places,
            "[{}, {}], ",
            pitch_radius * cosine,
            pitch_radius * sine
        )
        .expect("a text grows");
    }
    format!(
        r#"
        gravity = [0, 0]

        [chain]
        pitch = {pitch}
        links = {links}
        mass = "8.89 g"
        stiffness = "10 GN/m"
        roller_diameter = {}
        ends = [{}, {}]
        start = {{ kind = "points", positions = [{places}] }}

        [[sprockets]]
        name = "straight"
        teeth = {teeth}
        centre = [0, 0]
        motion = "held"
        gap_angle = {}

        [sprockets.tooth]
        kind = "path"
        from = [{}, {}]
        pieces = [
            {{ kind = "line", to = [0, {bottom}] }},
            {{ kind = "line", to = [{}, {}] }},
        ]

        [contact.teeth]
        law = {{ kind = "linear", stiffness = "10 GN/m" }}
        "#,
        2.0 * radius,
        pulled(pulls[0], -alpha),
        if pulls[1] > 0.0 {
            pulled(pulls[1], 2.0 * alpha * links as f64 + alpha + PI)
        } else {
            r#""fixed""#.to_owned()
        },
        FRAC_PI_2 + psi,
        tip[0],
        tip[1],
        -tip[0],
        tip[1],
    )
}

#[test]
fn tension_falls_geometrically_over_straight_flanks() {
    let case = Case::read("L02");
    for (i, input) in case.table("inputs.rows").iter().enumerate() {
        let tensions = case.list(&format!("expected.{i}.link_tension"));
        let forces = case.list(&format!("expected.{i}.contact_force"));
        let rollers = forces.len();
        let phi = input[1].to_radians();
        let tolerance = Relative(case.number("tolerance"));
        let judge = |quantity: &str, found: &[f64], expected: &[f64]| {
            case.judge_each(quantity, "N", found, expected, tolerance);
        };
        let pulls = [input[2], tensions[rollers]];
        let found = settled(&straight_flanks(input[0], phi, pulls, rollers - 1));
        let inner = &tensions[1..rollers];
        judge("link tensions", &found.link_tension, inner);
        judge("contact forces", &found.contact_force, &forces);
        // Held instead of pulled, the last roller asks for the same pull.
        let held = settled(&straight_flanks(input[0], phi, [input[2], 0.0], rollers));
        let quantity = "link tensions, the last roller held";
        judge(quantity, &held.link_tension, &tensions[1..]);
    }
}

#[test]
fn tension_falls_geometrically_at_the_standard_pressure_angles() {
    let case = Case::read("L01");
    let expected = case.table("expected.rows");
    for (input, expected) in case.table("inputs.rows").iter().zip(expected) {
        let teeth = input[0];
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "half of an even number of teeth"
        )]
        let around = (0.5 * teeth) as usize;
        let found = settled(&straight_flanks(
            teeth,
            input[1].to_radians(),
            [1.0, 0.0],
            around,
        ));
        let tension = |k: usize| found.link_tension[k - 1];
        let got = [1, 2, 3, 5, around].map(tension);
        let tolerance = Relative(case.number("tolerance"));
        case.judge_each("link tensions", "T₀", &got, &expected, tolerance);
    }
}

/// A slack strand between two pins, stiff enough to be that of hinged rigid links.
#[test]
fn slack_strands_hang_as_hinged_links() {
    for id in ["V09", "V10"] {
        let case = Case::read(id);
        let input = |key: &str| case.number(&format!("inputs.{key}"));
        let (mass, gravity) = (input("mass"), input("gravity"));
        let found = settled(&format!(
            r#"
            gravity = [0, -{gravity}]

            [chain]
            pitch = {}
            links = {}
            mass = {mass}
            stiffness = "30 GN/m"
            ends = ["fixed", "fixed"]
            start = {{ kind = "hang", from = [0, 0], to = [{}, 0] }}
            "#,
            input("pitch"),
            input("links"),
            input("distance"),
        ));
        let tolerance = case.number("tolerance");
        let (x, y) = (&found.roller_x, &found.roller_y);
        let angles: Vec<f64> = (0..x.len() - 1)
            .map(|i| (y[i + 1] - y[i]).atan2(x[i + 1] - x[i]))
            .collect();
        let expected = case.list("expected.link_angle");
        let allowed = Absolute(tolerance);
        case.judge_each(
            "directions of the links",
            "rad",
            &angles,
            &expected,
            allowed,
        );
        let sag = y.iter().fold(0.0_f64, |lowest, y| lowest.min(*y));
        let pull = found.link_tension[0] * angles[0].cos();
        // Half of the first link hangs from the pin itself.
        let vertical = found.link_tension[0] * angles[0].sin() - 0.5 * mass * gravity;
        for (quantity, unit, got, key) in [
            ("sag", "m", -sag, "sag"),
            ("horizontal pull", "N", pull, "horizontal_pull"),
            (
                "vertical force at the pin",
                "N",
                vertical,
                "first_pin_vertical",
            ),
            ("force at the pin", "N", pull.hypot(vertical), "end_tension"),
        ] {
            let expected = case.number(&format!("expected.{key}"));
            case.judge(quantity, unit, got, expected, Relative(tolerance));
        }
    }
}

/// A worn chain on the 16B drive, its wheels moved apart until it closes, finds its equilibrium: the teeth
/// of the driven wheel carry its load, −M = 1433 N m, whatever the wear.
///
/// The path from no weight to all of it has folds, where rollers slide from one flank to the next.
#[test]
fn a_worn_chain_settles() {
    worn_chains_settle(&[(0.002, 1500.0), (0.03, 1500.0)]);
}

#[test]
#[ignore = "a study: more wear and pretensions"]
fn a_worn_chain_settles_however_worn() {
    worn_chains_settle(&[(0.002, 0.0), (0.01, 500.0), (0.01, 5000.0), (0.02, 1500.0)]);
}

fn worn_chains_settle(chains: &[(f64, f64)]) {
    let preset = Scene::preset("industrial_16b").expect("a preset");
    let adjust = serde_json::json!({
        "kind": "sprocket", "name": "driven", "direction": [1, 0], "within": 0.2
    });
    for &(elongation, pretension) in chains {
        let scene = preset
            .replace_json("route.pretension", &pretension.into())
            .and_then(|scene| scene.replace_json("route.adjust", &adjust))
            // At rest: closing speeds would add damping forces.
            .and_then(|scene| scene.replace_json("sprockets.driver.motion", &"held".into()))
            .and_then(|scene| scene.replace_json("chain.elongation", &elongation.into()))
            .unwrap_or_else(|error| panic!("{error}"));
        let state = settled(scene.text());
        let torque = state.sprocket_torque[1];
        assert!(
            (torque / 1433.0 - 1.0).abs() <= 1e-4,
            "torque {torque} N m at {elongation} and {pretension} N"
        );
    }
}

/// The 16B drive at rest with a worn chain, its driven sprocket moved out as far as it takes.
fn worn(elongation: &str) -> Observation {
    let adjust = r#"{ kind = "sprocket", name = "driven", direction = [1, 0], within = 0.1 }"#;
    let scene = Scene::preset("industrial_16b")
        .and_then(|scene| scene.replace("chain.elongation", elongation))
        .and_then(|scene| scene.replace("route.adjust", adjust))
        .unwrap_or_else(|error| panic!("{error}"));
    settled(scene.text())
}

/// A chain worn by 4 % rides 9 mm outside the pitch circle of 57 teeth, and its spans still have a tension.
#[test]
fn spans_of_a_heavily_worn_chain_have_a_tension() {
    let state = worn("0.04");
    assert!(
        state.span_tension.iter().all(|tension| *tension > 0.0),
        "{:?}",
        state.span_tension
    );
}

/// A worn chain sets off with its wheels, however high it rides on them: every roller that touches teeth has the
/// velocity of the wheel at its place, ω ẑ × d.
#[test]
fn a_worn_chain_sets_off_with_its_wheels() {
    let state = worn("0.03");
    let mut touching = 0;
    for i in 0..state.roller_x.len() {
        if state.contact_force[i] <= 0.0 {
            continue;
        }
        touching += 1;
        let slip = (0..2).map(|wheel| {
            let (dx, dy) = (
                state.roller_x[i] - state.sprocket_x[wheel],
                state.roller_y[i] - state.sprocket_y[wheel],
            );
            let spin = state.sprocket_speed[wheel];
            (state.roller_vx[i] + spin * dy).hypot(state.roller_vy[i] - spin * dx)
        });
        // The chain runs at 2.4 m/s.
        let least = slip.fold(f64::INFINITY, f64::min);
        assert!(least < 1e-9, "roller {i} slips at {least} m/s");
    }
    assert!(touching > 20, "{touching}");
}

/// Theory: chain on two held wheels, whole links between them, no gravity and no load: every link carries the pretension, however
/// soft it is, and whatever its length.
#[test]
fn links_carry_the_pretension_that_is_asked_for() {
    let (teeth, links, pitch, pull) = (24.0, 30.0, 0.0127, 800.0);
    for stiffness in [2e5, 1e6, 1e8] {
        for lengths in ["", "elongation = 5e-4"] {
            let wheel = |name: &str, x: f64| {
                format!(
                    r#"
                    [[sprockets]]
                    name = "{name}"
                    teeth = {teeth}
                    centre = [{x}, 0]
                    motion = "held"
                    tooth = {{ kind = "circular", seat_radius = 0.0042555 }}
                    "#
                )
            };
            let scene = format!(
                r#"
                gravity = [0, 0]
                [chain]
                pitch = {pitch}
                links = {}
                mass = 9e-3
                stiffness = {stiffness}
                roller_diameter = 0.00851
                {lengths}
                {}{}
                [contact.teeth]
                law = {{ kind = "linear", stiffness = 1e12 }}
                [route]
                pretension = {pull}
                "#,
                teeth + 2.0 * links,
                wheel("a", 0.0),
                wheel("b", links * pitch),
            );
            for tension in settled(&scene).span_tension {
                assert!(
                    (tension / pull - 1.0).abs() < 1e-3,
                    "{tension} N, not {pull} N, with links of {stiffness:e} N/m {lengths}"
                );
            }
        }
    }
}

/// A pretension that would stretch links to more than twice their length is refused.
#[test]
fn a_pretension_beyond_all_stretch_is_refused() {
    let soft = Scene::preset("industrial_16b")
        .and_then(|scene| scene.replace("chain.stiffness", "10 kN/m"))
        .and_then(|scene| scene.replace("route.pretension", "3 kN"))
        .unwrap_or_else(|error| panic!("{error}"));
    let drive = soft.drive().unwrap_or_else(|error| panic!("{error}"));
    let refused = drive.assemble().expect_err("3 kN on links of 10 kN/m");
    assert!(
        refused.to_string().contains("lower the pretension"),
        "{refused}"
    );
}

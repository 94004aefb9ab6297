//! Drives that torques turn, chains that sag on purpose, and what is said of those that cannot be.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::{PI, TAU};

use chaindrive::describe::spans_at_rest;
use chaindrive::scene::Scene;
use chaindrive::{Description, Run, Simulation};
use chaindrive_mechanics::Assembled;

/// Teeth and inertia \[kg m²\] of motor and conveyor.
const TEETH: [f64; 2] = [17.0, 38.0];
const INERTIA: [f64; 2] = [0.02, 1.5];
const PITCH: f64 = 12.7e-3;

/// A motor by its torque over speed, and a conveyor with a constant load.
fn conveyor(motor: &str, load: &str) -> String {
    format!(
        r#"
[chain]
type = "08B-1"
[[sprockets]]
name = "motor"
teeth = 17
centre = [0, 0]
inertia = 0.02
{motor}
[[sprockets]]
name = "conveyor"
teeth = 38
centre = ["600 mm", 0]
inertia = 1.5
{load}
[route]
pretension = "800 N"
adjust = {{ kind = "sprocket", name = "motor", direction = [-1, 0], within = "10 mm" }}
"#
    )
}

const TABLE: &str = r#"drive = [{ kind = "speed-table", speeds = ["0 rpm", "135 rpm", "142.5 rpm", "150 rpm", "165 rpm"], torques = [110, 120, 60, 0, -120] }]"#;
const LOAD: &str = r#"load = [{ kind = "constant", torque = -60 }]"#;

fn assembled(text: &str) -> Result<Assembled, String> {
    let scene = Scene::from_text(text, "test.toml").map_err(|error| error.to_string())?;
    let drive = scene.drive().map_err(|error| error.to_string())?;
    drive.assemble().map_err(|error| error.to_string())
}

fn tensions(assembled: &Assembled) -> Vec<f64> {
    let spans = spans_at_rest(&assembled.drive, assembled);
    spans.into_iter().map(|span| span.tension).collect()
}

fn refused(text: &str) -> String {
    match assembled(text) {
        Ok(_) => panic!("it stands"),
        Err(error) => error,
    }
}

/// From rest the motor speeds up all that it turns; the chain carries what the conveyor takes of it.
///
/// ```text
/// α = (M₁ + i M₂)/(J₁ + i² J₂),   i = z₁/z₂,   (T − t) R₁ = M₁ − J₁ α
/// ```
#[test]
fn a_motor_speeds_up_from_rest_and_its_chain_carries_that() {
    let assembled = assembled(&conveyor(TABLE, LOAD)).unwrap();
    let [z1, z2] = TEETH;
    let ratio = z1 / z2;
    let net = 110.0 - ratio * 60.0;
    let inertia = INERTIA[0] + ratio * ratio * INERTIA[1];
    let trains = assembled.free_trains();
    let [train] = trains.as_slice() else {
        panic!("{trains:?}")
    };
    assert!((train.torque - net).abs() < 1e-9 * net, "{train:?}");
    assert!((train.acceleration() - net / inertia).abs() < 1e-9 * net / inertia);
    let radius = 0.5 * PITCH / (PI / z1).sin();
    let pull = (110.0 - INERTIA[0] * net / inertia) / radius;
    let spans = tensions(&assembled);
    // The weight of the spans and the polygons make some tenths of a per cent of it.
    let found = spans[1] - spans[0];
    assert!((found / pull - 1.0).abs() < 0.01, "{found} N for {pull} N");
}

/// 60 (150 − n)/7.5 N m of the motor are 60 z₁/z₂ N m: n = 150 − 7.5 z₁/z₂ r/min.
#[test]
fn a_drive_starts_where_its_torques_balance() {
    let motor = format!("speed = \"working-point\"\n{TABLE}");
    let assembled = assembled(&conveyor(&motor, LOAD)).unwrap();
    let expected = (150.0 - 7.5 * TEETH[0] / TEETH[1]) * TAU / 60.0;
    let speeds = assembled.mean_speeds();
    assert!((speeds[0] / expected - 1.0).abs() < 1e-9, "{speeds:?}");
    assert!((speeds[1] / speeds[0] - TEETH[0] / TEETH[1]).abs() < 1e-9);
    // The chain carries the load, and nothing speeds up.
    let radius = 0.5 * PITCH / (PI / TEETH[1]).sin();
    let spans = tensions(&assembled);
    assert!(((spans[1] - spans[0]) * radius / 60.0 - 1.0).abs() < 0.01);
    assert!(assembled.free_trains()[0].torque.abs() < 1e-9);
}

#[test]
fn a_speed_at_the_start_is_that_of_all_that_is_joined() {
    let load = format!("speed = \"60 rpm\"\n{LOAD}");
    let speeds = assembled(&conveyor(TABLE, &load)).unwrap().mean_speeds();
    assert!((speeds[0] * TEETH[0] / (TEETH[1] * TAU) - 1.0).abs() < 1e-9);
    let motor = format!("speed = \"60 rpm\"\n{TABLE}");
    let error = refused(&conveyor(&motor, &load));
    assert!(
        error.contains("sprockets.conveyor.speed: it turns at 26.84 rpm"),
        "{error}"
    );
    let driven = r#"motion = { kind = "constant", speed = "60 rpm" }"#;
    let error = refused(&conveyor(driven, &load));
    assert!(error.contains("it turns at 26.84 rpm"), "{error}");
    let both = format!("speed = 1\n{driven}");
    let error = refused(&conveyor(&both, LOAD));
    assert!(error.contains("`motion` is given too"), "{error}");
    let word = "speed = \"working point\"\ndrive = [{ kind = \"constant\", torque = 50 }]";
    let error = refused(&conveyor(word, LOAD));
    assert!(error.contains("does not begin with a number"), "{error}");
    let endless = "speed = \"working-point\"\ndrive = [{ kind = \"constant\", torque = 50 }]";
    let error = refused(&conveyor(endless, LOAD));
    assert!(error.contains("balance at no speed"), "{error}");
}

/// A torque that asks for tens of breaking loads is refused before an equilibrium is looked for; torques that balance on their shaft are
/// nobody's overload.
#[test]
fn a_chain_that_no_load_could_spare_is_named_at_once() {
    let driven = r#"motion = { kind = "constant", speed = "60 rpm" }"#;
    for sign in ["-", ""] {
        let load = format!(r#"load = [{{ kind = "constant", torque = "{sign}40 kN m" }}]"#);
        let error = refused(&conveyor(driven, &load));
        assert!(
            error.contains("40000.0 N m on `conveyor`") && error.contains("breaks at 18.0"),
            "{error}"
        );
    }
    let balanced = r#"drive = [{ kind = "constant", torque = 40000 }]
load = [{ kind = "constant", torque = -40060 }]"#;
    let spans = tensions(&assembled(&conveyor(driven, balanced)).unwrap());
    let radius = 0.5 * PITCH / (PI / TEETH[1]).sin();
    assert!(((spans[1] - spans[0]) * radius / 60.0 - 1.0).abs() < 0.01);
}

/// Two sprockets of eleven teeth, which settle or fail in a second; `more` are tables in front of the route.
fn short(chain: &str, motor: &str, torque: &str, more: &str) -> String {
    format!(
        "chain = {chain}
        gravity = [0, 0]
        [[sprockets]]
        name = 'motor'
        teeth = 11
        centre = [0, 0]
        {motor}
        [[sprockets]]
        name = 'conveyor'
        teeth = 11
        centre = ['127 mm', 0]
        inertia = 0.1
        load = [{{ kind = 'constant', torque = '{torque}' }}]
        {more}
        [route]
        pretension = '150 N'
        adjust = {{ kind = 'sprocket', name = 'motor', direction = [-1, 0], within = '20 mm' }}"
    )
}

const DRIVEN: &str = "motion = { kind = 'constant', speed = '60 rpm' }";

/// T = M/R, R = p/(2 sin(π/z)): 4 kN m on eleven teeth of 12.7 mm pull with 177.5 kN, whether or not it is known what the chain bears.
#[test]
fn a_load_is_named_whatever_is_known_of_the_chain() {
    let plain =
        "{ pitch = '12.7 mm', mass = '9 g', stiffness = '20 MN/m', roller_diameter = '8.5 mm' }";
    let error = refused(&short(plain, DRIVEN, "-4 kN m", ""));
    let pull = "the torque of 4000.0 N m on `conveyor` asks for a pull of 177.5 kN";
    assert!(
        error.contains(&format!("{pull}: see that the chain")),
        "{error}"
    );
    // Turning the other way, the other strand is tight.
    let clockwise = DRIVEN.replace("60 rpm", "-60 rpm");
    let error = refused(&short("'08B-1'", &clockwise, "4 kN m", ""));
    assert!(
        error.contains(&format!("{pull}, and the chain breaks at 18.0 kN")),
        "{error}"
    );
    assert!(!error.contains("tensioner"), "{error}");
}

/// Torque that speeds a free train up does not pull at the chain: of 4 and 3 kN m on equal inertias the mean is left.
#[test]
fn what_speeds_a_drive_up_is_told_beside_its_load() {
    let motor = "inertia = 0.1\ndrive = [{ kind = 'constant', torque = '3 kN m' }]";
    let error = refused(&short("'08B-1'", motor, "-4 kN m", ""));
    let told = "the torque of 4000.0 N m on `conveyor`, 3500.0 N m of it at the chain while the drive speeds up, asks for a pull of 155.3 kN";
    assert!(error.contains(told), "{error}");
}

#[test]
fn loads_of_several_sprockets_add_up() {
    let third = "[[sprockets]]
        name = 'third'
        teeth = 11
        centre = ['63 mm', '80 mm']
        inertia = 0.1
        load = [{ kind = 'constant', torque = '-1.5 kN m' }]";
    let error = refused(&short("'08B-1'", DRIVEN, "-1.5 kN m", third));
    let told = "the torque of 3000.0 N m that the loads ask of `motor` asks for a pull of 133.1 kN, and the chain breaks";
    assert!(error.contains(told), "{error}");
}

/// A load on a second chain pulls at the first one through the shaft between them.
#[test]
fn a_load_behind_another_chain_is_named() {
    let chain = |name: &str, kind: &str, stops: &str, adjusted: &str| {
        format!(
            "[[chains]]
            name = '{name}'
            type = '{kind}'
            [chains.route]
            stops = [{stops}]
            pretension = '150 N'
            adjust = {{ kind = 'sprocket', name = '{adjusted}', direction = [-1, 0], within = '20 mm' }}\n"
        )
    };
    let sprocket = |name: &str, at: u32, more: &str| {
        format!("[[sprockets]]\nname = '{name}'\nteeth = 11\ncentre = ['{at} mm', 0]\n{more}\n")
    };
    let load = "inertia = 0.1\nload = [{ kind = 'constant', torque = '-2.5 kN m' }]";
    let scene = [
        "gravity = [0, 0]\n".to_owned(),
        chain("first", "08B-1", "'motor', 'in'", "motor"),
        chain("second", "16B-1", "'out', 'drum'", "drum"),
        "[[shafts]]\nname = 'jack'\nsprockets = ['in', 'out']\n".to_owned(),
        sprocket("motor", 0, DRIVEN),
        sprocket("in", 127, "inertia = 0.1"),
        sprocket("out", 127, "inertia = 0.1"),
        sprocket("drum", 400, load),
    ];
    let error = refused(&scene.concat());
    // On equal numbers of teeth.
    let told = "chain `first`: the torque of 2500.0 N m on `in` asks for a pull of 110.9 kN";
    assert!(error.contains(told), "{error}");
}

/// A rail lies under the carrying run; what the chain is too long hangs in the return run.
#[test]
fn a_chain_hangs_where_no_rail_carries_it() {
    for short in [0.0, 2.0, 8.0] {
        let centre = 0.5 * (160.0 - 20.0) * 25.4 - short;
        let text = format!(
            r#"
[chain]
type = "16B-1"
links = 160
[[sprockets]]
name = "head"
teeth = 20
centre = [0, 0]
motion = {{ kind = "constant", speed = "40 rpm" }}
[[sprockets]]
name = "tail"
teeth = 20
centre = ["{centre} mm", 0]
inertia = 0.5
[[guides]]
name = "rail"
face = {{ kind = "bar", start = ["{} mm", "71.5 mm"], end = ["300 mm", "71.5 mm"], end_radius = "2 m", end_angle = "3 deg", material = "left" }}
"#,
            centre - 300.0
        );
        let assembled = assembled(&text).unwrap_or_else(|error| panic!("{short}: {error}"));
        let links: u32 = assembled
            .fittings
            .iter()
            .flatten()
            .map(|it| it.spans.iter().sum::<u32>() + it.seated.iter().sum::<u32>())
            .sum();
        assert_eq!(links, 160, "{short}");
    }
}

/// The slack run hangs as deep as asked, whichever it is, and the sprocket goes where that takes it.
#[test]
fn a_chain_sags_as_deep_as_asked() {
    for (span, torque, sag) in [
        ("driven-driver", 4.0, 20e-3),
        ("driver-driven", -4.0, 12e-3),
    ] {
        let text = format!(
            r#"
[chain]
type = "08B-1"
links = 124
[[sprockets]]
name = "driver"
teeth = 19
centre = [0, 0]
motion = {{ kind = "constant", speed = "60 rpm" }}
[[sprockets]]
name = "driven"
teeth = 19
centre = ["660 mm", 0]
inertia = 0.05
load = [{{ kind = "constant", torque = {torque} }}]
[route]
sag = {sag}
slack_span = "{span}"
adjust = {{ kind = "sprocket", name = "driven", direction = [1, 0], within = "20 mm" }}
"#
        );
        let assembled = assembled(&text).unwrap();
        let at = usize::from(span == "driven-driver");
        let spans = tensions(&assembled);
        assert!(spans[1 - at] > 3.0 * spans[at], "{spans:?}");
        // Both runs leave and arrive at the pitch radius above or below the line of centres.
        let radius = 0.5 * PITCH / (PI / 19.0).sin();
        let chord = if at == 1 { radius } else { -radius };
        let middle = 0.5 * assembled.fittings[0].as_ref().unwrap().wheels[1].centre.x;
        let found = depth_of_sag(&assembled, chord, middle);
        // The ends of the bow lie on polygons, and what the load stretches hangs there too.
        assert!(
            (found / sag - 1.0).abs() < 0.05,
            "{span}: {found} for {sag}"
        );
    }
    let short = conveyor(TABLE, LOAD).replace(
        "pretension = \"800 N\"",
        "sag = 0.01\nslack_span = \"motor-conveyer\"",
    );
    let error = refused(&short);
    assert!(
        error.contains("did you mean `motor-conveyor`") || error.contains("motor-conveyor"),
        "{error}"
    );
    let nothing = conveyor(TABLE, LOAD)
        .replace("pretension = \"800 N\"", "sag = 0.01")
        .replace("adjust =", "#");
    assert!(refused(&nothing).contains("nothing is moved to make it"));
}

/// Without a load both runs share the slack, and each hangs f/√2 deep; what the closing tells of it is that.
#[test]
fn runs_that_nothing_pulls_share_the_slack() {
    let text = r#"
[chain]
type = "08B-1"
links = 124
[[sprockets]]
name = "driver"
teeth = 19
centre = [0, 0]
motion = { kind = "constant", speed = "60 rpm" }
[[sprockets]]
name = "driven"
teeth = 19
centre = ["660 mm", 0]
inertia = 0.05
[route]
sag = "13 mm"
slack_span = "driver-driven"
adjust = { kind = "sprocket", name = "driven", direction = [1, 0], within = "20 mm" }
"#;
    let assembled = assembled(text).unwrap();
    let told = Description::of_assembled(&assembled, &Run::default()).unwrap();
    let sag = told.chains[0]
        .closing
        .as_ref()
        .unwrap()
        .sag
        .clone()
        .unwrap();
    assert_eq!((sag.span.as_str(), sag.asked), ("driver-driven", 13e-3));
    assert!(
        (sag.shared * 2.0_f64.sqrt() / 13e-3 - 1.0).abs() < 1e-3,
        "{}",
        sag.shared
    );
    assert!(
        told.to_string()
            .contains("`sag = \"18.4 mm\"` makes that 13.0 mm"),
        "{told}"
    );
    let radius = 0.5 * PITCH / (PI / 19.0).sin();
    let middle = 0.5 * assembled.fittings[0].as_ref().unwrap().wheels[1].centre.x;
    let found = depth_of_sag(&assembled, -radius, middle);
    assert!(
        (found / sag.shared - 1.0).abs() < 0.05,
        "{found} for {}",
        sag.shared
    );
}

/// How deep the roller nearest to the middle of a run hangs below its chord \[m\].
fn depth_of_sag(assembled: &Assembled, chord: f64, middle: f64) -> f64 {
    let mut simulation = Simulation::from_assembled(assembled.clone(), &Run::default()).unwrap();
    let seen = simulation.next_sample().unwrap().unwrap();
    let places = seen.roller_x.iter().zip(&seen.roller_y);
    let near = places.filter(|(_, y)| (*y - chord).abs() < 0.04);
    let nearest = near.min_by(|a, b| (a.0 - middle).abs().total_cmp(&(b.0 - middle).abs()));
    chord - nearest.unwrap().1
}

/// A worn chain on the centres that a new one had: two equal sprockets, some pitches apart.
fn worn(teeth: u32, links: u32, pitches: f64, elongation: f64) -> String {
    format!(
        r#"
[chain]
pitch = "12.7 mm"
links = {links}
mass = "9 g"
stiffness = "20 MN/m"
roller_diameter = "8.51 mm"
elongation = {elongation}
[[sprockets]]
name = "a"
teeth = {teeth}
centre = [0, 0]
motion = "held"
[[sprockets]]
name = "b"
teeth = {teeth}
centre = ["{} mm", 0]
inertia = 0.02
"#,
        pitches * 12.7
    )
}

/// What a chain has worn hangs as slack, more than a pitch of it too; a chain that its teeth do not hold is refused with that reason.
#[test]
fn worn_chains_hang_on_their_old_centres() {
    let hung = assembled(&worn(20, 90, 35.0, 0.015)).unwrap();
    let spans = tensions(&hung);
    // T = w L²/8 f, f = √(3 L e/8), e: half of 90 · 1.5 % p
    let (chord, spare) = (35.0 * PITCH, 0.5 * 90.0 * 0.015 * PITCH);
    let weight = 9e-3 / PITCH * 9.81;
    let pull = weight * chord * chord / (8.0 * (0.375 * chord * spare).sqrt());
    for tension in spans {
        assert!((tension / pull - 1.0).abs() < 0.2, "{tension} for {pull}");
    }
    let error = refused(&worn(100, 200, 50.0, 0.04));
    assert!(
        error.contains("rides 8.1 mm above its pitch circle") && error.contains("it jumps"),
        "{error}"
    );
}

/// A drive that torques turn begins at the phase of the scene, however loosely its chain lies in the teeth, and does not look for another one.
#[test]
fn a_train_that_moves_is_settled_at_its_phase() {
    for pretension in ["20 N", "200 N", "800 N"] {
        for phase in [0.0, 0.3, 0.5] {
            let motor = format!("speed = \"working-point\"\n{TABLE}");
            let text = conveyor(&motor, LOAD).replace("800 N", pretension);
            let text = text.replace("[route]", &format!("[route]\nphase = {phase}"));
            let start = assembled(&text).unwrap_or_else(|error| panic!("{error}"));
            for it in &start.statics {
                assert!(it.iterations < 100, "{pretension}, {phase}: {it:?}");
            }
            let simulation = Simulation::from_assembled(start, &Run::default());
            let mut simulation = simulation.unwrap_or_else(|error| panic!("{error}"));
            let seen = simulation.advance_to(0.0).expect("it begins");
            let slipped = seen.sprocket_angle[0];
            assert_eq!(
                slipped.to_bits(),
                0.0_f64.to_bits(),
                "{pretension}, {phase}"
            );
        }
    }
}

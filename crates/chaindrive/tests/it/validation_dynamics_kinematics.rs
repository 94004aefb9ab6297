//! Slow drives of light, stiff chains against the exact kinematics (validation cases I01 to I04, K02,
//! K03, K05, K07, K08, K10, K12 to K14, X03).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::two_sprockets::{LOWER_SPAN_HANGS, TwoSprockets, steady};
use chaindrive::{Observation, Scene};
use chaindrive_geometry::{PolygonAction, TwoWheels};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use dynamics::{holding_gap, mean, range, run, spreading_rod};

/// Angle \[rad\] of a tooth gap of the driver at the origin when the chain is laid.
fn gap_angle(text: &str, driver: usize) -> f64 {
    let scene = Scene::from_text(text, "case.toml").unwrap_or_else(|error| panic!("{error}"));
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let places = &drive.layouts().expect("the chain closes")[0].positions;
    let radius = drive.sprockets[driver].gap.pitch_radius;
    let seated = places
        .iter()
        .find(|p| (p.coords.norm() / radius - 1.0).abs() < 1e-9);
    let seated = seated.expect("a roller is seated");
    seated.y.atan2(seated.x)
}

/// Angle \[rad\] of the driver's leading seat in the kinematics at θ₁ = 0, just after seating.
fn leading_seat(action: &PolygonAction) -> f64 {
    let begin = action.driven(0.0);
    // φ_A past the normal of the span, in the sense of the rotation
    FRAC_PI_2 + begin.span_angle + begin.driver_seat
}

#[test]
fn x03_transmission_error_of_a_slow_drive() {
    let case = Case::read("X03");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (z, pitch, distance) = (input("z1"), input("p"), input("C"));
    let text = TwoSprockets {
        before: &format!("gravity = [0, {}]", -input("g")),
        pitch,
        links: input("N"),
        mass: input("m"),
        stiffness: input("kl"),
        roller: input("d1"),
        chain: &format!("damping = {}", input("dl")),
        contact: 1e8,
        teeth_keys: "restitution = 0.5",
        teeth: [z; 2],
        tooth: "{ kind = \"iso606\", gap = \"min\" }",
        centre: [distance, 0.0],
        driver: &format!(
            "motion = {{ kind = \"ramp\", from = 0, to = {}, start = {}, duration = {} }}",
            input("w1"),
            input("t_hold"),
            input("t_ramp")
        ),
        inertia: input("J2"),
        driven: &format!(
            "load = [{{ kind = \"constant\", torque = {} }}, {{ kind = \"resistance\", linear = {} }}]",
            -input("M2"),
            input("visc")
        ),
        after: LOWER_SPAN_HANGS,
        until: input("T"),
        every: 1e-4,
        ..TwoSprockets::NOTHING
    }
    .text();
    let action = PolygonAction::new(17, 17, pitch, distance).expect("a drive");
    let turn_to_seat = leading_seat(&action) - gap_angle(&text, 0);
    let period = TAU / z;
    let steady = input("t_hold") + 2.0 * input("t_ramp");
    let mut bins = vec![(Vec::new(), Vec::new()); 12];
    let mut tight = Vec::new();
    run(&text, |sample| {
        if sample.time < steady {
            return;
        }
        let (first, second) = (sample.sprocket_angle[0], sample.sprocket_angle[1]);
        let driver = first - turn_to_seat;
        let phase = (driver / period).rem_euclid(1.0);
        let bin = &mut bins[(1..12)
            .take_while(|i| phase * 12.0 >= f64::from(*i))
            .count()];
        bin.0.push(second - first);
        bin.1.push(action.transmission_error(driver));
        tight.push(sample.span_tension[0].max(sample.span_tension[1]));
    });
    let found: Vec<f64> = bins.iter().map(|bin| mean(&bin.0)).collect();
    let exact: Vec<f64> = bins.iter().map(|bin| mean(&bin.1)).collect();
    let (a, b) = (mean(&found), mean(&exact));
    let listed = case.table("expected.rows");
    let mut sum = 0.0;
    for i in 0..12 {
        let (found, exact) = (found[i] - a, exact[i] - b);
        println!(
            "X03: {i:2}: {found:+.2e} for {exact:+.2e}, listed {:+.2e}",
            listed[i][2]
        );
        sum += (found - exact).powi(2) / 12.0;
    }
    let rms = sum.sqrt();
    let pull = mean(&tight) / case.number("expected.torque_over_R2") - 1.0;
    println!(
        "X03: rms {rms:.2e}, other code {:.2e}; range {:.3e} for {:.3e}; offset {a:.2e}; pull {pull:.1e}",
        case.number("expected.rms_of_other_code"),
        range(&found),
        case.number("expected.ptp_exact"),
    );
    let tolerance = Absolute(case.number("tolerance.rms"));
    let quantity = "root mean square distance from the exact kinematics";
    case.judge(quantity, "rad", rms, 0.0, tolerance);
}

/// A drive that is nearly a linkage: light rollers in seats of their own radius, stiff links, and a
/// lower span that hangs slack.
struct Linkage {
    teeth: u32,
    /// Centre distance at which the links close without slack, in pitches.
    distance: f64,
    links: u32,
    torque: f64,
    /// Of the driver \[rad/s\].
    speed: f64,
    /// Of links, and of rollers on teeth \[N/m\].
    stiffness: f64,
}

const PITCH: f64 = 0.0127;
/// Speed of the driver \[rad/s\].
const SPEED: f64 = 2.0;
/// Samples a tooth.
const SAMPLES: usize = 600;

impl Linkage {
    fn text(&self) -> String {
        let period = TAU / f64::from(self.teeth) / self.speed;
        let teeth = f64::from(self.teeth);
        let (constant, viscous) = (-0.6 * self.torque, 0.4 * self.torque / self.speed);
        TwoSprockets {
            before: "settle = false",
            pitch: PITCH,
            links: self.links.into(),
            mass: 2e-4,
            stiffness: self.stiffness,
            damping_ratio: 0.2,
            roller: 0.6 * PITCH,
            contact: self.stiffness,
            damper: 1e-2 * self.stiffness.sqrt(),
            teeth: [teeth; 2],
            tooth: &format!("{{ kind = \"circular\", seat_radius = {} }}", 0.3 * PITCH),
            centre: [self.centre_distance(), 0.0],
            driver: &steady(self.speed),
            inertia: 2e-4,
            driven: &format!(
                "load = [{{ kind = \"ramp\", torque = {constant}, duration = {period} }}, {{ kind = \"resistance\", linear = {viscous} }}]"
            ),
            after: LOWER_SPAN_HANGS,
            until: 4.0 * period,
            every: period / SAMPLES as f64,
            ..TwoSprockets::NOTHING
        }
        .text()
    }

    /// Centre distance \[m\]: closer by a hundredth of a pitch, so that the lower span hangs.
    fn centre_distance(&self) -> f64 {
        (self.distance - 0.01) * PITCH
    }

    fn action(&self) -> PolygonAction {
        let distance = self.centre_distance();
        PolygonAction::new(self.teeth, self.teeth, PITCH, distance).expect("a drive")
    }

    /// Runs four teeth and shows every sample of the last two.
    fn run(&self, mut see: impl FnMut(&Observation)) {
        let period = TAU / f64::from(self.teeth) / self.speed;
        run(&self.text(), |sample| {
            if sample.time > 2.0 * period - 1e-9 {
                see(sample);
            }
        });
    }
}

/// Range of the speed ratio over pieces of a tooth, and of the transmission error.
fn ripple(angles: &[(f64, f64)]) -> (f64, f64) {
    let window = SAMPLES / 20;
    let ratio = angles.windows(window + 1).map(|w| {
        let (from, to) = (w[0], w[window]);
        (to.1 - from.1) / (to.0 - from.0)
    });
    let error: Vec<f64> = angles.iter().map(|(a, b)| b - a).collect();
    (range(&ratio.collect::<Vec<_>>()), range(&error))
}

/// Rate at the end of a stretch of time of what was sampled in it, by a parabola.
///
/// The strand swings from one seating to the next, for nothing damps it; over many of its periods
/// the parabola does not see that.
fn rate_at_end(samples: &[(f64, f64)]) -> f64 {
    let n = samples.len() as f64;
    let (begin, end) = (samples[0].0, samples[samples.len() - 1].0);
    let (middle, half) = (0.5 * (begin + end), 0.5 * (end - begin));
    // Legendre's polynomials are orthogonal on evenly spaced samples but for O(1/n²).
    let (mut first, mut second) = (0.0, 0.0);
    for (t, value) in samples {
        let s = (t - middle) / half;
        first += 3.0 / n * s * value;
        second += 2.5 / n * (3.0 * s * s - 1.0) * value;
    }
    (first + 3.0 * second) / half
}

/// Angles of both wheels of a slow drive, and the speeds p (ω₁ − dψ/dt) at which coming rollers meet their seats \[p ω₁\].
fn slow(drive: &Linkage) -> (Vec<(f64, f64)>, Vec<f64>) {
    let period = TAU / f64::from(drive.teeth);
    let seat = leading_seat(&drive.action());
    let turn_to_seat = seat - gap_angle(&drive.text(), 0);
    let mut angles = Vec::new();
    // Directions of the link that comes next, over the end of every tooth.
    let mut directions: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    drive.run(|sample| {
        let driver = sample.sprocket_angle[0] - turn_to_seat;
        angles.push((driver, sample.sprocket_angle[1]));
        let phase = (driver / period).rem_euclid(1.0);
        let direction = (driver, coming(sample, seat + phase * period, period));
        match directions.last_mut() {
            Some(tooth) if phase > 0.55 => tooth.push(direction),
            Some(tooth) if !tooth.is_empty() => directions.push(Vec::new()),
            _ => {}
        }
    });
    let whole = directions
        .iter()
        .filter(|samples| samples.len() as f64 > 0.44 * SAMPLES as f64);
    let speeds: Vec<f64> = whole.map(|samples| 1.0 - rate_at_end(samples)).collect();
    assert!(!speeds.is_empty());
    (angles, speeds)
}

/// Ripple of the speed ratio (K02, K03, K05, and with them K14) and the speed at which the coming roller meets its seat.
fn slow_drive(kinematics: &str, seating: &str, drive: &Linkage) {
    let (case, velocity) = (Case::read(kinematics), Case::read(seating));
    let action = drive.action();
    let period = TAU / f64::from(drive.teeth);
    let (angles, speeds) = slow(drive);
    let exact = angles.iter().map(|(a, _)| (*a, action.driven(*a).angle));
    let (found, exact) = (ripple(&angles), ripple(&exact.collect::<Vec<_>>()));
    let listed = case.number("expected.summary.te_ptp_rad");
    // Where there is no ripple at all it is reckoned in parts of (π/z)².
    let scale = [exact.0, exact.1].map(|x| {
        if listed > 1e-9 {
            x
        } else {
            0.25 * period * period
        }
    });
    let tolerances = scale.map(|scale| Absolute(0.02 * scale));
    let name = "range of the speed ratio, as a run";
    case.judge(name, "", found.0, exact.0, tolerances[0]);
    let within = format!("{name}, within 0.1 %");
    case.carry(&within, "", found.0, exact.0, Relative(1e-3));
    let name = "range of the transmission error, as a run";
    case.judge(name, "rad", found.1, exact.1, tolerances[1]);
    let expected = velocity.number("expected.v_rel_over_p_w1");
    let (name, expected) = ("seating velocity, as a run", vec![expected; speeds.len()]);
    velocity.judge_each(name, "p ω₁", &speeds, &expected, Relative(0.01));
}

/// Direction of the link that runs from the driver's last seated roller, at `angle`, to the next.
fn coming(sample: &Observation, angle: f64, period: f64) -> f64 {
    let radius = 0.5 * PITCH / (0.5 * period).sin();
    let (x, y) = (radius * angle.cos(), radius * angle.sin());
    let off = |i: usize| (sample.roller_x[i] - x).hypot(sample.roller_y[i] - y);
    let n = sample.roller_x.len();
    let seated = (0..n)
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))
        .unwrap_or(0);
    let sides = [(seated + 1) % n, (seated + n - 1) % n];
    let next = sides
        .into_iter()
        .max_by(|a, b| sample.roller_x[*a].total_cmp(&sample.roller_x[*b]));
    let next = next.unwrap_or(seated);
    let dy = sample.roller_y[next] - sample.roller_y[seated];
    dy.atan2(sample.roller_x[next] - sample.roller_x[seated])
}

/// Seventeen teeth. On softer links, or twice as fast, the span swings by as much as is allowed, so that the drives of K02 and K03 take their time.
fn long_span(distance: f64, links: u32) -> Linkage {
    Linkage {
        teeth: 17,
        distance,
        links,
        torque: 1.0,
        speed: SPEED,
        stiffness: 1e8,
    }
}

#[test]
fn k02_i02_a_slow_drive_with_a_whole_span() {
    slow_drive("K02", "I02", &long_span(20.0, 57));
}

/// Strands of whole pitches do not turn while a roller comes: it meets its seat with p ω.
#[test]
#[ignore = "five slow drives; `make validation` runs it"]
fn i01_rollers_meet_their_teeth() {
    let case = Case::read("I01");
    for (teeth, row) in [15, 17, 19, 25, 38]
        .into_iter()
        .zip(case.table("expected.table"))
    {
        assert!((f64::from(teeth) - row[0]).abs() < 1e-9);
        let drive = Linkage {
            teeth,
            distance: 20.0,
            links: 40 + teeth,
            torque: 1.0,
            // At twice the speed the strand of 38 teeth swings, and meets them 7 % slower.
            speed: 0.5 * SPEED,
            stiffness: 1e8,
        };
        let (_, speeds) = slow(&drive);
        let found: Vec<f64> = speeds.iter().map(|it| it * row[3]).collect();
        let expected = vec![row[3]; found.len()];
        case.judge_each(
            "speed of seating, p ω, as a run",
            "m/s",
            &found,
            &expected,
            Relative(0.03),
        );
    }
}

#[test]
fn k03_i03_a_slow_drive_with_half_a_pitch_more() {
    slow_drive("K03", "I03", &long_span(20.5, 58));
}

#[test]
fn k05_i04_a_slow_drive_of_few_teeth() {
    let drive = Linkage {
        teeth: 9,
        distance: 6.5,
        links: 22,
        torque: 1.0,
        // A short span swings fast.
        speed: 2.0 * SPEED,
        stiffness: 2.5e7,
    };
    slow_drive("K05", "I04", &drive);
}

/// Teeth that a ripple at a very centre distance is a mean of.
const ALIKE: usize = 6;

/// A slow drive at the very centre distance of a case; whole links leave up to a pitch for the lower span.
struct Slow {
    teeth: [u32; 2],
    pitch: f64,
    centres: f64,
    /// Pull of the upper span \[N\].
    pull: f64,
    /// Speed \[rad/s\] of a driver of nine teeth; others pass as many teeth a second.
    speed: f64,
}

impl Slow {
    fn action(&self) -> PolygonAction {
        let [first, second] = self.teeth;
        PolygonAction::new(first, second, self.pitch, self.centres).expect("a drive")
    }

    /// Range of the speed ratio and of the transmission error, found and exact, of a mean tooth.
    ///
    /// The strands swing, each tooth another way, and the range of one tooth of nine scatters by 1.5 %, that of a mean of six by 0.4 %.
    fn ripples(&self) -> [(f64, f64); 2] {
        let Self {
            pitch,
            centres,
            pull,
            ..
        } = *self;
        let [driver, driven] = self.teeth.map(f64::from);
        // As many teeth a second for every drive: the tight span, kicked by every tooth, swings much faster.
        let speed = 9.0 / driver * self.speed;
        let wheels = TwoWheels {
            teeth: self.teeth,
            pitch,
        };
        let length = wheels.links(centres).expect("wheels apart");
        let links = (length + 0.3).ceil();
        let radii = [driver, driven].map(|z| 0.5 * pitch / (PI / z).sin());
        let period = TAU / driver / speed;
        let torque = pull * radii[1];
        let [constant, viscous] = [-0.6 * torque, 0.4 * torque / (speed * driver / driven)];
        let gap = |z: f64| {
            format!(
                "tooth = {}",
                holding_gap(z, pitch, 6.0, 0.05).replace('\n', " ")
            )
        };
        let text = TwoSprockets {
            before: &format!("settle = false\n{}", spreading_rod(links - length, centres, radii, pitch)),
            pitch,
            links,
            mass: 2e-4,
            stiffness: 3e8,
            damping_ratio: 0.2,
            roller: 0.6 * pitch,
            contact: 3e8,
            damper: 100.0,
            teeth: [driver, driven],
            centre: [centres, 0.0],
            driver: &format!("{}\n{}", steady(speed), gap(driver)),
            // 0.6 kg at the rim.
            inertia: 0.6 * radii[1] * radii[1],
            driven: &format!(
                "{}\nload = [{{ kind = \"ramp\", torque = {constant}, duration = {period} }}, {{ kind = \"resistance\", linear = {viscous} }}]",
                gap(driven)
            ),
            after: "[route]\nstops = [\"driven\", \"driver\", \"rod\"]",
            until: (2.1 + ALIKE as f64) * period,
            every: period / SAMPLES as f64,
            ..TwoSprockets::NOTHING
        }
        .text();
        let action = self.action();
        let turn_to_seat = leading_seat(&action) - gap_angle(&text, 0);
        let ratio = driver / driven;
        // Turn of the driver, and of the driven wheel as much as the driver would turn for it.
        let mut angles = Vec::new();
        run(&text, |sample| {
            if sample.time > 2.0 * period - 1e-9 {
                angles.push((
                    sample.sprocket_angle[0] - turn_to_seat,
                    sample.sprocket_angle[1] / ratio,
                ));
            }
        });
        // The mean tooth, and the begin of the next one.
        let tooth = |i: usize| {
            let back = |k: usize| period * speed * k as f64;
            let mean_of = |read: &dyn Fn(&(f64, f64)) -> f64| {
                let read_back = |k: usize| read(&angles[i + k * SAMPLES]) - back(k);
                mean(&(0..ALIKE).map(read_back).collect::<Vec<_>>())
            };
            (mean_of(&|a| a.0), mean_of(&|a| a.1))
        };
        let angles: Vec<(f64, f64)> = (0..=SAMPLES + SAMPLES / 20).map(tooth).collect();
        let exact = angles
            .iter()
            .map(|(a, _)| (*a, action.driven(*a).angle / ratio));
        let (found, exact) = (ripple(&angles), ripple(&exact.collect::<Vec<_>>()));
        [(found.0, exact.0), (ratio * found.1, ratio * exact.1)]
    }
}

const RATIO: &str = "range of the speed ratio, as a run";
const ERROR: &str = "range of the transmission error, as a run";

/// `cargo test --release -p chaindrive --test it -- --ignored validation_dynamics_kinematics`
#[test]
#[ignore = "fourteen slow runs"]
fn k14_slow_drives_against_the_fraction_of_a_pitch() {
    let case = Case::read("K14");
    let mut judged = Vec::new();
    for three in case.table("expected.table").chunks(3) {
        for row in three {
            let fraction = row[1];
            let teeth = (5_u32..100).find(|z| f64::from(*z) >= row[0]).unwrap_or(5);
            let centres = (12.0 + fraction) * PITCH;
            if PolygonAction::new(teeth, teeth, PITCH, centres).is_err() {
                continue; // wheels of 38 teeth overlap at f = 0
            }
            let drive = Slow {
                teeth: [teeth; 2],
                pitch: PITCH,
                centres,
                pull: 50.0,
                speed: SPEED,
            };
            let [(ratio, exact), (error, _)] = drive.ripples();
            // The speed ratio is seen over pieces of a tooth, in the exact kinematics as well: that
            // is the listed one to nine digits. At f = 0, without ripple, parts of that at f = 1/2.
            let (expected, scale) = if fraction > 0.0 {
                ([exact, row[3]], [exact, row[3]])
            } else {
                ([0.0; 2], [three[2][2], three[2][3]])
            };
            for (k, found) in [ratio, error].into_iter().enumerate() {
                let (quantity, unit) = [(RATIO, ""), (ERROR, "rad")][k];
                println!(
                    "K14: {teeth} teeth, f = {fraction}: {found:.3e} {unit} for {:.3e}",
                    expected[k]
                );
                judged.push((
                    quantity,
                    unit,
                    found,
                    expected[k],
                    Absolute(0.02 * scale[k]),
                ));
            }
        }
    }
    for (quantity, unit, found, expected, tolerance) in judged {
        case.judge(quantity, unit, found, expected, tolerance);
    }
}

/// Unlike wheels, long spans, large wheels: the drives of K07 to K13.
#[test]
#[ignore = "five slow runs"]
fn slow_drives_of_unlike_wheels() {
    for id in ["K07", "K08", "K10", "K12", "K13"] {
        let case = Case::read(id);
        let count = |key: &str| {
            let teeth = case.number(&format!("inputs.{key}"));
            (5_u32..200).find(|z| f64::from(*z) >= teeth).unwrap_or(5)
        };
        let (pitch, centres) = (case.number("inputs.pitch"), case.number("inputs.C"));
        let drive = Slow {
            teeth: [count("z1"), count("z2")],
            pitch,
            centres,
            // The span's lowest swing, √(T p/m)/2L, is as far above the passing of teeth as in K14.
            pull: 50.0 * (centres / (12.0 * PITCH)).powi(2) * PITCH / pitch,
            speed: SPEED,
        };
        let [(ratio, exact), (error, exact_error)] = drive.ripples();
        println!(
            "{id}: ratio {ratio:.4e} for {exact:.4e}, error {error:.4e} for {exact_error:.4e}"
        );
        case.judge(RATIO, "", ratio, exact, Absolute(0.02 * exact));
        case.judge(
            ERROR,
            "rad",
            error,
            exact_error,
            Absolute(0.02 * exact_error),
        );
        let within = format!("{RATIO}, within 0.1 %");
        case.carry(&within, "", ratio, exact, Relative(1e-3));
    }
}

//! Running a scene text, and what the dynamic validation cases ask of its samples.
#![allow(dead_code, reason = "every test uses its part")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

use chaindrive::{Observation, Run, Scene, Simulation, Summary};

/// A simulation of a scene text, run as the text says.
pub(crate) fn start(text: &str) -> Simulation {
    let scene = Scene::from_text(text, "case.toml").unwrap_or_else(|error| panic!("{error}"));
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let run = Run::suggested(&scene.run_defaults());
    Simulation::start(&drive, &run).unwrap_or_else(|error| panic!("{error}"))
}

/// Share of its energy that the ledger of a judged run may leave open.
const OPEN: f64 = 0.01;

/// Runs a scene text to its end, and shows every sample. The ledger has to close.
pub(crate) fn run(text: &str, see: impl FnMut(&Observation)) -> Simulation {
    let (simulation, open) = run_open(text, see);
    assert!(open < OPEN, "{open:.2e} of the energy is unaccounted for");
    simulation
}

/// The same without that judgement, for drives that hardly move: with the share left open of the energy moved, or of motion.
pub(crate) fn run_open(text: &str, mut see: impl FnMut(&Observation)) -> (Simulation, f64) {
    let mut simulation = start(text);
    let mut summary = Summary::new(&simulation);
    loop {
        match simulation.next_sample() {
            Ok(Some(sample)) => {
                summary.push(sample);
                see(sample);
            }
            Ok(None) => {
                let ledger = summary.ledger();
                let open = ledger.residual.abs() / ledger.moved.max(ledger.kinetic);
                return (simulation, open);
            }
            Err(error) => panic!("{error}"),
        }
    }
}

/// Points or velocities as a scene lists them.
pub(crate) fn pairs(values: impl IntoIterator<Item = [f64; 2]>) -> String {
    let mut text = String::from("[");
    for [x, y] in values {
        write!(text, "[{x:?}, {y:?}], ").expect("a text grows");
    }
    text + "]"
}

/// Numbers as a scene lists them.
pub(crate) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    let values: Vec<f64> = values.into_iter().collect();
    format!("{values:?}")
}

/// A tooth gap whose seat has the roller's own radius, 0.3 p, and holds it without a pull from the
/// slack side: flanks β from the pull of a seated link, T' = T sin β/sin(β + 2π/z) after it.
///
/// The teeth end `tip` pitches above the pitch circle. The flank has to open by more than a link swings while its roller rises to the
/// tip, and to leave so little tension after the last tooth that a slack strand holds its rollers down: nine teeth seat four rollers,
/// which leave 4e-4 of a pull at β = 6°, and 3e-3 at 10°.
pub(crate) fn holding_gap(teeth: f64, pitch: f64, flank: f64, tip: f64) -> String {
    let roller = 0.3 * pitch;
    gap(teeth, pitch, [roller, roller], [flank, flank], tip)
}

/// A tooth gap for rollers of one radius, with a seat of another and straight flanks that lie at these angles \[deg\] to the
/// pull of a seated link, right and left.
///
/// The teeth end `tip` pitches above the pitch circle.
pub(crate) fn gap(
    teeth: f64,
    pitch: f64,
    [roller, seat]: [f64; 2],
    [right, left]: [f64; 2],
    tip: f64,
) -> String {
    let alpha = PI / teeth;
    let radius = 0.5 * pitch / alpha.sin();
    let (middle, tip) = (radius + (seat - roller), radius + tip * pitch);
    let side = |degrees: f64| {
        let (sine, cosine) = (FRAC_PI_2 - alpha - degrees.to_radians()).sin_cos();
        let foot = [seat * sine, middle - seat * cosine];
        let along = foot[0] * cosine + foot[1] * sine;
        let rise = (along * along + tip * tip - foot[0].powi(2) - foot[1].powi(2)).sqrt() - along;
        [foot, [foot[0] + rise * cosine, foot[1] + rise * sine]]
    };
    let ([foot_right, head_right], [foot_left, head_left]) = (side(right), side(left));
    let between = [tip * alpha.sin(), tip * alpha.cos()];
    let place = |[x, y]: [f64; 2], side: f64| format!("[{:?}, {y:?}]", side * x);
    format!(
        r#"{{ kind = "path", from = {}, pieces = [
            {{ kind = "line", to = {} }},
            {{ kind = "line", to = {} }},
            {{ kind = "arc", to = {}, radius = {:?} }},
            {{ kind = "line", to = {} }},
            {{ kind = "line", to = {} }},
        ] }}"#,
        place(between, 1.0),
        place(head_right, 1.0),
        place(foot_right, 1.0),
        place(foot_left, -1.0),
        -seat,
        place(head_left, -1.0),
        place(between, -1.0),
    )
}

/// A rod inside of the lower span of an open drive, from the driver at the origin to a wheel at (C, 0): it takes up most of the
/// length that whole links have to spare, and leaves 0.3 p to hang.
///
/// The route ends with it. `spare` is in pitches, all else in metres.
pub(crate) fn spreading_rod(spare: f64, centres: f64, radii: [f64; 2], pitch: f64) -> String {
    // The line that touches both wheels: n (c₂ − c₁) = R₁ − R₂, n its normal, out of the loop.
    let x = (radii[0] - radii[1]) / centres;
    let normal = [x, -(1.0 - x * x).sqrt()];
    let half = 0.5 * centres * -normal[1] / pitch;
    // 2 √(L²/4 + h²) = L + s - 0.3
    let depth = ((half + 0.5 * (spare - 0.3)).powi(2) - half * half)
        .max(0.0)
        .sqrt();
    // The rollers of 0.3 p roll under it.
    let out = 0.5 * (radii[0] + radii[1]) + (depth - 0.3 - 0.5) * pitch;
    let towards = normal[1].atan2(normal[0]).to_degrees();
    format!(
        r#"
        [[guides]]
        name = "rod"
        face = {{ kind = "arc", centre = [{x:?}, {y:?}], radius = {r:?}, from = "{from} deg", to = "{to} deg" }}
        contact = {{ law = {{ kind = "linear", stiffness = 1e6 }} }}
        "#,
        x = 0.5 * centres + out * normal[0],
        y = out * normal[1],
        r = 0.5 * pitch,
        from = towards - 30.0,
        to = towards + 30.0,
    )
}

/// Kinetic and potential energy \[J\].
pub(crate) fn energy(sample: &Observation) -> f64 {
    sample.energy.kinetic() + sample.energy.stored()
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Largest less smallest.
pub(crate) fn range(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Slope of the straight line through points, by least squares.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
    let (above, below) = points.iter().fold((0.0, 0.0), |sum, p| {
        (sum.0 + (p.0 - x) * (p.1 - y), sum.1 + (p.0 - x) * (p.0 - x))
    });
    above / below
}

/// Amplitude of the sine of frequency `f` \[Hz\] in a signal sampled every `dt` \[s\], under a
/// Hann window.
pub(crate) fn amplitude(signal: &[f64], dt: f64, f: f64) -> f64 {
    let n = signal.len() as f64;
    let average = mean(signal);
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (i, value) in signal.iter().enumerate() {
        let window = 1.0 - (TAU * (i as f64 + 0.5) / n).cos();
        let (s, c) = (TAU * f * dt * i as f64).sin_cos();
        cosine += window * (value - average) * c;
        sine += window * (value - average) * s;
    }
    2.0 * cosine.hypot(sine) / n
}

/// Frequency \[Hz\] between two bounds at which a signal is strongest.
pub(crate) fn strongest(signal: &[f64], dt: f64, (low, high): (f64, f64)) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..6 {
        let step = (high - low) / 40.0;
        let place = |i: i32| low + step * f64::from(i);
        let best = (0..=40)
            .max_by(|&a, &b| {
                amplitude(signal, dt, place(a)).total_cmp(&amplitude(signal, dt, place(b)))
            })
            .map_or(low, place);
        (low, high) = (best - step, best + step);
    }
    0.5 * (low + high)
}

/// Errors as one prints them.
pub(crate) fn brief(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|x| format!("{x:.1e}")).collect();
    format!("[{}]", values.join(", "))
}

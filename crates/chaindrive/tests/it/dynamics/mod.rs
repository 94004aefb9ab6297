//! Running a scene text, and what the dynamic validation cases ask of its samples.
#![allow(dead_code, reason = "every test uses its part")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

use chaindrive::{Observation, Run, Scene, Simulation};

/// A simulation of a scene text, run as the text says.
pub(crate) fn start(text: &str) -> Simulation {
    let scene = Scene::from_text(text, "case.toml").unwrap_or_else(|error| panic!("{error}"));
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let run = Run::suggested(&scene.run_defaults());
    Simulation::start(&drive, &run).unwrap_or_else(|error| panic!("{error}"))
}

/// Runs a scene text to its end, and shows every sample.
pub(crate) fn run(text: &str, mut see: impl FnMut(&Observation)) -> Simulation {
    let mut simulation = start(text);
    loop {
        match simulation.next_sample() {
            Ok(Some(sample)) => see(sample),
            Ok(None) => return simulation,
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
/// slack side: flanks 10° from the pull of a seated link, T' = T sin 10°/sin(10° + 2π/z) behind it.
///
/// The teeth end `tip` pitches above the pitch circle. The flank still opens by more than a link swings while its roller
/// rises to the tip.
pub(crate) fn holding_gap(teeth: f64, pitch: f64, tip: f64) -> String {
    let roller = 0.3 * pitch;
    gap(teeth, pitch, [roller, roller], [10.0, 10.0], tip)
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

/// A rod between the wheels of an open drive, inside of the lower span: it takes up most of the
/// length that whole links have to spare, and leaves 0.3 p to hang.
///
/// The route ends with it. `spare` and `distance` are in pitches, `radius` is that of the wheels.
pub(crate) fn spreading_rod(spare: f64, distance: f64, radius: f64, pitch: f64) -> String {
    let half = 0.5 * distance;
    // 2 √(C²/4 + h²) = C + s - 0.3
    let depth = ((half + 0.5 * (spare - 0.3)).powi(2) - half * half)
        .max(0.0)
        .sqrt();
    format!(
        r#"
        [[guides]]
        name = "rod"
        face = {{ kind = "arc", centre = [{x:?}, {y:?}], radius = {r:?}, from = "240 deg", to = "300 deg" }}
        contact = {{ law = {{ kind = "linear", stiffness = 1e6 }} }}
        "#,
        x = half * pitch,
        // The rollers of 0.3 p roll under it.
        y = -radius - (depth - 0.3 - 0.5) * pitch,
        r = 0.5 * pitch,
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

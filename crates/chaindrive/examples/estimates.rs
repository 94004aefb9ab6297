//! Stated errors of runs, held against a reference method, for forty drives:
//! `make estimates` writes the page `docs/estimates.md`, and fails where they do not hold. With names of presets, only the
//! lines of these are printed.
//!
//! Every drive is given the method and step that it gets by default. The reference, Runge–Kutta of fourth order with steps that
//! follow the damping and contacts that begin at most ten nanometres deep, has no part in the estimate; how far it is from
//! itself with half the step stands beside.

use std::io::Write;

use chaindrive::precision::{ACCURACY, Estimate, Strands, choose, estimate};
use chaindrive::{Run, Scene, SimulationError};

#[path = "../tests/it/against_reference.rs"]
mod against_reference;
use against_reference::{errors, horizon, reference, rms, tensions};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// A preset and what differs from it: paths of the scene and TOML values.
type Case = (&'static str, &'static [(&'static str, &'static str)]);

const CRANK: &str = "sprockets.crank.motion.speed";
const LOAD: &str = "sprockets.camshaft.load[0].torque";
const MODEL: &str = "chain.model";
const IDEAL: &str = r#""ideal-joints""#;
const PARTICLES: &str = r#""particles""#;

/// The drives: presets, and presets with other speeds, loads, phases, models and contacts.
const CASES: [Case; 40] = [
    ("marine_engine", &[]),
    ("marine_engine", &[("route.phase", "0.37")]),
    ("marine_engine", &[("chain.damping_ratio", "0.03")]),
    ("marine_engine", &[("contact.teeth.restitution", "0.3")]),
    ("marine_engine", &[("route.pretension", r#""25 kN""#)]),
    ("marine_engine_bare", &[]),
    ("marine_engine_bare", &[("route.phase", "0")]),
    ("marine_engine_bare", &[(CRANK, r#""-50 rpm""#)]),
    ("marine_engine_bare", &[(CRANK, r#""-200 rpm""#)]),
    ("marine_two_sprockets", &[]),
    ("marine_two_sprockets", &[("route.phase", "0.61")]),
    ("marine_two_sprockets", &[(CRANK, r#""-30 rpm""#)]),
    ("marine_two_sprockets", &[(CRANK, r#""-300 rpm""#)]),
    ("marine_two_sprockets", &[(CRANK, r#""-1000 rpm""#)]),
    ("marine_two_sprockets", &[(LOAD, r#""20 kN m""#)]),
    (
        "marine_two_sprockets",
        &[(
            "contact.teeth.friction",
            r#"{ kind = "coulomb", coefficient = 0.1, slip_speed = "1 mm/s" }"#,
        )],
    ),
    (
        "marine_two_sprockets",
        &[("route.pretension", r#""50 kN""#)],
    ),
    ("industrial_16b", &[]),
    ("industrial_16b", &[("route.phase", "0.25")]),
    (
        "industrial_16b",
        &[("sprockets.driver.motion.speed", r#""100 rpm""#)],
    ),
    (
        "industrial_16b",
        &[("sprockets.driver.motion.speed", r#""900 rpm""#)],
    ),
    (
        "industrial_16b",
        &[("sprockets.driven.load[0].torque", r#""-300 N m""#)],
    ),
    ("bicycle_slack", &[(MODEL, PARTICLES)]),
    ("motorcycle", &[("route.phase", "0")]),
    ("bicycle", &[]),
    ("bicycle", &[("route.phase", "0")]),
    (
        "bicycle",
        &[("sprockets.chainring.motion.speed", r#""-60 rpm""#)],
    ),
    (
        "bicycle",
        &[("sprockets.chainring.motion.speed", r#""-300 rpm""#)],
    ),
    (
        "bicycle",
        &[("sprockets.rear.load[0].torque", r#""20 N m""#)],
    ),
    ("bicycle", &[("contact.joints.restitution", "0.95")]),
    ("bicycle", &[(MODEL, PARTICLES)]),
    ("bicycle", &[(MODEL, IDEAL)]),
    ("bicycle_slack", &[]),
    ("bicycle_slack", &[("route.phase", "0")]),
    ("bicycle_crank", &[]),
    ("motorcycle", &[]),
    ("timing_drive", &[]),
    ("two_stage_timing", &[]),
    ("spinning_ring", &[]),
    ("hanging_chain", &[]),
];

/// Samples of the time examined.
const SAMPLES: f64 = 1024.0;
/// A true error may be this much larger than the stated one, in [`AGREEING`] drives.
const LARGE: f64 = 1.5;
/// A stated horizon may lie this much later than the true one, in [`AGREEING`] drives.
const LATE: f64 = 1.2;
/// Drives of the forty that have to agree.
const AGREEING: usize = 38;
/// Where the median of true over stated error has to lie.
const MEDIAN: [f64; 2] = [0.7, 1.3];

/// The text above the table.
const HEAD: &str = "\
# Estimates

What runs say of their own error and of its horizon, held against a reference. `make estimates` writes this page and fails where what
is said does not hold; whoever changes the estimate does that again. What the words mean is told in [Precision](precision.md).

Forty presets and variants of presets, each with the method and step that it gets by default. *Stated* and *true* are errors of the
span tensions over the time examined, root mean square over the mean tension; of the link tensions where no roller holds a span. The true
ones are against Runge–Kutta of fourth order at 1/32 of 1/ω with contacts that begin at most 5 nm deep, 1/4 and no such limit for
rigid links; *reference* is how far that is from itself with twice the step and depth. The *true horizon* is the first time at which the error, root
mean square over the last tooth that passed, is 1 %; – where that is not so in the time examined.

| drive | method, step | examined | stated | true | true/stated | reference | stated horizon | true horizon |
|---|---|---|---|---|---|---|---|---|";

/// One line of the table.
struct Line {
    case: Case,
    run: Run,
    stated: Estimate,
    /// Error within the window and the stated horizon \[–\].
    error: f64,
    /// The same of the reference from itself with half the step.
    doubt: f64,
    /// First time at which the error, root mean square over the last tooth, is 1 % \[s\].
    horizon: Option<f64>,
}

impl Line {
    fn of(case: Case) -> Outcome<Self> {
        let (preset, changes) = case;
        let mut scene = Scene::preset(preset)?;
        for (path, value) in changes {
            scene = scene.replace(path, value)?;
        }
        let start = scene.drive()?.assemble()?;
        let go_on = || false;
        let run = Run {
            until: 10.0,
            ..Run::default()
        };
        let run = choose(&start, &run, ACCURACY, &go_on)?.run;
        let stated = estimate(&start, &run, &go_on)?;
        let over = |run: Run| Run {
            until: stated.window,
            every: stated.window / SAMPLES,
            ..run
        };
        let strand = match stated.strands {
            Strands::Spans => 0,
            Strands::Links => 1,
        };
        let tensions =
            |run| Ok::<_, SimulationError>(tensions(&start, &over(run))?[strand].clone());
        let found = tensions(run.clone())?;
        let exact = tensions(reference(&start, 1.0))?;
        let sharper = tensions(reference(&start, 0.5))?;
        let every = stated.window / SAMPLES;
        let end = stated.horizon.all.time().unwrap_or(f64::INFINITY);
        let inside = |errors: &[f64]| {
            let inside = errors.iter().enumerate();
            let inside = inside.filter(|(sample, _)| *sample as f64 * every <= end);
            rms(inside.map(|(_, error)| *error))
        };
        let errors = |of: &[Vec<f64>]| errors(of, &sharper, sharper.len());
        let (error, doubt) = (errors(&found), errors(&exact));
        let first = horizon(&error, stated.period.map_or(1.0, |period| period / every));
        Ok(Self {
            case,
            run,
            error: inside(&error),
            doubt: inside(&doubt),
            horizon: first.map(|sample| sample as f64 * every),
            stated,
        })
    }

    fn ratio(&self) -> f64 {
        self.error / self.stated.tension
    }

    /// A horizon that nobody states is wrong where the error exceeds 1 % within the time examined.
    fn horizon_holds(&self) -> bool {
        self.horizon.is_none_or(|first| {
            let stated = self.stated.waveform.unwrap_or(f64::INFINITY);
            stated <= LATE * first
        })
    }

    fn print(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (preset, changes) = self.case;
        let changes: Vec<String> = changes
            .iter()
            .map(|(path, value)| format!("`{path}` {}", value.trim_matches('"')))
            .collect();
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let time =
            |at: Option<f64>| at.map_or("–".to_owned(), |at| format!("{:.2} ms", 1e3 * at));
        let mark = |holds: bool| if holds { "" } else { " **late**" };
        writeln!(
            out,
            "| {preset} {} | {:?} {:.2} µs | {:.2} ms | {} | {} | {:.2} | {} | {} | {}{} |",
            changes.join(", "),
            self.run.stepping,
            1e6 * self.run.step.unwrap_or(f64::NAN),
            1e3 * self.stated.window,
            percent(self.stated.tension),
            percent(self.error),
            self.ratio(),
            percent(self.doubt),
            time(self.stated.waveform),
            time(self.horizon),
            mark(self.horizon_holds()),
        )
    }
}

fn main() -> Outcome<()> {
    let mut out = std::io::stdout();
    writeln!(out, "{HEAD}")?;
    let mut lines = Vec::new();
    let named: Vec<String> = std::env::args().skip(1).collect();
    for case in CASES
        .iter()
        .filter(|case| named.is_empty() || named.iter().any(|name| name == case.0))
    {
        match Line::of(*case) {
            Ok(line) => {
                line.print(&mut out)?;
                lines.push(line);
            }
            Err(why) => writeln!(out, "| {case:?} | failed: {why} |")?,
        }
    }
    if !named.is_empty() {
        return Ok(());
    }
    let mut ratios: Vec<f64> = lines.iter().map(Line::ratio).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    let small = ratios.iter().filter(|ratio| **ratio <= LARGE).count();
    let early = lines.iter().filter(|line| line.horizon_holds()).count();
    writeln!(
        out,
        "\nOf {} drives {small} err by at most {LARGE} times what is stated; the median of the ratio is {median:.2}; {early} state a \
         horizon at most {LATE} times the true one.",
        lines.len()
    )?;
    let agree = small >= AGREEING && early >= AGREEING && (MEDIAN[0]..=MEDIAN[1]).contains(&median);
    if !agree {
        return Err("the estimates do not hold".into());
    }
    Ok(())
}

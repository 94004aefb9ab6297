//! Stated errors and horizons against a reference method, which has no part in the estimate; of forty drives of today
//! `examples/estimates.rs` makes a table.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::precision::{Strands, estimate};
use chaindrive::{Assembled, Run};

use crate::against_reference::{errors, horizon, reference, rms, tensions};
use crate::judged::bare;

/// A drive, changed in one value, the length of the run \[s\], and its step in those that it would choose.
struct Case {
    preset: &'static str,
    change: Option<(&'static str, &'static str)>,
    until: f64,
    step: f64,
}

/// A preset as it is.
const fn preset(preset: &'static str, until: f64) -> Case {
    Case {
        preset,
        change: None,
        until,
        step: 1.0,
    }
}

/// A preset with another value somewhere.
const fn changed(preset: &'static str, change: (&'static str, &'static str), until: f64) -> Case {
    Case {
        preset,
        change: Some(change),
        until,
        step: 1.0,
    }
}

impl Case {
    fn start(&self) -> Assembled {
        // Twins of bare drives part sooner.
        let mut scene = bare(self.preset);
        if let Some((path, value)) = self.change {
            scene = scene.replace(path, value).unwrap();
        }
        scene.drive().unwrap().assemble().unwrap()
    }
}

/// A stated horizon may lie this much later than the true one: in all but one of the drives here, as in 38 of the forty of
/// `examples/estimates.rs`.
const LATE: f64 = 1.2;
/// And in that one.
const LATEST: f64 = 1.3;
/// A true error may be this much larger than the stated one.
const LARGE: f64 = 1.5;

/// Holds what a run says of its error against a reference; the line of a table, and the stated horizon over the true one, the later of
/// two.
fn check(case: &Case) -> (String, f64) {
    let start = case.start();
    let run = Run {
        until: case.until,
        // Blows last a few steps: between fewer samples the true horizon would pass unseen.
        every: case.until / 2000.0,
        step: Some(case.step * Run::default().method(&start.system).step()),
        ..Run::default()
    };
    let stated = estimate(&start, &run, &|| false).unwrap();
    let exact = Run {
        until: run.until,
        every: run.every,
        ..reference(&start, 1.0)
    };
    let found = tensions(&start, &run).unwrap();
    let exact = tensions(&start, &exact).unwrap();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a window has some thousands of samples"
    )]
    let samples = (stated.window / run.every) as usize + 1;
    let examined = exact[0].len().min(samples);
    let [spans, links] = [0, 1].map(|k| errors(&found[k], &exact[k], examined));
    let compared = match stated.strands {
        Strands::Spans => &spans,
        Strands::Links => &links,
    };

    let end = stated
        .window
        .min(stated.horizon.all.time().unwrap_or(f64::INFINITY));
    let inside = compared.iter().enumerate();
    let inside = inside.filter(|(sample, _)| *sample as f64 * run.every <= end);
    let error = rms(inside.map(|(_, error)| *error));
    let name = format!("{} {:?}", case.preset, case.change);
    let line = format!(
        "{name}: factor {:.2}, error {:.1e} stated {:.1e}",
        stated.factor, error, stated.tension
    );
    assert!(error <= LARGE * stated.tension, "{line}");

    let (mut line, mut late) = (line, 0.0_f64);
    for (errors, at) in [(compared, stated.waveform), (&links, stated.link_waveform)] {
        let first = horizon(errors, stated.period.unwrap_or(0.0) / run.every);
        let first = first.map(|sample| sample as f64 * run.every);
        line = format!("{line}, horizon {first:?} stated {at:?}");
        if let Some(first) = first {
            // None stated: then nobody looked so far.
            let at = at.unwrap_or(stated.window);
            late = late.max((at - run.every) / first);
        }
    }
    (line, late)
}

/// Defect A6: the horizon of the bicycle lay at 6.8 ms where the error exceeds 1 % at 4 ms, and at 300 rpm there was
/// none; that of the slack one at 0.97 ms, for 0.63. Defect A7: that of link tensions lies far before that of span tensions.
#[test]
fn stated_horizons_do_not_lie_behind_the_true_ones() {
    for case in [preset("bicycle", 6e-3), preset("bicycle_slack", 4e-3)] {
        let (line, late) = check(&case);
        println!("{line}");
        assert!(late <= LATE, "{line}");
    }
}

#[test]
#[ignore = "a study: more drives, of which one may be later"]
fn horizons_of_more_drives_do_not_lie_behind_the_true_ones() {
    let mut later = 0;
    for case in [
        preset("marine_two_sprockets", 0.03),
        preset("motorcycle", 1e-3),
        changed("bicycle", ("contact.joints.restitution", "0.99"), 6e-3),
        changed(
            "bicycle",
            ("sprockets.chainring.motion.speed", "-300 rpm"),
            4e-3,
        ),
        changed(
            "marine_two_sprockets",
            ("sprockets.crank.motion.speed", "-300 rpm"),
            8e-3,
        ),
        changed(
            "marine_two_sprockets",
            ("sprockets.crank.motion.speed", "-500 rpm"),
            0.01,
        ),
    ] {
        let (line, late) = check(&case);
        println!("{line}");
        assert!(late <= LATEST, "{line}");
        later += usize::from(late > LATE);
    }
    assert!(later <= 1, "{later}");
}

/// Defect A3: the tension rises a hundredfold within the window, and the error was stated relative to the mean of all of it; and
/// with a quarter of the step the run errs by 0.23 % as does that of half the step, which differs by 0.1 %.
#[test]
fn errors_of_a_drive_under_overload_are_as_large_as_stated() {
    for step in [1.0, 0.25] {
        let speed = ("sprockets.crank.motion.speed", "-2000 rpm");
        let case = Case {
            step,
            ..changed("marine_two_sprockets", speed, 0.02)
        };
        println!("{}", check(&case).0);
    }
}

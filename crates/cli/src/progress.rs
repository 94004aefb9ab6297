//! Progress of a run or a sweep on a terminal; nothing in a pipe.

use std::cell::RefCell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use chaindrive::Simulation;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Parts of the bar.
const PARTS: u64 = 1000;
/// Wall time between two looks.
const EVERY: Duration = Duration::from_millis(100);
/// Wall time without a sample after which the bar says what goes on instead.
const PAUSE: Duration = Duration::from_secs(1);

/// A bar with time left and real-time factor.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    began: Instant,
    shown: Instant,
    /// Share done and time simulated when it began: not zero where a run goes on.
    from: Option<[f64; 2]>,
    /// Share done, and the wall time when it was reached \[s\].
    reached: [f64; 2],
    /// When samples ceased to come: before the first one, or after the last.
    resting: Option<Instant>,
}

/// Does something whose end nobody knows, and shows for how long: `work` takes what it asks now and then whether to stop.
pub(crate) fn waiting<T>(
    what: &str,
    interrupted: &dyn Fn() -> bool,
    work: impl FnOnce(&dyn Fn() -> bool) -> T,
) -> T {
    let progress = RefCell::new(Progress::new(false));
    work(&|| {
        progress.borrow_mut().wait(what);
        interrupted()
    })
}

impl Progress {
    /// A bar if somebody looks at stderr.
    pub(crate) fn new(quiet: bool) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {wide_msg}");
        let wanted = !quiet && std::io::stderr().is_terminal();
        let bar = style.ok().filter(|_| wanted).map(|style| {
            ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr())
                .with_style(style)
        });
        let now = Instant::now();
        Self {
            bar,
            began: now,
            shown: now,
            from: None,
            reached: [0.0; 2],
            resting: None,
        }
    }

    /// Shows for how long something goes on.
    fn wait(&mut self, what: &str) {
        self.tell(0.0, |elapsed, _| format!("{what}, {}", clock(elapsed)));
    }

    /// Shows for how long a run gives no samples: it assembles and chooses a method before them, and estimates its error after.
    pub(crate) fn rest(&mut self) {
        if self.resting.is_none() && self.shown.elapsed() < PAUSE {
            return;
        }
        let since = *self.resting.get_or_insert_with(Instant::now);
        let share = if self.from.is_some() {
            self.reached[0]
        } else {
            0.0
        };
        let what = if share < 1.0 {
            "preparing"
        } else {
            "estimating the error"
        };
        self.put(share, |_, _| {
            format!("{what}, {}", clock(since.elapsed().as_secs_f64()))
        });
    }

    /// Shows how far the run is.
    pub(crate) fn show(&mut self, simulation: &Simulation) {
        let now = [simulation.progress(), simulation.time()];
        if self.from.is_none() {
            // What was before was the run-in.
            self.began = Instant::now();
        }
        let [_, before] = *self.from.get_or_insert(now);
        self.tell(simulation.progress(), |elapsed, left| {
            let time = simulation.time();
            let factor = (time - before) / elapsed;
            format!("t = {time:.4} s, {left}, {factor:.3} × real time")
        });
    }

    /// Shows how much of the run-in is done; the run begins the bar anew.
    pub(crate) fn run_in(&mut self, share: f64) {
        self.tell(share, |elapsed, _| format!("run-in, {elapsed:.0} s"));
    }

    /// Shows how many variants are finished.
    pub(crate) fn count(&mut self, finished: usize, all: usize) {
        let share = finished as f64 / all.max(1) as f64;
        self.tell(share, |_, left| match finished {
            // Nothing is known about the time that a variant takes.
            0 => format!("0 of {all} variants"),
            _ => format!("{finished} of {all} variants, {left}"),
        });
    }

    /// Puts the bar at a share done, with a message made of the time elapsed and the time left.
    fn tell(&mut self, done: f64, message: impl FnOnce(f64, &str) -> String) {
        self.resting = None;
        self.put(done, message);
    }

    fn put(&mut self, done: f64, message: impl FnOnce(f64, &str) -> String) {
        let Some(bar) = &self.bar else { return };
        if self.shown.elapsed() < EVERY {
            return;
        }
        self.shown = Instant::now();
        let elapsed = self.began.elapsed().as_secs_f64();
        let before = self.from.map_or(0.0, |[share, _]| share);
        if self.reached[0].to_bits() != done.to_bits() {
            self.reached = [done, elapsed];
        }
        let [_, at] = self.reached;
        // Between two variants of a sweep nothing is done, and the time goes on: the estimate of the library would grow then.
        let left = if done > before {
            let left = at * (1.0 - done) / (done - before) - (elapsed - at);
            format!("{} left", clock(left.max(0.0)))
        } else {
            "time left not known yet".to_owned()
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a thousand"
        )]
        bar.set_position((done * PARTS as f64) as u64);
        bar.set_message(message(elapsed, &left));
    }
}

impl Drop for Progress {
    /// Removes the bar, however the run ended.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Minutes and seconds, or hours and minutes.
fn clock(seconds: f64) -> String {
    if seconds < 60.0 {
        format!("{seconds:.0} s")
    } else if seconds < 3600.0 {
        format!(
            "{:.0} min {:02.0} s",
            (seconds / 60.0).floor(),
            seconds % 60.0
        )
    } else {
        let minutes = seconds / 60.0;
        format!(
            "{:.0} h {:02.0} min",
            (minutes / 60.0).floor(),
            minutes % 60.0
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar that nobody sees.
    fn hidden(ago: u64) -> Progress {
        let mut then = Instant::now();
        then -= Duration::from_secs(ago);
        Progress {
            bar: Some(ProgressBar::hidden()),
            began: then,
            shown: then,
            from: None,
            reached: [0.0; 2],
            resting: None,
        }
    }

    fn message(progress: &Progress) -> String {
        progress
            .bar
            .as_ref()
            .map(ProgressBar::message)
            .unwrap_or_default()
    }

    #[test]
    fn the_time_left_of_a_sweep_counts_down_between_two_variants() {
        let mut progress = hidden(10);
        progress.count(1, 3);
        assert_eq!(message(&progress), "1 of 3 variants, 20 s left");
        for (later, left) in [(6, 14), (8, 6), (9, 0)] {
            progress.began -= Duration::from_secs(later);
            progress.shown -= Duration::from_secs(later);
            progress.count(1, 3);
            assert_eq!(
                message(&progress),
                format!("1 of 3 variants, {left} s left")
            );
        }
    }

    /// Defect: the first frame of a run that was carried on had a time left of some 300 digits.
    #[test]
    fn without_progress_no_time_left_is_told() {
        let mut progress = hidden(10);
        progress.from = Some([0.25, 0.5]);
        progress.tell(0.25, |_, left| left.to_owned());
        assert_eq!(message(&progress), "time left not known yet");
        progress.shown -= EVERY;
        progress.tell(0.5, |_, left| left.to_owned());
        assert_eq!(message(&progress), "20 s left");
    }

    #[test]
    fn what_has_no_end_tells_for_how_long_it_goes_on() {
        let mut progress = hidden(75);
        progress.wait("assembling");
        assert_eq!(message(&progress), "assembling, 1 min 15 s");
    }

    /// Assembly, choice and estimate take longer than the run itself at times.
    #[test]
    fn what_has_no_samples_tells_what_goes_on() {
        let mut progress = hidden(5);
        progress.rest();
        assert_eq!(message(&progress), "preparing, 0 s");
        progress.from = Some([0.0, 0.0]);
        progress.shown -= EVERY;
        progress.tell(1.0, |_, _| "the end".to_owned());
        progress.rest();
        assert_eq!(message(&progress), "the end", "only after a pause");
        progress.shown -= PAUSE;
        progress.rest();
        assert_eq!(message(&progress), "estimating the error, 0 s");
    }

    #[test]
    fn clocks() {
        assert_eq!(clock(4.2), "4 s");
        assert_eq!(clock(125.0), "2 min 05 s");
        assert_eq!(clock(7320.0), "2 h 02 min");
    }
}

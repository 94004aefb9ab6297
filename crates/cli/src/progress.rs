//! How far a run is, on a terminal; in a pipe, nothing.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use chaindrive::Simulation;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Parts of the bar.
const PARTS: u64 = 1000;
/// Wall time between two looks.
const EVERY: Duration = Duration::from_millis(100);

/// A bar with time left and real-time factor.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    began: Instant,
    shown: Instant,
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
        }
    }

    /// Shows how far the run is.
    pub(crate) fn show(&mut self, simulation: &Simulation) {
        let Some(bar) = &self.bar else { return };
        if self.shown.elapsed() < EVERY {
            return;
        }
        self.shown = Instant::now();
        let elapsed = self.began.elapsed().as_secs_f64();
        let done = simulation.progress().max(f64::MIN_POSITIVE);
        let left = elapsed * (1.0 - done) / done;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a thousand"
        )]
        bar.set_position((done * PARTS as f64) as u64);
        let factor = simulation.time() / elapsed;
        bar.set_message(format!(
            "t = {:.4} s, {} left, {factor:.3} × real time",
            simulation.time(),
            clock(left)
        ));
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
    use super::clock;

    #[test]
    fn clocks() {
        assert_eq!(clock(4.2), "4 s");
        assert_eq!(clock(125.0), "2 min 05 s");
        assert_eq!(clock(7320.0), "2 h 02 min");
    }
}

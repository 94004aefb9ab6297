//! A timed sample of variants: how many of them make a task.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::threads::{cores, on_threads};
use super::{Account, Go, Outcome, Sweep, SweepError, Worker};
use crate::clock::Instant;

/// Wall time of a task: 0.5 to 5 s are short beside a sweep, and long beside the writing of some forty files.
const TASK: Duration = Duration::from_secs(1);

/// Variants whose time is long enough to tell of the others.
const ENOUGH: Duration = Duration::from_millis(500);

/// A variant that takes longer than this is a task on its own, whatever the others take.
const PATIENCE: Duration = Duration::from_secs(5);

/// Of so many variants one is in the sample, and so many are in it at most.
const ONE_IN: usize = 200;
const MOST: usize = 8;

/// Tasks that every worker gets at least, so that all end at about the same time.
const TASKS_PER_WORKER: usize = 8;

/// Some variants that were timed.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    /// Variants that take about as long as a task should.
    pub variants_per_task: usize,
    /// The outcome of the first variant, open when it took too long.
    pub first: Outcome,
    /// Whether it was stopped.
    pub stopped: bool,
}

impl Sample {
    /// The account of the first variant, if it reached its end.
    pub fn account(&self) -> Option<&Account> {
        match &self.first {
            Outcome::Done(account) => Some(account),
            Outcome::Failed(_) | Outcome::Open => None,
        }
    }
}

impl Sweep {
    /// Times some variants on one thread, the first one and others at equal distances, for so many workers; as many as there
    /// are cores if absent.
    ///
    /// `watch` is asked every 50 ms whether to go on.
    ///
    /// # Errors
    /// As [`Sweep::run`].
    pub fn time_sample(
        &self,
        workers: Option<usize>,
        mut watch: impl FnMut() -> Go,
    ) -> Result<Sample, SweepError> {
        let workers = workers.unwrap_or_else(cores).max(1);
        let count = (self.len() / ONE_IN).clamp(1, MOST);
        let worker = Worker::alone(self);
        let mut sample = Sample::default();
        let (mut timed, mut spent) = (0_u32, Duration::ZERO);
        for number in 0..count {
            let index = number * self.len() / count;
            let mut look = |most: Duration, begin: Instant| {
                sample.stopped |= watch() == Go::NoFurther;
                if sample.stopped || begin.elapsed() > most {
                    Go::NoFurther
                } else {
                    Go::On
                }
            };
            // Outside of the time that is taken: it serves all variants of its block.
            let begin = Instant::now();
            let choose = |index, stop: &AtomicBool| drop(worker.choice(index, stop));
            let go = on_threads(&[index], Some(1), choose, |_| look(Duration::MAX, begin))?;
            if go == Go::NoFurther {
                break;
            }
            let begin = Instant::now();
            let carry_out = |index, stop: &AtomicBool| self.carry_out(index, stop);
            on_threads(&[index], Some(1), carry_out, |ended| {
                if let (0, Some((_, outcome))) = (number, ended) {
                    sample.first = outcome;
                }
                look(PATIENCE, begin)
            })?;
            timed += 1;
            spent += begin.elapsed();
            if sample.stopped || spent > ENOUGH {
                break;
            }
        }
        let each = (spent / timed.max(1)).as_secs_f64().max(1e-6);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most a million"
        )]
        let variants = (TASK.as_secs_f64() / each).round() as usize;
        let most = self.len() / (TASKS_PER_WORKER * workers);
        sample.variants_per_task = variants.clamp(1, most.max(1));
        Ok(sample)
    }
}

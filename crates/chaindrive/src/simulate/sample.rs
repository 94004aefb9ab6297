//! Samples, and those that were taken before anybody asked for them.

use std::mem::swap;

use chaindrive_mechanics::{Assembled, ContactEvent, EventKinds, Impact, Observation, Sights};

use super::ended_contacts::count_from;
use super::live::Changes;
use super::{Arc, Period, Simulation};
use crate::interruptible::LOOK;
use crate::{Channel, Run, SimulationError};

/// All that a sample says, on the clock of the drive.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sample {
    observation: Observation,
    ended: Vec<ContactEvent>,
    struck: Vec<Impact>,
    periods: Vec<Period>,
    readings: Vec<f64>,
}

impl Simulation {
    /// Reads these sights at a time \[s\] within the last step, and hands out what ended since the last reading.
    pub(super) fn sample(&mut self, sights: Sights, time: f64) {
        self.observe_some(sights, time);
        self.hand_out_ended();
    }

    /// Numbers of a sample of all channels.
    pub(crate) fn numbers(&mut self) -> usize {
        self.observe(self.read);
        let channels = Channel::ALL.iter();
        channels.map(|it| self.channel(*it).len()).sum()
    }

    /// Advances to a time \[s\] and takes a sample there; on request with the drive as it stood before the last step. The room of a sample
    /// that is no longer needed, `sample`, is that of the next one but one.
    pub(crate) fn take_sample(
        &mut self,
        time: f64,
        with_start: bool,
        mut sample: Box<Sample>,
        stop: &dyn Fn() -> bool,
    ) -> Result<(Box<Sample>, Option<Assembled>), SimulationError> {
        let changes = if with_start {
            Changes::AtTheEnd
        } else {
            Changes::None
        };
        self.go_to(time, changes, stop)?;
        let before = self.before.take();
        let before = before.map(|it| self.as_before(&it).expect("the memory is of this drive"));
        let start = before.map(|it| {
            let mut system = it.system;
            // Whoever begins there says what is logged.
            system.log_events(EventKinds::default());
            system.watch(None);
            self.assembled.come_to(system, &it.state)
        });
        self.sample(self.sights, time);
        // Nothing is copied: the lists change hands.
        swap(&mut sample.observation, &mut self.observation);
        swap(&mut sample.ended, &mut self.ended[0]);
        swap(&mut sample.struck, &mut self.struck[0]);
        swap(&mut sample.periods, &mut self.periods[0]);
        swap(&mut sample.readings, &mut self.readings[0]);
        Ok((sample, start))
    }

    /// Resets the clock so that the record of `run` begins at t = 0; samples that were taken since then are kept.
    pub(crate) fn begun_at(
        self,
        start: Assembled,
        run: &Run,
        ahead: impl IntoIterator<Item = Box<Sample>>,
    ) -> Self {
        Self {
            assembled: Arc::new(start),
            until: run.until,
            every: run.every,
            ahead: ahead.into_iter().collect(),
            next: 0,
            start_energy: None,
            ..self
        }
    }

    /// Advances to a time \[s\] and reads tensions of spans and motions of bodies there; a change before that time is no longer possible.
    pub(crate) fn look(
        &mut self,
        time: f64,
        stop: &dyn Fn() -> bool,
    ) -> Result<&Observation, SimulationError> {
        self.go_to(time, Changes::None, stop)?;
        self.observe_some(Sights::SPANS, time);
        Ok(&self.observation)
    }

    /// Steps to a time \[s\], however many steps that takes, unless somebody wants to stop.
    fn go_to(
        &mut self,
        time: f64,
        changes: Changes,
        stop: &dyn Fn() -> bool,
    ) -> Result<(), SimulationError> {
        while !self.step_towards(time, LOOK, changes)? {
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        Ok(())
    }

    /// Whether samples taken in advance are still to be handed out.
    pub(crate) fn has_samples_ahead(&self) -> bool {
        !self.ahead.is_empty()
    }

    /// Hands out a sample that was taken before, as that of a time \[s\].
    pub(super) fn hand_out(&mut self, sample: Sample, time: f64) {
        let zero = self.zero();
        self.observation = sample.observation;
        self.observation.time = time;
        self.start_energy.get_or_insert(self.observation.energy);
        self.read = time;
        self.next += 1;
        let ended = &mut self.ended[0];
        *ended = sample.ended;
        for event in ended {
            count_from(zero, event);
        }
        let struck = &mut self.struck[0];
        *struck = sample.struck;
        for impact in struck.iter_mut() {
            impact.time -= zero;
        }
        // Those before the record are not of it.
        struck.retain(|it| it.time >= 0.0);
        // The period in which the record begins has begun less than a sample before it.
        let begin = -self.every;
        let periods = &mut self.periods[0];
        *periods = sample.periods;
        for it in periods.iter_mut() {
            it.count_from(zero);
        }
        periods.retain(|it| it.time[0] > begin);
        self.readings[0].clear();
        let length = self.reading_length;
        for row in sample.readings.chunks_exact(length) {
            let time = row[0] - zero;
            if time > begin {
                let readings = &mut self.readings[0];
                readings.push(time);
                readings.extend(&row[1..]);
            }
        }
    }
}

//! Views: some channels of a drive in motion, in memory of their own.

use std::ops::Range;

use chaindrive_integrate::Moment;
use chaindrive_mechanics::{Observation, Sights};

use super::{Moving, Simulation};
use crate::{Channel, SimulationError};

/// Some channels of one simulation, as they were when it was last [read](Simulation::read_into).
///
/// # Example
///
/// ```
/// use chaindrive::{Channel, Run, Scene, Simulation};
///
/// let drive = Scene::preset("marine_two_sprockets")?.drive()?;
/// let mut simulation = Simulation::start(&drive, &Run::default())?;
/// let mut view = simulation.view(&[Channel::SpanTension, Channel::SprocketSpeed])?;
/// for _ in 0..10 {
///     simulation.step(1)?;
///     simulation.read_into(&mut view);
///     assert!(view.values(0).iter().chain(view.values(1)).all(|it| it.is_finite()));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct View {
    channels: Vec<Channel>,
    /// Ends of the entries of every channel.
    ends: Vec<usize>,
    values: Vec<f64>,
    sights: Sights,
    seen: Observation,
}

impl View {
    /// Its channels.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Entries of a channel, by its place among the channels.
    ///
    /// # Panics
    /// There are not so many channels.
    pub fn values(&self, channel: usize) -> &[f64] {
        &self.values[self.range(channel)]
    }

    /// Entries of all channels, one after the other.
    pub fn all(&self) -> &[f64] {
        &self.values
    }

    /// Places of a channel among all entries.
    ///
    /// # Panics
    /// There are not so many channels.
    pub fn range(&self, channel: usize) -> Range<usize> {
        let start = channel.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[channel]
    }
}

impl Simulation {
    /// A view of some channels, as they are at the last reading.
    ///
    /// # Errors
    /// [`SimulationError::AbsentChannel`]: the drive has nothing of the kind.
    pub fn view(&mut self, channels: &[Channel]) -> Result<View, SimulationError> {
        if let Some(absent) = channels.iter().find(|it| !it.is_of(self.system())) {
            return Err(SimulationError::AbsentChannel {
                name: absent.name(),
            });
        }
        let mut view = View {
            channels: channels.to_vec(),
            ends: Vec::new(),
            values: Vec::new(),
            sights: Channel::sights_of(channels),
            seen: Observation::default(),
        };
        self.read_into(&mut view);
        Ok(view)
    }

    /// Reads the channels of a view at the time of the last reading.
    ///
    /// They are what [`channel`](Self::channel) says there, to the bit. After a [step](Self::step) of an explicit method neither
    /// of them allocates, once the windows around sprockets and guides have had their most rollers.
    pub fn read_into(&mut self, view: &mut View) {
        let View {
            channels,
            ends,
            values,
            sights,
            seen,
        } = view;
        self.look_at(*sights, seen);
        let start = self.start_energy.unwrap_or(seen.energy);
        values.clear();
        ends.clear();
        for channel in channels {
            channel.read(seen, &start, values);
            ends.push(values.len());
        }
    }

    /// Takes a number of steps and reads at the end of the last one; tells the time there \[s\].
    ///
    /// Steps are those of the method: shorter before an event, and of their own length where it follows the error.
    ///
    /// # Errors
    /// [`SimulationError::Integration`]: the motion ceases to be finite.
    pub fn step(&mut self, steps: u64) -> Result<f64, SimulationError> {
        self.before = None;
        let moving = &mut self.moving;
        for left in (0..steps).rev() {
            // Forces are read at the end of the last step alone.
            let from = if left == 0 {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            };
            moving.system.keep_forces_from(from);
            moving.step()?;
        }
        self.end_periods();
        self.gather();
        if steps > 0 {
            self.read = self.time();
            self.hand_out_ended();
        }
        Ok(self.read)
    }

    /// Reads these sights at the time of the last reading.
    pub(super) fn look_at(&mut self, sights: Sights, seen: &mut Observation) {
        let clock = self.zero() + self.read;
        let [q, v, flows, z] = &mut self.buffers;
        let Moving { system, state, .. } = &self.moving;
        let (at, flows) = if clock.to_bits() == state.t.to_bits() {
            (
                Moment {
                    t: clock,
                    q: &state.q,
                    v: &state.v,
                    z: &state.z,
                },
                &*state.quadratures,
            )
        } else {
            state.at(clock, q, v);
            if sights.has(Sights::ENERGIES) {
                state.quadratures_at(clock, flows);
            }
            state.states_at(clock, z);
            (Moment { t: clock, q, v, z }, flows.as_slice())
        };
        system.observe_some(sights, at, flows, &mut self.record, seen);
        seen.time = self.read;
    }
}

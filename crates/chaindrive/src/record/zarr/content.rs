//! The arrays of a run: those that grow with time, the table of contacts, and the labels.

use chaindrive_mechanics::{Energy, EventKinds};
use serde_json::{Map, Value};

use super::events::EventTracks;
use crate::channel::{Axis, Channel, chains_along, labels};
use crate::record::Provenance;
use crate::zarr::{Fault, Storage, Track, about, samples_per_chunk, store_chains, store_labels};
use crate::{Judgement, Simulation};

/// All arrays of a run.
pub(super) struct Content {
    time: Track,
    tracks: Vec<(Channel, Track)>,
    /// Contacts, where they are logged.
    events: Option<EventTracks>,
    /// Metadata of the arrays that do not grow.
    fixed: Vec<(&'static str, Value)>,
    start: Option<Energy>,
}

impl Content {
    pub(super) fn new(
        storage: &Storage,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<Self, Fault> {
        let system = simulation.system();
        let width = |channel: &Channel| labels(channel.axis(), system).map_or(1, |it| it.len());
        let samples = samples_per_chunk(channels.iter().map(width).max().unwrap_or(1));
        let mut fixed = Vec::new();
        let mut tracks: Vec<(Channel, Track)> = Vec::new();
        for &channel in channels {
            if tracks.iter().any(|(known, _)| *known == channel) {
                continue;
            }
            let axis = channel.axis();
            if let (Some(name), Some(labels)) = (axis.name(), labels(axis, system))
                && !fixed.iter().any(|(known, _)| *known == name)
            {
                fixed.push((name, store_labels(storage, name, axis, &labels)?));
            }
            let mut about = Map::new();
            let (units, unit) = channel.unit_attribute(system);
            about.insert(units.into(), unit.into());
            about.insert("long_name".into(), channel.description().into());
            if let (Some(along), Some(name), Some(chains)) = (
                axis.name(),
                axis.chain_coordinate(),
                chains_along(axis, system),
            ) {
                // By this attribute readers of netCDF and Zarr know a coordinate that is no dimension.
                about.insert("coordinates".into(), name.into());
                if !fixed.iter().any(|(known, _)| *known == name) {
                    fixed.push((name, store_chains(storage, name, along, &chains)?));
                }
            }
            tracks.push((
                channel,
                Track::new(storage, channel.name(), axis, system, samples, about)?,
            ));
        }
        let about = about("s", "time");
        let time = Track::new(storage, "time", Axis::None, system, samples, about)?;
        let logged = provenance.run.events != EventKinds::default();
        let events = logged.then(|| EventTracks::new(storage, system));
        Ok(Self {
            time,
            tracks,
            events: events.transpose()?,
            fixed,
            start: None,
        })
    }

    /// Goes on after the samples and contacts that are in the store, with the energy at the start of the run.
    pub(super) fn go_on(
        &mut self,
        samples: u64,
        contacts: u64,
        start: Option<Energy>,
    ) -> Result<(), Fault> {
        self.start = start;
        self.time.go_on(samples)?;
        for (_, track) in &mut self.tracks {
            track.go_on(samples)?;
        }
        match &mut self.events {
            Some(events) => events.go_on(contacts),
            None => Ok(()),
        }
    }

    /// Every array that grows, with its last chunk in use.
    pub(super) fn last_chunks(&self) -> Vec<(&'static str, u64)> {
        let tracks = self.tracks.iter().map(|(_, track)| track);
        let tracks = std::iter::once(&self.time).chain(tracks);
        let mut all: Vec<_> = tracks.map(|it| (it.name, it.last_chunk())).collect();
        if let Some(events) = &self.events {
            let (last, names) = events.last_chunk();
            all.extend(names.map(|name| (name, last)));
        }
        all
    }

    /// Takes the last sample of the simulation, and the contacts that have ended.
    pub(super) fn push(&mut self, simulation: &Simulation) -> Result<(), Fault> {
        let sample = simulation.observation();
        let start = *self.start.get_or_insert(sample.energy);
        self.time.push(|to| to.push(sample.time))?;
        for (channel, track) in &mut self.tracks {
            track.push(|to| channel.read(sample, &start, to))?;
        }
        match &mut self.events {
            Some(events) => events.push(simulation.events()),
            None => Ok(()),
        }
    }

    /// Takes the contacts that last beyond the run.
    pub(super) fn push_outstanding(&mut self, simulation: &Simulation) -> Result<(), Fault> {
        match &mut self.events {
            Some(events) => events.push(&simulation.outstanding_events()),
            None => Ok(()),
        }
    }

    /// Tells the channels whose waveforms cease to mean anything; takes effect with the next [`store`](Self::store).
    pub(super) fn judge(&mut self, judgement: &Judgement) {
        for (channel, track) in &mut self.tracks {
            if let Some(horizon) = judgement.horizon_of(*channel) {
                track.tell("waveform_horizon", horizon.at.into());
                track.tell("waveform_horizon_of", horizon.found_on.name().into());
            }
        }
    }

    /// Stores the chunks in work and then the metadata of the arrays, which it returns by name.
    pub(super) fn store(&mut self, samples: u64) -> Result<Map<String, Value>, Fault> {
        let mut arrays = Map::new();
        let tracks = self.tracks.iter_mut().map(|(_, track)| track);
        let mut growing: Vec<&mut Track> = std::iter::once(&mut self.time).chain(tracks).collect();
        for track in &mut growing {
            track.store()?;
            track.set_length(samples)?;
            arrays.insert(track.name.into(), track.metadata()?);
        }
        if let Some(events) = &mut self.events {
            events.store()?;
            events.set_length()?;
            for (name, metadata) in events.metadata()? {
                arrays.insert(name.into(), metadata);
            }
        }
        for track in growing {
            track.store_metadata()?;
        }
        if let Some(events) = &self.events {
            events.store_metadata()?;
        }
        for (name, metadata) in &self.fixed {
            arrays.insert((*name).into(), metadata.clone());
        }
        Ok(arrays)
    }
}

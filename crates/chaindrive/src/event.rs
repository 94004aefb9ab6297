//! The table of contacts: one row for every contact from touch to parting.

use chaindrive_mechanics::{ContactEvent, ContactPair, System};

/// Contents of a column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventColumn {
    /// Kind of the contact: see [`EventTable::KINDS`].
    Kind,
    /// Name of the sprocket or guide; empty in joints.
    Body,
    /// Number of the roller or joint.
    Roller,
    /// When it began.
    Start,
    /// When it ended.
    End,
    /// Closing speed at touch.
    OnsetSpeed,
    /// Largest normal force.
    PeakForce,
    /// Force integrated over time.
    Impulse,
}

impl EventColumn {
    /// All columns.
    pub const ALL: [Self; 8] = [
        Self::Kind,
        Self::Body,
        Self::Roller,
        Self::Start,
        Self::End,
        Self::OnsetSpeed,
        Self::PeakForce,
        Self::Impulse,
    ];

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind => "event_kind",
            Self::Body => "event_body",
            Self::Roller => "event_roller",
            Self::Start => "event_start",
            Self::End => "event_end",
            Self::OnsetSpeed => "event_onset_speed",
            Self::PeakForce => "event_peak_force",
            Self::Impulse => "event_impulse",
        }
    }

    /// SI unit; none for names and numbers of things.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::Kind | Self::Body | Self::Roller => None,
            Self::Start | Self::End => Some("s"),
            Self::OnsetSpeed => Some("m/s"),
            Self::PeakForce => Some("N"),
            Self::Impulse => Some("N s"),
        }
    }

    /// One line of description.
    pub fn description(self) -> &'static str {
        match self {
            Self::Kind => "what touched: tooth, guide, joint, or roller on its bush",
            Self::Body => "sprocket or guide; empty in joints",
            Self::Roller => "number of the roller or joint",
            Self::Start => "when the contact began",
            Self::End => "when it ended; infinite where it lasts beyond the run",
            Self::OnsetSpeed => "closing speed at touch, also below the floor of the law",
            Self::PeakForce => "largest normal force",
            Self::Impulse => "normal force integrated over the contact",
        }
    }
}

/// Contacts, column by column.
#[derive(Clone, Debug, Default)]
pub struct EventTable {
    sprockets: Vec<String>,
    guides: Vec<String>,
    /// Kind of the contact, (event,).
    pub kind: Vec<&'static str>,
    /// Sprocket or guide, (event,).
    pub body: Vec<String>,
    /// Roller or joint, (event,).
    pub roller: Vec<i64>,
    /// Start \[s\], (event,).
    pub start: Vec<f64>,
    /// End \[s\], (event,).
    pub end: Vec<f64>,
    /// Closing speed at touch \[m/s\], (event,).
    pub onset_speed: Vec<f64>,
    /// Largest normal force \[N\], (event,).
    pub peak_force: Vec<f64>,
    /// Impulse \[N s\], (event,).
    pub impulse: Vec<f64>,
}

impl EventTable {
    /// Names of the kinds of contact: roller on tooth, chain on guide, pin in bush, bush in roller.
    pub const KINDS: [&'static str; 4] = ["tooth", "guide", "joint", "roller"];

    /// An empty table for a system.
    pub fn new(system: &System) -> Self {
        Self {
            sprockets: system.sprocket_names(),
            guides: system.guide_names(),
            ..Self::default()
        }
    }

    /// Appends one contact.
    pub fn push(&mut self, event: &ContactEvent) {
        let name = |names: &[String], index: usize| names.get(index).cloned().unwrap_or_default();
        let (body, roller) = match event.pair {
            ContactPair::Tooth { sprocket, roller } => (name(&self.sprockets, sprocket), roller),
            ContactPair::Guide { guide, roller } => (name(&self.guides, guide), roller),
            ContactPair::Joint { joint } | ContactPair::Roller { joint } => (String::new(), joint),
        };
        self.kind.push(Self::KINDS[kind(event.pair)]);
        self.body.push(body);
        self.roller.push(i64::try_from(roller).unwrap_or(i64::MAX));
        self.start.push(event.start);
        self.end.push(event.end);
        self.onset_speed.push(event.onset_speed);
        self.peak_force.push(event.peak_force);
        self.impulse.push(event.impulse);
    }

    /// Number of contacts held.
    pub fn len(&self) -> usize {
        self.start.len()
    }

    /// Whether no contact is held.
    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// Removes all contacts.
    pub fn clear(&mut self) {
        let (sprockets, guides) = (
            std::mem::take(&mut self.sprockets),
            std::mem::take(&mut self.guides),
        );
        *self = Self {
            sprockets,
            guides,
            ..Self::default()
        };
    }

    /// As [`numbers`](Self::numbers), to be filled.
    pub(crate) fn numbers_mut(&mut self, column: EventColumn) -> Option<&mut Vec<f64>> {
        match column {
            EventColumn::Kind | EventColumn::Body | EventColumn::Roller => None,
            EventColumn::Start => Some(&mut self.start),
            EventColumn::End => Some(&mut self.end),
            EventColumn::OnsetSpeed => Some(&mut self.onset_speed),
            EventColumn::PeakForce => Some(&mut self.peak_force),
            EventColumn::Impulse => Some(&mut self.impulse),
        }
    }

    /// A column of numbers; none for kind, body and roller.
    pub fn numbers(&self, column: EventColumn) -> Option<&[f64]> {
        match column {
            EventColumn::Kind | EventColumn::Body | EventColumn::Roller => None,
            EventColumn::Start => Some(&self.start),
            EventColumn::End => Some(&self.end),
            EventColumn::OnsetSpeed => Some(&self.onset_speed),
            EventColumn::PeakForce => Some(&self.peak_force),
            EventColumn::Impulse => Some(&self.impulse),
        }
    }
}

/// Index of the kind of a pair in [`EventTable::KINDS`].
pub(crate) fn kind(pair: ContactPair) -> usize {
    match pair {
        ContactPair::Tooth { .. } => 0,
        ContactPair::Guide { .. } => 1,
        ContactPair::Joint { .. } => 2,
        ContactPair::Roller { .. } => 3,
    }
}

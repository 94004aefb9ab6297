//! Offset of the sprockets of a span out of line.

use crate::drive::{Layout, Parts, Sprocket, Stop};

/// A span between two sprockets that are not in one plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// Its name, as [`System::span_names`](crate::System::span_names) has it.
    pub span: String,
    /// The sprocket at its beginning.
    pub sprocket: String,
    /// Distance Δy of the two planes \[m\].
    pub offset: f64,
    /// Length L of the span \[m\].
    pub length: f64,
    /// Distance of the two shafts \[m\].
    pub centres: f64,
}

impl Alignment {
    fn between(here: &Sprocket, next: &Sprocket) -> Self {
        // L² = d² − (R₁ ∓ R₂)²: an outer or an inner tangent
        let turns = here.side.sense() * next.side.sense();
        let across = here.gap.pitch_radius - turns * next.gap.pitch_radius;
        let centres = (here.centre - next.centre).norm();
        Self {
            span: format!("{}-{}", here.name, next.name),
            sprocket: here.name.clone(),
            offset: (here.lateral - next.lateral).abs(),
            length: (centres * centres - across * across).max(0.0).sqrt(),
            centres,
        }
    }

    /// Slope of the span, tan γ \[–\], with a play \[m\] within which it takes none.
    pub fn slope(&self, play: f64) -> f64 {
        // tan γ = max(0, |Δy| − play)/L
        let offset = (self.offset - play).max(0.0);
        if offset > 0.0 {
            offset / self.length
        } else {
            0.0
        }
    }
}

impl Parts {
    /// The spans after every sprocket of a closed route.
    pub(crate) fn alignments(&self, route: &[usize]) -> Vec<Alignment> {
        let next = route.iter().cycle().skip(1);
        let pairs = route.iter().zip(next);
        let between = |(here, next): (&usize, &usize)| {
            Alignment::between(&self.sprockets[*here], &self.sprockets[*next])
        };
        pairs.map(between).collect()
    }

    /// All spans whose sprockets are not in one plane, chain by chain.
    pub fn out_of_line(&self) -> Vec<Alignment> {
        let mut found = Vec::new();
        for placed in &self.chains {
            let Layout::Route { stops, .. } = &placed.layout else {
                continue;
            };
            let sprockets = stops.iter().filter_map(|stop| match stop {
                Stop::Sprocket(index) => Some(*index),
                Stop::Guide(_) => None,
            });
            let route: Vec<usize> = sprockets.collect();
            let spans = self.alignments(&route).into_iter();
            found.extend(spans.filter(|it| it.offset > 0.0));
        }
        found
    }
}

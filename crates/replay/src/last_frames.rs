//! The last frames of a drive in motion, as a film.

use chaindrive_mechanics::Observation;

use crate::animation::{Animation, Curve, PageTexts};
use crate::picture::Picture;

/// Frames as they come, of which the oldest are forgotten.
#[derive(Clone, Debug)]
pub struct LastFrames {
    film: Animation,
    most: usize,
}

impl LastFrames {
    /// No frames yet of a drive with these spans; at least the last `most` of those to come are kept.
    pub fn of(picture: &Picture, spans: &[String], most: usize) -> Self {
        let curve = |span: &String| Curve {
            channel: "span_tension".to_owned(),
            name: "span tension".to_owned(),
            unit: "N".to_owned(),
            label: span.clone(),
            values: Vec::new(),
        };
        let mut film = Animation {
            bodies: picture.bodies.clone(),
            chains: picture.chains.clone(),
            curves: spans.iter().map(curve).collect(),
            ..Animation::default()
        };
        film.frames.link_tension = Some(Vec::new());
        film.frames.contact_force = Some(Vec::new());
        film.frames.contact_direction = Some(Vec::new());
        Self {
            film,
            most: most.max(1),
        }
    }

    /// Takes a frame: what a drive looks like at an observation that the picture was moved to. One that is not later than the last is left out.
    pub fn take(&mut self, picture: &Picture, seen: &Observation) {
        let times = &self.film.frames.times;
        if times.last().is_some_and(|last| *last >= seen.time) {
            return;
        }
        let room = 2 * self.most;
        if times.len() >= room {
            self.forget(times.len() - self.most);
        }
        let frames = &mut self.film.frames;
        extend(&mut frames.times, &[seen.time], room);
        extend(&mut frames.placements, picture.placements(), room);
        extend(&mut frames.roller_x, &seen.roller_x, room);
        extend(&mut frames.roller_y, &seen.roller_y, room);
        let channels = [
            (&mut frames.link_tension, &seen.link_tension[..]),
            (&mut frames.contact_force, &seen.contact_force[..]),
            (&mut frames.contact_direction, picture.directions()),
        ];
        for (kept, values) in channels {
            extend(kept.get_or_insert_default(), values, room);
        }
        for (curve, tension) in self.film.curves.iter_mut().zip(&seen.span_tension) {
            extend(&mut curve.values, &[*tension], room);
        }
    }

    /// Forgets the first frames.
    fn forget(&mut self, count: usize) {
        if count == 0 {
            return;
        }
        let frames = &mut self.film.frames;
        let all = frames.times.len();
        let channels = [
            &mut frames.link_tension,
            &mut frames.contact_force,
            &mut frames.contact_direction,
        ];
        let lists = channels.into_iter().flatten();
        let lists = lists.chain([
            &mut frames.times,
            &mut frames.placements,
            &mut frames.roller_x,
            &mut frames.roller_y,
        ]);
        let curves = self.film.curves.iter_mut().map(|curve| &mut curve.values);
        for list in lists.chain(curves) {
            let width = list.len() / all;
            list.drain(..count * width);
        }
    }

    /// The film of the last frames, with a title.
    pub fn film(&self, title: &str) -> Animation {
        let mut last = self.clone();
        let all = last.film.frames.times.len();
        last.forget(all.saturating_sub(self.most));
        last.film.about = PageTexts {
            title: title.to_owned(),
            status: "complete".to_owned(),
            version: format!("chaindrive {}", env!("CARGO_PKG_VERSION")),
            samples: last.film.frames.times.len(),
            stride: 1,
            ..PageTexts::default()
        };
        last.film
    }
}

/// Appends the values of a frame; the first one makes room for all that are ever kept, so that memory does not grow afterwards.
fn extend(kept: &mut Vec<f64>, values: &[f64], frames: usize) {
    if kept.capacity() == 0 {
        kept.reserve_exact(frames * values.len());
    }
    kept.extend_from_slice(values);
}

#[cfg(test)]
mod tests {
    use chaindrive::{Instant, Run, Scene, Simulation};

    use super::*;

    /// Of a motion that is watched for longer the last frames remain, each as it was seen.
    #[test]
    fn last_frames_are_those_seen_last() {
        let scene = Scene::preset("spinning_ring").unwrap();
        let mut simulation = Simulation::start(&scene.drive().unwrap(), &Run::default()).unwrap();
        let mut picture = Picture::of(simulation.assembled().figure().unwrap()).unwrap();
        let mut last = LastFrames::of(&picture, &["a".to_owned()], 4);
        let mut seen = Vec::new();
        for index in 0..23 {
            let now = simulation.advance_to(1e-4 * f64::from(index)).unwrap();
            let forces = now.contact_force.clone();
            picture.move_to(&Instant::of(now), Some(&forces)).unwrap();
            // Twice the same is one frame.
            last.take(&picture, now);
            last.take(&picture, now);
            seen.push((now.time, now.roller_x.clone()));
        }
        let film = last.film("ring");
        let expected = &seen[seen.len() - 4..];
        let times: Vec<f64> = expected.iter().map(|it| it.0).collect();
        assert_eq!(film.frames.times, times);
        let places: Vec<f64> = expected.iter().flat_map(|it| it.1.clone()).collect();
        assert_eq!(film.frames.roller_x, places);
        assert!(crate::page(&film).contains("<title>ring</title>"));
    }
}

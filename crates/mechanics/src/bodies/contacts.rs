//! The contacts of one chain with the bodies that it can touch.

use chaindrive_geometry::Point;
use chaindrive_integrate::Moment;

use super::{Anchor, Bodies};
use crate::contact::{Arrivals, Impacts};
use crate::contact::{Contacts, Frame, Places, PlateContact};
use crate::seam::{Loads, Pose, Way};
use crate::surface::Surface;

/// Contacts with sprockets, then with guides.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyContacts {
    pub(crate) teeth: Vec<WheelContacts>,
    pub(crate) rails: Vec<GuideContacts>,
}

impl BodyContacts {
    /// Whether there is anything to touch.
    pub(crate) fn any(&self) -> bool {
        !(self.teeth.is_empty() && self.rails.is_empty())
    }
}

/// Contacts with the teeth of one sprocket.
#[derive(Clone, Debug)]
pub(crate) struct WheelContacts {
    /// Which one.
    pub(crate) wheel: usize,
    /// Whether no chain before this one touches it.
    pub(crate) first: bool,
    pub(crate) contacts: Contacts,
    /// An angle of the sprocket with known cosine and sine, renewed with the windows.
    pub(crate) anchor: Anchor,
    /// Impacts since the start.
    pub(crate) impacts: Impacts,
    /// Impacts of rollers that come.
    pub(crate) arrivals: Arrivals,
}

/// Contacts with one guide.
#[derive(Clone, Debug)]
pub(crate) struct GuideContacts {
    /// Which one.
    pub(crate) rail: usize,
    /// Whether no chain before this one touches it.
    pub(crate) first: bool,
    pub(crate) contact: RailContact,
    /// Impacts since the start.
    pub(crate) impacts: Impacts,
}

/// Parts of the chain that touch a guide: rollers, or plates.
#[derive(Clone, Debug)]
pub(crate) enum RailContact {
    Circles(Contacts),
    Plates(PlateContact),
}

impl RailContact {
    pub(crate) fn surface(&self) -> &Surface {
        match self {
            Self::Circles(contacts) => &contacts.surface,
            Self::Plates(plates) => &plates.surface,
        }
    }
}

impl BodyContacts {
    /// Where the bodies are and how they move, sprockets first; `at` is the whole state.
    pub(crate) fn frames(&self, bodies: &Bodies, at: Moment<'_>, frames: &mut [Frame]) {
        let (wheels, rails) = frames.split_at_mut(self.teeth.len());
        for (frame, on) in wheels.iter_mut().zip(&self.teeth) {
            *frame = bodies.wheel_frame(on.wheel, &on.anchor, at);
        }
        for (frame, on) in rails.iter_mut().zip(&self.rails) {
            *frame = bodies.rail_frame(on.rail, at);
        }
    }

    /// Derivatives of the frame origins by the coordinates of the tensioners that carry them.
    pub(crate) fn ways(
        &self,
        bodies: &Bodies,
        at: Moment<'_>,
        frames: &[Frame],
        ways: &mut [Option<Way>],
    ) {
        let wheels = self
            .teeth
            .iter()
            .map(|on| bodies.wheels[on.wheel].carried());
        let rails = self.rails.iter().map(|on| bodies.rails[on.rail].carried());
        let carriers = wheels.chain(rails);
        for ((way, frame), carrier) in ways.iter_mut().zip(frames).zip(carriers) {
            *way = carrier.and_then(|index| {
                let slide = &bodies.slides[index];
                slide.way(slide.pose(at.q, at.v), frame.origin)
            });
        }
    }

    /// Turns the anchors to where the sprockets are.
    pub(crate) fn anchor(&mut self, bodies: &Bodies, at: Moment<'_>) {
        for on in &mut self.teeth {
            let kinematics = bodies.wheels[on.wheel].kinematics(at.t, at.q, at.v);
            on.anchor = Anchor::at(kinematics.position);
        }
    }

    /// Lays new windows; returns the greatest speed of a roller against a rim \[m/s\].
    pub(crate) fn renew(
        &mut self,
        bodies: &Bodies,
        at: Moment<'_>,
        pose: Pose<'_>,
        rollers: usize,
        margin: f64,
    ) -> f64 {
        let fastest = pose.vx[..rollers]
            .iter()
            .zip(pose.vy)
            .map(|(x, y)| x * x + y * y)
            .fold(0.0, f64::max)
            .sqrt();
        let mut speed = fastest;
        let places = Places {
            x: pose.x,
            y: pose.y,
            count: rollers,
        };
        self.anchor(bodies, at);
        for on in &mut self.teeth {
            let wheel = &bodies.wheels[on.wheel];
            let rate = wheel.kinematics(at.t, at.q, at.v).rate;
            let frame = bodies.wheel_frame(on.wheel, &on.anchor, at);
            let rim_radius = wheel.pitch_radius + wheel.eccentricity.norm();
            let rim = rate.abs() * rim_radius + frame.velocity.norm();
            speed = speed.max(fastest + rim);
            on.contacts.renew(&frame, places, margin);
            on.arrivals.look_around(&on.contacts);
        }
        for on in &mut self.rails {
            let frame = bodies.rail_frame(on.rail, at);
            match &mut on.contact {
                RailContact::Circles(contacts) => contacts.renew(&frame, places, margin),
                RailContact::Plates(plates) => plates.renew(&frame, places, margin),
            }
        }
        speed
    }

    /// Says when the memory of the contacts is of.
    pub(crate) fn set_clock(&mut self, t: f64) {
        for on in &mut self.teeth {
            on.contacts.accepted = t;
        }
        for on in &mut self.rails {
            match &mut on.contact {
                RailContact::Circles(contacts) => contacts.accepted = t,
                RailContact::Plates(plates) => plates.accepted = t,
            }
        }
    }

    /// Takes over what was found at an accepted state.
    pub(crate) fn commit(&mut self, t: f64, loads: &mut Loads) {
        for (on, wrench) in self.teeth.iter_mut().zip(&loads.wheel_wrenches) {
            on.impacts.note(&wrench.begun, wrench.depth);
        }
        for (on, wrench) in self.rails.iter_mut().zip(&loads.rail_wrenches) {
            on.impacts.note(&wrench.begun, wrench.depth);
        }
        for (k, (on, touch)) in self.teeth.iter_mut().zip(&mut loads.teeth).enumerate() {
            let begun = loads.wheel_wrenches[k].begun.count > 0.0;
            on.arrivals
                .note(on.wheel, &on.contacts, &touch.state, t, begun);
            std::mem::swap(&mut on.contacts.memory, touch);
            on.contacts.accepted = t;
        }
        for (i, on) in self.rails.iter_mut().enumerate() {
            match &mut on.contact {
                RailContact::Circles(contacts) => {
                    std::mem::swap(&mut contacts.memory, &mut loads.rails[i]);
                    contacts.accepted = t;
                }
                RailContact::Plates(plates) => {
                    std::mem::swap(&mut plates.memory, &mut loads.rails[i]);
                    plates.accepted = t;
                }
            }
        }
    }

    /// Contacts of circles, with sprockets and with guides.
    pub(crate) fn circles(&self) -> impl Iterator<Item = &Contacts> {
        let rails = self.rails.iter().filter_map(|on| match &on.contact {
            RailContact::Circles(contacts) => Some(contacts),
            RailContact::Plates(_) => None,
        });
        self.teeth.iter().map(|on| &on.contacts).chain(rails)
    }

    /// Visits every body with its least distance \[m\] from touching, as a function of the place of a roller or pin, and its index if it is a sprocket.
    pub(crate) fn each_room(
        &self,
        bodies: &Bodies,
        at: Moment<'_>,
        mut visit: impl FnMut(Option<usize>, &dyn Fn(Point) -> f64),
    ) {
        for on in &self.teeth {
            let frame = bodies.wheel_frame(on.wheel, &on.anchor, at);
            visit(Some(on.wheel), &|place| on.contacts.room(&frame, place));
        }
        for on in &self.rails {
            let frame = bodies.rail_frame(on.rail, at);
            match &on.contact {
                RailContact::Circles(contacts) => {
                    visit(None, &|place| contacts.room(&frame, place));
                }
                RailContact::Plates(plates) => visit(None, &|place| plates.room(&frame, place)),
            }
        }
    }

    /// Says whether the faces that rollers press on are to be written down.
    pub(crate) fn write_faces(&mut self, wanted: bool) {
        for on in &mut self.teeth {
            on.contacts.writes_faces = wanted;
        }
        for on in &mut self.rails {
            if let RailContact::Circles(contacts) = &mut on.contact {
                contacts.writes_faces = wanted;
            }
        }
    }
}

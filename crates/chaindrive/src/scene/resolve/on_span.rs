//! Guides placed by shares of the spans that they work on, and the bow that makes the links close.

use std::f64::consts::TAU;

use chaindrive_geometry::{
    Closing, CurvedGuide, GeometryError, Plan, Point, Rearranged, Search, Side, Span, Station,
    Vector, Wheel, close_nearest, rearrangements,
};
use chaindrive_mechanics::{Sprocket, Touches};

use super::chains::ChainDescription;
use super::point;
use crate::scene::schema::{self, Face, Guide, Route, SceneText, TravelSide};

/// Bow at which the search for one begins, its first step and how far it goes \[pitches\].
const SEARCH: [f64; 3] = [0.5, 0.1, 10.0];

/// The chain as a guide on its span needs it: stops, sizes and route.
pub(super) struct GuidedChain<'s> {
    pub(super) scene: &'s SceneText,
    route: Option<&'s Route>,
    /// Names of the stops, in path order.
    pub(super) stops: Vec<&'s str>,
    /// Pitch, roller diameter and plate height \[m\].
    pub(super) size: [f64; 3],
}

impl<'s> GuidedChain<'s> {
    pub(super) fn new(
        scene: &'s SceneText,
        described: &ChainDescription<'s>,
        size: [f64; 3],
    ) -> Self {
        let route = described.route;
        let named = route.and_then(|route| route.stops.as_ref());
        let stops = if let Some(names) = named {
            names.iter().map(String::as_str).collect()
        } else {
            let own = described.sprockets.iter();
            own.map(|&i| scene.sprockets[i].name.as_str()).collect()
        };
        Self {
            scene,
            route,
            stops,
            size,
        }
    }

    /// Position of the first sprocket within a tooth, if the route gives one.
    pub(super) fn phase(&self) -> Option<f64> {
        Some(self.route?.phase?.0)
    }

    /// The route as a plan.
    ///
    /// # Errors
    /// A stop that is no wheel, whose bow is open, or whose name nothing has.
    pub(super) fn plan(&self) -> Result<Plan, String> {
        let stations = (0..self.stops.len()).map(|stop| self.station(stop, None));
        Ok(Plan {
            stops: stations.collect::<Result<_, _>>()?,
        })
    }

    /// A stop; `bow` is that of a guide that leaves it open.
    fn station(&self, stop: usize, bow: Option<f64>) -> Result<Station, String> {
        let name = self.stops[stop];
        if let Some(wheel) = self.sprocket(name) {
            return Ok(Station::Wheel(wheel));
        }
        let guide = self.scene.guides.iter().find(|guide| guide.name == name);
        let guide = guide.ok_or_else(|| format!("no sprocket or guide is named `{name}`"))?;
        let neither = || {
            format!(
                "it follows from routes around sprockets and arcs, and the face of `{name}` is neither"
            )
        };
        match &guide.face {
            Face::OnSpan { bow: given, .. } => {
                let open =
                    || format!("the bow of `{name}` is open: give it, or the number of links");
                let bow = given.map(f64::from).or(bow).ok_or_else(open)?;
                let curved = curved(guide, bow, self.size).ok_or_else(neither)?;
                Ok(Station::Guide(curved))
            }
            Face::Arc {
                centre,
                radius,
                from,
                to,
            } => {
                let ride = guide.touches.ride(radius.0, self.size);
                let middle = from.0 + 0.5 * (to.0 - from.0).rem_euclid(TAU);
                let normal = Vector::new(middle.cos(), middle.sin());
                let [before, after] = self.beside(stop).ok_or_else(neither)?;
                let travel = after.centre - before.centre;
                // The chain passes on the side of the normal.
                let side = if travel.perp(&normal) > 0.0 {
                    Side::Right
                } else {
                    Side::Left
                };
                Ok(Station::Wheel(Wheel::smooth(point(*centre), ride, side)))
            }
            Face::Bar { .. } | Face::Points { .. } => Err(neither()),
        }
    }

    /// The sprocket of a name as a wheel.
    fn sprocket(&self, name: &str) -> Option<Wheel> {
        let sprocket = self.scene.sprockets.iter().find(|s| s.name == name)?;
        let side = match sprocket.side {
            schema::Side::Left => Side::Left,
            schema::Side::Right => Side::Right,
        };
        let [pitch, ..] = self.size;
        let centre = point(sprocket.centre);
        Some(Wheel::toothed(centre, sprocket.teeth, pitch, side))
    }

    /// The sprockets before and after a stop.
    fn beside(&self, stop: usize) -> Option<[Wheel; 2]> {
        let count = self.stops.len();
        let before =
            (1..=count).find_map(|i| self.sprocket(self.stops[(stop + count - i) % count]));
        let after = (1..=count).find_map(|i| self.sprocket(self.stops[(stop + i) % count]));
        Some([before?, after?])
    }

    /// The span that a guide lies on.
    pub(super) fn span(
        &self,
        guide: &Guide,
        between: Option<&[String; 2]>,
    ) -> Result<Span, String> {
        let [before, after] = if let Some([before, after]) = between {
            let known = |name: &String| {
                let missing = || format!("between: no sprocket is named `{name}`");
                self.sprocket(name).ok_or_else(missing)
            };
            [known(before)?, known(after)?]
        } else {
            let stop = self.stops.iter().position(|stop| *stop == guide.name);
            let stop = stop.ok_or(
                "between: missing; name the two sprockets of the span, or make the guide a stop of the route",
            )?;
            let alone = "between: no sprocket stands beside it on the route";
            self.beside(stop).ok_or(alone)?
        };
        Span::between(&before, &after).map_err(|error| {
            error.with_names(&|wheel| ["the sprocket before", "the sprocket after"][wheel].into())
        })
    }

    /// The sprockets beside the span that a guide lies on: name, centre \[m\], and radius of the tips \[m\].
    pub(super) fn tips(
        &self,
        guide: &Guide,
        between: Option<&[String; 2]>,
        sprockets: &[Sprocket],
    ) -> Vec<(String, Point, f64)> {
        let stop = self.stops.iter().position(|stop| *stop == guide.name);
        let is_beside = |sprocket: &&Sprocket| match (between, stop) {
            (Some(names), _) => names.contains(&sprocket.name),
            (None, stop) => {
                let wheels = stop.and_then(|stop| self.beside(stop));
                let centres = wheels.iter().flatten().map(|wheel| wheel.centre);
                centres.into_iter().any(|it| it == sprocket.centre)
            }
        };
        let beside = sprockets.iter().filter(is_beside);
        let told = |it: &Sprocket| (it.name.clone(), it.centre, it.gap.tip_radius);
        beside.map(told).collect()
    }

    /// The least and the greatest number of pitches that the route takes with some bow of a guide; none where it cannot be laid.
    pub(super) fn pitches_by_bow(&self, guide: &Guide, phase: f64) -> Option<[f64; 2]> {
        let stop = self.stops.iter().position(|stop| *stop == guide.name)?;
        let [pitch, ..] = self.size;
        let [_, step, within] = SEARCH.map(|pitches| pitches * pitch);
        let bows = (0..).map(|k| f64::from(k) * step);
        let bows = bows.take_while(|bow| *bow <= within);
        let taken = bows.filter_map(|bow| {
            let stations =
                (0..self.stops.len()).map(|i| self.station(i, (i == stop).then_some(bow)));
            let stops = stations.collect::<Result<_, _>>().ok()?;
            let wheels = Plan { stops }.lay().ok()?;
            let closing = Closing::march(&wheels, pitch, phase).ok()?;
            Some(closing.excess(0) / pitch)
        });
        taken.fold(None, |range, pitches| {
            let [least, most] = range.unwrap_or([pitches; 2]);
            Some([pitches.min(least), pitches.max(most)])
        })
    }

    /// The bow of a guide with which so many links close without stress.
    pub(super) fn closing_bow(
        &self,
        guide: &Guide,
        links: usize,
        phase: f64,
    ) -> Result<f64, String> {
        let stop = self.stops.iter().position(|stop| *stop == guide.name);
        let stop =
            stop.ok_or("missing; only that of a stop of the route can follow from the links")?;
        let [pitch, ..] = self.size;
        let [start, step, within] = SEARCH.map(|pitches| pitches * pitch);
        let plan = Plan {
            stops: (0..self.stops.len())
                .map(|i| self.station(i, (i == stop).then_some(start)))
                .collect::<Result<_, _>>()?,
        };
        let links = u32::try_from(links).map_err(|_| "more links than a chain can have")?;
        if let Err(error) = plan.lay() {
            let name = |wheel: usize| format!("`{}`", self.stops.get(wheel).unwrap_or(&"?"));
            let other = self.other_order(guide, f64::from(links), start);
            let other = other.map_or_else(String::new, |it| format!("; {it}"));
            return Err(format!("{}{other}", error.with_names(&name)));
        }
        let mut moving = |bow: f64| {
            let plan = plan.moved(stop, Vector::zeros(), bow - start);
            plan.lay().unwrap_or_default()
        };
        let search = Search {
            start,
            step,
            within,
        };
        let name = |wheel: usize| format!("`{}`", self.stops.get(wheel).unwrap_or(&"?"));
        let found = close_nearest(pitch, 0.0, links, phase, &mut moving, search);
        let (bow, ..) = found.map_err(|error| {
            let told = error.with_names(&name);
            match error {
                GeometryError::DoesNotClose { slack, .. } if slack > 0.0 => format!(
                    "{told}; or give `{}` a smaller radius or a shorter face: it then bows the chain further",
                    guide.name
                ),
                _ => told,
            }
        })?;
        Ok(bow)
    }
}

impl GuidedChain<'_> {
    /// The order of the stops in which a chain of about so many links can lie around them, with a bow \[m\] of a guide that leaves it open.
    fn other_order(&self, guide: &Guide, links: f64, bow: f64) -> Option<String> {
        let lay = |order: &[usize]| {
            let other = Self {
                stops: order.iter().map(|stop| self.stops[*stop]).collect(),
                ..*self
            };
            let open = |name: &str| (name == guide.name).then_some(bow);
            let stations = other.stops.iter().enumerate();
            let stops = stations.map(|(stop, name)| other.station(stop, open(name)));
            let stops = stops.collect::<Result<_, _>>().ok()?;
            Plan { stops }.lay().ok()
        };
        let [pitch, ..] = self.size;
        let found = rearrangements(self.stops.len(), &lay, pitch);
        let moved = found.iter().filter(|it| it.turned.is_none());
        let best = Rearranged::nearest(moved, links)?;
        let names = best
            .order
            .iter()
            .map(|stop| format!("\"{}\"", self.stops[*stop]));
        let names: Vec<String> = names.collect();
        Some(format!(
            "with `stops = [{}]` the chain can lie around all of them",
            names.join(", ")
        ))
    }
}

/// A convex face on a span; none for any other.
pub(super) fn curved(guide: &Guide, bow: f64, size: [f64; 3]) -> Option<CurvedGuide> {
    let Face::OnSpan {
        from,
        to,
        radius: Some(radius),
        crest,
        material,
        ..
    } = &guide.face
    else {
        return None;
    };
    Some(CurvedGuide {
        shares: [from.0, to.0],
        crest: crest.map_or(0.5 * (from.0 + to.0), |crest| crest.0),
        bow,
        radius: radius.0,
        ride: guide.touches.ride(radius.0, size),
        side: side(*material),
    })
}

pub(super) fn side(material: TravelSide) -> Side {
    match material {
        TravelSide::Left => Side::Left,
        TravelSide::Right => Side::Right,
    }
}

/// Distance from a straight face to the line through the centres of rollers that touch it \[m\].
pub(super) fn above(touches: Touches, [_, roller_diameter, plate_height]: [f64; 3]) -> f64 {
    match touches {
        Touches::Rollers => 0.5 * roller_diameter,
        Touches::Eyes | Touches::Plates => 0.5 * plate_height,
    }
}

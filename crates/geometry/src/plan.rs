//! A drive as a designer says it: sprockets in their places, guides and idlers by the spans that they work on.

use crate::{Arc, CurvedGuide, GeometryError, IdlerByWrap, Route, Vector, Wheel};

/// One stop of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Station {
    /// A wheel with a place of its own.
    Wheel(Wheel),
    /// A curved guide on the bare span between the wheels before and after that have places of their own.
    Guide(CurvedGuide),
    /// An idler on that bare span.
    Idler {
        /// The wheel; its centre is found.
        wheel: Wheel,
        /// Share of the span at which it stands \[–\].
        share: f64,
        /// Angle by which the chain wraps it where nothing else works on the span \[rad\].
        wrap: f64,
    },
}

/// The stops of a closed chain, in the order in which it passes them.
///
/// A plan is laid anew when one of its wheels moves: guides and idlers follow their spans.
///
/// ```
/// use chaindrive_geometry::{CurvedGuide, LinkCounts, Plan, Point, Side, Station, Wheel};
///
/// # fn main() -> Result<(), chaindrive_geometry::GeometryError> {
/// let sprocket = |x, teeth| Wheel::toothed(Point::new(x, 0.0), teeth, 8e-3, Side::Left);
/// let rail = CurvedGuide { shares: [0.1, 0.9], crest: 0.5, bow: 2e-3, radius: 1.0, ride: 1.0025, side: Side::Right };
/// let stops = vec![Station::Wheel(sprocket(0.0, 18)), Station::Guide(rail), Station::Wheel(sprocket(0.3, 36))];
/// let wheels = Plan { stops }.lay()?;
/// assert_eq!(LinkCounts::around(&wheels, 8e-3, 0.5)?.even_above, 104);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The stops; two or more of them are wheels with places of their own.
    pub stops: Vec<Station>,
}

impl Plan {
    /// All stops as wheels of a route.
    ///
    /// # Errors
    /// Those of [`Route::taut`] for the bare route, of [`CurvedGuide::on`] and of [`IdlerByWrap::into`].
    pub fn lay(&self) -> Result<Vec<Wheel>, GeometryError> {
        let bare = self.bare()?;
        let spans = self.spans(bare.spans.len());
        let stops = self.stops.iter().zip(spans);
        stops
            .map(|(stop, span)| match *stop {
                Station::Wheel(wheel) => Ok(wheel),
                Station::Guide(guide) => {
                    let face = guide.on(&bare.spans[span])?;
                    Ok(Wheel::smooth(face.centre, guide.ride, guide.side))
                }
                Station::Idler { wheel, share, wrap } => {
                    let (wheels, _) = IdlerByWrap { span, share, wrap }.into(&bare, wheel)?;
                    Ok(wheels[span + 1])
                }
            })
            .collect()
    }

    /// The faces of its guides, each with the number of its stop.
    ///
    /// # Errors
    /// As [`lay`](Self::lay).
    pub fn faces(&self) -> Result<Vec<(usize, Arc)>, GeometryError> {
        let bare = self.bare()?;
        let spans = self.spans(bare.spans.len());
        let stops = self.stops.iter().zip(spans).enumerate();
        stops
            .filter_map(|(index, (stop, span))| match stop {
                Station::Guide(guide) => {
                    Some(guide.on(&bare.spans[span]).map(|face| (index, face)))
                }
                Station::Wheel(_) | Station::Idler { .. } => None,
            })
            .collect()
    }

    /// The taut route around the wheels with places of their own.
    ///
    /// # Errors
    /// Those of [`Route::taut`].
    pub fn bare(&self) -> Result<Route, GeometryError> {
        let own = self.stops.iter().filter_map(|stop| match stop {
            Station::Wheel(wheel) => Some(*wheel),
            Station::Guide(_) | Station::Idler { .. } => None,
        });
        Route::taut(&own.collect::<Vec<_>>())
    }

    /// The plan with one stop changed by `travel`: a wheel moved along a direction \[m\], the bow of a guide \[m\], the wrap of an
    /// idler \[rad\]. No such stop: the plan as it is.
    #[must_use]
    pub fn moved(&self, stop: usize, direction: Vector, travel: f64) -> Self {
        let mut plan = self.clone();
        match plan.stops.get_mut(stop) {
            Some(Station::Wheel(wheel)) => {
                let along = direction.try_normalize(0.0).unwrap_or_default();
                wheel.centre += along * travel;
            }
            Some(Station::Guide(guide)) => guide.bow += travel,
            Some(Station::Idler { wrap, .. }) => *wrap += travel,
            None => {}
        }
        plan
    }

    /// The bare span that every stop lies on, or begins with it.
    fn spans(&self, count: usize) -> impl Iterator<Item = usize> {
        // What comes before the first wheel lies on the last span.
        let mut passed = count;
        self.stops.iter().map(move |stop| {
            if matches!(stop, Station::Wheel(_)) {
                passed += 1;
            }
            (passed + count - 1) % count
        })
    }
}

//! Guides and idlers placed by the span that they work on, not by coordinates.
//!
//! A place along a span is a *share*: 0 where the chain leaves the wheel before, 1 where it arrives at the wheel after.

use crate::{Arc, GeometryError, Point, Route, Side, Span, Vector, Wheel};

/// Most halvings until an interval of numbers holds none of its own.
const HALVINGS: u32 = 200;

impl Span {
    /// The point at a share of the span \[m\].
    pub fn at(&self, share: f64) -> Point {
        self.leaves + (self.arrives - self.leaves) * share
    }

    /// Unit vector along travel \[–\].
    pub fn along(&self) -> Vector {
        Vector::new(self.direction.cos(), self.direction.sin())
    }

    /// Unit vector across the span, away from the side on which something lies \[–\]: the way it pushes.
    pub fn away_from(&self, side: Side) -> Vector {
        // The left normal points away from what lies on the right.
        let sense = -side.sense();
        Vector::new(-self.direction.sin(), self.direction.cos()) * sense
    }
}

/// A curved guide on a span: its crest bends the chain by the bow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvedGuide {
    /// Shares of the span between which the face lies \[–\].
    pub shares: [f64; 2],
    /// Share of the crest, where the face is parallel to the span \[–\].
    pub crest: f64,
    /// How far the crest pushes the centres of the rollers across the span \[m\]; negative: how far it keeps clear.
    pub bow: f64,
    /// Radius of the face \[m\].
    pub radius: f64,
    /// Radius of the circle that roller centres ride on \[m\], or equivalent: larger than the face by half a roller or plate.
    pub ride: f64,
    /// Side of the travelling chain on which the guide lies.
    pub side: Side,
}

impl CurvedGuide {
    /// The face on `span`, convex toward the chain.
    ///
    /// With A and L begin and length of the span, u along and n across it toward the chain, crest share s and bow b:
    ///
    /// ```text
    /// C = A + s L u + (b − R_ride) n        sin φ = (share − s) L / R
    /// ```
    ///
    /// # Errors
    /// Numbers that are not finite; shares in the wrong order; a face that would be more than a half circle.
    ///
    /// # Example
    ///
    /// ```
    /// use chaindrive_geometry::{CurvedGuide, Point, Route, Side, Wheel};
    ///
    /// # fn main() -> Result<(), chaindrive_geometry::GeometryError> {
    /// let sprocket = |x| Wheel::toothed(Point::new(x, 0.0), 20, 8e-3, Side::Left);
    /// let route = Route::taut(&[sprocket(0.0), sprocket(0.3)])?;
    /// let ride = 0.5 + 2.5e-3;
    /// let rail = CurvedGuide { shares: [0.2, 0.8], crest: 0.5, bow: 0.0, radius: 0.5, ride, side: Side::Right };
    /// let face = rail.on(&route.spans[0])?;
    /// // A roller on the straight span touches the crest.
    /// assert!((face.centre - route.spans[0].at(0.5)).norm() - ride < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    pub fn on(&self, span: &Span) -> Result<Arc, GeometryError> {
        for (what, value) in [
            ("share where the guide begins", self.shares[0]),
            ("share where the guide ends", self.shares[1]),
            ("share of the crest", self.crest),
            ("bow [m]", self.bow),
        ] {
            GeometryError::finite(what, value)?;
        }
        GeometryError::positive("radius of the guide [m]", self.radius)?;
        GeometryError::positive("radius of the rollers on the guide [m]", self.ride)?;
        let [from, to] = self.shares;
        if from >= to {
            return Err(GeometryError::OutOfRange {
                what: "share where the guide ends",
                value: to,
                allowed: "greater than the share where it begins",
            });
        }
        // sin φ = (share − s) L / R
        let sines = self
            .shares
            .map(|share| (share - self.crest) * span.length / self.radius);
        if let Some(&sine) = sines.iter().find(|sine| sine.abs() > 1.0) {
            return Err(GeometryError::OutOfRange {
                what: "reach of the guide from its crest / its radius",
                value: sine.abs(),
                allowed: "at most 1: take a larger radius, or shares nearer to the crest",
            });
        }
        let across = span.away_from(self.side);
        // C = A + s L u + (b − R_ride) n
        let centre = span.at(self.crest) + across * (self.bow - self.ride);
        let crest = across.y.atan2(across.x);
        let angles = sines.map(f64::asin);
        // Along travel a face on the right is passed clockwise.
        let start = match self.side {
            Side::Left => crest + angles[0],
            Side::Right => crest - angles[1],
        };
        Ok(Arc {
            centre,
            radius: self.radius,
            start_angle: start,
            sweep: angles[1] - angles[0],
        })
    }
}

/// A wheel that is pushed across a span until the chain wraps it by an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdlerByWrap {
    /// Span of the route without the idler.
    pub span: usize,
    /// Share of the span at which its centre lies \[–\].
    pub share: f64,
    /// Angle by which the chain wraps it \[rad\], in (0, π).
    pub wrap: f64,
}

impl IdlerByWrap {
    /// Puts `idler`, whose centre is free, into a route: the wheels in their new order, and how far it pushes the chain \[m\].
    ///
    /// # Errors
    /// No such span; an angle outside (0, π); an idler that meets its neighbours before the chain wraps it so far, with the angle
    /// that it reaches.
    pub fn into(self, route: &Route, idler: Wheel) -> Result<(Vec<Wheel>, f64), GeometryError> {
        let Some(span) = route.spans.get(self.span) else {
            return Err(GeometryError::Count {
                what: "number of the span",
                got: self.span,
                expected: format!("less than {}, the number of spans", route.spans.len()),
            });
        };
        GeometryError::finite("share of the span", self.share)?;
        GeometryError::positive("wrap angle [rad]", self.wrap)?;
        if self.wrap >= std::f64::consts::PI {
            return Err(GeometryError::OutOfRange {
                what: "wrap angle [rad]",
                value: self.wrap,
                allowed: "less than a half turn",
            });
        }
        let across = span.away_from(idler.side);
        let at = |push: f64| {
            let mut wheels = route.wheels.clone();
            let centre = span.at(self.share) + across * (push - idler.radius);
            wheels.insert(self.span + 1, Wheel { centre, ..idler });
            wheels
        };
        let place = self.span + 1;
        // None where there is no route, or where the idler has come through to another span.
        let wrap = |push: f64| {
            let laid = Route::taut(&at(push)).ok()?;
            stands_free(&laid, place).then(|| laid.wraps[place])
        };
        // Pushed further the wrap grows.
        let (mut low, mut reached) = (0.0, 0.0);
        let mut high = 1e-3 * span.length;
        let mut refused = None;
        for _ in 0..HALVINGS {
            match wrap(high) {
                Some(angle) if angle < self.wrap => {
                    (low, reached) = (high, angle);
                    // By no more than it is thick, so that it does not step through a span.
                    high = refused.map_or(high + high.min(idler.radius), |refused| {
                        low.midpoint(refused)
                    });
                }
                Some(_) => {
                    refused = None;
                    break;
                }
                None => {
                    refused = Some(high);
                    high = low.midpoint(high);
                }
            }
        }
        if refused.is_some() || high <= low {
            return Err(GeometryError::Wrap {
                asked: self.wrap.to_degrees(),
                reached: f64::to_degrees(reached),
            });
        }
        for _ in 0..HALVINGS {
            let middle = low.midpoint(high);
            if middle <= low || middle >= high {
                break;
            }
            if wrap(middle).is_some_and(|angle| angle < self.wrap) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok((at(high), high))
    }
}

/// Whether the spans that do not meet at a wheel pass it by.
fn stands_free(route: &Route, wheel: usize) -> bool {
    let own = [(wheel + route.spans.len() - 1) % route.spans.len(), wheel];
    let others = route.spans.iter().enumerate();
    let mut others = others.filter(|(span, _)| !own.contains(span));
    others.all(|(_, span)| {
        let from = route.wheels[wheel].centre - span.leaves;
        let along = from.dot(&span.along()).clamp(0.0, span.length);
        (from - span.along() * along).norm() > route.wheels[wheel].radius
    })
}

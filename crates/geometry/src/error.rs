//! Mistakes in a shape.

use crate::Point;

/// Why a shape cannot be built. Every message says what, where, and what is allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum GeometryError {
    /// A number is infinite or not a number.
    #[error("{what} = {value}, must be finite")]
    NotFinite { what: &'static str, value: f64 },

    /// A number lies outside its range.
    #[error("{what} = {value}, must be {allowed}")]
    OutOfRange {
        what: &'static str,
        value: f64,
        allowed: &'static str,
    },

    /// An arc's ends do not lie on one circle about its centre.
    #[error(
        "the ends of the arc are {start_radius} m and {end_radius} m from its centre, must be equal"
    )]
    UnequalRadii { start_radius: f64, end_radius: f64 },

    /// A curve needs at least one piece.
    #[error("the curve has no pieces, needs at least one")]
    NoPieces,

    /// A piece is too short to have a direction.
    #[error("piece {piece} is {length} m long, must exceed {least} m")]
    ShortPiece {
        piece: usize,
        length: f64,
        least: f64,
    },

    /// A piece has a number that is not finite, a radius that is not positive, or too wide a sweep.
    #[error("piece {piece}: {source}")]
    Piece {
        piece: usize,
        source: Box<GeometryError>,
    },

    /// Two neighbouring pieces do not meet.
    #[error("the pieces before and after joint {joint} are {gap} m apart, allowed are {allowed} m")]
    OpenJoint {
        joint: usize,
        gap: f64,
        allowed: f64,
    },

    /// A closed curve runs clockwise, so that the material would lie outside.
    #[error(
        "the closed curve has a signed area of {area} m², must be positive (counter-clockwise)"
    )]
    Clockwise { area: f64 },

    /// No such wheel.
    #[error(
        "a sprocket of {teeth} teeth is outside the range of its tooth form, {least} to {most}"
    )]
    Teeth { teeth: u32, least: u32, most: u32 },

    /// The tooth form cannot be drawn with these numbers.
    #[error("tooth form, {teeth} teeth: {what} is {value} m, must be {allowed}")]
    ToothForm {
        teeth: u32,
        what: &'static str,
        value: f64,
        allowed: String,
    },

    /// A corner of a rail has no room for its rounding.
    #[error(
        "the rounding of corner {corner} takes {needed} m of its shorter side, there are {available} m"
    )]
    Rounding {
        corner: usize,
        needed: f64,
        available: f64,
    },

    /// A list does not have the length another list asks for.
    #[error("{what}: there are {got}, must be {expected}")]
    Count {
        what: &'static str,
        got: usize,
        expected: String,
    },

    /// Two neighbouring points coincide.
    #[error("points {first} and {second} coincide, must be apart")]
    Coincident { first: usize, second: usize },

    /// A chain needs two wheels to run around.
    #[error("the route has {wheels} wheels, needs at least two")]
    TooFewWheels { wheels: usize },

    /// A wheel of a route has a number that is out of range.
    #[error("{}", faulty(&number, *.wheel, .source))]
    Wheel {
        wheel: usize,
        source: Box<GeometryError>,
    },

    /// Two sprockets in one plane need more room.
    #[error("{}", overlap(&number, [*.first, *.second], *.distance, *.least))]
    WheelsOverlap {
        first: usize,
        second: usize,
        distance: f64,
        least: f64,
    },

    /// Two neighbours on the route have no common tangent on the sides asked for.
    #[error("{}", no_tangent(&number, [*.from, *.to], *.distance, *.least))]
    NoTangent {
        from: usize,
        to: usize,
        distance: f64,
        least: f64,
    },

    /// The chain crosses itself, or misses a wheel.
    #[error("{}", turns_wrongly(&number, *.turns, *.wheel, *.wrap, *.around))]
    RouteTurns {
        turns: f64,
        wheel: usize,
        wrap: f64,
        /// Sense in which the centres follow one another \[–\]: +1 counter-clockwise, −1 clockwise, 0 on a line.
        around: f64,
    },

    /// An idler cannot be wrapped as far as asked for.
    #[error(
        "the chain wraps the idler by {reached:.1} degrees at most, asked were {asked:.1}; ask for less, take a smaller wheel, or another place on the span"
    )]
    Wrap { asked: f64, reached: f64 },

    /// Fewer links than a drive needs.
    #[error("{links} links are too few, these wheels need more than {least:.2}")]
    TooFewLinks { links: f64, least: f64 },

    /// No way of laying the chain into the teeth was found.
    #[error("{}", no_seat(&number, [*.from, *.to]))]
    NoSeat { from: usize, to: usize },

    /// A route of more links than anybody lays, which would take for ever.
    #[error(
        "the taut route takes {taut:e} links, and at most {most:e} are laid; are places and pitch given in their units? A bare number is in metres"
    )]
    TooLong { taut: f64, most: f64 },

    /// The number of links does not fit the wheels.
    #[error("{}", does_not_close(&number, self))]
    DoesNotClose {
        /// Links asked for.
        links: u32,
        /// Links of the taut route, at the most favourable place if wheels may move.
        taut: f64,
        /// Length of the chain beyond that of the route \[m\]; positive: too long.
        slack: f64,
        /// Links of the shortest and of the longest route that moving wheels make; none where they stand still.
        reach: Option<Box<[f64; 2]>>,
        /// Next count below, and by how much it is too short \[m\].
        below: u32,
        short: f64,
        /// Next count above, and by how much it is too long \[m\].
        above: u32,
        long: f64,
        /// Where a wheel would have to stand for the links asked for; none where moving one alone does not do it.
        remedy: Option<Box<Remedy>>,
    },
}

/// A wheel, and where it would have to stand for a chain to close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// The wheel, by its place on the route.
    pub wheel: usize,
    /// How far it would move \[m\].
    pub travel: f64,
    /// Where its centre would be \[m\].
    pub centre: Point,
    /// Distance of the centres \[m\], where there are two wheels.
    pub centre_distance: Option<f64>,
}

impl GeometryError {
    /// The message with a name instead of the number of a wheel, counted from 0 along the route.
    ///
    /// ```
    /// use chaindrive_geometry::GeometryError;
    ///
    /// let error = GeometryError::NoSeat { from: 0, to: 1 };
    /// assert!(error.to_string().contains("from wheel 0"));
    /// let named = error.with_names(&|wheel| ["`crank`", "`cam`"][wheel].to_owned());
    /// assert!(named.contains("from `crank` into a seat of `cam`"));
    /// ```
    pub fn with_names(&self, name: &dyn Fn(usize) -> String) -> String {
        match self {
            Self::Wheel { wheel, source } => faulty(name, *wheel, source),
            Self::WheelsOverlap {
                first,
                second,
                distance,
                least,
            } => overlap(name, [*first, *second], *distance, *least),
            Self::NoTangent {
                from,
                to,
                distance,
                least,
            } => no_tangent(name, [*from, *to], *distance, *least),
            Self::RouteTurns {
                turns,
                wheel,
                wrap,
                around,
            } => turns_wrongly(name, *turns, *wheel, *wrap, *around),
            Self::NoSeat { from, to } => no_seat(name, [*from, *to]),
            Self::DoesNotClose { .. } => does_not_close(name, self),
            other => other.to_string(),
        }
    }

    /// Refuses a number that is infinite or not a number.
    pub(crate) fn finite(what: &'static str, value: f64) -> Result<(), Self> {
        if value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotFinite { what, value })
        }
    }

    /// Refuses a number that is not finite and positive.
    pub(crate) fn positive(what: &'static str, value: f64) -> Result<(), Self> {
        Self::finite(what, value)?;
        if value > 0.0 {
            Ok(())
        } else {
            Err(Self::OutOfRange {
                what,
                value,
                allowed: "positive",
            })
        }
    }
}

/// Name of a wheel.
type Name<'n> = &'n dyn Fn(usize) -> String;

/// Name of a wheel where only its place on the route is known.
fn number(wheel: usize) -> String {
    format!("wheel {wheel}")
}

fn faulty(name: Name<'_>, wheel: usize, source: &GeometryError) -> String {
    format!("{}: {source}", name(wheel))
}

fn overlap(name: Name<'_>, [first, second]: [usize; 2], distance: f64, least: f64) -> String {
    let (first, second) = (name(first), name(second));
    format!(
        "{first} and {second} overlap: their centres are {distance} m apart, must be more than {least} m; move one of them"
    )
}

fn no_tangent(name: Name<'_>, [from, to]: [usize; 2], distance: f64, least: f64) -> String {
    let (from, to) = (name(from), name(to));
    format!(
        "no straight span leads from {from} to {to}: their centres are {distance} m apart, must be more than {least} m; move one of them, or put it on the other side of the chain"
    )
}

fn turns_wrongly(name: Name<'_>, turns: f64, wheel: usize, wrap: f64, around: f64) -> String {
    let wheel = name(wheel);
    // −0 would be told as such.
    let turns = turns.round() + 0.0;
    let sides = if around > 0.0 {
        "; the stops follow one another counter-clockwise: those inside the chain lie on its `left`, all others on its `right`"
    } else if around < 0.0 {
        "; the stops follow one another clockwise: those inside the chain lie on its `right`, all others on its `left`"
    } else {
        ""
    };
    format!(
        "the taut chain turns {turns:.0} times on its way round, must be once (+1 or -1): at {wheel} it would wrap {wrap:.1} degrees; check the order of the stops, and on which side of the chain {wheel} lies{sides}"
    )
}

fn no_seat(name: Name<'_>, [from, to]: [usize; 2]) -> String {
    let (from, to) = (name(from), name(to));
    format!(
        "no link count reaches from {from} into a seat of {to}; move one of them apart, or compare the pitch with the teeth"
    )
}

fn does_not_close(name: Name<'_>, error: &GeometryError) -> String {
    let GeometryError::DoesNotClose {
        links,
        taut,
        slack,
        reach,
        below,
        short,
        above,
        long,
        remedy,
    } = error
    else {
        return String::new();
    };
    let is = if *slack > 0.0 {
        "too long"
    } else {
        "too short"
    };
    let moved = remedy.as_deref().map_or_else(
        || "move a wheel".to_owned(),
        |remedy| match remedy.centre_distance {
            Some(distance) => format!("a centre distance of {:.4} mm", distance * 1e3),
            None => format!(
                "move {} by {:.3} mm to ({:.3}, {:.3}) mm",
                name(remedy.wheel),
                remedy.travel.abs() * 1e3,
                remedy.centre.x * 1e3,
                remedy.centre.y * 1e3
            ),
        },
    );
    let slack = slack * 1e3;
    let share = taut / f64::from(*links);
    if !(1.0 / OTHER_UNIT..OTHER_UNIT).contains(&share) {
        return format!(
            "{links} links do not close: the taut route takes {taut:.0}; are places and pitch given in their units? A bare number is in metres"
        );
    }
    if let Some(reach) = reach {
        let [least, most] = **reach;
        return format!(
            "{links} links do not close: the taut route can be made {least:.3} to {most:.3} links long, so that the chain would be {is} (slack {slack:+.3} mm); {} for {links} links {moved}",
            within_reach(**reach)
        );
    }
    let odd = if below % 2 == 1 { below } else { above };
    format!(
        "{links} links do not close: the taut route takes {taut:.3}, so that the chain would be {is} (slack {slack:+.3} mm); {below} links are {:.3} mm too short, {above} are {:.3} mm too long ({odd} need an offset link); take one of these, or for {links} links {moved}",
        short * 1e3,
        long * 1e3
    )
}

/// The route is so many times longer or shorter than the chain that lengths must be in different units.
const OTHER_UNIT: f64 = 50.0;

/// The whole numbers of links between two lengths of a route, before what else would do.
fn within_reach([least, most]: [f64; 2]) -> String {
    let (first, last) = (least.ceil(), most.floor());
    if first > last {
        "no whole number lies between;".to_owned()
    } else if first < last {
        format!("take {first} to {last} (odd numbers need an offset link), or")
    } else if first % 2.0 == 0.0 {
        format!("take {first}, or")
    } else {
        format!("take {first}, which needs an offset link, or")
    }
}

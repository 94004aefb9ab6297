//! Layouts of closed chains: how many links they take, where they touch what, and where a body would have to stand for a number of
//! links to close.
//!
//! Everything follows from geometry alone; nothing is assembled or settled. A layout is made of a [drive](of) or of a [`Plan`].

mod text;

use chaindrive_geometry::{
    Closing, GeometryError, LinkCounts, Plan, Point, Route, Search, Side, Station, TwoWheels,
    Vector, Wheel, WheelKind, close_nearest,
};
use chaindrive_mechanics::{Adjust, AssemblyError, Clash, Drive, Layout, PlacedChain, Stop};
use schemars::JsonSchema;
use serde::Serialize;

/// Elongations by wear at which the travel of an adjusted body is given \[–\]: timing chains are replaced at 0.5 to 1 %, others at 2
/// to 3 %.
const ELONGATIONS: [f64; 9] = [0.0, 0.001, 0.002, 0.003, 0.005, 0.0075, 0.01, 0.02, 0.03];

/// First step of a search for a place \[pitches\].
const STEP: f64 = 0.1;

/// Range in which a position is searched for \[pitches\].
const REACH: f64 = 20.0;

/// A closed chain, laid out.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChainLayout {
    /// Its name; none where there is one only.
    pub chain: Option<String>,
    /// Pitch \[m\].
    pub pitch: f64,
    /// Place of the first sprocket within a tooth \[–\].
    pub phase: f64,
    /// Number of links that it has, or was asked for.
    pub links: Option<u32>,
    /// Length of the route beyond that of these links \[m\]: positive for a chain that is too short.
    pub misfit: Option<f64>,
    /// Travel of the adjusted body from where it is described \[m, or rad\].
    pub travel: Option<f64>,
    /// Whether travels are angles \[rad\].
    pub turns: bool,
    /// Numbers of links that the route takes.
    pub counts: Counts,
    /// Sprockets and guides, in path order.
    pub stops: Vec<StopLayout>,
    /// Straight spans, each after its stop.
    pub spans: Vec<SpanLayout>,
    /// Faces of guides that lie on spans by share; none of those that a scene places by coordinates.
    pub faces: Vec<FaceLayout>,
    /// Where one body would have to stand for the numbers of links next to those of the route.
    pub fits: Vec<Fit>,
    /// Where the adjusted body goes while the chain wears; empty where nothing is adjusted.
    pub wear: Vec<Worn>,
}

/// How many links a route takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Counts {
    /// By the exact polygon \[–\].
    pub pitches: f64,
    /// By the smooth taut curve \[–\].
    pub smooth: f64,
    /// Next whole number that is not longer than the route.
    pub below: u32,
    /// Next whole number that is not shorter.
    pub above: u32,
    /// Next even number that is not longer: no offset link.
    pub even_below: u32,
    /// Next even number that is not shorter.
    pub even_above: u32,
}

/// A sprocket or guide on the route.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StopLayout {
    /// Its name.
    pub name: String,
    /// Number of teeth; none for a guide.
    pub teeth: Option<u32>,
    /// Centre of the circle of roller centres (x, y) \[m\].
    pub centre: [f64; 2],
    /// Radius of that circle \[m\].
    pub radius: f64,
    /// Side of the travelling chain on which it lies: left or right.
    pub side: &'static str,
    /// Wrap angle between the points of tangency \[rad\].
    pub wrap: f64,
    /// Rollers seated on it.
    pub seated: u32,
    /// Angle of the first seated roller about the centre \[rad\]: that of a gap of the sprocket.
    pub seat_angle: f64,
}

/// A straight span.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SpanLayout {
    /// Name, "from-to".
    pub name: String,
    /// Direction of travel, counter-clockwise from the x axis \[rad\].
    pub direction: f64,
    /// Length between the points of tangency \[m\].
    pub length: f64,
    /// Links between the last roller seated before and the first one after.
    pub links: u32,
    /// Point of tangency where the chain leaves (x, y) \[m\].
    pub leaves: [f64; 2],
    /// Point of tangency where it arrives (x, y) \[m\].
    pub arrives: [f64; 2],
}

/// The face of a guide: an arc, as a scene says it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FaceLayout {
    /// Name of the guide.
    pub name: String,
    /// Centre (x, y) \[m\].
    pub centre: [f64; 2],
    /// Radius \[m\].
    pub radius: f64,
    /// Angle at which the face begins \[rad\].
    pub from: f64,
    /// Angle at which it ends \[rad\], counter-clockwise from `from`.
    pub to: f64,
}

/// Where a body would have to stand for a number of links to close exactly.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Fit {
    /// Number of links.
    pub links: u32,
    /// Whether it is odd, and needs an offset link.
    pub offset_link: bool,
    /// Name of the body.
    pub body: String,
    /// How far it moves from where it is described \[m, or rad for an arm\].
    pub travel: f64,
    /// Where its centre is then (x, y) \[m\]; none for an arm.
    pub centre: Option<[f64; 2]>,
    /// Distance of the centres \[m\], where there are two stops.
    pub centre_distance: Option<f64>,
}

/// Where the adjusted body stands when the links are worn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Worn {
    /// Elongation of the chain \[–\].
    pub elongation: f64,
    /// Travel of the body from where it is described \[m, or rad\]; none where the chain closes nowhere in reach.
    pub travel: Option<f64>,
}

/// The body that moves until a number of links closes.
struct Mover<'m> {
    /// Its name.
    body: String,
    /// Its place on the route, where it is one stop with a centre.
    stop: Option<usize>,
    /// The wheels after a travel; none where they cannot be laid.
    wheels: &'m mut dyn FnMut(f64) -> Vec<Wheel>,
    /// Length that turns its travel into metres \[m\]; 1 for a travel.
    reach: f64,
    /// Whether it turns, and its travel is an angle.
    turns: bool,
    /// Its travel.
    travel: f64,
    /// Named by the scene as what adjusts.
    adjusts: bool,
}

/// A chain and how it lies.
struct Chain<'c> {
    name: Option<String>,
    names: Vec<String>,
    wheels: &'c [Wheel],
    pitch: f64,
    links: Option<u32>,
    phase: f64,
}

/// The layouts of all closed chains of a drive, as they are laid, or as they are described where they do not close.
///
/// # Errors
/// A route that no chain can be laid along.
///
/// # Example
///
/// ```
/// use chaindrive::{Scene, design};
///
/// let drive = Scene::preset("industrial_16b")?.drive()?;
/// let layouts = design::of(&drive)?;
/// assert_eq!(layouts[0].counts.even_above, 120);
/// assert!(layouts[0].misfit.unwrap().abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn of(drive: &Drive) -> Result<Vec<ChainLayout>, AssemblyError> {
    let laid = drive.layouts().ok();
    let mut layouts = Vec::new();
    for (index, placed) in drive.chains.iter().enumerate() {
        let fitting = laid.as_ref().and_then(|laid| laid[index].fitting.as_ref());
        let fitted = fitting.map(|fitting| (fitting.wheels.clone(), fitting.travel));
        let found = of_chain(drive, index, placed, fitted)?;
        layouts.extend(found);
    }
    Ok(layouts)
}

/// Bodies in each other's way in a drive as its chains are laid.
///
/// # Errors
/// An outline that is none, which checked drives do not bring about.
pub fn clashes(drive: &Drive) -> Result<Vec<Clash>, AssemblyError> {
    Ok(drive.figure_as_laid()?.clashes)
}

/// The layout of one chain; none for one that lies along no route.
fn of_chain(
    drive: &Drive,
    index: usize,
    placed: &PlacedChain,
    fitted: Option<(Vec<Wheel>, f64)>,
) -> Result<Option<ChainLayout>, AssemblyError> {
    let Layout::Route {
        stops, phase, fit, ..
    } = &placed.layout
    else {
        return Ok(None);
    };
    let at_rest = || drive.wheels(index, &Adjust::Nothing, 0.0);
    let (wheels, travel) = match fitted {
        Some(fitted) => fitted,
        None => (at_rest()?.unwrap_or_default(), 0.0),
    };
    let links = placed.chain.links();
    let names: Vec<String> = stops.iter().map(|stop| name(drive, stop)).collect();
    let named = |error: GeometryError| AssemblyError::Route {
        problem: error.with_names(&|stop| format!("`{}`", names[stop])),
        source: error,
    };
    let chain = Chain {
        name: placed.name.clone(),
        names: names.clone(),
        wheels: &wheels,
        pitch: placed.chain.lengths.iter().sum::<f64>() / links as f64,
        links: u32::try_from(links).ok(),
        phase: *phase,
    };
    let route = Route::taut(&wheels).map_err(named)?;
    let mut by_adjust = |travel: f64| {
        let wheels = drive.wheels(index, &fit.adjust, travel);
        wheels.ok().flatten().unwrap_or_default()
    };
    let mut by_hand: Box<dyn FnMut(f64) -> Vec<Wheel>>;
    let mover = match &fit.adjust {
        Adjust::Sprocket { sprocket, .. } => Some(Mover {
            body: drive.sprockets[*sprocket].name.clone(),
            stop: stops.iter().position(|s| *s == Stop::Sprocket(*sprocket)),
            wheels: &mut by_adjust,
            reach: 1.0,
            turns: false,
            travel,
            adjusts: true,
        }),
        Adjust::Tensioner { tensioner, .. } => Some(Mover {
            body: drive.tensioners[*tensioner].name.clone(),
            stop: None,
            wheels: &mut by_adjust,
            reach: drive.tensioners[*tensioner].carrier.reach(),
            turns: drive.tensioners[*tensioner].carrier.coordinate_unit() == "rad",
            travel,
            adjusts: true,
        }),
        Adjust::Nothing => match route.most_effective() {
            Some((stop, direction)) => {
                let wheels = wheels.clone();
                by_hand = Box::new(move |travel: f64| {
                    let mut wheels = wheels.clone();
                    wheels[stop].centre += direction * travel;
                    wheels
                });
                Some(Mover {
                    body: names[stop].clone(),
                    stop: Some(stop),
                    wheels: &mut by_hand,
                    reach: 1.0,
                    turns: false,
                    travel: 0.0,
                    adjusts: false,
                })
            }
            None => None,
        },
    };
    chain.laid_out(mover).map(Some).map_err(named)
}

fn name(drive: &Drive, stop: &Stop) -> String {
    match *stop {
        Stop::Sprocket(i) => drive.sprockets[i].name.clone(),
        Stop::Guide(i) => drive.guides[i].name.clone(),
    }
}

/// The stop of a plan that moves until the links close.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Movement {
    /// The stop; that of the greatest effect where none is given.
    pub stop: Option<usize>,
    /// Direction of a wheel, of any length, that of the greatest effect where none is given; of guides and idlers bow and
    /// wrap change instead.
    pub direction: Option<Vector>,
}

impl Movement {
    /// The stop and direction that are meant on a route.
    fn on(self, route: &Route) -> Option<(usize, Vector)> {
        let most = route.most_effective();
        let stop = self.stop.or(most.map(|(stop, _)| stop))?;
        let effect = || match most {
            Some((effective, direction)) if effective == stop => direction,
            _ => route.lengthening(stop),
        };
        Some((stop, self.direction.unwrap_or_else(effect)))
    }
}

/// The layout of a plan; where a movement is given and a number of links, with that movement made.
///
/// `names` has a name for every stop.
///
/// # Errors
/// [`GeometryError`] of the plan; a number of links that closes nowhere in the movement.
pub fn of_plan(
    plan: &Plan,
    names: &[String],
    pitch: f64,
    links: Option<u32>,
    phase: f64,
    movement: Option<Movement>,
) -> Result<ChainLayout, GeometryError> {
    let at_rest = plan.lay()?;
    let chosen = movement.unwrap_or_default().on(&Route::taut(&at_rest)?);
    let moving = |travel: f64| match chosen {
        Some((stop, direction)) => plan.moved(stop, direction, travel).lay(),
        None => plan.lay(),
    };
    let mut moving = |travel: f64| moving(travel).unwrap_or_default();
    let (mut wheels, mut travel) = (at_rest.clone(), 0.0);
    if let (Some((stop, _)), Some(links)) = (chosen.filter(|_| movement.is_some()), links) {
        let search = search(0.0, pitch, reach(&plan.stops[stop]));
        (travel, wheels, _) = close_nearest(pitch, 0.0, links, phase, &mut moving, search)?;
    }
    let mover = chosen.map(|(stop, _)| Mover {
        body: names[stop].clone(),
        stop: Some(stop),
        wheels: &mut moving,
        reach: reach(&plan.stops[stop]),
        turns: matches!(plan.stops[stop], Station::Idler { .. }),
        travel,
        adjusts: movement.is_some(),
    });
    let chain = Chain {
        name: None,
        names: names.to_vec(),
        wheels: &wheels,
        pitch,
        links,
        phase,
    };
    let mut layout = chain.laid_out(mover)?;
    let made = chosen.map(|(stop, direction)| plan.moved(stop, direction, travel));
    let faces = made.as_ref().unwrap_or(plan).faces()?.into_iter();
    layout.faces = faces
        .map(|(stop, face)| FaceLayout {
            name: names[stop].clone(),
            centre: pair(face.centre),
            radius: face.radius,
            from: face.start_angle,
            to: face.start_angle + face.sweep,
        })
        .collect();
    Ok(layout)
}

/// The layout of an open drive: two sprockets, first and second, at a distance of their centres \[m\].
///
/// With a number of links the distance is that at which they close, nearest to the one that is given.
///
/// # Errors
/// Numbers out of range; neither a distance nor a number of links; links that close nowhere near.
///
/// # Example
///
/// ```
/// let layout = chaindrive::design::of_two_sprockets([19, 57], 25.4e-3, None, Some(120))?;
/// assert!((layout.fits[0].centre_distance.unwrap() - 1.029929958).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn of_two_sprockets(
    teeth: [u32; 2],
    pitch: f64,
    distance: Option<f64>,
    links: Option<u32>,
) -> Result<ChainLayout, GeometryError> {
    let distance = match (distance, links) {
        (Some(distance), _) => distance,
        // The smooth formula is some (π/z)² of a pitch off: where the search begins.
        (None, links) => {
            let links = f64::from(links.unwrap_or(0));
            TwoWheels { teeth, pitch }.centre_distance(links)?
        }
    };
    let sprocket =
        |x, teeth| Station::Wheel(Wheel::toothed(Point::new(x, 0.0), teeth, pitch, Side::Left));
    let plan = Plan {
        stops: vec![sprocket(0.0, teeth[0]), sprocket(distance, teeth[1])],
    };
    let names = ["first".to_owned(), "second".to_owned()];
    let movement = Movement {
        stop: Some(1),
        direction: Some(Vector::x()),
    };
    of_plan(&plan, &names, pitch, links, 0.5, links.map(|_| movement))
}

/// Length that turns a change of a stop into metres \[m\].
fn reach(stop: &Station) -> f64 {
    match stop {
        Station::Wheel(_) | Station::Guide(_) => 1.0,
        Station::Idler { wheel, .. } => wheel.radius,
    }
}

fn search(start: f64, pitch: f64, reach: f64) -> Search {
    Search {
        start,
        step: STEP * pitch / reach,
        within: REACH * pitch / reach,
    }
}

impl Chain<'_> {
    fn laid_out(&self, mover: Option<Mover<'_>>) -> Result<ChainLayout, GeometryError> {
        let Self {
            wheels,
            pitch,
            phase,
            ..
        } = *self;
        let route = Route::taut(wheels)?;
        let closing = Closing::march(wheels, pitch, phase)?;
        let counts = LinkCounts::around(wheels, pitch, phase)?;
        let mut layout = ChainLayout {
            chain: self.name.clone(),
            pitch,
            phase,
            links: self.links,
            misfit: self.links.map(|links| closing.excess(links)),
            travel: mover
                .as_ref()
                .filter(|mover| mover.adjusts)
                .map(|it| it.travel),
            turns: mover.as_ref().is_some_and(|mover| mover.turns),
            counts: Counts {
                pitches: counts.pitches,
                smooth: counts.smooth,
                below: counts.below,
                above: counts.above,
                even_below: counts.even_below,
                even_above: counts.even_above,
            },
            stops: self.stops(&route, &closing),
            spans: self.spans(&route, &closing),
            faces: Vec::new(),
            fits: Vec::new(),
            wear: Vec::new(),
        };
        if let Some(mut mover) = mover {
            layout.fits = self.fits(&layout.counts, &mut mover);
            if let Some(links) = self.links.filter(|_| mover.adjusts) {
                layout.wear = self.wear(links, &mut mover);
            }
        }
        Ok(layout)
    }

    fn stops(&self, route: &Route, closing: &Closing) -> Vec<StopLayout> {
        let all = self.names.iter().zip(self.wheels);
        let seats = closing.seats.iter().zip(&route.wraps);
        all.zip(seats)
            .map(|((name, wheel), (seat, wrap))| StopLayout {
                name: name.clone(),
                teeth: match wheel.kind {
                    WheelKind::Toothed { teeth } => Some(teeth),
                    WheelKind::Smooth => None,
                },
                centre: pair(wheel.centre),
                radius: wheel.radius,
                side: match wheel.side {
                    Side::Left => "left",
                    Side::Right => "right",
                },
                wrap: *wrap,
                seated: seat.pitches + 1,
                seat_angle: seat.first_angle,
            })
            .collect()
    }

    fn spans(&self, route: &Route, closing: &Closing) -> Vec<SpanLayout> {
        let spans = route.spans.iter().zip(&closing.spans).enumerate();
        spans
            .map(|(i, (span, links))| {
                let next = &self.names[(i + 1) % self.names.len()];
                SpanLayout {
                    name: format!("{}-{next}", self.names[i]),
                    direction: span.direction,
                    length: span.length,
                    links: *links,
                    leaves: pair(span.leaves),
                    arrives: pair(span.arrives),
                }
            })
            .collect()
    }

    /// Positions at which the links asked for close, and those for the numbers of links next to the length of the route.
    fn fits(&self, counts: &Counts, mover: &mut Mover<'_>) -> Vec<Fit> {
        let mut wanted = vec![
            counts.even_below,
            counts.below,
            counts.above,
            counts.even_above,
        ];
        wanted.extend(self.links);
        wanted.sort_unstable();
        wanted.dedup();
        let fit = |links: u32| {
            let (travel, wheels) = self.place(links, 0.0, mover)?;
            Some(Fit {
                links,
                offset_link: links % 2 == 1,
                body: mover.body.clone(),
                travel,
                centre: mover.stop.map(|stop| pair(wheels[stop].centre)),
                centre_distance: match wheels.as_slice() {
                    [first, second] => Some((second.centre - first.centre).norm()),
                    _ => None,
                },
            })
        };
        wanted.into_iter().filter_map(fit).collect()
    }

    fn wear(&self, links: u32, mover: &mut Mover<'_>) -> Vec<Worn> {
        let worn = ELONGATIONS.iter().map(|&elongation| Worn {
            elongation,
            travel: self
                .place(links, elongation, mover)
                .map(|(travel, _)| travel),
        });
        worn.collect()
    }

    /// Travel of a body at which a number of links with a strain closes.
    fn place(&self, links: u32, strain: f64, mover: &mut Mover<'_>) -> Option<(f64, Vec<Wheel>)> {
        let search = search(mover.travel, self.pitch, mover.reach);
        let found = close_nearest(self.pitch, strain, links, self.phase, mover.wheels, search);
        found.ok().map(|(travel, wheels, _)| (travel, wheels))
    }
}

fn pair(point: Point) -> [f64; 2] {
    [point.x, point.y]
}

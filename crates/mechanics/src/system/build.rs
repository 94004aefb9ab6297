//! From the laid drive to flat arrays.

use std::collections::HashSet;
use std::ops::Range;

use chaindrive_geometry::Point;

use super::offset_spans::OffsetSpans;
use super::{Group, Member, System};
use crate::accounts::AccountSizes;
use crate::bodies::{
    Anchor, Bodies, BodyContacts, GuideContacts, Inputs, Rail, RailContact, RailSupport, Shaft,
    Slide, Turn, TurnedBy, Wheel, WheelContacts, WheelSupport,
};
use crate::chains;
use crate::contact::{Arrivals, Impacts};
use crate::contact::{Contacts, PlateContact, Shape, Teeth};
use crate::drive::{Guide, GuideSupport, Parts, PlacedChain, Rotation, Sprocket, Support, Touches};
use crate::groups::groups;
use crate::profile::{GapFace, RailFace};
use crate::tensioner::Weight;
use crate::trains::{TrainMember, trains};
use crate::{AssemblyError, Chain, Motion, Push};

/// A drive with its chains laid: where everything is when it begins.
#[derive(Clone, Debug)]
pub(crate) struct LaidDrive {
    /// The parts, moved to where the chains close.
    pub(crate) parts: Parts,
    /// The chains, in the order of the parts.
    pub(crate) chains: Vec<LaidChain>,
    /// Angle of one gap axis of every sprocket.
    pub(crate) gap_angles: Vec<f64>,
    /// Time \[s\].
    pub(crate) begin: f64,
}

/// A chain as laid, with its place in the state.
#[derive(Clone, Debug, Default)]
pub(crate) struct LaidChain {
    /// Roller positions.
    pub(crate) positions: Vec<Point>,
    /// Sprockets in path order.
    pub(crate) route: Vec<usize>,
}

impl System {
    /// Compiles a laid drive; returns the system and its positions.
    pub(crate) fn build(laid: &LaidDrive) -> Result<(Self, Vec<f64>), AssemblyError> {
        let parts = &laid.parts;
        let mut q = Vec::new();
        let mut chains = Vec::new();
        let mut touched = TouchedBodies::default();
        for (placed, lies) in parts.chains.iter().zip(&laid.chains) {
            let (built, own) = chains::Chain::laid(&placed.chain, &lies.positions);
            let contacts = contacts(laid, placed, &mut touched)?;
            let mut member = Member::new(built, q.len(), contacts, lies.route.clone());
            member.name.clone_from(&placed.name);
            member.sideways = OffsetSpans::new(parts, placed, &lies.route);
            chains.push(member);
            q.extend(own);
        }
        let first = q.len();
        let trains = trains(parts);
        let places = Places::new(parts, &trains, first);
        let wheels = wheels(laid, &trains, &places);
        let shafts = shafts(laid, &trains, &places);
        let slides = slides(parts, &places);
        let dofs = places.groups.last().map_or(first, |range| range.end);
        q.resize(dofs, 0.0);
        for shaft in &shafts {
            if let Some(dof) = shaft.led() {
                // Where the shaft has not turned yet.
                q[dof] = 0.0 - shaft.turn.zero;
            }
        }
        for wheel in &wheels {
            if let WheelSupport::Springs { dof, .. } = wheel.support {
                q[dof] = wheel.centre.x;
                q[dof + 1] = wheel.centre.y;
            }
        }
        let mut bodies = Bodies {
            wheels,
            rails: parts
                .guides
                .iter()
                .map(|guide| rail(guide, &slides))
                .collect(),
            slides,
            shafts,
            couplings: parts.couplings.clone(),
            gravity: parts.gravity,
            first,
            states: 0,
            inertias: Vec::new(),
            rates: [0.0; 2],
            inputs: Inputs::default(),
            accounts: AccountSizes::default(),
        };
        bodies.number_states();
        bodies.weigh(dofs - first);
        let mut system = Self {
            chains,
            bodies,
            dofs,
            groups: places.solved(first),
            events: None,
            applied: crate::applied::AppliedForces::default(),
            time_scales: [f64::INFINITY; 4],
            onset_depth: None,
            begin: laid.begin,
            watch: None,
        };
        system.refer_to_groups();
        let mut v = vec![0.0; dofs];
        let z = system.settled_states(&q);
        system.start(laid.begin, &mut q, &mut v, &z);
        Ok((system, q))
    }
}

/// Length that turns the angle of a shaft into metres where there is no sprocket \[m\].
const NO_SPROCKET: f64 = 0.1;

/// Bodies that chains before this one touch.
#[derive(Default)]
struct TouchedBodies {
    sprockets: HashSet<usize>,
    guides: HashSet<usize>,
}

/// Contacts of a chain with everything that it can touch.
fn contacts(
    laid: &LaidDrive,
    placed: &PlacedChain,
    touched: &mut TouchedBodies,
) -> Result<BodyContacts, AssemblyError> {
    let parts = &laid.parts;
    let teeth = placed.sprockets.iter().map(|&wheel| WheelContacts {
        wheel,
        first: touched.sprockets.insert(wheel),
        contacts: teeth(&parts.sprockets[wheel], &placed.chain),
        anchor: Anchor::at(laid.gap_angles[wheel]),
        impacts: Impacts::default(),
        arrivals: Arrivals::default(),
    });
    let rails = placed.guides.iter().map(|&rail| {
        Ok(GuideContacts {
            rail,
            first: touched.guides.insert(rail),
            contact: face(&parts.guides[rail], &placed.chain, parts)?,
            impacts: Impacts::default(),
        })
    });
    Ok(BodyContacts {
        teeth: teeth.collect(),
        rails: rails.collect::<Result<_, AssemblyError>>()?,
    })
}

/// Positions of the coordinates of the bodies in the state, those of a group side by side.
struct Places {
    slides: Vec<Option<usize>>,
    /// What turns the shafts that lead a train.
    shafts: Vec<TurnedBy>,
    /// Centres on springs, x before y.
    centres: Vec<Option<usize>>,
    groups: Vec<Range<usize>>,
    chains: Vec<Vec<usize>>,
}

impl Places {
    fn new(parts: &Parts, trains: &[TrainMember], first: usize) -> Self {
        let mut places = Self {
            slides: vec![None; parts.tensioners.len()],
            shafts: parts.shafts.iter().map(given).collect(),
            centres: vec![None; parts.sprockets.len()],
            groups: Vec::new(),
            chains: Vec::new(),
        };
        let mut next = first;
        let mut take = |count: usize| {
            next += count;
            next - count
        };
        for group in groups(parts) {
            let start = take(0);
            for &index in &group.tensioners {
                let moves = parts.tensioners[index].push != Push::Locked;
                places.slides[index] = moves.then(|| take(1));
            }
            for &index in &group.sprockets {
                let sprocket = &parts.sprockets[index];
                places.turn(parts, trains[sprocket.shaft].leader, &mut take);
                if let Support::Springs { .. } = sprocket.support {
                    places.centres[index] = Some(take(2));
                }
            }
            for &index in &group.shafts {
                places.turn(parts, trains[index].leader, &mut take);
            }
            places.groups.push(start..take(0));
            places.chains.push(group.chains);
        }
        places
    }

    /// Gives a free shaft its coordinate, once.
    fn turn(&mut self, parts: &Parts, leader: usize, take: &mut impl FnMut(usize) -> usize) {
        let free = matches!(parts.shafts[leader].rotation, Rotation::Free { .. });
        let placed = matches!(self.shafts[leader], TurnedBy::Coordinate(_));
        if free && !placed {
            self.shafts[leader] = TurnedBy::Coordinate(take(1));
        }
    }

    /// The groups of the system.
    fn solved(self, first: usize) -> Vec<Group> {
        let groups = self.chains.into_iter().zip(self.groups);
        let relative = |range: Range<usize>| range.start - first..range.end - first;
        groups
            .map(|(chains, range)| Group {
                chains,
                bodies: relative(range),
            })
            .collect()
    }
}

/// How a shaft, or a sprocket on it, turns from an angle on.
fn turn(laid: &LaidDrive, train: TrainMember, angle: f64, places: &Places) -> Turn {
    let parts = &laid.parts;
    let TrainMember { leader, ratio } = train;
    // The coordinate begins at the gap angle of the first sprocket on the shaft that leads, so that the angle of a
    // sprocket alone on its shaft is the coordinate itself.
    let first = parts.sprockets.iter().position(|s| s.shaft == leader);
    let start = first.map_or(0.0, |sprocket| laid.gap_angles[sprocket]);
    let by = places.shafts[leader].clone();
    let zero = match by {
        TurnedBy::Coordinate(_) => angle - ratio * start,
        TurnedBy::Motion(_) | TurnedBy::Driven { .. } => angle,
    };
    Turn {
        by,
        ratio,
        zero,
        train: leader,
    }
}

/// The motion of a shaft whose angle is given in time; others get a coordinate.
fn given(shaft: &crate::Shaft) -> TurnedBy {
    TurnedBy::Motion(match &shaft.rotation {
        Rotation::Prescribed(motion) => motion.clone(),
        Rotation::Free { .. } => Motion::Held,
    })
}

fn wheels(laid: &LaidDrive, trains: &[TrainMember], places: &Places) -> Vec<Wheel> {
    let sprockets = laid.parts.sprockets.iter().zip(&laid.gap_angles);
    sprockets
        .zip(&places.centres)
        .map(|((sprocket, &angle), &centre)| {
            let turn = turn(laid, trains[sprocket.shaft], angle, places);
            wheel(sprocket, angle, turn, centre)
        })
        .collect()
}

fn shafts(laid: &LaidDrive, trains: &[TrainMember], places: &Places) -> Vec<Shaft> {
    let parts = &laid.parts;
    let lever = |leader: usize| {
        let in_train = |sprocket: &&Sprocket| trains[sprocket.shaft].leader == leader;
        let own = parts.sprockets.iter().filter(in_train);
        let rims = own.map(|s| s.gap.pitch_radius * trains[s.shaft].ratio.abs());
        let all = || parts.sprockets.iter().map(|s| s.gap.pitch_radius);
        // A shaft without sprockets is as large as those around it.
        rims.reduce(f64::max)
            .or_else(|| all().reduce(f64::max))
            .unwrap_or(NO_SPROCKET)
    };
    let shafts = parts.shafts.iter().zip(trains).enumerate();
    let shafts = shafts.map(|(index, (shaft, &train))| {
        let (drive, load) = match &shaft.rotation {
            Rotation::Prescribed(_) => (Vec::new(), Vec::new()),
            Rotation::Free { drive, load, .. } => (drive.clone(), load.clone()),
        };
        Shaft {
            name: shaft.name.clone(),
            turn: turn(laid, train, 0.0, places),
            lever: lever(train.leader),
            leads: train.leader == index,
            inertia: shaft.inertia,
            drive,
            load,
            load_factor: 1.0,
            loss: shaft.loss,
        }
    });
    shafts.collect()
}

fn slides(parts: &Parts, places: &Places) -> Vec<Slide> {
    parts
        .tensioners
        .iter()
        .enumerate()
        .map(|(index, tensioner)| {
            let carried = parts
                .sprockets
                .iter()
                .filter(|s| s.support == Support::Tensioner(index));
            let carried: Vec<Weight> = carried.map(|s| (s.mass, s.centre)).collect();
            let carrier = tensioner.carrier;
            Slide {
                name: tensioner.name.clone(),
                carrier,
                push: tensioner.push,
                inertia: carrier.reduced(0.0, &carried).inertia,
                dof: places.slides[index],
                // Until all are there: see `number_states`.
                state: None,
                carried,
                forces: tensioner.forces.clone(),
                forced_at: tensioner.forced_at,
            }
        })
        .collect()
}

fn wheel(sprocket: &Sprocket, angle: f64, turn: Turn, centre: Option<usize>) -> Wheel {
    let gap = &sprocket.gap;
    let support = match (&sprocket.support, centre) {
        (Support::Prescribed { x, y }, _) => WheelSupport::Prescribed {
            x: x.clone(),
            y: y.clone(),
        },
        (Support::Springs { stiffness, damping }, Some(dof)) => WheelSupport::Springs {
            dof,
            stiffness: *stiffness,
            damping: *damping,
        },
        (Support::Tensioner(index), _) => WheelSupport::Carried(*index),
        // Springs have a place.
        (Support::Fixed | Support::Springs { .. }, _) => WheelSupport::Fixed,
    };
    Wheel {
        name: sprocket.name.clone(),
        centre: sprocket.centre,
        angle,
        turn,
        shaft: sprocket.shaft,
        support,
        forces: sprocket.forces.clone(),
        inertia: sprocket.inertia,
        mass: sprocket.mass,
        mobility: 0.0,
        teeth: gap.teeth,
        pitch_radius: gap.pitch_radius,
        pitch: gap.pitch,
        eccentricity: sprocket.tolerance.eccentricity(),
        sense: sprocket.side.sense(),
        loss: sprocket.loss,
    }
}

fn rail(guide: &Guide, slides: &[Slide]) -> Rail {
    let mobility = match &guide.support {
        GuideSupport::Fixed | GuideSupport::Prescribed { .. } => 0.0,
        GuideSupport::Tensioner(index) => {
            // Nothing on the face has a longer lever than some corner of its box.
            let [low, high] = bounds(guide);
            let across = [Point::new(low.x, high.y), Point::new(high.x, low.y)];
            let corners = [low, high].into_iter().chain(across);
            let mobilities = corners.map(|corner| slides[*index].mobility(corner));
            mobilities.fold(0.0, f64::max)
        }
    };
    Rail {
        mobility,
        name: guide.name.clone(),
        support: match &guide.support {
            GuideSupport::Fixed => RailSupport::Fixed,
            GuideSupport::Prescribed { x, y } => RailSupport::Prescribed {
                x: x.clone(),
                y: y.clone(),
            },
            GuideSupport::Tensioner(index) => RailSupport::Carried(*index),
        },
    }
}

/// Contacts of a chain with the teeth of a sprocket.
fn teeth(sprocket: &Sprocket, chain: &Chain) -> Contacts {
    let gap = &sprocket.gap;
    let radius = 0.5 * chain.roller_diameter;
    let pitch_angle = std::f64::consts::TAU / f64::from(gap.teeth);
    let teeth = Teeth {
        face: GapFace::new(gap.pieces(), radius),
        count: gap.teeth,
        tan_half: (0.5 * pitch_angle).tan(),
        pitch_turn: [pitch_angle.cos(), pitch_angle.sin()],
        tip_radius: gap.tip_radius,
        errors: sprocket.tolerance.gap_angles(gap.pitch_radius),
    };
    let shape = Shape::Teeth(teeth);
    Contacts::new(shape, sprocket.surface, sprocket.flank, radius)
        .with_errors(&chain.roller_deviations)
}

/// Contacts of a chain with a guide.
fn face(guide: &Guide, chain: &Chain, parts: &Parts) -> Result<RailContact, AssemblyError> {
    let face = RailFace::new(guide.face.pieces());
    let reference = parts.reference(&guide.support);
    let bounds = bounds(guide);
    let radius = match guide.touches {
        Touches::Rollers => 0.5 * chain.roller_diameter,
        Touches::Eyes | Touches::Plates => 0.5 * chain.plate_height,
    };
    confirm(guide, &face, radius)?;
    if guide.touches == Touches::Plates {
        let (surface, links) = (guide.surface, chain.links());
        return Ok(RailContact::Plates(PlateContact::new(
            face, reference, bounds, surface, radius, links,
        )));
    }
    let shape = Shape::Rail {
        face,
        reference,
        bounds,
    };
    let contacts = Contacts::new(shape, guide.surface, None, radius);
    Ok(RailContact::Circles(match guide.touches {
        Touches::Rollers => contacts.with_errors(&chain.roller_deviations),
        Touches::Eyes | Touches::Plates => contacts,
    }))
}

fn bounds(guide: &Guide) -> [Point; 2] {
    let mut low = Point::new(f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for piece in guide.face.pieces() {
        let bounding = piece.aabb();
        low = low.inf(&bounding.min);
        high = high.sup(&bounding.max);
    }
    [low, high]
}

/// Checks that passing from feature to feature finds the nearest one all along the face.
fn confirm(guide: &Guide, face: &RailFace, radius: f64) -> Result<(), AssemblyError> {
    let reach = 4.0 * radius;
    for (i, piece) in guide.face.pieces().iter().enumerate() {
        for k in 0..=8 {
            let parameter = f64::from(k) / 8.0;
            let at = piece.point(parameter) + piece.normal(parameter) * radius;
            let exact = guide
                .face
                .nearest(at, reach)
                .map_or(f64::INFINITY, |foot| foot.distance);
            let found = face.probe(at, 0.0).gap;
            if (exact - found).abs() > 1e-6 * radius {
                return Err(AssemblyError::Guide {
                    guide: guide.name.clone(),
                    problem: format!(
                        "a roller on piece {i} of the face also reaches another part of it; split the guide there, or give hollow corners a radius larger than the roller's"
                    ),
                });
            }
        }
    }
    Ok(())
}

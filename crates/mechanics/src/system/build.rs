//! From the laid drive to flat arrays.

use std::collections::HashSet;

use chaindrive_geometry::Point;

use super::bodies::{
    Anchor, Bodies, Leader, Rail, RailSupport, Wheel, WheelRotation, WheelSupport,
};
use super::{BodyContacts, Member, OnRail, OnWheel, RailContact, Slide, System};
use crate::chains;
use crate::contact::{Contacts, PlateContact, Shape, Teeth};
use crate::drive::{Guide, GuideSupport, Parts, PlacedChain, Rotation, Sprocket, Support, Touches};
use crate::profile::{GapFace, Profile};
use crate::tensioner::Weight;
use crate::{AssemblyError, Chain, Motion, Push};

/// A drive with its chains laid: where everything is at t = 0.
#[derive(Clone, Debug)]
pub(crate) struct Laid {
    /// The parts, moved to where the chains close.
    pub(crate) parts: Parts,
    /// The chains, in the order of the parts.
    pub(crate) chains: Vec<LaidChain>,
    /// Angle of one gap axis of every sprocket.
    pub(crate) gap_angles: Vec<f64>,
}

/// Where a chain lies.
#[derive(Clone, Debug)]
pub(crate) struct LaidChain {
    /// Roller positions.
    pub(crate) positions: Vec<Point>,
    /// Sprockets in path order.
    pub(crate) route: Vec<usize>,
}

impl System {
    /// Compiles a laid drive; returns the system and its positions.
    pub(crate) fn build(laid: &Laid) -> Result<(Self, Vec<f64>), AssemblyError> {
        let parts = &laid.parts;
        let mut q = Vec::new();
        let mut chains = Vec::new();
        let mut touched = Touched::default();
        for (placed, lies) in parts.chains.iter().zip(&laid.chains) {
            let (built, own) = chains::Chain::laid(&placed.chain, &lies.positions);
            let contacts = contacts(laid, placed, &mut touched)?;
            chains.push(Member::new(built, q.len(), contacts, lies.route.clone()));
            q.extend(own);
        }
        let first = q.len();
        let mut next = first;
        let mut take = |count: usize| {
            next += count;
            next - count
        };
        let slides = slides(parts, &mut take);
        let mut wheels: Vec<Wheel> = parts
            .sprockets
            .iter()
            .zip(&laid.gap_angles)
            .map(|(sprocket, &angle)| wheel(sprocket, angle, &mut take))
            .collect();
        gear(parts, &mut wheels);
        let dofs = next;
        q.resize(dofs, 0.0);
        for wheel in &wheels {
            if let WheelRotation::Free { dof, .. } = wheel.rotation {
                q[dof] = wheel.angle;
            }
            if let WheelSupport::Springs { dof, .. } = wheel.support {
                q[dof] = wheel.centre.x;
                q[dof + 1] = wheel.centre.y;
            }
        }
        let mut bodies = Bodies {
            wheels,
            rails: parts.guides.iter().map(rail).collect(),
            slides,
            torsions: parts.torsions.clone(),
            gravity: parts.gravity,
            first,
            inertias: Vec::new(),
            inputs: super::inputs::Inputs::default(),
        };
        bodies.weigh(dofs - first);
        let mut system = Self {
            chains,
            bodies,
            dofs,
            events: None,
            time_scales: [f64::INFINITY; 2],
            onset_depth: None,
        };
        let mut v = vec![0.0; dofs];
        system.start(0.0, &mut q, &mut v);
        Ok((system, q))
    }
}

/// Bodies that chains before this one touch.
#[derive(Default)]
struct Touched {
    sprockets: HashSet<usize>,
    guides: HashSet<usize>,
}

/// Contacts of a chain with everything that it can touch.
fn contacts(
    laid: &Laid,
    placed: &PlacedChain,
    touched: &mut Touched,
) -> Result<BodyContacts, AssemblyError> {
    let parts = &laid.parts;
    let teeth = placed.sprockets.iter().map(|&wheel| OnWheel {
        wheel,
        first: touched.sprockets.insert(wheel),
        contacts: teeth(&parts.sprockets[wheel], &placed.chain),
        anchor: Anchor::at(laid.gap_angles[wheel]),
    });
    let rails = placed.guides.iter().map(|&rail| {
        Ok(OnRail {
            rail,
            first: touched.guides.insert(rail),
            contact: face(&parts.guides[rail], &placed.chain, parts)?,
        })
    });
    Ok(BodyContacts {
        teeth: teeth.collect(),
        rails: rails.collect::<Result<_, AssemblyError>>()?,
    })
}

/// Lets geared wheels follow their leaders, and gives every shaft the inertia of all that turns with it.
fn gear(parts: &Parts, wheels: &mut [Wheel]) {
    for (index, sprocket) in parts.sprockets.iter().enumerate() {
        let Rotation::Geared { leader, ratio } = sprocket.rotation else {
            continue;
        };
        let angle = wheels[leader].angle;
        let followed = match &wheels[leader].rotation {
            WheelRotation::Free { dof, .. } => Leader::Free { dof: *dof, angle },
            WheelRotation::Prescribed(motion) => Leader::Prescribed(motion.clone()),
            WheelRotation::Geared { leader, .. } => leader.clone(),
        };
        wheels[leader].shaft_inertia += ratio * ratio * sprocket.inertia;
        wheels[index].rotation = WheelRotation::Geared {
            leader: followed,
            ratio,
        };
    }
    for (index, sprocket) in parts.sprockets.iter().enumerate() {
        if let Rotation::Geared { leader, .. } = sprocket.rotation {
            wheels[index].shaft_inertia = wheels[leader].shaft_inertia;
        }
    }
}

fn slides(parts: &Parts, take: &mut impl FnMut(usize) -> usize) -> Vec<Slide> {
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
                own: tensioner.inertia,
                inertia: carrier.reduced(0.0, tensioner.inertia, &carried).inertia,
                dof: (tensioner.push != Push::Locked).then(|| take(1)),
                carried,
            }
        })
        .collect()
}

fn wheel(sprocket: &Sprocket, angle: f64, take: &mut impl FnMut(usize) -> usize) -> Wheel {
    let gap = &sprocket.gap;
    let rotation = match &sprocket.rotation {
        Rotation::Prescribed(motion) => WheelRotation::Prescribed(motion.clone()),
        Rotation::Free { drive, load } => WheelRotation::Free {
            dof: take(1),
            drive: drive.clone(),
            load: load.clone(),
        },
        // Until all wheels are there: see `gear`.
        Rotation::Geared { ratio, .. } => WheelRotation::Geared {
            leader: Leader::Prescribed(Motion::Held),
            ratio: *ratio,
        },
    };
    let support = match &sprocket.support {
        Support::Fixed => WheelSupport::Fixed,
        Support::Prescribed { x, y } => WheelSupport::Prescribed {
            x: x.clone(),
            y: y.clone(),
        },
        Support::Springs { stiffness, damping } => WheelSupport::Springs {
            dof: take(2),
            stiffness: *stiffness,
            damping: *damping,
        },
        Support::Tensioner(index) => WheelSupport::Carried(*index),
    };
    Wheel {
        name: sprocket.name.clone(),
        centre: sprocket.centre,
        angle,
        rotation,
        support,
        inertia: sprocket.inertia,
        shaft_inertia: sprocket.inertia,
        mass: sprocket.mass,
        teeth: gap.teeth,
        pitch_radius: gap.pitch_radius,
        pitch: gap.pitch,
        sense: sprocket.side.sense(),
    }
}

fn rail(guide: &Guide) -> Rail {
    Rail {
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
    };
    Contacts::new(
        Shape::Teeth(teeth),
        sprocket.surface,
        sprocket.flank,
        radius,
    )
}

/// Contacts of a chain with a guide.
fn face(guide: &Guide, chain: &Chain, parts: &Parts) -> Result<RailContact, AssemblyError> {
    let profile = Profile::new(guide.face.pieces(), true, true);
    let reference = parts.reference(&guide.support);
    let bounds = bounds(guide);
    let radius = match guide.touches {
        Touches::Rollers => 0.5 * chain.roller_diameter,
        Touches::Eyes | Touches::Plates => 0.5 * chain.plate_height,
    };
    confirm(guide, &profile, radius)?;
    if guide.touches == Touches::Plates {
        let (surface, links) = (guide.surface, chain.links());
        return Ok(RailContact::Plates(PlateContact::new(
            profile, reference, bounds, surface, radius, links,
        )));
    }
    let shape = Shape::Rail {
        profile,
        reference,
        bounds,
    };
    let contacts = Contacts::new(shape, guide.surface, None, radius);
    Ok(RailContact::Circles(contacts))
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
fn confirm(guide: &Guide, profile: &Profile, radius: f64) -> Result<(), AssemblyError> {
    let reach = 4.0 * radius;
    for (i, piece) in guide.face.pieces().iter().enumerate() {
        for k in 0..=8 {
            let parameter = f64::from(k) / 8.0;
            let at = piece.point(parameter) + piece.normal(parameter) * radius;
            let exact = guide
                .face
                .nearest(at, reach)
                .map_or(f64::INFINITY, |foot| foot.distance);
            let found = profile.probe(at, 0.0).gap;
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

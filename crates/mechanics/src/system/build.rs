//! From the laid drive to flat arrays.

use chaindrive_geometry::Point;

use super::bodies::{Anchor, Bodies, Rail, RailSupport, Slide, Wheel, WheelRotation, WheelSupport};
use super::{BodyContacts, Member, OnRail, OnWheel, RailContact, System};
use crate::chains;
use crate::contact::{Contacts, PlateContact, Shape, Teeth};
use crate::drive::{Guide, GuideSupport, Parts, Rotation, Sprocket, Support, Touches};
use crate::profile::{GapFace, Profile};
use crate::{AssemblyError, Carrier, Chain, Push};

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
        for (chain, lies) in [&parts.chain].into_iter().zip(&laid.chains) {
            let (built, own) = chains::Chain::laid(chain, &lies.positions);
            let contacts = contacts(laid, chain)?;
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
        let wheels: Vec<Wheel> = parts
            .sprockets
            .iter()
            .zip(&laid.gap_angles)
            .map(|(sprocket, &angle)| wheel(sprocket, angle, &mut take))
            .collect();
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

/// Contacts of a chain with everything that it can touch.
fn contacts(laid: &Laid, chain: &Chain) -> Result<BodyContacts, AssemblyError> {
    let parts = &laid.parts;
    let sprockets = parts.sprockets.iter().zip(&laid.gap_angles).enumerate();
    let teeth = sprockets.map(|(wheel, (sprocket, &angle))| OnWheel {
        wheel,
        first: true,
        contacts: teeth(sprocket, chain),
        anchor: Anchor::at(angle),
    });
    let rails = parts.guides.iter().enumerate().map(|(rail, guide)| {
        Ok(OnRail {
            rail,
            first: true,
            contact: face(guide, chain, parts)?,
        })
    });
    Ok(BodyContacts {
        teeth: teeth.collect(),
        rails: rails.collect::<Result<_, AssemblyError>>()?,
    })
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
            let mut weights: Vec<(f64, Point)> = carried.map(|s| (s.mass, s.centre)).collect();
            let mut inertia = tensioner.inertia;
            for (mass, place) in &weights {
                inertia += match &tensioner.carrier {
                    Carrier::Slider { .. } => *mass,
                    Carrier::Arm { pivot, .. } => mass * (place - pivot).norm_squared(),
                };
            }
            if matches!(tensioner.carrier, Carrier::Slider { .. }) {
                weights.push((tensioner.inertia, Point::origin()));
            }
            Slide {
                name: tensioner.name.clone(),
                carrier: tensioner.carrier,
                push: tensioner.push,
                inertia,
                dof: (tensioner.push != Push::Locked).then(|| take(1)),
                weights,
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
    let reference = match &guide.support {
        GuideSupport::Tensioner(index) => match &parts.tensioners[*index].carrier {
            Carrier::Slider { .. } => Point::origin(),
            Carrier::Arm { pivot, .. } => *pivot,
        },
        GuideSupport::Fixed | GuideSupport::Prescribed { .. } => Point::origin(),
    };
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

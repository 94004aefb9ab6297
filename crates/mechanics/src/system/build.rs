//! From the laid drive to flat arrays.

use chaindrive_geometry::{Point, Vector};
use pulp::Arch;

use super::bodies::{
    Anchor, Rail, RailContact, RailSupport, Slide, Wheel, WheelRotation, WheelSupport,
};
use super::{HeldEnd, System};
use crate::contact::{Contacts, PlateContact, Shape, Teeth};
use crate::drive::{Guide, GuideSupport, Parts, Rotation, Sprocket, Support, Touches};
use crate::links::Links;
use crate::profile::{GapFace, Profile};
use crate::{AssemblyError, Carrier, Chain, End, Ends, Push};

/// A drive with its chain laid: where everything is at t = 0.
#[derive(Clone, Debug)]
pub(crate) struct Laid {
    /// The parts, moved to where the chain closes.
    pub(crate) parts: Parts,
    /// Roller positions.
    pub(crate) positions: Vec<Point>,
    /// Angle of one gap axis of every sprocket.
    pub(crate) gap_angles: Vec<f64>,
    /// Sprockets in path order.
    pub(crate) route: Vec<usize>,
}

impl System {
    /// Compiles a laid drive; returns the system and its positions.
    pub(crate) fn build(laid: &Laid) -> Result<(Self, Vec<f64>), AssemblyError> {
        let parts = &laid.parts;
        let chain = &parts.chain;
        let links = Links::new(chain);
        let stride = links.stride();
        let mut next = 2 * stride;
        let mut take = |count: usize| {
            next += count;
            next - count
        };
        let slides = slides(parts, &mut take);
        let wheels: Vec<Wheel> = parts
            .sprockets
            .iter()
            .zip(&laid.gap_angles)
            .map(|(sprocket, &angle)| wheel(sprocket, angle, chain, &mut take))
            .collect();
        let rails = parts
            .guides
            .iter()
            .map(|guide| rail(guide, parts))
            .collect::<Result<Vec<_>, _>>()?;
        let dofs = next;

        let rollers = chain.rollers();
        let ends = held_ends(chain, &laid.positions);
        let mut masses = chain.masses.clone();
        let mut inverse_masses: Vec<f64> = masses.iter().map(|m| 1.0 / m).collect();
        for held in &ends {
            if matches!(held.end, End::Fixed | End::Driven { .. }) {
                inverse_masses[held.roller] = 0.0;
            }
        }
        let q = positions(laid, stride, dofs, &wheels);
        pad(&mut masses, stride, chain.is_closed());
        pad(&mut inverse_masses, stride, chain.is_closed());

        let mut system = Self {
            lightest: inverse_masses.iter().copied().fold(0.0, f64::max),
            link_rates: link_rates(&links, &inverse_masses, rollers),
            links,
            rollers,
            stride,
            dofs,
            masses,
            inverse_masses,
            gravity: parts.gravity,
            wheels,
            rails,
            slides,
            ends,
            pitch: chain.pitch,
            route: laid.route.clone(),
            linkage: None,
            events: None,
            border_inertias: Vec::new(),
            time_scale: f64::INFINITY,
            onset_depth: None,
            renew: (0.0, 0),
            arch: Arch::new(),
            oldest: matches!(Arch::new(), Arch::Scalar),
        };
        let mut q = q;
        let mut v = vec![0.0; dofs];
        system.start(0.0, &mut q, &mut v);
        Ok((system, q))
    }
}

/// Masses behind the last roller: those of the originals, or none.
fn pad(values: &mut Vec<f64>, stride: usize, closed: bool) {
    let count = values.len();
    for i in count..stride {
        values.push(if closed { values[i % count] } else { 0.0 });
    }
}

fn positions(laid: &Laid, stride: usize, dofs: usize, wheels: &[Wheel]) -> Vec<f64> {
    let chain = &laid.parts.chain;
    let count = chain.rollers();
    let mut q = vec![0.0; dofs];
    for i in 0..stride {
        let place = if i < count {
            laid.positions[i]
        } else if chain.is_closed() {
            laid.positions[i % count]
        } else {
            // Behind a strand stand still points one pitch apart, so that no length is zero.
            laid.positions[count - 1] + Vector::x() * chain.pitch * (i + 1 - count) as f64
        };
        q[i] = place.x;
        q[stride + i] = place.y;
    }
    for wheel in wheels {
        if let WheelRotation::Free { dof, .. } = wheel.rotation {
            q[dof] = wheel.angle;
        }
        if let WheelSupport::Springs { dof, .. } = wheel.support {
            q[dof] = wheel.centre.x;
            q[dof + 1] = wheel.centre.y;
        }
    }
    q
}

fn held_ends(chain: &Chain, places: &[Point]) -> Vec<HeldEnd> {
    match &chain.ends {
        Ends::Closed => Vec::new(),
        Ends::Open(ends) => [0, chain.rollers() - 1]
            .into_iter()
            .zip(ends)
            .map(|(roller, end)| HeldEnd {
                roller,
                end: end.clone(),
                place: places[roller],
            })
            .collect(),
    }
}

/// Largest Gershgorin row of M⁻¹K and of M⁻¹D over the rollers.
fn link_rates(links: &Links, inverse_masses: &[f64], rollers: usize) -> [f64; 2] {
    let row = |values: &[f64], roller: usize| {
        let before = match (roller, links.closed) {
            (0, true) => values[links.count - 1],
            (0, false) => 0.0,
            (i, _) => values[i - 1],
        };
        // (k₋ + k₊) on the diagonal and as much again beside it
        2.0 * (before + values[roller]) * inverse_masses[roller]
    };
    let largest = |values: &[f64]| (0..rollers).map(|i| row(values, i)).fold(0.0, f64::max);
    [largest(&links.stiffness), largest(&links.damping)]
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

fn wheel(
    sprocket: &Sprocket,
    angle: f64,
    chain: &Chain,
    take: &mut impl FnMut(usize) -> usize,
) -> Wheel {
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
        contacts: Contacts::new(
            Shape::Teeth(teeth),
            sprocket.surface,
            sprocket.flank,
            radius,
        ),
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
        anchor: Anchor::at(angle),
    }
}

fn rail(guide: &Guide, parts: &Parts) -> Result<Rail, AssemblyError> {
    let chain = &parts.chain;
    let profile = Profile::new(guide.face.pieces(), true, true);
    let support = match &guide.support {
        GuideSupport::Fixed => RailSupport::Fixed,
        GuideSupport::Prescribed { x, y } => RailSupport::Prescribed {
            x: x.clone(),
            y: y.clone(),
        },
        GuideSupport::Tensioner(index) => RailSupport::Carried(*index),
    };
    let reference = match &support {
        RailSupport::Carried(index) => match &parts.tensioners[*index].carrier {
            Carrier::Slider { .. } => Point::origin(),
            Carrier::Arm { pivot, .. } => *pivot,
        },
        RailSupport::Fixed | RailSupport::Prescribed { .. } => Point::origin(),
    };
    let bounds = bounds(guide);
    let radius = match guide.touches {
        Touches::Rollers => 0.5 * chain.roller_diameter,
        Touches::Eyes | Touches::Plates => 0.5 * chain.plate_height,
    };
    confirm(guide, &profile, radius)?;
    let contact = if guide.touches == Touches::Plates {
        let (surface, links) = (guide.surface, chain.links());
        RailContact::Plates(PlateContact::new(
            profile, reference, bounds, surface, radius, links,
        ))
    } else {
        let shape = Shape::Rail {
            profile,
            reference,
            bounds,
        };
        RailContact::Circles(Contacts::new(shape, guide.surface, None, radius))
    };
    Ok(Rail {
        name: guide.name.clone(),
        contact,
        support,
    })
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

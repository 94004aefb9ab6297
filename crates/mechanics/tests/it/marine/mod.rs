//! The marine camshaft drive of the tests: four sprockets, 122 links.

use chaindrive_contact::{Friction, Law};
use chaindrive_geometry::{Point, Seat, Side, Tip, ToothForm, ToothGap, Vector};
use chaindrive_mechanics::{
    Adjust, Chain, Ends, Fit, Layout, Motion, Parts, PlacedChain, PretensionAt, Rotation, Shaft,
    SpanStart, Sprocket, StartSpeed, Stop, Strength, Support, Surface, Tighten, Tolerance, Torque,
};

/// Pitch, link mass and stiffness as published; the rest is a reconstruction that closes exactly.
pub(crate) fn parts(law: Law) -> Parts {
    let (pitch, links, stiffness, mass) = (0.0889, 122, 815e6, 3.01);
    let roller_diameter = 0.05398;
    let wheels = [
        ("crank", 0.0, 0.0, 48, 0.0),
        ("camshaft", 1.220_977_776_126_472, 2.15, 48, 251.0),
        ("tensioner", 0.372, 3.127, 30, 20.8),
        ("idler", -0.6, 1.75, 24, 8.55),
    ];
    let form = ToothForm::Iso606 {
        gap: 0.5,
        tip: Tip::Mid,
        seat: Seat::Bottom,
    };
    let shafts = wheels.map(|(name, ..)| {
        Shaft::of_one(if name == "crank" {
            Rotation::Prescribed(Motion::Constant {
                rate: -13.299_408_9,
            })
        } else {
            let load = if name == "camshaft" {
                vec![Torque::Constant { torque: 5e3 }]
            } else {
                Vec::new()
            };
            Rotation::Free {
                drive: Vec::new(),
                load,
                start: StartSpeed::Joined,
            }
        })
    });
    let mut numbers = 0..;
    let sprockets = wheels.map(|(name, x, y, teeth, inertia)| Sprocket {
        name: name.into(),
        gap: ToothGap::new(teeth, pitch, roller_diameter, &form)
            .expect("the tooth form fits the chain"),
        side: Side::Left,
        centre: Point::new(x, y),
        shaft: numbers.next().expect("without end"),
        support: Support::Fixed,
        inertia,
        mass: 100.0,
        surface: Surface {
            law,
            friction: Friction::None,
            film: None,
        },
        stack: None,
        flank: None,
        gap_angle: 0.0,
        tolerance: Tolerance::default(),
        lateral: 0.0,
        loss: chaindrive_mechanics::ShaftLoss::default(),
    });
    Parts {
        chains: vec![PlacedChain {
            name: None,
            chain: Chain {
                pitch,
                lengths: vec![pitch; links],
                stiffness: vec![stiffness; links],
                damping: vec![2.97e3; links],
                masses: vec![mass; links],
                roller_diameter,
                roller_deviations: Vec::new(),
                plate_height: 0.0778,
                strength: Strength::default(),
                articulation: None,
                drag: 0.0,
                ends: Ends::Closed,
                model: chaindrive_mechanics::ChainModel::Particles,
            },
            layout: Layout::Route {
                stops: (0..4).map(Stop::Sprocket).collect(),
                phase: 0.5,
                start: SpanStart::Polygon,
                fit: Fit {
                    growth: 0.0,
                    sag: None,
                    slack: None,
                    adjust: Adjust::Nothing,
                    pretension: 15e3,
                    tighten: Tighten::RestLength,
                    at: PretensionAt::Phase,
                },
            },
            sprockets: (0..4).collect(),
            guides: Vec::new(),
        }],
        sprockets: sprockets.into(),
        guides: Vec::new(),
        tensioners: Vec::new(),
        shafts: shafts.into(),
        couplings: Vec::new(),
        gears: Vec::new(),
        settle: true,
        gravity: Vector::new(0.0, -9.81),
        oil: None,
        tunable: Vec::new(),
    }
}

//! The marine camshaft drive of the tests: four sprockets, 122 links.

use chaindrive_contact::Law;
use chaindrive_geometry::Vector;
use chaindrive_mechanics::{
    Action, ChainModel, Ends, Motion, Parts, Rotation, Shaft, Sprocket, StartSpeed,
};

use crate::pieces;
use crate::pieces::{around, smooth};

/// Pitch, link mass and stiffness as published; the rest is a reconstruction that closes exactly.
pub(crate) fn parts(law: Law) -> Parts {
    let (pitch, roller) = (0.0889, 0.05398);
    let wheels = [
        ("crank", 0.0, 0.0, 48, 0.0),
        ("camshaft", 1.220_977_776_126_472, 2.15, 48, 251.0),
        ("tensioner", 0.372, 3.127, 30, 20.8),
        ("idler", -0.6, 1.75, 24, 8.55),
    ];
    let shafts = wheels.map(|(name, ..)| {
        Shaft::of_one(if name == "crank" {
            Rotation::Prescribed(Motion::Constant {
                rate: -13.299_408_9,
            })
        } else {
            let load = if name == "camshaft" {
                vec![Action::Constant { value: 5e3 }.into()]
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
        shaft: numbers.next().expect("without end"),
        inertia,
        mass: 100.0,
        ..pieces::sprocket(name, teeth, [pitch, roller], [x, y], smooth(law))
    });
    let of = [pitch, 3.01, 815e6];
    let mut chain = pieces::links(
        122,
        of,
        [roller, 0.0778],
        Ends::Closed,
        ChainModel::Particles,
    );
    chain.damping.fill(2.97e3);
    Parts {
        sprockets: sprockets.into(),
        shafts: shafts.into(),
        settle: true,
        gravity: Vector::new(0.0, -9.81),
        ..pieces::alone(vec![around(chain, &[0, 1, 2, 3], 15e3)])
    }
}

//! A step allocates nothing, whatever the chain is made of and however it is stepped.

use std::hint::black_box;

use allocation_counter::measure;
use chaindrive_contact::Friction;
use chaindrive_contact::friction::{Coulomb, Lugre, SpringSlider};
use chaindrive_integrate::Method;
use chaindrive_mechanics::{
    Articulation, BushStrands, ChainModel, FreeRoller, Joint, Parts, PointJoints, Support,
};

use crate::pieces::assembled;
use crate::several_chains::{EVEN, chain, driven, pair, parts, with_play};

/// Explicit and implicit methods that take steps of this length \[s\].
fn methods(step: f64) -> Vec<Method> {
    let implicit = Method::implicit_specimens(step);
    Method::specimens(step)
        .into_iter()
        .chain(implicit)
        .collect()
}

/// A chain around two sprockets.
fn drive(make: impl Fn(&mut Parts)) -> Parts {
    let mut parts = parts(
        vec![chain(40, [0, 1])],
        pair("", [20, 20], 0.0, EVEN, driven()).into(),
    );
    make(&mut parts);
    parts
}

fn ideal(parts: &mut Parts) {
    with_play(&mut parts.chains[0]);
    if let ChainModel::Rigid(links) = &mut parts.chains[0].chain.model {
        links.joint = Joint::Ideal;
    }
}

fn rubbing_by(parts: &mut Parts, friction: Friction) {
    parts.chains[0].chain.articulation = Some(Articulation {
        friction,
        radius: 2e-3,
        damping: 1e-5,
        seal: 0.0,
        lateral: None,
    });
}

fn rubbing(parts: &mut Parts) {
    let spring = SpringSlider {
        coefficient: 0.1,
        stiffness: 1e6,
    };
    rubbing_by(parts, Friction::SpringSlider(spring));
}

fn bristles(parts: &mut Parts) {
    let lugre = Lugre {
        static_coefficient: 0.12,
        coefficient: 0.1,
        slip_speed: 0.01,
        stiffness: 1e4,
        damping: 1.0,
        viscosity: 0.0,
    };
    rubbing_by(parts, Friction::Lugre(lugre));
}

/// Two strands whose bushes and joints rub.
fn stranded(parts: &mut Parts) {
    rubbing(parts);
    for sprocket in &mut parts.sprockets {
        sprocket.surface.friction = Friction::Coulomb(Coulomb {
            coefficient: 0.1,
            slip_speed: 0.01,
        });
    }
    let (strands, _) = BushStrands::together(&[1.0, 1.001], &[1.0, 0.9]);
    parts.chains[0].chain.model = ChainModel::Strands(BushStrands {
        strands,
        clearance: 20e-6,
        outer_first: false,
    });
}

/// Rollers, bushes and pins as points, around a wheel on springs: bodies have equations of their own then.
fn pointed(parts: &mut Parts) {
    with_play(&mut parts.chains[0]);
    let model = &mut parts.chains[0].chain.model;
    let ChainModel::Rigid(links) = &*model else {
        return;
    };
    let Joint::Clearance(joint) = links.joint else {
        return;
    };
    let roller = FreeRoller {
        mass: 0.453e-3,
        inertia: 1e-8,
        bush_radius: 2.5e-3,
        bore_radius: 2.53e-3,
        surface: joint.surface,
    };
    *model = ChainModel::Points(PointJoints {
        inner: 3.01e-3,
        outer: 3.71e-3,
        outer_first: false,
        joint,
        roller,
    });
    parts.sprockets[1].support = Support::Springs {
        stiffness: [1e7; 2],
        damping: [1e3; 2],
    };
}

/// Steps in which windows are renewed some times and every list has grown to its length, and steps in which nothing grows.
const STEPS: [usize; 2] = [1200, 1000];

#[test]
fn steps_allocate_nothing() {
    let counted = measure(|| drop(black_box(vec![0.0; STEPS[0]])));
    assert_eq!(counted.count_total, 1, "allocations are counted");
    let chains: [(&str, Parts, usize, f64); 8] = [
        ("particles", drive(|_| {}), 3, 1e-6),
        ("particles that rub", drive(rubbing), 3, 1e-6),
        ("particles with bristles", drive(bristles), 3, 1e-6),
        ("bush strands", drive(stranded), 3, 1e-6),
        ("points", drive(pointed), 4, 2e-7),
        ("ideal joints", drive(ideal), 5, 1e-6),
        (
            "ideal joints that rub",
            drive(|parts| {
                ideal(parts);
                rubbing(parts);
            }),
            5,
            1e-6,
        ),
        (
            "clearance",
            drive(|parts| with_play(&mut parts.chains[0])),
            5,
            1e-6,
        ),
    ];
    for (kind, parts, count, step) in chains {
        let assembled = assembled(parts);
        let methods = methods(step);
        for method in &methods[..count] {
            let mut system = assembled.system.clone();
            let mut state = assembled.state();
            let mut stepper = method.start(&mut system, &mut state).expect("starts");
            let mut advance = |steps: usize| {
                measure(|| {
                    for _ in 0..steps {
                        stepper.advance(&mut system, &mut state).expect("advances");
                    }
                })
            };
            let [_, then] = STEPS.map(&mut advance);
            let name = method.name();
            assert_eq!(then.count_total, 0, "{kind}, {name}: {then:?}");
        }
    }
}

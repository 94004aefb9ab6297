//! A step allocates nothing, whatever the chain is made of and however it is stepped.

use std::hint::black_box;

use allocation_counter::measure;
use chaindrive_contact::Friction;
use chaindrive_contact::friction::SpringSlider;
use chaindrive_integrate::Method;
use chaindrive_mechanics::{Articulation, ChainModel, Joint, Parts};

use crate::several_chains::{EVEN, assembled, chain, driven, pair, parts, with_play};

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

fn rubbing(parts: &mut Parts) {
    parts.chains[0].chain.articulation = Some(Articulation {
        friction: Friction::SpringSlider(SpringSlider {
            coefficient: 0.1,
            stiffness: 1e6,
        }),
        radius: 2e-3,
        damping: 1e-5,
    });
}

/// Steps in which windows are renewed some times and every list has grown to its length, and steps in which nothing grows.
const STEPS: [usize; 2] = [1200, 1000];

#[test]
fn steps_allocate_nothing() {
    let counted = measure(|| drop(black_box(vec![0.0; STEPS[0]])));
    assert_eq!(counted.count_total, 1, "allocations are counted");
    let chains: [(&str, Parts, usize); 5] = [
        ("particles", drive(|_| {}), 3),
        ("particles that rub", drive(rubbing), 3),
        ("ideal joints", drive(ideal), 5),
        (
            "ideal joints that rub",
            drive(|parts| {
                ideal(parts);
                rubbing(parts);
            }),
            5,
        ),
        (
            "clearance",
            drive(|parts| with_play(&mut parts.chains[0])),
            5,
        ),
    ];
    for (kind, parts, count) in chains {
        let assembled = assembled(parts);
        let methods = methods(1e-6);
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

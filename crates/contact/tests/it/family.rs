//! Duties of every law, whichever elastic law and dissipation it is made of.

use chaindrive_contact::elastic::ElasticLaw;
use chaindrive_contact::{Approach, Dissipation, Elastic, Friction, Law};

/// Penetrations \[m\] from far below to beyond those of a chain, and past the end of Johnson's theory.
fn penetrations() -> impl Iterator<Item = f64> {
    (0..60).map(|i| 1e-10 * 10.0_f64.powf(f64::from(i) / 8.0))
}

fn at(penetration: f64, rate: f64) -> Approach {
    Approach {
        penetration,
        rate,
        onset_rate: 0.3,
    }
}

#[track_caller]
fn assert_close(got: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (got - expected).abs() / expected.abs();
    assert!(
        error <= tolerance,
        "{what}: got {got:e}, expected {expected:e}, error {error:e}"
    );
}

#[test]
fn specimens_pass_their_own_check() {
    for law in Law::specimens() {
        law.check().unwrap();
    }
    for friction in Friction::specimens() {
        friction.check().unwrap();
    }
}

#[test]
fn silent_across_a_gap() {
    for law in Law::specimens() {
        for gap in [0.0, 1e-12, 1e-3] {
            for rate in [-1.0, 0.0, 1.0] {
                let quantities = [
                    law.force(at(-gap, rate)),
                    law.damping(at(-gap, rate)),
                    law.elastic_force(-gap),
                    law.stiffness(-gap),
                    law.energy(-gap),
                ];
                assert!(
                    quantities.iter().all(|x| x.abs() < f64::MIN_POSITIVE),
                    "{law:?}"
                );
            }
        }
    }
}

#[test]
fn never_pulls_and_stays_finite() {
    for law in Law::specimens() {
        for penetration in penetrations().chain([1e-300, 5e-324, 1.0]) {
            for rate in [-1e3, -1.0, -1e-3, 0.0, 1e-3, 1.0, 1e3] {
                for onset_rate in [0.0, 0.3] {
                    let force = law.force(Approach {
                        penetration,
                        rate,
                        onset_rate,
                    });
                    assert!(force >= 0.0 && force.is_finite(), "{law:?}: {force}");
                }
            }
        }
    }
}

#[test]
fn monotone_at_rest() {
    for law in Law::specimens() {
        let forces: Vec<f64> = penetrations().map(|x| law.force(at(x, 0.0))).collect();
        assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{law:?}");
    }
}

/// Closing never costs less than resting, and resting never less than opening.
#[test]
fn monotone_in_the_rate() {
    for law in Law::specimens() {
        let forces: Vec<f64> = (-20..=20)
            .map(|i| law.force(at(2e-6, 0.1 * f64::from(i))))
            .collect();
        assert!(forces.windows(2).all(|pair| pair[0] <= pair[1]), "{law:?}");
    }
}

#[test]
fn damping_is_the_slope_of_the_force() {
    for law in Law::specimens() {
        for rate in [-0.2, 0.0, 0.25] {
            let h = 1e-6;
            let slope = (law.force(at(2e-6, rate + h)) - law.force(at(2e-6, rate - h))) / (2.0 * h);
            let damping = law.damping(at(2e-6, rate));
            assert!(
                (slope - damping).abs() <= 1e-6 * damping.max(1.0),
                "{law:?}"
            );
        }
    }
}

#[test]
fn stiffness_is_the_slope_of_the_force() {
    for elastic in Elastic::specimens() {
        for x in penetrations() {
            // Fourth-order differences.
            let h = 1e-3 * x;
            let g = |steps: f64| elastic.force(x + steps * h);
            let slope = (8.0 * (g(1.0) - g(-1.0)) - (g(2.0) - g(-2.0))) / (12.0 * h);
            if crosses_a_knee(&elastic, x - 2.0 * h, x + 2.0 * h) {
                continue;
            }
            assert_close(
                elastic.stiffness(x),
                slope,
                1e-8,
                &format!("{elastic:?} at {x:e}"),
            );
        }
    }
}

/// Gauss's rule with five points on geometric pieces; the knee only costs its piece some digits.
#[test]
fn energy_is_the_integral_of_the_force() {
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    for elastic in Elastic::specimens() {
        let (mut from, mut work) = (1e-14, elastic.energy(1e-14));
        while from < 1e-3 {
            let to = 1.002 * from;
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            for (node, weight) in NODES {
                work += weight * half * elastic.force(middle + node * half);
            }
            from = to;
            assert_close(
                elastic.energy(to),
                work,
                1e-8,
                &format!("{elastic:?} at {to:e}"),
            );
        }
    }
}

/// Whether a law changes to its tangent between two penetrations.
fn crosses_a_knee(elastic: &Elastic, from: f64, to: f64) -> bool {
    let knee = match elastic {
        Elastic::Johnson(law) => 0.9 * law.greatest_penetration(),
        Elastic::Radzimovsky(law) => 0.9 * law.greatest_penetration(),
        Elastic::Esdu78035(law) => 0.9 * law.greatest_penetration(),
        Elastic::DubowskyFreudenstein(law) => 0.9 * law.greatest_penetration(),
        Elastic::Conformal(law) => 1.590_390_386_062_958_2 * law.clearance,
        _ => return false,
    };
    from < knee && knee < to
}

/// Force and stiffness at once are force and stiffness.
#[test]
fn pair_is_both() {
    for elastic in Elastic::specimens() {
        for x in penetrations().chain([-1e-6, 0.0, 5e-324]) {
            let (force, stiffness) = elastic.pair(x);
            assert!(
                (force - elastic.force(x)).abs() <= 1e-15 * force,
                "{elastic:?} at {x:e}"
            );
            let error = (stiffness - elastic.stiffness(x)).abs();
            assert!(error <= 1e-15 * stiffness, "{elastic:?} at {x:e}");
        }
    }
}

/// The prepared law, which kernels use, is the law.
#[test]
fn response_is_the_law() {
    for law in Law::specimens() {
        let prepared = law.prepared();
        for penetration in penetrations().chain([-1e-6, 0.0]) {
            for rate in [-2.0, -0.31, -0.1, 0.0, 0.1, 1.1, 2.0] {
                let here = at(penetration, rate);
                let response = prepared.respond(here);
                assert_eq!(response, law.respond(here));
                for (got, expected) in [
                    (response.force, law.force(here)),
                    (response.elastic, law.elastic_force(penetration)),
                    (response.damping, law.damping(here)),
                    (prepared.energy(penetration), law.energy(penetration)),
                ] {
                    // Where damping nearly cancels the elastic force, rounding is relative to the latter.
                    let scale = expected.abs().max(law.elastic_force(penetration));
                    assert!(
                        (got - expected).abs() <= 1e-14 * scale,
                        "{law:?} at {here:?}"
                    );
                }
            }
        }
    }
}

/// ∂F/∂δ at constant rate, with damping acting and with either limit holding.
#[test]
fn stiffness_of_the_response_is_the_slope_of_its_force() {
    for law in Law::specimens() {
        let prepared = law.prepared();
        for x in [3e-8, 1e-6, 7e-6, 3e-5] {
            for rate in [-5.0, -0.2, 0.0, 0.25, 5.0] {
                let h = 1e-3 * x;
                if crosses_a_knee(&law.elastic, x - 2.0 * h, x + 2.0 * h) {
                    continue;
                }
                let f = |steps: f64| law.force(at(x + steps * h, rate));
                if [-2.0, -1.0, 0.0, 1.0, 2.0]
                    .iter()
                    .any(|&steps| f(steps) <= 0.0)
                {
                    continue;
                }
                let slope = (8.0 * (f(1.0) - f(-1.0)) - (f(2.0) - f(-2.0))) / (12.0 * h);
                let stiffness = prepared.respond(at(x, rate)).stiffness;
                assert_close(stiffness, slope, 1e-7, &format!("{law:?} at {x:e}, {rate}"));
            }
        }
        let pulled = prepared.respond(at(1e-9, -1e6));
        if law.dissipation != Dissipation::None {
            assert_eq!(
                (pulled.force, pulled.stiffness, pulled.damping),
                (0.0, 0.0, 0.0)
            );
        }
    }
}

/// A parameter outside its range is named; the file form is strict and keeps every law.
#[test]
fn laws_survive_their_file_form() {
    for law in Law::specimens() {
        let text = serde_json::to_string(&law).unwrap();
        assert_eq!(serde_json::from_str::<Law>(&text).unwrap(), law);
    }
    let text = r#"{"elastic": {"kind": "power", "stiffness": 1e8, "exponent": 1.5},
        "dissipation": {"kind": "lankarani-nikravesh", "restitution": 1.4}, "onset_floor": 1e-3}"#;
    let law: Law = serde_json::from_str(text).unwrap();
    assert_eq!(
        law.check().unwrap_err().to_string(),
        "restitution = 1.4, must be at most 1"
    );
    let unknown = text.replace("\"exponent\"", "\"hardening\": 2, \"exponent\"");
    let message = serde_json::from_str::<Law>(&unknown)
        .unwrap_err()
        .to_string();
    assert!(message.contains("hardening"), "{message}");
}

/// A parameter that belongs to another member is not silently dropped.
#[test]
fn members_without_parameters_are_strict_too() {
    let text = r#"{"kind": "none", "restitution": 0.5}"#;
    let read = serde_json::from_str::<Dissipation>(text);
    assert!(read.is_err(), "{read:?}");
}

/// Without a floor a hysteretic law would divide by zero; others do not need one.
#[test]
fn floor_is_required_where_it_is_divided_by() {
    for mut law in Law::specimens() {
        law.onset_floor = 0.0;
        let hysteretic = law.dissipation.factor().is_some();
        assert_eq!(law.check().is_err(), hysteretic);
    }
}

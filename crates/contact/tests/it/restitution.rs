//! A mass thrown at every dissipation returns with the restitution of the theory.

use chaindrive_contact::dissipation::Viscous;
use chaindrive_contact::elastic::{CylinderLaw, Cylinders, Power};
use chaindrive_contact::restitution::delivered;
use chaindrive_contact::{Approach, Dissipation, Elastic, Law};

/// Exit over entry speed, by the classical Runge–Kutta method with `steps` to the depth of rest.
fn thrown(law: &Law, mass: f64, speed: f64, steps: f64) -> f64 {
    let prepared = law.prepared();
    let acceleration = |penetration: f64, rate: f64| {
        let response = prepared.respond(Approach {
            penetration,
            rate,
            onset_rate: speed,
        });
        -response.force / mass
    };
    let mut depth = 1e-12;
    while law.energy(depth) < 0.5 * mass * speed * speed {
        depth *= 1.01;
    }
    let h = depth / speed / steps;
    let (mut x, mut v) = (0.0, speed);
    loop {
        let (k1, a1) = (v, acceleration(x, v));
        let (k2, a2) = (
            v + 0.5 * h * a1,
            acceleration(x + 0.5 * h * k1, v + 0.5 * h * a1),
        );
        let (k3, a3) = (
            v + 0.5 * h * a2,
            acceleration(x + 0.5 * h * k2, v + 0.5 * h * a2),
        );
        let (k4, a4) = (v + h * a3, acceleration(x + h * k3, v + h * a3));
        x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        if x <= 0.0 {
            return -v / speed;
        }
    }
}

/// Three elastic laws that have nothing in common.
fn elastics() -> [Elastic; 3] {
    let pin = Cylinders::pin_in_hole(1.85e-3, 1.8e-3, 4.5e-3, 113.7e9);
    let between = |law: CylinderLaw| law.between(&pin).expect("a pin in its bushing");
    [
        Elastic::Power(Power::linear(1e8)),
        between(CylinderLaw::Cylindrical),
        between(CylinderLaw::Conformal),
    ]
}

#[test]
fn every_hysteretic_dissipation_delivers_what_the_theory_says() {
    let mut worst: f64 = 0.0;
    for asked in [0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
        for dissipation in Dissipation::hysteretic(asked) {
            let expected = delivered(dissipation.factor().unwrap());
            for elastic in elastics() {
                // Dissipation multiplies the force of the whole stack.
                for series in [None, Some(5e7)] {
                    let law = Law {
                        elastic,
                        series,
                        dissipation,
                        onset_floor: 1e-6,
                    };
                    let error = thrown(&law, 5e-4, 0.5, 1000.0) - expected;
                    worst = worst.max(error.abs());
                    assert!(error.abs() < 1e-4, "{law:?}: {error:e}");
                }
                if matches!(dissipation, Dissipation::Exact(_)) {
                    assert!((expected - asked).abs() < 1e-13);
                }
            }
        }
    }
    println!("worst error of a restitution: {worst:.1e}");
}

#[test]
fn without_dissipation_nothing_is_lost() {
    for elastic in elastics() {
        let law = Law {
            series: None,
            elastic,
            dissipation: Dissipation::None,
            onset_floor: 1e-6,
        };
        assert!((thrown(&law, 5e-4, 0.5, 1000.0) - 1.0).abs() < 1e-4);
    }
}

/// A Kelvin–Voigt element that may not pull parts when its force is zero:
/// e = exp(−ζ s/√(1 − ζ²)), tan s = −2ζ√(1 − ζ²)/(1 − 2ζ²).
#[test]
fn kelvin_and_voigt_part_when_the_force_is_zero() {
    let (stiffness, mass) = (1e8_f64, 5e-4_f64);
    for damping_ratio in [0.05, 0.2, 0.5] {
        let law = Law {
            series: None,
            elastic: Elastic::Power(Power::linear(stiffness)),
            dissipation: Dissipation::Viscous(Viscous {
                damping: 2.0 * damping_ratio * (stiffness * mass).sqrt(),
            }),
            onset_floor: 0.0,
        };
        let free = (1.0 - damping_ratio * damping_ratio).sqrt();
        let s = std::f64::consts::PI
            - (2.0 * damping_ratio * free / (1.0 - 2.0 * damping_ratio * damping_ratio)).atan();
        let expected = (-damping_ratio * s / free).exp();
        let error = thrown(&law, mass, 0.5, 2e4) - expected;
        assert!(error.abs() < 1e-4, "ζ = {damping_ratio}: {error:e}");
    }
}

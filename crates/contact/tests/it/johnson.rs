//! Johnson's law against forces computed by an independent program.
//!
//! The reference solves the implicit law δ = p [ln(4ΔR/p) − 1] for the load in Python, by Newton's
//! method, to twelve digits; composite modulus of steel on steel, 113.736 GPa.

use chaindrive_contact::elastic::{ElasticLaw, Johnson};
use chaindrive_contact::{Elastic, Elasticity};

/// Pair, its law, and rows of penetration \[m\] and force \[N\].
type Case = (&'static str, Johnson, &'static [(f64, f64)]);

fn cases() -> Vec<Case> {
    let modulus = Elasticity::STEEL.composite(Elasticity::STEEL);
    vec![
        (
            "pin of 19 mm in its hole",
            Johnson::internal(0.01, 0.0095, 0.01, modulus),
            &[
                (1e-07, 31.534_019_679_53),
                (1e-06, 407.309_084_125_6),
                (1e-05, 5_850.013_652_689),
                (3e-05, 22_520.010_580_03),
            ],
        ),
        (
            "pin in bushing",
            Johnson::internal(0.001_85, 0.0018, 0.0045, modulus),
            &[
                (3e-07, 64.146_701_508_18),
                (3e-06, 1_013.400_476_101),
                (2e-05, 16_148.149_473_9),
            ],
        ),
        (
            "roller on tooth",
            Johnson::external(0.003_875, 0.0186, 0.0022, modulus),
            &[
                (1e-07, 5.089_133_042_595),
                (1e-06, 60.612_817_536_14),
                (1e-05, 752.200_497_694_8),
                (3e-05, 2_555.710_564_067),
            ],
        ),
        (
            "roller in seat",
            Johnson::internal(0.003_913_75, 0.003_875, 0.0022, modulus),
            &[
                (3e-07, 32.640_645_639_22),
                (3e-06, 531.841_889_817_8),
                (1e-5, 2_854.524_120_479),
            ],
        ),
        (
            "bushing in roller",
            Johnson::internal(0.0026, 0.0025, 0.003, modulus),
            &[
                (1e-07, 11.223_716_937_55),
                (1e-06, 154.750_783_799_2),
                (1e-05, 2_614.598_101_479),
                (3e-05, 12_807.356_621_89),
            ],
        ),
    ]
}

#[test]
fn agrees_with_the_implicit_law() {
    for (name, law, rows) in cases() {
        for &(penetration, expected) in rows {
            let error = law.force(penetration) / expected - 1.0;
            assert!(
                error.abs() < 1e-10,
                "{name} at {penetration:e} m: {error:e}"
            );
        }
    }
}

/// p = δ/u put back into the implicit law gives δ, up to the knee.
#[test]
fn satisfies_the_implicit_law() {
    for (name, law, _) in cases() {
        let end = law.greatest_penetration();
        for i in 1..900 {
            let penetration = 1e-3 * f64::from(i) * end;
            let p = law.force(penetration) / (std::f64::consts::PI * law.modulus_length);
            let back = p * ((law.length_scale / p).ln() - 1.0);
            assert!(
                (back / penetration - 1.0).abs() < 1e-13,
                "{name} at {penetration:e}"
            );
        }
    }
}

/// Force, stiffness and energy are continuous at the knee, and beyond the law is a straight line.
#[test]
fn continues_as_its_tangent() {
    for (name, law, _) in cases() {
        let knee = 0.9 * law.greatest_penetration();
        let (below, above) = (knee * (1.0 - 1e-12), knee * (1.0 + 1e-12));
        for (a, b) in [
            (law.force(below), law.force(above)),
            (law.stiffness(below), law.stiffness(above)),
            (law.energy(below), law.energy(above)),
        ] {
            assert!((a / b - 1.0).abs() < 1e-11, "{name}: {a} {b}");
        }
        let rise = law.force(30.0 * knee) - law.force(10.0 * knee);
        assert!(
            (rise / (20.0 * knee * law.stiffness(5.0 * knee)) - 1.0).abs() < 1e-12,
            "{name}"
        );
    }
}

/// A cylinder on a flat is the limit of a large partner only on a rigid one: D = 4R.
#[test]
fn flat_is_stiffer_than_any_larger_cylinder() {
    let modulus = Elasticity::STEEL.composite(Elasticity::RIGID);
    let flat = Johnson::flat(4e-3, 2e-3, modulus);
    let wheel = Johnson::external(4e-3, 20e-3, 2e-3, modulus);
    assert!(flat.force(1e-6) > wheel.force(1e-6));
    assert!((flat.length_scale - 16e-3).abs() < 1e-15);
}

#[test]
fn a_pin_without_clearance_is_refused() {
    let jammed = Johnson::internal(2e-3, 2e-3, 4e-3, 1e11);
    assert_eq!(
        Elastic::from(jammed).check().unwrap_err().parameter,
        "length_scale"
    );
}

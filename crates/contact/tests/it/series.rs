//! A law with a spring behind it: two springs, one behind the other.

use chaindrive_contact::elastic::{CylinderLaw, Cylinders, ElasticLaw, Power};
use chaindrive_contact::{Dissipation, Elastic, Law};

const BEHIND: f64 = 5.3e7;

fn with(elastic: Elastic, series: Option<f64>) -> Law {
    Law {
        elastic,
        series,
        dissipation: Dissipation::None,
        onset_floor: 0.0,
    }
}

/// Penetration of the surfaces themselves, by bisection of x + g(x)/k_s = δ.
fn bisected(elastic: Elastic, penetration: f64) -> f64 {
    let (mut low, mut high) = (0.0, penetration);
    for _ in 0..200 {
        let x = 0.5 * (low + high);
        if x + elastic.force(x) / BEHIND < penetration {
            low = x;
        } else {
            high = x;
        }
    }
    0.5 * (low + high)
}

#[track_caller]
fn assert_close(got: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (got / expected - 1.0).abs();
    assert!(
        error < tolerance,
        "{what}: {got:e}, {expected:e}, {error:e}"
    );
}

/// F = g(x), 1/k = 1/g′(x) + 1/k_s, U = U_g(x) + F²/(2 k_s), for every law, before and after its knee.
#[test]
fn springs_one_behind_the_other_share_a_penetration() {
    for elastic in Elastic::specimens() {
        let law = with(elastic, Some(BEHIND));
        for i in 0..40 {
            let penetration = 1e-9 * 10.0_f64.powf(f64::from(i) / 7.0);
            let x = bisected(elastic, penetration);
            let what = format!("{elastic:?} at {penetration:e}");
            let force = elastic.force(x);
            assert_close(law.elastic_force(penetration), force, 1e-11, &what);
            let stiffness = 1.0 / (1.0 / elastic.stiffness(x) + 1.0 / BEHIND);
            assert_close(law.stiffness(penetration), stiffness, 1e-10, &what);
            let energy = elastic.energy(x) + force * force / (2.0 * BEHIND);
            assert_close(law.energy(penetration), energy, 1e-10, &what);
        }
    }
}

#[test]
fn what_is_rigid_changes_nothing_and_what_is_soft_is_all_that_counts() {
    for elastic in Elastic::specimens() {
        let alone = with(elastic, None).elastic_force(2e-5);
        assert_close(
            with(elastic, Some(1e22)).elastic_force(2e-5),
            alone,
            1e-9,
            "rigid",
        );
        let soft = with(elastic, Some(1.0)).elastic_force(2e-5);
        assert_close(soft, 2e-5, 1e-3, "soft");
    }
}

/// Two linear springs are one, k₁ k₂/(k₁ + k₂), with nothing left to solve.
#[test]
fn two_linear_springs_are_one() {
    let law = with(Elastic::Power(Power::linear(1e8)), Some(BEHIND));
    let stiffness = 1e8 * BEHIND / (1e8 + BEHIND);
    assert_eq!(law.prepared().power(), Some([stiffness, 1.0]));
    assert_close(law.elastic_force(1e-5), stiffness * 1e-5, 1e-15, "both");
}

#[test]
fn a_spring_that_is_none_is_refused() {
    let pin = Cylinders::pin_in_hole(1.85e-3, 1.8e-3, 4.5e-3, 113.7e9);
    let elastic = CylinderLaw::Johnson.between(&pin).unwrap();
    for series in [0.0, -1e6, f64::NAN, f64::INFINITY] {
        let error = with(elastic, Some(series)).check().unwrap_err();
        assert!(error.to_string().contains("series"), "{error}");
    }
    with(elastic, Some(BEHIND)).check().unwrap();
}

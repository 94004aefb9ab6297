//! Viscosity, index and density of oils against the examples of the standards and published values.

use chaindrive_contact::Lubricant;
use chaindrive_contact::lubricant::viscosity_index;

const CELSIUS: f64 = 273.15;

fn oil(grade: &str, degrees: f64) -> Lubricant {
    Lubricant {
        viscosity_40: Lubricant::grade(grade).expect("a grade of ISO 3448"),
        viscosity_index: 95.0,
        density: 880.0,
        temperature: degrees + CELSIUS,
    }
}

/// Examples of ASTM D2270: 5.1.4 with an index below 100, and 6.1.4 with one above.
#[test]
fn viscosity_indices_are_those_of_the_examples_of_the_standard() {
    for (at_40, at_100, index) in [(73.30, 8.86, 92.43), (22.83, 5.05, 156.37)] {
        let found = viscosity_index(at_40 * 1e-6, at_100 * 1e-6).unwrap();
        assert!((found - index).abs() < 0.3, "{found} for {index}");
    }
    assert_eq!(viscosity_index(5e-6, 1.9e-6), None);
}

/// The viscosity at 100 °C that follows from an index has that index.
#[test]
fn an_index_comes_back() {
    for grade in ["VG 15", "VG 32", "VG 150", "VG 460", "VG 3200"] {
        for index in [0.0, 40.0, 95.0, 120.0, 180.0] {
            let oil = Lubricant {
                viscosity_index: index,
                ..oil(grade, 40.0)
            };
            oil.check().unwrap();
            let found = viscosity_index(oil.viscosity_40, oil.viscosity_100()).unwrap();
            // The pieces of L and H meet within 0.1 %.
            assert!((found - index).abs() < 0.2, "{grade} {index}: {found}");
        }
    }
}

/// Typical values at 100 °C of a table of the trade, for industrial oils with an index about 95 to 100: they are given to a few per cent.
/// The values at 40 °C are those of ISO 3448.
#[test]
fn grades_have_the_viscosities_of_tables() {
    for (grade, at_40, at_100) in [
        ("VG 32", 32.0, 5.5),
        ("VG 150", 150.0, 14.5),
        ("VG 460", 460.0, 32.0),
    ] {
        let at = |degrees| oil(grade, degrees).kinematic_viscosity() * 1e6;
        assert!((at(40.0) / at_40 - 1.0).abs() < 1e-9, "{grade}");
        assert!((at(100.0) / at_100 - 1.0).abs() < 0.06, "{}", at(100.0));
    }
}

/// Dynamic viscosities \[mPa s\] at 30, 60 and 100 °C of oils of VG 32, 100, 150 and 460, as measured
/// (G. Stachowiak and A. Batchelor, *Engineering Tribology*, table 2.3). Grade and index are those of the first and last value.
#[test]
fn measured_oils_lie_on_their_line() {
    for (grade, [cold, warm, hot]) in [
        ("VG 32", [45.0, 12.0, 3.9]),
        ("VG 100", [153.0, 34.0, 9.1]),
        ("VG 150", [250.0, 50.5, 12.6]),
        ("VG 460", [810.0, 135.0, 26.8]),
    ] {
        let of = |viscosity_40: f64, viscosity_index: f64, degrees: f64| Lubricant {
            viscosity_40,
            viscosity_index,
            density: 880.0,
            temperature: degrees + CELSIUS,
        };
        // Two values, two unknowns: the index that fits the first, for the viscosity that fits the last.
        let mut best = (f64::INFINITY, oil("VG 100", 40.0));
        for index in 0..=150 {
            let index = f64::from(index);
            let mut between = [20e-6, 600e-6];
            for _ in 0..60 {
                let middle = 0.5 * (between[0] + between[1]);
                let beyond = of(middle, index, 100.0).dynamic_viscosity() > hot * 1e-3;
                between[usize::from(beyond)] = middle;
            }
            let off = (of(between[1], index, 30.0).dynamic_viscosity() / (cold * 1e-3)).ln();
            if off.abs() < best.0 {
                best = (off.abs(), of(between[1], index, 60.0));
            }
        }
        let (off, best) = best;
        assert!(off < 0.02, "{grade}: {off}");
        let graded = best.viscosity_40 / Lubricant::grade(grade).unwrap();
        assert!((0.9..1.1).contains(&graded), "{grade}: {graded}");
        let found = best.dynamic_viscosity() * 1e3;
        println!(
            "{grade}: index {}, {found:.2} for {warm}",
            best.viscosity_index
        );
        assert!(
            (found / warm - 1.0).abs() < 0.04,
            "{grade}: {found} for {warm}"
        );
    }
}

/// ASTM D1250 for lubricating oils: 880 kg/m³ at 15 °C is some 7e-4 a kelvin.
#[test]
fn density_falls_by_the_expansion_of_oil() {
    let at = |degrees| oil("VG 150", degrees).density_there();
    assert!((at(15.0) - 880.0).abs() < 1e-9);
    let expansion = (at(15.0) / at(60.0) - 1.0) / 45.0;
    assert!((expansion / 7.3e-4 - 1.0).abs() < 0.03, "{expansion}");
    let oil = oil("VG 150", 60.0);
    let product = oil.density_there() * oil.kinematic_viscosity();
    assert!((oil.dynamic_viscosity() / product - 1.0).abs() < 1e-15);
}

#[test]
fn values_out_of_range_are_named() {
    let good = oil("VG 150", 60.0);
    for (bad, name) in [
        (
            Lubricant {
                viscosity_40: 1e-6,
                ..good
            },
            "viscosity_40",
        ),
        (
            Lubricant {
                viscosity_40: 3e-6,
                ..good
            },
            "viscosity_40",
        ),
        (
            Lubricant {
                viscosity_index: f64::NAN,
                ..good
            },
            "viscosity_index",
        ),
        (
            Lubricant {
                density: 0.88,
                ..good
            },
            "density",
        ),
        (
            Lubricant {
                temperature: 60.0,
                ..good
            },
            "temperature",
        ),
    ] {
        assert_eq!(bad.check().unwrap_err().parameter, name);
    }
    assert_eq!(Lubricant::grade("VG 151"), None);
    assert_eq!(Lubricant::grades().count(), 20);
}

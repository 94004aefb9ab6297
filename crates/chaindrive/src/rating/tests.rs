//! Formulas at the points of their sources, and what becomes of them in a rating.

use std::f64::consts::TAU;

use chaindrive_mechanics::{Extremes, PowerLimits};

use super::*;
use crate::catalogue::{Number, catalogue};

const RPM: f64 = TAU / 60.0;

/// Number 80: an inch of pitch, on which P₁ is 0.004 Z^1.08 n^0.9.
const INCH_PITCH: PowerLimits = PowerLimits {
    pitch: 0.0254,
    plates: 0.004,
    rollers: 17.0,
};

fn american(strands: u32) -> Strength {
    Strength {
        breaking_load: Some(56.7e3),
        bearing_area: Some(176.2e-6),
        pin_radius: Some(3.96e-3),
        strands,
        capacity: Capacity::American(INCH_PITCH),
        ..Strength::default()
    }
}

fn duty(name: &str, teeth: u32, power: f64, force: [f64; 2]) -> SprocketDuty {
    SprocketDuty {
        name: name.to_owned(),
        teeth,
        speed: 300.0 * RPM * 19.0 / f64::from(teeth),
        power,
        force,
    }
}

/// 15 kW from 19 teeth at 300 rpm to 57, past an idler of 11.
fn load(strength: Strength) -> Load {
    Load {
        chain: String::new(),
        strength,
        tension: Extremes {
            least: 0.0,
            greatest: 8.1e3,
            ..Extremes::default()
        },
        pressed: 0.0,
        power: 15e3,
        pitch: 0.0254,
        steady: Some(6.3e3),
        sliding: Some(18.7),
        wear_limit: Some(WearLimit {
            elongation: 0.015,
            bound: WearBound::FixedCentres,
        }),
        sprockets: vec![
            duty("driven", 57, 14.8e3, [-3e3, 4e3]),
            duty("driver", 19, -15e3, [6e3, 0.0]),
            duty("idler", 11, 20.0, [0.0, -200.0]),
        ],
    }
}

/// Shigley, 9th ed., table 17–23.
#[test]
fn strands_carry_less_than_their_number() {
    let factors = [1, 2, 3, 4, 5, 6].map(strand_factor);
    let published = [1.0_f64, 1.7, 2.5, 3.3, 3.9, 4.6];
    assert_eq!(factors.map(f64::to_bits), published.map(f64::to_bits));
    let single = rated_power(&american(1), 19, 300.0 * RPM).unwrap_or_default();
    for strands in 1..=6 {
        let several = rated_power(&american(strands), 19, 300.0 * RPM).unwrap_or_default();
        assert!((several / single / strand_factor(strands) - 1.0).abs() < 1e-12);
    }
    // Nobody has published factors of more.
    assert_eq!(strand_factor(9).to_bits(), strand_factor(6).to_bits());
    assert_eq!(strand_factor(0).to_bits(), strand_factor(1).to_bits());
}

/// Shigley, 9th ed., eqs. 17–32 and 17–33 by hand: 0.004 · 19^1.08 · 300^0.9 and 17 000 (19/300)^1.5 horsepower.
#[test]
fn the_least_limit_governs() {
    let rating = Rating::of(&load(american(1)));
    let at = rating.sprocket.as_ref();
    assert_eq!(
        at.map(|it| (it.name.as_str(), it.teeth)),
        Some(("driver", 19)),
        "an idler takes no part"
    );
    let limits = rating.limits.as_deref().unwrap_or_default();
    let [plates, rollers, galling] = limits else {
        panic!("{limits:?}");
    };
    let is = |found: Option<f64>, horsepower: f64| {
        found.is_some_and(|found| (found / 745.7 / horsepower - 1.0).abs() < 5e-3)
    };
    assert!(is(plates.power, 16.31), "{plates:?}");
    assert!(is(rollers.power, 271.0), "{rollers:?}");
    assert_eq!((galling.by, galling.power), (LimitedBy::Galling, None));
    assert_eq!(
        rating.governing().map(|(by, _)| by),
        Some(LimitedBy::Plates)
    );
    let fast = power_limits(&american(1), 19, 3000.0 * RPM);
    let governs = fast.ok().and_then(|limits| least(&limits));
    assert_eq!(governs.map(|(by, _)| by), Some(LimitedBy::Rollers));
}

#[test]
fn the_service_factor_counts_with_the_power_that_is_carried() {
    let rated = |service_factor| {
        Rating::of(&load(Strength {
            service_factor,
            ..american(2)
        }))
    };
    let smooth = rated(1.0).utilisation();
    assert!(smooth.is_some_and(|it| (it - 15e3 / (1.7 * 12.16e3)).abs() < 1e-3));
    let rough = rated(1.4).utilisation();
    let ratio = rough.zip(smooth).map(|(rough, smooth)| rough / smooth);
    assert!(ratio.is_some_and(|it| (it - 1.4).abs() < 1e-12));
}

/// Static safety is of the greatest tension, dynamic safety of that which recurs; p = T/(k d b).
#[test]
fn safeties_pressure_and_shaft_loads_are_those_of_the_load() {
    let rating = Rating::of(&load(american(2)));
    let near = |found: Option<f64>, expected: f64| {
        found.is_some_and(|found| (found / expected - 1.0).abs() < 1e-12)
    };
    assert!(near(rating.static_safety, 7.0));
    assert!(near(rating.dynamic_safety, 9.0));
    assert!(near(rating.bearing_pressure, 6.3e3 / (2.0 * 176.2e-6)));
    let [driven, driver, idler] = rating.shaft_loads.as_slice() else {
        panic!("{rating:?}");
    };
    assert!(near(Some(driven.force), 5e3) && near(Some(idler.force), 200.0));
    assert!((driven.angle.to_degrees() - 126.869_897_645_844).abs() < 1e-9);
    assert!(driver.angle.abs() < 1e-12);
    assert!((idler.angle.to_degrees() + 90.0).abs() < 1e-12);
}

/// Number 40 by hand or in drops up to 300 ft/min, in a bath up to 2300 ft/min.
#[test]
fn lubrication_follows_the_chain_speed() {
    let foot_a_minute = 0.3048 / 60.0;
    for (pitch, speed, expected) in [
        (0.0127, 299.0, Some(Lubrication::Drip)),
        (0.0127, 301.0, Some(Lubrication::Bath)),
        (0.0127, -2301.0, Some(Lubrication::Stream)),
        (0.0254, 169.0, Some(Lubrication::Drip)),
        (0.0508, 999.0, Some(Lubrication::Bath)),
        (0.0508, 1001.0, Some(Lubrication::Stream)),
        // Between two rows: √(220 · 170) ft/min at √(0.75 · 1) in. Beyond the table by its ends: 300 · 3^½ at ¼ in, 100/3^(log₄ 2) = 57.7 at 4 in.
        (0.866_025 * 0.0254, 193.3, Some(Lubrication::Drip)),
        (0.866_025 * 0.0254, 193.5, Some(Lubrication::Bath)),
        (0.00635, 519.0, Some(Lubrication::Drip)),
        (0.00635, 520.0, Some(Lubrication::Bath)),
        (0.1016, 57.7, Some(Lubrication::Drip)),
        (0.1016, 57.8, Some(Lubrication::Bath)),
        (0.0, 100.0, None),
    ] {
        let found = Lubrication::at(pitch, speed * foot_a_minute);
        assert_eq!(found, expected, "{pitch}, {speed}");
    }
    let class = Rating::of(&load(american(1))).lubrication;
    assert_eq!(class, Some(Lubrication::Bath), "2.4 m/s, 475 ft/min");
}

/// Small chains may run faster in drops, and every chain of the catalogue has its speeds.
#[test]
fn every_chain_of_the_catalogue_has_its_lubrication() {
    let chains = catalogue().iter();
    let pitches = chains.filter_map(|chain| chain.number(Number::Pitch));
    let mut pitches: Vec<f64> = pitches.collect();
    pitches.sort_by(f64::total_cmp);
    pitches.dedup();
    let speeds = pitches.iter().map(|pitch| LubricationSpeeds::of(*pitch));
    let speeds: Vec<LubricationSpeeds> = speeds.map(Option::unwrap).collect();
    assert_eq!(speeds.iter().filter(|it| it.is_tabled).count(), 8);
    for pair in speeds.windows(2) {
        assert!(pair[0].drip > pair[1].drip && pair[0].bath > pair[1].bath);
        assert!(pair[0].drip < 0.2 * pair[0].bath, "{pair:?}");
    }
}

/// By hand: ε p d b/(k Q) = 0.015 · 25.4 mm · 176.2 mm²/(3·10⁻⁷ mm³/(N m) · 18.7 W) = 11 970 000 s = 3324 h; two strands last twice as long.
#[test]
fn life_is_archards_within_a_factor_of_ten() {
    let by_hand = 0.015 * 25.4e-3 * 176.2e-6 / (3e-16 * 18.7) / 3600.0;
    for strands in [1, 2] {
        let [least, greatest] = Rating::of(&load(american(strands))).life.unwrap();
        let expected = f64::from(strands) * by_hand;
        assert!((least * 10.0 / expected - 1.0).abs() < 1e-12, "{least}");
        assert!(
            (greatest / 10.0 / expected - 1.0).abs() < 1e-12,
            "{greatest}"
        );
    }
    let life = Rating::of(&load(american(1))).life.unwrap();
    assert_eq!(told_hours(life), "330 to 33,000 h");
    assert_eq!(told_hours([0.956, 9.94]), "0.96 to 9.9 h");
    assert_eq!(told_hours([99.6, 1_249_999.0]), "100 to 1,200,000 h");
    let mut still = load(american(1));
    still.sliding = Some(0.0);
    assert_eq!(Rating::of(&still).life, None);
}

#[test]
fn what_nobody_rates_says_why_and_what_its_twin_bears() {
    let unknown = |why| Strength {
        capacity: Capacity::Unknown(why),
        ..american(1)
    };
    let twin = Some(INCH_PITCH);
    let rating = Rating::of(&load(unknown(MissingRating::SourceMissing { twin })));
    assert_eq!((rating.governing(), rating.utilisation()), (None, None));
    assert!(
        rating
            .twin
            .is_some_and(|it| (it / 12.16e3 - 1.0).abs() < 1e-3)
    );
    assert!(rating.static_safety.is_some(), "the other figures stand");
    let none = Rating::of(&load(unknown(MissingRating::NoType)));
    assert_eq!(none.twin, None);
    // What the maker says holds for all strands.
    let maker = Strength {
        capacity: Capacity::Given(17e3),
        ..american(2)
    };
    let governing = Rating::of(&load(maker)).governing();
    assert_eq!(governing, Some((LimitedBy::Maker, 17e3)));
}

#[test]
fn a_chain_at_rest_has_no_rating() {
    let mut still = load(american(1));
    for sprocket in &mut still.sprockets {
        sprocket.speed = 0.0;
    }
    let rating = Rating::of(&still);
    assert_eq!((rating.power(), rating.lubrication), (None, None));
}

//! Polygon action against closed forms computed elsewhere, one folder of `tests/validation` a case.
//!
//! The tables give, over one tooth of the driver from the moment a roller has seated, the turn of
//! the driven wheel, the speed ratio over its mean, its rate, the direction of the span and its
//! number of links. They carry twelve digits.

#![expect(clippy::unwrap_used, reason = "test code outside of test functions")]

use std::f64::consts::{PI, TAU};

use chaindrive_geometry::{
    ChordalAction, GeometryError, PolygonAction, PressureAngles, TwoWheels, mesh_frequency,
};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};

const KINEMATICS: [&str; 8] = ["K02", "K03", "K05", "K07", "K08", "K10", "K12", "K13"];

fn drive(case: &Case) -> PolygonAction {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let teeth = |name| count(input(name));
    PolygonAction::new(teeth("z1"), teeth("z2"), input("pitch"), input("C")).unwrap()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts in a table"
)]
fn count(number: f64) -> u32 {
    number.round() as u32
}

#[test]
fn chordal_action_of_one_sprocket() {
    let case = Case::read("K01");
    let tolerance = Relative(case.number("tolerance"));
    let judge = |quantity: &str, unit: &str, found, expected| {
        case.judge(quantity, unit, found, expected, tolerance);
    };
    let pitch = 0.0254;
    for row in case.table("expected.table") {
        let action = ChordalAction::new(count(row[0]), pitch).unwrap();
        let diameter = action.pitch_diameter / pitch;
        judge("pitch diameter", "p", diameter, row[1]);
        judge("least over greatest speed", "", action.speed_ratio, row[2]);
        let nonuniformity = 100.0 * action.nonuniformity();
        judge("nonuniformity", "%", nonuniformity, row[3]);
        judge("rise of the span", "p", action.rise / pitch, row[4]);
        // v_mean = z p ω / 2π against v_max = R ω
        let mean = row[0] * pitch / TAU / (0.5 * action.pitch_diameter);
        let found = action.mean_speed_ratio;
        judge("mean over greatest speed", "", found, mean);
    }
}

#[test]
fn linkage_reproduces_the_tables() {
    for id in KINEMATICS {
        let case = Case::read(id);
        let drive = drive(&case);
        let judge = |quantity: &str, unit: &str, found, expected| {
            let tolerance = Absolute(case.number("tolerance"));
            case.judge(quantity, unit, found, expected, tolerance);
        };
        let period = TAU / case.number("inputs.z1");
        let radii = drive.radii();
        let listed = ["R1", "R2"].map(|name| case.number(&format!("inputs.{name}")));
        judge("pitch radius of the driver", "m", radii[0], listed[0]);
        judge("pitch radius of the driven", "m", radii[1], listed[1]);
        for (i, row) in (0_u32..).zip(case.table("expected.table")) {
            let phase = f64::from(i) / 12.0;
            assert!((phase - row[0]).abs() < 1e-9, "{id}: a row every twelfth");
            let state = drive.driven(phase * period);
            judge("turn of the driven wheel", "rad", state.angle, row[1]);
            let ratio = state.ratio / drive.mean_ratio();
            judge("speed ratio over its mean", "", ratio, row[2]);
            judge("rate of the speed ratio", "1/rad", state.ratio_rate, row[3]);
            judge("direction of the span", "rad", state.span_angle, row[4]);
            let links = f64::from(state.links);
            case.judge("links of the span", "", links, row[5], Absolute(0.0));
        }
    }
}

/// The reference took its extremes from 20 000 samples a tooth; the exact ones enclose them.
#[test]
fn extremes_enclose_the_sampled_ones() {
    for id in KINEMATICS {
        let case = Case::read(id);
        let drive = drive(&case);
        let tolerance = case.number("tolerance");
        let judge = |quantity: &str, unit: &str, found, name: &str, tolerance: f64| {
            let expected = case.number(&format!("expected.summary.{name}"));
            case.judge(quantity, unit, found, expected, Absolute(tolerance));
        };
        let (lowest, highest) = sampled_ratio(&drive);
        let (low, high) = (lowest / drive.mean_ratio(), highest / drive.mean_ratio());
        judge("least speed ratio", "", low, "ratio_norm_min", tolerance);
        judge(
            "greatest speed ratio",
            "",
            high,
            "ratio_norm_max",
            tolerance,
        );
        let error = drive.transmission_error_range();
        let name = "range of the transmission error";
        judge(name, "rad", error, "te_ptp_rad", tolerance);
        let period = TAU / case.number("inputs.z1");
        let rates =
            (0..20_000).map(|i| drive.driven(period * f64::from(i) / 20e3).ratio_rate.abs());
        // The greatest rate is that of the sample next to a jump: the begin of the samples shows.
        let rate = rates.fold(0.0, f64::max);
        let name = "greatest rate of the speed ratio";
        judge(name, "1/rad", rate, "max_abs_dratio", 1e-8);
        let (least, most) = drive.ratio_extremes();
        assert!(least < lowest + 1e-14 && lowest - least < 1e-9);
        assert!(most > highest - 1e-14 && most - highest < 1e-5);
        let links = f64::from(drive.driven(0.0).links);
        judge("links after a seating", "", links, "n_after_seating", 0.0);
    }
}

/// Least and greatest speed ratio of 20 000 samples over a tooth.
fn sampled_ratio(drive: &PolygonAction) -> (f64, f64) {
    let [driver, _] = drive.radii();
    let period = 2.0 * (0.5 * drive.pitch() / driver).asin();
    let ratio = |i: u32| drive.driven(period * f64::from(i) / 20e3).ratio;
    let ratios = (0..20_000).map(ratio);
    ratios.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), r| {
        (a.min(r), b.max(r))
    })
}

#[test]
fn ripple_grows_with_the_fraction_of_a_pitch() {
    let case = Case::read("K14");
    let tolerance = Absolute(case.number("tolerance"));
    let pitch = 0.0127;
    for row in case.table("expected.table") {
        let (z, fraction) = (count(row[0]), row[1]);
        let centre_distance = (12.0 + fraction) * pitch;
        let drive = PolygonAction::new(z, z, pitch, centre_distance);
        if centre_distance < ChordalAction::new(z, pitch).unwrap().pitch_diameter {
            // One row is a drive that cannot be built: its sprockets overlap.
            assert!(matches!(drive, Err(GeometryError::WheelsOverlap { .. })));
            continue;
        }
        let drive = drive.unwrap();
        let (least, most) = drive.ratio_extremes();
        if fraction < 0.1 {
            let ripples = [most - least, drive.transmission_error_range()];
            let name = "ripples of a parallelogram";
            case.judge_each(name, "", &ripples, &[0.0; 2], Absolute(1e-13));
        }
        let (lowest, highest) = sampled_ratio(&drive);
        let ripple = highest - lowest;
        case.judge("range of the speed ratio", "", ripple, row[2], tolerance);
        let error = drive.transmission_error_range();
        let name = "range of the transmission error";
        case.judge(name, "rad", error, row[3], tolerance);
        // ptp(f = 1/2) ≈ (π/z)²
        if (fraction - 0.5).abs() < 0.1 {
            let square = (PI / row[0]).powi(2);
            assert!(
                ((most - least) / square - 1.0).abs() < 2.5 * square,
                "z = {z}"
            );
        }
    }
}

#[test]
fn links_for_a_centre_distance() {
    let case = Case::read("K15");
    let tolerance = Absolute(case.number("tolerance"));
    // The printed digits.
    let digits = Absolute(1e-9);
    let pitch = 0.01905;
    for row in case.table("expected.table") {
        let drive = TwoWheels {
            teeth: [count(row[0]), count(row[1])],
            pitch,
        };
        let centre = row[2] * pitch;
        let links = drive.links(centre).unwrap();
        case.judge("links", "", links, row[3], digits);
        let approximate = drive.links_catalogue(centre);
        let name = "links by the formula of catalogues";
        case.judge(name, "", approximate, row[4], tolerance);
        let again = drive.centre_distance(row[3]).unwrap() / pitch;
        case.judge("centre distance", "p", again, row[2], digits);
    }
    let number =
        |i: usize, name: &str| case.number(&format!("expected.published_checks.{i}.{name}"));
    let published = |quantity: &str, unit: &str, found, i, name: &str, tolerance| {
        let quantity = format!("{quantity}, printed in a textbook");
        case.judge(&quantity, unit, found, number(i, name), Absolute(tolerance));
    };
    let drive = TwoWheels {
        teeth: [count(number(0, "z1")), count(number(0, "z2"))],
        pitch,
    };
    let approximate = drive.links_catalogue(number(0, "centre_pitches") * pitch);
    let name = "links by the formula of catalogues";
    published(name, "", approximate, 0, "approximate_links", 5e-3);
    let drive = TwoWheels {
        teeth: [count(number(1, "z1")), count(number(1, "z2"))],
        pitch,
    };
    let links = number(1, "links");
    let approximate = drive.centre_distance_catalogue(links) / pitch;
    let name = "centre distance by the formula of catalogues";
    let key = "approximate_centre_pitches";
    published(name, "p", approximate, 1, key, 5e-4);
    let exact = drive.centre_distance(links).unwrap() / pitch;
    let name = "centre distance";
    published(name, "p", exact, 1, "exact_centre_pitches", 5e-6);
}

#[test]
fn wrapping_length_over_a_tooth() {
    for id in ["K16", "K17", "K19"] {
        let case = Case::read(id);
        let drive = drive(&case);
        let judge = |quantity: &str, found, expected| {
            let tolerance = Absolute(case.number("tolerance"));
            case.judge(quantity, "p", found, expected, tolerance);
        };
        for (i, row) in (0_u32..).zip(case.table("expected.table_f_L")) {
            let length = drive.wrapping_length(f64::from(i) / 12.0).unwrap();
            judge("wrapping length", length, row[1]);
        }
        // The mean and the extremes of the reference are those of 240 samples a tooth.
        let lengths: Vec<f64> = (0..240)
            .map(|i| drive.wrapping_length(f64::from(i) / 240.0).unwrap())
            .collect();
        let mean = lengths.iter().sum::<f64>() / 240.0;
        let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let most = lengths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (quantity, found, key) in [
            ("mean wrapping length", mean, "mean"),
            ("least wrapping length", least, "min"),
            ("greatest wrapping length", most, "max"),
        ] {
            judge(quantity, found, case.number(&format!("expected.{key}")));
        }
    }
}

#[test]
fn seating_speed_on_the_ansi_form() {
    let case = Case::read("I01");
    let judge = |quantity: &str, unit: &str, found, expected| {
        let tolerance = Relative(case.number("tolerance"));
        case.judge(quantity, unit, found, expected, tolerance);
    };
    for row in case.table("expected.table") {
        let (teeth, pitch, omega) = (count(row[0]), row[1], row[2] * TAU / 60.0);
        judge("speed of seating, p ω", "m/s", pitch * omega, row[3]);
        let angles = PressureAngles::ansi(teeth).unwrap();
        for (i, angle) in [angles.least, angles.mean, angles.most]
            .into_iter()
            .enumerate()
        {
            judge("pressure angle", "deg", angle.to_degrees(), row[4 + i]);
            let speed = pitch * omega * PressureAngles::normal_speed(teeth, angle);
            judge("speed along the normal", "m/s", speed, row[7 + i]);
        }
        let frequency = mesh_frequency(teeth, omega);
        judge("mesh frequency", "Hz", frequency, row[10]);
    }
}

#[test]
fn seating_velocity_with_the_rotation_of_the_span() {
    for id in ["I02", "I03", "I04"] {
        let case = Case::read(id);
        let judge = |quantity: &str, unit: &str, found, key: &str, tolerance: f64| {
            let expected = case.number(&format!("expected.{key}"));
            case.judge(quantity, unit, found, expected, Absolute(tolerance));
        };
        let tolerance = case.number("tolerance");
        let seating = drive(&case).seating_velocity();
        let name = "seating velocity";
        judge(name, "p ω₁", seating.relative, "v_rel_over_p_w1", tolerance);
        let name = "rate of the span's direction";
        judge(name, "ω₁", seating.span_rate, "psid_over_w1", tolerance);
        let (name, key) = ("seat of the driven wheel", "phiB_at_seating");
        judge(name, "rad", seating.driven_seat, key, tolerance);
        let links = f64::from(seating.links);
        judge("links of the span", "", links, "n", 0.0);
    }
}

#[test]
fn impossible_drives_are_refused() {
    let new = PolygonAction::new;
    assert!(matches!(
        new(17, 17, 0.0127, 0.05),
        Err(GeometryError::WheelsOverlap { .. })
    ));
    assert!(matches!(
        new(2, 17, 0.0127, 0.5),
        Err(GeometryError::OutOfRange { .. })
    ));
    for broken in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        assert!(new(17, 17, broken, 0.5).is_err());
        assert!(new(17, 17, 0.0127, broken).is_err());
        assert!(ChordalAction::new(17, broken).is_err());
    }
    assert!(ChordalAction::new(2, 0.0127).is_err());
    assert!(PressureAngles::ansi(4).is_err());
    let drive = new(17, 17, 0.0127, 0.3).unwrap();
    assert!(drive.wrapping_length(f64::NAN).is_err());
    assert!(drive.driven(f64::NAN).ratio.is_nan());
}

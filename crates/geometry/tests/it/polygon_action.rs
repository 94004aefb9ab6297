//! Polygon action against closed forms computed elsewhere, one folder of `tests/validation` a case.
//!
//! The tables give, over one tooth of the driver from the moment a roller has seated, the turn of
//! the driven wheel, the speed ratio over its mean, its rate, the direction of the span and its
//! number of links. They carry twelve digits.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "test code outside of test functions"
)]

use std::f64::consts::{PI, TAU};
use std::path::Path;

use chaindrive_geometry::{
    ChordalAction, GeometryError, PolygonAction, PressureAngles, TwoWheels, mesh_frequency,
};
use serde_json::Value;

const KINEMATICS: [&str; 8] = ["K02", "K03", "K05", "K07", "K08", "K10", "K12", "K13"];

/// One folder of `tests/validation`.
struct Case(Value);

impl Case {
    fn read(id: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../tests/validation")
            .join(id);
        let text = std::fs::read_to_string(folder.join("reference.json")).unwrap();
        let case: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(case["id"], id);
        Self(case)
    }

    fn tolerance(&self) -> f64 {
        self.0["tolerance"].as_f64().unwrap()
    }

    fn input(&self, name: &str) -> f64 {
        self.0["inputs"][name].as_f64().unwrap()
    }

    fn expected(&self, name: &str) -> f64 {
        self.0["expected"][name].as_f64().unwrap()
    }

    fn rows(&self, table: &str) -> Vec<Vec<f64>> {
        let rows = self.0["expected"][table].as_array().unwrap();
        let numbers = |row: &Value| {
            row.as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect()
        };
        rows.iter().map(numbers).collect()
    }

    fn drive(&self) -> PolygonAction {
        let teeth = |name| count(self.input(name));
        PolygonAction::new(
            teeth("z1"),
            teeth("z2"),
            self.input("pitch"),
            self.input("C"),
        )
        .unwrap()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts in a table"
)]
fn count(number: f64) -> u32 {
    number.round() as u32
}

/// Largest deviation from a reference, for the report.
struct Deviation {
    what: String,
    tolerance: f64,
    worst: f64,
}

impl Deviation {
    fn new(what: impl Into<String>, tolerance: f64) -> Self {
        Self {
            what: what.into(),
            tolerance,
            worst: 0.0,
        }
    }

    #[track_caller]
    fn note(&mut self, got: f64, expected: f64) {
        let error = (got - expected).abs();
        let what = &self.what;
        assert!(
            error <= self.tolerance,
            "{what}: got {got}, expected {expected}, off by {error:e}"
        );
        self.worst = self.worst.max(error);
    }

    /// Deviation relative to the expected value.
    #[track_caller]
    fn note_relative(&mut self, got: f64, expected: f64) {
        self.note(got / expected, 1.0);
    }
}

impl Drop for Deviation {
    fn drop(&mut self) {
        println!(
            "{}: largest deviation {:.1e}, allowed {:.0e}",
            self.what, self.worst, self.tolerance
        );
    }
}

#[test]
fn chordal_action_of_one_sprocket() {
    let case = Case::read("K01");
    let mut deviation = Deviation::new("K01", case.tolerance());
    let pitch = 0.0254;
    for row in case.rows("table") {
        let action = ChordalAction::new(count(row[0]), pitch).unwrap();
        deviation.note_relative(action.pitch_diameter / pitch, row[1]);
        deviation.note_relative(action.speed_ratio, row[2]);
        deviation.note_relative(100.0 * action.nonuniformity(), row[3]);
        deviation.note_relative(action.rise / pitch, row[4]);
        // v_mean = z p ω / 2π against v_max = R ω
        let mean = row[0] * pitch / TAU / (0.5 * action.pitch_diameter);
        deviation.note_relative(action.mean_speed_ratio, mean);
    }
}

#[test]
fn linkage_reproduces_the_tables() {
    for id in KINEMATICS {
        let case = Case::read(id);
        let drive = case.drive();
        let mut deviation = Deviation::new(id, case.tolerance());
        let period = TAU / case.input("z1");
        deviation.note(drive.radii()[0], case.input("R1"));
        deviation.note(drive.radii()[1], case.input("R2"));
        for (i, row) in (0_u32..).zip(case.rows("table")) {
            let phase = f64::from(i) / 12.0;
            deviation.note(phase, row[0]);
            let state = drive.driven(phase * period);
            deviation.note(state.angle, row[1]);
            deviation.note(state.ratio / drive.mean_ratio(), row[2]);
            deviation.note(state.ratio_rate, row[3]);
            deviation.note(state.span_angle, row[4]);
            assert_eq!(state.links, count(row[5]), "{id} at phase {phase}");
        }
    }
}

/// The reference took its extremes from 20 000 samples a tooth; the exact ones enclose them.
#[test]
fn extremes_enclose_the_sampled_ones() {
    for id in KINEMATICS {
        let case = Case::read(id);
        let drive = case.drive();
        let summary = |name: &str| case.0["expected"]["summary"][name].as_f64().unwrap();
        let mut deviation = Deviation::new(format!("{id}, extremes"), case.tolerance());
        let (lowest, highest) = sampled_ratio(&drive);
        deviation.note(lowest / drive.mean_ratio(), summary("ratio_norm_min"));
        deviation.note(highest / drive.mean_ratio(), summary("ratio_norm_max"));
        deviation.note(drive.transmission_error_range(), summary("te_ptp_rad"));
        let period = TAU / case.input("z1");
        let rates =
            (0..20_000).map(|i| drive.driven(period * f64::from(i) / 20e3).ratio_rate.abs());
        // The greatest rate is that of the sample next to a jump: the begin of the samples shows.
        let mut rate = Deviation::new(format!("{id}, greatest rate"), 1e-8);
        rate.note(rates.fold(0.0, f64::max), summary("max_abs_dratio"));
        let (least, most) = drive.ratio_extremes();
        assert!(least < lowest + 1e-14 && lowest - least < 1e-9);
        assert!(most > highest - 1e-14 && most - highest < 1e-5);
        assert_eq!(drive.driven(0.0).links, count(summary("n_after_seating")));
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
    let mut ratio = Deviation::new("K14 ratio", case.tolerance());
    let mut error = Deviation::new("K14 transmission error", case.tolerance());
    let mut parallelogram = Deviation::new("K14 parallelogram", 1e-13);
    let pitch = 0.0127;
    for row in case.rows("table") {
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
            parallelogram.note(most - least, 0.0);
            parallelogram.note(drive.transmission_error_range(), 0.0);
        }
        let (lowest, highest) = sampled_ratio(&drive);
        ratio.note(highest - lowest, row[2]);
        error.note(drive.transmission_error_range(), row[3]);
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
    let mut deviation = Deviation::new("K15", case.tolerance());
    let mut digits = Deviation::new("K15 to the printed digits", 1e-9);
    let pitch = 0.01905;
    for row in case.rows("table") {
        let drive = TwoWheels {
            teeth: [count(row[0]), count(row[1])],
            pitch,
        };
        let centre = row[2] * pitch;
        deviation.note(drive.links(centre).unwrap(), row[3]);
        deviation.note(drive.links_catalogue(centre), row[4]);
        digits.note(drive.links(centre).unwrap(), row[3]);
        digits.note(drive.centre_distance(row[3]).unwrap() / pitch, row[2]);
    }
    let checks = &case.0["expected"]["published_checks"];
    let number = |i: usize, name: &str| checks[i][name].as_f64().unwrap();
    let drive = TwoWheels {
        teeth: [count(number(0, "z1")), count(number(0, "z2"))],
        pitch,
    };
    let approximate = drive.links_catalogue(number(0, "centre_pitches") * pitch);
    assert!((approximate - number(0, "approximate_links")).abs() < 5e-3);
    let drive = TwoWheels {
        teeth: [count(number(1, "z1")), count(number(1, "z2"))],
        pitch,
    };
    let links = number(1, "links");
    let approximate = drive.centre_distance_catalogue(links) / pitch;
    assert!((approximate - number(1, "approximate_centre_pitches")).abs() < 5e-4);
    let exact = drive.centre_distance(links).unwrap() / pitch;
    assert!((exact - number(1, "exact_centre_pitches")).abs() < 5e-6);
}

#[test]
fn wrapping_length_over_a_tooth() {
    for id in ["K16", "K17", "K19"] {
        let case = Case::read(id);
        let drive = case.drive();
        let mut deviation = Deviation::new(id, case.tolerance());
        for (i, row) in (0_u32..).zip(case.rows("table_f_L")) {
            deviation.note(drive.wrapping_length(f64::from(i) / 12.0).unwrap(), row[1]);
        }
        // The mean and the extremes of the reference are those of 240 samples a tooth.
        let lengths: Vec<f64> = (0..240)
            .map(|i| drive.wrapping_length(f64::from(i) / 240.0).unwrap())
            .collect();
        let mean = lengths.iter().sum::<f64>() / 240.0;
        let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let most = lengths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut sampled = Deviation::new(
            format!("{id}, mean and extremes of samples"),
            case.tolerance(),
        );
        sampled.note(mean, case.expected("mean"));
        sampled.note(least, case.expected("min"));
        sampled.note(most, case.expected("max"));
    }
}

#[test]
fn seating_speed_on_the_ansi_form() {
    let case = Case::read("I01");
    let mut deviation = Deviation::new("I01", case.tolerance());
    for row in case.rows("table") {
        let (teeth, pitch, omega) = (count(row[0]), row[1], row[2] * TAU / 60.0);
        deviation.note_relative(pitch * omega, row[3]);
        let angles = PressureAngles::ansi(teeth).unwrap();
        for (i, angle) in [angles.least, angles.mean, angles.most]
            .into_iter()
            .enumerate()
        {
            deviation.note_relative(angle.to_degrees(), row[4 + i]);
            deviation.note_relative(
                pitch * omega * PressureAngles::normal_speed(teeth, angle),
                row[7 + i],
            );
        }
        deviation.note_relative(mesh_frequency(teeth, omega), row[10]);
    }
}

#[test]
fn seating_velocity_with_the_rotation_of_the_span() {
    for id in ["I02", "I03", "I04"] {
        let case = Case::read(id);
        let mut deviation = Deviation::new(id, case.tolerance());
        let seating = case.drive().seating_velocity();
        deviation.note(seating.relative, case.expected("v_rel_over_p_w1"));
        deviation.note(seating.span_rate, case.expected("psid_over_w1"));
        deviation.note(seating.driven_seat, case.expected("phiB_at_seating"));
        assert_eq!(seating.links, count(case.expected("n")));
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

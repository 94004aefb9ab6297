//! Coverage and width of intervals, of noise, of what repeats, and of both.

use std::f64::consts::{PI, TAU};

use super::*;

/// Numbers that look normal and are the same every time.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        // xorshift64* (Vigna 2016)
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Sum of twelve: variance 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// x ← φ x + e, which has the mean 0, in the steady state from the first one on.
fn series(seed: u64, phi: f64, count: usize) -> impl Iterator<Item = f64> {
    let mut noise = Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut x = noise.normal() / (1.0 - phi * phi).sqrt();
    (0..count).map(move |_| {
        x = phi * x + noise.normal();
        x
    })
}

/// Of values that are one apart; what repeats has a period of so many.
fn of(values: impl Iterator<Item = f64>, period: f64, scale: f64) -> Steadiness {
    let mut blocks = Blocks::new(1.0, period, 1, &[]);
    values.enumerate().for_each(|(i, value)| {
        let i = i as f64;
        blocks.push([(i - 0.5).max(0.0), i + 0.5], value, &[]);
    });
    blocks.steadiness(scale).unwrap()
}

const STATISTICS: [fn(&Steadiness) -> ConfidenceInterval; 4] =
    [|it| it.mean, |it| it.deviation, |it| it.p1, |it| it.p99];

/// Shares of the intervals that hold what is true, their median half widths, and the 95 % quantiles of the true errors.
fn judged(true_values: [f64; 4], found: impl Iterator<Item = Steadiness>) -> [[f64; 3]; 4] {
    let found: Vec<Steadiness> = found.collect();
    std::array::from_fn(|k| {
        let known: Vec<ConfidenceInterval> = found.iter().map(STATISTICS[k]).collect();
        let mut errors: Vec<f64> = known
            .iter()
            .map(|it| (it.value - true_values[k]).abs())
            .collect();
        let held = known
            .iter()
            .zip(&errors)
            .filter(|(it, error)| **error <= it.half_width);
        let share = held.count() as f64 / known.len() as f64;
        let mut widths: Vec<f64> = known.iter().map(|it| it.half_width).collect();
        widths.sort_by(f64::total_cmp);
        errors.sort_by(f64::total_cmp);
        [
            share,
            widths[widths.len() / 2],
            errors[errors.len() * 95 / 100],
        ]
    })
}

/// Noise of any correlation: intervals hold the true statistics as often as they say, and are no wider than they need be. The 2.326 σ of a
/// normal distribution are its quantiles. Intervals ten times as wide, or a third, fail.
#[test]
fn intervals_hold_as_often_as_they_say() {
    for (phi, count) in [(0.0_f64, 600), (0.5, 1500), (0.9, 5000), (0.98, 25_000)] {
        let sigma = 1.0 / (1.0 - phi * phi).sqrt();
        let quantile = 2.326_348 * sigma;
        let true_values = [0.0, sigma, -quantile, quantile];
        let seeds = 1..=(1_500_000 / count as u64).min(300);
        let found = judged(
            true_values,
            seeds.map(|seed| of(series(seed, phi, count), 25.0, 1e-9)),
        );
        for (k, [share, width, error]) in found.into_iter().enumerate() {
            // Of noise they hold more than of drives, whose drifts they are made for; that they are not too wide, the ratio tells.
            assert!(share > 0.88, "φ {phi}, {k}: {share}");
            let ratio = width / error;
            assert!((0.6..2.0).contains(&ratio), "φ {phi}, {k}: {ratio}");
        }
    }
}

/// A motion that repeats, with the teeth upon it, begun anywhere and ended anywhere: statistics are those of whole periods, and intervals no
/// wider than a few times what is true, however few periods there are.
#[test]
fn what_repeats_is_known_from_three_periods_on() {
    for (periods, widest) in [(3.4, 3.0), (7.77, 3.0), (38.2, 1.5), (120.6, 1.5)] {
        let period = 61.7;
        let wave = |i: usize, phase: f64| {
            let turn = TAU * i as f64 / period + phase;
            20.0 + 5.0 * turn.sin() + 2.0 * (7.0 * turn).cos()
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count"
        )]
        let count = (periods * period) as usize;
        // σ² = ½ Σ A²
        let sigma = f64::sqrt(0.5 * (25.0 + 4.0));
        let of_phase = |phase: f64| of((0..count).map(|i| wave(i, phase)), period, 20.0);
        let phases = || (0..100_u32).map(f64::from);
        let means = phases()
            .map(of_phase)
            .map(|it| (it.mean.value - 20.0).abs());
        let worst = means.fold(0.0, f64::max);
        // The mean of all samples errs by up to A/(π m).
        assert!(worst < 0.02 * 5.0 / (PI * periods), "{periods}: {worst}");
        let found = judged([20.0, sigma, f64::NAN, f64::NAN], phases().map(of_phase));
        for ([share, width, error], least) in found.into_iter().zip(LEAST_WIDTH).take(2) {
            assert!(share >= 0.88, "{periods} periods: {share}");
            let least = least * 20.0;
            assert!(width < widest * error.max(least), "{width}, {error}");
        }
    }
}

/// Statistics of values that are one apart, in blocks of a period, with waves of other periods.
fn with_waves(
    values: impl Iterator<Item = f64>,
    period: f64,
    together: usize,
    forcings: &[f64],
) -> Steadiness {
    let mut blocks = Blocks::new(1.0, period, together, forcings);
    for (i, value) in values.enumerate() {
        let i = i as f64;
        let phases = forcings.iter().map(|period| (TAU * i / period).sin_cos());
        let harmonics: Vec<f64> = phases.flat_map(|(s, c)| [c, s]).collect();
        blocks.push([(i - 0.5).max(0.0), i + 0.5], value, &harmonics);
    }
    blocks.steadiness(1.0).unwrap()
}

/// Orders 4 and 7 of a shaft over two turns: eight periods of order 4, of which none is whole for order 7. What repeats is no chance: mean and
/// standard deviation, √(½ Σ A²), are known as well as those of one order alone. Told nothing of order 7, they are not.
#[test]
fn waves_of_other_orders_are_told_from_the_mean() {
    let turn = 1400.0_f64;
    let sigma = f64::sqrt(0.5 * (1.0 + 4.0));
    for phase in (0..10_u32).map(|it| 0.7 * f64::from(it)) {
        let wave = |i: u32| {
            let angle = TAU * f64::from(i) / turn;
            50.0 + (4.0 * angle).sin() + 2.0 * (7.0 * angle + phase).cos()
        };
        let values = || (0..2964).map(wave);
        let blind = with_waves(values(), turn / 4.0, 4, &[]);
        let told = with_waves(values(), turn / 4.0, 4, &[turn / 4.0, turn / 7.0]);
        let error = |it: ConfidenceInterval, right: f64| (it.value - right).abs();
        assert!(error(told.mean, 50.0) < 1e-3, "{phase}: {told:?}");
        assert!(error(told.deviation, sigma) < 1e-3, "{phase}: {told:?}");
        assert!(told.mean.half_width < 2e-3 && blind.mean.half_width > 0.05);
        assert!(told.deviation.half_width < 0.1 * blind.deviation.half_width);
        assert!(error(blind.mean, 50.0) < blind.mean.half_width);
    }
}

/// From three turns on there are blocks in which all orders are whole: quantiles are known too, whatever waves are told.
#[test]
fn blocks_are_joined_to_what_repeats_together() {
    let turn = 1400.0_f64;
    for turns in [3.1, 5.4, 30.3] {
        let wave = |i: u32| {
            let angle = TAU * f64::from(i) / turn;
            (4.0 * angle).sin() + 2.0 * (7.0 * angle).cos()
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count"
        )]
        let count = (turns * turn) as u32;
        let found = with_waves((0..count).map(wave), turn / 4.0, 4, &[]);
        for (known, least) in STATISTICS.iter().zip(LEAST_WIDTH) {
            let half_width = known(&found).half_width;
            assert!(half_width < 5.0 * least.max(2e-3), "{turns}: {found:?}");
        }
    }
}

/// Noise with a wave upon it that blocks do not hold whole: intervals hold as often as they say, and are as narrow as without the wave.
#[test]
fn intervals_beside_waves_hold_as_often_as_they_say() {
    let (phi, count) = (0.9_f64, 600);
    let sigma = 1.0 / (1.0 - phi * phi).sqrt();
    let wave = 4.0 * sigma;
    let deviation = sigma.hypot(wave / 2_f64.sqrt());
    let of_seed = |seed: u64, size: f64| {
        let turn = move |i: usize| TAU * i as f64 / 31.7 + seed as f64;
        let values = series(seed, phi, count).enumerate();
        let values = values.map(move |(i, x)| x + size * turn(i).sin());
        with_waves(values, 50.0, 1, &[31.7])
    };
    let seeds = || 1..=300;
    let [mean, deviated, ..] = judged(
        [0.0, deviation, f64::NAN, f64::NAN],
        seeds().map(|seed| of_seed(seed, wave)),
    );
    let [alone, ..] = judged([0.0; 4], seeds().map(|seed| of_seed(seed, 0.0)));
    assert!(
        mean[0] > 0.9 && deviated[0] > 0.88,
        "{mean:?}, {deviated:?}"
    );
    assert!(
        (0.8..1.25).contains(&(mean[1] / alone[1])),
        "{mean:?}, {alone:?}"
    );
}

/// Two and a half periods of a wave do not tell it from a drift: it stays in the mean, and in the interval.
#[test]
fn no_wave_is_fitted_below_three_periods() {
    let wave = |i: u32| (TAU * f64::from(i) / 400.0).sin();
    let values = || (0..1001).map(wave);
    let blind = with_waves(values(), 100.0, 1, &[]);
    let told = with_waves(values(), 100.0, 1, &[400.0]);
    assert_eq!(blind.mean, told.mean);
    let longer = |told: &[f64]| with_waves((0..1401).map(wave), 100.0, 1, told).mean;
    assert!(longer(&[400.0]).half_width < 0.1 * longer(&[]).half_width);
}

#[test]
fn fewer_than_three_periods_say_nothing() {
    let found = of(series(3, 0.5, 299), 100.0, 1.0);
    assert!(STATISTICS.iter().all(|it| it(&found).half_width.is_nan()));
    assert!(found.mean.value.is_finite() && found.p99.value > found.mean.value);
    let found = of(series(3, 0.5, 301), 100.0, 1.0);
    assert!(STATISTICS.iter().all(|it| it(&found).half_width > 0.0));
}

/// One of three periods dips: whether 1 % of the time lies in such dips or none does, three periods do not tell, and the interval of p1 is not said to
/// be wider than all samples. Twenty periods tell. What hardly changes is known by the least width, which is wider than its samples lie apart.
#[test]
fn an_interval_is_unknown_where_it_would_be_wider_than_all_samples() {
    let dips = |i: usize, every: usize, by: f64| {
        let wave = (TAU * i as f64 / 100.0).sin();
        100.0 + wave
            - if i / 100 % every == 1 && i % 100 > 90 {
                by
            } else {
                0.0
            }
    };
    let short = of((0..301).map(|i| dips(i, 3, 20.0)), 100.0, 100.0);
    assert!(short.p1.half_width.is_nan(), "{short:?}");
    assert!(
        short.mean.half_width > 0.0 && short.p99.half_width < 22.0,
        "{short:?}"
    );
    let long = of((0..2101).map(|i| dips(i, 3, 20.0)), 100.0, 100.0);
    assert!(long.p1.half_width < 22.0, "{long:?}");
    let nearly = of(
        (0..301).map(|i| dips(i, 3, 0.0) * 1e-3 + 99.9),
        100.0,
        100.0,
    );
    assert!((nearly.p1.half_width - 0.5).abs() < 1e-3, "{nearly:?}");
}

/// A drift that counts is told, one that nobody would read is not, however sure it is.
#[test]
fn drifts_that_count_are_told() {
    let settling = |size: f64| {
        let drift =
            move |(i, x): (usize, f64)| 100.0 + 0.01 * x + size * (-(i as f64) / 3000.0).exp();
        of(series(5, 0.5, 4000).enumerate().map(drift), 50.0, 100.0)
    };
    assert!(settling(0.0).is_steady && settling(1.0).is_steady);
    assert!(!settling(20.0).is_steady);
    let growing =
        (0..4000).map(|i| (1.0 + f64::from(i) / 4000.0) * (TAU * f64::from(i) / 50.0).sin());
    assert!(!of(growing, 50.0, 1.0).is_steady, "its deviation grows");
}

/// A start that dies away is cut off, and what it does to the mean is in the interval.
#[test]
fn the_start_is_cut_off() {
    let start = |i: usize| 30.0 * (-(i as f64) / 150.0).exp();
    let noise = series(11, 0.5, 6000).enumerate();
    let found = of(noise.map(|(i, x)| 100.0 + x + start(i)), 50.0, 100.0);
    assert!(found.from > 200.0 && found.from < 3000.0, "{found:?}");
    assert!((found.settled - 100.0).abs() < 0.2, "{found:?}");
    assert!((found.mean.value - 100.0).abs() < found.mean.half_width);
}

#[test]
fn a_constant_is_known() {
    let found = of(std::iter::repeat_n(5.0, 1000), 10.0, 0.0);
    assert!(found.is_steady && found.mean.half_width.abs() < 1e-9);
    assert!((found.mean.value - 5.0).abs() < 1e-12 && found.deviation.value < 1e-9);
}

/// Published: Abramowitz and Stegun, *Handbook of Mathematical Functions*, table 26.10.
#[test]
fn students_t_is_that_of_the_tables() {
    for (freedom, t) in [
        (2.0, 4.303),
        (3.0, 3.182),
        (5.0, 2.571),
        (10.0, 2.228),
        (30.0, 2.042),
    ] {
        assert!(
            (students(freedom) - t).abs() < 2e-3,
            "{freedom}: {}",
            students(freedom)
        );
    }
}

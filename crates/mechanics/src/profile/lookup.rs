//! Long rows of features: which one a roller is on, by halving.
//!
//! Passing from feature to feature costs as many looks as a roller has features behind it. Where a row has many, as fitted
//! to measured or imported faces, the row is looked up instead:
//!
//! ```text
//!   start lines   | | | | | | | | | | | | |        while the face turns by no more than a quarter turn in all,
//!   roller at                q                     a roller near it has passed all lines behind it and none
//!   passed        + + + + + + - - - - - - -        ahead: the sign changes once, and halving finds where
//! ```
//!
//! Let s be the start of a feature with direction t, and f the foot of a roller at q with d = |q − f|, a feature before it. Then
//! (s − q)·t = ∫ t′·t ds′ − (q − f)·t from f to s. Directions t′ within a quarter turn of t make the first term grow with the way; the second is
//! at most d sin of the turn, and a hollow that takes the roller in has a longer way for its turn. A row that turns by more is cut
//! into *reaches* of a quarter turn each, which are passed one after the other.

use std::f64::consts::FRAC_PI_2;

use chaindrive_geometry::{Point, Vector};
use pulp::Simd;

use super::{Feature, LaneFeatures, Profile};
use crate::lanes::{LANES, Lane, Wide};

/// Rows longer than this are looked up for every roller. Nanoseconds a roller, with eight rollers side by side (see the test
/// `rows_and_lookups_take_their_time`):
///
/// ```text
/// pieces                4    12    24    48   100   300  1000
/// row                   6    10    14    23    45   142   500
/// halving              31    36    37    38    43    50    86
/// tree of the curve   120   152   150   190   240   295   350
/// ```
pub(super) const LONG: usize = 96;

/// Rows longer than this are looked up for plates, which ask feature by feature.
pub(super) const FEW: usize = 8;

/// Where every reach of a row ends: the index after its last feature.
pub(super) fn reaches(features: &[Feature]) -> Box<[usize]> {
    let mut ends = Vec::new();
    // Heading since the reach began, and its least and largest.
    let mut heading = [0.0_f64; 3];
    for (index, pair) in features.windows(2).enumerate() {
        heading[0] += turn(pair[0].along, pair[1].along);
        heading[1] = heading[1].min(heading[0]);
        heading[2] = heading[2].max(heading[0]);
        if heading[2] - heading[1] > FRAC_PI_2 {
            ends.push(index + 1);
            heading = [0.0; 3];
        }
    }
    ends.push(features.len());
    ends.into()
}

fn turn(from: Vector, to: Vector) -> f64 {
    from.perp(&to).atan2(from.dot(&to))
}

impl Profile {
    /// Index of the feature that a place belongs to, by halving.
    #[inline]
    pub(super) fn feature_at(&self, x: f64, y: f64) -> usize {
        let passed = |index: usize| {
            let f = &self.features[index];
            (x - f.start.x) * f.along.x + (y - f.start.y) * f.along.y > 0.0
        };
        let mut low = 0;
        for &end in &self.reaches {
            // The first feature has no line before it.
            let last = end - 1;
            if end < self.features.len() && (last == 0 || passed(last)) && passed(end) {
                low = end;
                continue;
            }
            let mut high = end;
            while high - low > 1 {
                let middle = low + (high - low) / 2;
                if passed(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            break;
        }
        low
    }

    /// Indices of the features that a straight line from `a` to `b` passes.
    pub(crate) fn features_along(&self, a: Point, b: Point) -> std::ops::Range<usize> {
        if self.reaches.is_empty() {
            return 0..self.features.len();
        }
        let [a, b] = [a, b].map(|p| self.feature_at(p.x, p.y));
        a.min(b)..a.max(b) + 1
    }

    /// The features that any of the straight lines of a lane passes, from and to its two places.
    #[inline(always)]
    pub(crate) fn passed_by<S: Simd>(&self, ends: [[Lane<S>; 2]; 2]) -> &[Feature] {
        if self.reaches.is_empty() {
            return &self.features;
        }
        let ends = ends.map(|end| end.map(Lane::numbers));
        self.passed_by_any(Wide::<S>::COUNT, &ends)
    }

    /// The same from the numbers of the lanes; kept out of line, since few rows are so long.
    #[inline(never)]
    fn passed_by_any(&self, count: usize, ends: &[[[f64; LANES]; 2]; 2]) -> &[Feature] {
        let (mut first, mut behind) = (self.features.len(), 0);
        for [x, y] in ends {
            for (x, y) in x.iter().zip(y).take(count) {
                let feature = self.feature_at(*x, *y);
                first = first.min(feature);
                behind = behind.max(feature + 1);
            }
        }
        &self.features[first..behind]
    }

    /// The features that circles at (x, y) belong to, looked up one after the other.
    #[inline(always)]
    pub(super) fn looked_up<S: Simd>(&self, w: Wide<S>, [x, y]: [Lane<S>; 2]) -> LaneFeatures<S> {
        let [mut at_x, mut at_y] = [[0.0; LANES]; 2];
        x.store(&mut at_x, 0);
        y.store(&mut at_y, 0);
        let mut found = [[0.0; LANES]; 6];
        self.look_up(&at_x[..Wide::<S>::COUNT], &at_y, &mut found);
        let [cx, cy, radius, sign, mx, my] = found.map(|numbers| w.load(&numbers, 0));
        LaneFeatures {
            centre: [cx, cy],
            radius,
            sign,
            straight: [mx, my],
        }
    }

    /// Kept out of line: it is scalar, and the same for every kind of processor.
    #[inline(never)]
    fn look_up(&self, x: &[f64], y: &[f64; LANES], found: &mut [[f64; LANES]; 6]) {
        for (k, (&x, &y)) in x.iter().zip(y).enumerate() {
            let f = &self.features[self.feature_at(x, y)];
            let numbers = [
                f.centre.x,
                f.centre.y,
                f.radius,
                f.sign,
                f.straight.x,
                f.straight.y,
            ];
            for (lane, number) in found.iter_mut().zip(numbers) {
                lane[k] = number;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::hint::black_box;
    use std::time::Instant;

    use chaindrive_geometry::{Arc, ArcSpline, Piece};
    use chaindrive_integrate::{Registers, kernel};
    use pulp::WithSimd;

    use super::*;

    const RADIUS: f64 = 0.01;

    /// Numbers that look random and are the same every time.
    struct Dice(u64);

    impl Dice {
        fn between(&mut self, low: f64, high: f64) -> f64 {
            // splitmix64
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// A face like one fitted to measured points: tangent arcs, bulging and hollow, whose heading stays within `spread` of its
    /// mean and follows half a wave on top of it.
    fn measured(count: usize, spread: f64, wave: f64, dice: &mut Dice) -> Vec<Piece> {
        let (mut at, mut heading) = (Point::origin(), 0.0);
        let mut pieces = Vec::new();
        for k in 0..count {
            let aim = wave * (PI * k as f64 / count as f64).sin() + dice.between(-spread, spread);
            let sweep = if (aim - heading).abs() < 1e-3 {
                1e-3
            } else {
                aim - heading
            };
            // Hollows hold the roller with room to spare.
            let radius = dice.between(1.5, 12.0) * RADIUS;
            let left = Vector::new(-heading.sin(), heading.cos()) * sweep.signum();
            let arc = Arc {
                centre: at + left * radius,
                radius,
                start_angle: (-left.y).atan2(-left.x),
                sweep,
            };
            pieces.push(arc.into());
            (at, heading) = (arc.point(1.0), heading + sweep);
        }
        pieces
    }

    /// Places near a face, as rollers in contact and about to be have them.
    fn places(face: &ArcSpline, count: usize, dice: &mut Dice) -> Vec<Point> {
        (0..count)
            .map(|_| {
                let on = face.point_at(dice.between(-0.02, 1.02) * face.length());
                let foot = face.nearest(on, 1.0).expect("on the face");
                let tangent = Vector::new(-foot.normal.y, foot.normal.x);
                let off = dice.between(0.6, 1.4) * RADIUS;
                on + foot.normal * off + tangent * dice.between(-0.3, 0.3) * RADIUS
            })
            .collect()
    }

    kernel!(
        /// Both ways of choosing, side by side.
        fn both<'a, S: Simd>(w: Wide<S>, profile: &'a Profile, places: &'a [Point]) {
            for eight in places.chunks_exact(LANES) {
                let [mut x, mut y] = [[0.0; LANES]; 2];
                for (k, p) in eight.iter().enumerate() {
                    (x[k], y[k]) = (p.x, p.y);
                }
                for start in (0..LANES).step_by(Wide::<S>::COUNT) {
                    let at = [w.load(&x, start), w.load(&y, start)];
                    let chosen = [profile.looked_up(w, at), profile.passed(w, at)];
                    let [a, b] = chosen.map(|chosen| {
                        let nearest = profile.facing(w, at, chosen, RADIUS);
                        [nearest.gap, nearest.nx, nearest.ny, nearest.bend]
                    });
                    for (a, b) in a.into_iter().zip(b) {
                        let apart = (a - b).abs().largest();
                        assert!(apart <= 1e-12, "{apart} at {:?}", &eight[start]);
                    }
                }
            }
        }
    );

    /// Looking up finds what passing from feature to feature finds, and both what the exact curve finds; in lanes of every width,
    /// on faces within a quarter turn and on such as turn by much more.
    #[test]
    fn looking_up_finds_what_the_row_finds() {
        let mut dice = Dice(5);
        let mut compared = 0;
        for count in [9, 60, 200, 1000] {
            for (spread, wave) in [
                (0.05, 0.0),
                (0.3, 0.0),
                (0.05, 1.2),
                (0.02, 2.2),
                (0.02, -2.0),
            ] {
                let pieces = measured(count, spread, wave, &mut dice);
                let face = ArcSpline::open(&pieces).expect("a face");
                let profile = Profile::new(&pieces, true, true);
                let places: Vec<Point> = places(&face, 800, &mut dice)
                    .into_iter()
                    .filter(|p| {
                        // Where a roller reaches two parts of the face at once, rows are not meant to be used.
                        let exact = face.nearest(*p, 1.0).expect("near").distance;
                        let w = Wide(pulp::Scalar);
                        let at = [w.splat(p.x), w.splat(p.y)];
                        let row = profile.facing(w, at, profile.passed(w, at), 0.0);
                        (row.gap.sum() - exact).abs() < 1e-9
                    })
                    .collect();
                compared += places.len();
                let both = || both(&profile, &places);
                Registers::in_use().dispatch(both());
                both().with_simd(pulp::Scalar);
                both().with_simd(pulp::Scalar512b);
            }
        }
        assert!(compared > 12_000, "{compared} of 16 000 places");
    }

    /// A plate sees the same place whether all features are asked or those between its pins.
    #[test]
    fn lines_pass_the_features_between_their_ends() {
        let mut dice = Dice(9);
        let pieces = measured(300, 0.1, 0.8, &mut dice);
        let face = ArcSpline::open(&pieces).expect("a face");
        let profile = Profile::new(&pieces, true, true);
        let middle = |k: usize| {
            let piece = &pieces[k];
            piece.point(0.5) + piece.normal(0.5) * RADIUS
        };
        for k in 3..280 {
            let along = profile.features_along(middle(k), middle(k + 9));
            // One corner stands before the first piece.
            assert_eq!(along, k + 1..k + 11);
            let back = profile.features_along(middle(k + 9), middle(k));
            assert_eq!(back, along);
        }
        let beyond = face.point_at(0.0) - Vector::new(1.0, 0.0);
        assert_eq!(profile.features_along(beyond, middle(4)), 0..6);
        let short = Profile::new(&pieces[..5], true, true);
        assert_eq!(short.features_along(middle(0), middle(1)), 0..7);
    }

    kernel!(
        fn timed<'a, S: Simd>(
            w: Wide<S>,
            profile: &'a Profile,
            halving: bool,
            places: &'a [Point],
        ) -> f64 {
            let x: Vec<f64> = places.iter().map(|p| p.x).collect();
            let y: Vec<f64> = places.iter().map(|p| p.y).collect();
            let mut sum = w.splat(0.0);
            for start in (0..x.len()).step_by(Wide::<S>::COUNT) {
                let at = [w.load(&x, start), w.load(&y, start)];
                let chosen = if halving {
                    profile.looked_up(w, at)
                } else {
                    profile.passed(w, at)
                };
                sum += profile.facing(w, at, chosen, RADIUS).gap;
            }
            sum.sum()
        }
    );

    /// Nanoseconds a roller on rows of more and more features, passed and looked up. Rollers lie side by side along the whole face.
    #[test]
    #[ignore = "a measurement: cargo test -p chaindrive-mechanics --lib rows_and -- --ignored --nocapture"]
    fn rows_and_lookups_take_their_time() {
        let mut dice = Dice(1);
        let mut last = [0.0; 2];
        for count in [4, 8, 12, 16, 24, 32, 48, 100, 300, 1000] {
            let pieces = measured(count, 0.05, 0.3, &mut dice);
            let face = ArcSpline::open(&pieces).expect("a face");
            let mut profile = Profile::new(&pieces, true, true);
            profile.reaches = reaches(&profile.features);
            let rollers = 1024;
            let places: Vec<Point> = (0..rollers)
                .map(|k| {
                    let s = (f64::from(k) + 0.5) / f64::from(rollers) * face.length();
                    let foot = face.nearest(face.point_at(s), 1.0).expect("on the face");
                    foot.point + foot.normal * RADIUS
                })
                .collect();
            let time = |halving: bool| {
                let once = || {
                    let start = Instant::now();
                    for _ in 0..20 {
                        black_box(Registers::in_use().dispatch(timed(
                            black_box(&profile),
                            halving,
                            &places,
                        )));
                    }
                    start.elapsed().as_secs_f64() / 20.0 / f64::from(rollers) * 1e9
                };
                (0..15).map(|_| once()).fold(f64::INFINITY, f64::min)
            };
            let tree = {
                let once = || {
                    let start = Instant::now();
                    for p in &places {
                        black_box(face.nearest(black_box(*p), 1.5 * RADIUS));
                    }
                    start.elapsed().as_secs_f64() / f64::from(rollers) * 1e9
                };
                (0..15).map(|_| once()).fold(f64::INFINITY, f64::min)
            };
            last = [time(false), time(true)];
            println!(
                "{count:5} pieces: row {:7.1} ns, lookup {:7.1} ns, tree {tree:7.1} ns",
                last[0], last[1]
            );
        }
        assert!(last[1] < 0.3 * last[0], "{last:?}");
    }
}

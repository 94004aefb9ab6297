//! Courses of what somebody sets while a drive moves: jumps, ramps, and how they go on.

use chaindrive_integrate::slack;
use serde::{Deserialize, Serialize};

use crate::kinematics::Kinematics;

/// Course of an input from the moment on at which it is set.
///
/// ```text
/// x(t) = x₀ + (x₁ − x₀) (t − t₀)/T      until t₀ + T      x₀: what it is at t₀
/// x(t) = x₁ + r (t − t₀ − T)            from then on
/// ```
///
/// A number alone is a jump to a value that holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// Value x₁, in the unit of the input.
    pub to: f64,
    /// Duration T of the ramp \[s\], zero for a jump.
    pub over: f64,
    /// Rate r after the ramp, in the unit of the input per second.
    pub rate: f64,
}

impl From<f64> for Course {
    fn from(to: f64) -> Self {
        Self {
            to,
            ..Self::default()
        }
    }
}

/// A value on its course.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ramp {
    from: f64,
    since: f64,
    course: Course,
}

impl Ramp {
    /// On from a value at a time \[s\].
    pub(crate) fn new(from: f64, since: f64, course: Course) -> Self {
        Self {
            from,
            since,
            course,
        }
    }

    /// The value at a time \[s\].
    #[inline]
    pub(crate) fn at(&self, t: f64) -> f64 {
        let Course { to, over, rate } = self.course;
        let after = t - self.since;
        if after < over {
            self.from + (to - self.from) * (after / over).max(0.0)
        } else if rate == 0.0 {
            to
        } else {
            to + rate * (after - over)
        }
    }

    /// Time \[s\] at which its ramp ends, if that is after t.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        let end = self.since + self.course.over;
        (end > t).then_some(end)
    }
}

/// A coordinate on its course, in pieces.
///
/// ```text
/// x = x₀ + v τ + ½ a τ² + ⅙ j τ³,   τ = t − t₀ of the last piece that has begun
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// As it was before, on the ramp, and after it.
    pieces: [Piece; 3],
    /// Arrival of a step at the end of the ramp. Until then the ramp goes on: the end of the step has its acceleration.
    arrived: bool,
}

/// A piece of a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Piece {
    since: f64,
    from: Kinematics,
    jerk: f64,
}

impl Piece {
    fn at(&self, t: f64) -> Kinematics {
        let Self { since, from, jerk } = *self;
        let after = t - since;
        let acceleration = from.acceleration + jerk * after;
        // ½ a τ² + ⅙ j τ³
        let gained = 0.5 * from.acceleration + jerk / 6.0 * after;
        Kinematics {
            position: from.position + (from.rate + gained * after) * after,
            rate: from.rate + 0.5 * (from.acceleration + acceleration) * after,
            acceleration,
        }
    }
}

impl Path {
    /// Position, rate and acceleration at a time \[s\].
    #[inline]
    pub(crate) fn at(&self, t: f64) -> Kinematics {
        let [before, way, after] = &self.pieces;
        let piece = if self.arrived && t >= after.since {
            after
        } else if t >= way.since {
            way
        } else {
            before
        };
        piece.at(t)
    }

    /// Time \[s\] at which it begins.
    pub(crate) fn since(&self) -> f64 {
        self.pieces[1].since
    }

    /// Time \[s\] at which its ramp ends, if that is after t.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        let end = self.pieces[2].since;
        (!self.arrived && end > t).then_some(end)
    }

    /// Goes on after the ramp, at a time \[s\] at which a step has ended; whether it ended there.
    pub(crate) fn arrive(&mut self, t: f64) -> bool {
        let after = &mut self.pieces[2];
        let arrives = !self.arrived && t + slack(t) >= after.since;
        if arrives {
            after.since = t;
            self.arrived = true;
        }
        arrives
    }

    /// On from a place and speed, with an acceleration on its course.
    pub(crate) fn accelerated(now: Kinematics, since: f64, course: Course) -> Self {
        let Course { to, over, rate } = course;
        let jerk = if over > 0.0 {
            (to - now.acceleration) / over
        } else {
            0.0
        };
        Self::new(now, since, (now, jerk), over, |end| {
            let there = Kinematics {
                acceleration: to,
                ..end
            };
            (there, rate)
        })
    }

    /// On from a place, with a speed on its course.
    pub(crate) fn driven(now: Kinematics, since: f64, course: Course) -> Self {
        let Course { to, over, rate } = course;
        let acceleration = if over > 0.0 {
            (to - now.rate) / over
        } else {
            0.0
        };
        let way = Kinematics {
            acceleration,
            ..now
        };
        Self::new(now, since, (way, 0.0), over, |end| {
            let there = Kinematics {
                position: end.position,
                rate: to,
                acceleration: rate,
            };
            (there, 0.0)
        })
    }

    /// On to a place within a time, by the cubic that has the speed of now and the rate of the course at its ends.
    ///
    /// ```text
    /// a = 6 Δx/T² − (4 v₀ + 2 v₁)/T,   j = 6 (v₀ + v₁)/T² − 12 Δx/T³      C. Hermite
    /// ```
    pub(crate) fn placed(now: Kinematics, since: f64, course: Course) -> Self {
        let Course { to, over, rate } = course;
        let mean = (to - now.position) / over;
        let acceleration = (6.0 * mean - 4.0 * now.rate - 2.0 * rate) / over;
        let jerk = (6.0 * (now.rate + rate) - 12.0 * mean) / (over * over);
        let way = Kinematics {
            acceleration,
            ..now
        };
        Self::new(now, since, (way, jerk), over, |_| {
            let there = Kinematics {
                position: to,
                rate,
                acceleration: 0.0,
            };
            (there, 0.0)
        })
    }

    /// From the ramp, its duration, and what follows from its end.
    fn new(
        now: Kinematics,
        since: f64,
        (from, jerk): (Kinematics, f64),
        over: f64,
        after: impl FnOnce(Kinematics) -> (Kinematics, f64),
    ) -> Self {
        let before = Piece {
            since,
            from: now,
            jerk: 0.0,
        };
        let way = Piece { since, from, jerk };
        let end = since + over;
        let (there, jerk) = after(way.at(end));
        let after = Piece {
            since: end,
            from: there,
            jerk,
        };
        Self {
            pieces: [before, way, after],
            arrived: over <= 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Kinematics = Kinematics {
        position: 0.3,
        rate: 2.0,
        acceleration: 0.0,
    };

    fn course(to: f64, over: f64, rate: f64) -> Course {
        Course { to, over, rate }
    }

    /// Slopes by central differences are what a path says of itself, and nothing jumps but what is set.
    #[test]
    fn rates_are_the_slopes_of_positions() {
        let all = [
            Path::accelerated(NOW, 1.0, course(-40.0, 0.25, 7.0)),
            Path::driven(NOW, 1.0, course(-3.0, 0.25, 5.0)),
            Path::driven(NOW, 1.0, course(-3.0, 0.0, 5.0)),
            Path::placed(NOW, 1.0, course(0.8, 0.25, 4.0)),
        ];
        for mut path in all {
            path.arrive(path.pieces[2].since);
            for t in [0.99, 1.07, 1.2, 1.4] {
                let [before, now, after] = [-1e-5, 0.0, 1e-5].map(|away| path.at(t + away));
                let slope = (after.position - before.position) / 2e-5;
                assert!((slope - now.rate).abs() < 1e-7, "{path:?} at {t}");
                let slope = (after.rate - before.rate) / 2e-5;
                assert!((slope - now.acceleration).abs() < 1e-7, "{path:?} at {t}");
            }
            for knot in [path.since(), path.pieces[2].since] {
                let [before, after] = [-1e-9, 1e-9].map(|away| path.at(knot + away));
                assert!((after.position - before.position).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn courses_come_to_where_they_are_set() {
        let at = |mut path: Path| {
            assert!(!path.arrive(1.2) && path.next_knot(1.2) == Some(1.25));
            assert!((path.at(1.25).rate - path.pieces[2].from.rate).abs() < 1e-12);
            assert!(path.arrive(1.25 - 1e-17) && !path.arrive(1.25));
            [path.at(1.25), path.at(1.5)]
        };
        let [there, later] = at(Path::driven(NOW, 1.0, course(-3.0, 0.25, 5.0)));
        assert!((there.rate + 3.0).abs() < 1e-14 && (later.rate + 1.75).abs() < 1e-14);
        let [there, later] = at(Path::placed(NOW, 1.0, course(0.8, 0.25, 4.0)));
        assert!((there.position - 0.8).abs() < 1e-14 && (there.rate - 4.0).abs() < 1e-14);
        assert!((later.position - 1.8).abs() < 1e-14);
        let ramp = Ramp::new(1.0, 1.0, course(3.0, 0.25, 8.0));
        for (t, value) in [
            (0.5, 1.0),
            (1.0, 1.0),
            (1.125, 2.0),
            (1.25, 3.0),
            (1.5, 5.0),
        ] {
            assert!((ramp.at(t) - value).abs() < 1e-14);
        }
        assert_eq!([1.1, 1.25].map(|t| ramp.next_knot(t)), [Some(1.25), None]);
    }
}

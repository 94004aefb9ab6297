//! Load cycles of a signal, counted by the rainflow method.

/// A cycle, or half of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// Range, in the unit of the signal.
    pub range: f64,
    /// Mean of its two turning points.
    pub mean: f64,
    /// 1 for a cycle, ½ for a half.
    pub count: f64,
}

/// Counts the cycles of a signal, in the order in which they close; halves of what stays open follow.
///
/// ```text
/// |c − b| ≥ |b − a|:   a cycle of the range |b − a|, or half of one where a begins the signal;   a, b, c turning points that follow each other
/// ```
///
/// # Source
/// ASTM E1049-85 (2017), *Standard Practices for Cycle Counting in Fatigue Analysis*, §5.4.4.
///
/// # Examples
/// Figure 6 of the standard:
///
/// ```
/// let signal = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];
/// let of = |range: f64| -> f64 {
///     let cycles = chaindrive::rainflow(&signal).into_iter();
///     cycles.filter(|cycle| cycle.range == range).map(|cycle| cycle.count).sum()
/// };
/// assert_eq!([3.0, 4.0, 6.0, 8.0, 9.0].map(of), [0.5, 1.5, 0.5, 1.0, 0.5]);
/// ```
pub fn rainflow(signal: &[f64]) -> Vec<Cycle> {
    let mut cycles = Vec::new();
    let mut open: Vec<f64> = Vec::new();
    // Points before this one are counted.
    let mut first = 0;
    for point in turning_points(signal) {
        open.push(point);
        while let [.., a, b, c] = open[first..] {
            if (c - b).abs() < (b - a).abs() {
                break;
            }
            if open.len() - first == 3 {
                // The range begins the signal: half a cycle.
                cycles.push(Cycle::between(a, b, 0.5));
                first += 1;
            } else {
                cycles.push(Cycle::between(a, b, 1.0));
                open.truncate(open.len() - 3);
                open.push(c);
            }
        }
    }
    let rest = open[first..].windows(2);
    cycles.extend(rest.map(|ends| Cycle::between(ends[0], ends[1], 0.5)));
    cycles
}

impl Cycle {
    fn between(a: f64, b: f64, count: f64) -> Self {
        Self {
            range: (a - b).abs(),
            mean: 0.5 * (a + b),
            count,
        }
    }
}

/// The first and the last value, and those between at which the signal turns; on a plateau it turns once.
fn turning_points(signal: &[f64]) -> Vec<f64> {
    let mut moving = signal.to_vec();
    #[expect(clippy::float_cmp, reason = "a plateau is one of equal values")]
    moving.dedup_by(|next, before| next == before);
    let turns = moving.windows(3).filter_map(|it| {
        let turns = (it[1] - it[0]) * (it[2] - it[1]) < 0.0;
        turns.then_some(it[1])
    });
    let [first, last] = [moving.first(), moving.last()].map(Option::<&f64>::copied);
    first.into_iter().chain(turns).chain(last).collect()
}

//! Exponential growth of a distance: rate, its uncertainty, and where it ends.

/// Growth of a distance over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Growth {
    /// It grows: D(t) = exp(λ (t − t₀)).
    Exponential {
        /// λ \[1/s\].
        rate: f64,
        /// ln D at the end of the samples, by the fit.
        last: f64,
    },
    /// It has grown and stays at a level \[–\].
    Saturated(f64),
    /// Neither.
    None,
}

/// Parts of the window over which distances are averaged, since they swing with the tension.
const BLOCKS: usize = 16;
/// Blocks a fit needs.
const LEAST: usize = 5;
/// Standard errors by which a rate must exceed zero.
const SIGNIFICANT: f64 = 3.0;
/// Growth between the two ends of a fit below which it is not called growth: a factor of ten.
const LEAST_GROWTH: f64 = std::f64::consts::LN_10;
/// Factor above the least distance that something has to have reached before it may be called saturated.
const RISEN: f64 = 1e3;

/// Looks for growth.
///
/// ```text
/// ln D̄ₖ = λ tₖ + c,   least squares over the blocks from the least one in the first half to the last
/// ```
///
/// D̄ₖ is the root mean square of a sixteenth of the samples. The beginning is left out because the start of
/// a twin rings before anything unfolds.
pub(super) fn growth(time: &[f64], distance: &[f64]) -> Growth {
    let blocks = blocks(time, distance);
    let Some(least) = (0..blocks.len() / 2).min_by(|a, b| blocks[*a].1.total_cmp(&blocks[*b].1))
    else {
        return Growth::None;
    };
    let blocks = &blocks[least..];
    if blocks.len() < LEAST {
        return Growth::None;
    }
    let late = &blocks[blocks.len() - (blocks.len() / 2).max(LEAST)..];
    let (rate, error) = line(late);
    let risen = mean(late) - blocks[0].1;
    if risen > RISEN.ln() && rate * span(late) < LEAST_GROWTH.max(SIGNIFICANT * error * span(late))
    {
        return Growth::Saturated(mean(late).exp());
    }
    let (rate, error) = line(blocks);
    if rate > SIGNIFICANT * error && rate * span(blocks) > LEAST_GROWTH {
        let middle = blocks.iter().map(|(t, _)| t).sum::<f64>() / blocks.len() as f64;
        let last = mean(blocks) + rate * (time[time.len() - 1] - middle);
        return Growth::Exponential { rate, last };
    }
    Growth::None
}

/// Mean time and ln of the root mean square distance of every block that has a distance.
fn blocks(time: &[f64], distance: &[f64]) -> Vec<(f64, f64)> {
    let size = time.len().div_ceil(BLOCKS).max(1);
    time.chunks(size)
        .zip(distance.chunks(size))
        .filter_map(|(time, distance)| {
            let count = time.len() as f64;
            let square = distance.iter().map(|d| d * d).sum::<f64>() / count;
            let middle = time.iter().sum::<f64>() / count;
            (square > 0.0 && square.is_finite()).then(|| (middle, 0.5 * square.ln()))
        })
        .collect()
}

fn mean(blocks: &[(f64, f64)]) -> f64 {
    blocks.iter().map(|(_, ln)| ln).sum::<f64>() / blocks.len() as f64
}

fn span(blocks: &[(f64, f64)]) -> f64 {
    blocks[blocks.len() - 1].0 - blocks[0].0
}

/// Slope of the line of least squares, and its standard error.
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let t0 = points.iter().map(|(t, _)| t).sum::<f64>() / n;
    let y0 = mean(points);
    let tt: f64 = points.iter().map(|(t, _)| (t - t0).powi(2)).sum();
    let ty: f64 = points.iter().map(|(t, y)| (t - t0) * (y - y0)).sum();
    let slope = ty / tt;
    let left: f64 = points
        .iter()
        .map(|(t, y)| (y - y0 - slope * (t - t0)).powi(2))
        .sum();
    (slope, (left / (n - 2.0) / tt).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(of: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..=200).map(|i| f64::from(i) * 1e-3).collect();
        let distance = time.iter().map(|t| of(*t)).collect();
        (time, distance)
    }

    #[test]
    fn a_swinging_exponential_gives_its_rate() {
        let (time, distance) = samples(|t| 1e-9 * (t / 0.02).exp() * (t * 900.0).sin());
        let Growth::Exponential { rate, last } = growth(&time, &distance) else {
            panic!("no growth");
        };
        assert!((rate * 0.02 - 1.0).abs() < 0.05, "{rate}");
        let amplitude = (1e-9_f64 / 2.0_f64.sqrt()).ln() + 10.0;
        assert!((last - amplitude).abs() < 0.5, "{last}");
    }

    #[test]
    fn what_grows_and_stays_is_saturated() {
        let (time, distance) = samples(|t| (1e-9 * (t / 2e-3).exp()).min(2e-3));
        let found = growth(&time, &distance);
        assert!(
            matches!(found, Growth::Saturated(level) if (level / 2e-3 - 1.0).abs() < 0.1),
            "{found:?}"
        );
    }

    #[test]
    fn a_distance_that_stays_small_does_not_grow() {
        let (time, distance) = samples(|t| 1e-9 * (1.0 + 0.5 * (t * 700.0).sin()));
        assert_eq!(growth(&time, &distance), Growth::None);
        let (time, distance) = samples(|_| 0.0);
        assert_eq!(growth(&time, &distance), Growth::None);
        assert_eq!(growth(&[], &[]), Growth::None);
    }

    #[test]
    fn growth_with_time_to_the_first_power_is_not_chaos() {
        let (time, distance) = samples(|t| 1e-9 * (1.0 + t));
        assert_eq!(growth(&time, &distance), Growth::None);
    }
}

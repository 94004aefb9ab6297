//! What is packed comes back, undone step by step as the page does it.

use std::io::Read;

use flate2::read::DeflateDecoder;

use super::{Stream, Streams};

/// Values of a stream, (rows, columns).
fn unpacked(streams: &Streams, stream: &Stream) -> Vec<f64> {
    let packed = &streams.bytes[stream.at..stream.at + stream.length];
    let mut bytes = Vec::new();
    DeflateDecoder::new(packed).read_to_end(&mut bytes).unwrap();
    let (rows, count) = (stream.rows, stream.rows * stream.columns);
    assert_eq!(bytes.len(), count * stream.planes);
    let mut whole: Vec<i64> = (0..count)
        .map(|at| {
            let planes =
                (0..stream.planes).map(|plane| u64::from(bytes[plane * count + at]) << (8 * plane));
            let zigzag = planes.sum::<u64>();
            (zigzag >> 1).cast_signed() ^ -(zigzag & 1).cast_signed()
        })
        .collect();
    for _ in 0..stream.order[0] {
        for series in whole.chunks_mut(rows) {
            for at in 1..rows {
                series[at] += series[at - 1];
            }
        }
    }
    for _ in 0..stream.order[1] {
        for at in rows..count {
            whole[at] += whole[at - rows];
        }
    }
    let value = |number: i64| match stream.missing {
        Some(missing) if missing == number => f64::NAN,
        _ => stream.origin + stream.quantum * number as f64,
    };
    let place = |at: usize| (at % stream.columns) * rows + at / stream.columns;
    (0..count).map(|at| value(whole[place(at)])).collect()
}

fn packed(values: &[f64], columns: usize, quantum: f64) -> Vec<f64> {
    let mut streams = Streams::default();
    // Another array before it moves its place.
    streams.push("before", &[1.0, 2.0, 3.0], 1, 0.5);
    streams.push("values", values, columns, quantum);
    let stream = &streams.index[1];
    assert_eq!(
        (stream.rows, stream.columns),
        (values.len() / columns, columns)
    );
    unpacked(&streams, stream)
}

/// Waves that wander, with jumps: smooth in time, across columns, or neither.
fn waves(rows: usize, columns: usize) -> Vec<f64> {
    let wave = |at: usize| {
        let (row, column) = ((at / columns) as f64, (at % columns) as f64);
        let jump = if at.is_multiple_of(97) { 50.0 } else { 0.0 };
        (0.05 * row + 0.3 * column).sin() * 3.0 + 0.01 * row - 7.0 + jump
    };
    (0..rows * columns).map(wave).collect()
}

#[test]
fn values_come_back_within_half_a_quantum() {
    for (rows, columns) in [(1, 1), (1, 7), (300, 1), (211, 13)] {
        let values = waves(rows, columns);
        for quantum in [1e-4, 0.013, 2.0] {
            let back = packed(&values, columns, quantum);
            for (value, found) in values.iter().zip(&back) {
                assert!(
                    (value - found).abs() <= 0.5 * quantum * (1.0 + 1e-9),
                    "{value} {found}"
                );
            }
        }
    }
}

/// An arm that moves by a ten-thousandth of its angle moves smoothly in its plot; what stands keeps its digits.
#[test]
fn curves_are_as_fine_as_their_range() {
    let angles: Vec<f64> = (0..500)
        .map(|at| 1.2 + 1e-4 * (0.02 * f64::from(at)).sin())
        .collect();
    for (values, allowed) in [(angles, 0.51e-7), (vec![5.3; 9], 1e-8), (vec![0.0; 9], 0.0)] {
        let mut streams = Streams::default();
        streams.push_curve("curve", &values);
        let back = unpacked(&streams, &streams.index[0]);
        let worst = values
            .iter()
            .zip(&back)
            .map(|(value, found)| (value - found).abs());
        assert!(worst.fold(0.0, f64::max) <= allowed, "{back:?}");
    }
}

/// Eight metres by tenths of a millimetre are more than sixteen bits hold.
#[test]
fn long_ways_do_not_wrap() {
    let values: Vec<f64> = (0..4000).map(|at| f64::from(at % 2) * 8.0).collect();
    let back = packed(&values, 4, 1e-4);
    assert!(
        values
            .iter()
            .zip(&back)
            .all(|(value, found)| (value - found).abs() <= 0.5e-4)
    );
}

/// No force is no force, and the number of a roller is whole.
#[test]
fn zeros_and_whole_numbers_stay_what_they_are() {
    let values = [0.0, 3.0, 117.0, 0.0, 41.0];
    assert_eq!(packed(&values, 1, 1.0), values);
    let forces = [0.0, 812.3, 0.0, 99.0];
    let back = packed(&forces, 2, 812.3 / 400.0);
    assert!(back[0] == 0.0 && back[2] == 0.0, "{back:?}");
}

#[test]
fn what_is_no_number_stays_none() {
    let values = [1.0, f64::NAN, -2.0, f64::INFINITY];
    let back = packed(&values, 2, 0.1);
    assert!(back[1].is_nan() && back[3].is_nan(), "{back:?}");
    assert!((back[0] - 1.0).abs() <= 0.05 && (back[2] + 2.0).abs() <= 0.05);
    assert!(packed(&[f64::NAN; 3], 1, 0.0).iter().all(|it| it.is_nan()));
}

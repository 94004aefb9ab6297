//! Static states of the marine drive against an independent Newton solution.

use crate::marine;
use crate::pieces::linear;

use chaindrive_mechanics::Drive;

/// The span means and extremes, from an independent energy minimisation with the same linear
/// contact of 5 GN/m: pretension alone, with gravity, and with 5 kN m on the camshaft.
const STATES: [(&str, [[f64; 2]; 4]); 3] = [
    ("pretension", [[14.94, 15.02]; 4]),
    (
        "gravity",
        [
            [15.16, 15.86],
            [16.17, 16.41],
            [15.92, 16.37],
            [15.33, 15.88],
        ],
    ),
    (
        "load",
        [
            [20.19, 20.88],
            [13.84, 14.07],
            [13.58, 14.03],
            [12.99, 13.54],
        ],
    ),
];

#[test]
fn span_tensions_match_the_reference_states() {
    let law = linear(5e9);
    let drive = Drive::new(marine::parts(law)).expect("the marine drive is valid");
    let assembled = drive.assemble().expect("the marine drive assembles");
    let fitting = assembled.fittings[0].clone().expect("it has a route");
    assert_eq!(fitting.seated, [19, 11, 8, 3]);
    assert_eq!(fitting.spans, [28, 14, 19, 20]);
    assert!(fitting.strain.abs() < 1e-12, "{}", fitting.strain);

    assert_eq!(assembled.statics.len(), 3);
    for (found, (stage, spans)) in assembled.statics.iter().zip(STATES) {
        assert_eq!(found.stage, stage);
        let mut link = 0;
        for (i, [low, high]) in spans.iter().enumerate() {
            link += fitting.seated[i] as usize;
            let count = fitting.spans[i] as usize;
            let span = &found.tensions[link..link + count];
            link += count;
            let least = span.iter().copied().fold(f64::INFINITY, f64::min) * 1e-3;
            let most = span.iter().copied().fold(0.0, f64::max) * 1e-3;
            println!(
                "{stage:10} span {i}: {least:.3}..{most:.3} kN, reference {low}..{high}; {} iterations, residual {:.1e}, contacts {:?}",
                found.iterations, found.residual, found.contacts
            );
            if stage != "pretension" {
                assert!(
                    (least / low - 1.0).abs() < 5e-3,
                    "{stage}, span {i}: {least}"
                );
                assert!(
                    (most / high - 1.0).abs() < 5e-3,
                    "{stage}, span {i}: {most}"
                );
            }
            assert!(least > low - 0.01 && most < high + 0.01);
        }
    }
    assert_eq!(assembled.statics[0].contacts, [20, 12, 9, 4]);
}

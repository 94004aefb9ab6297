//! Chains of several strands.

/// Factors of 1 to 6 strands.
const FACTORS: [f64; 6] = [1.0, 1.7, 2.5, 3.3, 3.9, 4.6];

/// Power of a multi-strand chain over that of a single strand \[–\]: 1, 1.7, 2.5, 3.3, 3.9 and 4.6 for one to six, and no more beyond.
///
/// The strands do not share the load evenly. Chinese practice after GB/T 18150 takes 1.75 for two; in fatigue three strands with
/// a clearance fit were measured to bear 2.0 times, with an interference fit 2.4 times as much as one (*J. Soc. Materials Science, Japan* 8, 1959, 638).
///
/// # Source
/// American Chain Association, in R. G. Budynas and J. K. Nisbett, *Shigley's Mechanical Engineering Design*, 9th ed., 2011, table 17–23.
pub fn strand_factor(strands: u32) -> f64 {
    let index = (strands as usize).clamp(1, FACTORS.len()) - 1;
    FACTORS[index]
}

//! Wear of joints: by how much a chain may grow in its use, and how long that takes.

use std::fmt;

use chaindrive_mechanics::{Drive, GuideSupport, PlacedChain, Strength, Support};
use serde::{Deserialize, Serialize};

use crate::figure::with_digits;

/// Wear coefficient k of an oiled joint, pin and bush together \[m³/(N m)\]: 3·10⁻⁷ mm³/(N m), *assumed*, see [`BAND`].
pub const COEFFICIENT: f64 = 3e-16;
/// Factor within which the coefficient lies on either side \[–\], *assumed*: nobody measured one of a roller chain with its load and oil.
pub const BAND: f64 = 10.0;

/// Elongation at which a chain is worn out \[–\]: usual, of a large sprocket over its teeth at most, on fixed centres, beside guides.
const USUAL: f64 = 0.03;
const BY_TEETH: f64 = 2.0;
const ON_FIXED_CENTRES: f64 = 0.015;
const GUIDED: f64 = 0.01;

/// Seconds in an hour.
const HOUR: f64 = 3600.0;

/// What bounds the elongation by wear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WearBound {
    /// What rollers on teeth allow.
    Usual,
    /// The many teeth of the largest sprocket.
    Teeth,
    /// Nothing takes up the growth.
    FixedCentres,
    /// A chain beside guides, as in engines, drives what must keep its time.
    Guides,
}

impl WearBound {
    /// Words after the elongation.
    pub fn words(self) -> &'static str {
        match self {
            Self::Usual => "as most chains (Diamond Chain)",
            Self::Teeth => "200 % over the teeth of its largest sprocket (Diamond Chain)",
            Self::FixedCentres => "on fixed centres (Diamond Chain)",
            Self::Guides => "beside guides, as in engines (manual of a marine engine)",
        }
    }
}

/// Elongation at which a chain is worn out in its use.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WearLimit {
    /// Elongation \[–\].
    pub elongation: f64,
    /// What bounds it.
    pub bound: WearBound,
}

impl WearLimit {
    /// The least of the limits that hold for a chain; none where it passes no sprocket: nothing turns its joints.
    ///
    /// ```text
    /// ε ≤ 3 %,   ε ≤ 200 %/z,   ε ≤ 1.5 % on fixed centres,   ε ≤ 1 % beside guides
    /// ```
    ///
    /// # Source
    /// Diamond Chain, *How can the wear in a roller chain be accurately measured and when is the chain considered worn out?*,
    /// <https://diamondchain.com/faq/how-can-the-wear-in-a-roller-chain-be-accurately-measured-and-when-is-the-chain-considered-worn-out/>:
    /// 3 %, 200/N %, and some 1.5 % on fixed centres and for smooth running. 1 %: ten links of 114.3 mm of a marine engine are scrap at
    /// 1154.4 mm, the reference case M08.
    pub fn of(placed: &PlacedChain, drive: &Drive) -> Option<Self> {
        let own = |index: &usize| drive.sprockets[*index].gap.teeth;
        let teeth = placed.sprockets.iter().map(own).max()?;
        let limits = [
            Some((USUAL, WearBound::Usual)),
            Some((BY_TEETH / f64::from(teeth), WearBound::Teeth)),
            (!takes_up(placed, drive)).then_some((ON_FIXED_CENTRES, WearBound::FixedCentres)),
            (!placed.guides.is_empty()).then_some((GUIDED, WearBound::Guides)),
        ];
        let least = limits.into_iter().flatten();
        let (elongation, bound) = least.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Self { elongation, bound })
    }
}

impl fmt::Display for WearLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let elongation = with_digits(100.0 * self.elongation, 2);
        write!(f, "{elongation} %, {}", self.bound.words())
    }
}

/// A tensioner or a sprung centre takes up the growth of the chain.
fn takes_up(placed: &PlacedChain, drive: &Drive) -> bool {
    let by_sprocket = placed.sprockets.iter().any(|index| {
        matches!(
            drive.sprockets[*index].support,
            Support::Tensioner(_) | Support::Springs { .. }
        )
    });
    let by_guide = placed
        .guides
        .iter()
        .any(|index| matches!(drive.guides[*index].support, GuideSupport::Tensioner(_)));
    by_sprocket || by_guide
}

/// Hours until a new chain is worn out, least and greatest; none where its joints do not turn under load or are not known.
///
/// ```text
/// t = ε p n d b/(k Q),    Q = r Σ T ω/X
/// ```
///
/// By Archard's law (J. F. Archard, *J. Appl. Phys.* 24, 1953, 981–988). ε: limit of the use, p: pitch, n d b: bearing area of all strands, Q: load times
/// sliding of a joint in the mean, see [`Load::sliding`](super::Load::sliding), k: from a tenth of [`COEFFICIENT`] to ten times that.
pub(super) fn life(
    strength: &Strength,
    pitch: f64,
    sliding: Option<f64>,
    limit: Option<WearLimit>,
) -> Option<[f64; 2]> {
    let area = strength.bearing_area? * f64::from(strength.strands);
    let sliding = sliding.filter(|it| *it > 0.0)?;
    // t = ε p n d b/(k Q)
    let hours = limit?.elongation * pitch * area / (COEFFICIENT * sliding) / HOUR;
    hours.is_finite().then_some([hours / BAND, hours * BAND])
}

/// Hours of a life in words, two digits each: nobody knows a third.
///
/// ```
/// assert_eq!(chaindrive::rating::told_hours([1530.8, 153_080.0]), "1,500 to 150,000 h");
/// ```
pub fn told_hours([least, greatest]: [f64; 2]) -> String {
    format!("{} to {} h", two_digits(least), two_digits(greatest))
}

/// Two significant digits, thousands apart.
fn two_digits(value: f64) -> String {
    if !(value >= 10.0 && value.is_finite()) {
        return with_digits(value, 2);
    }
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    let digits = format!("{:.0}", (value / unit).round() * unit);
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

//! Lubrication that a chain needs.

/// Class of lubrication that a chain speed asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lubrication {
    /// Type A of the American Chain Association: by hand, or in drops.
    Drip,
    /// Type B: a bath, or a disc that slings oil.
    Bath,
    /// Type C: a stream from a pump.
    Stream,
}

/// Pitch \[in\], and the greatest chain speeds \[ft/min\] of drip and bath.
const SPEEDS: [(f64, f64, f64); 8] = [
    (0.5, 300.0, 2300.0),
    (0.625, 250.0, 2000.0),
    (0.75, 220.0, 1800.0),
    (1.0, 170.0, 1500.0),
    (1.25, 150.0, 1300.0),
    (1.5, 130.0, 1200.0),
    (1.75, 115.0, 1100.0),
    (2.0, 100.0, 1000.0),
];

/// Inch \[m\].
const INCH: f64 = 0.0254;
/// Foot a minute \[m/s\].
const FOOT_A_MINUTE: f64 = 0.3048 / 60.0;
/// Difference of pitches, relative, up to which they are the same.
const SAME_PITCH: f64 = 1e-3;

impl Lubrication {
    /// The least class that will do at a pitch \[m\] and a chain speed \[m/s\]; none for pitches that the table does not have.
    ///
    /// The table is that of numbers 40 to 160, half an inch to two inches; chains of the B series have the same pitches, and are *assumed*
    /// to ask for the same.
    ///
    /// # Source
    /// McGuire Bearing, *What are some guidelines for better chain performance?*,
    /// <https://mcguirebearing.com/faqs/better-chain-performance/>: types A and B of the American Chain Association, in rounded numbers.
    pub fn at(pitch: f64, speed: f64) -> Option<Self> {
        let own = |(inches, ..): &&(f64, f64, f64)| {
            (pitch - inches * INCH).abs() <= SAME_PITCH * inches * INCH
        };
        let (_, drip, bath) = SPEEDS.iter().find(own)?;
        Some(match speed.abs() / FOOT_A_MINUTE {
            speed if speed <= *drip => Self::Drip,
            speed if speed <= *bath => Self::Bath,
            _ => Self::Stream,
        })
    }

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drip => "drip",
            Self::Bath => "bath",
            Self::Stream => "stream",
        }
    }
}

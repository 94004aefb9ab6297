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

/// Greatest chain speeds of a pitch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LubricationSpeeds {
    /// By hand or in drops \[m/s\].
    pub drip: f64,
    /// In a bath \[m/s\].
    pub bath: f64,
    /// The table has the pitch; else the speeds are *assumed*.
    pub is_tabled: bool,
}

/// Pitch \[in\], and the greatest chain speeds \[ft/min\] of drip and bath.
const SPEEDS: [[f64; 3]; 8] = [
    [0.5, 300.0, 2300.0],
    [0.625, 250.0, 2000.0],
    [0.75, 220.0, 1800.0],
    [1.0, 170.0, 1500.0],
    [1.25, 150.0, 1300.0],
    [1.5, 130.0, 1200.0],
    [1.75, 115.0, 1100.0],
    [2.0, 100.0, 1000.0],
];

/// Inch \[m\].
const INCH: f64 = 0.0254;
/// Foot a minute \[m/s\].
const FOOT_A_MINUTE: f64 = 0.3048 / 60.0;
/// Difference of pitches, relative, up to which they are the same.
const SAME_PITCH: f64 = 1e-3;

impl LubricationSpeeds {
    /// The speeds of a pitch \[m\]; none where it is not positive.
    ///
    /// ```text
    /// ln v = ln v₁ + ln(v₂/v₁) ln(p/p₁)/ln(p₂/p₁)
    /// ```
    ///
    /// between two pitches of the table, that of numbers 40 to 160. Beyond its ends p₁ and p₂ are these ends: *assumed*. So it is that chains of the B
    /// series, of motorcycles and bicycles ask for what the A series does.
    ///
    /// # Source
    /// McGuire Bearing, *What are some guidelines for better chain performance?*,
    /// <https://mcguirebearing.com/faqs/better-chain-performance/>: types A and B of the American Chain Association, in rounded numbers.
    pub fn of(pitch: f64) -> Option<Self> {
        if !(pitch > 0.0 && pitch.is_finite()) {
            return None;
        }
        let inches = pitch / INCH;
        let same = |row: &&[f64; 3]| (inches - row[0]).abs() <= SAME_PITCH * row[0];
        if let Some([_, drip, bath]) = SPEEDS.iter().find(same) {
            return Some(Self {
                drip: drip * FOOT_A_MINUTE,
                bath: bath * FOOT_A_MINUTE,
                is_tabled: true,
            });
        }
        let between = SPEEDS.windows(2);
        let ends = [SPEEDS[0], SPEEDS[SPEEDS.len() - 1]];
        let [low, high] = between
            .map(|rows| [rows[0], rows[1]])
            .find(|[low, high]| (low[0]..high[0]).contains(&inches))
            .unwrap_or(ends);
        // ln v = ln v₁ + ln(v₂/v₁) ln(p/p₁)/ln(p₂/p₁)
        let share = (inches / low[0]).ln() / (high[0] / low[0]).ln();
        let speed =
            |column: usize| low[column] * (high[column] / low[column]).powf(share) * FOOT_A_MINUTE;
        Some(Self {
            drip: speed(1),
            bath: speed(2),
            is_tabled: false,
        })
    }
}

impl Lubrication {
    /// The least class that will do at a pitch \[m\] and a chain speed \[m/s\], see [`LubricationSpeeds::of`].
    pub fn at(pitch: f64, speed: f64) -> Option<Self> {
        let speeds = LubricationSpeeds::of(pitch)?;
        Some(match speed.abs() {
            speed if speed <= speeds.drip => Self::Drip,
            speed if speed <= speeds.bath => Self::Bath,
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

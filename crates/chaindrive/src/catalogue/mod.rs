//! A table of chains: dimensions of makers and standards, masses and stiffness, and what is assumed.
//!
//! The table is `chains.csv` beside this file. Every column of numbers has a status in words: read off
//! catalogues, computed, or assumed.
//!
//! ```
//! use chaindrive::catalogue::{CatalogueChain, Number};
//!
//! let chain = CatalogueChain::named("16B-1").ok_or("no such chain")?;
//! assert_eq!(chain.number(Number::Pitch), Some(0.0254));
//! assert_eq!(CatalogueChain::named("80").map(|chain| chain.name.as_str()), Some("16A-1"));
//! # Ok::<(), &str>(())
//! ```

use std::sync::LazyLock;

use csv::StringRecord;

/// One chain of the catalogue, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct CatalogueChain {
    /// ISO designation, or the trade's name where ISO has none.
    pub name: String,
    /// ANSI number; empty where there is none.
    pub ansi: String,
    /// The part that runs on the teeth: "roller" or "bush".
    pub kind: String,
    /// Where its dimensions, breaking load and mass per length are from.
    pub dimensions_status: String,
    /// Where makers differ by more than a per cent, their values in the order of the sources.
    pub makers_differ: String,
    numbers: [Option<f64>; Number::ALL.len()],
    statuses: [String; 4],
}

/// Where the value of a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Read off catalogues: [`CatalogueChain::dimensions_status`].
    Dimensions,
    /// Bore of the bush.
    Bore,
    /// Outside of the bush.
    Bush,
    /// Mass and inertia of links and rollers.
    Mass,
    /// Stiffness of a link.
    Stiffness,
}

impl Status {
    /// Name of its column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dimensions => "dimensions_status",
            Self::Bore => "bore_status",
            Self::Bush => "bush_status",
            Self::Mass => "mass_status",
            Self::Stiffness => "stiffness_status",
        }
    }
}

macro_rules! numbers {
    ($($variant:ident, $name:literal, $column:literal, $per:literal, $unit:literal, $status:ident, $text:literal;)*) => {
        /// A number that the catalogue gives, in SI units.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Number {
            $(#[doc = $text] $variant,)*
        }

        impl Number {
            /// All numbers.
            pub const ALL: [Self; [$(Self::$variant),*].len()] = [$(Self::$variant),*];

            /// Name in listings.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// SI unit.
            pub fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit),* }
            }

            /// One line of description.
            pub fn description(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }

            /// Where it comes from.
            pub fn status(self) -> Status {
                match self { $(Self::$variant => Status::$status),* }
            }

            /// Column of the table, and how many of its units make one of SI.
            fn column(self) -> (&'static str, f64) {
                match self { $(Self::$variant => ($column, $per)),* }
            }
        }
    };
}

numbers! {
    Pitch, "pitch", "pitch_mm", 1e3, "m", Dimensions, "pitch";
    RollerDiameter, "roller_diameter", "roller_diameter_mm", 1e3, "m", Dimensions, "diameter of the roller, or of the bush that runs on the teeth";
    InnerWidth, "inner_width", "inner_width_mm", 1e3, "m", Dimensions, "width between the inner plates";
    PinDiameter, "pin_diameter", "pin_diameter_mm", 1e3, "m", Dimensions, "diameter of the pin";
    BushBore, "bush_bore", "bush_bore_mm", 1e3, "m", Bore, "bore of the bush";
    BushDiameter, "bush_diameter", "bush_diameter_mm", 1e3, "m", Bush, "outer diameter of the bush";
    PlateHeight, "plate_height", "plate_height_mm", 1e3, "m", Dimensions, "height of the inner plates";
    InnerPlate, "inner_plate", "inner_plate_mm", 1e3, "m", Dimensions, "thickness of an inner plate";
    OuterPlate, "outer_plate", "outer_plate_mm", 1e3, "m", Dimensions, "thickness of an outer plate";
    PinLength, "pin_length", "pin_length_mm", 1e3, "m", Dimensions, "length of the pin";
    BreakingLoad, "breaking_load", "breaking_load_kn", 1e-3, "N", Dimensions, "least breaking load";
    MassPerLength, "mass_per_length", "mass_kg_per_m", 1.0, "kg/m", Dimensions, "mass per length";
    InnerMass, "inner_mass", "inner_mass_kg", 1.0, "kg", Mass, "mass of an inner link, rollers not included";
    OuterMass, "outer_mass", "outer_mass_kg", 1.0, "kg", Mass, "mass of an outer link";
    RollerMass, "roller_mass", "roller_mass_kg", 1.0, "kg", Mass, "mass of a roller";
    InnerInertia, "inner_inertia", "inner_inertia_kg_m2", 1.0, "kg m^2", Mass, "moment of inertia of an inner link about its middle, rollers not included";
    OuterInertia, "outer_inertia", "outer_inertia_kg_m2", 1.0, "kg m^2", Mass, "moment of inertia of an outer link about its middle";
    RollerInertia, "roller_inertia", "roller_inertia_kg_m2", 1.0, "kg m^2", Mass, "moment of inertia of a roller";
    LinkStiffness, "link_stiffness", "link_stiffness_mn_per_m", 1e-6, "N/m", Stiffness, "axial stiffness of a link";
}

static CHAINS: LazyLock<Vec<CatalogueChain>> = LazyLock::new(|| {
    read(include_str!("chains.csv")).expect("the table in the crate is tested to be well formed")
});

/// All chains of the catalogue, in the order of the table.
pub fn catalogue() -> &'static [CatalogueChain] {
    &CHAINS
}

impl CatalogueChain {
    /// The chain of a name: the ISO designation with or without its `-1`, or the ANSI number.
    pub fn named(name: &str) -> Option<&'static Self> {
        let name = name.trim();
        let is = |known: &str| !known.is_empty() && known.eq_ignore_ascii_case(name);
        catalogue()
            .iter()
            .find(|chain| is(&chain.name) || chain.name.strip_suffix("-1").is_some_and(is))
            .or_else(|| catalogue().iter().find(|chain| is(&chain.ansi)))
    }

    /// A number in SI units; none where the table has none.
    pub fn number(&self, number: Number) -> Option<f64> {
        self.numbers[number as usize]
    }

    /// Where a number of this chain comes from, in words.
    pub fn status(&self, of: Status) -> &str {
        match of {
            Status::Dimensions => &self.dimensions_status,
            Status::Bore => &self.statuses[0],
            Status::Bush => &self.statuses[1],
            Status::Mass => &self.statuses[2],
            Status::Stiffness => &self.statuses[3],
        }
    }

    /// Mass of one link, rollers included, in the mean of inner and outer ones \[kg\].
    pub fn mass(&self) -> Option<f64> {
        // m = q p
        Some(self.number(Number::MassPerLength)? * self.number(Number::Pitch)?)
    }

    /// Radial clearance of the pin in its bush \[m\].
    pub fn joint_clearance(&self) -> Option<f64> {
        let bore = self.number(Number::BushBore)?;
        // In nanometres, to which the table is exact.
        let clearance = 0.5 * (bore - self.number(Number::PinDiameter)?);
        Some((clearance * 1e9).round() * 1e-9)
    }

    /// Length on which pin and bush touch \[m\]: the length of the bush.
    pub fn joint_length(&self) -> Option<f64> {
        // b₁ + 2 t
        Some(self.number(Number::InnerWidth)? + 2.0 * self.number(Number::InnerPlate)?)
    }
}

fn read(text: &str) -> Result<Vec<CatalogueChain>, String> {
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let headings = table.headers().map_err(|error| error.to_string())?.clone();
    let rows = table.records();
    rows.map(|row| chain(&headings, &row.map_err(|error| error.to_string())?))
        .collect()
}

fn chain(headings: &StringRecord, row: &StringRecord) -> Result<CatalogueChain, String> {
    let cell = |column: &str| {
        let at = headings.iter().position(|heading| heading == column);
        at.and_then(|at| row.get(at))
            .ok_or_else(|| format!("no column {column}"))
    };
    let text = |column: &str| cell(column).map(str::to_owned);
    let mut numbers = [None; Number::ALL.len()];
    for number in Number::ALL {
        let (column, per) = number.column();
        let written = cell(column)?;
        if !written.is_empty() {
            let value: f64 = written
                .parse()
                .map_err(|_| format!("{column}: {written} is no number"))?;
            numbers[number as usize] = Some(value / per);
        }
    }
    Ok(CatalogueChain {
        name: text("name")?,
        ansi: text("ansi")?,
        kind: text("kind")?,
        dimensions_status: text("dimensions_status")?,
        makers_differ: text("makers_differ")?,
        numbers,
        statuses: [
            text("bore_status")?,
            text("bush_status")?,
            text("mass_status")?,
            text("stiffness_status")?,
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_its_numbers_are_those_of_chains() {
        assert_eq!(catalogue().len(), 40);
        for chain in catalogue() {
            assert_eq!(CatalogueChain::named(&chain.name), Some(chain));
            for number in Number::ALL {
                let positive = chain.number(number).is_none_or(|value| value > 0.0);
                assert!(positive, "{}: {}", chain.name, number.name());
                let told =
                    chain.number(number).is_none() || chain.status(number.status()) != "unknown";
                assert!(told, "{}: where is {} from?", chain.name, number.name());
            }
            let number = |of| chain.number(of).unwrap_or(f64::NAN);
            assert!(number(Number::PinDiameter) < number(Number::RollerDiameter));
            assert!(number(Number::RollerDiameter) < number(Number::Pitch));
        }
    }

    /// Two pitches weigh an inner link, an outer link and two rollers.
    #[test]
    fn masses_add_up_to_the_mass_per_length() {
        for chain in catalogue() {
            let (Some(inner), Some(outer)) = (
                chain.number(Number::InnerMass),
                chain.number(Number::OuterMass),
            ) else {
                continue;
            };
            let rollers = 2.0 * chain.number(Number::RollerMass).unwrap_or(0.0);
            let link = 0.5 * (inner + outer + rollers);
            let mass = chain.mass().expect("masses were scaled to it");
            assert!(
                (link / mass - 1.0).abs() < 2e-3,
                "{}: {link} {mass}",
                chain.name
            );
        }
    }

    #[test]
    fn chains_have_several_names() {
        for (name, meant) in [
            ("16b", "16B-1"),
            ("16B-1", "16B-1"),
            ("40", "08A-1"),
            ("520", "520"),
        ] {
            assert_eq!(
                CatalogueChain::named(name).map(|c| c.name.as_str()),
                Some(meant)
            );
        }
        assert_eq!(CatalogueChain::named(""), None);
        assert_eq!(CatalogueChain::named("17B-1"), None);
    }
}

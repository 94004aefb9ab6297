//! A layout as text.

use std::fmt::{self, Write as _};

use super::{ChainLayout, Fit};
use crate::sheet::{aligned, lines};

/// Width of the names of what is said of the whole layout.
const NAMES: usize = 18;

impl fmt::Display for ChainLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sheet = &mut String::new();
        let name = self.chain.iter().map(|it| format!(" {it}"));
        lines! { sheet; "chain{}", name.collect::<String>(); }
        self.links(sheet)?;
        lines! { sheet; "stop\tteeth\tcentre x, y [mm]\tradius [mm]\tside\twrap [deg]\tseated\tgap at [deg]"; }
        for stop in &self.stops {
            let teeth = stop.teeth.map_or("–".to_owned(), |teeth| teeth.to_string());
            let ([x, y], radius) = (stop.centre.map(|x| x * 1e3), stop.radius * 1e3);
            let [wrap, seat] = [stop.wrap, stop.seat_angle].map(f64::to_degrees);
            lines! { sheet;
                "  {}\t{teeth}\t{x:.3} {y:>11.3}\t{radius:.4}\t{}\t{wrap:.3}\t{}\t{seat:.4}",
                    stop.name, stop.side, stop.seated;
            }
        }
        lines! { sheet; "span\tlinks\tlength [mm]\tdirection [deg]\tleaves x, y [mm]\tarrives x, y [mm]"; }
        for span in &self.spans {
            let [[a, b], [c, d]] = [span.leaves, span.arrives].map(|it| it.map(|x| x * 1e3));
            let (length, direction) = (span.length * 1e3, span.direction.to_degrees());
            lines! { sheet;
                "  {}\t{}\t{length:.3}\t{direction:.4}\t{a:.3} {b:>11.3}\t{c:.3} {d:>11.3}", span.name, span.links;
            }
        }
        // The first of several has the heading.
        let headings = |heading| std::iter::once(heading).chain(std::iter::repeat(""));
        for (heading, fit) in headings("would close").zip(&self.fits) {
            lines! { sheet; "{heading}\t{}", self.told(fit); }
        }
        for (heading, worn) in headings("worn by").zip(&self.wear) {
            let travel = worn.travel.map(|it| self.travelled(it));
            let travel = travel.unwrap_or("closes nowhere in reach".to_owned());
            lines! { sheet; "{heading}\t{:>4.2} %  {travel}", worn.elongation * 1e2; }
        }
        f.write_str(&aligned(sheet, NAMES))
    }
}

/// One number, or two that differ.
fn either(one: u32, other: u32) -> String {
    if one == other {
        one.to_string()
    } else {
        format!("{one} and {other}")
    }
}

impl ChainLayout {
    fn links(&self, sheet: &mut String) -> fmt::Result {
        let counts = &self.counts;
        let pitch = self.pitch * 1e3;
        let nearest = either(counts.below, counts.above);
        let even = either(counts.even_below, counts.even_above);
        lines! { sheet;
            "  the route takes\t{:.6} links of {pitch:.4} mm (smooth curve {:.4})", counts.pitches, counts.smooth;
            "  whole numbers\t{nearest}; even, without an offset link: {even}";
        }
        if let (Some(links), Some(misfit)) = (self.links, self.misfit) {
            let is = if misfit > 0.0 { "short" } else { "long" };
            let fits = if misfit.abs() < 1e-9 {
                "closes".to_owned()
            } else {
                format!("{:.4} mm too {is}", misfit.abs() * 1e3)
            };
            let odd = ["", ", with an offset link"][usize::from(links % 2 == 1)];
            lines! { sheet; "  with {links} links\t{fits}{odd}"; }
        }
        if let Some(travel) = self.travel {
            let body = self.fits.first().map_or("", |fit| &fit.body);
            lines! { sheet; "  adjusted\t{body} {}", self.travelled(travel); }
        }
        Ok(())
    }

    fn told(&self, fit: &Fit) -> String {
        let odd = if fit.offset_link {
            " with an offset link"
        } else {
            ""
        };
        let at = match (fit.centre_distance, fit.centre) {
            (Some(distance), _) => format!(", centre distance {:.6} mm", distance * 1e3),
            (None, Some([x, y])) => format!(", centre at ({:.6}, {:.6}) mm", x * 1e3, y * 1e3),
            (None, None) => String::new(),
        };
        let travel = self.travelled(fit.travel);
        format!("{} links{odd}: {} {travel}{at}", fit.links, fit.body)
    }

    /// A travel in words.
    fn travelled(&self, travel: f64) -> String {
        if self.turns {
            format!("turned by {:+.6} deg", travel.to_degrees())
        } else {
            format!("moved by {:+.6} mm", travel * 1e3)
        }
    }
}

//! A layout as text.

use std::fmt;

use super::{ChainLayout, Fit};

impl fmt::Display for ChainLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.chain {
            Some(name) => writeln!(f, "chain {name}")?,
            None => writeln!(f, "chain")?,
        }
        self.links(f)?;
        writeln!(
            f,
            "stop                     teeth   centre x, y [mm]          radius [mm]  side   wrap [deg]  seated  gap at [deg]"
        )?;
        for stop in &self.stops {
            let teeth = stop.teeth.map_or("–".to_owned(), |teeth| teeth.to_string());
            let [x, y] = stop.centre.map(|x| x * 1e3);
            writeln!(
                f,
                "  {:22} {teeth:>5}  {x:>11.3} {y:>11.3}  {:>13.4}  {:5} {:>11.3}  {:>6}  {:>12.4}",
                stop.name,
                stop.radius * 1e3,
                stop.side,
                stop.wrap.to_degrees(),
                stop.seated,
                stop.seat_angle.to_degrees()
            )?;
        }
        writeln!(
            f,
            "span                             links  length [mm]  direction [deg]  leaves x, y [mm]          arrives x, y [mm]"
        )?;
        for span in &self.spans {
            let [a, b] = span.leaves.map(|x| x * 1e3);
            let [c, d] = span.arrives.map(|x| x * 1e3);
            writeln!(
                f,
                "  {:30} {:>5}  {:>11.3}  {:>15.4}  {a:>11.3} {b:>11.3}  {c:>13.3} {d:>11.3}",
                span.name,
                span.links,
                span.length * 1e3,
                span.direction.to_degrees()
            )?;
        }
        for (place, fit) in self.fits.iter().enumerate() {
            let heading = if place == 0 { "would close" } else { "" };
            writeln!(f, "{heading:16} {}", self.told(fit))?;
        }
        for (place, worn) in self.wear.iter().enumerate() {
            let heading = if place == 0 { "worn by" } else { "" };
            let travel = worn
                .travel
                .map_or("closes nowhere in reach".to_owned(), |t| self.travelled(t));
            writeln!(f, "{heading:16} {:>4.2} %  {travel}", worn.elongation * 1e2)?;
        }
        Ok(())
    }
}

impl ChainLayout {
    fn links(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = &self.counts;
        let pitch = self.pitch * 1e3;
        writeln!(
            f,
            "  the route takes  {:.6} links of {pitch:.4} mm (smooth curve {:.4})",
            counts.pitches, counts.smooth
        )?;
        let nearest = if counts.below == counts.above {
            format!("{}", counts.below)
        } else {
            format!("{} and {}", counts.below, counts.above)
        };
        let even = if counts.even_below == counts.even_above {
            format!("{}", counts.even_below)
        } else {
            format!("{} and {}", counts.even_below, counts.even_above)
        };
        writeln!(
            f,
            "  whole numbers    {nearest}; even, without an offset link: {even}"
        )?;
        if let (Some(links), Some(misfit)) = (self.links, self.misfit) {
            let fits = if misfit.abs() < 1e-9 {
                "closes".to_owned()
            } else {
                let is = if misfit > 0.0 { "short" } else { "long" };
                format!("{:.4} mm too {is}", misfit.abs() * 1e3)
            };
            let odd = if links % 2 == 1 {
                ", with an offset link"
            } else {
                ""
            };
            writeln!(f, "  with {links} links   {fits}{odd}")?;
        }
        if let Some(travel) = self.travel {
            let body = self.fits.first().map_or("", |fit| &fit.body);
            writeln!(f, "  adjusted         {body} {}", self.travelled(travel))?;
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

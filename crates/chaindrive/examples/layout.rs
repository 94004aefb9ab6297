//! Links and centre distances of two sprockets, by geometry alone: `cargo run --release --example layout`.

use std::io::Write;

use chaindrive::design;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (teeth, pitch) = ([19, 57], 25.4e-3);
    let wanted = design::of_two_sprockets(teeth, pitch, Some(1.0), None)?;
    let links = wanted.counts.even_below;
    let fitted = design::of_two_sprockets(teeth, pitch, None, Some(links))?;
    for fit in fitted.fits.iter().filter(|fit| fit.links == links) {
        let distance = fit.centre_distance.unwrap_or(f64::NAN) * 1e3;
        writeln!(std::io::stdout(), "{links} links close at {distance:.3} mm")?;
    }
    Ok(())
}

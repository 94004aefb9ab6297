//! The work-precision diagram: error over wall time, both logarithmic, one line a method.

use std::error::Error;
use std::path::Path;

use chaindrive::precision::{Row, Table};
use plotters::prelude::*;

/// Size of the picture, in pixels.
const SIZE: (u32, u32) = (900, 600);

/// Draws the error of the tight span over wall time as SVG.
pub(super) fn draw(table: &Table, title: &str, to: &Path) -> Result<(), Box<dyn Error>> {
    let points: Vec<(f64, f64)> = table.rows.iter().filter_map(point).collect();
    let root = SVGBackend::new(to, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    // Without points there is nothing to draw but the frame.
    let wall = range(points.iter().map(|point| point.0), 1e-3);
    let error = range(points.iter().map(|point| point.1), 1e-2);
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 20))
        .margin(15)
        .x_label_area_size(45)
        .y_label_area_size(70)
        .build_cartesian_2d((wall.0..wall.1).log_scale(), (error.0..error.1).log_scale())?;
    chart
        .configure_mesh()
        .x_desc(format!("wall time for {:.2e} s [s]", table.window))
        .y_desc("error of the tight span, rms [–]")
        .max_light_lines(4)
        .x_label_formatter(&|value| format!("{value:.0e}"))
        .y_label_formatter(&|value| format!("{value:.0e}"))
        .draw()?;
    let agreement = table.agreement.tight_tension;
    if agreement > error.0 && agreement < error.1 {
        let line = [(wall.0, agreement), (wall.1, agreement)];
        chart
            .draw_series(LineSeries::new(line, BLACK.mix(0.4)))?
            .label("reference and check apart")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.mix(0.4)));
    }
    for (place, (name, line)) in lines(table).into_iter().enumerate() {
        let colour = Palette99::pick(place).to_rgba();
        chart
            .draw_series(LineSeries::new(line.clone(), colour.stroke_width(2)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        chart.draw_series(
            line.into_iter()
                .map(|at| Circle::new(at, 4, colour.filled())),
        )?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}

/// Wall time and error of a row that has both.
fn point(row: &Row) -> Option<(f64, f64)> {
    let point = (row.wall, row.errors.tight_tension);
    (point.0 > 0.0 && point.1 > 0.0 && point.1.is_finite()).then_some(point)
}

/// Rows of one method and onset depth, by wall time.
fn lines(table: &Table) -> Vec<(String, Vec<(f64, f64)>)> {
    let mut lines: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for row in &table.rows {
        let Some(at) = point(row) else { continue };
        let mut name = row.variant.stepping.name().to_owned();
        if let Some(depth) = row.variant.onset_depth {
            name = format!("{name}, onset {depth:.0e} m");
        }
        match lines.iter_mut().find(|(known, _)| *known == name) {
            Some((_, line)) => line.push(at),
            None => lines.push((name, vec![at])),
        }
    }
    for (_, line) in &mut lines {
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    lines
}

/// Range that holds all values, with some room; `usual` where there are none.
fn range(values: impl Iterator<Item = f64>, usual: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if high > 0.0 {
        (low / 2.0, high * 2.0)
    } else {
        (usual / 2.0, usual * 2.0)
    }
}

//! The work-precision diagram: error over wall time, both logarithmic, one line a method.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;

use chaindrive::draw::escaped;
use chaindrive::precision::{Row, Table};

/// Size of the picture, and of the margins left, below, right and above the axes \[px\].
const SIZE: [f64; 2] = [900.0, 600.0];
const MARGINS: [f64; 4] = [90.0, 60.0, 20.0, 50.0];

/// Height of a line of the legend \[px\].
const ROW: f64 = 20.0;

const STYLE: &str = "\
text{font-family:sans-serif;font-size:13px;fill:#767e87}\
.title{font-size:18px}\
.frame{fill:none;stroke:#767e87}\
.grid{stroke:#8d99a6;stroke-opacity:.35}\
.line{fill:none;stroke-width:2}\
.apart{stroke:#767e87;stroke-dasharray:6 4}\
.legend{fill:none;stroke:#8d99a6;stroke-opacity:.35}";

/// One colour a method, those of curves in `python/chaindrive/plot/scheme.py` (a test compares).
const COLOURS: [&str; 7] = [
    "#2f7ec2", "#d0661c", "#2f9148", "#a45fc0", "#14899c", "#cf4a7c", "#7d8c1f",
];

/// Draws the error of the tight span over wall time as SVG.
pub(super) fn draw(table: &Table, title: &str, to: &Path) -> io::Result<()> {
    fs::write(to, svg(table, title))
}

fn svg(table: &Table, title: &str) -> String {
    let points: Vec<[f64; 2]> = table.rows.iter().filter_map(point).collect();
    // Without points there is nothing to draw but the frame.
    let wall = Axis::around(points.iter().map(|point| point[0]), 1e-3);
    let error = Axis::around(points.iter().map(|point| point[1]), 1e-2);
    let [left, below, right, above] = MARGINS;
    let [width, height] = SIZE;
    let (end, bottom) = (width - right, height - below);
    let x = |value: f64| left + wall.share(value) * (end - left);
    let y = |value: f64| bottom - error.share(value) * (bottom - above);

    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n\
         <text class=\"title\" x=\"{:.0}\" y=\"30\" text-anchor=\"middle\">{title}</text>\n",
        width / 2.0,
        title = escaped(title),
    );
    let mut add = |line: std::fmt::Arguments<'_>| writeln!(out, "{line}").expect("a text grows");
    for tick in wall.ticks() {
        let x = x(tick);
        add(format_args!(
            "<path class=\"grid\" d=\"M{x:.1} {above}V{bottom}\"/>"
        ));
        add(format_args!(
            "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{tick:.0e}</text>",
            bottom + 18.0
        ));
    }
    for tick in error.ticks() {
        let y = y(tick);
        add(format_args!(
            "<path class=\"grid\" d=\"M{left} {y:.1}H{end}\"/>"
        ));
        add(format_args!(
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{tick:.0e}</text>",
            left - 8.0,
            y + 4.0
        ));
    }
    add(format_args!(
        "<rect class=\"frame\" x=\"{left}\" y=\"{above}\" width=\"{}\" height=\"{}\"/>",
        end - left,
        bottom - above
    ));
    add(format_args!(
        "<text x=\"{:.0}\" y=\"{}\" text-anchor=\"middle\">wall time for {:.2e} s [s]</text>",
        f64::midpoint(left, end),
        height - 15.0,
        table.window
    ));
    let middle = f64::midpoint(above, bottom);
    add(format_args!(
        "<text x=\"20\" y=\"{middle:.0}\" text-anchor=\"middle\" transform=\"rotate(-90 20 {middle:.0})\">error of the tight span, rms [–]</text>"
    ));

    let mut legend = Vec::new();
    let agreement = table.agreement.tight_tension;
    if error.holds(agreement) {
        let y = y(agreement);
        add(format_args!(
            "<path class=\"apart\" d=\"M{left} {y:.1}H{end}\"/>"
        ));
        legend.push((
            "class=\"apart\"".to_owned(),
            "reference and check apart".to_owned(),
        ));
    }
    for (colour, (name, line)) in COLOURS.iter().cycle().zip(lines(table)) {
        let places: Vec<String> = line
            .iter()
            .map(|at| format!("{:.1} {:.1}", x(at[0]), y(at[1])))
            .collect();
        add(format_args!(
            "<path class=\"line\" stroke=\"{colour}\" d=\"M{}\"/>",
            places.join("L")
        ));
        for at in &line {
            let (x, y) = (x(at[0]), y(at[1]));
            add(format_args!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\"/>"
            ));
        }
        legend.push((format!("class=\"line\" stroke=\"{colour}\""), name));
    }
    key(&mut out, &legend, [left + 10.0, bottom - 10.0]);
    out.push_str("</svg>\n");
    out
}

/// The legend, its lower left corner at a place: how every line looks, and its name.
fn key(out: &mut String, legend: &[(String, String)], [left, bottom]: [f64; 2]) {
    let mut add = |line: std::fmt::Arguments<'_>| writeln!(out, "{line}").expect("a text grows");
    let Some(letters) = legend.iter().map(|(_, name)| name.chars().count()).max() else {
        return;
    };
    let tall = ROW * legend.len() as f64 + 10.0;
    let top = bottom - tall;
    add(format_args!(
        "<rect class=\"legend\" x=\"{left}\" y=\"{top:.0}\" width=\"{:.0}\" height=\"{tall:.0}\"/>",
        7.5 * letters as f64 + 50.0
    ));
    for (row, (look, name)) in legend.iter().enumerate() {
        let y = top + 5.0 + ROW * (row as f64 + 0.5);
        add(format_args!(
            "<path {look} d=\"M{} {y:.0}h20\"/>",
            left + 8.0
        ));
        add(format_args!(
            "<text x=\"{}\" y=\"{:.0}\">{}</text>",
            left + 36.0,
            y + 4.0,
            escaped(name)
        ));
    }
}

/// A logarithmic axis.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    /// An axis that holds all values, with some room; around `usual` where there are none.
    fn around(values: impl Iterator<Item = f64>, usual: f64) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let (low, high) = if high > 0.0 {
            (low, high)
        } else {
            (usual, usual)
        };
        Self {
            low: low / 2.0,
            high: high * 2.0,
        }
    }

    fn holds(&self, value: f64) -> bool {
        value > self.low && value < self.high
    }

    /// Share of the axis before a value.
    fn share(&self, value: f64) -> f64 {
        (value / self.low).ln() / (self.high / self.low).ln()
    }

    /// Powers of ten; on an axis of less than two decades twice and five times these as well.
    fn ticks(&self) -> Vec<f64> {
        let decades = (self.high / self.low).log10();
        let factors: &[f64] = if decades < 2.0 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        #[expect(
            clippy::cast_possible_truncation,
            reason = "exponents of doubles are small"
        )]
        let [first, last] = [self.low, self.high].map(|end| end.log10().floor() as i32);
        (first..=last)
            .flat_map(|power| {
                factors
                    .iter()
                    .map(move |factor| factor * 10.0_f64.powi(power))
            })
            .filter(|&tick| self.holds(tick))
            .collect()
    }
}

/// Wall time and error of a row that has both.
fn point(row: &Row) -> Option<[f64; 2]> {
    let point = [row.wall, row.errors.tight_tension];
    (point[0] > 0.0 && point[1] > 0.0 && point[1].is_finite()).then_some(point)
}

/// Rows of one method and onset depth, by wall time.
fn lines(table: &Table) -> Vec<(String, Vec<[f64; 2]>)> {
    let mut lines: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
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
        line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    lines
}

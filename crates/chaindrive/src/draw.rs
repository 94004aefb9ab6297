//! Drawings: a pose as SVG.
//!
//! Coordinates are those of the drive in millimetres, x to the right and y upwards: every outline stands where it is, without
//! a transformation of its own, so that distances can be measured in the file. Only the group around all of it is turned over, since
//! y points down in SVG. Every part has an `id`: `sprocket-crank`, `guide-shoe`, `arm-blade`, `roller-17`, `plate-17`; where there are
//! several chains `roller-primary-17`.

mod marks;
mod path;
mod view;

use std::fmt::Write;

use chaindrive_geometry::{Piece, Vector};
use chaindrive_mechanics::{Body, BodyKind, Figure, FigureChain, Placement, Pose};

pub use path::escaped;
use path::{id, millimetres, outline, placed, polygon, polyline};
use view::View;

/// Looks of all parts, for drawings alone: pages that hold one have other pictures too. Lines keep their width whatever the size.
///
/// The colours are those of `python/chaindrive/plot/scheme.py` (a test compares), to be seen on light and dark paper alike.
const STYLE: &str = "\
.chaindrive path,.chaindrive circle,.chaindrive line{vector-effect:non-scaling-stroke;stroke:#6b7784;stroke-width:.7;fill:none;stroke-linejoin:round;stroke-linecap:round}
.chaindrive .sprocket{fill:#8d99a6;fill-opacity:.2}
.chaindrive .face{stroke:#b9702c;stroke-width:1.4}
.chaindrive .backing{fill:#b9702c;fill-opacity:.4;stroke:none}
.chaindrive .arm,.chaindrive .slider{stroke:#7d8a52;stroke-width:4;stroke-opacity:.7}
.chaindrive .plunger{stroke:#7d8a52;stroke-width:2}
.chaindrive .pivot{fill:#7d8a52;stroke:#7d8a52}
.chaindrive .roller{fill:#8d99a6;fill-opacity:.2}
.chaindrive .plate{fill:#2f7ec2;fill-opacity:.45;stroke-width:.4}
.chaindrive .rotation{stroke:#767e87;stroke-width:1.4}
.chaindrive .force,.chaindrive .carrier-force{stroke:#cf4a7c;stroke-width:2}
.chaindrive .mark{stroke:#d6324a;stroke-width:2}
.chaindrive text{font-family:sans-serif;fill:#767e87}
.chaindrive .told{fill:#d6324a}";

/// A pose as the text of an SVG file.
pub fn svg(figure: &Figure, pose: &Pose, title: &str) -> String {
    let view = View::of(figure, pose);
    let mut out = view.head(title, figure.problem.as_deref(), STYLE);
    let bodies = || figure.bodies.iter().zip(&pose.placements);
    // Carriers lie behind what they carry, sprockets before guides, and arrows of forces before all.
    let layers = [
        |kind: &BodyKind| matches!(kind, BodyKind::Carrier { .. } | BodyKind::Plunger),
        |kind: &BodyKind| matches!(kind, BodyKind::Guide { .. }),
        |kind: &BodyKind| matches!(kind, BodyKind::Sprocket { .. }),
        |kind: &BodyKind| matches!(kind, BodyKind::Force { .. }),
    ];
    for within in layers {
        for (index, (body, placement)) in bodies().enumerate() {
            if within(&body.kind) {
                self::body(&mut out, body, placement);
                rotation(&mut out, figure, index, placement);
            }
        }
    }
    for (index, chain) in figure.chains.iter().enumerate() {
        self::chain(&mut out, chain, index, pose);
    }
    view.names(&mut out, figure, pose);
    marks::draw(&mut out, &view, figure);
    out.push_str("</g>\n</svg>\n");
    out
}

fn body(out: &mut String, body: &Body, placement: &Placement) {
    let kind = body.kind.name();
    let id = id(&[kind, &body.name]);
    if !body.backing.is_empty() {
        let places: Vec<_> = body.backing.iter().map(|p| placement.place(*p)).collect();
        let outline = polygon(&places);
        line(
            out,
            format_args!("<path id=\"{id}-backing\" class=\"backing\" d=\"{outline}\"/>"),
        );
    }
    let class = if matches!(body.kind, BodyKind::Guide { .. }) {
        "face"
    } else {
        kind
    };
    let mut lines = String::new();
    for line in &body.outlines {
        lines.push_str(&outline(&placed(line, placement), line.is_closed()));
    }
    line(
        out,
        format_args!("<path id=\"{id}\" class=\"{class}\" d=\"{lines}\"/>"),
    );
    let [x, y] = [placement.x, placement.y].map(millimetres);
    match body.kind {
        BodyKind::Sprocket { pitch_radius, .. } => {
            // The spoke shows how far the sprocket has turned.
            let end = placement.place(chaindrive_geometry::Point::new(0.0, 0.4 * pitch_radius));
            let [to_x, to_y] = [end.x, end.y].map(millimetres);
            line(
                out,
                format_args!(
                    "<line id=\"{id}-spoke\" x1=\"{x}\" y1=\"{y}\" x2=\"{to_x}\" y2=\"{to_y}\"/>"
                ),
            );
        }
        BodyKind::Carrier { pivots: true, .. } => {
            let pivot = format!(
                "<circle id=\"{id}-pivot\" class=\"pivot\" cx=\"{x}\" cy=\"{y}\" r=\"2\"/>"
            );
            line(out, format_args!("{pivot}"));
        }
        BodyKind::Guide { .. }
        | BodyKind::Carrier { .. }
        | BodyKind::Plunger
        | BodyKind::Force { .. } => {}
    }
}

/// The arrow that shows which way a sprocket turns.
fn rotation(out: &mut String, figure: &Figure, index: usize, placement: &Placement) {
    let Some(arrow) = figure.rotation_arrow(index) else {
        return;
    };
    let to = Vector::new(placement.x, placement.y);
    let shaft = outline(&[Piece::Arc(arrow.arc).translated(to)], false);
    let head = polyline(&arrow.head.map(|p| p + to));
    let id = id(&["rotation", &figure.bodies[index].name]);
    line(
        out,
        format_args!("<path id=\"{id}\" class=\"rotation\" d=\"{shaft}{head}\"/>"),
    );
}

fn chain(out: &mut String, chain: &FigureChain, index: usize, pose: &Pose) {
    let name = chain.name.as_deref();
    let numbered = |kind: &str, number: usize| match name {
        Some(name) => id(&[kind, name, &number.to_string()]),
        None => id(&[kind, &number.to_string()]),
    };
    let radius = millimetres(0.5 * chain.roller_diameter);
    for (number, roller) in pose.rollers[index].iter().enumerate() {
        let id = numbered("roller", number);
        let [x, y] = [roller.x, roller.y].map(millimetres);
        line(
            out,
            format_args!(
                "<circle id=\"{id}\" class=\"roller\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>"
            ),
        );
    }
    for (number, [from, to]) in pose.plates[index].iter().enumerate() {
        let along = to - from;
        // A link without a length has no plate.
        let Ok(plate) = chain.plate(along.norm()) else {
            continue;
        };
        let placement = Placement {
            x: from.x,
            y: from.y,
            angle: along.y.atan2(along.x),
        };
        let id = numbered("plate", number);
        let outline = outline(&placed(&plate, &placement), true);
        line(
            out,
            format_args!("<path id=\"{id}\" class=\"plate\" d=\"{outline}\"/>"),
        );
    }
}

/// Appends a line. Writing to a text does not fail.
fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = writeln!(out, "{text}");
}

//! Surroundings of the parts in a drawing: the window, the title, names.

use chaindrive_geometry::{ArcSpline, Point, Vector};
use chaindrive_mechanics::{Body, BodyKind, Figure, Placement, Pose};

use super::line;
use super::path::{escaped, id, millimetres};

/// Width of a drawing on a screen \[px\].
const WIDTH: f64 = 960.0;
/// Height that it does not exceed \[px\].
const HEIGHT: f64 = 720.0;
/// Letters of a line of text, about as many as fit beside each other.
const LETTERS: usize = 90;

/// Mean width of a letter in its height.
const LETTER_WIDTH: f64 = 0.55;

/// The window of a drawing.
pub(super) struct View {
    low: Point,
    high: Point,
    /// Height of letters \[m\].
    pub(super) letter: f64,
    /// Middle of the drive \[m\].
    middle: f64,
}

impl View {
    /// A window with room for everything.
    pub(super) fn of(figure: &Figure, pose: &Pose) -> Self {
        let mut low = Point::new(f64::INFINITY, f64::INFINITY);
        let mut high = -low;
        let mut room = |p: Point, around: f64| {
            if p.x.is_finite() && p.y.is_finite() {
                low = Point::new(low.x.min(p.x - around), low.y.min(p.y - around));
                high = Point::new(high.x.max(p.x + around), high.y.max(p.y + around));
            }
        };
        for (body, placement) in figure.bodies.iter().zip(&pose.placements) {
            if let BodyKind::Sprocket { tip_radius, .. } = body.kind {
                room(Point::new(placement.x, placement.y), tip_radius);
                continue;
            }
            for piece in body.outlines.iter().flat_map(ArcSpline::pieces) {
                for share in [0.0, 0.5, 1.0] {
                    room(placement.place(piece.point(share)), 0.0);
                }
            }
            for corner in &body.backing {
                room(placement.place(*corner), 0.0);
            }
        }
        for (chain, rollers) in figure.chains.iter().zip(&pose.rollers) {
            let around = 0.5 * chain.plate_height.max(chain.roller_diameter);
            for roller in rollers {
                room(*roller, around);
            }
        }
        if low.x > high.x {
            (low, high) = (Point::origin(), Point::new(0.1, 0.1));
        }
        let size = high - low;
        let margin = 0.03 * size.x.max(size.y);
        let letter = 0.018 * size.x.max(size.y);
        let middle = 0.5 * (low.x + high.x);
        for (body, placement) in figure.bodies.iter().zip(&pose.placements) {
            if let Some((at, anchor)) = name_of(figure, body, placement, letter, middle) {
                let name = TextBox::new(at, anchor, body, letter);
                (low.x, high.x) = (low.x.min(name.left), high.x.max(name.right));
            }
        }
        let margin = Vector::new(margin, margin);
        Self {
            low: low - margin,
            high: high + margin,
            letter,
            middle,
        }
    }

    /// The beginning of the file, up to the group in which y points upwards.
    pub(super) fn head(&self, title: &str, problem: Option<&str>, style: &str) -> String {
        let told: Vec<String> = problem.map(lines).unwrap_or_default();
        let below = 1.4 * self.letter * told.len() as f64;
        let size = self.high - self.low;
        let (width, height) = (size.x, size.y + below);
        // Pixels of a screen for a metre of the drive.
        let scale = (WIDTH / width).min(HEIGHT / height);
        let mut out = String::new();
        line(
            &mut out,
            format_args!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chaindrive\" width=\"{:.0}\" height=\"{:.0}\" viewBox=\"{} {} {} {}\">",
                width * scale,
                height * scale,
                millimetres(self.low.x),
                millimetres(-self.high.y),
                millimetres(width),
                millimetres(height)
            ),
        );
        line(&mut out, format_args!("<title>{}</title>", escaped(title)));
        line(&mut out, format_args!("<style>{style}</style>"));
        for (row, text) in told.iter().enumerate() {
            let y = -self.low.y + 1.4 * self.letter * (row as f64 + 0.5);
            line(
                &mut out,
                format_args!(
                    "<text class=\"told\" x=\"{}\" y=\"{}\" font-size=\"{}\">{}</text>",
                    millimetres(self.low.x + self.letter),
                    millimetres(y),
                    millimetres(self.letter),
                    escaped(text)
                ),
            );
        }
        line(&mut out, format_args!("<g transform=\"scale(1 -1)\">"));
        out
    }

    /// A text at a place, its middle there.
    pub(super) fn text(&self, out: &mut String, ids: [&str; 2], at: Point, text: &str) {
        self.anchored(out, ids, (at, "middle"), text);
    }

    /// A text whose `start`, `middle` or `end` is at a place.
    fn anchored(
        &self,
        out: &mut String,
        [id, class]: [&str; 2],
        (at, anchor): (Point, &str),
        text: &str,
    ) {
        line(
            out,
            format_args!(
                "<text id=\"{id}\" class=\"{class}\" transform=\"translate({} {}) scale(1 -1)\" font-size=\"{}\" text-anchor=\"{anchor}\">{}</text>",
                millimetres(at.x),
                millimetres(at.y),
                millimetres(self.letter),
                escaped(text)
            ),
        );
    }

    /// Names of sprockets above their centres, of guides at the middle of their faces; a name that would lie on an earlier one
    /// stands above it.
    pub(super) fn names(&self, out: &mut String, figure: &Figure, pose: &Pose) {
        let mut written: Vec<TextBox> = Vec::new();
        for (body, placement) in figure.bodies.iter().zip(&pose.placements) {
            let id = id(&["name", body.kind.name(), &body.name]);
            let Some((at, anchor)) = name_of(figure, body, placement, self.letter, self.middle)
            else {
                continue;
            };
            let mut name = TextBox::new(at, anchor, body, self.letter);
            let height = 1.2 * self.letter;
            while let Some(other) = written.iter().find(|it| it.meets(&name, height)) {
                name.base = other.base + height;
            }
            let at = Point::new(at.x, name.base);
            written.push(name);
            self.anchored(out, [&id, "name"], (at, anchor), &body.name);
        }
    }
}

/// The room that a name takes \[m\].
struct TextBox {
    left: f64,
    right: f64,
    base: f64,
}

impl TextBox {
    fn new(at: Point, anchor: &str, body: &Body, letter: f64) -> Self {
        let width = LETTER_WIDTH * letter * body.name.chars().count() as f64;
        let left = match anchor {
            "start" => at.x,
            "end" => at.x - width,
            _ => at.x - 0.5 * width,
        };
        Self {
            left,
            right: left + width,
            base: at.y,
        }
    }

    /// Overlap of two names of one height, to within rounding.
    fn meets(&self, other: &Self, height: f64) -> bool {
        let apart = (self.base - other.base).abs();
        self.left < other.right && other.left < self.right && apart < 0.999 * height
    }
}

/// Place of the name of a body, and the end that stands there, if it has one: of a sprocket at its centre, or beside it and its chain where
/// it has no room, away from the middle of the drive.
fn name_of(
    figure: &Figure,
    body: &Body,
    placement: &Placement,
    letter: f64,
    middle: f64,
) -> Option<(Point, &'static str)> {
    match body.kind {
        BodyKind::Sprocket { pitch_radius, .. } => {
            let width = LETTER_WIDTH * letter * body.name.chars().count() as f64;
            if width < 1.3 * pitch_radius {
                let above = Point::new(placement.x, placement.y + 0.6 * letter);
                return Some((above, "middle"));
            }
            let plates = figure.chains.iter().map(|chain| 0.5 * chain.plate_height);
            let aside = pitch_radius + plates.fold(0.0, f64::max) + letter;
            let y = placement.y - 0.4 * letter;
            Some(if placement.x > middle {
                (Point::new(placement.x + aside, y), "start")
            } else {
                (Point::new(placement.x - aside, y), "end")
            })
        }
        BodyKind::Guide { .. } => Some(name_of_guide(body, placement, letter)),
        BodyKind::Carrier { .. } | BodyKind::Plunger | BodyKind::Force { .. } => None,
    }
}

/// Where the name of a guide stands, and by which end: on the side of the material, away from the chain.
fn name_of_guide(body: &Body, placement: &Placement, letter: f64) -> (Point, &'static str) {
    let Some(face) = body.outlines.first() else {
        return (Point::new(placement.x, placement.y), "middle");
    };
    let middle = face.point_at(0.5 * face.length());
    let foot = face.nearest(middle, f64::INFINITY);
    let behind = foot.map_or(middle, |foot| middle - foot.normal * (2.0 * letter));
    let [middle, at] = [middle, behind].map(|p| placement.place(p));
    let aside = at.x - middle.x;
    let anchor = if aside.abs() < 0.5 * letter {
        "middle"
    } else if aside > 0.0 {
        "start"
    } else {
        "end"
    };
    (Point::new(at.x, at.y - 0.4 * letter), anchor)
}

/// A message in lines that fit beside the drawing.
fn lines(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for paragraph in text.lines() {
        for word in paragraph.split_whitespace() {
            let last = lines.last_mut().expect("one line at least");
            if !last.is_empty() && last.chars().count() + word.chars().count() > LETTERS {
                lines.push(word.to_owned());
            } else {
                if !last.is_empty() {
                    last.push(' ');
                }
                last.push_str(word);
            }
        }
        lines.push(String::new());
    }
    lines.retain(|line| !line.is_empty());
    lines
}

//! Marks: where a chain does not close, and what is in each other's way.

use chaindrive_geometry::Point;
use chaindrive_mechanics::Figure;

use super::line;
use super::path::millimetres;
use super::view::View;

/// Marks every gap and clash of a figure, with its size in words.
pub(super) fn draw(out: &mut String, view: &View, figure: &Figure) {
    for (number, gap) in figure.gaps.iter().enumerate() {
        let [x1, y1, x2, y2] = [gap.end.x, gap.end.y, gap.start.x, gap.start.y].map(millimetres);
        line(
            out,
            format_args!(
                "<line id=\"gap-{number}\" class=\"mark\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>"
            ),
        );
        let middle = gap.end + 0.5 * (gap.start - gap.end);
        circle(out, &format!("gap-{number}-circle"), middle, view.letter);
        let above = Point::new(middle.x, middle.y + 1.5 * view.letter);
        view.text(
            out,
            [&format!("gap-{number}-told"), "told"],
            above,
            &gap.to_string(),
        );
    }
    for (number, clash) in figure.clashes.iter().enumerate() {
        let id = format!("clash-{number}");
        circle(
            out,
            &id,
            clash.place(),
            view.letter.max(0.5 * clash.depth()),
        );
        let told = format!("{:.1} mm", clash.depth() * 1e3);
        let above = Point::new(clash.place().x, clash.place().y + 1.5 * view.letter);
        view.text(out, [&format!("{id}-told"), "told"], above, &told);
    }
}

fn circle(out: &mut String, id: &str, at: Point, radius: f64) {
    let [x, y, r] = [at.x, at.y, radius].map(millimetres);
    line(
        out,
        format_args!("<circle id=\"{id}\" class=\"mark\" cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>"),
    );
}

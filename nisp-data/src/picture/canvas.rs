//! Writes SVG elements. Knows nothing of figures.

use std::fmt::Write;

use super::Picture;
use super::style::{FONT, INK};
use super::text::{self, num};

/// An SVG document under construction.
pub(super) struct Canvas {
    body: String,
    clips: usize,
}

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Stroke<'a> {
    pub(super) colour: &'a str,
    pub(super) width: f64,
    /// SVG dash pattern, empty for a solid line.
    pub(super) dash: &'a str,
}

impl<'a> Stroke<'a> {
    pub(super) fn solid(colour: &'a str, width: f64) -> Stroke<'a> {
        Stroke { colour, width, dash: "" }
    }
}

/// Where the given point lies on the text.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A rectangle in figure units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Frame {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

impl Canvas {
    pub(super) fn new() -> Canvas {
        Canvas { body: String::new(), clips: 0 }
    }

    /// Closes the document at the size the layout turned out to need.
    pub(super) fn finish(self, width: f64, height: f64, description: &str) -> Picture {
        let (w, h, about) = (num(width), num(height), text::escape(description));
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" font-family=\"{FONT}\" fill=\"{INK}\" role=\"img\">\n\
             <title>{about}</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        );
        Picture { svg }
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing into a String cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke<'_>) {
        self.polyline(&[from, to], stroke);
    }

    pub(super) fn polyline(&mut self, points: &[[f64; 2]], stroke: Stroke<'_>) {
        self.push(format_args!(
            "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>",
            path(points, false),
            stroke.colour,
            num(stroke.width),
            dash(stroke.dash)
        ));
    }

    /// Many separate pieces of a line, as one element.
    pub(super) fn pieces(&mut self, pieces: &[[[f64; 2]; 2]], stroke: Stroke<'_>) {
        let d: String = pieces.iter().map(|piece| path(piece, false)).collect();
        let (colour, width) = (stroke.colour, num(stroke.width));
        self.push(format_args!(
            "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
        ));
    }

    pub(super) fn polygon(&mut self, points: &[[f64; 2]], fill: &str, opacity: f64) {
        let opacity = num(opacity);
        self.push(format_args!("<path d=\"{}\" fill=\"{fill}\" fill-opacity=\"{opacity}\"/>", path(points, true)));
    }

    /// The outline of a closed curve.
    pub(super) fn outline(&mut self, points: &[[f64; 2]], stroke: Stroke<'_>) {
        let width = num(stroke.width);
        self.push(format_args!(
            "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{}/>",
            path(points, true),
            stroke.colour,
            dash(stroke.dash)
        ));
    }

    pub(super) fn rect(&mut self, frame: Frame, fill: &str, stroke: Option<Stroke<'_>>) {
        let Frame { left, top, width, height } = frame;
        let border = stroke.map_or(String::new(), |stroke| {
            format!(" stroke=\"{}\" stroke-width=\"{}\"", stroke.colour, num(stroke.width))
        });
        let (x, y, w, h) = (num(left), num(top), num(width), num(height));
        self.push(format_args!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"{fill}\"{border}/>"));
    }

    /// Many dots of one kind, as one element: zero-length strokes with round ends.
    pub(super) fn dots(&mut self, points: &[[f64; 2]], radius: f64, colour: &str) {
        if points.is_empty() || radius <= 0.0 {
            return;
        }
        let mut d = String::with_capacity(points.len() * 16);
        for [x, y] in points {
            let _ = write!(d, "M{} {}h0", num(*x), num(*y));
        }
        let width = num(2.0 * radius);
        self.push(format_args!(
            "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
        ));
    }

    /// A text; `^{..}` and `_{..}` are raised and lowered.
    pub(super) fn text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, content: &str) {
        self.styled_text(at, size, anchor, content, INK, "");
    }

    pub(super) fn coloured_text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, content: &str, colour: &str) {
        self.styled_text(at, size, anchor, content, colour, "");
    }

    pub(super) fn bold_text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, content: &str) {
        self.styled_text(at, size, anchor, content, INK, " font-weight=\"bold\"");
    }

    /// A text that reads upwards.
    pub(super) fn upward_text(&mut self, at: [f64; 2], size: f64, content: &str) {
        let turn = format!(" transform=\"rotate(-90 {} {})\"", num(at[0]), num(at[1]));
        self.styled_text(at, size, Anchor::Middle, content, INK, &turn);
    }

    fn styled_text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, content: &str, colour: &str, extra: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y, size_text) = (num(at[0]), num(at[1]), num(size));
        let spans = text::spans(content, size);
        self.push(format_args!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size_text}\" text-anchor=\"{anchor}\" fill=\"{colour}\"{extra}>{spans}</text>"
        ));
    }

    /// Everything `draw` adds is cut at the frame.
    pub(super) fn clipped(&mut self, frame: Frame, draw: impl FnOnce(&mut Canvas)) {
        let corners = [
            [frame.left, frame.top],
            [frame.right(), frame.top],
            [frame.right(), frame.bottom()],
            [frame.left, frame.bottom()],
        ];
        self.clipped_to(&corners, draw);
    }

    /// Everything `draw` adds is cut at the polygon.
    pub(super) fn clipped_to(&mut self, polygon: &[[f64; 2]], draw: impl FnOnce(&mut Canvas)) {
        self.clips += 1;
        let id = self.clips;
        self.push(format_args!("<clipPath id=\"clip{id}\"><path d=\"{}\"/></clipPath>", path(polygon, true)));
        self.push(format_args!("<g clip-path=\"url(#clip{id})\">"));
        draw(self);
        self.push(format_args!("</g>"));
    }

    /// An embedded PNG stretched over the frame.
    pub(super) fn image(&mut self, frame: Frame, png_base64: &str) {
        let (x, y, w, h) = (num(frame.left), num(frame.top), num(frame.width), num(frame.height));
        self.push(format_args!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" \
             xlink:href=\"data:image/png;base64,{png_base64}\"/>"
        ));
    }
}

fn dash(pattern: &str) -> String {
    if pattern.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{pattern}\"") }
}

fn path(points: &[[f64; 2]], closed: bool) -> String {
    let mut d = String::with_capacity(points.len() * 14);
    for (index, [x, y]) in points.iter().enumerate() {
        let _ = write!(d, "{}{} {}", if index == 0 { 'M' } else { 'L' }, num(*x), num(*y));
    }
    if closed {
        d.push('Z');
    }
    d
}

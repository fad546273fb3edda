//! Figures as SVG, drawn here so that one file serves light and dark, a page and a printer: colours are classes, text is
//! text. (The crate plotters writes fixed colours, and text as it measures it itself.)

mod bars;
mod chart;
mod drawing;
mod escape;
mod frame;
mod matrix;
mod ramp;
mod roads;
mod scale;
mod spans;
mod style;
mod tracks;

pub use bars::Bars;
pub use chart::{Band, Chart, Curve};
pub use drawing::Figure;
pub use escape::escape;
pub use matrix::Matrix;
pub use ramp::Ramp;
pub use roads::{Event, Road, Roads};
pub use spans::{Span, Spans};
pub use style::{STEPS, hue, step_rgb, style};
pub use tracks::Tracks;

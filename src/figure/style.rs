//! Colours and strokes of all figures, in light and dark. A drawing names classes, so that one drawing serves both.

use super::escape::escape;

/// The strokes of all figures, and the colours of what is not a controller. `currentColor` of a hue is its colour.
const BASE: &str = "\
.fig{font:12px system-ui,'Segoe UI',Roboto,sans-serif;color:#1c2430;background:#fff}\
.fig text{fill:currentColor}.fig .title{font-size:14px;font-weight:600}.fig .soft{fill:#5b6675}\
.fig .grid{stroke:#e3e7ec;stroke-width:1}.fig .axis{stroke:#8a94a3;stroke-width:1}.fig .plot{fill:#fafbfc}\
.fig path{fill:none;stroke:currentColor;stroke-width:1.8;stroke-linejoin:round}\
.fig circle,.fig .bar{fill:currentColor;stroke:none}.fig .law{stroke-width:1.6}\
.fig .reference{stroke:#5b6675;stroke-dasharray:5 4;stroke-width:1.4}\
.fig .mark{fill:none;stroke:#c2185b;stroke-width:3}.fig .cell{font-size:10px;fill:#14181f}\
.fig .band{fill:currentColor;fill-opacity:.16;stroke:none}.fig .whisker{stroke:currentColor;stroke-width:1.6}\
.fig .box{fill:currentColor;fill-opacity:.22;stroke:currentColor;stroke-width:1.4}\
.fig .thin{stroke-width:1.1}.fig .level{stroke-width:1.3;stroke-dasharray:2 3}.fig .strip{stroke-width:9;stroke-opacity:.55}\
.fig .road{stroke-width:3;stroke-linecap:round;vector-effect:non-scaling-stroke}\
.fig .empty{stroke:#c9d0d9;stroke-width:1.2;vector-effect:non-scaling-stroke}\
.fig .event{fill:#c2185b;stroke:#fff;stroke-width:1.5;vector-effect:non-scaling-stroke}.fig .full{fill:currentColor;stroke:none}\
.fig .conflict{fill:none;stroke:#c2185b;stroke-width:1.6;vector-effect:non-scaling-stroke}\
.fig .value{font-size:12px}\
@media(prefers-color-scheme:dark){.fig{color:#e4e9f0;background:#151a21}.fig .soft{fill:#9aa7b8}.fig .grid{stroke:#2a323d}\
.fig .axis{stroke:#66717f}.fig .plot{fill:#1a2029}.fig .reference{stroke:#9aa7b8}.fig .mark{stroke:#ff6fa3}\
.fig .empty{stroke:#3b4553}.fig .event{fill:#ff6fa3;stroke:#151a21}.fig .conflict{stroke:#ff6fa3}}";

/// The hues in light and dark. Neighbours stay apart for every kind of colour vision.
const HUES: [[&str; 2]; 8] = [
    ["#1765ad", "#5fb0f5"],
    ["#d1610a", "#ff9d4d"],
    ["#2e8540", "#63c97c"],
    ["#a02c8c", "#f08ad8"],
    ["#7a4fb5", "#b99af0"],
    ["#00798c", "#4cc9d8"],
    ["#8a6d00", "#e0bd3a"],
    ["#7d4b3a", "#d39b86"],
];

/// Viridis (Smith and van der Walt 2015), without the end that its background would swallow: from the colour nearest to
/// the background to the farthest, so that more of a value stands out more. Readable with every kind of colour vision.
const RAMP: [[&str; 2]; 9] = [
    ["#b4de2c", "#414487"],
    ["#6dcd59", "#355f8d"],
    ["#35b779", "#2a788e"],
    ["#1f9e89", "#21918c"],
    ["#26828e", "#22a884"],
    ["#31688e", "#44bf70"],
    ["#3e4a89", "#7ad151"],
    ["#482878", "#bddf26"],
    ["#440154", "#fde725"],
];

/// The number of steps of [`RAMP`]: the classes `v0`, `v1`, ...
pub const STEPS: usize = RAMP.len();

/// A step as red, green and blue, in the shades for a dark background: more is brighter.
pub fn step_rgb(step: usize) -> [u8; 3] {
    let hex = u32::from_str_radix(&RAMP[step.min(STEPS - 1)][1][1..], 16).expect("RAMP has six hexadecimal digits");
    [hex >> 16, hex >> 8, hex].map(|byte| (byte & 0xff) as u8)
}

/// The styles that every page and file with figures needs.
pub fn style() -> String {
    let rules = |shade: usize| {
        let rule = |(i, hue): (usize, &[&str; 2])| format!(".fig .hue{i}{{color:{}}}", hue[shade]);
        // Text on a step is dark where the step is light: at the beginning of the ramp in light, at its end in dark.
        let ink = |i: usize| if (i < STEPS / 2) == (shade == 0) { "#14181f" } else { "#fff" };
        let step = |(i, step): (usize, &[&str; 2])| {
            format!(".fig .v{i}{{color:{}}}.fig .v{i} .value{{fill:{}}}", step[shade], ink(i))
        };
        HUES.iter().enumerate().map(rule).chain(RAMP.iter().enumerate().map(step)).collect::<String>()
    };
    format!("{BASE}{}@media(prefers-color-scheme:dark){{{}}}", rules(0), rules(1))
}

/// The class of the hue of a controller, or of something else that has this place among those beside it.
pub fn hue(name: &str, place: usize) -> String {
    let known = crate::control::CONTROLLERS.iter().position(|entry| entry.name == name);
    format!("hue{}", known.unwrap_or(place) % HUES.len())
}

/// The class of a controller's hue, by its place among the controllers; any other name is a class itself.
pub fn class(name: &str) -> String {
    let place = crate::control::CONTROLLERS.iter().position(|entry| entry.name == name);
    place.map_or_else(|| escape(name), |i| format!("hue{}", i % HUES.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_controller_has_a_colour_in_light_and_dark() {
        let style = style();
        let names = crate::control::CONTROLLERS.iter().map(|entry| class(entry.name));
        let classes: std::collections::BTreeSet<String> = names.collect();
        assert_eq!(
            classes.len(),
            crate::control::CONTROLLERS.len().min(HUES.len()),
            "no two share one while there are enough"
        );
        for class in classes {
            assert_eq!(style.matches(&format!(".{class}{{color:#")).count(), 2, "{class}");
        }
    }
}

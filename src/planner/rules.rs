//! The rules of DESIGN 7, but for that of multiple scattering.

use std::fmt;

use crate::graph::Decision;
use crate::light::chromaticity;
use crate::optics::directions::LineSet;
use crate::wire::Channels;

/// A number for people: at most four digits.
pub fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    let is_plain = rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs());
    if is_plain { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// An RGB as one number where it is grey.
fn color([red, green, blue]: [f64; 3]) -> String {
    if red == green && green == blue {
        return number(red);
    }
    [red, green, blue].map(number).join(" ")
}

/// `1 beam`, `2 beams`.
fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// All that has a color.
#[derive(Debug, Clone, Default)]
pub struct Colors {
    /// Of the medium.
    pub albedo: [f64; 3],
    /// Whether the medium emits; flames of several temperatures have several colors.
    pub glows: bool,
    /// Of all light that enters, of any unit.
    pub lights: Vec<[f64; 3]>,
    /// Of surfaces.
    pub reflectances: Vec<[f64; 3]>,
    /// Whether light that is known already has three channels.
    pub has_rgb_fields: bool,
}

/// Components of two chromaticities that differ by less are the same color.
const SAME: f64 = 1e-6;

/// How many channels are computed.
pub fn channels(colors: &Colors, prune: bool) -> (Channels, Decision) {
    let Colors { albedo, glows, reflectances, has_rgb_fields, .. } = colors;
    let found = colors.of_light();
    let is_grey = |color: &[f64; 3]| color.iter().all(|share| *share == color[0]);
    let three = |reason: &str| (Channels::RGB, three_channels(reason, colors));
    if !prune {
        return three("everything is modeled");
    }
    if !is_grey(albedo) {
        return three("the albedo differs from channel to channel");
    }
    if *glows {
        return three("what the medium emits has many colors");
    }
    if !reflectances.iter().all(is_grey) {
        return three("surfaces reflect in color");
    }
    if found.len() > 1 || *has_rgb_fields {
        return three("lights have several colors: optical depths are shared, scattered light is not");
    }
    let color = found.first().copied().unwrap_or([1.0; 3]);
    let reason = "matter is grey and all light has one color";
    let decision = Decision::left_out(CHANNELS, "two of three channels", reason, colors.to_string());
    (Channels { count: 1, color }, decision)
}

const CHANNELS: &str = "channels";

/// What to say where all three channels are computed.
pub fn three_channels(reason: &str, colors: &Colors) -> Decision {
    Decision::kept(CHANNELS, "three channels", reason, colors.to_string())
}

impl Colors {
    /// Chromaticities of the light, each once.
    fn of_light(&self) -> Vec<[f64; 3]> {
        let mut found: Vec<[f64; 3]> = Vec::new();
        for (_, light) in self.lights.iter().filter_map(|light| chromaticity(*light)) {
            let same = |other: &[f64; 3]| other.iter().zip(light).all(|(a, b)| (a - b).abs() < SAME);
            if !found.iter().any(same) {
                found.push(light);
            }
        }
        found
    }
}

impl fmt::Display for Colors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "albedo {}; light of {}", color(self.albedo), count(self.of_light().len(), "color"))
    }
}

/// Whether the residual is looked at.
pub fn residual(is_wired: bool, is_dark: bool) -> (bool, Decision) {
    const RULE: &str = "residual";
    let what = "the residual";
    match (is_wired, is_dark) {
        (false, _) => (false, Decision::left_out(RULE, what, "none is wired", "")),
        (true, true) => {
            (false, Decision::left_out(RULE, what, "its node has found that nobody sees it", "dark"))
        }
        (true, false) => {
            (true, Decision::kept(RULE, what, "it holds what was scattered more than once", "lit"))
        }
    }
}

/// One optical depth serves all channels.
pub fn one_depth(n_beams: usize) -> Decision {
    Decision::left_out(
        "one_depth",
        "an optical depth for each channel",
        "extinction is the same in all: color is in the albedo",
        count(n_beams, "beam"),
    )
}

/// Whether beams are carried through the medium and looked up in it.
pub fn beams(albedo: [f64; 3], powers: &[[f64; 3]], prune: bool) -> (bool, Decision) {
    const RULE: &str = "beams";
    let n_lit = powers.iter().filter(|power| chromaticity(**power).is_some()).count();
    let data = match powers.len() {
        0 => "0 beams".to_owned(),
        n if n == n_lit => format!("{}; albedo {}", count(n, "beam"), color(albedo)),
        n => format!("{}, {n_lit} of them lit; albedo {}", count(n, "beam"), color(albedo)),
    };
    let left_out = |reason: &str| (false, Decision::left_out(RULE, "beams", reason, data.clone()));
    if powers.is_empty() {
        return left_out("no light has a direction");
    }
    if !prune {
        return (true, Decision::kept(RULE, "beams", "everything is modeled", data));
    }
    if n_lit == 0 {
        return left_out("no beam has any light");
    }
    if albedo == [0.0; 3] {
        return left_out("nothing scatters: the medium only absorbs and emits");
    }
    (true, Decision::kept(RULE, "beams", "light is scattered out of them", data))
}

/// Whether surfaces send light of beams back as virtual lights.
pub fn bounce(
    powers: &[[f64; 3]],
    reflectances: &[[f64; 3]],
    n_lights: usize,
    prune: bool,
) -> (bool, Decision) {
    const RULE: &str = "bounce";
    let n_lit = powers.iter().filter(|power| chromaticity(**power).is_some()).count();
    let n_white = reflectances.iter().filter(|share| chromaticity(**share).is_some()).count();
    let what = count(n_lights, "virtual light");
    let data = format!(
        "{} with light; {} of {} reflect",
        count(n_lit, "beam"),
        n_white,
        count(reflectances.len(), "surface")
    );
    let left_out = |reason: &str| (false, Decision::left_out(RULE, what.clone(), reason, data.clone()));
    match () {
        () if powers.is_empty() => left_out("no light arrives"),
        () if !prune => (true, Decision::kept(RULE, what, "everything is modeled", data)),
        () if n_lit == 0 => left_out("no light arrives"),
        () if n_white == 0 => left_out("surfaces are black"),
        () => (true, Decision::kept(RULE, what, "surfaces send light back", data)),
    }
}

/// A smaller share of what the stack may carry than this is left to the ordinates as well: measured, it betters a
/// picture by 0.3 % at most, and costs its ways through the medium.
const LEAST_STACK: f64 = 0.1;

/// Whether an environment shines through a medium by the blurred levels of `prefilter`. `share` of what they may
/// carry is what is best: more of it the farther ordinates are apart, and the less light turns in a scattering.
pub fn stack(g: f64, is_map: bool, share: f64, prune: bool) -> (bool, Decision) {
    const RULE: &str = "stack";
    let what = "blurred levels of the environment";
    let data = format!("g = {}, {}", number(g), if is_map { "a map" } else { "a constant" });
    let left_out = |reason: &str, data: String| (false, Decision::left_out(RULE, what, reason, data));
    match () {
        () if g <= 0.0 => left_out("nothing is scattered forward by little", data),
        () if !is_map => left_out("a constant has no detail", data),
        () if share < LEAST_STACK && prune => {
            let reason = "a scattering blurs more than ordinates are apart: they show all of the detail";
            left_out(reason, format!("{data}, best share {}", number(share)))
        }
        () => {
            let reason = "its detail is seen through forward scattering";
            (true, Decision::kept(RULE, what, reason, format!("{data}, share {}", number(share))))
        }
    }
}

/// Whether forward scattering adds to what is scattered once (the table K).
pub fn forward_peak(g: f64, prune: bool) -> (bool, Decision) {
    const RULE: &str = "forward_peak";
    let data = format!("g = {}", number(g));
    if g > 0.0 {
        return (true, Decision::kept(RULE, "the forward peak", "matter scatters forward", data));
    }
    if !prune {
        return (true, Decision::kept(RULE, "the forward peak", "everything is modeled", data));
    }
    (false, Decision::left_out(RULE, "the forward peak", "nothing is scattered more forward than back", data))
}

/// Whether light goes to and fro along parallel beams where g < 0, so that what scatters backward has its peak.
pub fn backward_peak(g: f64, n_surfaces: usize) -> (bool, Decision) {
    const RULE: &str = "backward_peak";
    const WHAT: &str = "light to and fro along beams";
    let data = format!("g = {}, {}", number(g), count(n_surfaces, "surface"));
    if n_surfaces > 0 {
        return (false, Decision::left_out(RULE, WHAT, "surfaces would not be lit by what comes back", data));
    }
    (true, Decision::kept(RULE, WHAT, "matter scatters backward", data))
}

/// Whether the lobe of a cell has a direction; else its fluence is enough.
pub fn lobes(g: f64, prune: bool) -> (bool, Decision) {
    const RULE: &str = "lobes";
    let data = format!("g = {}", number(g));
    if g != 0.0 {
        return (
            true,
            Decision::kept(RULE, "directions of lobes", "scattering keeps some of the direction", data),
        );
    }
    if !prune {
        return (true, Decision::kept(RULE, "directions of lobes", "everything is modeled", data));
    }
    let reason = "scattering forgets the direction: fluence is enough";
    (false, Decision::left_out(RULE, "directions of lobes", reason, data))
}

/// The least that stands for all directions where light has a place inside of the medium. Measured on a fire
/// (14, 26, 50 directions: error 1.71, 1.54, 1.31 %, time 1, 1.6, 4.4).
const AROUND_A_LIGHT: LineSet = LineSet::Lines26;

/// Along which lines the residual is solved, where the user did not say; `chosen` is the quality's choice.
pub fn directions(chosen: LineSet, n_inside: usize, glows: bool, prune: bool) -> (LineSet, Decision) {
    const RULE: &str = "directions";
    let data = format!("{} inside, emission: {}", count(n_inside, "light"), if glows { "yes" } else { "no" });
    let what = |lines: LineSet| format!("{} directions", lines.count());
    if !prune {
        let most = LineSet::Lines50;
        return (most, Decision::kept(RULE, what(most), "everything is modeled", data));
    }
    if n_inside > 0 || glows {
        let more = if chosen.count() < AROUND_A_LIGHT.count() { AROUND_A_LIGHT } else { chosen };
        let reason = "light inside of the medium shows few directions as streaks";
        return (more, Decision::kept(RULE, what(more), reason, data));
    }
    let fewer = format!("{} of {} directions", LineSet::MOST - chosen.count(), LineSet::MOST);
    let reason = format!("{} carry light that comes from outside", chosen.count());
    (chosen, Decision::left_out(RULE, fewer, reason, data))
}

/// Whether the part of an environment that is the same everywhere flows in without ordinates.
pub fn constant_light(least: [f64; 3], is_constant: bool, prune: bool) -> (bool, Decision) {
    const RULE: &str = "constant_light";
    let what = if is_constant { "ordinates" } else { "ordinates for the constant part" };
    let data = format!("radiance from everywhere {}", color(least));
    if !prune {
        return (false, Decision::kept(RULE, what, "everything is modeled", data));
    }
    if chromaticity(least).is_none() {
        let reason =
            if is_constant { "the environment is black" } else { "the environment is black somewhere" };
        return (true, Decision::left_out(RULE, what, reason, data));
    }
    (true, Decision::left_out(RULE, what, "it flows in from all sides alike", data))
}

/// Optical depth of a cell over which it is split (DESIGN 6.3: 12.9 % error at 1.4, 2.9 % at 0.7).
const THICK: f64 = 0.7;

/// The edge that cells should have so that light enters and leaves through thin ones.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    /// The largest extinction [1/m].
    pub sigma_t_max: f64,
    /// Edge of a cell before it is split in meters.
    pub whole_m: f64,
    /// Whether the user bounds the resolution, and does not want it split again.
    pub is_bounded: bool,
}

/// The longest cell that is not to be split in meters, and what to say once cells are `cell_m` long.
pub fn split(facts: Split, prune: bool) -> (f64, impl Fn(f64) -> Decision) {
    let Split { sigma_t_max, whole_m, is_bounded } = facts;
    let wanted_m = match () {
        () if is_bounded => f64::INFINITY,
        // Once more than needed.
        () if !prune => (THICK / sigma_t_max).min(0.51 * whole_m),
        () => THICK / sigma_t_max,
    };
    let tell = move |cell_m: f64| {
        const RULE: &str = "split";
        let parts = (whole_m / cell_m).round().max(1.0);
        let data = format!("at most {} optical depths a cell", number(sigma_t_max * cell_m));
        // A whole number of parts may end at the very edge.
        let thick = sigma_t_max * cell_m > THICK * (1.0 + 1e-9);
        if parts > 1.0 {
            let reason = match () {
                () if thick => "thick cells; max_cells or the device ended it",
                () if !prune && sigma_t_max * whole_m <= THICK => "everything is modeled",
                () => "thick cells",
            };
            return Decision::kept(RULE, format!("cells split in {parts} along each axis"), reason, data);
        }
        let reason = match () {
            () if !thick => "cells are thin",
            () if is_bounded => "max_resolution is set",
            () => "cells are thick, but max_cells or the device allow no more",
        };
        Decision::left_out(RULE, "subdivision", reason, data)
    };
    (wanted_m, tell)
}

/// Whether a shape's boundary is known better than its cells tell.
pub fn closed_form(is_homogeneous: bool, prune: bool) -> (bool, Decision) {
    const RULE: &str = "closed_form";
    let what = "optical depths by samples";
    match (is_homogeneous, prune) {
        (false, _) => (false, Decision::kept(RULE, what, "density varies", "voxels")),
        (true, false) => (false, Decision::kept(RULE, what, "everything is modeled", "an even shape")),
        (true, true) => (true, Decision::left_out(RULE, what, "the shape's are known", "an even shape")),
    }
}

/// Whether rays pass empty blocks of cells in one step.
pub fn empty_space(n_filled: usize, n_blocks: usize, prune: bool) -> (bool, Decision) {
    const RULE: &str = "empty_space";
    let data = format!("{n_filled} of {} hold something", count(n_blocks, "block"));
    let what = "steps through empty blocks";
    if !prune {
        return (false, Decision::kept(RULE, what, "everything is modeled", data));
    }
    if n_filled == n_blocks {
        return (false, Decision::kept(RULE, what, "there are none", data));
    }
    (true, Decision::left_out(RULE, what, "nothing is there to be met", data))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.85, 1.0, 1.0 / 3.0, 1e-7, 0.0, 123_456.7, 2e9, f64::INFINITY].map(number);
        assert_eq!(texts, ["0.85", "1", "0.3333", "1e-7", "0", "123500", "2e9", "inf"]);
    }

    #[test]
    fn each_color_counts_once() {
        let grey = Colors {
            albedo: [0.9; 3],
            lights: vec![[2.0, 1.0, 0.0], [1.0, 0.5, 0.0], [0.0; 3]],
            ..Colors::default()
        };
        let count = |colors: Colors| channels(&colors, true).0.count;
        assert_eq!(channels(&grey, true).0, Channels { count: 1, color: [1.0, 0.5, 0.0] });
        assert_eq!(grey.to_string(), "albedo 0.9; light of 1 color");
        assert_eq!(channels(&grey, false).0, Channels::RGB);
        assert_eq!(count(Colors { albedo: [0.9, 0.9, 0.8], ..grey.clone() }), 3);
        assert_eq!(count(Colors { glows: true, ..grey.clone() }), 3);
        assert_eq!(count(Colors { has_rgb_fields: true, ..grey.clone() }), 3);
        assert_eq!(count(Colors { reflectances: vec![[0.5; 3], [0.5, 0.5, 0.4]], ..grey.clone() }), 3);
        let other = Colors { lights: vec![[2.0, 1.0, 0.0], [1.0, 0.6, 0.0]], ..grey };
        assert_eq!((count(other.clone()), other.of_light().len()), (3, 2));
        let dark = channels(&Colors { lights: vec![[0.0; 3]], ..Colors::default() }, true).0;
        assert_eq!(dark, Channels { count: 1, color: [1.0; 3] });
    }

    #[test]
    fn cells_are_split_where_they_are_thick() {
        let facts = Split { sigma_t_max: 7.0, whole_m: 0.2, is_bounded: false };
        let (wanted_m, tell) = split(facts, true);
        assert!((wanted_m - 0.1).abs() < 1e-12);
        let told = |cell_m| (tell(cell_m).kept, tell(cell_m).reason);
        assert_eq!(told(0.1), (true, "thick cells".to_owned()));
        assert!(!told(0.2).0);
        assert!(told(0.2).1.contains("max_cells"));
        // 1.05 optical depths, of which more was wanted.
        let (_, tell) = split(Split { sigma_t_max: 21.0, whole_m: 0.1, ..facts }, true);
        assert!(tell(0.05).kept && tell(0.05).reason.contains("ended it"));
        assert_eq!(split(Split { is_bounded: true, ..facts }, true).0, f64::INFINITY);
        // The whole model splits once more than needed.
        assert!(split(Split { sigma_t_max: 1.0, ..facts }, false).0 < 0.2);
        assert!(split(Split { sigma_t_max: 1.0, ..facts }, true).0 > 0.2);
    }

    #[test]
    fn beams_without_light_or_scattering_are_left_out() {
        let found = |albedo, powers: &[[f64; 3]], prune| beams([albedo; 3], powers, prune).0;
        let lit = [[0.0, 0.0, 1.0], [0.0; 3]];
        assert!(found(0.5, &lit, true) && !found(0.5, &lit[1..], true) && !found(0.0, &lit, true));
        assert!(found(0.0, &lit, false) && found(0.5, &lit[1..], false) && !found(0.5, &[], false));
        assert_eq!(beams([0.5; 3], &lit, true).1.data, "2 beams, 1 of them lit; albedo 0.5");
    }

    #[test]
    fn what_is_black_or_dark_sends_nothing_back() {
        let found = |powers: &[[f64; 3]], share, prune| bounce(powers, &[[share; 3]], 8, prune).0;
        let lit = [[0.0, 0.0, 1.0], [0.0; 3]];
        assert!(found(&lit, 0.5, true) && !found(&lit[1..], 0.5, true) && !found(&lit, 0.0, true));
        assert!(found(&lit, 0.0, false) && !found(&[], 0.5, false));
        let data = bounce(&lit, &[[0.5; 3]], 8, true).1.data;
        assert_eq!(data, "1 beam with light; 1 of 1 surface reflect");
    }

    #[test]
    fn a_stack_that_adds_nothing_is_left_out() {
        let found = |g, is_map, share| stack(g, is_map, share, true).0;
        assert!(found(0.5, true, 0.11) && !found(0.5, true, 0.05) && stack(0.5, true, 0.05, false).0);
        assert!(!found(0.0, true, 1.0) && !found(-0.5, true, 1.0) && !found(0.5, false, 1.0));
        let Decision { reason, data, .. } = stack(0.5, true, 0.05, true).1;
        assert!(
            reason.contains("blurs more") && data == "g = 0.5, a map, best share 0.05",
            "{reason}: {data}"
        );
    }

    #[test]
    fn light_inside_takes_more_directions() {
        use LineSet::*;
        let found = |chosen, n_inside, glows| directions(chosen, n_inside, glows, true).0;
        assert_eq!([found(Lines14, 0, false), found(Lines8, 0, false)], [Lines14, Lines8]);
        assert_eq!([found(Lines14, 1, false), found(Lines14, 0, true)], [Lines26, Lines26]);
        assert_eq!(directions(Lines14, 0, false, false).0, Lines50);
    }
}

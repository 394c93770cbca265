//! `prefilter`: an environment for the eye behind a medium, and its ordinates for what remains (DESIGN 6.5).
//!
//! Light that is scattered forward by a few degrees comes nearly straight along the view ray: what shows is
//! the environment itself, blurred by each scattering once more, and no number of ordinates would draw it.
//! The stack holds it for 16 numbers x of scatterings, e^−x Σ_{j≥1} x^j/j! [Env ⊗ w peak_j], Env without its
//! ambient and its suns (`kernel.rs`, `harmonics.rs`); the ordinates of its regions lose that share by their
//! window. Units as the map's, [W/(m² sr)]; texels may be negative near the window's outer angle from a bright spot.
//! The march bends its light (`raymarch`, `environment.wgsl`): so it may take over wider angles than straight light
//! may, 60 to 120 degrees for 30 to 70. Of that it takes a share (`share`): nearly all where ordinates are few and
//! light turns by little, none where a scattering blurs more than ordinates are apart.
//!
//! The stack has n rows and 2n columns, n the power of two over 10/(1−g), in 64 … 256. Between texels
//! bilinear interpolation takes up to 5 % off the very peak of light from a single texel, 12 % for g over
//! 0.97; elsewhere and for wider light it is right to 1e-3. For g over 0.961 bright spots are smoothed by up to 1°
//! (`kernel.rs`). Tested against a sum over texels.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Report, Value};
use crate::light::environment::{Environment, Map, Stack};
use crate::light::{Ordinate, Ordinates, Window};
use crate::planner;
use crate::wire::Medium;

mod fft;
mod harmonics;
mod kernel;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Cheap };

static SPEC: NodeSpec = NodeSpec {
    id: "prefilter",
    version: 2,
    category: Category::Transport,
    purpose: "Makes an environment ready to be seen through a medium that scatters forward.",
    doc: "Every ordinate becomes as wide as its region. What of the environment shines through the medium, blurred, then comes \
          from the map itself, as sharp as it is, not from ordinates: the more of it the fewer ordinates there are and the \
          nearer g is to 1. For maps and g over 0; constant light passes as it is.",
    inputs: &[
        PortSpec::new("environment", PortType::Environment, "what was split"),
        PortSpec::new("ordinates", PortType::Ordinates, "what it was split into, by light_decomposition"),
        PortSpec::new("medium", PortType::Medium, "what it is seen through"),
    ],
    outputs: &[
        PortSpec::new("ordinates", PortType::Ordinates, "the beams, for principal_propagation"),
        PortSpec::new("environment", PortType::Environment, "for raymarch.environment"),
    ],
    params: &[ParamSpec::vector("window_deg", &[60.0, 120.0]).unit("deg").between(0.0, 180.0).soft(5.0, 150.0).doc(
        "Of light scattered by less than the first angle a share (`explain` names it) is the environment's, of more than \
         the second none.",
    )],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let environment: &Environment = run.inputs.one("environment");
    let light: &Ordinates = run.inputs.one("ordinates");
    let medium: &Medium = run.inputs.one("medium");
    let [inner_deg, outer_deg] = run.params.vec("window_deg");
    if inner_deg >= outer_deg {
        return Err(NodeError::new(format!(
            "window_deg is [{inner_deg}, {outer_deg}]: the first angle must be the smaller one"
        )));
    }
    let window = Window { inner_deg, outer_deg, share: share(light.n_regions, medium.g) };
    let is_map = matches!(environment, Environment::Map(_));
    let (has_stack, decision) = planner::stack(medium.g, is_map, window.share, run.prune);
    run.tell(Report { decisions: vec![decision], ..Report::default() });
    let stack = match environment {
        Environment::Map(map) if has_stack => {
            let (flows_in, _) = planner::constant_light(environment.minimum(), false, run.prune);
            let ambient = if flows_in { environment.minimum() } else { [0.0; 3] };
            Some(stack(map, ambient, medium.g, window))
        }
        _ => None,
    };
    run.cancel.check()?;
    let widened = |ordinate: &Ordinate| match ordinate.region {
        Some(spread) => Ordinate { a0: spread, window: stack.as_ref().map(|_| window), ..*ordinate },
        None => *ordinate,
    };
    let ordinates = Ordinates { ordinates: light.ordinates.iter().map(widened).collect(), ..*light };
    let bytes = size_of_val(ordinates.ordinates.as_slice()) as u64;
    let ordinates = Value::new(PortType::Ordinates, bytes, ordinates);
    let environment = match (environment, stack) {
        (Environment::Map(map), Some(stack)) => {
            let bytes = size_of_val(stack.texels.as_slice()) as u64;
            let map = Map { stack: Some(Arc::new(stack)), ..map.clone() };
            Value::new(PortType::Environment, bytes, Environment::Map(map))
        }
        _ => run.inputs.values("environment")[0].clone(),
    };
    Ok(vec![ordinates, environment])
}

/// The stack's share of what its window lets through.
///
/// Both ways to draw it err. An ordinate stands for a region as for one direction, which is wrong by the distance of
/// ordinates, √(4π/n), over the width of what a scattering makes of a ray, some 1 − g. The stack leads light by few ways,
/// which is wrong by as much however many ordinates there are. The two errors know nothing of each other: shares by
/// the square of the other's make the least of both. It hangs on nothing that changes while a camera moves. All of it
/// where nothing was split (`n_regions` 0).
///
/// Measured as the prototype draws, noise of the truth taken off: error in percent of ordinates alone, with all of the
/// stack, and with this share of it. The best of nine shares is at most 0.3 below that.
///
/// | medium, environment | 16 ordinates | 32 | 64 |
/// |---|---|---|---|
/// | checkerboard, g 0.95, tau 10, sky | 10.8, 4.1, 4.1 | 9.3, 4.1, 4.1 | 7.8, 3.7, 3.7 |
/// | cloud, g 0.93, tau 5, studio | 8.4, 4.8, 4.7 | 6.3, 4.9, 4.7 | |
/// | cloud, g 0.85, tau 10, sky | 10.2, 4.8, 4.4 | 6.4, 4.0, 3.6 | 4.9, 3.9, 3.4 |
/// | plume, g 0.85, tau 4, studio | | 10.4, 7.3, 6.0 | |
/// | cloud, g 0.75, tau 10, sky | | 5.3, 4.4, 4.3 | |
/// | plume, g 0.75, tau 4, studio | 5.7, 6.8, 5.1 | 4.6, 6.6, 4.3 | 4.7, 6.6, 4.2 |
/// | plume, g 0.5, tau 4, studio | | 4.7, 5.1, 4.5 | |
fn share(n_regions: usize, g: f64) -> f64 {
    let alike = (1.0 - g) / EVEN;
    1.0 / (1.0 + alike * alike * n_regions as f64 / (4.0 * PI))
}

/// 1 − g over the distance of ordinates where both err alike.
const EVEN: f64 = 1.0 / 3.0;

/// Degrees, and rows, of a stack.
const MIN_DEGREES: usize = 64;
const MAX_DEGREES: usize = 256;

fn stack(map: &Map, minimum: [f64; 3], g: f64, window: Window) -> Stack {
    let n = (kernel::degrees_needed(g).min(MAX_DEGREES as f64) as usize).next_power_of_two().max(MIN_DEGREES);
    // They are ordinates that keep all of their light.
    let mut suns = map.suns().concat();
    suns.sort_unstable();
    let excess = |row: usize, column: usize| {
        let idx = row * map.width + column;
        if suns.binary_search(&idx).is_ok() {
            return [0.0; 3];
        }
        let texel = map.texels[idx];
        std::array::from_fn(|c| f64::from(texel[c]) * map.scale - minimum[c])
    };
    let picture = harmonics::Picture { width: map.width, height: map.height, texels: &excess };
    let texels = harmonics::convolve(&picture, &kernel::factors(g, window, n));
    Stack { width: 2 * n, height: n, texels, turns: kernel::turns(g, window) }
}

#[cfg(test)]
mod tests;

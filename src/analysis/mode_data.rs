//! From modes of a system to plain data: eigenvalues, and shapes on the outer surface.

use crate::Result;
use crate::native::Vector;
use crate::results::{About, ModeData, Shape, Source, largest};
use crate::stability::{Band, Mode};
use crate::structure::SurfaceMotion;

use super::run::ValueResult;

/// An unstable mode that is to be explained.
pub(super) struct UnstableMode<'a> {
    /// Its place among all modes found.
    pub index: usize,
    /// Its number in the band, from 1.
    pub number: usize,
    pub mode: &'a Mode,
    /// On the outer surface; only the root has it.
    pub shape: &'a Shape,
}

/// The modes within the band of a study. Where the value was asked for, unstable ones get a shape on the whole surface
/// and the sources that `explain` finds. Collective.
pub(super) fn mode_data(
    motion: &mut SurfaceMotion,
    found: &Band,
    asked: bool,
    about: &About,
    mut explain: impl FnMut(UnstableMode) -> Result<Vec<Source>>,
) -> Result<ValueResult> {
    let [from, to] = about.band;
    let is_within = |mode: &Mode| (from..=to).contains(&mode.frequency());
    let within: Vec<(usize, &Mode)> = found.modes.iter().enumerate().filter(|(_, mode)| is_within(mode)).collect();
    let modes: Vec<&Mode> = within.iter().map(|(_, mode)| *mode).collect();
    let mut data = shapes(motion, &modes, |mode| asked && mode.is_unstable(about.criterion))?;
    data.iter_mut().zip(&modes).for_each(|(data, mode)| data.unstable = mode.is_unstable(about.criterion));
    for ((number, &(index, mode)), data) in (1..).zip(&within).zip(&mut data) {
        if let Some(shape) = &data.shape {
            data.sources = explain(UnstableMode { index, number, mode, shape })?;
        }
    }
    Ok(ValueResult { modes: data, count: Some(found.count), snapshot: None })
}

/// Modes as plain data; those for which `is_drawn` have a shape on the whole surface. Collective.
fn shapes(motion: &mut SurfaceMotion, modes: &[&Mode], is_drawn: impl Fn(&Mode) -> bool) -> Result<Vec<ModeData>> {
    let samples = motion.of_samples(&parts(modes))?;
    let drawn: Vec<&Mode> = modes.iter().copied().filter(|mode| is_drawn(mode)).collect();
    let all = if drawn.is_empty() { Vec::new() } else { motion.of_all(&parts(&drawn))? };
    let mut of_drawn = all.chunks_exact(2);
    let pairs = modes.iter().zip(samples.chunks_exact(2));
    Ok(pairs.map(|(mode, samples)| one(mode, samples, if is_drawn(mode) { of_drawn.next() } else { None })).collect())
}

/// Shapes of modes on the whole surface, on the root. Collective.
pub(super) fn whole_shapes(motion: &mut SurfaceMotion, modes: &[&Mode]) -> Result<Vec<Shape>> {
    let all = motion.of_all(&parts(modes))?;
    Ok(all.chunks_exact(2).map(|own| Shape::over(&own[0], &own[1], largest(&own[0], &own[1]))).collect())
}

/// Real and imaginary parts of the modes' vectors.
fn parts<'a>(modes: &[&'a Mode]) -> Vec<&'a Vector> {
    modes.iter().flat_map(|mode| [&mode.re, &mode.im]).collect()
}

/// A mode by its displacements at the samples and, where it is drawn, on the whole surface.
fn one(mode: &Mode, samples: &[Vec<f64>], all: Option<&[Vec<f64>]>) -> ModeData {
    let known = all.unwrap_or(samples);
    let divisor = largest(&known[0], &known[1]);
    ModeData {
        lambda: mode.lambda,
        backward_error: mode.backward_error,
        unstable: false,
        sampled: Shape::over(&samples[0], &samples[1], divisor),
        shape: all.map(|all| Shape::over(&all[0], &all[1], divisor)),
        sources: Vec::new(),
    }
}

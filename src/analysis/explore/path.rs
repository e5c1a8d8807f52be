//! The modes of a point followed to the nominal one: at once where they are recognised without doubt, else along the
//! straight line between the two.
//!
//! Where an unstable mode of the point is doubtful or not recognised, the line is bisected: the modes of the point are
//! recognised among those of the middle, and those among the nominal ones, each half again in two parts where it has
//! doubt. Stable modes in doubt take the same way, but cause no bisection.

use crate::Result;
use crate::analysis::observer::{Event, Observer};
use crate::explore::Link;

use super::Run;
use super::point::{PointSolution, Request, WeightedModes};

impl Run<'_> {
    /// Recognises the modes of a point. Collective in the group.
    pub(super) fn follow(
        &self,
        number: usize,
        found: &mut PointSolution,
        nominal: &WeightedModes,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        found.weighted = None;
        let unstable: Vec<usize> = (0..found.modes.len()).filter(|&j| found.modes[j].unstable).collect();
        let unstable = self.groups.own.broadcast_value(0, unstable);
        let line = Line { number, n_bisections: self.request.follow.unwrap_or(0) };
        let links = self.links(line, (&self.values[0], nominal), (&self.values[number], found), &unstable, observer)?;
        found.modes.iter_mut().zip(links).for_each(|(mode, link)| mode.link = link);
        Ok(())
    }

    /// For each mode at the end of a line that at its start which it is. What is in doubt among the wanted ones is
    /// looked for by way of the middle. Collective in the group.
    fn links(
        &self,
        line: Line,
        start: (&[f64], &WeightedModes),
        end: (&[f64], &PointSolution),
        wanted: &[usize],
        observer: &mut dyn Observer,
    ) -> Result<Vec<Option<Link>>> {
        // Ranks agree: rounding may differ, and what follows is collective.
        let direct = self.groups.own.broadcast_value(0, end.1.links(start.1));
        let in_doubt: Vec<usize> = wanted.iter().copied().filter(|&j| !is_clear(&direct[j])).collect();
        if line.n_bisections == 0 || in_doubt.is_empty() {
            return Ok(direct);
        }
        let half = Line { n_bisections: line.n_bisections - 1, ..line };
        let values: Vec<f64> = start.0.iter().zip(end.0).map(|(a, b)| 0.5 * (a + b)).collect();
        let request = Request { shapes: false, ..self.request };
        let mut middle = match self.solved(&values, &request, Some(&end.1.displacements), observer)? {
            Ok(middle) => middle,
            Err(reason) => {
                let what = format!("point {}: modes are not followed by way of a point between", line.number);
                observer.event(Event::Warning(&format!("{what} it and the nominal one, which fails: {reason}")));
                return Ok(direct);
            }
        };
        // Its vectors with M serve the second half, those without the first: not all are kept at the same time.
        let Some(weighted) = middle.weighted.take() else { return Ok(direct) };
        let second = self.links(half, (&values, &weighted), end, &in_doubt, observer)?;
        drop(weighted);
        let on_the_way: Vec<usize> = in_doubt.iter().filter_map(|&j| clear(&second[j])).collect();
        if on_the_way.is_empty() {
            return Ok(direct);
        }
        let first = self.links(half, start, (&values, &middle), &on_the_way, observer)?;
        Ok(better(&direct, &joined(&first, &second)))
    }
}

/// The line from the nominal point to one with a number, or a part of it.
#[derive(Debug, Clone, Copy)]
struct Line {
    number: usize,
    /// How often it may be bisected.
    n_bisections: usize,
}

fn is_clear(link: &Option<Link>) -> bool {
    link.is_some_and(|link| !link.doubtful)
}

/// The place of the mode at the start of a line, where that is without doubt.
fn clear(link: &Option<Link>) -> Option<usize> {
    link.filter(|link| !link.doubtful).map(|link| link.nominal - 1)
}

/// Links of the first half of a line continued by those of the second: as sure as the less sure of both.
fn joined(first: &[Option<Link>], second: &[Option<Link>]) -> Vec<Option<Link>> {
    let through = |link: &Option<Link>| {
        let second = (*link)?;
        let first = first[second.nominal - 1]?;
        let doubtful = first.doubtful || second.doubtful;
        // What is farther from 1, on either side.
        let share = if distance(first.share) > distance(second.share) { first.share } else { second.share };
        Some(Link { nominal: first.nominal, share, doubtful })
    };
    second.iter().map(through).collect()
}

/// How far a share is from 1, which is that of a mode that has not changed.
fn distance(share: f64) -> f64 {
    share.ln().abs()
}

/// Of each mode the direct link where that is clear, then that by way of the middle where that is, then what is
/// doubtful in the same order; a mode at the start is linked once.
fn better(direct: &[Option<Link>], by_middle: &[Option<Link>]) -> Vec<Option<Link>> {
    let mut links: Vec<Option<Link>> = vec![None; direct.len()];
    for (from, doubtful) in [(direct, false), (by_middle, false), (direct, true), (by_middle, true)] {
        for (j, link) in from.iter().enumerate() {
            let is_taken = |own: &Link| links.iter().flatten().any(|link| link.nominal == own.nominal);
            let free = link.filter(|own| own.doubtful == doubtful && !is_taken(own));
            links[j] = links[j].or(free);
        }
    }
    links
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(nominal: usize, share: f64) -> Option<Link> {
        Some(Link { nominal, share, doubtful: !(0.6..=1.0 / 0.6).contains(&share) })
    }

    #[test]
    fn halves_of_a_line_are_joined_and_are_as_sure_as_the_less_sure() {
        let first = [link(2, 0.9), link(1, 0.5), None];
        let second = [link(2, 0.8), link(1, 0.7), link(3, 0.9), None];
        assert_eq!(joined(&first, &second), [link(1, 0.5), link(2, 0.7), None, None]);
        assert_eq!(joined(&[link(1, 2.0)], &[link(1, 0.9)]), [link(1, 2.0)], "a coalescence on the way");
    }

    #[test]
    fn clear_links_stay_and_a_mode_is_linked_once() {
        let direct = [link(1, 0.4), link(2, 0.9), link(3, 0.5), None];
        // The first is clear by way of the middle; the second is clear anyhow; the third may keep its own.
        let by_middle = [link(4, 0.9), link(5, 0.7), None, link(6, 0.4)];
        assert_eq!(better(&direct, &by_middle), [link(4, 0.9), link(2, 0.9), link(3, 0.5), link(6, 0.4)]);
        // What is clear takes its mode from what is doubtful, and from what is clear by way of the middle.
        let by_middle = [link(3, 0.8), None, None, link(2, 0.8)];
        assert_eq!(better(&direct, &by_middle), [link(3, 0.8), link(2, 0.9), None, None]);
        assert_eq!((clear(&link(4, 0.9)), clear(&link(4, 0.5)), clear(&None)), (Some(3), None, None));
    }
}

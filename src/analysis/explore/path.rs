//! The modes of a point followed to the nominal one: at once where they are recognised without doubt, else along the
//! straight line between the two.
//!
//! Where an unstable mode of the point is doubtful or not recognised, the line is bisected: the modes of the point are
//! recognised among those of the middle, and those among the nominal ones, each half again in two parts where it has
//! doubt. Stable modes take the same way, but cause no bisection.

use crate::Result;
use crate::analysis::observer::Observer;
use crate::explore::{Link, PointMode};

use super::Run;
use super::point::{NominalModes, PointSolution, Request};

impl Run<'_> {
    /// Recognises the modes of a point. Collective in the group.
    pub(super) fn follow(
        &self,
        values: &[f64],
        found: &mut PointSolution,
        nominal: &NominalModes,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let wanted: Vec<usize> = positions(&found.modes, |mode| mode.unstable);
        let n_bisections = self.request.follow.unwrap_or(0);
        let links = self.links((&self.values[0], nominal), (values, found), &wanted, n_bisections, observer)?;
        found.modes.iter_mut().zip(links).for_each(|(mode, link)| mode.link = link);
        Ok(())
    }

    /// The modes at the start of a line that the modes at its end are. What is in doubt among the wanted ones is looked
    /// for by way of the middle. Collective in the group.
    fn links(
        &self,
        start: (&[f64], &NominalModes),
        end: (&[f64], &PointSolution),
        wanted: &[usize],
        n_bisections: usize,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Option<Link>>> {
        let direct = end.1.links(start.1);
        if n_bisections == 0 || n_clear(&direct, wanted) == wanted.len() {
            return Ok(direct);
        }
        let middle: Vec<f64> = start.0.iter().zip(end.0).map(|(a, b)| 0.5 * (a + b)).collect();
        let request = Request { gradients: false, ..self.request };
        let Ok(found) = self.solved(&middle, &request, Some(&end.1.displacements), observer)? else {
            return Ok(direct);
        };
        let Some(own) = &found.own else { return Ok(direct) };
        let second = self.links((&middle, own), end, wanted, n_bisections - 1, observer)?;
        let through: Vec<usize> = wanted.iter().filter_map(|&j| Some(second[j]?.nominal - 1)).collect();
        let first = self.links(start, (&middle, &found), &through, n_bisections - 1, observer)?;
        Ok(better(direct, joined(&first, &second), wanted))
    }
}

fn positions(modes: &[PointMode], is: impl Fn(&PointMode) -> bool) -> Vec<usize> {
    (0..modes.len()).filter(|&j| is(&modes[j])).collect()
}

/// How many of the wanted modes are recognised without doubt.
fn n_clear(links: &[Option<Link>], wanted: &[usize]) -> usize {
    wanted.iter().filter(|&&j| links[j].is_some_and(|link| !link.doubtful)).count()
}

/// Links of the first half of a line continued by those of the second: as sure as the less sure of both.
fn joined(first: &[Option<Link>], second: &[Option<Link>]) -> Vec<Option<Link>> {
    let through = |link: &Option<Link>| {
        let second = (*link)?;
        let first = first[second.nominal - 1]?;
        Some(Link {
            nominal: first.nominal,
            share: first.share.min(second.share),
            doubtful: first.doubtful || second.doubtful,
        })
    };
    second.iter().map(through).collect()
}

/// The links by way of the middle where more of the wanted modes are clear by them, with the direct ones of modes that
/// got lost there as far as these are still free; else the direct ones.
fn better(direct: Vec<Option<Link>>, by_middle: Vec<Option<Link>>, wanted: &[usize]) -> Vec<Option<Link>> {
    if n_clear(&by_middle, wanted) <= n_clear(&direct, wanted) {
        return direct;
    }
    let is_taken = |nominal| by_middle.iter().flatten().any(|link| link.nominal == nominal);
    let free = |link: Option<Link>| link.filter(|link| !is_taken(link.nominal));
    by_middle.iter().zip(direct).map(|(own, direct)| own.or_else(|| free(direct))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(nominal: usize, share: f64) -> Option<Link> {
        Some(Link { nominal, share, doubtful: share < 0.6 })
    }

    #[test]
    fn halves_of_a_line_are_joined_and_are_as_sure_as_the_less_sure() {
        let first = [link(2, 0.9), link(1, 0.5), None];
        let second = [link(2, 0.8), link(1, 0.7), link(3, 0.9), None];
        assert_eq!(joined(&first, &second), [link(1, 0.5), link(2, 0.7), None, None]);
    }

    #[test]
    fn only_wanted_modes_decide_and_a_mode_is_linked_once() {
        let direct = vec![link(1, 0.4), link(2, 0.9), link(3, 0.9)];
        let by_middle = vec![link(2, 0.9), None, None];
        assert_eq!(better(direct.clone(), by_middle.clone(), &[0]), [link(2, 0.9), None, link(3, 0.9)]);
        assert_eq!(better(direct.clone(), by_middle.clone(), &[1]), direct);
        assert_eq!(better(direct.clone(), by_middle, &[]), direct);
        assert_eq!((n_clear(&direct, &[0, 1]), n_clear(&direct, &[0])), (1, 0));
    }
}

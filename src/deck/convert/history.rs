//! What acts at the end of the last step.
//!
//! Supports, loads and motions last from step to step; `OP=NEW` ends those of its kind that began in earlier steps. A
//! force on the same displacement adds to one of the same step and replaces one of an earlier step.

use crate::deck::types::{Action, ActionKind, Deck, Friction, NothingKind};

/// The actions that last, with the step that they began in.
pub struct State<'d> {
    actions: Vec<(usize, &'d Action)>,
}

/// A kind of action that `OP=NEW` ends.
#[derive(Clone, Copy, PartialEq)]
enum Ended {
    Boundary,
    Force,
    Distributed,
    SurfacePressure,
    Rotation,
    Friction,
}

impl From<&ActionKind> for Ended {
    fn from(what: &ActionKind) -> Ended {
        match what {
            ActionKind::Boundary(..) | ActionKind::Nothing(NothingKind::Boundary) => Ended::Boundary,
            ActionKind::Force(..) | ActionKind::Nothing(NothingKind::Force) => Ended::Force,
            ActionKind::FacePressure(..)
            | ActionKind::Centrifugal(..)
            | ActionKind::Gravity(..)
            | ActionKind::Nothing(NothingKind::Distributed) => Ended::Distributed,
            ActionKind::SurfacePressure(..) | ActionKind::Nothing(NothingKind::SurfacePressure) => {
                Ended::SurfacePressure
            }
            ActionKind::Rotation(..) => Ended::Rotation,
            ActionKind::Friction(..) => Ended::Friction,
        }
    }
}

impl<'d> State<'d> {
    /// The state of a deck at its end.
    pub fn of(deck: &'d Deck) -> State<'d> {
        let mut actions: Vec<(usize, &Action)> = deck.initial.iter().map(|action| (0, action)).collect();
        for (step, own) in deck.steps.iter().enumerate().map(|(i, step)| (i + 1, &step.actions)) {
            for action in own {
                let ended = Ended::from(&action.what);
                if action.is_new {
                    actions.retain(|(began, other)| *began == step || Ended::from(&other.what) != ended);
                }
                actions.push((step, action));
            }
        }
        State { actions }
    }

    /// The actions with their steps.
    pub fn actions(&self) -> impl Iterator<Item = (usize, &'d Action)> + '_ {
        self.actions.iter().copied()
    }

    /// The friction that an interaction changes to.
    pub fn friction(&self, interaction: &str) -> Option<&Friction> {
        let changed = self.actions().filter_map(|(_, action)| match &action.what {
            ActionKind::Friction(name, friction) if name == interaction => Some(friction),
            _ => None,
        });
        changed.last()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::types::{Entry, Procedure, Step};
    use crate::model::Place;

    fn force(value: f64, is_new: bool) -> Action {
        Action { what: ActionKind::Force(Entry::Number(1), 1, value), is_new, place: Place::default() }
    }

    #[test]
    fn new_ends_what_began_earlier_and_no_other_kind() {
        let nothing =
            Action { what: ActionKind::Nothing(NothingKind::Boundary), is_new: true, place: Place::default() };
        let step = |actions| Step {
            procedure: Procedure::Static,
            actions,
            nlgeom: false,
            perturbation: false,
            place: Place::default(),
        };
        let boundary = ActionKind::Boundary(Entry::Number(1), [1, 3], 0.0);
        let deck = Deck {
            initial: vec![Action { what: boundary, is_new: false, place: Place::default() }, force(1.0, false)],
            steps: vec![step(vec![force(2.0, false)]), step(vec![force(3.0, true), force(4.0, true), nothing])],
            ..Deck::default()
        };
        let values: Vec<f64> = State::of(&deck)
            .actions()
            .filter_map(|(_, action)| match action.what {
                ActionKind::Force(_, _, value) => Some(value),
                ActionKind::Boundary(..) => Some(-1.0),
                _ => None,
            })
            .collect();
        assert_eq!(values, [3.0, 4.0]);
    }
}

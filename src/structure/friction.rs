//! Which friction coefficient an analysis gives the swept pairs.

use std::path::Path;

use crate::contact::{ContactPair, Interface};
use crate::{Error, Result};

/// The values of the friction coefficient to analyse: those given, else those of a file, else the swept pairs'.
///
/// # Errors
/// [`Error::Input`] where no pair slides; where none is given and the pairs differ.
pub(super) fn friction_values(
    given: Option<&[f64]>,
    own: &[f64],
    interface: &Interface,
    file: &Path,
) -> Result<Vec<f64>> {
    if let Some(list) = given {
        return Ok(list.to_vec());
    }
    if !own.is_empty() {
        return Ok(own.to_vec());
    }
    own_friction(interface, file)?.map(|mu| vec![mu]).ok_or_else(|| {
        let what = "no contact pair slides, so there is no friction coefficient to sweep";
        Error::input(format!("{}: {what}. Add the [[rotation]] of the disc, or give --friction 0", file.display()))
    })
}

/// The one friction coefficient that the swept pairs have in a file; none where no pair slides.
///
/// # Errors
/// [`Error::Input`] where they differ: an analysis gives all swept pairs the same.
pub(super) fn own_friction(interface: &Interface, file: &Path) -> Result<Option<f64>> {
    let mut swept = interface.pairs.iter().filter(|pair| pair.swept);
    let Some(first) = swept.next() else { return Ok(None) };
    swept.find(|pair| pair.friction != first.friction).map_or(Ok(Some(first.friction)), |other| {
        let of = |pair: &ContactPair| format!("{} on \"{}\"", pair.friction, pair.name);
        Err(Error::input(format!(
            "{}: the friction coefficient is {} and {}, and an analysis gives all swept contacts the same. Give it with \
             --friction, or sweep some of them alone ([sweep] friction = {{ contacts = [\"{}\"], values = [{}] }}): the \
             others keep their own",
            file.display(),
            of(first),
            of(other),
            first.name,
            first.friction
        )))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::testing::{ALONG_X, belt};

    #[test]
    fn the_pairs_own_value_counts_where_no_other_is_given_and_all_have_it() {
        let file = Path::new("brake.toml");
        let mut interface = belt(1, ALONG_X);
        let pair = |friction: f64, swept: bool| ContactPair { friction, swept, ..belt(1, ALONG_X).pairs.remove(0) };
        interface.pairs = vec![pair(0.7, false), pair(0.4, true), pair(0.4, true)];
        assert_eq!(friction_values(None, &[], &interface, file).unwrap(), [0.4]);
        assert_eq!(friction_values(None, &[0.1, 0.2], &interface, file).unwrap(), [0.1, 0.2]);
        interface.pairs[2].friction = 0.5;
        assert_eq!(friction_values(Some(&[0.3]), &[0.1], &interface, file).unwrap(), [0.3]);
        let error = friction_values(None, &[], &interface, file).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("is 0.4 on \"belt\" and 0.5 on \"belt\""), "{error}");
        interface.pairs.truncate(1);
        assert!(
            friction_values(None, &[], &interface, file).unwrap_err().to_string().contains("no contact pair slides")
        );
        assert_eq!(own_friction(&interface, file).unwrap(), None);
    }
}

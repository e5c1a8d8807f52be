//! Bands, sweeps and the reduction.

use super::{GOOD, complains, parsed};

#[test]
fn bands_and_sweeps_must_not_be_empty() {
    let advice = "(stability). Give [lowest, highest] in Hz, 0 <= lowest < highest";
    let band = "band = [0, 6000]";
    complains(band, "band = [6000, 6000]", 0, &format!("band is empty: [6000, 6000] {advice}"));
    complains(band, "band = [-1, 6000]", 0, &format!("band begins below 0: [-1, 6000] {advice}"));
    let sweep = |text: &str| parsed(&GOOD.replace("from = 0.1, to = 0.9, step = 0.1", text));
    assert_eq!(sweep("values = [0.5, 0]").unwrap().frictions, [0.5, 0.0]);
    assert_eq!(sweep("from = 0.2, to = 0.55, step = 0.1").unwrap().frictions, [0.2, 0.3, 0.4, 0.5]);
    assert!(sweep("values = []").unwrap_err().contains(":48: the values of the friction are not given"));
    assert!(sweep("from = 0.1, to = 0.5").unwrap_err().contains("are not given, or given twice (sweep)"));
    assert!(sweep("from = 0.5, to = 0.1, step = 0.1").unwrap_err().contains("the range is empty"));
    assert!(sweep("from = 0.1, to = 0.9, step = 0").unwrap_err().contains("step must be above 0, not 0"));
    assert!(sweep("from = 0.1, to = 0.9, step = 1e-9").unwrap_err().contains("Give a larger step"));
    assert!(sweep("values = [3]").unwrap_err().contains("friction must be from 0 to 2, not 3 (sweep)"));
}

#[test]
fn the_reduction_is_kept_and_checked() {
    let with = |text: &str| parsed(&format!("{GOOD}[reduction]\n{text}\n"));
    let reduction = with("contacts = 44\nband = [0, 12000]").unwrap().reduction.unwrap();
    assert_eq!((reduction.contacts, reduction.place.line), (44, 49));
    assert!(with("contacts = 0\nband = [0, 1]").unwrap_err().contains(":50: contacts must be above 0 (reduction)"));
    let said = with("contacts = 1.5\nband = [0, 1]").unwrap_err();
    assert!(said.contains("expected a whole number ([reduction])"), "{said}");
}

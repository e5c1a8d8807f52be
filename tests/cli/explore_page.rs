//! The page of `squeal explore` in a browser: what a reader sees and can do.

use serde_json::json;

use crate::browser::{DRAWN, PICTURE};
use crate::support::browser::Browser;
use crate::support::program::Place;

/// A grid of friction and load, with a column of points that the model reader refuses.
const GRID: &str = "model = \"brake.toml\"\nband = [0, 60000]\nbin = 10000\n\
    [design]\nkind = \"grid\"\nlevels = 3\n\
    [parameter.mu]\nkey = \"friction\"\nvalues = [0.0, 0.5, 0.9, 2.6]\n\
    [parameter.\"<load>\"]\nkey = \"load.*.force\"\nfactor = true\nuniform = [0.5, 1.5]\n";

#[test]
fn the_page_of_a_study_shows_points_and_the_modes_of_a_chosen_one() {
    let place = Place::blocks();
    place.write("explore.toml", GRID);
    let finished = place.run(&["explore", "explore.toml", "-o", "run"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let mut page = Browser::open(&place.path("run/explore.html"), [1400, 900]);
    page.wait_for("document.querySelectorAll('#point tbody tr').length > 2");
    let headline = page.text("document.querySelector('.verdict').textContent");
    assert!(headline.starts_with("Unstable at ") && headline.ends_with(" of 9 points"), "{headline}");
    assert!(page.text("document.querySelector('main').innerText").contains("represent no distribution"));
    choose_parameters(&mut page);
    choose_points(&mut page);
    choose_shapes(&mut page);
    assert_eq!(page.number("document.querySelectorAll('[aria-label=\"Failed points\"] tbody tr').length"), 3.0);
    for window in [[420, 900], [1400, 900]] {
        page.resize(window);
        assert!(page.number("document.documentElement.scrollWidth") <= f64::from(window[0]));
    }
    assert_eq!(page.complaints(), Vec::<String>::new());
}

fn select(page: &mut Browser, id: &str, value: usize) {
    page.value(&format!(
        "{{ const s = document.getElementById('{id}'); s.value = '{value}'; s.dispatchEvent(new Event('change')); }}"
    ));
}

/// Both figures have the nine points and the nominal one, and follow the chosen parameters.
fn choose_parameters(page: &mut Browser) {
    for (figure, id) in [("scatter", "scatter-x"), ("map", "map-x")] {
        let circles = format!("document.querySelectorAll('#{figure} circle').length");
        assert_eq!(page.number(&circles), 10.0, "{figure}");
        let picture = format!("document.getElementById('{figure}').innerHTML");
        select(page, id, 0);
        let over_friction = page.text(&picture);
        select(page, id, 1);
        let over_load = page.text(&picture);
        assert!(over_friction != over_load && over_load.contains("&lt;load&gt;"), "{figure}");
        select(page, id, 0);
        assert_eq!(page.text(&picture), over_friction);
    }
    select(page, "map-y", 1);
    let on_line = "document.querySelectorAll('#map .zero').length";
    assert!(page.number(on_line) >= 2.0, "the boundary lies between the columns");
    select(page, "map-y", 0);
    assert_eq!(page.number(on_line), 0.0);
}

/// A point is chosen in the table, by a click and by keys, and is marked in both figures.
fn choose_points(page: &mut Browser) {
    let title = "document.querySelector('#point h3').textContent";
    let worst = page.text("document.querySelector('button[data-point]').dataset.point");
    page.value("document.querySelector('button[data-point]').click()");
    assert_eq!(page.text(title), format!("Point {worst}"));
    assert!(page.number("document.querySelectorAll('#point tr.unstable').length") >= 1.0);
    page.value("document.querySelector('#map circle[data-point=\"0\"]').dispatchEvent(new MouseEvent('click'))");
    assert_eq!(page.text(title), "Nominal point");
    assert_eq!(page.number("document.querySelectorAll('circle.picked[data-point=\"0\"]').length"), 2.0);
    page.value("document.querySelector('#scatter svg').focus()");
    page.press("ArrowRight");
    assert_eq!(page.text(title), "Point 1");
    page.press("ArrowLeft");
    page.press("ArrowLeft");
    // The last point has failed.
    assert!(page.text("document.querySelector('#point p').textContent").contains("friction"));
}

/// The chosen point's fastest mode moves; its other modes and those of other points have shapes of their own; a point
/// that has failed has none.
fn choose_shapes(page: &mut Browser) {
    let title = "document.getElementById('shape-title').textContent";
    let worst = page.text("document.querySelector('button[data-point]').dataset.point");
    page.value("document.querySelector('button[data-point]').click()");
    assert!(page.text(title).ends_with(&format!("of point {worst}")), "{}", page.text(title));
    page.value("document.getElementById('shape').scrollIntoView({behavior: 'instant'})");
    page.wait_for(&format!("{DRAWN} > 0.05"));
    let before = page.text(PICTURE);
    page.wait_for(&format!("{PICTURE} !== {}", json!(before)));
    page.value("document.getElementById('play').click()");
    let settled = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))";
    page.wait_for(settled);
    page.value(&format!("{{ window.kept = {PIXELS}; }}"));
    page.value("document.querySelector('#map circle[data-point=\"0\"]').dispatchEvent(new MouseEvent('click'))");
    page.wait_for(settled);
    assert!(page.number(&changed()) > 0.02, "the nominal point has another shape");
    assert!(page.text(title).ends_with("of the nominal point"), "{}", page.text(title));
    let buttons = page.number("document.querySelectorAll('#point button[data-shape]').length");
    assert_eq!(page.number("document.querySelectorAll('#shape-mode option').length"), buttons);
    page.value("document.querySelector('#scatter svg').focus()");
    page.press("ArrowLeft");
    assert!(page.text("document.getElementById('shape-note').textContent").contains("has failed"));
    assert_eq!(page.number("document.getElementById('view').clientHeight"), 0.0);
    page.value("document.querySelector('button[data-point]').click()");
    page.wait_for(settled);
    assert!(page.number(&changed()) < 1e-3, "the same shape at rest");
}

const PIXELS: &str = "(() => { const view = document.getElementById('view'); const c = document.createElement('canvas'); \
    c.width = view.width; c.height = view.height; const x = c.getContext('2d'); x.drawImage(view, 0, 0); \
    return x.getImageData(0, 0, c.width, c.height).data; })()";

/// The share of the shape's picture that differs from what was kept by more than rounding.
fn changed() -> String {
    format!(
        "(() => {{ const p = {PIXELS}; let n = 0; p.forEach((x, i) => {{ n += Math.abs(x - kept[i]) > 60; }}); return n / p.length; }})()"
    )
}

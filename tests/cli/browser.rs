//! `squeal report` on the two pads on a disc (tests/validation/pads_on_disc.rs), and its page in a browser: what
//! a reader sees and can do.

use std::path::Path;

use crate::support::browser::Browser;
use crate::support::program::Place;
use serde_json::json;

const WINDOW: [u32; 2] = [1400, 900];

/// A study with one coupling, and its report, which begins with this sentence.
fn reported(friction_values: &str, sentence: &str) -> Place {
    let place = Place::pads();
    let band = ["--band", "0:1500", "--friction", friction_values];
    let finished = place.run(&[&["stability", "brake.toml"][..], &band, &["-o", "run"]].concat());
    assert_eq!(finished.code, 0, "{}", finished.err);
    let finished = place.run(&["report", "run", "--plots", "run/plots", "--paraview", "run/moving"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.starts_with(sentence), "{}", finished.out);
    place
}

fn open(place: &Place) -> Browser {
    let page = place.path("run/report.html");
    let mut browser = Browser::open(Path::new(&page), WINDOW);
    browser.wait_for("document.getElementById('chosen').textContent !== ''");
    browser
}

/// The share of the shape's pixels that are not the ground.
pub const DRAWN: &str = "(() => { const view = document.getElementById('view'); const c = document.createElement('canvas'); \
    c.width = view.width; c.height = view.height; const x = c.getContext('2d'); x.drawImage(view, 0, 0); \
    const p = x.getImageData(0, 0, c.width, c.height).data; let n = 0; for (let i = 3; i < p.length; i += 4) n += p[i] > 0; \
    return n / (c.width * c.height); })()";
/// The picture of the shape.
pub const PICTURE: &str = "document.getElementById('view').toDataURL()";

#[test]
fn the_page_answers_and_its_controls_work() {
    let place = reported("0:0.6:0.2", "Squeals at 1.27 kHz above \u{3bc} = 0.");
    let mut page = open(&place);
    let headline = page.text("document.querySelector('.verdict').textContent");
    assert!(headline.starts_with("Squeals at 1.27 kHz above"), "{headline}");
    let answer = page.text("document.querySelector('.answer').innerText");
    for word in ["Kinetic energy in", "coalesce at 1.27 kHz", "Energy input by", "Dissipation by", "Largest reductions"]
    {
        assert!(answer.contains(word), "{word} is not in {answer}");
    }
    shape(&mut page);
    table(&mut page);
    choice(&mut page);
    pressure(&mut page);
    for window in [[420, 900], WINDOW] {
        page.resize(window);
        assert!(page.number("document.documentElement.scrollWidth") <= f64::from(window[0]));
    }
    let pdf = page.send("Page.printToPDF", json!({"preferCSSPageSize": true}));
    assert!(pdf["data"].as_str().unwrap().len() > 20_000);
    assert_eq!(page.complaints(), Vec::<String>::new());
}

/// The shape is there, moves, stands still, and turns.
fn shape(page: &mut Browser) {
    page.value("document.getElementById('shape').scrollIntoView({behavior: 'instant'})");
    page.wait_for(&format!("{DRAWN} > 0.05"));
    let before = page.text(PICTURE);
    page.wait_for(&format!("{PICTURE} !== {}", json!(before)));
    page.value("document.getElementById('play').click()");
    assert_eq!(page.text("document.getElementById('play').textContent"), "Play");
    page.wait_for("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
    let still = page.text(PICTURE);
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert_eq!(page.text(PICTURE), still);
    page.value("document.getElementById('view').focus()");
    page.press("ArrowLeft");
    page.wait_for(&format!("{PICTURE} !== {}", json!(still)));
    let whole = page.number(DRAWN);
    page.value("document.querySelector('#parts input').click()");
    page.wait_for(&format!("{DRAWN} < 0.9 * {whole}"));
    page.press(" ");
    assert_eq!(page.text("document.getElementById('play').textContent"), "Pause");
}

/// The column of a table.
fn column(page: &mut Browser, place: usize) -> Vec<f64> {
    let cells =
        format!("[...document.querySelectorAll('#mode-table tbody tr')].map((row) => row.cells[{place}].textContent)");
    let minus = |text: &str| text.replace('\u{2212}', "-").parse().unwrap();
    page.value(&cells).as_array().unwrap().iter().map(|cell| minus(cell.as_str().unwrap())).collect()
}

fn table(page: &mut Browser) {
    const FREQUENCY: usize = 2;
    const GROWTH: usize = 3;
    page.value("document.getElementById('mode-clear').click()");
    let all = column(page, FREQUENCY);
    assert!(all.is_sorted() && all.len() > 12, "{all:?}");
    let sort = "document.querySelectorAll('#mode-table thead button')[3].click()";
    page.value(sort);
    assert!(column(page, GROWTH).is_sorted());
    page.value(sort);
    assert!(column(page, GROWTH).is_sorted_by(|a, b| a >= b));
    let filter = |page: &mut Browser, name: &str, text: &str| {
        let input = format!("document.querySelector('[aria-label=\"filter {name}\"]')");
        page.value(&format!("{{ const i = {input}; i.value = '{text}'; i.dispatchEvent(new Event('input')); }}"));
    };
    // The pads are undamped: what is below is noise.
    filter(page, "growth rate, 1/s", "> 0.1");
    let growing = column(page, GROWTH);
    assert!(!growing.is_empty() && growing.iter().all(|&growth| growth > 0.0));
    filter(page, "frequency, Hz", "0 - 1000");
    assert_eq!(column(page, FREQUENCY), Vec::<f64>::new());
    page.value("document.getElementById('mode-clear').click()");
    page.value("document.getElementById('mode-unstable').click()");
    assert_eq!(column(page, GROWTH).len(), growing.len());
    page.value(
        "{ const s = document.getElementById('mode-friction'); s.value = '3'; s.dispatchEvent(new Event('change')); }",
    );
    assert_eq!(column(page, 0), [0.6]);
}

/// A mode chosen in one place is marked in all.
fn choice(page: &mut Browser) {
    page.value("document.getElementById('mode-clear').click()");
    page.value("document.querySelectorAll('#mode-table tbody tr.unstable')[0].click()");
    let chosen = page.text("document.querySelector('tr.picked').dataset.name");
    let marks = format!("document.querySelectorAll('.plot circle.picked[data-mode=\"{chosen}\"]').length");
    assert_eq!(page.number(&marks), 4.0);
    assert_eq!(page.text("document.getElementById('shape-mode').value"), chosen);
    assert_eq!(page.text("document.querySelector('.instability select').value"), chosen);
    page.value("document.querySelector('.plot svg').focus()");
    for key in ["ArrowLeft", "ArrowRight"] {
        let before = page.text("document.getElementById('shape-mode').value");
        page.press(key);
        let after = page.text("document.getElementById('shape-mode').value");
        assert_ne!(before, after, "{key}");
    }
}

fn pressure(page: &mut Browser) {
    let picture = "document.querySelector('#maps canvas').toDataURL()";
    let mut seen = vec![page.text(picture)];
    for (id, value) in [("pressure-friction", "0"), ("pressure-field", "status")] {
        page.value(&format!("{{ const s = document.getElementById('{id}'); s.value = '{value}'; s.dispatchEvent(new Event('change')); }}"));
        seen.push(page.text(picture));
    }
    assert!(seen[0] != seen[1] && seen[1] != seen[2]);
    assert_eq!(page.number("document.querySelectorAll('#maps figure').length"), 2.0);
}

#[test]
fn figures_and_motion_come_beside_the_page() {
    let place = reported("0.4", "Squeals at 1.27 kHz at \u{3bc} = 0.4.\n");
    for name in ["stability-chart", "growth-rates", "convergence"] {
        let svg = place.read(&format!("run/plots/{name}.svg"));
        assert!(
            roxmltree::Document::parse(&svg)
                .unwrap()
                .root_element()
                .has_tag_name(("http://www.w3.org/2000/svg", "svg"))
        );
        let png = std::fs::read(place.path(&format!("run/plots/{name}.png"))).unwrap();
        assert_eq!(&png[1..4], b"PNG");
    }
    let moving: Vec<_> =
        std::fs::read_dir(place.path("run/moving")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let is_collection = |path: &&std::path::PathBuf| path.extension().is_some_and(|kind| kind == "pvd");
    let text = std::fs::read_to_string(moving.iter().find(is_collection).unwrap()).unwrap();
    let xml = roxmltree::Document::parse(&text).unwrap();
    let files: Vec<&str> = xml.descendants().filter_map(|node| node.attribute("file")).collect();
    assert_eq!(files.len(), 24);
    assert!(files.iter().all(|file| Path::new(&place.path("run/moving")).join(file).is_file()));
    // What is there is not replaced unasked, and goes with the run that it belongs to.
    let finished = place.run(&["report", "run"]);
    assert!(finished.code == 2 && finished.err.contains("--force"), "{}", finished.err);
    assert_eq!(place.run(&["report", "run", "--force"]).code, 0);
    let finished = place.run(&["static", "brake.toml", "--friction", "0.2", "-o", "run", "--force"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let finished = place.run(&["report", "run"]);
    assert!(finished.code == 2 && finished.err.contains("has no modes"), "{}", finished.err);
}

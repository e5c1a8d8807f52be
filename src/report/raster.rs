//! Figures as PNG.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::output::overwrite::FileKind;
use crate::{Error, Result};

/// Draws SVG figures with the fonts of this computer.
pub struct Painter {
    options: Options<'static>,
}

/// First bytes of every PNG file.
const MAGIC: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// A figure as PNG, which has no mark of ours.
pub const KIND: FileKind = FileKind { name: "a PNG file", is_one: is_png };

fn is_png(path: &Path) -> bool {
    let mut head = [0; MAGIC.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == MAGIC
}

/// Pixels for each of the figure's.
const FINENESS: f32 = 2.0;

impl Painter {
    /// Looks for the fonts.
    ///
    /// # Errors
    /// [`Error::Input`] where there is none: figures without words are of no use.
    pub fn new() -> Result<Painter> {
        let mut fonts = fontdb::Database::new();
        fonts.load_system_fonts();
        let Some(any) = fonts.faces().next().map(|face| face.families[0].0.clone()) else {
            return Err(Error::input(
                "there is no font to write PNG figures with. Install one, e.g. fonts-dejavu-core",
            ));
        };
        const SANS: [&str; 3] = ["DejaVu Sans", "Liberation Sans", "Noto Sans"];
        let has = |name: &str| fonts.faces().any(|face| face.families.iter().any(|(family, _)| family == name));
        let sans = SANS.into_iter().find(|name| has(name)).map_or(any, String::from);
        fonts.set_sans_serif_family(sans.clone());
        Ok(Painter { options: Options { fontdb: Arc::new(fonts), font_family: sans, ..Options::default() } })
    }

    /// A figure as the bytes of a PNG file, on white.
    ///
    /// # Errors
    /// [`Error::Library`] where the SVG cannot be read or drawn.
    pub fn png(&self, svg: &str) -> Result<Vec<u8>> {
        let failed = |reason: String| Error::library("a figure cannot be drawn")(reason);
        let tree = Tree::from_str(svg, &self.options).map_err(|reason| failed(reason.to_string()))?;
        let size = tree.size().to_int_size().scale_by(FINENESS).ok_or_else(|| failed("it has no size".into()))?;
        let mut pixels = Pixmap::new(size.width(), size.height()).ok_or_else(|| failed("it is too large".into()))?;
        pixels.fill(Color::WHITE);
        resvg::render(&tree, Transform::from_scale(FINENESS, FINENESS), &mut pixels.as_mut());
        pixels.encode_png().map_err(|reason| failed(reason.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::svg::{Anchor, Sheet};
    use super::*;

    /// Pixels of a figure that are not white.
    fn inked(draw: impl FnOnce(&mut Sheet)) -> usize {
        let mut sheet = Sheet::new([120.0, 40.0]);
        draw(&mut sheet);
        let png = Painter::new().unwrap().png(&sheet.finish("test")).unwrap();
        let pixels = Pixmap::decode_png(&png).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (240, 80));
        pixels.pixels().iter().filter(|p| (p.red(), p.green(), p.blue()) != (255, 255, 255)).count()
    }

    #[test]
    fn lines_and_words_leave_ink() {
        assert_eq!(inked(|_| ()), 0);
        // A line of 100 by 1, drawn at twice the size.
        let line = inked(|sheet| sheet.line([10.0, 20.5], [110.0, 20.5], r#"stroke="black""#));
        assert!((400..=410).contains(&line), "{line}");
        let word = inked(|sheet| sheet.text([10.0, 30.0], Anchor::Start, "\u{3bc} = 0.27", ""));
        assert!((300..3000).contains(&word), "{word}");
    }
}

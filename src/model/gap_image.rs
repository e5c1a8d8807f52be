//! Gap fields as images: the topography of a contact surface, of which grey levels are the depth.
//!
//! ```text
//! gap = "topography.png"
//! gap_image = { plane = "xy", lower_left = [-40, 60], upper_right = [40, 110], black = 0, white = 0.02 }
//!
//! gap = black + (white - black) level / largest level       bilinear between the centres of four pixels
//! ```

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Transformations};
use serde::{Deserialize, Serialize};

/// Where an image lies, and what its grey levels mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ImageFrame {
    /// The axes along its rows and up its columns.
    pub plane: [usize; 2],
    /// The outer corner of its pixel at the lower left, m; on a mirrored image to the right of the other.
    pub lower_left: [f64; 2],
    /// The outer corner of its pixel at the upper right, m.
    pub upper_right: [f64; 2],
    /// Gap where it is black, m.
    pub black: f64,
    /// Gap where it is white, m.
    pub white: f64,
}

/// Gaps (m) of the pixels of an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct GapImage {
    pub frame: ImageFrame,
    n_columns: usize,
    /// By rows, the uppermost first.
    gaps: Vec<f64>,
}

impl GapImage {
    /// Reads a PNG file in grey levels, of 1 to 16 bits.
    ///
    /// # Errors
    /// What is wrong.
    pub fn read(file: &Path, frame: ImageFrame) -> Result<GapImage, String> {
        let place = file.display();
        let fail = |reason: &dyn std::fmt::Display| format!("the image {place} cannot be read: {reason}");
        let input = BufReader::new(File::open(file).map_err(|reason| fail(&reason))?);
        let mut decoder = Decoder::new(input);
        decoder.set_transformations(Transformations::EXPAND);
        let header = decoder.read_header_info().map_err(|reason| fail(&reason))?;
        require_size(header.width, header.height).map_err(|what| format!("the image {place} {what}"))?;
        let mut reader = decoder.read_info().map_err(|reason| fail(&reason))?;
        let mut bytes = vec![0; reader.output_buffer_size().ok_or_else(|| fail(&"it is too large"))?];
        let info = reader.next_frame(&mut bytes).map_err(|reason| fail(&reason))?;
        bytes.truncate(info.buffer_size());
        let levels = match info.bit_depth {
            BitDepth::Sixteen => bytes.as_chunks().0.iter().map(|pair| u16::from_be_bytes(*pair)).collect(),
            _ => bytes.iter().map(|&byte| u16::from(byte)).collect::<Vec<u16>>(),
        };
        let largest = if info.bit_depth == BitDepth::Sixteen { u16::MAX } else { u16::from(u8::MAX) };
        let levels = grey(&levels, info.color_type).map_err(|what| format!("the image {place} {what}"))?;
        let gap = |level: u16| frame.black + (frame.white - frame.black) * f64::from(level) / f64::from(largest);
        Ok(GapImage { frame, n_columns: info.width as usize, gaps: levels.into_iter().map(gap).collect() })
    }

    /// The gap (m) at a point (m).
    ///
    /// # Errors
    /// Where the point is outside of the image.
    pub fn at(&self, x: [f64; 3]) -> Result<f64, String> {
        let ImageFrame { plane, lower_left, upper_right, .. } = self.frame;
        let share = |i: usize| (x[plane[i]] - lower_left[i]) / (upper_right[i] - lower_left[i]);
        let [right, up] = [share(0), share(1)];
        if !(-ROUNDING..=1.0 + ROUNDING).contains(&right) || !(-ROUNDING..=1.0 + ROUNDING).contains(&up) {
            return Err(format!("the contact point at {x:?} m is outside of the image"));
        }
        let (columns, rows) = (between(right, self.n_columns), between(1.0 - up, self.gaps.len() / self.n_columns));
        let pixel = |row: usize, column: usize| self.gaps[row * self.n_columns + column];
        let along =
            |row: usize| (1.0 - columns.weight) * pixel(row, columns.first) + columns.weight * pixel(row, columns.last);
        Ok((1.0 - rows.weight) * along(rows.first) + rows.weight * along(rows.last))
    }
}

/// The largest image that is read, in pixels.
const MAX_PIXELS: u64 = 16_000_000;

/// Refuses a size by the header alone, before there is memory for the pixels.
fn require_size(n_columns: u32, n_rows: u32) -> Result<(), String> {
    if u64::from(n_columns) * u64::from(n_rows) <= MAX_PIXELS {
        return Ok(());
    }
    let most = MAX_PIXELS / 1_000_000;
    Err(format!(
        "has {n_columns} x {n_rows} pixels, more than {most} million. Scale it down, or cut out the contact surface"
    ))
}

/// A point this far outside of an image, as a share of that, is on its edge.
const ROUNDING: f64 = 1e-9;

/// Two neighbours, and how much the last one counts.
struct Neighbours {
    first: usize,
    last: usize,
    weight: f64,
}

/// The pixels of `n` around a place between 0 and 1; beyond the centres of the outer ones these alone.
fn between(share: f64, n: usize) -> Neighbours {
    let at = (share * n as f64 - 0.5).clamp(0.0, (n - 1) as f64);
    let first = at as usize;
    Neighbours { first, last: (first + 1).min(n - 1), weight: at - first as f64 }
}

/// One level a pixel. Colours are grey where all three are equal.
fn grey(levels: &[u16], colours: ColorType) -> Result<Vec<u16>, &'static str> {
    match colours {
        ColorType::Grayscale => Ok(levels.to_vec()),
        ColorType::Rgb => {
            let pixels: &[[u16; 3]] = levels.as_chunks().0;
            let is_grey = pixels.iter().all(|[red, green, blue]| red == green && green == blue);
            is_grey
                .then(|| pixels.iter().map(|pixel| pixel[0]).collect())
                .ok_or("has colours. Save it in grey levels, of which the gap is a linear function")
        }
        _ => Err("is transparent in places. Save it without an alpha channel"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: ImageFrame =
        ImageFrame { plane: [0, 2], lower_left: [1.0, 10.0], upper_right: [5.0, 12.0], black: 0.0, white: 255.0 };

    /// Writes a PNG file of so many columns.
    fn write(path: &Path, n_columns: u32, colours: ColorType, depth: BitDepth, bytes: &[u8]) {
        let samples = colours.samples() as u32 * if depth == BitDepth::Sixteen { 2 } else { 1 };
        let n_rows = bytes.len() as u32 / (n_columns * samples);
        let mut encoder = png::Encoder::new(File::create(path).unwrap(), n_columns, n_rows);
        encoder.set_color(colours);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
    }

    fn read(n_columns: u32, colours: ColorType, depth: BitDepth, bytes: &[u8]) -> Result<GapImage, String> {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("topography.png");
        write(&file, n_columns, colours, depth, bytes);
        GapImage::read(&file, FRAME)
    }

    /// Two rows of four pixels of 1 m: the upper one at z = 11.5.
    #[test]
    fn a_gap_is_bilinear_between_the_centres_of_pixels() {
        let image = read(4, ColorType::Grayscale, BitDepth::Eight, &[0, 10, 20, 30, 100, 110, 120, 255]).unwrap();
        let at = |x: f64, z: f64| image.at([x, 7.0, z]).unwrap();
        assert!((at(1.5, 11.5) - 0.0).abs() < 1e-12 && (at(4.5, 10.5) - 255.0).abs() < 1e-12, "centres");
        assert!((at(2.0, 11.5) - 5.0).abs() < 1e-12 && (at(2.5, 11.25) - 35.0).abs() < 1e-12, "along rows and columns");
        assert!((at(3.0, 11.0) - 0.5 * (15.0 + 115.0)).abs() < 1e-12, "between four");
        assert_eq!([at(1.0, 12.0), at(5.0, 10.0)], [0.0, 255.0], "the corners are those of the outer pixels");
    }

    #[test]
    fn a_mirrored_image_has_its_corners_the_other_way_round() {
        let frame = ImageFrame { lower_left: [5.0, 10.0], upper_right: [1.0, 12.0], ..FRAME };
        let image = read(4, ColorType::Grayscale, BitDepth::Eight, &[0, 10, 20, 30, 100, 110, 120, 255]).unwrap();
        let image = GapImage { frame, ..image };
        assert_eq!(image.at([4.5, 0.0, 11.5]).unwrap(), 0.0);
    }

    #[test]
    fn points_outside_are_refused() {
        let image = read(1, ColorType::Grayscale, BitDepth::Eight, &[7]).unwrap();
        assert!((image.at([3.0, 0.0, 11.0]).unwrap() - 7.0).abs() < 1e-12);
        for x in [[0.99, 0.0, 11.0], [3.0, 0.0, 12.01], [f64::NAN, 0.0, 11.0]] {
            assert!(image.at(x).unwrap_err().contains("is outside of the image"));
        }
    }

    #[test]
    fn levels_are_of_any_depth_and_colours_are_refused() {
        let fine = read(1, ColorType::Grayscale, BitDepth::Sixteen, &[0x80, 0x00]).unwrap();
        assert!((fine.gaps[0] - 255.0 * 32768.0 / 65535.0).abs() < 1e-9);
        let grey = read(2, ColorType::Rgb, BitDepth::Eight, &[9, 9, 9, 200, 200, 200]).unwrap();
        assert_eq!(grey.gaps, [9.0, 200.0]);
        let red = read(1, ColorType::Rgb, BitDepth::Eight, &[200, 9, 9]).unwrap_err();
        assert!(red.contains("has colours. Save it in grey levels"), "{red}");
        let clear = read(1, ColorType::GrayscaleAlpha, BitDepth::Eight, &[200, 9]).unwrap_err();
        assert!(clear.contains("without an alpha channel"), "{clear}");
    }

    #[test]
    fn an_image_that_is_too_large_is_refused_by_its_header() {
        assert!(require_size(4000, 4000).is_ok() && require_size(u32::MAX, u32::MAX).is_err());
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("topography.png");
        let writer = |n_columns: u32| {
            let mut encoder = png::Encoder::new(File::create(&file).unwrap(), n_columns, 4000);
            encoder.set_color(ColorType::Grayscale);
            drop(encoder.write_header().unwrap());
            GapImage::read(&file, FRAME).unwrap_err()
        };
        let large = writer(4001);
        assert!(large.contains("has 4001 x 4000 pixels, more than 16 million. Scale it down"), "{large}");
        assert!(writer(4000).contains("cannot be read"), "there are no pixels");
    }

    #[test]
    fn a_file_that_is_no_image_is_refused() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("topography.png");
        assert!(GapImage::read(&file, FRAME).unwrap_err().contains("cannot be read"));
        std::fs::write(&file, "x_mm,y_mm,gap_um").unwrap();
        assert!(GapImage::read(&file, FRAME).unwrap_err().contains("cannot be read"));
    }
}

/// Red, green, blue.
pub(crate) type Rgb = [u8; 3];

/// A picture: RGB, 8 bits, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three bytes per pixel.
    pub pixels: Vec<u8>,
}

/// A picture, and where its data are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Charted {
    /// With captions and all.
    pub image: Image,
    /// Left, top, right, bottom of the data, in pixels.
    pub area: [usize; 4],
}

impl Image {
    /// The picture as a PNG file.
    ///
    /// # Errors
    /// [`png::EncodingError`] if the picture is empty or its fields contradict each other.
    pub fn to_png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let mut encoder = png::Encoder::new(&mut bytes, side(self.width), side(self.height));
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// A white picture to paint on.
#[derive(Clone, Debug)]
pub(crate) struct Canvas {
    image: Image,
}

impl Canvas {
    pub(crate) fn new(width: usize, height: usize) -> Canvas {
        Canvas {
            image: Image {
                width,
                height,
                pixels: vec![u8::MAX; width * height * 3],
            },
        }
    }

    pub(crate) fn into_image(self) -> Image {
        self.image
    }

    /// A line with round ends, anti-aliased; lengths in pixels.
    pub(crate) fn segment(&mut self, from: [f32; 2], to: [f32; 2], radius: f32, colour: Rgb) {
        let reach = radius + 1.0;
        let range = |axis: usize, n: usize| {
            let low = (from[axis].min(to[axis]) - reach).floor().max(0.0) as usize;
            let high = (from[axis].max(to[axis]) + reach).ceil().max(0.0) as usize;
            low..high.min(n)
        };
        let along = [to[0] - from[0], to[1] - from[1]];
        let squared = (along[0] * along[0] + along[1] * along[1]).max(f32::EPSILON);
        for y in range(1, self.image.height) {
            for x in range(0, self.image.width) {
                let at = [x as f32 + 0.5 - from[0], y as f32 + 0.5 - from[1]];
                let share = ((at[0] * along[0] + at[1] * along[1]) / squared).clamp(0.0, 1.0);
                let off = [at[0] - share * along[0], at[1] - share * along[1]];
                let cover = (radius + 0.5 - off[0].hypot(off[1])).clamp(0.0, 1.0);
                if cover > 0.0 {
                    self.blend(x, y, colour, cover);
                }
            }
        }
    }

    /// A filled rectangle, cut at the edges.
    pub(crate) fn fill(&mut self, corner: [usize; 2], size: [usize; 2], colour: Rgb) {
        for y in corner[1]..(corner[1] + size[1]).min(self.image.height) {
            for x in corner[0]..(corner[0] + size[0]).min(self.image.width) {
                self.blend(x, y, colour, 1.0);
            }
        }
    }

    /// Copies a picture, cut at the edges.
    pub(crate) fn paste(&mut self, picture: &Image, left: usize, top: usize) {
        let n_columns = picture.width.min(self.image.width.saturating_sub(left));
        let rows = picture.pixels.chunks_exact((picture.width * 3).max(1));
        for (row, y) in rows.zip(top..self.image.height) {
            let start = (y * self.image.width + left) * 3;
            let target = self.image.pixels.get_mut(start..start + n_columns * 3);
            if let (Some(target), Some(source)) = (target, row.get(..n_columns * 3)) {
                target.copy_from_slice(source);
            }
        }
    }

    fn blend(&mut self, x: usize, y: usize, colour: Rgb, cover: f32) {
        let start = (y * self.image.width + x) * 3;
        if let Some(pixel) = self.image.pixels.get_mut(start..start + 3) {
            for (old, new) in pixel.iter_mut().zip(colour) {
                let mixed = f32::from(*old) + (f32::from(new) - f32::from(*old)) * cover;
                *old = mixed.round() as u8;
            }
        }
    }
}

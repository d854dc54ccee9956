//! The colours of a picture's pixels, however they are saved.

use crate::values::{Channels, Image, Samples};

/// Looks up colours, 0 to 1.
pub(super) struct Pixels<'a> {
    image: &'a Image,
    stride: usize,
    /// Where a pixel's red, green and blue stand among its samples.
    channels: [usize; 3],
}

impl<'a> Pixels<'a> {
    pub(super) fn new(image: &'a Image) -> Self {
        let stride = image.channels.count();
        let channels = if stride < 3 { [0; 3] } else { [0, 1, 2] };
        Self { image, stride, channels }
    }

    /// Red, green and blue of a pixel.
    pub(super) fn at(&self, at: usize) -> [f32; 3] {
        self.channels.map(|channel| self.sample(at, channel))
    }

    /// How far a pixel's colour is from gray: the greatest difference of its channels, by the share to
    /// which it is opaque.
    pub(super) fn chroma(&self, at: usize) -> f32 {
        let [red, green, blue] = self.at(at);
        let opacity = match self.image.channels {
            Channels::Gray | Channels::Rgb => 1.0,
            Channels::GrayAlpha | Channels::Rgba => self.sample(at, self.stride - 1),
        };
        opacity * (red.max(green).max(blue) - red.min(green).min(blue))
    }

    fn sample(&self, at: usize, channel: usize) -> f32 {
        match &self.image.samples {
            Samples::U8(samples) => f32::from(samples[at * self.stride + channel]) / 255.0,
            Samples::U16(samples) => f32::from(samples[at * self.stride + channel]) / 65535.0,
            Samples::F32(samples) => samples[at * self.stride + channel],
        }
    }
}

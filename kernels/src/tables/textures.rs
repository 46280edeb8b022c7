//! Images, and how textures look values up in them.

use std::sync::LazyLock;

/// An image as it was stored: sRGB. Alpha is left out.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    /// Texels of a row, > 0.
    pub width: u32,
    /// Rows, > 0.
    pub height: u32,
    /// Red, green and blue, not linear, row by row from the top left; `width * height` of them.
    pub texels: Vec<[u8; 3]>,
}

impl core::fmt::Debug for Image {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Image {} x {}", self.width, self.height)
    }
}

/// How an image is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Index of its image.
    pub image: u32,
    /// What is to the left and right of the image, and what is above and below it.
    pub wrap: [Wrap; 2],
    /// What is between texels.
    pub filter: Filter,
}

/// What continues an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    /// The image again, every other time mirrored.
    Mirror,
    /// The texels of its edge.
    Clamp,
}

/// What is between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// A bilinear mean, of linear values.
    Linear,
}

/// A texture of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index of the texture.
    pub texture: u32,
    /// Which of the model's two sets of texture coordinates it uses: 0 or 1.
    pub texcoords: u32,
    /// Shifts texture coordinates, after the rotation.
    pub offset: [f32; 2],
    /// Turns texture coordinates, and so the image the other way, after the scale `[rad]`.
    pub rotation: f32,
    /// Multiplies texture coordinates.
    pub scale: [f32; 2],
}

impl Image {
    /// Shows all that makes it up to `digest`, in pieces.
    pub(super) fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(&[self.width, self.height]));
        digest(self.texels.as_flattened());
    }
}

impl Texture {
    /// Shows all that makes it up to `digest`, in pieces.
    pub(super) fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        let [u, v] = self.wrap;
        digest(&self.image.to_le_bytes());
        digest(&[u as u8, v as u8, self.filter as u8]);
    }
}

impl TextureRef {
    /// Shows all that makes it up to `digest`, in pieces.
    pub(super) fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(&[self.texture, self.texcoords]));
        digest(bytemuck::cast_slice(&[self.offset, self.scale]));
        digest(&self.rotation.to_le_bytes());
    }

    /// Texture coordinates in the image for those of a vertex: scaled, rotated, shifted (KHR_texture_transform).
    pub fn transform(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = self.rotation.sin_cos();
        let [u, v] = [u * self.scale[0], v * self.scale[1]];
        [cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]]
    }
}

impl Image {
    /// The linear value of the texel in column `x` of row `y`, in [0, 1].
    ///
    /// # Panics
    /// If there is no such texel.
    pub fn linear(&self, x: u32, y: u32) -> [f32; 3] {
        assert!(x < self.width && y < self.height, "texel {x}, {y} of {self:?}");
        self.texels[y as usize * self.width as usize + x as usize].map(|value| LINEAR[usize::from(value)])
    }
}

/// Linear values of sRGB bytes (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    core::array::from_fn(|byte| {
        let value = byte as f64 / 255.0;
        let linear = if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

impl Texture {
    /// The linear value of `image`, which must be this texture's, at `uv`, in [0, 1]: (0, 0) is the upper left corner
    /// of the image, (1, 1) the lower right one. Coordinates that are not finite count as 0.
    pub fn sample(&self, image: &Image, uv: [f32; 2]) -> [f32; 3] {
        let size = [image.width, image.height];
        let texel =
            |x: i64, y: i64| image.linear(self.wrap[0].column(x, image.width), self.wrap[1].column(y, image.height));
        let uv = uv.map(|uv| if uv.is_finite() { f64::from(uv) } else { 0.0 });
        let at = [0, 1].map(|axis| uv[axis] * f64::from(size[axis]));
        match self.filter {
            Filter::Nearest => texel(at[0].floor() as i64, at[1].floor() as i64),
            Filter::Linear => {
                let corner = at.map(|at| (at - 0.5).floor());
                let [right, lower] = [0, 1].map(|axis| (at[axis] - 0.5 - corner[axis]) as f32);
                let [x, y] = corner.map(|corner| corner as i64);
                let [next_x, next_y] = [x.saturating_add(1), y.saturating_add(1)];
                let upper = mix(texel(x, y), texel(next_x, y), right);
                mix(upper, mix(texel(x, next_y), texel(next_x, next_y), right), lower)
            }
        }
    }
}

fn mix(from: [f32; 3], to: [f32; 3], share: f32) -> [f32; 3] {
    core::array::from_fn(|channel| from[channel] + (to[channel] - from[channel]) * share)
}

impl Wrap {
    /// The column, or row, of an image with `size` of them that stands for column `at` of the endless plane.
    fn column(self, at: i64, size: u32) -> u32 {
        let size = i64::from(size);
        let column = match self {
            Self::Repeat => at.rem_euclid(size),
            Self::Mirror => {
                let column = at.rem_euclid(2 * size);
                if column < size { column } else { 2 * size - 1 - column }
            }
            Self::Clamp => at.clamp(0, size - 1),
        };
        column as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_continue_the_image() {
        let row = |wrap: Wrap| (-4..8).map(|at| wrap.column(at, 3)).collect::<Vec<_>>();
        assert_eq!(row(Wrap::Repeat), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1]);
        assert_eq!(row(Wrap::Mirror), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1]);
        assert_eq!(row(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2]);
    }

    #[test]
    fn any_coordinates_have_a_value() {
        let image = Image { width: 2, height: 1, texels: vec![[0; 3], [255; 3]] };
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Nearest, Filter::Linear] {
                let texture = Texture { image: 0, wrap: [wrap; 2], filter };
                for u in [0.0, -0.0, 1e30, -1e30, f32::MAX, f32::MIN, f32::INFINITY, f32::NAN] {
                    let value = texture.sample(&image, [u, u]);
                    assert!(value.iter().all(|value| (0.0..=1.0).contains(value)), "{u}");
                }
            }
        }
    }
}

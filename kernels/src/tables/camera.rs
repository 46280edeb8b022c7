//! The pinhole camera.

/// A pinhole and the film in front of it, in world space.
///
/// The film point of pixel coordinates (x, y), with (0, 0) the upper left corner of the image, lies in direction
/// `corner + x pixel_x + y pixel_y` from the pinhole, which is one metre ahead along the viewing axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole `[m]`.
    pub position: [f32; 3],
    /// Unit viewing direction.
    pub forward: [f32; 3],
    /// From the pinhole to the upper left corner of the film, one metre ahead.
    pub corner: [f32; 3],
    /// From one pixel to its right neighbour.
    pub pixel_x: [f32; 3],
    /// From one pixel to the one below.
    pub pixel_y: [f32; 3],
    /// Distance, along the viewing axis, of the plane on which paths start `[m]`, >= 0.
    pub near: f32,
    /// Pixels in a row of the whole image: pixel `i` is (i mod width, i div width).
    pub width: u32,
}

impl Camera {
    /// A camera at `position` that looks along `forward`, with `up` upward in the image.
    ///
    /// The frame is right-handed: image right is `forward x up`. `vertical_fov` in radians, in (0, pi).
    ///
    /// # Panics
    /// If `forward` and `up` are parallel or zero; scenes are checked before.
    pub fn new(
        position: glam::DVec3,
        forward: glam::DVec3,
        up: glam::DVec3,
        vertical_fov: f64,
        near: f64,
        size: [u32; 2],
    ) -> Self {
        let forward = forward.normalize();
        let right = forward.cross(up).normalize();
        let up = right.cross(forward);
        assert!(right.is_finite(), "viewing direction {forward} is parallel to the up vector");
        let half_height = (0.5 * vertical_fov).tan();
        let pixel = 2.0 * half_height / f64::from(size[1]);
        let half_width = 0.5 * pixel * f64::from(size[0]);
        Self {
            position: position.as_vec3().to_array(),
            forward: forward.as_vec3().to_array(),
            corner: (forward - half_width * right + half_height * up).as_vec3().to_array(),
            pixel_x: (pixel * right).as_vec3().to_array(),
            pixel_y: (-pixel * up).as_vec3().to_array(),
            near: near as f32,
            width: size[0],
        }
    }

    /// The same view of `from` pixels across and down with `to` pixels.
    pub fn at_size(&self, from: [u32; 2], to: [u32; 2]) -> Self {
        let step = |step: [f32; 3], axis: usize| step.map(|x| x * (from[axis] as f32 / to[axis] as f32));
        Self { pixel_x: step(self.pixel_x, 0), pixel_y: step(self.pixel_y, 1), width: to[0], ..*self }
    }
}

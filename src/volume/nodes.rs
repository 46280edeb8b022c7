//! Where nodes are: cubes of 32^3, 16^3 and 8^3 parts, one inside the other.

/// Edges of a voxel, of leaves, of the nodes above and of those below the root, in voxels: 2 to the power of these.
pub const LEAF: u32 = 3;
pub const LOWER: u32 = 7;
pub const UPPER: u32 = 12;

/// A cube of voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cube {
    /// Index coordinates of its first voxel: multiples of its edge.
    pub origin: [i32; 3],
    /// Its edge has 2 to this power voxels.
    pub log_edge: u32,
}

impl Cube {
    /// How many voxels it has.
    pub fn voxels(&self) -> u64 {
        1 << (3 * self.log_edge)
    }

    /// Its part of edge 2^`log_edge` with this number; z runs fastest.
    pub fn part(&self, index: usize, log_edge: u32) -> Self {
        let bits = self.log_edge - log_edge;
        let along = |axis: u32| ((index >> ((2 - axis) * bits)) & ((1 << bits) - 1)) << log_edge;
        let [x, y, z] = self.origin;
        Self { origin: [x + along(0) as i32, y + along(1) as i32, z + along(2) as i32], log_edge }
    }
}

impl core::fmt::Display for Cube {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.log_edge {
            0 => write!(f, "voxel {:?}", self.origin),
            log_edge => write!(f, "constant region of {}^3 voxels at {:?}", 1 << log_edge, self.origin),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_counted_along_z_first() {
        let node = Cube { origin: [-4096, 0, 4096], log_edge: UPPER };
        let part = |index| node.part(index, LOWER).origin;
        assert_eq!(part(0), node.origin);
        assert_eq!(part(1), [-4096, 0, 4096 + 128]);
        assert_eq!(part(32), [-4096, 128, 4096]);
        assert_eq!(part(32 * 32), [-4096 + 128, 0, 4096]);
        assert_eq!(part(32 * 32 * 32 - 1), [-128, 4096 - 128, 8192 - 128]);
    }
}

//! Which descendants of a binary node become the children of a node of eight, and which subtrees become leaves, so that
//! rays have the least to do (Ylitie, Karras and Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs, HPG 2017, Eq. 1 to 3).
//!
//! A ray that meets a box meets one inside it with the quotient of their surface areas A. So a node costs `A NODE` and
//! a leaf, whatever is in it, `A LEAF`; and the least cost of what lies below n, as a forest of up to j trees, is
//!
//! ```text
//! forest(n, 1) = min(A(n) LEAF if n has up to 8 triangles, A(n) NODE + parts(n, 8))
//! forest(n, j) = min(forest(n, j - 1), parts(n, j))
//! parts(n, j)  = min over 0 < k < j of forest(left, k) + forest(right, j - k)
//! ```

use obvhs::bvh2::node::Bvh2Node;

use crate::lanes::LANES;

/// Cost of eight boxes.
const NODE: f32 = 1.0;
/// Cost of eight triangles, as measured: with 1 rays take a tenth longer, and from 1.5 to 3 they hardly differ.
const LEAF: f32 = 2.0;

/// The choice for every node of a binary tree.
pub(super) struct Collapse<'a> {
    binary: &'a [Bvh2Node],
    /// `forest(n, 1..=7)`.
    forests: Vec<[f32; LANES - 1]>,
    /// Whether a tree at n is a leaf.
    leaves: Vec<bool>,
}

impl<'a> Collapse<'a> {
    /// Chooses, from the leaves up.
    pub fn new(binary: &'a [Bvh2Node]) -> Self {
        let count = binary.len();
        let mut collapse = Self { binary, forests: vec![[0.0; LANES - 1]; count], leaves: vec![false; count] };
        let mut triangles = vec![0; count];
        for n in parents_first(binary).into_iter().rev() {
            collapse.choose(n, &mut triangles);
        }
        collapse
    }

    fn choose(&mut self, n: u32, triangles: &mut [u32]) {
        let node = &self.binary[n as usize];
        let area = node.aabb().half_area();
        let here = n as usize;
        if node.is_leaf() {
            triangles[here] = node.prim_count;
            self.forests[here] = [area * LEAF * node.prim_count.div_ceil(LANES as u32) as f32; LANES - 1];
            self.leaves[here] = node.prim_count <= LANES as u32;
            return;
        }
        let left = node.first_index as usize;
        triangles[here] = triangles[left] + triangles[left + 1];
        let leaf = if triangles[here] <= LANES as u32 { area * LEAF } else { f32::INFINITY };
        let inner = area * NODE + self.parts(n, LANES).0;
        let mut forest = [leaf.min(inner); LANES - 1];
        for j in 2..LANES {
            forest[j - 1] = forest[j - 2].min(self.parts(n, j).0);
        }
        self.leaves[here] = leaf <= inner;
        self.forests[here] = forest;
    }

    /// `parts(n, j)` and the best k, j >= 2.
    #[inline(always)]
    fn parts(&self, n: u32, j: usize) -> (f32, usize) {
        let left = self.binary[n as usize].first_index as usize;
        let (left, right) = (&self.forests[left], &self.forests[left + 1]);
        let mut best = (f32::INFINITY, 1);
        for k in 1..j {
            let cost = left[k - 1] + right[j - k - 1];
            if cost < best.0 {
                best = (cost, k);
            }
        }
        best
    }

    /// Whether the tree at n is a leaf.
    pub fn is_leaf(&self, n: u32) -> bool {
        self.leaves[n as usize]
    }

    /// The two to eight children of the node at n.
    pub fn children(&self, n: u32) -> Vec<u32> {
        let mut children = Vec::with_capacity(LANES);
        self.divide(n, LANES, &mut children);
        children
    }

    fn divide(&self, n: u32, j: usize, children: &mut Vec<u32>) {
        let (_, k) = self.parts(n, j);
        let left = self.binary[n as usize].first_index;
        self.plant(left, k, children);
        self.plant(left + 1, j - k, children);
    }

    fn plant(&self, n: u32, j: usize, children: &mut Vec<u32>) {
        let forest = &self.forests[n as usize];
        let trees = (1..=j).find(|trees| forest[trees - 1] == forest[j - 1]).unwrap_or(1);
        if trees == 1 {
            children.push(n);
        } else {
            self.divide(n, trees, children);
        }
    }
}

/// All nodes, every one after its parent.
fn parents_first(binary: &[Bvh2Node]) -> Vec<u32> {
    let mut order = Vec::with_capacity(binary.len());
    order.push(0);
    let mut next = 0;
    while let Some(n) = order.get(next) {
        let node = &binary[*n as usize];
        if !node.is_leaf() {
            order.extend([node.first_index, node.first_index + 1]);
        }
        next += 1;
    }
    order
}

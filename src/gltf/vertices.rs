//! Attributes of vertices: which formats they may have, and which values.

use super::accessors::Accessors;
use super::element_format::{Component, Format, Shape};
use super::elements::Elements;
use super::fault::{At, Checked, label, require};
use super::schema::Primitive;

/// How far a colour may be outside [0, 1] and count as rounded.
pub const ROUNDING: f64 = 1e-3;

/// Accessors of the attributes that are read. Primitives for which they are the same have the same vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Attributes {
    pub positions: usize,
    /// Set 0 and set 1, if the material uses them and the primitive has them.
    pub texcoords: [Option<usize>; 2],
    pub colors: Option<usize>,
}

/// Reads attributes.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    pub accessors: Accessors<'a>,
    /// Whether positions and texture coordinates may be small integers (KHR_mesh_quantization).
    pub quantized: bool,
}

impl<'a> Reader<'a> {
    /// The positions of `attributes`, whose values are still unknown.
    pub fn position_elements(&self, attributes: &Attributes) -> Checked<Elements<'a>> {
        let quantized = self.quantized;
        let accepts = |format: Format| {
            let small = quantized && matches!(format.size(), 3 | 6);
            format.shape == Shape::Vec3 && (is_float(format) || small)
        };
        let expected = match quantized {
            true => "VEC3 of FLOAT, BYTE, UNSIGNED_BYTE, SHORT or UNSIGNED_SHORT",
            false => "VEC3 of FLOAT, or list KHR_mesh_quantization in extensionsUsed for small integers",
        };
        self.accessors.elements(attributes.positions, accepts, expected).at(|| "POSITION")
    }

    /// The positions, all of them finite.
    pub fn positions(&self, attributes: &Attributes) -> Checked<Vec<[f32; 3]>> {
        let elements = self.position_elements(attributes)?;
        let positions = values(&elements, attributes.positions).and_then(|positions| {
            finite(&positions).at(|| label("accessor", attributes.positions, None))?;
            Ok(positions)
        });
        positions.at(|| "POSITION")
    }

    /// Texture coordinates of `set`, `count` of them and all finite; none if the primitive has none.
    pub fn texcoords(&self, attributes: &Attributes, set: usize, count: usize) -> Checked<Option<Vec<[f32; 2]>>> {
        let Some(index) = attributes.texcoords[set] else {
            return Ok(None);
        };
        let quantized = self.quantized;
        let accepts = |format: Format| {
            let small = matches!(format.size(), 2 | 4) && (quantized || is_fraction(format));
            format.shape == Shape::Vec2 && (is_float(format) || small)
        };
        let expected = "VEC2 of FLOAT, or of normalized UNSIGNED_BYTE or UNSIGNED_SHORT";
        let read = || {
            let elements = self.accessors.elements(index, accepts, expected)?;
            same_count(&elements, count).at(|| label("accessor", index, None))?;
            let texcoords = values(&elements, index)?;
            finite(&texcoords).at(|| label("accessor", index, None))?;
            Ok(Some(texcoords))
        };
        read().at(|| format!("TEXCOORD_{set}"))
    }

    /// Colours, `count` of them and clamped to [0, 1]; none if the primitive has none. `warn` is called if some were
    /// outside by more than rounding.
    pub fn colors(&self, attributes: &Attributes, count: usize, warn: impl FnOnce()) -> Checked<Option<Vec<[f32; 3]>>> {
        let Some(index) = attributes.colors else {
            return Ok(None);
        };
        let accepts = |format: Format| {
            matches!(format.shape, Shape::Vec3 | Shape::Vec4) && (is_float(format) || is_fraction(format))
        };
        let expected = "VEC3 or VEC4 of FLOAT, or of normalized UNSIGNED_BYTE or UNSIGNED_SHORT";
        let read = || {
            let elements = self.accessors.elements(index, accepts, expected)?;
            same_count(&elements, count).at(|| label("accessor", index, None))?;
            let mut colors = values(&elements, index)?;
            finite(&colors).at(|| label("accessor", index, None))?;
            if !colors.iter().flatten().all(|channel| is_reflectance(f64::from(*channel))) {
                warn();
            }
            colors.iter_mut().flatten().for_each(|channel| *channel = channel.clamp(0.0, 1.0));
            Ok(Some(colors))
        };
        read().at(|| "COLOR_0")
    }

    /// The indices of `primitive`, whose values are still unknown; none if it has none.
    pub fn index_elements(&self, primitive: &Primitive) -> Checked<Option<Elements<'a>>> {
        let Some(index) = primitive.indices else {
            return Ok(None);
        };
        let accepts =
            |format: Format| format.shape == Shape::Scalar && format.component.is_index() && !format.normalized;
        let expected = "SCALAR of UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT";
        self.accessors.elements(index, accepts, expected).map(Some).at(|| "indices")
    }

    /// The indices, each of one of `count` vertices; all vertices in order if the primitive has none.
    pub fn indices(&self, primitive: &Primitive, count: usize) -> Checked<Vec<u32>> {
        let Some(elements) = self.index_elements(primitive)? else {
            return Ok((0..count as u32).collect());
        };
        let read = || {
            let indices = elements.indices()?;
            let largest = elements.largest_index();
            let Some(at) = indices.iter().position(|index| *index == largest || *index as usize >= count) else {
                return Ok(indices);
            };
            let found = indices[at];
            let restart = || format!("index {at} is {found}, which would restart the primitive");
            require(found != largest, restart, "split the primitive: glTF has no primitive restart")?;
            let finding = || format!("index {at} is {found}, but there are {count} vertices");
            require(false, finding, "refer only to vertices of the primitive")?;
            Ok(indices)
        };
        read().at(|| label("accessor", primitive.indices.unwrap_or_default(), None)).at(|| "indices")
    }
}

/// Whether no surface reflects more than arrives, up to rounding.
pub fn is_reflectance(value: f64) -> bool {
    (-ROUNDING..=1.0 + ROUNDING).contains(&value)
}

fn is_float(format: Format) -> bool {
    format.component == Component::F32 && !format.normalized
}

/// Whether components are fractions made of unsigned integers.
fn is_fraction(format: Format) -> bool {
    format.normalized && matches!(format.component, Component::U8 | Component::U16)
}

fn same_count(elements: &Elements<'_>, count: usize) -> Checked<()> {
    let finding = || format!("has {} elements, but POSITION has {count}", elements.count);
    require(elements.count == count, finding, "give every attribute of a primitive the same count")
}

fn values<const N: usize>(elements: &Elements<'_>, index: usize) -> Checked<Vec<[f32; N]>> {
    elements.vectors().at(|| label("accessor", index, None))
}

fn finite<const N: usize>(values: &[[f32; N]]) -> Checked<()> {
    let wrong = values.iter().position(|value| !value.iter().all(|x| x.is_finite()));
    let finding = |at: usize| format!("its element {at} is {:?}", values[at]);
    wrong.map_or(Ok(()), |at| require(false, || finding(at), "give finite numbers"))
}

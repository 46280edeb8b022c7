//! What is wrong with a mesh that is not closed: holes, faces that are there twice, or face the wrong way.

use std::collections::BTreeMap;

use fogbow_kernels::media::closed_mesh::{ClosedMesh, OpenEdge};

use super::Corners;

/// Edges that an error tells.
const MOST_EDGES: usize = 3;

/// A position by the bits of its coordinates, of which -0 has those of 0.
type Place = [u32; 3];

/// What was found, and what to do about it.
pub struct Diagnosis {
    /// Behind "bounds a volume, but ".
    pub finding: String,
    /// What would be right.
    pub remedy: &'static str,
}

/// What is wrong with `triangles`, of which these `edges`, all that there are, are passed more often one way than the
/// other. Coordinates are told from `origin` on.
pub fn diagnosis(triangles: &[Corners], edges: &[OpenEdge], origin: [f64; 3]) -> Diagnosis {
    let triangles: Vec<_> = triangles.iter().copied().filter(is_proper).collect();
    let triangles = triangles.as_slice();
    let tell = |at: [f32; 3]| format!("{:?}", [0, 1, 2].map(|axis| (f64::from(at[axis]) + origin[axis]) as f32));
    let face = |corners: &Corners| corners.map(tell).join(", ");
    if let Some((first, count)) = repeated(triangles) {
        let (are, more) = if count == 1 { ("is", "") } else { ("are", "the first ") };
        return Diagnosis {
            finding: format!("{count} of its triangles {are} there more than once: {more}{}", face(&first)),
            remedy: "delete faces that lie on each other in the modelling program",
        };
    }
    if let Some((first, count)) = turned(triangles, edges) {
        let face_away = if count == 1 { "faces" } else { "face" };
        let more = if count == 1 { "" } else { "the first " };
        return Diagnosis {
            finding: format!(
                "{count} of its triangles {face_away} the other way than the rest: {more}{}",
                face(&first)
            ),
            remedy: "let all normals point outward: have the modelling program recalculate them, or flip these faces",
        };
    }
    let ends = |edge: &OpenEdge| format!("from {} to {}", tell(edge.ends[0]), tell(edge.ends[1]));
    let told = |kind: &str, which: &dyn Fn(u32) -> bool| {
        let all: Vec<_> = edges.iter().filter(|edge| which(edge.there + edge.back)).collect();
        let first: Vec<_> = all.iter().take(MOST_EDGES).map(|edge| ends(edge)).collect();
        let more = if all.len() > MOST_EDGES { "; .." } else { "" };
        (!all.is_empty()).then(|| format!("{} of its edges {kind}: {}{more}", all.len(), first.join("; ")))
    };
    let kinds = [
        told("are open", &|count| count == 1),
        told("are between triangles that face different ways", &|count| count == 2),
        told("have more than two triangles", &|count| count > 2),
    ];
    Diagnosis {
        finding: format!("is not closed: {}", kinds.into_iter().flatten().collect::<Vec<_>>().join("; and ")),
        remedy: "close its holes in the modelling program: merge vertices by distance, fill what is left, and let all \
                 normals point outward",
    }
}

/// Whether its corners differ.
fn is_proper([a, b, c]: &Corners) -> bool {
    a != b && b != c && c != a
}

/// The bits of a position.
pub fn place(at: [f32; 3]) -> Place {
    at.map(|x| (x + 0.0).to_bits())
}

/// The places of a triangle's corners, beginning with the least.
fn turn(corners: &Corners) -> [Place; 3] {
    let [a, b, c] = corners.map(place);
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three turns")
}

/// The first of the triangles that are there more than once, and how many these are, if the mesh is closed without their
/// copies.
fn repeated(triangles: &[Corners]) -> Option<(Corners, usize)> {
    let mut counts = BTreeMap::new();
    let mut once = Vec::new();
    for corners in triangles {
        let count = counts.entry(turn(corners)).or_insert(0);
        *count += 1;
        if *count == 1 {
            once.push(*corners);
        }
    }
    let is_repeated = |corners: &&Corners| counts[&turn(corners)] > 1;
    let first = once.iter().find(is_repeated)?;
    ClosedMesh::check(&once).is_ok().then(|| (*first, once.iter().filter(is_repeated).count()))
}

/// The first of the triangles that face another way than most of those that they hang together with, and how many these
/// are, if that is all that is wrong.
fn turned(triangles: &[Corners], edges: &[OpenEdge]) -> Option<(Corners, usize)> {
    if edges.iter().any(|edge| edge.there + edge.back != 2) {
        return None;
    }
    let is_turned = against_the_rest(triangles)?;
    let mut all = triangles.iter().zip(&is_turned).filter(|(_, is_turned)| **is_turned).map(|(corners, _)| corners);
    let count = all.clone().count();
    all.next().map(|first| (*first, count))
}

/// Which triangles face another way than most of those that they hang together with; none if they cannot all face one.
fn against_the_rest(triangles: &[Corners]) -> Option<Vec<bool>> {
    let sides = sides(triangles);
    let mut facing: Vec<Option<bool>> = vec![None; triangles.len()];
    for seed in 0..triangles.len() {
        if facing[seed].is_some() {
            continue;
        }
        facing[seed] = Some(false);
        let (mut part, mut next) = (vec![seed], 0);
        while let Some(&one) = part.get(next) {
            next += 1;
            for edge in edges_of(&triangles[one]) {
                let (key, there) = ordered(edge);
                let [(a, _), (b, _)] = sides[&key][..] else { continue };
                let other = if a == one { b } else { a };
                let other_there = sides[&key].iter().find(|(index, _)| *index == other)?.1;
                let expected = facing[one].map(|facing| facing != (there == other_there));
                if facing[other].is_none() {
                    part.push(other);
                    facing[other] = expected;
                } else if facing[other] != expected {
                    return None;
                }
            }
        }
        // The fewer are those that are wrong.
        let wrong = part.iter().filter(|index| facing[**index] == Some(true)).count();
        if 2 * wrong > part.len() {
            part.iter().for_each(|index| facing[*index] = facing[*index].map(|facing| !facing));
        }
    }
    Some(facing.into_iter().map(|facing| facing == Some(true)).collect())
}

/// The ends of an edge, and whether it is passed from the first to the second.
type Side = ([Place; 2], bool);

/// Which triangles have each edge, and whether they pass it from its first end to its second.
fn sides(triangles: &[Corners]) -> BTreeMap<[Place; 2], Vec<(usize, bool)>> {
    let mut sides: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for (index, corners) in triangles.iter().enumerate() {
        for edge in edges_of(corners) {
            let (key, there) = ordered(edge);
            sides.entry(key).or_default().push((index, there));
        }
    }
    sides
}

fn edges_of(corners: &Corners) -> [[Place; 2]; 3] {
    let [a, b, c] = corners.map(place);
    [[a, b], [b, c], [c, a]]
}

fn ordered([from, to]: [Place; 2]) -> Side {
    ([from.min(to), from.max(to)], from < to)
}

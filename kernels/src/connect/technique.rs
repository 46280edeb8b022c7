//! One row per connection technique: what the rest of the program must know of it.

use super::bridge::Bridge;
use super::light_sample::Scope;
use super::lis::{self, Lis};
use super::mvnee::Mvnee;
use super::{Techniques, distant, nee, omnee};
use crate::PathLengths;
use crate::tables::lights::Lights;

/// The connection techniques.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// Next event estimation.
    Nee,
    /// Multiple-vertex next event estimation.
    Mvnee,
    /// Once-more next event estimation.
    Omnee,
    /// Bridges.
    Bridge,
    /// Light importance sampling and its companion.
    Lis,
}

/// At which vertices a technique's ratios ask for the phase function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Densities {
    /// At none, or through the technique's own eyes.
    None,
    /// At the one next to the light.
    Last,
    /// At all of them.
    All,
}

/// What others must know of a technique.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Most vertices that it inserts; `u32::MAX` for no limit but that of the path.
    pub most_inserted: u32,
    /// Whether its ratios look at the vertices before a start.
    pub looks_back: bool,
    /// Most edges from a start that it can use to the light, wherever the start is.
    pub most_edges: usize,
    /// Most edges from a start within the distance [`Self::near`]; 0 if that limits nothing.
    pub most_edges_near: usize,
    /// Where its ratios ask for phase functions.
    pub densities: Densities,
    /// Distance from a light within which it uses starts `[m]`; infinite for no limit.
    pub near: f32,
}

impl Technique {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Nee, Self::Mvnee, Self::Omnee, Self::Bridge, Self::Lis];

    /// The technique's name in scenes, flags and statistics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nee => "nee",
            Self::Mvnee => "mvnee",
            Self::Omnee => "omnee",
            Self::Bridge => "bridge",
            Self::Lis => "lis",
        }
    }

    /// Its row in `techniques`, if it is among them.
    pub fn row(self, techniques: &Techniques) -> Option<Row> {
        match self {
            Self::Nee => techniques.nee.then_some(nee::ROW),
            Self::Mvnee => techniques.mvnee.as_ref().map(Mvnee::row),
            Self::Omnee => techniques.omnee.then_some(omnee::ROW),
            Self::Bridge => techniques.bridge.as_ref().map(Bridge::row),
            Self::Lis => techniques.lis.as_ref().map(Lis::row),
        }
    }

    /// The connections that it tries from every vertex, in paths of `lengths`, if it is among `techniques`.
    fn connection(self, techniques: &Techniques, lengths: PathLengths) -> Option<Connection<'_>> {
        let (scope, chain) = match self {
            Self::Nee => techniques.nee.then_some((nee::SCOPE, Chain::Straight)),
            Self::Mvnee => techniques.mvnee.as_ref().map(|mvnee| (mvnee.scope(), Chain::Mvnee(mvnee))),
            Self::Omnee => techniques.omnee.then(|| (omnee::scope(lengths), Chain::OnceMore)),
            Self::Bridge => techniques.bridge.as_ref().map(|bridge| (bridge.scope(), Chain::Bridge(bridge))),
            Self::Lis => techniques.lis.as_ref().map(|lis| (lis::scope(lengths), Chain::FromLight(lis))),
        }?;
        Some(Connection { technique: self, scope, chain })
    }
}

/// What joins a vertex with a light point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chain<'a> {
    /// Nothing.
    Straight,
    /// One vertex.
    OnceMore,
    /// Seeds on the axis, perturbed.
    Mvnee(&'a Mvnee),
    /// A bridge.
    Bridge(&'a Bridge),
    /// A vertex made from the light, and what joins it.
    FromLight(&'a Lis),
}

/// The connections that a technique tries from every vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection<'a> {
    /// Whose they are.
    pub technique: Technique,
    /// Which pairs of start and light point they connect.
    pub scope: Scope,
    /// How.
    pub chain: Chain<'a>,
}

impl Techniques {
    /// The rows of the active techniques.
    pub fn rows(&self) -> impl Iterator<Item = (Technique, Row)> + '_ {
        Technique::ALL.into_iter().filter_map(|technique| Some((technique, technique.row(self)?)))
    }

    /// All connections of a vertex with `lights`, one technique after the other, in paths of `lengths`. Where any
    /// technique connects, lights at infinity are connected with in a straight line.
    pub fn connections(&self, lengths: PathLengths, lights: &Lights) -> impl Iterator<Item = Connection<'_>> {
        let straight = |technique, scope| Connection { technique, scope, chain: Chain::Straight };
        let companion = self.companion().map(|scope| straight(Technique::Lis, scope));
        let joined = Technique::ALL.into_iter().filter_map(move |technique| technique.connection(self, lengths));
        let near = joined.chain(companion).filter(|_| !lights.lights().is_empty());
        let reaches_far = self.any() && lights.has_distant();
        near.chain(reaches_far.then(|| straight(Technique::Nee, distant::SCOPE)))
    }

    /// Whether next event estimation is all that connects.
    pub fn are_nee_alone(&self) -> bool {
        *self == Self { nee: true, ..Self::default() }
    }

    /// Whether any weight looks at the vertices before a start.
    pub fn look_back(&self) -> bool {
        self.rows().any(|(_, row)| row.looks_back)
    }

    /// Most vertices that any of them inserts into a path of at most `longest` segments.
    pub fn most_inserted(&self, longest: u32) -> usize {
        let most = self.rows().map(|(_, row)| row.most_inserted).max().unwrap_or(0);
        most.min(longest.saturating_sub(2)) as usize
    }

    /// Most edges from a start that any of them can use to the light, but for those near one.
    pub fn most_edges(&self) -> usize {
        self.rows().map(|(_, row)| row.most_edges).max().unwrap_or(1)
    }

    /// Most edges from a start near a light that those limited in distance can use.
    pub fn most_edges_near(&self) -> usize {
        self.rows().map(|(_, row)| row.most_edges_near).max().unwrap_or(0)
    }

    /// Whether weights look no farther back than to the first vertex near a light.
    pub fn look_back_near(&self) -> bool {
        self.near().is_finite() && self.most_edges() == 1
    }

    /// Where they ask for phase functions.
    pub fn densities(&self) -> Densities {
        self.rows().map(|(_, row)| row.densities).max().unwrap_or(Densities::None)
    }

    /// Distance from a light within which starts are remembered as near `[m]`; infinite if nothing asks for that.
    pub fn near(&self) -> f32 {
        self.rows().map(|(_, row)| row.near).fold(f32::INFINITY, f32::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_say_what_buffers_are_needed() {
        let none = Techniques::default();
        assert_eq!((none.look_back(), none.most_inserted(20), none.near()), (false, 0, f32::INFINITY));
        let straight = Techniques { nee: true, ..Techniques::default() };
        assert_eq!((straight.look_back(), straight.most_inserted(20), straight.most_edges()), (false, 0, 1));
        let once = Techniques { nee: true, omnee: true, ..Techniques::default() };
        assert_eq!((once.look_back(), once.most_inserted(20), once.most_edges()), (true, 1, 2));
        assert_eq!(once.most_inserted(2), 0);
        assert_eq!(once.rows().map(|(technique, _)| technique.name()).collect::<Vec<_>>(), ["nee", "omnee"]);
    }
}

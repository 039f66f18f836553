//! What the sweeps ask of the nodes around a particle, whatever gives them their weights.
//!
//! A [`Footprint`] finds the weights of a particle: from its place alone (hats, splines,
//! [`Tensor`]) or also from the records of its domain ([`Records`]). A [`Support`] carries
//! quantities between that particle and its nodes. Sweeps are generic over the footprint.

use super::scatter::Parcel;
use super::shared::Shared;
use super::stencil::{Frame, Stencil};
use crate::math::v4::Wide;
use crate::model::grid::Node;
use crate::model::particles::DOMAIN_RECORDS;
use crate::shape::Shape;
use std::marker::PhantomData;
use std::ops::Range;

/// Records of the domains of some particles: a slice for each record, empty where the footprint
/// has none.
pub type Records<'a> = [&'a [[f64; 4]]; DOMAIN_RECORDS];

/// How the weights of particles are found in `D` dimensions.
pub trait Footprint<const D: usize>: Sync {
    /// Records of a domain that the weights depend on.
    const RECORDS: usize;

    /// Affine fields are fitted with moments of the weights in place of gradients.
    const MOMENTS: bool = false;

    /// The domains have corners that the grid carries along, each for itself.
    const FREE: bool = false;

    /// Memory for weights of particles that are found together. It must not outlive a change of
    /// places or records.
    type Memory: Default;

    /// The nodes of one particle with their weights.
    type Support<'a>: Support<D>;

    /// The support of particle `p` of some particles, which lie at `places`. Only if `SLOPES` it has
    /// gradients, only if `CORNERS` it can say how free corners move.
    fn at<'a, V: Wide, const SLOPES: bool, const CORNERS: bool>(
        memory: &'a mut Self::Memory,
        frame: &Frame,
        places: &[[f64; 4]],
        records: &Records<'_>,
        p: usize,
    ) -> Self::Support<'a>;

    /// The same nodes with weights in place of gradients that fit affine fields.
    fn affine<V: Wide>(support: Self::Support<'_>) -> Self::Support<'_> {
        support
    }

    /// The records of a range of particles.
    #[inline(always)]
    fn part<'a>(records: &'a [Vec<[f64; 4]>; DOMAIN_RECORDS], range: Range<usize>) -> Records<'a> {
        let mut part: Records<'a> = [&[]; DOMAIN_RECORDS];
        for (part, record) in part.iter_mut().zip(records).take(Self::RECORDS) {
            *part = &record[range.clone()];
        }
        part
    }
}

/// What a particle sees on the grid.
pub struct Gathered<V, const D: usize> {
    /// w = sum N v*.
    pub w: V,
    /// sum N (v* - v).
    pub a: V,
    /// Columns of sum v* (x) grad N, per node spacing.
    pub matrix: [V; D],
}

/// The nodes of one particle in `D` dimensions: sums over them, and what they are given.
///
/// Whatever writes to nodes must be called by one tile of a colour: tiles of one colour share no
/// node (see `tiles`).
pub trait Support<const D: usize>: Copy {
    /// sum N v*, sum N (v* - v) and, if asked to, sum v* (x) grad N with the gradients of `steep`.
    fn gather<V: Wide, const AFFINE: bool>(&self, steep: &Self, nodes: &[Node]) -> Gathered<V, D>;

    /// The velocity of each free corner, sum N(x_c) v*.
    fn carry<V: Wide>(&self, _nodes: &[Node], _velocities: &mut [[f64; 4]]) {}

    /// mapped += N m (v + C (x_I - x)); `spread` is m C h, column by column.
    fn scatter_momentum<V: Wide, const AFFINE: bool>(
        &self,
        momentum: V,
        spread: &[V; D],
        mapped: Shared<'_, [f64; 4]>,
    );

    /// motion += N (m v, m), force -= V sigma grad N (line 5 of language.md 7.1); where x is a
    /// radius (`ROUND`) also f_r -= V sigma_tt N/r. The gradients are those of `steep`.
    fn scatter<
        V: Wide,
        const ROUND: bool,
        const MOTION: bool,
        const FORCE: bool,
        const AFFINE: bool,
    >(
        &self,
        parcel: Parcel<V, D>,
        nodes: Shared<'_, Node>,
    );

    /// sum v (x) grad N, column j the derivative along axis j in velocity per node spacing, and, in
    /// two dimensions, sum v N.
    fn gradient_and_value<V: Wide>(&self, mapped: &[[f64; 4]]) -> ([V; D], V);

    /// sum N q.
    fn sum<V: Wide>(&self, nodes: &[[f64; 4]]) -> V;

    /// q_I += N amount.
    fn add<V: Wide>(&self, amount: V, nodes: Shared<'_, [f64; 4]>);

    /// sum N q.
    fn sum_of_numbers(&self, nodes: &[f64]) -> f64;

    /// q_I += N amount.
    fn add_number(&self, amount: f64, nodes: Shared<'_, f64>);

    /// q_I += flux . grad N, in flux per node spacing.
    fn add_divergence(&self, flux: [f64; 4], nodes: Shared<'_, f64>);

    /// Every node (its place in memory) with its weight; a node may come more than once.
    fn each(&self, visit: impl FnMut(usize, f64));

    /// The same with the gradient of the weight per node spacing, and the way from the node to the
    /// particle in node spacings.
    fn each_slope(&self, visit: impl FnMut(usize, f64, [f64; 3], [f64; 3]));
}

/// Hats averaged over the box of a particle; the record holds its half sizes.
pub struct Boxed;

impl<const D: usize> Footprint<D> for Boxed {
    const RECORDS: usize = 1;

    type Memory = ();

    type Support<'a> = Stencil<D, 3>;

    #[inline(always)]
    fn at<'a, V: Wide, const SLOPES: bool, const CORNERS: bool>(
        (): &'a mut (),
        frame: &Frame,
        places: &[[f64; 4]],
        records: &Records<'_>,
        p: usize,
    ) -> Self::Support<'a> {
        frame.boxed::<V, D>(V::load(&places[p]), V::load(&records[0][p]))
    }
}

/// Weights that are products over the axes, from the place alone.
pub struct Tensor<const W: usize, S>(PhantomData<S>);

impl<const D: usize, const W: usize, S: Shape<W> + Sync> Footprint<D> for Tensor<W, S> {
    const RECORDS: usize = 0;

    const MOMENTS: bool = S::MOMENTS;

    type Memory = ();

    type Support<'a> = Stencil<D, W>;

    #[inline(always)]
    fn at<'a, V: Wide, const SLOPES: bool, const CORNERS: bool>(
        (): &'a mut (),
        frame: &Frame,
        places: &[[f64; 4]],
        _: &Records<'_>,
        p: usize,
    ) -> Self::Support<'a> {
        frame.stencil::<V, D, W, S>(V::load(&places[p]))
    }

    #[inline(always)]
    fn affine<V: Wide>(support: Self::Support<'_>) -> Self::Support<'_> {
        support.affine::<V, S>()
    }
}

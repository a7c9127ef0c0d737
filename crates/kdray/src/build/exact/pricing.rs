//! Price planes eight at a time, and keep the cheapest.

use super::lanes::Lanes;
use super::sweep::Candidate;
use crate::build::NodeCost;
use crate::geometry::Aabb;

/// The cheapest plane along an axis so far, one in each lane.
pub(super) struct Pricing<L: Lanes> {
    pub(super) lanes: L,
    axis: usize,
    lower: L::Numbers,
    upper: L::Numbers,
    step: L::Numbers,
    face: L::Numbers,
    girth: L::Numbers,
    empty_factor: L::Numbers,
    best_price: L::Numbers,
    best_position: L::Numbers,
}

impl<L: Lanes> Pricing<L> {
    #[inline(always)]
    pub(super) fn new(lanes: L, bounds: &Aabb, cost: &NodeCost, axis: usize) -> Self {
        Self {
            lanes,
            axis,
            lower: lanes.numbers(bounds.lower[axis]),
            upper: lanes.numbers(bounds.upper[axis]),
            step: lanes.numbers(cost.step),
            face: lanes.numbers(cost.face[axis]),
            girth: lanes.numbers(cost.girth[axis]),
            empty_factor: lanes.numbers(cost.empty_factor),
            best_price: lanes.numbers(f32::INFINITY),
            best_position: lanes.numbers(f32::INFINITY),
        }
    }

    /// Prices planes, which come in ascending order, with `left` and `right` references on their sides: [`NodeCost::split`], lane
    /// by lane. Those that do not lie strictly inside the node have no price.
    #[inline(always)]
    pub(super) fn price(&mut self, positions: L::Numbers, left: L::Counts, right: L::Counts) {
        let (lanes, price) = (self.lanes, self.prices(positions, left, right));
        self.keep(lanes.is_less(price, self.best_price), price, positions);
    }

    /// The same for planes that do not come in ascending order.
    #[inline(always)]
    pub(super) fn price_unordered(
        &mut self,
        positions: L::Numbers,
        left: L::Counts,
        right: L::Counts,
    ) {
        let (lanes, price) = (self.lanes, self.prices(positions, left, right));
        let is_equal = lanes.is_equal(price, self.best_price);
        let is_lower = lanes.and(is_equal, lanes.is_less(positions, self.best_position));
        let is_better = lanes.or(lanes.is_less(price, self.best_price), is_lower);
        self.keep(is_better, price, positions);
    }

    #[inline(always)]
    fn keep(&mut self, is_better: L::Truths, price: L::Numbers, positions: L::Numbers) {
        self.best_price = self.lanes.select(is_better, price, self.best_price);
        self.best_position = self.lanes.select(is_better, positions, self.best_position);
    }

    #[inline(always)]
    fn prices(&self, positions: L::Numbers, left: L::Counts, right: L::Counts) -> L::Numbers {
        let lanes = self.lanes;
        let below = lanes.subtract(positions, self.lower);
        let above = lanes.subtract(self.upper, positions);
        let volumes = lanes.add(
            lanes.multiply(lanes.to_numbers(left), below),
            lanes.multiply(lanes.to_numbers(right), above),
        );
        let both = lanes.to_numbers(lanes.sum(left, right));
        let tests = lanes.add(lanes.multiply(self.face, both), lanes.multiply(self.girth, volumes));
        let full = lanes.add(self.step, tests);
        let is_empty = lanes.or(lanes.is_zero(left), lanes.is_zero(right));
        let price = lanes.select(is_empty, lanes.multiply(full, self.empty_factor), full);
        let is_inside = lanes.is_less(lanes.numbers(0.0), lanes.min(below, above));
        lanes.select(is_inside, price, lanes.numbers(f32::INFINITY))
    }

    /// The cheapest of all lanes; of equals the one with the lowest position.
    #[inline(always)]
    pub(super) fn best(&self) -> Option<Candidate> {
        let lanes = self.lanes;
        let price = lanes.least(self.best_price);
        if price == f32::INFINITY {
            return None;
        }
        let is_best = lanes.is_equal(self.best_price, lanes.numbers(price));
        let none = lanes.numbers(f32::INFINITY);
        let position = lanes.least(lanes.select(is_best, self.best_position, none));
        Some(Candidate { price, axis: self.axis, position })
    }
}

//! The columns of cells that a triangle passes through, and where.

use std::ops::RangeInclusive;

use super::MARGIN;

/// A convex polygon with a few corners, in units of cells.
struct Polygon {
    /// Three, and one more for each of four cuts; a few more if roundings bend a thin one.
    corners: [[f64; 3]; 16],
    len: usize,
}

/// Calls `visit` with every column in which a triangle has a part, and from where to where along
/// the column that reaches. Cells are taken as larger than they are, by [`MARGIN`] on all sides
/// across.
pub(super) fn columns(
    triangle: &[[f64; 3]; 3],
    counts: [usize; 3],
    mut visit: impl FnMut([usize; 2], [f64; 2]),
) {
    let rows = cells(range(triangle, 0), counts[0]);
    let row = cells(range(triangle, 1), counts[1]);
    if rows.start() == rows.end() && row.start() == row.end() {
        return visit([*rows.start(), *row.start()], range(triangle, 2));
    }
    let [mut strip, mut half, mut part, mut spare] = [const { Polygon::EMPTY }; 4];
    for x in rows.clone() {
        let strip = within(triangle, 0, x, &rows, [&mut strip, &mut half]);
        let here = cells(range(strip, 1), counts[1]);
        for y in here.clone() {
            let part = within(strip, 1, y, &here, [&mut part, &mut spare]);
            if !part.is_empty() {
                visit([x, y], range(part, 2));
            }
        }
    }
}

/// The cells that something reaches into that goes from here to there; none if it goes nowhere.
#[inline]
pub(super) fn cells([from, to]: [f64; 2], count: usize) -> RangeInclusive<usize> {
    // Conversions round toward zero, and make zero of what is less.
    let last = ((to + MARGIN) as usize).min(count - 1);
    let first = (from - MARGIN) as usize;
    if to + MARGIN >= 0.0 && first <= last { first..=last } else { RangeInclusive::new(1, 0) }
}

/// From where to where corners reach.
#[inline]
fn range(corners: &[[f64; 3]], axis: usize) -> [f64; 2] {
    corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], corner| {
        [from.min(corner[axis]), to.max(corner[axis])]
    })
}

/// What of a polygon is in one of the cells that it reaches into. There is room for it and for what
/// is on the way there.
fn within<'a>(
    whole: &'a [[f64; 3]],
    axis: usize,
    cell: usize,
    all: &RangeInclusive<usize>,
    [room, spare]: [&'a mut Polygon; 2],
) -> &'a [[f64; 3]] {
    let (lower, upper) = (cell as f64 - MARGIN, (cell + 1) as f64 + MARGIN);
    match (cell > *all.start(), cell < *all.end()) {
        (false, false) => whole,
        (true, false) => room.cut(whole, axis, lower, 1.0),
        (false, true) => room.cut(whole, axis, upper, -1.0),
        (true, true) => room.cut(spare.cut(whole, axis, lower, 1.0), axis, upper, -1.0),
    }
}

impl Polygon {
    const EMPTY: Self = Self { corners: [[0.0; 3]; 16], len: 0 };

    /// Becomes what of `whole` is above a plane, or, with `sense` -1, below it.
    fn cut(&mut self, whole: &[[f64; 3]], axis: usize, plane: f64, sense: f64) -> &[[f64; 3]] {
        self.len = 0;
        let height = |corner: &[f64; 3]| sense * (corner[axis] - plane);
        let Some(mut from) = whole.last() else { return &[] };
        let mut a = height(from);
        for to in whole {
            let b = height(to);
            if (a < 0.0) != (b < 0.0) {
                let s = a / (a - b);
                self.push([0, 1, 2].map(|axis| from[axis] + s * (to[axis] - from[axis])));
            }
            if b >= 0.0 {
                self.push(*to);
            }
            (from, a) = (to, b);
        }
        &self.corners[..self.len]
    }

    fn push(&mut self, corner: [f64; 3]) {
        self.corners[self.len] = corner;
        self.len += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::noise::noise;

    /// Every point of a triangle is in one of its columns, at a height that was told.
    #[test]
    fn no_point_is_left_out_and_few_columns_are_too_many() {
        let mut state = 5;
        let mut random = |size: f32| f64::from(size * noise(&mut state) - 1.0);
        let (mut visited, mut needed) = (0, 0);
        for _ in 0..300 {
            let size = random(9.0) as f32 + 2.0;
            let triangle = [(); 3].map(|()| [(); 3].map(|()| random(size)));
            let mut told = std::collections::HashMap::new();
            columns(&triangle, [7, 6, 1], |column, range| {
                assert!(told.insert(column, range).is_none())
            });
            let mut hit = std::collections::HashSet::new();
            for _ in 0..500 {
                let (a, b) = (0.5 + 0.5 * random(2.0), 0.5 + 0.5 * random(2.0));
                let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
                let [p, q, r] = triangle;
                let point = [0, 1, 2]
                    .map(|axis| p[axis] + a * (q[axis] - p[axis]) + b * (r[axis] - p[axis]));
                let is_there = (0.0..7.0).contains(&point[0]) && (0.0..6.0).contains(&point[1]);
                if is_there {
                    let column = [point[0] as usize, point[1] as usize];
                    let [from, to] = told[&column];
                    assert!(
                        from - 1e-9 <= point[2] && point[2] <= to + 1e-9,
                        "{triangle:?} {point:?}"
                    );
                    hit.insert(column);
                }
            }
            (visited, needed) = (visited + told.len(), needed + hit.len());
        }
        assert!(needed > 1000 && visited < 3 * needed / 2, "{visited} columns for {needed}");
    }

    #[test]
    fn a_point_is_in_its_cell() {
        let mut seen = Vec::new();
        columns(&[[2.5, 0.5, 7.0]; 3], [4, 4, 1], |column, range| seen.push((column, range)));
        assert_eq!(seen, [([2, 0], [7.0, 7.0])]);
        columns(&[[2.5, 4.5, 7.0]; 3], [4, 4, 1], |column, _| panic!("{column:?} is not there"));
    }
}

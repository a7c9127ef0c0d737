//! What colour things have.

use glam::Vec3;
use kdray::Mesh;

use crate::components::Components;

/// A colour for each triangle, and one for the ground.
pub(crate) struct Palette {
    /// For each triangle an index into `colours`; empty if all have the first.
    pub(crate) of_triangle: Vec<u32>,
    pub(crate) colours: Vec<Vec3>,
    ground: Vec3,
}

/// sRGB colours of the large parts, the largest first.
const PARTS: [u32; 8] =
    [0x2f8f8b, 0xe07a5f, 0xf2cc8f, 0x3d6fa5, 0xd9d4c7, 0x81b29a, 0xb5495b, 0x8a79b5];

/// sRGB colours between which the many small parts vary.
const SMALL_PARTS: [u32; 2] = [0x7f9a4e, 0xc9c07a];

/// sRGB colours between which all parts vary where there are many large ones: a building.
const STONES: [u32; 2] = [0xcdb79a, 0xe3dccf];

/// sRGB colour of floors and of the ground.
const FLOOR: u32 = 0xd8cbb6;

/// A part is small if its area is less than this fraction of the largest one's, floors aside.
const SMALL: f32 = 0.02;

impl Palette {
    /// One colour for everything.
    pub(crate) fn uniform(colour: Vec3) -> Self {
        Self { of_triangle: Vec::new(), colours: vec![colour], ground: colour }
    }

    /// A colour for each connected part.
    pub(crate) fn new(mesh: &Mesh, components: Components, up: Vec3) -> Self {
        let floors = floors(mesh, &components, up);
        let parts = || components.areas.iter().zip(&floors);
        let largest = parts().find(|(_, floor)| !**floor).map_or(0.0, |(area, _)| *area);
        let is_large = |(area, floor): (&f32, &bool)| !floor && *area >= SMALL * largest;
        let is_building = parts().filter(|part| is_large(*part)).count() > PARTS.len();
        let mut unused = PARTS.into_iter();
        let colours = parts().enumerate().map(|(index, part)| {
            let between = |[a, b]: [u32; 2]| linear(a).lerp(linear(b), scattered(index));
            match part {
                _ if is_building => between(STONES),
                (_, true) => linear(FLOOR),
                _ if is_large(part) => unused.next().map_or_else(|| linear(FLOOR), linear),
                _ => between(SMALL_PARTS),
            }
        });
        let colours = colours.collect();
        Self { of_triangle: components.of_triangle, colours, ground: linear(FLOOR) }
    }

    pub(crate) fn of(&self, triangle: usize) -> Vec3 {
        let part = self.of_triangle.get(triangle).copied().unwrap_or(0);
        self.colours[part as usize]
    }

    pub(crate) fn ground(&self) -> Vec3 {
        self.ground
    }
}

/// Which parts are flat and at the foot of the mesh.
fn floors(mesh: &Mesh, components: &Components, up: Vec3) -> Vec<bool> {
    let height = |point: [f32; 3]| Vec3::from(point).dot(up);
    let mut spans = vec![[f32::INFINITY, f32::NEG_INFINITY]; components.areas.len()];
    let mut scene = [f32::INFINITY, f32::NEG_INFINITY];
    let widen = |[low, high]: [f32; 2], y: f32| [low.min(y), high.max(y)];
    for (triangle, part) in components.of_triangle.iter().enumerate() {
        for y in mesh.triangle(triangle).map(height) {
            spans[*part as usize] = widen(spans[*part as usize], y);
            scene = widen(scene, y);
        }
    }
    let foot = scene[0] + 0.03 * (scene[1] - scene[0]);
    let all_is_flat = scene[1] <= scene[0];
    spans.iter().map(|[_, high]| *high <= foot && !all_is_flat).collect()
}

/// Numbers in 0..1 that are spread evenly: multiples of the golden ratio.
fn scattered(index: usize) -> f32 {
    (index as u32).wrapping_mul(2_654_435_769) as f32 / 4_294_967_296.0
}

/// The linear colour of an sRGB one.
fn linear(srgb: u32) -> Vec3 {
    let channel = |shift: u32| {
        let encoded = (srgb >> shift & 255) as f32 / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(channel(16), channel(8), channel(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weld::weld;

    /// Separate right-angled triangles, each with its own size, standing or lying at its height.
    fn palette(parts: &[(f32, f32, bool)]) -> Palette {
        let corners = parts.iter().enumerate().flat_map(|(index, (size, height, stands))| {
            let at = [100.0 * index as f32, *height, 0.0];
            let last = if *stands { [at[0], height + size, 0.0] } else { [at[0], *height, *size] };
            [at, [at[0] + size, *height, 0.0], last]
        });
        let positions: Vec<[f32; 3]> = corners.collect();
        let triangles: Vec<[u32; 3]> =
            (0..parts.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = Mesh::new(&positions, &triangles).expect("finite");
        Palette::new(&mesh, Components::new(&mesh, &weld(&mesh)), Vec3::Y)
    }

    #[test]
    fn floors_things_and_small_parts_differ() {
        let floor = (50.0, 0.0, false);
        let palette = palette(&[(9.0, 0.0, true), floor, (8.0, 0.0, true), (0.1, 3.0, true)]);
        assert_eq!(palette.of(0), linear(PARTS[0]));
        assert_eq!(palette.of(1), palette.ground());
        assert_eq!(palette.of(2), linear(PARTS[1]));
        let [from, to] = SMALL_PARTS.map(linear);
        assert!(palette.of(3).cmpge(from.min(to)).all() && palette.of(3).cmple(from.max(to)).all());
    }

    #[test]
    fn buildings_are_of_stone() {
        let palette = palette(&[(9.0, 0.0, true); 20]);
        let [from, to] = STONES.map(linear);
        for triangle in 0..20 {
            let colour = palette.of(triangle);
            assert!(colour.cmpge(from.min(to)).all() && colour.cmple(from.max(to)).all());
        }
    }

    #[test]
    fn srgb_is_decoded() {
        assert_eq!(linear(0xff_00_ff), Vec3::new(1.0, 0.0, 1.0));
        assert!((linear(0x80_80_80).x - 0.2159).abs() < 1e-3);
    }
}

use super::*;
use crate::geometry::Mesh;
use crate::trace::noise::noise;
use crate::{BuildOptions, Tracer, Tree};

/// Triangles anywhere, balls that are closed and that are open in places, and a sheet.
fn meshes() -> Vec<Mesh> {
    let mut state = 3;
    let mut soup = |count: u32, size: f32| {
        let corner = |around: [f32; 3], state: &mut u32| around.map(|x| x + size * noise(state));
        let corners: Vec<_> = (0..count)
            .flat_map(|_| {
                let around = [(); 3].map(|()| noise(&mut state));
                [(); 3].map(|()| corner(around, &mut state))
            })
            .collect();
        let faces: Vec<_> = (0..count).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
        Mesh::new(&corners, &faces).expect("sound")
    };
    let soups = [soup(60, 0.2), soup(400, 0.01), soup(300, 1.0)];
    soups.into_iter().chain([balls(usize::MAX), balls(701), balls(60), sheet()]).collect()
}

/// Balls that overlap, without every `gap`-th face. Their poles are triangles without area, and
/// every other one is a box.
fn balls(gap: usize) -> Mesh {
    const TURN: u32 = 48;
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for ball in 0..5 {
        let first = corners.len() as u32;
        for at in 0..TURN * (TURN + 1) {
            let (turn, rise) = ((at % TURN) as f32, (at / TURN) as f32);
            let (across, around) = (
                (rise / TURN as f32 * 3.2 - 1.6).cos().max(0.0),
                turn / TURN as f32 * std::f32::consts::TAU,
            );
            let round = [across * around.cos(), rise / 12.0 - 2.0, across * around.sin()];
            let of = if ball % 2 == 0 { round } else { round.map(|x| (4.0 * x).clamp(-0.7, 0.7)) };
            corners.push([of[0] + 0.6 * ball as f32, of[1], 0.8 * of[2]]);
        }
        let quads = (0..TURN * TURN).map(|at| [at, at / TURN * TURN + (at + 1) % TURN]);
        let quads = quads.map(|pair| pair.map(|at| first + at));
        faces.extend(quads.flat_map(|[a, b]| [[a, b, a + TURN], [b + TURN, a + TURN, b]]));
        // The ends.
        let ring = |start: u32| (1..TURN - 1).map(move |at| [start, start + at, start + at + 1]);
        faces.extend(ring(first).chain(ring(first + TURN * TURN)));
    }
    let kept = (0..faces.len()).filter(|at| (at + 1) % gap != 0);
    let faces: Vec<_> = kept.map(|at| faces[at]).collect();
    Mesh::new(&corners, &faces).expect("sound")
}

/// Bumps over a square.
fn sheet() -> Mesh {
    let corner = |at: u32| {
        let [x, z] = [(at / 40) as f32, (at % 40) as f32];
        [x, 3.0 * (0.4 * x).sin() * (0.3 * z).cos(), z]
    };
    let corners: Vec<_> = (0..1600).map(corner).collect();
    let starts = (0..1560).filter(|at| at % 40 != 39);
    let faces: Vec<_> =
        starts.flat_map(|at| [[at, at + 1, at + 40], [at + 41, at + 40, at + 1]]).collect();
    Mesh::new(&corners, &faces).expect("sound")
}

/// Points in the box, some of them where cells meet, and how their ray answers.
#[test]
fn what_the_grid_tells_is_what_the_ray_says() {
    let mut state = 9;
    let mut told = 0;
    for (place, mesh) in meshes().into_iter().enumerate() {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let tracer = Tracer::new(&mesh, &tree);
        let along = tracer.shortest_side();
        let grid = Grid::new(&tracer.trip, tracer.bounds, along, mesh.triangles().len())
            .expect("there is room");
        let Aabb { lower, upper } = mesh.bounds();
        let counts = grid.space.counts;
        let (mut inside, mut known) = (0, 0);
        for turn in 0..40_000 {
            let point = [0, 1, 2].map(|axis| {
                let cells = counts[[1, 2, 0][(axis + 2 - along) % 3]] as f32;
                let whole = noise(&mut state);
                let part = if turn % 3 == 0 { (cells * whole).round() / cells } else { whole };
                lower[axis] + part * (upper[axis] - lower[axis])
            });
            if let Some(answer) = tracer.look(&grid, &point) {
                assert_eq!(answer, tracer.contains(point), "mesh {place}: {point:?}");
                (inside, known) = (inside + usize::from(answer), known + 1);
            }
        }
        println!("{place}: {counts:?} cells, {known} known, {inside} of them inside");
        told += usize::from(inside > 400 && known > 10_000);
    }
    assert!(told >= 3, "grids tell");
}

#[test]
fn boxes_without_room_have_no_grid() {
    for corners in [[[0.0; 3]; 3], [[1.0, 2.0, 3.0]; 3]] {
        let mesh = Mesh::new(&corners, &[[0, 1, 2]]).expect("sound");
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let tracer = Tracer::new(&mesh, &tree);
        assert!(Grid::new(&tracer.trip, tracer.bounds, 0, 1).is_none());
    }
    let mesh = Mesh::new(&[], &[]).expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
    assert!(Tracer::new(&mesh, &tree).grid_for(1 << 20).is_none());
}

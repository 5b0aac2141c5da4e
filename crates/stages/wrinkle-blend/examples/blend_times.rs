//! How long one core blends four maps of 2048², in time that it really worked: machines that measure do other things too.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::disallowed_methods,
    missing_docs,
    reason = "an example"
)]

use artifact::gltf::SkinnedMesh;
use wrinkle_blend::{Atlas, MapBlender, NormalMap};

const SIZE: usize = 2048;
/// Cells along a side of the mesh: about as many triangles as a game's head.
const CELLS: u32 = 72;

fn main() {
    let side = CELLS + 1;
    let grid: Vec<[f64; 2]> =
        (0..side * side).map(|i| [i % side, i / side].map(|at| f64::from(at) / f64::from(CELLS))).collect();
    let corner = |cell: u32| cell / CELLS * side + cell % CELLS;
    let mesh = SkinnedMesh {
        name: "grid".into(),
        positions: vec![[0.0; 3].into(); grid.len()],
        uvs: grid.clone(),
        triangles: (0..CELLS * CELLS)
            .map(corner)
            .flat_map(|a| [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]])
            .collect(),
        joints: vec![],
        inverse_bind: vec![],
        influences: vec![vec![]; grid.len()],
    };
    let atlas = Atlas::new(&mesh, [SIZE, SIZE], 8).unwrap();
    let map = |number: usize| {
        let codes: Vec<u8> = (0..3 * SIZE * SIZE)
            .map(|i| if i % 3 == 2 { 230 } else { (100 + (i * number) % 56) as u8 })
            .collect();
        NormalMap::from_8_bits("map", SIZE, SIZE, &codes).unwrap()
    };
    let blender = MapBlender::new(map(0), (1..5).map(map).collect(), 8).unwrap();
    for share in [0.0, 0.5, 1.0] {
        let one = grid.iter().map(|uv| if uv[1] < share { 0.5 + 0.4 * uv[0] as f32 } else { 0.0 });
        let weights: Vec<f32> = (0..4).flat_map(|_| one.clone()).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let seconds = pool.install(|| {
            let mut all: Vec<f64> = (0..9)
                .map(|_| {
                    let start = worked();
                    std::hint::black_box(blender.blend(&atlas, &weights));
                    worked() - start
                })
                .collect();
            all.sort_by(f64::total_cmp);
            all[4]
        });
        println!(
            "{:3.0} % of the texels wrinkled: {:.1} Mpix/s",
            100.0 * share,
            (SIZE * SIZE) as f64 / seconds / 1e6
        );
    }
}

/// Seconds that this thread has had a processor (Linux).
fn worked() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() / 1e9
}

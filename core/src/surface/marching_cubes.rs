//! Marching cubes (Lorensen & Cline, SIGGRAPH 1987): extracts the iso-surface of a sampled field as a closed manifold
//! mesh.

use alloc::{vec, vec::Vec};
use core::mem::take;
use glam::Vec3;

use super::cases::{Cases, EDGES};
use super::neighbourhood::{Neighbourhood, SIDE};
use crate::executor::Executor;
use crate::grid::{BLOCK, BLOCK_NODES, BLOCKS_PER_JOB, SparseGrid};
use crate::math::min;
use crate::point_cloud::Mesh;
use crate::workspace::Workspace;

/// Smallest distance of a vertex from a node, as a fraction of the edge. It keeps vertices on different edges apart, so
/// that no triangle degenerates.
const NEAREST: f32 = 0.02;

const NO_BLOCK: u32 = u32::MAX;

/// The values of the field in blocks that a grid does not store.
#[derive(Debug, Clone, Copy)]
pub struct Unstored {
    /// In blocks inside the object: greater than the iso value.
    pub inside: f32,
    /// In blocks outside the object: not greater than the iso value.
    pub outside: f32,
}

/// Extracts the surface on which the field equals `iso`. Nodes with a greater value are inside the object. `values`
/// belong to the nodes of the stored blocks.
///
/// For any values the mesh is closed and manifold: each edge has two triangles and each vertex one fan of triangles.
/// Triangles are counter-clockwise as seen from outside and have a positive area. Normals follow the gradient of the
/// field.
pub fn marching_cubes(
    grid: &SparseGrid,
    values: &[f32],
    iso: f32,
    unstored: Unstored,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Mesh {
    let mut mesh = extract(Extractor::new(grid, values, iso, unstored, true, workspace), workspace, executor);
    complete_normals(&mut mesh);
    mesh
}

/// [`marching_cubes`] for a mesh whose vertices will be moved: all normals are zero.
pub(crate) fn without_normals(
    grid: &SparseGrid,
    values: &[f32],
    iso: f32,
    unstored: Unstored,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Mesh {
    extract(Extractor::new(grid, values, iso, unstored, false, workspace), workspace, executor)
}

fn extract(mut extractor: Extractor, workspace: &mut Workspace, executor: &dyn Executor) -> Mesh {
    let mut mesh = Mesh::with_workspace(workspace);
    let mut nodes = take(&mut extractor.nodes);
    let parts = nodes.chunks_mut(BLOCKS_PER_JOB * BLOCK_NODES);
    let found = executor.map_parts(parts, |i, nodes| extractor.vertices(i * BLOCKS_PER_JOB, nodes));
    for part in &found {
        extractor.firsts.push(mesh.positions.len() as u32);
        mesh.positions.extend_from_slice(&part.positions);
        mesh.normals.extend_from_slice(&part.normals);
    }
    extractor.nodes = nodes;
    let cases = Cases::new();
    let parts = extractor.active.len().div_ceil(BLOCKS_PER_JOB);
    for part in executor.map(parts, |i| extractor.triangles(i * BLOCKS_PER_JOB, &cases)) {
        mesh.triangles.extend_from_slice(&part);
    }
    extractor.recycle_into(workspace);
    mesh
}

/// The state of one extraction. It works on the active blocks: those with different signs at their nodes or at their
/// upper faces. Some of them lie in the layer of blocks below the grid.
struct Extractor<'a> {
    grid: &'a SparseGrid,
    values: &'a [f32],
    iso: f32,
    unstored: Unstored,
    /// Whether vertices get the normals of the field. They are zero otherwise.
    normals: bool,
    active: Vec<[i32; 3]>,
    /// For each block, its index in `active` or [`NO_BLOCK`]. Starts one block below the grid.
    table: Vec<u32>,
    /// For each node of an active block, its first vertex times eight, plus one bit for each axis whose edge has a
    /// vertex. Vertices are counted from the first one of the job that found them.
    nodes: Vec<u32>,
    /// The first vertex of each job.
    firsts: Vec<u32>,
}

/// Vertices that one job found.
#[derive(Default)]
struct Vertices {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

impl<'a> Extractor<'a> {
    fn new(
        grid: &'a SparseGrid,
        values: &'a [f32],
        iso: f32,
        unstored: Unstored,
        normals: bool,
        workspace: &mut Workspace,
    ) -> Self {
        let [w, h, d] = grid.dims.map(|v| v as i32);
        let mut active = workspace.take();
        let mut table = workspace.empty(((w + 1) * (h + 1) * (d + 1)) as usize);
        for z in -1..d {
            for y in -1..h {
                for x in -1..w {
                    let state = grid.slot(x, y, z);
                    let differs = |c: i32| grid.slot(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)) != state;
                    if state < SparseGrid::INSIDE || (1..8).any(differs) {
                        table.push(active.len() as u32);
                        active.push([x, y, z]);
                    } else {
                        table.push(NO_BLOCK);
                    }
                }
            }
        }
        let nodes = workspace.filled(0, active.len() * BLOCK_NODES);
        Self { grid, values, iso, unstored, normals, active, table, nodes, firsts: Vec::new() }
    }

    fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.active);
        workspace.recycle(self.table);
        workspace.recycle(self.nodes);
    }

    fn load(&self, block: [i32; 3], around: &mut Neighbourhood) {
        around.load(self.grid, self.values, block, self.unstored.inside, self.unstored.outside);
    }

    /// The signs of the block's 9 x 9 rows of 9 nodes. Bit x of row (z, y) is set if the node is inside.
    fn signs(&self, around: &Neighbourhood) -> [[u16; BLOCK + 1]; BLOCK + 1] {
        let mut signs = [[0; BLOCK + 1]; BLOCK + 1];
        for (z, plane) in signs.iter_mut().enumerate() {
            for (y, bits) in plane.iter_mut().enumerate() {
                let first = Neighbourhood::index(0, y as i32, z as i32);
                for (x, &value) in around.0[first..first + BLOCK + 1].iter().enumerate() {
                    *bits |= u16::from(value > self.iso) << x;
                }
            }
        }
        signs
    }

    /// Finds the vertices of the active blocks from `first` on, for as many as `nodes` has, and sets `nodes`.
    fn vertices(&self, first: usize, nodes: &mut [u32]) -> Vertices {
        let mut found = Vertices::default();
        let mut around = Neighbourhood::new();
        for (&block, nodes) in self.active[first..].iter().zip(nodes.chunks_exact_mut(BLOCK_NODES)) {
            self.load(block, &mut around);
            let signs = self.signs(&around);
            for z in 0..BLOCK {
                for y in 0..BLOCK {
                    let row = signs[z][y];
                    let crossed = [row ^ row >> 1, row ^ signs[z][y + 1], row ^ signs[z + 1][y]];
                    if (crossed[0] | crossed[1] | crossed[2]) & 0xff == 0 {
                        continue;
                    }
                    for x in 0..BLOCK {
                        let axes = (0..3).fold(0, |bits, a| bits | (crossed[a] >> x & 1) << a);
                        if axes == 0 {
                            continue;
                        }
                        let vertex = found.positions.len() as u32;
                        nodes[(z * BLOCK + y) * BLOCK + x] = vertex << 3 | u32::from(axes);
                        for axis in (0..3).filter(|axis| axes >> axis & 1 == 1) {
                            let (position, normal) = self.vertex(&around, block, [x, y, z].map(|v| v as i32), axis);
                            found.positions.push(position);
                            found.normals.push(normal);
                        }
                    }
                }
            }
        }
        found
    }

    /// Position and normal of the vertex on the edge that starts at a node and runs along an axis.
    fn vertex(&self, around: &Neighbourhood, block: [i32; 3], node: [i32; 3], axis: usize) -> (Vec3, Vec3) {
        let i = Neighbourhood::index(node[0], node[1], node[2]);
        let step = [1, SIDE, SIDE * SIDE][axis];
        let t = crossing([i - step, i, i + step, i + 2 * step].map(|k| around.0[k] - self.iso));
        // Written so that NaN, which results from values that are not finite, is replaced as well.
        let t = if t > NEAREST { min(t, 1.0 - NEAREST) } else { NEAREST };
        let mut local = Vec3::from_array(node.map(|v| v as f32));
        local[axis] += t;
        let first = Vec3::from_array(block.map(|v| (v * BLOCK as i32) as f32));
        let position = self.grid.origin + (first + local) * self.grid.voxel;
        if !self.normals {
            return (position, Vec3::ZERO);
        }
        let outward = -around.gradient(local);
        let length = outward.length();
        let normal = if length > 1e-20 && length.is_finite() { outward / length } else { Vec3::ZERO };
        (position, normal)
    }

    /// The triangles of the active blocks of one job, from `first` on.
    fn triangles(&self, first: usize, cases: &Cases) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        let mut around = Neighbourhood::new();
        for index in first..self.active.len().min(first + BLOCKS_PER_JOB) {
            self.load(self.active[index], &mut around);
            let signs = self.signs(&around);
            for z in 0..BLOCK {
                for y in 0..BLOCK {
                    let rows = [signs[z][y], signs[z][y + 1], signs[z + 1][y], signs[z + 1][y + 1]];
                    let (any, all) = rows.iter().fold((0, 0x1ff), |(any, all), row| (any | row, all & row));
                    // A cube is uniform if its two columns of four nodes are all inside or all outside.
                    let mixed = (any | any >> 1) & !(all & all >> 1) & 0xff;
                    for x in (0..BLOCK).filter(|x| mixed >> x & 1 == 1) {
                        let case = (0..4).fold(0, |bits, r| bits | (rows[r] >> x & 3) << (2 * r));
                        for triangle in cases.of(case as u8) {
                            triangles.push(triangle.map(|e| self.edge(index, [x, y, z], usize::from(e))));
                        }
                    }
                }
            }
        }
        triangles
    }

    /// Index of the vertex on an edge of a cube, which is given by its lowest node in the block.
    fn edge(&self, index: usize, cube: [usize; 3], edge: usize) -> u32 {
        let (axis, corner) = EDGES[edge];
        let node: [usize; 3] = core::array::from_fn(|k| cube[k] + (corner >> k & 1));
        let owner = if node.iter().all(|&v| v < BLOCK) {
            index
        } else {
            let block = self.active[index];
            // The table starts one block below the grid.
            let [x, y, z] = core::array::from_fn(|k| (block[k] + 1) as usize + node[k] / BLOCK);
            let [w, h, _] = self.grid.dims.map(|v| v as usize + 1);
            self.table[(z * h + y) * w + x] as usize
        };
        let [x, y, z] = node.map(|v| v % BLOCK);
        let entry = self.nodes[owner * BLOCK_NODES + (z * BLOCK + y) * BLOCK + x];
        self.firsts[owner / BLOCKS_PER_JOB] + (entry >> 3) + (entry & ((1 << axis) - 1)).count_ones()
    }
}

/// The zero, between the middle two of four equidistant values, of the cubic through them. The signs of the middle
/// values differ. The result is a fraction of the way from the second to the third value. Newton's method starts at the
/// zero of the chord, which is returned if the iteration leaves the interval.
fn crossing([before, a, b, after]: [f32; 4]) -> f32 {
    const STEPS: u32 = 3;
    let chord = a / (a - b);
    let cubic = (after - before) / 6.0 + 0.5 * (a - b);
    let square = 0.5 * (before + b) - a;
    let slope = b - a - square - cubic;
    let mut t = chord;
    for _ in 0..STEPS {
        let value = a + t * (slope + t * (square + t * cubic));
        t -= value / (slope + t * (2.0 * square + t * 3.0 * cubic));
    }
    if (0.0..=1.0).contains(&t) { t } else { chord }
}

/// Sets the normals that are zero: the mean of the triangles' normals, weighted by area.
pub(crate) fn complete_normals(mesh: &mut Mesh) {
    if mesh.normals.iter().all(|&n| n != Vec3::ZERO) {
        return;
    }
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        for v in triangle {
            sums[v as usize] += (b - a).cross(c - a);
        }
    }
    for (normal, sum) in mesh.normals.iter_mut().zip(sums) {
        if *normal == Vec3::ZERO {
            let length = sum.length();
            *normal = if length > 0.0 { sum / length } else { Vec3::Z };
        }
    }
}

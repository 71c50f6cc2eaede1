//! Trees over triangles: the builder writes what tracing relies on, for any triangles.

use crate::common::random::tries;
use belvedere_sensors::Execution;
use belvedere_sensors::scene::build::{
    Plan, Quality, Scratch, Tree, build, max_size, plan, refit, scratch_len,
};
use belvedere_sensors::scene::tree::{LEAF, MAX_DEPTH, NONE, TriangleBlock, WideNode};
use belvedere_sensors::scene::{SceneError, TreeFault, validate_scratch_len, validate_tree};
use belvedere_sensors::simd::Level;
use belvedere_sensors::simd::WIDTH;
use bytemuck::Zeroable;
use proptest::prelude::*;

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

const QUALITIES: [Quality; 2] = [Quality::Fast, Quality::High];

/// `SplitMix64`, scaled to [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    fn point(&mut self, size: f32) -> [f32; 3] {
        [0; 3].map(|_| (self.next() - 0.5) * size)
    }
}

/// Small random triangles, no two of which share a vertex.
fn soup(count: usize, seed: u64, size: f32, edge: f32) -> Mesh {
    let mut random = Random(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let centre = random.point(size);
        for _ in 0..3 {
            let offset = random.point(edge);
            positions.push(core::array::from_fn(|axis| centre[axis] + offset[axis]));
        }
    }
    (positions, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A bumpy plane of n × n squares, each of two triangles.
fn terrain(n: u32) -> Mesh {
    let mut random = Random(u64::from(n));
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| (x, y)));
    let positions = positions.map(|(x, y)| [x as f32, y as f32, random.next()]).collect();
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles = squares.flat_map(|(x, y)| {
        [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]]
    });
    (positions, triangles.collect())
}

/// Sizes that double from one triangle to the next: split by surface area alone, the tree would be a list.
fn doubling(count: usize) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..count {
        let size = 2.0_f32.powi((i % 60) as i32 - 30);
        positions.extend([[0.0, 0.0, 0.0], [size, 0.0, size], [0.0, size, size]]);
    }
    (positions, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Meshes that are difficult in some way, with a name.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let one = vec![[1.0, 2.0, 3.0], [1.0, 2.5, 3.0], [1.5, 2.0, 3.0]];
    let line = (0..3000).map(|i| [i as f32, 0.0, 0.0]).collect::<Vec<_>>();
    let copies = |count: usize| (one.clone(), vec![[0, 1, 2]; count]);
    let zeros = (0..500).map(|i| [-0.0, if i % 2 == 0 { 0.0 } else { -0.0 }, i as f32]).collect::<Vec<_>>();
    vec![
        ("none", (vec![], vec![])),
        ("vertices without triangles", (one.clone(), vec![])),
        ("one", copies(1)),
        ("sixteen", soup(16, 1, 10.0, 1.0)),
        ("seventeen", soup(17, 2, 10.0, 1.0)),
        ("seventeen alike", copies(17)),
        ("thousands alike", copies(20_000)),
        ("points", (one.clone(), vec![[1, 1, 1]; 5000])),
        ("points on a line", (line.clone(), (0..3000).map(|i| [i; 3]).collect())),
        ("edges on a line", (line, (0..2998).map(|i| [i, i + 1, i + 2]).collect())),
        ("both zeros", (zeros, (0..498).map(|i| [i, i + 1, i + 2]).collect())),
        ("soup", soup(5000, 3, 10.0, 0.5)),
        ("large in small", soup(3000, 4, 1.0, 10.0)),
        ("tiny", soup(1000, 5, 1e-30, 1e-32)),
        ("subnormal", soup(1000, 6, 1e-41, 1e-41)),
        ("huge", soup(1000, 7, 1.9e12, 1e10)),
        ("doubling", doubling(4000)),
        ("terrain", terrain(100)),
    ]
}

fn bytes(tree: &Tree) -> (&[u8], &[u8]) {
    (bytemuck::cast_slice(&tree.nodes), bytemuck::cast_slice(&tree.blocks))
}

#[test]
fn every_mesh_gets_a_valid_tree() {
    for (name, (positions, triangles)) in meshes() {
        for quality in QUALITIES {
            let tree = Tree::build(&positions, &triangles, quality, Execution::default()).unwrap();
            assert_eq!(tree.validate(&positions, &triangles), Ok(()), "{name} {quality:?}");
            let most = max_size(triangles.len());
            assert!(tree.nodes.len() <= most.nodes && tree.blocks.len() <= most.blocks, "{name} {quality:?}");
        }
    }
}

/// An independent check in addition to the validator: which triangles are in which leaves.
#[test]
fn every_triangle_is_in_one_leaf_of_a_plain_tree() {
    let (positions, triangles) = soup(3000, 8, 10.0, 0.5);
    for quality in QUALITIES {
        let tree = Tree::build(&positions, &triangles, quality, Execution::default()).unwrap();
        let mut found = vec![0; triangles.len()];
        let mut work = vec![(0_usize, vec![])];
        while let Some((index, above)) = work.pop() {
            for lane in 0..WIDTH {
                let (node, mut boxes): (&WideNode, Vec<(usize, usize)>) = (&tree.nodes[index], above.clone());
                boxes.push((index, lane));
                match node.child[lane] {
                    NONE => {}
                    child if child & LEAF == 0 => work.push((child as usize, boxes)),
                    child => {
                        let block: &TriangleBlock = &tree.blocks[(child & !LEAF) as usize];
                        for &triangle in block.triangle.iter().filter(|&&triangle| triangle != NONE) {
                            found[triangle as usize] += 1;
                            for vertex in triangles[triangle as usize] {
                                for &(node, lane) in &boxes {
                                    let bounds = &tree.nodes[node];
                                    for (axis, &x) in positions[vertex as usize].iter().enumerate() {
                                        assert!(bounds.min[axis][lane] <= x && x <= bounds.max[axis][lane]);
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(found.iter().all(|&times| times == 1));
    }
}

/// A leaf costs the same whether it is full or not.
#[test]
fn leaves_are_well_filled() {
    let (positions, triangles) = terrain(200);
    for quality in QUALITIES {
        let tree = Tree::build(&positions, &triangles, quality, Execution::default()).unwrap();
        let fill = triangles.len() as f32 / tree.blocks.len() as f32;
        assert!(fill > 12.0, "{quality:?}: {fill} triangles a leaf");
    }
}

#[test]
fn levels_give_the_same_bytes() {
    let levels = [Level::baseline(), Level::new()];
    for (name, (positions, triangles)) in meshes() {
        for quality in QUALITIES {
            let [a, b] = levels.map(|level| {
                let execution = Execution::at(level);
                let mut tree = Tree::build(&positions, &triangles, quality, execution).unwrap();
                let built = tree.clone();
                tree.refit(&positions, &triangles, execution).unwrap();
                assert_eq!(bytes(&built), bytes(&tree), "{name} {quality:?}: refit changes nothing");
                tree
            });
            assert_eq!(bytes(&a), bytes(&b), "{name} {quality:?}");
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn threads_give_the_same_bytes() {
    for (name, (positions, triangles)) in meshes().into_iter().chain([("large", terrain(300))]) {
        for quality in QUALITIES {
            let serial = Tree::build(&positions, &triangles, quality, Execution::default()).unwrap();
            for threads in [2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let parallel = pool
                    .install(|| Tree::build(&positions, &triangles, quality, Execution::parallel()))
                    .unwrap();
                assert_eq!(bytes(&serial), bytes(&parallel), "{name} {quality:?} on {threads} threads");
            }
        }
    }
}

#[test]
fn a_refitted_tree_is_valid() {
    for (name, (mut positions, triangles)) in meshes() {
        let mut tree = Tree::build(&positions, &triangles, Quality::Fast, Execution::default()).unwrap();
        let mut random = Random(9);
        for position in &mut positions {
            let offset = random.point(3.0);
            *position = core::array::from_fn(|axis| 0.5 * position[axis] + offset[axis]);
        }
        tree.refit(&positions, &triangles, Execution::default()).unwrap();
        assert_eq!(tree.validate(&positions, &triangles), Ok(()), "{name}");
    }
}

#[test]
fn the_callers_memory_may_be_dirty_and_larger() {
    let (positions, triangles) = soup(777, 10, 5.0, 0.5);
    let clean = Tree::build(&positions, &triangles, Quality::High, Execution::default()).unwrap();
    let most = max_size(triangles.len());
    let mut scratch = vec![Scratch::zeroed(); scratch_len(triangles.len()) + 7];
    bytemuck::cast_slice_mut::<_, u8>(&mut scratch).fill(0xA5);
    let mut nodes = vec![WideNode::zeroed(); most.nodes + 7];
    bytemuck::cast_slice_mut::<_, u8>(&mut nodes).fill(0xA5);
    let mut blocks = vec![TriangleBlock::zeroed(); most.blocks + 7];
    bytemuck::cast_slice_mut::<_, u8>(&mut blocks).fill(0xA5);
    let execution = Execution::default();
    let size = build(&positions, &triangles, Quality::High, execution, &mut scratch, &mut nodes, &mut blocks)
        .unwrap();
    let dirty = Tree { nodes: nodes[..size.nodes].to_vec(), blocks: blocks[..size.blocks].to_vec() };
    assert_eq!(bytes(&clean), bytes(&dirty));
}

#[test]
fn each_fault_of_a_mesh_is_named() {
    let (positions, triangles) = soup(100, 11, 5.0, 0.5);
    let fails = |positions: &[[f32; 3]], triangles: &[[u32; 3]], error: SceneError| {
        for quality in QUALITIES {
            let built = Tree::build(positions, triangles, quality, Execution::default());
            assert_eq!(built.err(), Some(error));
        }
        // A refit reports the same faults.
        let (sound, same) = soup(100, 11, 5.0, 0.5);
        let mut tree = Tree::build(&sound, &same, Quality::Fast, Execution::default()).unwrap();
        assert_eq!(tree.refit(positions, triangles, Execution::default()), Err(error));
        assert_eq!(tree.validate(positions, triangles), Err(TreeFault::Mesh(error)));
    };
    for (value, error) in [
        (f32::NAN, SceneError::BadVertex(37)),
        (f32::NEG_INFINITY, SceneError::BadVertex(37)),
        (2e12, SceneError::VertexTooFar(37)),
    ] {
        for axis in 0..3 {
            let mut positions = positions.clone();
            positions[37][axis] = value;
            fails(&positions, &triangles, error);
        }
    }
    for corner in 0..3 {
        let mut triangles = triangles.clone();
        triangles[42][corner] = positions.len() as u32;
        fails(&positions, &triangles, SceneError::BadTriangle(42));
    }
    assert_eq!(
        SceneError::VertexTooFar(37).to_string(),
        "vertex 37 is farther than 1e12 m from the origin of its mesh"
    );
}

#[test]
fn short_buffers_are_named() {
    let (positions, triangles) = soup(100, 12, 5.0, 0.5);
    let execution = Execution::default();
    let need = scratch_len(100);
    let mut scratch = vec![Scratch::zeroed(); need];
    let short = plan(&positions, &triangles, Quality::Fast, execution, &mut scratch[1..]);
    let error = SceneError::BufferTooSmall { buffer: "scratch", have: need - 1, need };
    assert_eq!(short.err(), Some(error));
    let plan: Plan = plan(&positions, &triangles, Quality::Fast, execution, &mut scratch).unwrap();
    let size = plan.size();
    let mut nodes = vec![WideNode::zeroed(); size.nodes];
    let mut blocks = vec![TriangleBlock::zeroed(); size.blocks];
    assert_eq!(
        plan.write(&mut nodes[1..], &mut blocks),
        Err(SceneError::BufferTooSmall { buffer: "nodes", have: size.nodes - 1, need: size.nodes })
    );
    assert_eq!(
        plan.write(&mut nodes, &mut blocks[1..]),
        Err(SceneError::BufferTooSmall { buffer: "blocks", have: size.blocks - 1, need: size.blocks })
    );
    assert_eq!(plan.write(&mut nodes, &mut blocks), Ok(()));
    let mut words = vec![0; validate_scratch_len(100, nodes.len(), blocks.len())];
    let need = words.len();
    let validate = |words: &mut [u32]| validate_tree(&positions, &triangles, &nodes, &blocks, words);
    assert_eq!(validate(&mut words[1..]), Err(TreeFault::ScratchTooSmall(need)));
    assert_eq!(validate(&mut words), Ok(()));
}

/// One element is corrupted at a time; the validator names it, and a refit survives it.
#[test]
fn each_fault_of_a_tree_is_named() {
    let (positions, triangles) = soup(1000, 13, 10.0, 0.5);
    let sound = Tree::build(&positions, &triangles, Quality::High, Execution::default()).unwrap();
    let last = |node: &WideNode| node.child.iter().position(|&child| child == NONE).unwrap_or(WIDTH) - 1;
    let node = (0..sound.nodes.len()).find(|&node| last(&sound.nodes[node]) < WIDTH - 1).unwrap();
    let lane = last(&sound.nodes[node]);
    let block = (0..sound.blocks.len()).find(|&block| sound.blocks[block].triangle[15] == NONE).unwrap();
    let inner = sound.nodes[0].child.iter().position(|child| child & LEAF == 0).unwrap();
    let blocks = sound.blocks.len() as u32;
    let finds = |fault: TreeFault, spoil: &dyn Fn(&mut Tree)| {
        let mut tree = sound.clone();
        spoil(&mut tree);
        assert_eq!(tree.validate(&positions, &triangles), Err(fault));
        assert!(!fault.to_string().is_empty());
        let _ = refit(&positions, &triangles, Execution::default(), &mut tree.nodes, &mut tree.blocks);
    };
    finds(TreeFault::NoNodes, &|tree| tree.nodes.clear());
    finds(TreeFault::Child { node: 0, lane: inner }, &|tree| tree.nodes[0].child[inner] = 0);
    finds(TreeFault::Child { node: 0, lane: inner }, &|tree| tree.nodes[0].child[inner] = LEAF | blocks);
    finds(TreeFault::Child { node: 0, lane: 3 }, &|tree| tree.nodes[0].child[3] = 1 << 20);
    finds(TreeFault::UnusedChild { node, lane }, &|tree| tree.nodes[node].child[lane] = NONE);
    finds(TreeFault::UnusedChild { node, lane: lane + 1 }, &|tree| {
        tree.nodes[node].min[1][lane + 1] += 1.0;
    });
    finds(TreeFault::UnusedChild { node: 0, lane: 1 }, &|tree| tree.nodes[0].child[0] = NONE);
    finds(TreeFault::Box { node: 0, lane: inner }, &|tree| tree.nodes[0].min[0][inner] += 0.1);
    finds(TreeFault::Box { node: 0, lane: inner }, &|tree| tree.nodes[0].max[2][inner] = f32::NAN);
    finds(TreeFault::Box { node: 0, lane: inner }, &|tree| tree.nodes[0].max[2][inner] = f32::INFINITY);
    finds(TreeFault::StrayNode(sound.nodes.len()), &|tree| tree.nodes.push(tree.nodes[0]));
    finds(TreeFault::StrayBlock(sound.blocks.len()), &|tree| tree.blocks.push(tree.blocks[0]));
    finds(TreeFault::Triangle { block, lane: 0 }, &|tree| tree.blocks[block].triangle[0] = 1000);
    finds(TreeFault::Triangle { block, lane: 1 }, &|tree| tree.blocks[block].corners[2][1][1] += 0.1);
    finds(TreeFault::UnusedTriangle { block, lane: 15 }, &|tree| {
        tree.blocks[block].corners[0][0][15] += 0.1;
    });
    finds(TreeFault::UnusedTriangle { block, lane: 1 }, &|tree| tree.blocks[block].triangle[0] = NONE);
    let missing = sound.blocks[block].triangle[0];
    finds(TreeFault::MissingTriangle(missing as usize), &|tree| {
        let block = &mut tree.blocks[block];
        block.triangle[0] = block.triangle[1];
        for corner in &mut block.corners {
            for axis in corner {
                axis[0] = axis[1];
            }
        }
    });
    // A leaf that is reached twice. Which of the lanes is reported depends on the order of the walk.
    let mut tree = sound.clone();
    let leaves = tree.nodes[node].child;
    tree.nodes[node].child[lane] = leaves[0];
    for axis in 0..3 {
        tree.nodes[node].min[axis] = [-20.0; WIDTH];
        tree.nodes[node].max[axis] = [20.0; WIDTH];
    }
    let fault = tree.validate(&positions, &triangles);
    assert!(matches!(fault, Err(TreeFault::SharedChild { .. } | TreeFault::Box { .. })), "{fault:?}");
}

/// A chain of nodes, each the only child of the previous one.
#[test]
fn a_tree_too_deep_for_a_stack_is_refused() {
    let (positions, triangles) = soup(1, 14, 1.0, 1.0);
    let leaf = Tree::build(&positions, &triangles, Quality::Fast, Execution::default()).unwrap();
    let chain = |depth: usize| {
        let mut tree = leaf.clone();
        tree.nodes = vec![leaf.nodes[0]; depth];
        for (index, node) in tree.nodes[..depth - 1].iter_mut().enumerate() {
            node.child[0] = index as u32 + 1;
        }
        tree.validate(&positions, &triangles)
    };
    assert_eq!(chain(MAX_DEPTH), Ok(()));
    assert_eq!(chain(MAX_DEPTH + 1), Err(TreeFault::TooDeep(MAX_DEPTH)));
}

proptest! {
    #![proptest_config(tries(64))]

    /// Random triangles, either on a coarse grid so that many coincide, or of all magnitudes.
    #[test]
    fn any_triangles_get_a_valid_tree(
        vertices in proptest::collection::vec((any::<[i8; 3]>(), -30_i32..30), 1..60),
        corners in proptest::collection::vec(any::<[u8; 3]>(), 0..600),
        grid in any::<bool>(),
        high in any::<bool>(),
    ) {
        let positions: Vec<[f32; 3]> = vertices
            .iter()
            .map(|(x, exponent)| x.map(|x| if grid { f32::from(x / 16) } else { f32::from(x) * 2.0_f32.powi(*exponent) }))
            .collect();
        let triangles: Vec<[u32; 3]> =
            corners.iter().map(|corner| corner.map(|vertex| u32::from(vertex) % positions.len() as u32)).collect();
        let quality = if high { Quality::High } else { Quality::Fast };
        let tree = Tree::build(&positions, &triangles, quality, Execution::default()).unwrap();
        prop_assert_eq!(tree.validate(&positions, &triangles), Ok(()));
        let most = max_size(triangles.len());
        prop_assert!(tree.nodes.len() <= most.nodes && tree.blocks.len() <= most.blocks);
    }

    /// The bytes of a corrupted tree: there may be an error or not, but nothing panics.
    #[test]
    fn a_broken_tree_never_panics(
        edits in proptest::collection::vec((any::<u32>(), any::<u32>()), 1..8),
        few in any::<bool>(),
    ) {
        let (positions, triangles) = soup(400, 15, 10.0, 0.5);
        let mut tree = Tree::build(&positions, &triangles, Quality::Fast, Execution::default()).unwrap();
        for (at, value) in edits {
            let value = if few { value % 64 } else { value };
            let words: &mut [u32] = if at % 2 == 0 {
                bytemuck::cast_slice_mut(&mut tree.nodes)
            } else {
                bytemuck::cast_slice_mut(&mut tree.blocks)
            };
            let at = (at / 2) as usize % words.len();
            words[at] = value;
        }
        let _ = tree.validate(&positions, &triangles);
        let _ = tree.refit(&positions, &triangles, Execution::default());
    }
}

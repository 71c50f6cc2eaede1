//! No sensor allocates after it is set up, and none needs much stack.

#[path = "../common/mod.rs"]
mod common;
#[cfg(target_arch = "x86_64")]
mod small_stack;

use belvedere_sensors::camera::{Camera, Edges, Picture};
use belvedere_sensors::depth::{DepthCamera, DepthFrame, POINT_STEP};
use belvedere_sensors::device::depth_model::published;
use belvedere_sensors::lidar::{Lidar, Scan};
use belvedere_sensors::optics::{Optics, PinholeGrid, RayTable};
use belvedere_sensors::scanner::{
    Beam, Columns, Echoes, Laser, Pattern, Returns, Scanner, ScannerConfig, Spinning, Weather,
};
use belvedere_sensors::scene::{SceneBuilder, visibility};
use belvedere_sensors::trace::{CacheLine, Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use belvedere_sensors::{Capture, Keyframe, Pose, Sensor};
use common::{LIDAR, camera, depth_camera, scenery};
use core::cell::Cell;
use std::alloc::{GlobalAlloc, Layout, System};

/// The system allocator, which counts the calls of each thread.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // Calls are not counted while the thread ends.
    let _ = CALLS.try_with(|calls| calls.set(calls.get() + 1));
}

// SAFETY: every call is passed unchanged to the system allocator. Counting neither allocates nor unwinds: the counter
// is a plain number that is initialised at compile time.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller guarantees what `System` requires.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `System` with this layout, as the caller guarantees.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count();
        // SAFETY: as for `dealloc`; the caller guarantees a valid size.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The number of allocations of this thread during `work`.
fn allocations(work: impl FnOnce()) -> usize {
    let before = CALLS.get();
    work();
    CALLS.get() - before
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(std::hint::black_box(vec![0_u8; 100]))), 1);
}

#[test]
fn sensing_does_not_allocate() {
    let mut builder = SceneBuilder::new();
    let moving = scenery(&mut builder);
    let mut workspace = WorkspaceBuf::default();
    let camera = Camera::new(camera().edges(Edges::Smooth)).unwrap();
    let depth_camera =
        DepthCamera::new(depth_camera().model(published::icl_nuim().matching(published::D4XX_MATCHING)))
            .unwrap();
    let lidar = Lidar::new(LIDAR).unwrap();
    let mut pixels = vec![0; camera.frame_len()];
    let mut colour = vec![0; camera.frame_len()];
    let mut metres = vec![0.0; depth_camera.pixels()];
    let mut millimetres = vec![0; depth_camera.pixels()];
    let mut points = vec![0; depth_camera.pixels() * POINT_STEP];
    let (mut ranges, mut intensities) = (vec![0.0; lidar.beams()], vec![0.0; lidar.beams()]);

    let lasers: Vec<_> = (0..16).map(|row| Laser::at_degrees(2.0 * f64::from(row) - 15.0, 0.0)).collect();
    let columns = Columns::Turn { per_turn: 90, first: 0, count: 90 };
    let head = Spinning { lasers: &lasers, columns, first_azimuth_rad: 0.0, clockwise: false };
    let scanner = Scanner::new(ScannerConfig::new(Pattern::Spinning(head))).unwrap();
    let mut fired = vec![0.0; scanner.most_firings()];
    let wide = ScannerConfig::new(Pattern::Spinning(head))
        .beam(Beam { divergence_rad: [3e-3; 2], aperture_m: [0.01; 2], rays: 19 })
        .returns(Returns::Several(5))
        .weather(Weather { visibility_m: 50.0, rain_mm_per_h: 30.0, snow_mm_per_h: 3.0 });
    let wide = Scanner::new(wide).unwrap();
    let mut returned = vec![0.0; 5 * wide.most_firings()];

    let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(Pose::IDENTITY)));
    let keyframes = [0.0, 0.05, 0.1].map(|time_s| Keyframe { time_s, at: builder.moment(Pose::IDENTITY) });
    for len in [
        scanner.workspace_len(&scene, &Capture::new(0, &keyframes[..])),
        camera.workspace_len(&scene, &capture),
        depth_camera.workspace_len(&scene, &capture),
        lidar.workspace_len(&scene, &capture),
    ] {
        workspace.lend(len);
    }
    for frame in 0..3 {
        let pose = Pose::from_translation(glam::DVec3::new(-3.0 + 0.1 * frame as f64, 0.2, 0.5));
        let calls = allocations(|| {
            builder.set_pose(moving, pose.inverse()).unwrap();
            let (scene, capture) = (builder.scene(), Capture::new(frame, builder.moment(pose)));
            camera
                .sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(camera.workspace_len(&scene, &capture)),
                    Picture::new().colour(&mut pixels),
                )
                .expect("outputs of the right size");
            let output = DepthFrame::new()
                .depth_32fc1(&mut metres)
                .depth_16uc1(&mut millimetres)
                .colour(&mut colour)
                .points(&mut points);
            depth_camera
                .sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(depth_camera.workspace_len(&scene, &capture)),
                    output,
                )
                .expect("outputs of the right size");
            lidar
                .sense(
                    &scene,
                    &capture,
                    &mut workspace.lend(lidar.workspace_len(&scene, &capture)),
                    Scan::new().ranges(&mut ranges).intensities(&mut intensities),
                )
                .expect("outputs of the right size");
            let keyframes = [0.0, 0.05, 0.1].map(|time_s| Keyframe { time_s, at: builder.moment(pose) });
            let capture = Capture::new(frame, &keyframes[..]);
            let memory = &mut workspace.lend(scanner.workspace_len(&scene, &capture));
            scanner
                .sense(&scene, &capture, memory, Echoes::new().ranges(&mut fired))
                .expect("outputs of the right size");
            let memory = &mut workspace.lend(wide.workspace_len(&scene, &capture));
            wide.sense(&scene, &capture, memory, Echoes::new().ranges(&mut returned))
                .expect("outputs of the right size");
        });
        assert_eq!(calls, 0, "frame {frame}");
    }
}

#[test]
fn tables_of_rays_do_not_allocate() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let (scene, moment) = (builder.scene(), builder.moment(Pose::IDENTITY));
    let (width, height) = (90, 60);
    let directions: Vec<_> = (0..width * height)
        .map(|ray| glam::Vec3::new(0.2, (ray % width) as f32 - 44.5, (ray / width) as f32 - 29.5))
        .map(|direction| direction.normalize().to_array())
        .collect();
    let mut buffer = vec![CacheLine::ZERO; RayTable::required_len(width, height)];
    let mut distances = vec![0.0; directions.len()];
    let mut workspace = WorkspaceBuf::default();
    // Frames of a table need the memory of a pinhole's of the same size.
    let pinhole = Optics::from(PinholeGrid::from_fov(width, height, 1.0).unwrap());
    workspace.lend(grid_workspace_len(&scene, &pinhole));
    let calls = allocations(|| {
        let table = RayTable::build(width, height, &directions, &mut buffer).unwrap();
        let grid = Optics::Table(table);
        cast_grid(
            &scene,
            &moment,
            &grid,
            [0.0, f64::INFINITY],
            visibility::VISUAL,
            Faces::Both,
            &mut workspace.lend(grid_workspace_len(&scene, &grid)),
            Hits { distance: Some(&mut distances), ..Hits::default() },
        )
        .unwrap();
    });
    assert_eq!(calls, 0);
    assert!(distances.iter().any(|distance| distance.is_finite()));
}

// The host of host.c in Rust: streams samples, then draws a surface along a path.
use std::ffi::CStr;
use std::os::raw::c_char;
use std::ptr::{null, null_mut};

#[repr(C)]
#[derive(Default)]
struct Settings {
    size: u32,
    sectors: i32,
    bit_diameter: f64,
    pitch: f64,
    start_depth: f64,
    stop_depth: f64,
    start_toolface: f64,
    integers: [i64; 2],  // window, most_vertices
    numbers: [f64; 6],   // power, max_distance, tolerance, angular_scale, kriging_range, nugget
    choices: [i32; 6],   // neighbors, max_iterations, estimator, direct, threads, instruction_set
}

#[repr(C)]
#[derive(Default)]
struct PathSettings {
    size: u32,
    choices: [i32; 3],  // method, reference, reserved
    numbers: [f64; 4],  // head, extend
}

#[repr(C)]
#[derive(Default)]
struct Change {
    size: u32,
    reserved: i32,
    ranges: i64,
    settled: i64,
    accepted: i64,
    redundant: i64,
}

#[repr(C)]
#[derive(Default)]
struct State {
    size: u32,
    reserved: i32,
    vertices: i64,
    samples: i64,
    settled: i64,
    start_depth: f64,
}

#[link(name = "helibore")]
extern "C" {
    fn hb_last_error() -> *const c_char;
    fn hb_close(handle: i64) -> i32;
    fn hb_settings_init(settings: *mut Settings) -> i32;
    fn hb_path_settings_init(settings: *mut PathSettings) -> i32;
    fn hb_wall_create(settings: *const Settings, wall: *mut i64) -> i32;
    fn hb_wall_append(wall: i64, n: i64, depth: *const f64, toolface: *const f64, radius: *const f64,
                      time: *const f64, change: *mut Change) -> i32;
    fn hb_wall_get(wall: i64, state: *mut State) -> i32;
    fn hb_path_create(settings: *const PathSettings, n: i64, depth: *const f64, inclination: *const f64,
                      azimuth: *const f64, path: *mut i64) -> i32;
    fn hb_wall_surface(wall: i64, path: i64, start: i64, stop: i64, vertex_count: *mut i64, vertices: *mut f64,
                       vertex_index: *mut i64, quad_count: *mut i64, quads: *mut i64) -> i32;
}

fn last_error() -> String {
    unsafe { CStr::from_ptr(hb_last_error()).to_string_lossy().into_owned() }
}

fn check(status: i32) {
    assert!(status == 0, "{}", last_error());
}

fn main() {
    let mut settings = Settings { size: std::mem::size_of::<Settings>() as u32, ..Default::default() };
    let (mut wall, mut path, mut rows, mut quad_count) = (0i64, 0i64, 0i64, 0i64);
    unsafe {
        check(hb_settings_init(&mut settings));
        settings.bit_diameter = 0.216;
        settings.sectors = 32;
        settings.start_depth = 1000.0;
        check(hb_wall_create(&settings, &mut wall));

        let mut toolface: Vec<f64> = (0..1000).map(|i| (i * 37 % 360) as f64).collect();
        let (mut depth, mut radius) = (vec![], vec![]);
        for packet in 0..5 {
            depth = (0..1000).map(|i| (1000 + packet) as f64 + i as f64 * 0.001).collect();
            radius = vec![if packet == 2 { 0.11 + 0.02 } else { 0.11 }; 1000];
            let mut change = Change { size: std::mem::size_of::<Change>() as u32, ..Default::default() };
            check(hb_wall_append(wall, 1000, depth.as_ptr(), toolface.as_ptr(), radius.as_ptr(), null(), &mut change));
            println!("{} samples, {} changed ranges, settled to {}", change.accepted, change.ranges, change.settled);
        }

        let mut how = PathSettings { size: std::mem::size_of::<PathSettings>() as u32, ..Default::default() };
        check(hb_path_settings_init(&mut how));
        let (at, inclination, azimuth) = ([0.0, 500.0, 1100.0], [0.0, 10.0, 35.0], [40.0, 40.0, 55.0]);
        check(hb_path_create(&how, 3, at.as_ptr(), inclination.as_ptr(), azimuth.as_ptr(), &mut path));
        let mut state = State { size: std::mem::size_of::<State>() as u32, ..Default::default() };
        check(hb_wall_get(wall, &mut state));
        hb_wall_surface(wall, path, 0, state.vertices, &mut rows, null_mut(), null_mut(), &mut quad_count, null_mut());
        let (mut vertices, mut quads) = (vec![0.0; 3 * rows as usize], vec![0i64; 4 * quad_count as usize]);
        check(hb_wall_surface(wall, path, 0, state.vertices, &mut rows, vertices.as_mut_ptr(), null_mut(),
                              &mut quad_count, quads.as_mut_ptr()));
        println!("{} vertices, {} quads, first at {:.6} {:.6} {:.6}", rows, quad_count, vertices[0], vertices[1],
                 vertices[2]);

        toolface[17] = f64::NEG_INFINITY;
        assert!(hb_wall_append(wall, 1000, depth.as_ptr(), toolface.as_ptr(), radius.as_ptr(), null(), null_mut()) == 1);
        println!("{}", last_error());
        check(hb_close(path));
        check(hb_close(wall));
    }
}

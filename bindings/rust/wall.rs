// A floor that the hand touches from above, in Rust without a crate. Prints what is felt.
//     rustc -O wall.rs -l knurl && ./wall 30

use std::ffi::{c_char, c_int, c_void, CStr};
use std::ptr::{null, null_mut};

#[repr(C)]
struct Device { size: u64, texts: [u8; 320], rate: f64, centre: [f64; 3], rest: [u64; 5] }

#[repr(C)] // knurl_plane: its first members; the others keep their defaults
struct Plane { size: u64, normal: [f64; 3], offset: f64, update: u32, combine: u32, velocity: [f64; 3], stiffness: f64, rest: [u64; 21] }

#[repr(C)]
struct Feedback { size: u64, force: [f64; 3], rest: [f64; 8], share: f64, damping_share: f64, cycle: u64, flags: u32, reserved: u32 }

extern "C" {
    fn knurl_connect(address: *const c_char, options: *const c_void, out: *mut *mut c_void) -> c_int;
    fn knurl_claim(client: *mut c_void, device: *const c_char, options: *const c_void, out: *mut *mut c_void) -> c_int;
    fn knurl_device_of(hand: *const c_void, out: *mut Device) -> c_int;
    fn knurl_default(kind: u32, params: *mut c_void, size: u64) -> c_int;
    fn knurl_add(hand: *mut c_void, kind: u32, params: *const c_void, options: *const c_void, id: *mut u64) -> c_int;
    fn knurl_arm(hand: *mut c_void) -> c_int;
    fn knurl_commit(hand: *mut c_void, number: *mut u64) -> c_int;
    fn knurl_wait_applied(hand: *mut c_void, number: u64, timeout_ns: i64) -> c_int;
    fn knurl_feedback_of(hand: *mut c_void, id: u64, out: *mut Feedback) -> c_int;
    fn knurl_close(handle: *mut c_void) -> c_int;
    fn knurl_error(handle: *const c_void) -> *const c_char;
}

fn check(code: c_int) -> c_int {
    assert!(code >= 0, "{}", unsafe { CStr::from_ptr(knurl_error(null())) }.to_string_lossy());
    code
}

fn main() {
    let seconds = std::env::args().nth(1).map_or(30.0, |text| text.parse().unwrap());
    let (mut client, mut hand, mut id, mut most) = (null_mut(), null_mut(), 0u64, 0f64);
    unsafe {
        check(knurl_connect(null(), null(), &mut client));
        check(knurl_claim(client, null(), null(), &mut hand));
        let mut device = Device { size: std::mem::size_of::<Device>() as u64, ..std::mem::zeroed() };
        check(knurl_device_of(hand, &mut device));
        let mut floor: Plane = std::mem::zeroed();
        check(knurl_default(0, &mut floor as *mut Plane as *mut c_void, std::mem::size_of::<Plane>() as u64));
        floor.offset = device.centre[2] + 0.002; // m: the hand at rest is 2 mm within
        floor.stiffness = 800.0; // N/m
        check(knurl_add(hand, 0, &floor as *const Plane as *const c_void, null(), &mut id));
        check(knurl_arm(hand));
        let start = std::time::Instant::now();
        while start.elapsed().as_secs_f64() < seconds {
            let mut felt = Feedback { size: std::mem::size_of::<Feedback>() as u64, ..std::mem::zeroed() };
            check(knurl_commit(hand, null_mut()));
            check(knurl_wait_applied(hand, 0, 50_000_000));
            if check(knurl_feedback_of(hand, id, &mut felt)) == 0 { most = most.max(felt.force[2] * felt.share) }
        }
        check(knurl_close(client));
    }
    println!("felt up to {most:.2} N");
}

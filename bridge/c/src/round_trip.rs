//! Tests of the C functions, called as from C, against a publisher in Rust.

use std::{
    ffi::{CStr, CString},
    ptr::{null, null_mut},
};

use belvedere_bridge::{
    Domain, Encoding, FrameHeader, Kind, Publisher, StreamSpec, Text,
    payload::{
        self, CameraInfo, MotorPower, ResetOdometry, SimulationCommand, SimulationResult, VelocityCommand,
    },
};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::{
    command::{
        bv_command_close, bv_command_open, bv_command_send, bv_velocity_close, bv_velocity_open,
        bv_velocity_send,
    },
    control::{bv_control_call, bv_control_close, bv_control_open},
    frame::{bv_frame_get_header, bv_frame_get_payload, bv_frame_missed, bv_frame_release},
    node::{bv_node_close, bv_node_open, bv_streams, bv_streams_free},
    status::{Status, bv_last_error, guard},
    subscriber::{
        bv_subscribe, bv_subscriber_close, bv_subscriber_fd, bv_subscriber_set_busy_poll, bv_subscriber_take,
        bv_subscriber_wait,
    },
    synchronizer::{
        bv_synchronizer_close, bv_synchronizer_open, bv_synchronizer_skipped, bv_synchronizer_take,
        bv_synchronizer_wait,
    },
};

fn last_error() -> String {
    // SAFETY: NUL-terminated, valid until the next failing call in this thread.
    unsafe { CStr::from_ptr(bv_last_error()) }.to_str().unwrap().to_owned()
}

#[test]
fn frames_and_commands_arrive() {
    let name = format!("c-{}", std::process::id());
    let domain = Domain::new(&name).unwrap();
    let rust = belvedere_bridge::Node::open(&domain, "test").unwrap();
    let publisher =
        rust.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Mono8, 12).rate_hz(5.0)).unwrap();
    let commands_spec = StreamSpec::velocity_command("cmd_vel");
    let mut commands = rust.command_subscriber(&commands_spec).unwrap();
    let name = CString::new(name).unwrap();
    let (mut node, mut subscriber, mut frame, mut velocity) =
        (null_mut(), null_mut(), null_mut(), null_mut());
    let (mut streams, mut count) = (null_mut(), 0);
    // SAFETY: handles are used between their creation and their closing; texts are NUL-terminated; out pointers point
    // to local variables.
    unsafe {
        assert_eq!(
            bv_node_open(name.as_ptr(), c"test".as_ptr(), &raw mut node),
            Status::Ok,
            "{}",
            last_error()
        );
        assert_eq!(bv_subscribe(node, c"/image".as_ptr(), &raw mut subscriber), Status::Ok);
        assert_eq!(bv_subscriber_set_busy_poll(subscriber, 1000), Status::Ok);
        assert_eq!(bv_subscriber_wait(subscriber, 10), Status::Nothing);
        assert_eq!(bv_subscriber_take(subscriber, &raw mut frame), Status::Nothing);
        assert!(frame.is_null());

        let mut loaned = publisher.loan(12).unwrap();
        loaned.header_mut().set_packed(4, 3);
        loaned.payload_mut().fill(9);
        loaned.send().unwrap();
        assert_eq!(bv_subscriber_wait(subscriber, 10_000), Status::Ok);
        assert_eq!(bv_subscriber_take(subscriber, &raw mut frame), Status::Ok);
        let header = &*bv_frame_get_header(frame);
        assert_eq!((header.magic, header.width, header.height, header.kind), (FrameHeader::MAGIC, 4, 3, 1));
        let payload = std::slice::from_raw_parts(bv_frame_get_payload(frame), header.payload_len as usize);
        assert_eq!(payload, [9; 12]);
        assert_eq!(bv_frame_missed(frame), 0);

        assert_eq!(bv_streams(node, &raw mut streams, &raw mut count), Status::Ok);
        let listed = std::slice::from_raw_parts(streams, count);
        let topics: Vec<_> = listed.iter().map(|stream| CStr::from_ptr(stream.topic.as_ptr())).collect();
        assert_eq!(topics, [c"cmd_vel", c"image"]);
        assert_eq!((listed[1].rate_hz, listed[1].kind, listed[1].subscribers), (5.0, 1, 1));
        bv_streams_free(streams, count);

        assert_eq!(bv_velocity_open(node, c"cmd_vel".as_ptr(), &raw mut velocity), Status::Ok);
        let command = VelocityCommand { linear: [0.5, 0.0, 0.0], angular: [0.0, 0.0, -1.0] };
        assert_eq!(bv_velocity_send(velocity, &raw const command), Status::Ok);

        let command: payload::VelocityCommand = commands.take_newest().unwrap().unwrap().message().unwrap();
        assert_eq!((command.linear[0], command.angular[2]), (0.5, -1.0));

        bv_velocity_close(velocity);
        bv_node_close(node);
        bv_subscriber_close(subscriber);
        bv_frame_release(frame);
    }
}

/// All coefficients of a lens arrive, in an image and in its camera_info.
#[test]
fn lens_coefficients_arrive() {
    let name = format!("cl-{}", std::process::id());
    let rust = belvedere_bridge::Node::open(&Domain::new(&name).unwrap(), "test").unwrap();
    let pictures = rust.publisher(&StreamSpec::new("image", Kind::Image, Encoding::Mono8, 1)).unwrap();
    let infos = rust.publisher(&StreamSpec::structs("info", Kind::CameraInfo, 1)).unwrap();
    let parameters: [f64; 14] = std::array::from_fn(|index| 0.1 * index as f64 - 0.5);
    let name = CString::new(name).unwrap();
    let (mut node, mut subscriber, mut frame) = (null_mut(), null_mut(), null_mut());
    // SAFETY: as above.
    unsafe {
        assert_eq!(bv_node_open(name.as_ptr(), c"test".as_ptr(), &raw mut node), Status::Ok);
        assert_eq!(bv_subscribe(node, c"image".as_ptr(), &raw mut subscriber), Status::Ok);
        assert_eq!(bv_subscriber_wait(subscriber, 10), Status::Nothing);
        for count in [0, 4, 5, 8, 12, 14] {
            let mut lens = belvedere_bridge::Intrinsics { fx: 300.0, skew: 0.5, ..Default::default() };
            lens.set_distortion(belvedere_bridge::DistortionModel::RationalPolynomial, &parameters[..count]);
            let mut loaned = pictures.loan(1).unwrap();
            loaned.header_mut().set_packed(1, 1);
            loaned.header_mut().set_intrinsics(&lens);
            loaned.send().unwrap();
            assert_eq!(bv_subscriber_wait(subscriber, 10_000), Status::Ok);
            assert_eq!(bv_subscriber_take(subscriber, &raw mut frame), Status::Ok);
            let block = *(*bv_frame_get_header(frame)).intrinsics().unwrap();
            assert_eq!((block.fx, block.skew, block.distortion_model), (300.0, 0.5, 2));
            assert_eq!(block.distortion[..block.distortion_len.into()], parameters[..count]);
            assert_eq!(block.distortion[count..], [0.0; 14][count..]);
            bv_frame_release(frame);
        }
        bv_subscriber_close(subscriber);
        let mut info = <payload::CameraInfo as bytemuck::Zeroable>::zeroed();
        (info.d, info.d_len, info.p[11]) = (parameters, 14, 7.0);
        info.distortion_model = belvedere_bridge::Text::new("rational_polynomial").unwrap();
        assert_eq!(bv_subscribe(node, c"info".as_ptr(), &raw mut subscriber), Status::Ok);
        assert_eq!(bv_subscriber_wait(subscriber, 10), Status::Nothing);
        infos.send_structs(0, &[info]).unwrap();
        assert_eq!(bv_subscriber_wait(subscriber, 10_000), Status::Ok);
        assert_eq!(bv_subscriber_take(subscriber, &raw mut frame), Status::Ok);
        let read = bv_frame_get_payload(frame).cast::<std::ffi::c_void>().cast::<CameraInfo>().read();
        assert_eq!(read.distortion_model.as_str(), "rational_polynomial");
        assert_eq!((read.d, read.d_len, read.p[11]), (parameters, 14, 7.0));
        bv_frame_release(frame);
        bv_subscriber_close(subscriber);
        bv_node_close(node);
    }
}

/// Each kind of command is accepted as its struct, and as nothing else.
#[test]
fn commands_are_accepted_as_their_struct_only() {
    let name = format!("ct-{}", std::process::id());
    let rust = belvedere_bridge::Node::open(&Domain::new(&name).unwrap(), "test").unwrap();
    let receiver = |topic, kind| rust.command_subscriber(&StreamSpec::command(topic, kind)).unwrap();
    let (mut powers, mut resets) =
        (receiver("power", Kind::MotorPower), receiver("reset", Kind::ResetOdometry));
    let name = CString::new(name).unwrap();
    let (mut node, mut power, mut reset) = (null_mut(), null_mut(), null_mut());
    // SAFETY: as above; sizes are those of what is pointed to, or smaller.
    unsafe {
        assert_eq!(bv_node_open(name.as_ptr(), c"test".as_ptr(), &raw mut node), Status::Ok);
        assert_eq!(
            bv_command_open(node, c"power".as_ptr(), 19, &raw mut power),
            Status::Ok,
            "{}",
            last_error()
        );
        assert_eq!(
            bv_command_open(node, c"reset".as_ptr(), 18, &raw mut reset),
            Status::Ok,
            "{}",
            last_error()
        );
        let off = MotorPower { state: 7 };
        assert_eq!(bv_command_send(power, (&raw const off).cast(), size_of_val(&off)), Status::Ok);
        let zero = ResetOdometry { reserved: 0 };
        assert_eq!(bv_command_send(reset, (&raw const zero).cast(), size_of_val(&zero)), Status::Ok);
        let got: payload::MotorPower = powers.take().unwrap().unwrap().message().unwrap();
        assert_eq!(got.state, 7);
        let got: payload::ResetOdometry = resets.take().unwrap().unwrap().message().unwrap();
        assert_eq!(got.reserved, 0);

        assert_eq!(bv_command_send(power, (&raw const off).cast(), 3), Status::InvalidArgument);
        assert_eq!(last_error(), "size is 3, but a command of power has 4 bytes");
        assert_eq!(bv_command_send(power, null(), 4), Status::InvalidArgument);
        let mut none = null_mut();
        for kind in [0, 1, 14, 9999] {
            assert_eq!(
                bv_command_open(node, c"power".as_ptr(), kind, &raw mut none),
                Status::InvalidArgument
            );
            assert!(none.is_null() && last_error().contains("BV_KIND_MOTOR_POWER"), "{}", last_error());
        }
        bv_command_close(power);
        bv_command_close(reset);
        bv_command_close(null_mut());
        bv_node_close(node);
    }
}

/// The simulator refuses every command, with the text that it was sent.
#[test]
fn a_simulation_is_controlled() {
    let name = format!("cc-{}", std::process::id());
    let rust = belvedere_bridge::Node::open(&Domain::new(&name).unwrap(), "test").unwrap();
    let mut commands = rust.command_subscriber(&StreamSpec::simulation_command(0)).unwrap();
    let results = rust.publisher(&StreamSpec::simulation_result()).unwrap();
    let simulator = std::thread::spawn(move || {
        assert!(commands.wait(std::time::Duration::from_secs(20)).unwrap());
        let frame = commands.take().unwrap().unwrap();
        let command: payload::SimulationCommand = frame.message().unwrap();
        assert!(command.id != 0 && command.text_len == 5 && command.position == [1.0, 2.0, 3.0]);
        let text = std::str::from_utf8(&frame.payload()[size_of::<payload::SimulationCommand>()..]).unwrap();
        let result = payload::SimulationResult {
            id: command.id,
            time_ns: 7,
            done: 0,
            operation: command.operation,
            reserved: 0,
            reason: belvedere_bridge::Text::new(&format!("{} {text}", command.name)).unwrap(),
        };
        results.send_structs(7, &[result]).unwrap();
        results
    });
    let name = CString::new(name).unwrap();
    let (mut node, mut control) = (null_mut(), null_mut());
    // SAFETY: as above; all fields of the structs are numbers, for which zeros are valid.
    unsafe {
        assert_eq!(bv_node_open(name.as_ptr(), c"test".as_ptr(), &raw mut node), Status::Ok);
        assert_eq!(bv_control_open(node, &raw mut control), Status::Ok);
        let mut command: SimulationCommand = std::mem::zeroed();
        let mut result: SimulationResult = std::mem::zeroed();
        (command.operation, command.position) = (7, [1.0, 2.0, 3.0]);
        command.name = Text::new("n").unwrap();
        let (command, result) = (&raw const command, &raw mut result);
        assert_eq!(bv_control_call(control, command, c"model".as_ptr(), 20_000, result), Status::Ok);
        assert_eq!(((*result).done, (*result).operation, (*result).time_ns), (0, 7, 7));
        assert_eq!(CStr::from_ptr((&raw const (*result).reason).cast()), c"n model");
        drop(simulator.join().unwrap());
        assert_eq!(bv_control_call(control, command, null(), 50, result), Status::Nothing);
        bv_control_close(control);
        bv_node_close(node);
    }
}

fn send(publisher: &Publisher, stamp_ns: u64) {
    let mut loaned = publisher.loan(12).unwrap();
    loaned.header_mut().set_packed(4, 3);
    loaned.header_mut().stamp_ns = stamp_ns;
    loaned.payload_mut().fill(9);
    loaned.send().unwrap();
}

#[test]
fn poll_and_sets_of_equal_stamps() {
    let name = format!("cs-{}", std::process::id());
    let rust = belvedere_bridge::Node::open(&Domain::new(&name).unwrap(), "test").unwrap();
    let [rgb, depth] = ["rgb", "depth"]
        .map(|topic| rust.publisher(&StreamSpec::new(topic, Kind::Image, Encoding::Mono8, 12)).unwrap());
    let name = CString::new(name).unwrap();
    let topics = [c"rgb".as_ptr(), c"depth".as_ptr()];
    let (mut node, mut subscriber, mut sets, mut fd) = (null_mut(), null_mut(), null_mut(), -1);
    let mut frames = [null_mut(); 2];
    // SAFETY: as above; the descriptor is that of a subscriber that is open.
    unsafe {
        assert_eq!(bv_node_open(name.as_ptr(), c"test".as_ptr(), &raw mut node), Status::Ok);
        assert_eq!(bv_subscribe(node, c"depth".as_ptr(), &raw mut subscriber), Status::Ok);
        assert_eq!(bv_subscriber_fd(subscriber, &raw mut fd), Status::Ok);
        let open = |count, sets| bv_synchronizer_open(node, topics.as_ptr(), count, 0, sets);
        assert_eq!(open(1, &raw mut sets), Status::InvalidArgument);
        assert_eq!(last_error(), "1 streams: a set is of 2 to 8");
        assert_eq!(open(2, &raw mut sets), Status::Ok);
        // Connects; frames that were sent earlier arrive with the publisher's next frame only.
        let mut frame = null_mut();
        assert_eq!(bv_synchronizer_take(sets, frames.as_mut_ptr()), Status::Nothing);
        assert_eq!(bv_subscriber_take(subscriber, &raw mut frame), Status::Nothing);

        send(&rgb, 7);
        send(&rgb, 8);
        send(&depth, 8);
        assert_eq!(bv_synchronizer_wait(sets, 10_000), Status::Ok);
        assert_eq!(bv_synchronizer_take(sets, frames.as_mut_ptr()), Status::Ok);
        assert_eq!(frames.map(|frame| (*bv_frame_get_header(frame)).stamp_ns), [8, 8]);
        assert_eq!(bv_synchronizer_skipped(sets), 1);
        bv_synchronizer_close(sets);
        for frame in frames {
            bv_frame_release(frame);
        }

        let descriptor = std::os::fd::BorrowedFd::borrow_raw(fd);
        let mut fds = [PollFd::from_borrowed_fd(descriptor, PollFlags::IN)];
        assert_eq!(poll(&mut fds, Some(&Timespec { tv_sec: 10, tv_nsec: 0 })).unwrap(), 1);
        assert_eq!(bv_subscriber_take(subscriber, &raw mut frame), Status::Ok);
        assert_eq!((*bv_frame_get_header(frame)).stamp_ns, 8);
        bv_frame_release(frame);
        bv_subscriber_close(subscriber);
        bv_node_close(node);
    }
}

#[test]
fn errors_are_codes_with_messages() {
    let (mut node, mut subscriber) = (null_mut(), null_mut());
    // SAFETY: null pointers are allowed everywhere; the rest as above.
    unsafe {
        assert_eq!(bv_node_open(c"a/b".as_ptr(), c"x".as_ptr(), &raw mut node), Status::InvalidName);
        assert!(last_error().contains("a/b"), "{}", last_error());
        assert_eq!(bv_node_open(null_mut(), null_mut(), &raw mut node), Status::InvalidArgument);
        assert_eq!(bv_node_open(null_mut(), c"\xff".as_ptr(), &raw mut node), Status::InvalidArgument);
        assert_eq!(bv_subscribe(null_mut(), c"x".as_ptr(), &raw mut subscriber), Status::InvalidArgument);
        assert!(last_error().contains("null"), "{}", last_error());
        assert_eq!(bv_subscriber_wait(null_mut(), 1), Status::InvalidArgument);
        assert_eq!(bv_subscriber_set_busy_poll(null_mut(), 1), Status::InvalidArgument);
        assert_eq!(bv_subscriber_take(null_mut(), null_mut()), Status::InvalidArgument);
        assert!(bv_frame_get_header(null_mut()).is_null());
        bv_frame_release(null_mut());
        bv_subscriber_close(null_mut());
        bv_node_close(null_mut());
    }
}

#[test]
fn a_panic_becomes_a_status() {
    assert_eq!(guard(|| panic!("on purpose")), Status::Internal);
    assert!(last_error().contains("report"), "{}", last_error());
}

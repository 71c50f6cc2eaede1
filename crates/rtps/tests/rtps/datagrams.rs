//! A participant goes on, whatever comes to its ports.

use std::net::UdpSocket;
use std::time::Duration;

use belvedere_rtps::Qos;

use crate::participants::{domain, join, topic};

#[test]
fn a_participant_goes_on_after_nonsense() {
    let domain = domain(5);
    let ours = join(domain, "writer");
    let topic = topic();
    let writer = ours.writer(topic, Qos::latched()).expect("a writer");
    writer.write(vec![0, 1, 0, 0, 7, 7, 7, 7]);
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let first = 7400 + 250 * domain as u16 + 10;
    let mut random: u64 = 1;
    for number in 0..20_000 {
        let mut datagram = b"RTPS\x02\x03\x01\x0F".to_vec();
        let head = [0, 4, 8, 20][number % 4];
        datagram.resize(20 + number % 300, 0);
        for byte in &mut datagram[head.min(20)..] {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            *byte = (random >> 56) as u8;
        }
        // A kind of submessage that exists.
        if datagram.len() > 24 {
            datagram[20] = [0x06, 0x07, 0x08, 0x0E, 0x12, 0x15, 0x16][number % 7];
        }
        // A datagram that finds no room is lost, which is as well.
        let _ = socket.send_to(&datagram, ("127.0.0.1", first + (number % 2) as u16));
    }
    let theirs = join(domain, "reader");
    let reader = theirs.reader(topic, Qos::latched(), 100).expect("a reader");
    assert_eq!(reader.take(Duration::from_secs(60)), Some(vec![0, 1, 0, 0, 7, 7, 7, 7]));
}

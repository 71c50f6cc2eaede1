//! A program that serves the page, and the client side of a page, for tests.
#![allow(dead_code, reason = "each test takes what it needs")]

use crate::live::{PATIENCE, belvedere};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tungstenite::protocol::Role;
use tungstenite::{Message, WebSocket};

/// A program that serves the page, which is stopped when dropped.
pub(crate) struct Server {
    pub(crate) child: Child,
    /// 127.0.0.1:PORT.
    pub(crate) host: String,
    pub(crate) token: String,
}

impl Server {
    pub(crate) fn start(mut command: Command) -> Self {
        Self::of(command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap())
    }

    /// A server that has been started with its output as a pipe.
    pub(crate) fn of(mut child: Child) -> Self {
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let url =
            lines.find_map(|line| line.unwrap().strip_prefix("page: http://").map(str::to_owned)).unwrap();
        let (host, token) = url.split_once("/?token=").unwrap();
        Self { host: host.to_owned(), token: token.to_owned(), child }
    }

    /// The simulator with its page.
    pub(crate) fn run(domain: &str, arguments: &[&str]) -> Self {
        let mut command = belvedere();
        command.args(["run", "--view", "--no-browser", "--domain", domain]).args(arguments);
        if !arguments.contains(&"--port") {
            command.args(["--port", "0"]);
        }
        Self::start(command)
    }

    /// A page server in addition to a simulator.
    pub(crate) fn view(domain: &str) -> Self {
        let mut command = belvedere();
        command.args(["view", "--wait", "--no-browser", "--port", "0", "--domain", domain]);
        Self::start(command)
    }

    /// A recording that is played with its page.
    pub(crate) fn view_recording(domain: &str, file: &Path) -> Self {
        let mut command = belvedere();
        command.arg("view").arg(file).args(["--no-browser", "--port", "0", "--domain", domain]);
        Self::start(command)
    }

    /// Sends a request and returns the raw answer.
    pub(crate) fn ask(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    pub(crate) fn get(&self, target: &str) -> String {
        self.ask(&format!("GET {target} HTTP/1.1\r\nHost: {}\r\n\r\n", self.host))
    }

    pub(crate) fn page(&self) -> Page {
        self.connect("")
    }

    /// Opens a WebSocket with an additional header.
    pub(crate) fn connect(&self, header: &str) -> Page {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (host, token) = (&self.host, &self.token);
        let request = format!(
            "GET /?token={token} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             {header}Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        while !answer.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            answer.push(byte[0]);
        }
        let answer = String::from_utf8(answer).unwrap();
        // The answer for this key from RFC 6455.
        assert!(answer.contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), "{answer}");
        if let Some(offered) = header.strip_suffix("\r\n") {
            assert!(answer.contains(offered.split(", ").next().unwrap()), "{answer}");
        }
        Page { socket: WebSocket::from_raw_socket(stream, Role::Client, None), heard: Vec::new() }
    }

    pub(crate) fn kill(mut self) {
        kill_process(Pid::from_child(&self.child), Signal::KILL).unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Ok(None) = self.child.try_wait() {
            let _ = kill_process(Pid::from_child(&self.child), Signal::INT);
            let _ = self.child.wait();
        }
    }
}

/// The client side of a page's WebSocket.
pub(crate) struct Page {
    pub(crate) socket: WebSocket<TcpStream>,
    pub(crate) heard: Vec<Value>,
}

/// A frame of a stream, as sent to the page.
pub(crate) struct Shown {
    pub(crate) header: Value,
    pub(crate) payload: Vec<u8>,
}

impl Shown {
    /// Parses the format of `src/view/payload.rs`.
    pub(crate) fn parse(message: &[u8]) -> Self {
        let len = u32::from_le_bytes(message[..4].try_into().unwrap()) as usize;
        let header = serde_json::from_slice(&message[4..4 + len]).unwrap();
        Self { header, payload: message[4 + len..].to_vec() }
    }

    pub(crate) fn stamp(&self) -> u64 {
        self.header["stamp"].as_u64().unwrap()
    }
}

impl Page {
    pub(crate) fn say(&mut self, message: &Value) {
        self.socket.send(Message::text(message.to_string())).unwrap();
    }

    /// The next frame of a topic.
    pub(crate) fn next(&mut self, topic: &str) -> Shown {
        self.try_next(topic).unwrap()
    }

    /// The next frame of a topic, if it comes within the patience.
    pub(crate) fn try_next(&mut self, topic: &str) -> Option<Shown> {
        self.say(&json!({ "op": "next", "topic": topic }));
        loop {
            match self.socket.read().ok()? {
                Message::Binary(bytes) => {
                    let shown = Shown::parse(&bytes);
                    if shown.header["topic"] == topic {
                        return Some(shown);
                    }
                }
                Message::Text(text) => self.heard.push(serde_json::from_str(&text).unwrap()),
                _ => {}
            }
        }
    }

    /// The next binary message with this first byte.
    pub(crate) fn binary(&mut self, opcode: u8) -> Vec<u8> {
        loop {
            match self.socket.read().unwrap() {
                Message::Binary(bytes) if bytes[0] == opcode => return bytes.to_vec(),
                Message::Text(text) => self.heard.push(serde_json::from_str(&text).unwrap()),
                _ => {}
            }
        }
    }

    /// The next JSON message with this `op`.
    pub(crate) fn next_json(&mut self, op: &str) -> Value {
        loop {
            if let Some(place) = self.heard.iter().position(|message| message["op"] == op) {
                return self.heard.remove(place);
            }
            if let Message::Text(text) = self.socket.read().unwrap() {
                self.heard.push(serde_json::from_str(&text).unwrap());
            }
        }
    }

    pub(crate) fn control(&mut self, operation: &str) -> Value {
        self.say(&json!({ "op": "control", "id": 7, "operation": operation, "steps": 10 }));
        self.next_json("result")
    }
}

/// The position of a link in `simulation/link_states`.
pub(crate) fn position(states: &Shown, link: &str) -> [f64; 3] {
    let stride = states.header["rowStride"].as_u64().unwrap() as usize;
    let state = states.payload.chunks(stride).find(|state| state.starts_with(link.as_bytes())).unwrap();
    std::array::from_fn(|axis| f64::from_le_bytes(state[128 + 8 * axis..][..8].try_into().unwrap()))
}

//! A terminal in which a simulator runs: its screen, and the number of bytes written to it.

use super::{PATIENCE, belvedere};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use std::ffi::OsStr;
use std::fs::{File, OpenOptions};
use std::io::Read as _;
use std::os::unix::ffi::OsStrExt as _;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// `belvedere` in its own terminal.
pub(crate) struct Terminal {
    child: Child,
    master: File,
    shown: Arc<Mutex<Shown>>,
    reader: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shown {
    screen: Screen,
    bytes: u64,
}

impl Terminal {
    /// Runs a command in a terminal with this number of columns and rows.
    pub(crate) fn start(columns: usize, rows: usize, arguments: &[&str]) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let name = ptsname(&master, Vec::new()).unwrap();
        let slave =
            OpenOptions::new().read(true).write(true).open(OsStr::from_bytes(name.to_bytes())).unwrap();
        tcsetwinsize(&slave, window(columns, rows)).unwrap();
        let child = belvedere()
            .args(arguments)
            .stdout(Stdio::from(slave.try_clone().unwrap()))
            .stderr(Stdio::from(slave))
            .spawn()
            .expect("the simulator's binary runs");
        let shown = Arc::new(Mutex::new(Shown { screen: Screen::new(columns, rows), bytes: 0 }));
        let master = File::from(master);
        let (mut reading, theirs) = (master.try_clone().unwrap(), shown.clone());
        let reader = std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            // Reading fails once no process has the other end open.
            while let Ok(read) = reading.read(&mut bytes) {
                let mut shown = theirs.lock().unwrap();
                shown.bytes += read as u64;
                shown.screen.write(&bytes[..read]);
            }
        });
        Self { child, master, shown, reader: Some(reader) }
    }

    /// Changes the size, as if the user resized the window.
    pub(crate) fn resize(&self, columns: usize, rows: usize) {
        let mut shown = self.shown.lock().unwrap();
        tcsetwinsize(&self.master, window(columns, rows)).unwrap();
        shown.screen.resize(columns, rows);
    }

    /// The rows of the screen, without empty ones at the end.
    pub(crate) fn rows(&self) -> Vec<String> {
        self.shown.lock().unwrap().screen.text()
    }

    /// The number of bytes written so far.
    pub(crate) fn bytes(&self) -> u64 {
        self.shown.lock().unwrap().bytes
    }

    /// Waits until the rows of the screen fulfil a condition, and returns them.
    pub(crate) fn wait_until(&mut self, what: &str, holds: impl Fn(&[String]) -> bool) -> Vec<String> {
        let started = Instant::now();
        loop {
            let rows = self.rows();
            if holds(&rows) {
                return rows;
            }
            let ended = self.child.try_wait().unwrap();
            assert!(ended.is_none(), "{what}: it ended with {ended:?}:\n{}", rows.join("\n"));
            assert!(started.elapsed() < PATIENCE, "{what}:\n{}", rows.join("\n"));
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Sends Ctrl-C; returns the exit status and the final screen.
    pub(crate) fn interrupt(mut self) -> (ExitStatus, Vec<String>) {
        kill_process(Pid::from_child(&self.child), Signal::INT).unwrap();
        let status = self.child.wait().unwrap();
        self.reader.take().unwrap().join().unwrap();
        (status, self.rows())
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Ok(None) = self.child.try_wait() {
            let _ = kill_process(Pid::from_child(&self.child), Signal::INT);
            let _ = self.child.wait();
        }
    }
}

fn window(columns: usize, rows: usize) -> Winsize {
    Winsize { ws_col: columns as u16, ws_row: rows as u16, ws_xpixel: 0, ws_ypixel: 0 }
}

/// A terminal emulator for the escape codes that are used: those that move the cursor and those that erase.
#[derive(Default)]
struct Screen {
    columns: usize,
    rows: usize,
    lines: Vec<Vec<char>>,
    row: usize,
    column: usize,
    /// The beginning of an incomplete escape code or character.
    rest: Vec<u8>,
}

impl Screen {
    fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, lines: vec![Vec::new()], ..Self::default() }
    }

    fn text(&self) -> Vec<String> {
        let rows = self.lines.iter().map(|line| line.iter().collect::<String>().trim_end().to_owned());
        let mut rows: Vec<String> = rows.collect();
        while rows.last().is_some_and(String::is_empty) {
            rows.pop();
        }
        rows
    }

    fn write(&mut self, bytes: &[u8]) {
        self.rest.extend(bytes);
        let bytes = std::mem::take(&mut self.rest);
        let whole = match std::str::from_utf8(&bytes) {
            Ok(_) => bytes.len(),
            Err(error) => error.valid_up_to(),
        };
        let mut text = std::str::from_utf8(&bytes[..whole]).unwrap();
        while let Some(first) = text.chars().next() {
            let mut used = first.len_utf8();
            match first {
                '\x1b' => match text.find(|c: char| c.is_ascii_alphabetic()) {
                    Some(end) => {
                        used = end + 1;
                        let number = text[2..end].parse().unwrap_or(1);
                        self.obey(&text[end..=end], number);
                    }
                    None => break,
                },
                '\r' => self.column = 0,
                '\n' => self.next_row(),
                _ => self.put(first),
            }
            text = &text[used..];
        }
        self.rest = [text.as_bytes(), &bytes[whole..]].concat();
    }

    fn obey(&mut self, code: &str, number: usize) {
        match code {
            "A" => self.row = self.row.saturating_sub(number),
            "B" => self.row = (self.row + number).min(self.lines.len() - 1),
            "G" => self.column = number - 1,
            "J" => {
                self.lines.truncate(self.row + 1);
                self.lines[self.row].truncate(self.column);
            }
            "K" => self.lines[self.row].truncate(self.column),
            // Colours.
            "m" => {}
            _ => panic!("unknown escape code {code}"),
        }
    }

    fn put(&mut self, character: char) {
        if self.column >= self.columns {
            self.column = 0;
            self.next_row();
        }
        let line = &mut self.lines[self.row];
        line.resize(line.len().max(self.column + 1), ' ');
        line[self.column] = character;
        self.column += 1;
    }

    fn next_row(&mut self) {
        self.row += 1;
        if self.row == self.lines.len() {
            self.lines.push(Vec::new());
        }
        self.scroll();
    }

    /// Removes rows that have scrolled off the top.
    fn scroll(&mut self) {
        let above = self.lines.len().saturating_sub(self.rows);
        self.lines.drain(..above);
        self.row = self.row.saturating_sub(above);
    }

    /// Wraps rows that are too long, like most terminals.
    fn resize(&mut self, columns: usize, rows: usize) {
        (self.columns, self.rows) = (columns, rows);
        let wrap = |line: &Vec<char>| {
            let pieces = line.chunks(columns).map(<[char]>::to_vec);
            if line.is_empty() { vec![Vec::new()] } else { pieces.collect() }
        };
        let below = self.lines.len() - 1 - self.row;
        self.lines = self.lines.iter().flat_map(wrap).collect();
        self.row = self.lines.len() - 1 - below;
        self.column = self.column.min(columns);
        self.scroll();
    }
}

//! The table of a run in terminals of several sizes, while robots are spawned and deleted.

use crate::live::terminal::Terminal;
use crate::live::{PATIENCE, belvedere, output, own_domain};
use rustix::process::{Pid, Signal, kill_process};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

const THREE_ROBOTS: &[&str] = &[
    "--robot",
    "kobuki_hexagons_kinect",
    "--robot",
    "kobuki_nostack_rplidar",
    "--robot",
    "kobuki_nostack_camera",
    "--drive",
    "still",
];

/// Runs the simulator in a terminal.
fn run(columns: usize, rows: usize, arguments: &[&str]) -> (Terminal, String) {
    let domain = own_domain();
    let arguments = [&["run", "--domain", &domain], arguments].concat();
    (Terminal::start(columns, rows, &arguments), domain)
}

fn is_total(row: &str) -> bool {
    row.contains(" s simulated, real-")
}

/// Returns the rows of the table on a screen. There must be exactly one table, with nothing below it.
#[track_caller]
fn table(rows: &[String]) -> &[String] {
    let screen = rows.join("\n");
    let headings: Vec<usize> = (0..rows.len()).filter(|&row| rows[row].starts_with("TOPIC ")).collect();
    let [heading] = headings[..] else { panic!("{} tables:\n{screen}", headings.len()) };
    let table = &rows[heading..];
    assert!(is_total(table.last().unwrap()), "{screen}");
    let is_stream = |row: &String| row.starts_with('/') || row.starts_with("… ");
    assert!(table[1..table.len() - 1].iter().all(is_stream), "{screen}");
    table
}

#[test]
fn the_table_fits_into_terminals_of_all_sizes() {
    let many = [THREE_ROBOTS, &["--truth"]].concat();
    let sizes =
        [(80, 24, &[][..]), (70, 20, &[]), (80, 24, &["--truth"]), (80, 24, THREE_ROBOTS), (200, 60, &many)];
    // In parallel, because each mostly waits for the next table.
    std::thread::scope(|scope| {
        for (columns, rows, arguments) in sizes {
            scope.spawn(move || assert_fits(columns, rows, arguments));
        }
    });
}

#[track_caller]
fn assert_fits(columns: usize, rows: usize, arguments: &[&str]) {
    let (mut terminal, _) = run(columns, rows, arguments);
    let is_shown = |rows: &[String]| rows.last().is_some_and(|row| is_total(row));
    let first = terminal.wait_until("there is no table", is_shown);
    let mut shown = first.clone();
    let (bytes, since) = (terminal.bytes(), Instant::now());
    // Several times.
    for _ in 0..3 {
        let before = terminal.rows();
        shown = terminal.wait_until("the table is not updated", |rows| *rows != before && is_shown(rows));
    }
    let a_second = (terminal.bytes() - bytes) as f64 / since.elapsed().as_secs_f64();
    println!("{columns} x {rows}, {arguments:?}: {a_second:.0} bytes a second");
    assert!(a_second < 5000.0, "{columns} x {rows}: {a_second} bytes a second");
    let table = table(&shown);
    assert_eq!(table.len(), self::table(&first).len());
    let is_summed_up = table[table.len() - 2].starts_with("… ");
    if is_summed_up {
        assert_eq!((shown.len(), table.len()), (rows - 1, rows - 1), "{}", shown.join("\n"));
        assert!(table[table.len() - 2].ends_with(" more streams: belvedere list"));
    }
    let has_room = columns == 80 && arguments.is_empty();
    assert!(!(has_room && is_summed_up), "{}", shown.join("\n"));
    let (status, _) = terminal.interrupt();
    assert_eq!(status.code(), Some(0));
}

#[test]
fn the_table_survives_another_size_of_the_terminal() {
    let (mut terminal, _) = run(100, 30, &[]);
    terminal.wait_until("there is no table", |rows| rows.last().is_some_and(|row| is_total(row)));
    for (columns, rows) in [(60, 30), (60, 12), (120, 40), (30, 10)] {
        terminal.resize(columns, rows);
        let before = terminal.rows();
        let is_drawn = |rows: &[String]| *rows != before && rows.last().is_some_and(|row| is_total(row));
        let shown = terminal.wait_until("the table is not drawn again", is_drawn);
        assert!(table(&shown).len() < rows, "{}", shown.join("\n"));
    }
    assert_eq!(terminal.interrupt().0.code(), Some(0));
}

/// A robot with streams, as the command `urdf` prints it.
fn robot(folder: &Path) -> String {
    let urdf = output(&["urdf", "kobuki_nostack_rplidar"]);
    assert!(urdf.status.success());
    let file = folder.join("robot.urdf");
    std::fs::write(&file, urdf.stdout).unwrap();
    file.to_str().unwrap().to_owned()
}

#[track_caller]
fn control(domain: &str, arguments: &[&str]) {
    let done = output(&[&["control", "--domain", domain, "--timeout", "60"], arguments].concat());
    assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
}

/// Checks that no rate is impossible for the stream.
#[track_caller]
fn assert_sane(table: &[String]) {
    for row in table.iter().filter(|row| row.starts_with('/')) {
        let cells: Vec<&str> = row.split_whitespace().collect();
        let hz = |cell: &str| cell.parse::<f64>().ok();
        // Over a short time, one additional frame gives a rate several times as high.
        if let (Some(rate), Some(asked)) = (hz(cells[1]), hz(cells[2])) {
            assert!((0.0..=10.0 * asked + 100.0).contains(&rate), "{row}");
        }
    }
}

fn has_topic(rows: &[String], topic: &str) -> bool {
    rows.iter().any(|row| row.split(' ').next() == Some(topic))
}

#[track_caller]
fn assert_recorded(recording: &Path) {
    let info = output(&["info", recording.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&info.stdout).into_owned();
    assert!(info.status.success(), "{said}{}", String::from_utf8_lossy(&info.stderr));
    assert!(said.contains("/carl/"), "{said}");
    assert!(!recording.with_extension("mcap.active").exists());
}

#[test]
fn robots_come_and_go_in_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let (robot, recording) = (robot(folder.path()), folder.path().join("run.mcap"));
    let arguments = ["--drive", "still", "--record", recording.to_str().unwrap(), "--patience", "60"];
    let (mut terminal, domain) = run(120, 60, &arguments);
    // The screen may be read while it is being drawn.
    let is_whole = |rows: &[String]| rows.last().is_some_and(|row| is_total(row));
    terminal.wait_until("there is no table", |rows| has_topic(rows, "/scan"));
    control(&domain, &["spawn", &robot, "--name", "carl", "--namespace", "carl", "--pose", "1,1"]);
    let shown = terminal.wait_until("the robot's streams are not shown", |rows| {
        is_whole(rows) && has_topic(rows, "/carl/odom")
    });
    assert_sane(table(&shown));
    control(&domain, &["delete", "carl"]);
    // The first streams are deleted, and the others take their rows.
    control(&domain, &["delete", "turtlebot"]);
    let gone =
        |rows: &[String]| is_whole(rows) && !has_topic(rows, "/carl/odom") && !has_topic(rows, "/scan");
    let shown = terminal.wait_until("streams that are gone are shown", gone);
    assert_sane(table(&shown));
    control(&domain, &["spawn", &robot, "--name", "carl", "--namespace", "carl"]);
    terminal.wait_until("the robot's streams are not shown again", |rows| has_topic(rows, "/carl/odom"));
    for _ in 0..2 {
        let before = terminal.rows();
        let shown = terminal.wait_until("the table is not updated", |rows| *rows != before && is_whole(rows));
        assert_sane(table(&shown));
    }
    let (status, rows) = terminal.interrupt();
    assert_eq!(status.code(), Some(0), "{}", rows.join("\n"));
    assert_sane(table(&rows));
    assert!(has_topic(&rows, "/carl/odom") && !has_topic(&rows, "/scan"), "{}", rows.join("\n"));
    assert_recorded(&recording);
}

#[test]
fn robots_come_and_go_without_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let (robot, recording) = (robot(folder.path()), folder.path().join("run.mcap"));
    let domain = own_domain();
    let simulator = belvedere()
        .args(["run", "--domain", &domain, "--record", recording.to_str().unwrap(), "--patience", "60"])
        .args(["--drive", "still"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    // The streams of commands exist first, before anything is published.
    while !String::from_utf8_lossy(&output(&["list", "--domain", &domain]).stdout).contains("/odom") {
        assert!(started.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(50));
    }
    control(&domain, &["spawn", &robot, "--name", "carl", "--namespace", "carl", "--pose", "1,1"]);
    control(&domain, &["spawn", &robot, "--name", "dora", "--namespace", "dora", "--pose", "2,1"]);
    control(&domain, &["delete", "turtlebot"]);
    control(&domain, &["pause"]);
    kill_process(Pid::from_child(&simulator), Signal::INT).unwrap();
    let ended = simulator.wait_with_output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(0), "{said}");
    let rows: Vec<String> = said.lines().map(str::to_owned).collect();
    assert_sane(table(&rows));
    assert!(has_topic(&rows, "/dora/odom") && !has_topic(&rows, "/scan"), "{said}");
    assert_recorded(&recording);
}

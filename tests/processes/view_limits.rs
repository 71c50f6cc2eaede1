//! The page's server with too many clients, without a browser, and its access to files.
#![cfg(feature = "view")]

use crate::live::{PATIENCE, belvedere, own_domain};
use crate::page::{Page, Server};
use serde_json::json;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use tungstenite::protocol::Role;
use tungstenite::{Message, WebSocket};

/// The header of a request for a WebSocket.
fn upgrade(server: &Server) -> String {
    format!(
        "GET /?token={} HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        server.token, server.host
    )
}

#[test]
fn connections_are_limited_and_freed() {
    let server = Server::run(&own_domain(), &["--drive", "still"]);
    let mut pages: Vec<_> = (0..6).map(|_| server.page()).collect();
    let answer = server.ask(&upgrade(&server));
    assert!(
        answer.starts_with("HTTP/1.1 503 ") && answer.contains("6 clients are connected already"),
        "{answer}"
    );
    // Existing clients still receive their streams.
    for page in &mut pages {
        page.next("clock");
    }
    pages.pop();
    let deadline = Instant::now() + PATIENCE;
    while !is_let_in(&server) {
        assert!(Instant::now() < deadline, "a free place is not given to the next client");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Any user of the machine can connect without a token: the oldest of these connections are closed, and clients with
/// the token are accepted.
#[test]
fn connections_without_a_token_do_not_block_others() {
    let server = Server::run(&own_domain(), &["--drive", "still"]);
    let mut halves: Vec<_> = (0..40)
        .map(|_| {
            let mut stream = TcpStream::connect(&server.host).unwrap();
            stream.set_read_timeout(Some(PATIENCE)).unwrap();
            stream.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
            stream
        })
        .collect();
    for _ in 0..20 {
        let page = server.get(&format!("/?token={}", server.token));
        assert!(page.starts_with("HTTP/1.1 200 "), "{page}");
    }
    server.page().next("clock");
    // The first of them was closed without an answer.
    let mut answer = Vec::new();
    let _ = halves[0].read_to_end(&mut answer);
    assert_eq!(answer, b"");
    // The last one has some seconds for the rest of its request.
    halves.pop().unwrap().read_to_end(&mut answer).unwrap();
    assert!(answer.starts_with(b"HTTP/1.1 408 "), "{}", String::from_utf8_lossy(&answer));
}

/// The peak memory of a process in KiB.
fn peak_kib(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// Writes a binary STL file with this many triangles of 50 bytes each.
fn write_stl(path: &Path, triangles: u32) {
    let mut bytes = vec![0; 80];
    bytes.extend_from_slice(&triangles.to_le_bytes());
    for index in 0..triangles {
        let (x, y) = ((index % 200) as f32 * 0.01, (index / 200) as f32 * 0.01);
        let numbers = [0.0, 0.0, 1.0, x, y, 0.1, x + 0.01, y, 0.1, x, y + 0.01, 0.1];
        bytes.extend(numbers.iter().flat_map(|number: &f32| number.to_le_bytes()));
        bytes.extend_from_slice(&[0; 2]);
    }
    fs::write(path, bytes).unwrap();
}

/// A client that does not take its answers waits, and costs the simulator no memory.
#[test]
fn unread_answers_do_not_accumulate() {
    let folder = tempfile::tempdir().unwrap();
    write_stl(&folder.path().join("part.stl"), 40_000);
    let robot = folder.path().join("robot.urdf");
    fs::write(
        &robot,
        format!(
            "<robot name='r'><link name='base'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' \
             ixy='0' ixz='0' iyz='0'/></inertial><visual name='{}'><geometry><mesh filename='file://{}/part.stl'/>\
             </geometry></visual></link></robot>",
            "x".repeat(20_000),
            folder.path().display()
        ),
    )
    .unwrap();
    let server = Server::run(
        &own_domain(),
        &["--robot", robot.to_str().unwrap(), "--world", "empty", "--drive", "still"],
    );
    let mut client = server.connect("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n");
    client.say(&json!({ "op": "getParameters", "parameterNames": ["/robot_description"], "id": "a" }));
    let parameters = client.next_json("parameterValues");
    let urdf = parameters["parameters"][0]["value"].as_str().unwrap();
    let mesh = urdf.split('"').find(|word| word.starts_with("package://")).unwrap();
    let parameters = json!({ "op": "getParameters", "parameterNames": ["/robot_description"], "id": "b" });
    let asset = json!({ "op": "fetchAsset", "uri": mesh, "requestId": 1 });
    // About 80 MB each.
    for (question, times, least) in [(parameters, 4000, 20_000), (asset, 40, 2_000_000)] {
        client.say(&question);
        assert!(next_of(&mut client, least) < 8_000_000);
        let before = peak_kib(server.child.id());
        let sending = client.socket.get_ref().try_clone().unwrap();
        let asking = std::thread::spawn(move || {
            let mut sending = WebSocket::from_raw_socket(sending, Role::Client, None);
            for _ in 0..times {
                sending.send(Message::text(question.to_string())).unwrap();
            }
        });
        // Time in which they could accumulate.
        std::thread::sleep(Duration::from_secs(1));
        for _ in 0..times {
            next_of(&mut client, least);
        }
        asking.join().unwrap();
        let grown = peak_kib(server.child.id()) - before;
        assert!(grown < 20 << 10, "{grown} KiB more");
    }
}

/// The length of the next message with at least this many bytes.
fn next_of(client: &mut Page, least: usize) -> usize {
    loop {
        let len = client.socket.read().unwrap().len();
        if len >= least {
            return len;
        }
    }
}

/// Returns true if one more WebSocket is accepted.
fn is_let_in(server: &Server) -> bool {
    let mut stream = TcpStream::connect(&server.host).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    // A refused connection may be closed before the answer is complete.
    let mut begin = [0; 12];
    let said = stream.write_all(upgrade(server).as_bytes()).and_then(|()| stream.read_exact(&mut begin));
    said.is_ok() && begin == *b"HTTP/1.1 101"
}

#[test]
fn without_a_browser_the_address_is_printed_and_served() {
    let folder = tempfile::tempdir().unwrap();
    // Without xdg-open, and with one that finds no browser.
    let nowhere = folder.path().join("nowhere");
    let failing = folder.path().join("failing");
    fs::create_dir(&failing).unwrap();
    fs::write(failing.join("xdg-open"), "#!/bin/sh\nexit 3\n").unwrap();
    fs::set_permissions(failing.join("xdg-open"), fs::Permissions::from_mode(0o755)).unwrap();
    for path in [nowhere, failing] {
        let mut command = belvedere();
        command.args(["view", "--wait", "--port", "0", "--domain", &own_domain()]).env("PATH", &path);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let said = BufReader::new(child.stderr.take().unwrap());
        let server = Server::of(child);
        let warning = said.lines().map(Result::unwrap).find(|line| line.contains("no browser was opened"));
        assert!(warning.unwrap().contains("--no-browser"));
        let page = server.get(&format!("/?token={}", server.token));
        assert!(page.contains("<title>Belvedere"), "{page}");
    }
}

/// Other users of the machine can read the arguments of programs. A browser is therefore given an address without the
/// token, which opens the page once.
#[test]
fn the_browser_is_not_given_the_token_among_its_arguments() {
    let folder = tempfile::tempdir().unwrap();
    let (program, given) = (folder.path().join("xdg-open"), folder.path().join("given"));
    fs::write(&program, format!("#!/bin/sh\necho \"$@\" >{0}.new && mv {0}.new {0}\n", given.display()))
        .unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());
    let mut command = belvedere();
    command.args(["view", "--wait", "--port", "0", "--domain", &own_domain()]).env("PATH", path);
    let server = Server::start(command);
    let began = Instant::now();
    let given = loop {
        if let Ok(given) = fs::read_to_string(&given) {
            break given;
        }
        assert!(began.elapsed() < PATIENCE, "no browser was asked for");
        std::thread::sleep(Duration::from_millis(10));
    };
    assert!(!given.contains(&server.token), "{given}");
    let target = given.trim().strip_prefix(&format!("http://{}", server.host)).unwrap();
    let wrong = server.get(&format!("{target}0"));
    assert!(wrong.starts_with("HTTP/1.1 403 ") && !wrong.contains(&server.token), "{wrong}");
    let first = server.get(target);
    let elsewhere = format!("Location: /?token={}\r\n", server.token);
    assert!(first.starts_with("HTTP/1.1 303 ") && first.contains(&elsewhere), "{first}");
    let second = server.get(target);
    assert!(second.starts_with("HTTP/1.1 403 ") && second.contains("only once"), "{second}");
}

#[test]
fn a_token_can_be_read_from_a_private_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("token");
    fs::write(&file, "a-token-of-ours\n").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
    let mut command = belvedere();
    command.args(["view", "--wait", "--no-browser", "--port", "0", "--domain", &own_domain()]);
    let server = Server::start({
        command.arg("--token-file").arg(&file);
        command
    });
    assert_eq!(server.token, "a-token-of-ours");
    let fails = |file: &Path, words: &str| {
        let output = belvedere().args(["view", "--token-file"]).arg(file).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains("--token-file") && said.contains(words), "{said}");
    };
    fails(&folder.path().join("none"), "cannot be read");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o644)).unwrap();
    fails(&file, "chmod 600");
    fs::write(&file, "short").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
    fails(&file, "8 or more");
}

/// A mesh of one triangle whose file names pictures: beside it, in `materials/textures` with a path of another machine,
/// one that is missing, and outside the list of pictures.
fn write_collada(folder: &Path) -> PathBuf {
    fs::create_dir_all(folder.join("materials/textures")).unwrap();
    fs::write(folder.join("a picture.png"), "of a part").unwrap();
    fs::write(folder.join("materials/textures/wood.jpg"), "of wood").unwrap();
    let image = |name: &str| format!("<image id='{name}'><init_from>{name}</init_from></image>");
    let images = ["a%20picture.png", "C:\\models\\wood.jpg", "../secret"].map(image).concat();
    let text = format!(
        "<COLLADA version='1.4.1'><library_images>{images}</library_images><library_effects><effect id='e'><profile_COMMON>\
         <newparam sid='s'><surface type='2D'><init_from>a picture.png</init_from></surface></newparam><technique sid='t'>\
         <lambert/></technique></profile_COMMON></effect></library_effects><library_geometries><geometry id='g'><mesh>\
         <source id='p'><float_array id='f' count='9'>0 0 0 0.1 0 0 0 0.1 0</float_array><technique_common>\
         <accessor source='#f' count='3' stride='3'><param name='X' type='float'/><param name='Y' type='float'/>\
         <param name='Z' type='float'/></accessor></technique_common></source><vertices id='v'><input semantic='POSITION' \
         source='#p'/></vertices><triangles count='1'><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p>\
         </triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='o'><node>\
         <instance_geometry url='#g'/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene \
         url='#o'/></scene></COLLADA>"
    );
    let path = folder.join("b.dae");
    fs::write(&path, text).unwrap();
    path
}

/// Clients of Foxglove's protocol can fetch the meshes that a robot names, by generated names, and no other file.
#[test]
fn clients_can_fetch_meshes_and_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("a part.stl");
    let stl = "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0\nendloop\n\
               endfacet\nendsolid part\n";
    fs::write(&mesh, stl).unwrap();
    fs::write(folder.path().join("secret"), "of nobody's business").unwrap();
    let robot = folder.path().join("robot.urdf");
    fs::write(
        &robot,
        format!(
            "<robot name='r'><link name='base'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' \
             ixz='0' iyz='0'/></inertial><visual><geometry><mesh filename='file://{}'/></geometry></visual><visual>\
             <geometry><mesh filename='file://{}'/></geometry></visual></link></robot>",
            mesh.display().to_string().replace(' ', "%20"),
            write_collada(folder.path()).display()
        ),
    )
    .unwrap();
    let server = Server::run(
        &own_domain(),
        &["--robot", robot.to_str().unwrap(), "--world", "empty", "--drive", "still"],
    );
    let mut client = server.connect("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n");
    let info = client.next_json("serverInfo");
    assert!(info["capabilities"].as_array().unwrap().contains(&json!("assets")), "{info}");
    client.say(&json!({ "op": "getParameters", "parameterNames": ["/robot_description"], "id": "a" }));
    let values = client.next_json("parameterValues");
    let urdf = values["parameters"][0]["value"].as_str().unwrap().to_owned();
    assert!(!urdf.contains("file://") && !urdf.contains(folder.path().to_str().unwrap()), "{urdf}");
    let name = urdf.split('"').find(|word| word.starts_with("package://")).unwrap().to_owned();
    assert!(name.ends_with("/a_part.stl"), "{name}");
    let mut fetch = |name: &str, request: u32| {
        client.say(&json!({ "op": "fetchAsset", "uri": name, "requestId": request }));
        let answer = client.binary(4);
        assert_eq!(answer[1..5], request.to_le_bytes());
        let len = u32::from_le_bytes(answer[6..10].try_into().unwrap()) as usize;
        (answer[5], String::from_utf8(answer[10..10 + len].to_vec()).unwrap(), answer[10 + len..].to_vec())
    };
    assert_eq!(fetch(&name, 7), (0, String::new(), stl.as_bytes().to_vec()));
    let secret = format!("file://{}/secret", folder.path().display());
    for wrong in [
        secret.as_str(),
        &name.replace("a_part.stl", "secret"),
        &format!("{name}/../secret"),
        "package://belvedere/../../../../etc/passwd",
        "/etc/passwd",
        "file:///etc/passwd",
        "",
    ] {
        let (status, error, bytes) = fetch(wrong, 8);
        assert!(
            status == 1 && error.contains("no robot's description") && bytes.is_empty(),
            "{wrong}: {error}"
        );
    }
    // The pictures of a Collada file have names below its own in the version that is sent, and no other file can be
    // fetched.
    let collada = fetch(&name.replace("/0/a_part.stl", "/1/b.dae"), 10);
    assert_eq!((collada.0, &*collada.1), (0, ""));
    let collada = String::from_utf8(collada.2).unwrap();
    let named: Vec<&str> =
        collada.split("<init_from>").skip(1).filter_map(|rest| rest.split('<').next()).collect();
    let [own, other, missing, of_surface] = named[..] else { panic!("{collada}") };
    assert!(own.ends_with("/a_picture.png") && other.ends_with("/wood.jpg"), "{named:?}");
    assert_eq!((missing, of_surface), ("../secret", "a picture.png"));
    let beside = |own: &str| name.replace("/0/a_part.stl", &format!("/1/{own}"));
    assert_eq!(fetch(&beside(own), 11).2, b"of a part");
    assert_eq!(fetch(&beside(other), 12).2, b"of wood");
    assert_eq!(fetch(&beside(missing), 13).0, 1);
    // A missing file is reported without its path on this machine.
    fs::remove_file(&mesh).unwrap();
    let (status, error, _) = fetch(&name, 9);
    assert!(status == 1 && error.contains("cannot be read") && !error.contains("tmp"), "{error}");
}

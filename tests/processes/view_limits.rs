//! What the page's server does when there are too many clients, no browser, or files to be given away.
#![cfg(feature = "view")]

use crate::live::{PATIENCE, belvedere, own_domain};
use crate::page::Server;
use serde_json::json;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// What a WebSocket is asked for with.
fn upgrade(server: &Server) -> String {
    format!(
        "GET /?token={} HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        server.token, server.host
    )
}

#[test]
fn clients_and_connections_are_limited_and_places_come_free() {
    let server = Server::run(&own_domain(), &["--drive", "still"]);
    let mut pages: Vec<_> = (0..6).map(|_| server.page()).collect();
    let answer = server.ask(&upgrade(&server));
    assert!(answer.starts_with("HTTP/1.1 503 ") && answer.contains("6 clients look already"), "{answer}");
    // Those who look already see what they saw before.
    for page in &mut pages {
        page.next("clock");
    }
    pages.pop();
    let deadline = Instant::now() + PATIENCE;
    while !is_let_in(&server) {
        assert!(Instant::now() < deadline, "the place that came free is not given");
        std::thread::sleep(Duration::from_millis(20));
    }

    // Whoever connects and says nothing.
    let silent: Vec<_> = (0..40).map(|_| TcpStream::connect(&server.host).unwrap()).collect();
    // It is told so before it has said anything.
    let answer = server.ask("");
    assert!(answer.starts_with("HTTP/1.1 503 ") && answer.contains("too many connections"), "{answer}");
    pages[0].next("clock");
    // He has some seconds for his words.
    let began = Instant::now();
    while !is_let_in(&server) {
        assert!(began.elapsed() < PATIENCE, "silent ones keep their places");
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(silent);
}

/// Whether one more WebSocket is served.
fn is_let_in(server: &Server) -> bool {
    let mut stream = TcpStream::connect(&server.host).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    // One that is refused may be closed before it has said all.
    let mut begin = [0; 12];
    let said = stream.write_all(upgrade(server).as_bytes()).and_then(|()| stream.read_exact(&mut begin));
    said.is_ok() && begin == *b"HTTP/1.1 101"
}

#[test]
fn without_a_browser_the_address_is_printed_and_served() {
    let folder = tempfile::tempdir().unwrap();
    // No xdg-open at all, and one that finds no browser.
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

/// A mesh of one triangle whose file names pictures: beside it, in `materials/textures` as of another machine, one that is
/// not there, and outside of the list of pictures.
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

/// Clients of Foxglove's protocol are given the meshes that a robot names, by names of ours, and no other file.
#[test]
fn meshes_are_given_to_who_cannot_read_them_and_nothing_else_is() {
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
    let info = client.told("serverInfo");
    assert!(info["capabilities"].as_array().unwrap().contains(&json!("assets")), "{info}");
    client.say(&json!({ "op": "getParameters", "parameterNames": ["/robot_description"], "id": "a" }));
    let values = client.told("parameterValues");
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
    // Pictures that a Collada file names have names below its own in what is sent of it, and no other file is given.
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
    // What is there no more is said, without its place on this machine.
    fs::remove_file(&mesh).unwrap();
    let (status, error, _) = fetch(&name, 9);
    assert!(status == 1 && error.contains("cannot be read") && !error.contains("tmp"), "{error}");
}

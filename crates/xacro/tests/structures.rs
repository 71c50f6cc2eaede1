//! Whole files against ROS's xacro 2.1.1: macros, properties, includes, YAML files.

use belvedere_xacro::diagnostics::Diagnostics;
use belvedere_xacro::expand;
use belvedere_xacro::package::PackagePath;
use std::fs;
use tempfile::TempDir;

/// Returns the expansion of the first of some files in a folder, and the reported problems.
fn expand_files(files: &[(&str, &str)]) -> (Result<String, String>, Vec<String>) {
    let folder = TempDir::new().unwrap();
    for (name, content) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let content = if *name == "c.yaml" {
            (*content).to_owned()
        } else {
            format!("<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>{content}</robot>")
        };
        fs::write(path, content).unwrap();
    }
    let packages = PackagePath::new([], None);
    let mut diagnostics = Diagnostics::default();
    let result = expand(&folder.path().join(files[0].0), &packages, &[], &mut diagnostics);
    let at = folder.path().to_str().unwrap();
    let reported = diagnostics.problems().iter().map(|problem| problem.to_string().replace(at, "."));
    let reported: Vec<String> = reported.collect();
    let text = result.map(|root| {
        let lines = root.to_string().replace(at, ".");
        let inside: Vec<&str> =
            lines.lines().skip(2).map(str::trim).filter(|line| *line != "</robot>").collect();
        inside.concat()
    });
    (text.map_err(|problem| problem.to_string().replace(at, ".")), reported)
}

fn expands_to(content: &str, expected: &str) {
    let (text, reported) = expand_files(&[("r.xacro", content)]);
    assert_eq!(text.as_deref(), Ok(expected), "{content}: {reported:#?}");
}

fn is_refused(content: &str, words: &[&str]) {
    let (text, _) = expand_files(&[("r.xacro", content)]);
    let fault = text.expect_err(content);
    for word in words {
        assert!(fault.contains(word), "{content}: no '{word}' in {fault}");
    }
}

#[test]
fn properties_and_macros() {
    for (content, expected) in [
        // Texts in quotes are parsed twice.
        (r#"<xacro:property name="b" value="'3'"/><a v="${b+1}"/>"#, r#"<a v="4"/>"#),
        (
            r#"<xacro:property name="a" value="5"/><xacro:property name="b" value="'${a}'"/><a v="${b+1}"/>"#,
            r#"<a v="6"/>"#,
        ),
        (
            r#"<xacro:macro name="m" params="p"><a v="${p+1}"/></xacro:macro><xacro:m p="${'3'}"/>"#,
            r#"<a v="4"/>"#,
        ),
        (r#"<xacro:property name="b" value=" 5 "/><a v="[${b}]"/>"#, r#"<a v="[5]"/>"#),
        // Lists are shared.
        (
            r#"<xacro:property name="l" value="${[1,2]}"/><a v="${l.append(3)}"/><a v="${l}"/>"#,
            r#"<a v="None"/><a v="[1, 2, 3]"/>"#,
        ),
        (
            r#"<xacro:property name="l" value="${[1,2]}"/><xacro:property name="k" value="${l}"/><a v="${k.pop(0)}"/><a v="${l}"/>"#,
            r#"<a v="1"/><a v="[2]"/>"#,
        ),
        (
            r#"<xacro:macro name="m" params="l"><xacro:if value="${l}"><a v="${l.pop(0)}"/><xacro:m l="${l}"/></xacro:if></xacro:macro><xacro:property name="q" value="${[1,2,3]}"/><xacro:m l="${q}"/>"#,
            r#"<a v="1"/><a v="2"/><a v="3"/>"#,
        ),
        // Comprehensions and lambdas see properties, and properties can hold lambdas.
        (
            r#"<xacro:property name="k" value="2"/><a v="${[k*i for i in range(3)]}"/>"#,
            r#"<a v="[0, 2, 4]"/>"#,
        ),
        (r#"<xacro:property name="f" value="${lambda x: x*2}"/><a v="${f(4)}"/>"#, r#"<a v="8"/>"#),
        (
            r#"<xacro:property name="v" value="${[x.strip() for x in 'a : b'.split(':') if x]}"/><a v="${v[1]}"/>"#,
            r#"<a v="b"/>"#,
        ),
        (r#"<xacro:property name="f" value="{:.2f}"/><a v="${f.format(pi)}"/>"#, r#"<a v="3.14"/>"#),
        (
            r#"<xacro:property name="f" value="{0:>5}|{n:03d}|{1!r}"/><a v="${f.format(1.5, 'x', n=7)}"/>"#,
            r#"<a v="  1.5|007|'x'"/>"#,
        ),
        (r#"<a v="$(eval {1: 2})"/>"#, r#"<a v="{1: 2}"/>"#),
        (r#"<a v="${xacro.message('hi')}|${xacro.print_location()}|"/>"#, r#"<a v="||"/>"#),
        (r#"<a v="${xacro.abs_filename('hi')}"/>"#, r#"<a v="./hi"/>"#),
        (r#"<a v="${xacro.tokenize('a,b; c')}"/>"#, r#"<a v="['a', 'b', 'c']"/>"#),
        (r#"<a v="${xacro.dotify(dict(a=1)).a}"/>"#, r#"<a v="1"/>"#),
        (r#"<xacro:arg name="n" default="7"/><a v="${xacro.arg('n') + 'x'}"/>"#, r#"<a v="7x"/>"#),
        // Nothing is expanded in CDATA.
        ("<a><![CDATA[x ${1+1} $(arg z)]]></a>", "<a>x ${1+1} $(arg z)</a>"),
        ("<a>${1+1}<![CDATA[ ${1}]]></a>", "<a>2 ${1}</a>"),
    ] {
        expands_to(content, expected);
    }
    for (content, words) in [
        (r#"<xacro:property name="if" value="1"/>"#, &["'if'", "keyword"][..]),
        (r#"<a v="${xacro.fatal('no', 3)}"/>"#, &["no 3", "r.xacro:1"]),
        (r#"<a v="$(anon x)"/>"#, &["anon", "in each run"]),
        (
            r#"<xacro:macro name="m" params="p"><a v="${p+1}"/></xacro:macro><xacro:m p="'3'"/>"#,
            &["do not go together"],
        ),
        (r#"<xacro:property name="f" value="${lambda x: f(x)}"/><a v="${f(4)}"/>"#, &["300 deep"]),
        (r#"<a v="$(eval 'a'.__class__)"/>"#, &["underscores"]),
    ] {
        is_refused(content, words);
    }
    let (_, reported) =
        expand_files(&[("r.xacro", "<a v=\"${xacro.warning('old', 1)}${xacro.message('hi')}\"/>")]);
    assert!(reported.contains(&"./r.xacro:1: warning: old 1".to_owned()), "{reported:#?}");
    assert!(reported.contains(&"./r.xacro:1: note: hi".to_owned()), "{reported:#?}");
}

#[test]
fn yaml_files() {
    let yaml = "u: [!meters 2, !millimeters 1000*2, !foot 1, !inches 1, !degrees 180, !radians pi/2, !inches '2']\n\
        b: [yes, No, on, OFF, true, ~, null, '', Null]\n\
        i: [010, 0o10, 0x1F, 0b101, 1_000, 08, +12, 1:30, -1:30:05, 1:60]\n\
        f: [1., .5, 1e5, 1.0e5, 1.0e+5, 1.5E-3, -.5, 1:30.5, .inf, -.INF, 1_0.5]\n\
        t: ['1', \"2\", word, a b, !!str 12, !!int '3', !!float 4, 12e03]\n\
        d: &d {x: 1, y: {z: [1, {k: v}]}}\n\
        m: {a: 0, <<: *d, x: 5}\n\
        n: {<<: [{p: 1, q: 1}, {q: 2, r: 2}], p: 9}\n\
        items: 3\n1: one\nx: 1\nx: 2\n";
    for (expression, expected) in YAML {
        let content = format!(
            "<xacro:property name=\"y\" value=\"${{xacro.load_yaml('c.yaml')}}\"/><a v=\"{expression}\"/>"
        );
        let (text, _) = expand_files(&[("r.xacro", &content), ("c.yaml", yaml)]);
        let text = text.map(|text| text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\""));
        match *expected {
            "!" => assert!(text.is_err(), "{expression}: {text:?}"),
            expected => assert_eq!(text, Ok(format!("<a v=\"{expected}\"/>")), "{expression}"),
        }
    }
    for (yaml, word) in [
        ("a: !cubits 3", "!cubits"),
        ("a: !degrees x", "'x' is not a number"),
        ("a: !meters 1 +", "ends too early"),
        ("a: 2024-01-02", "date"),
        ("a: 1\n---\nb: 2", "more than one document"),
        ("a: !!python/object x", "python"),
        ("? [1]\n: 2", "cannot be a key"),
        ("a: !thing {b: 1}", "!thing"),
        ("a: {<<: 3}", "'<<'"),
    ] {
        let (text, _) = expand_files(&[("r.xacro", "<a v=\"${load_yaml('c.yaml')}\"/>"), ("c.yaml", yaml)]);
        let fault = text.expect_err(yaml);
        assert!(fault.contains(word) && fault.contains("c.yaml"), "{yaml}: {fault}");
    }
}

/// Expressions on a YAML file, and the output of xacro.
const YAML: &[(&str, &str)] = &[
    ("${y.u}", "[2.0, 2.0, 0.3048, 0.0254, 3.141592653589793, 1.5707963267948966, 0.0508]"),
    ("${y.b}", "[True, False, True, False, True, None, None, '', None]"),
    ("${y.i}", "[8, '0o10', 31, 5, 1000, '08', 12, 90, -5405, '1:60']"),
    ("${y.f}", "[1.0, 0.5, '1e5', '1.0e5', 100000.0, 0.0015, '-.5', 90.5, inf, -inf, 10.5]"),
    ("${y.t}", "['1', '2', 'word', 'a b', '12', 3, 4.0, '12e03']"),
    ("${y.d.y.z[1].k}", "v"),
    ("${y['d']['y'].z[1]['k']}", "v"),
    ("${y.m}", "{'x': 5, 'y': {'z': [1, {'k': 'v'}]}, 'a': 0}"),
    ("${y.n}", "{'p': 9, 'q': 1, 'r': 2}"),
    ("${y[1]}", "one"),
    ("${y.x}", "2"),
    ("${y['items']}", "3"),
    ("${list(y.keys())}", "['u', 'b', 'i', 'f', 't', 'd', 'm', 'n', 'items', 1, 'x']"),
    ("${y.items}", "!"),
    ("${y.get('d').x}", "!"),
    ("${y.get('d')['x']}", "1"),
    ("${y.d.y.z.append(3)}${y.d.y.z}", "None[1, {'k': 'v'}]"),
    ("${[e for e in y.d.y.z]}", "[1, {'k': 'v'}]"),
    ("${[e.k for e in y.d.y.z[1:]]}", "['v']"),
    ("${y.d.y.z[-1:][0].k}", "v"),
    ("${'d' in y}", "True"),
    ("${len(y.u)}", "7"),
    ("${[k for k in y.d]}", "['x', 'y']"),
    ("${[str(k) + str(v) for k, v in y.d.items()]}", r#"['x1', "y{'z': [1, {'k': 'v'}]}"]"#),
    ("${dict(y.d)}", "{'x': 1, 'y': {'z': [1, {'k': 'v'}]}}"),
    ("${y.d == dict(y.d)}", "True"),
    ("${y.nothing}", "!"),
    ("${y.d.y.z.k}", "!"),
    ("${sorted(y.i[:3])}", "!"),
    ("${y.d.pop('x')} ${y.d.x}", "1 1"),
    ("${y.d | dict(w=1)}", "{'x': 1, 'y': {'z': [1, {'k': 'v'}]}, 'w': 1}"),
    ("${(y.d | dict(w=1)).w}", "!"),
    ("${y.u[0] + 1}", "3.0"),
    ("${y.i[7]}", "90"),
];

#[test]
fn includes_are_relative_to_the_file_that_is_being_expanded() {
    // The macro is in sub/m.xacro and called in r.xacro: its include is next to r.xacro.
    let call = ("r.xacro", "<xacro:include filename='sub/m.xacro'/><xacro:m/>");
    let definition =
        ("sub/m.xacro", "<xacro:macro name='m'><xacro:include filename='part.xacro'/></xacro:macro>");
    let files = [call, definition, ("part.xacro", "<outer/>"), ("sub/part.xacro", "<inner/>")];
    assert_eq!(expand_files(&files).0.as_deref(), Ok("<outer/>"));
    let direct = ("sub/m.xacro", "<xacro:macro name='m'/><xacro:include filename='part.xacro'/>");
    let files = [call, direct, ("part.xacro", "<outer/>"), ("sub/part.xacro", "<inner/>")];
    assert_eq!(expand_files(&files).0.as_deref(), Ok("<inner/>"));
}

#[test]
fn patterns_include_files_in_the_order_of_their_names() {
    let parts = [("p/b.xacro", "<b/>"), ("p/a.xacro", "<a/>"), ("p/.c.xacro", "<c/>"), ("p/d.urdf", "<d/>")];
    let with = |include| [&[("r.xacro", include)], &parts[..]].concat();
    let (text, reported) = expand_files(&with("<xacro:include filename='p/*.xacro'/>"));
    assert_eq!(text.as_deref(), Ok("<a/><b/>"), "{reported:#?}");
    assert_eq!(expand_files(&with("<xacro:include filename='*/[!a].*'/>")).0.as_deref(), Ok("<b/><d/>"));
    let (text, reported) = expand_files(&with("<xacro:include filename='p/z*.xacro'/>"));
    assert!(text.as_deref() == Ok("") && reported[0].contains("no file matches"), "{text:?} {reported:#?}");
    let spaced = "<xacro:include filename='s/*.xacro' ns='s'/><e v='${s.k}'/><xacro:s.m/>";
    let files = [
        ("r.xacro", spaced),
        ("s/a.xacro", "<xacro:property name='k' value='4'/>"),
        ("s/b.xacro", "<xacro:macro name='m'><f v='${k}'/></xacro:macro>"),
    ];
    assert_eq!(expand_files(&files).0.as_deref(), Ok("<e v=\"4\"/><f v=\"4\"/>"));
}

#[test]
fn elements_of_other_programs_are_kept_and_not_macros() {
    expands_to("<mujoco><compiler/></mujoco><loop_joint/>", "<mujoco><compiler/></mujoco><loop_joint/>");
    let (text, reported) = expand_files(&[("r.xacro", "<xacro:macro name='kobuki'/><kobuky/>")]);
    assert_eq!(text.as_deref(), Ok("<kobuky/>"));
    assert!(
        reported[0].contains("warning") && reported[0].contains("did you mean 'kobuki'?"),
        "{reported:#?}"
    );
    // A macro with the name of an element of its own body, or of another macro's.
    for (content, expected) in [
        (
            "<xacro:macro name='sonar' params='name'><link name='${name}'><sonar><min>1</min></sonar></link></xacro:macro>\
             <xacro:sonar name='s'/>",
            "<link name=\"s\"><sonar><min>1</min></sonar></link>",
        ),
        (
            "<xacro:macro name='static'><static>true</static></xacro:macro><xacro:static/>",
            "<static>true</static>",
        ),
        (
            "<xacro:macro name='altimeter'><gazebo><altimeter/></gazebo></xacro:macro><xacro:altimeter/>",
            "<gazebo><altimeter/></gazebo>",
        ),
        (
            "<xacro:macro name='kp' params='v'><kp>${v}</kp></xacro:macro><xacro:macro name='m'><gazebo><xacro:kp v='1'/>\
             <kp>2</kp></gazebo></xacro:macro><xacro:m/>",
            "<gazebo><kp>1</kp><kp>2</kp></gazebo>",
        ),
        // The older style without prefixes.
        (
            "<xacro:macro name='wheel' params='side'><link name='${side}'/></xacro:macro><wheel side='l'/>",
            "<link name=\"l\"/>",
        ),
        (
            "<xacro:macro name='box_inertia' params='m'><mass value='${m}'/></xacro:macro><link name='l'><box_inertia m='2'/></link>",
            "<link name=\"l\"><mass value=\"2\"/></link>",
        ),
    ] {
        expands_to(content, expected);
    }
    is_refused("<xacro:macro name='wheel' params='side'/><wheel/>", &["without its parameter 'side'"]);
    is_refused("<xacro:kobuky/>", &["unknown macro 'kobuky'"]);
}

#[test]
fn no_recursion_exhausts_the_stack() {
    let inside = |text: &str| format!("{}<a v=\"{text}\"/>{}", "<b>".repeat(100), "</b>".repeat(100));
    for text in [
        "${(lambda f: f(f))(lambda f: f(f))}",
        "${(lambda f: f(f))(lambda f: [f(f) for i in [1] for j in [1] for k in [1]])}",
        "${(lambda f: f(f))(lambda f: sorted([1, 2], key=lambda x: f(f)))}",
        "${(lambda f: f(f))(lambda f: list(map(f, [f])))}",
        "${(lambda f: f(f))(lambda f: -(-(-(-(-(-(-f(f))))))))}",
        "${(lambda f: f(f))(lambda f: max(*[f(f)], **dict(key=f)))}",
        "${(lambda f: f(f))(lambda f: 1 if f(f) < 2 and not f(f) else 3)}",
        "${(lambda f: f(f))(lambda f: dict(a=[(f(f),)])['a'][0])}",
    ] {
        is_refused(&format!("<a v=\"{text}\"/>"), &["300 deep"]);
        is_refused(&inside(text), &["300 deep"]);
    }
    let properties = "<xacro:property name='f' value='${lambda x: g(x)}'/><xacro:property name='g' value='${lambda x: f(x)}'/>";
    is_refused(&format!("{properties}{}", inside("${f(1)}")), &["300 deep"]);
}

//! Small files that expand to large ones: each gives one clear error. Expanding them would take days.

use crate::sdf::Folder;
use belvedere::description::load::{LoadOptions, load_robot};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use std::collections::HashSet;
use std::time::{Duration, Instant};

/// A watchdog for endless loops; speed is not tested.
const PATIENCE: Duration = Duration::from_secs(120);

/// Loads a robot and returns its errors.
fn errors_of(inside: &str) -> Vec<String> {
    let folder = Folder::new();
    let text = format!("<robot name='r' xmlns:xacro='http://x'>{inside}<link name='base'/></robot>");
    let path = folder.write("r.xacro", text);
    let packages = package_path([], None);
    let options = LoadOptions { packages, rules: Rules::default(), xacro_args: Vec::new() };
    let mut diagnostics = Diagnostics::default();
    let start = Instant::now();
    load_robot(path.to_str().unwrap(), &options, &mut diagnostics);
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
    diagnostics.errors().map(ToString::to_string).collect()
}

#[track_caller]
fn assert_refused(inside: &str, words: &str) {
    let errors = errors_of(inside);
    assert!(errors.len() == 1 && errors[0].contains(words), "{errors:?}");
}

#[test]
fn nested_xacro_calls_are_limited() {
    // 64 calls, each 190 levels of elements deeper.
    let (open, close) = ("<a>".repeat(190), "</a>".repeat(190));
    let body = format!("{open}<xacro:if value='${{n > 0}}'><xacro:down n='${{n - 1}}'/></xacro:if>{close}");
    let macros = format!("<xacro:macro name='down' params='n'>{body}</xacro:macro>");
    assert_refused(&format!("{macros}<gazebo><xacro:down n='64'/></gazebo>"), "more than 300 deep");
    assert_eq!(errors_of(&format!("{macros}<gazebo><xacro:down n='0'/></gazebo>")), [""; 0]);
    // A loop by recursion, as used in files.
    let count = "<xacro:macro name='count' params='n'><xacro:if value='${n}'><link name='l${n}'/>\
        <joint name='j${n}' type='fixed'><parent link='base'/><child link='l${n}'/></joint>\
        <xacro:count n='${n - 1}'/></xacro:if></xacro:macro>";
    assert_eq!(errors_of(&format!("{count}<xacro:count n='100'/>")), [""; 0]);
    assert_refused("<xacro:macro name='m'><xacro:m/></xacro:macro><xacro:m/>", "more than 300 deep");
    // Blocks that are nested in each other.
    let wrap = format!(
        "<xacro:macro name='wrap' params='n *inside'><xacro:if value='${{n > 0}}'><xacro:wrap n='${{n - 1}}'>\
         <b>{}<xacro:insert_block name='inside'/>{}</b></xacro:wrap></xacro:if></xacro:macro>",
        "<c>".repeat(30),
        "</c>".repeat(30)
    );
    assert_refused(
        &format!("{wrap}<gazebo><xacro:wrap n='60'><d/></xacro:wrap></gazebo>"),
        "more than 300 deep",
    );
    // Expressions in properties in expressions.
    let nested = |i: usize| format!("{}p{}{}", "(-".repeat(12), i + 1, ")".repeat(12));
    let chain: Vec<String> =
        (0..160).map(|i| format!("<xacro:property name='p{i}' value='${{{}}}'/>", nested(i))).collect();
    let chain = chain.concat();
    let chain = format!("{chain}<xacro:property name='p160' value='1'/><gazebo x='${{p0}}'/>");
    assert_refused(&chain, "more than 300 deep");
}

#[test]
fn repeated_doubling_in_xacro_is_limited() {
    let text: Vec<String> =
        (1..36).map(|i| format!("<xacro:property name='a{i}' value='${{a{0} + a{0}}}'/>", i - 1)).collect();
    let text = text.concat();
    assert_refused(
        &format!("<xacro:property name='a0' value='word'/>{text}<gazebo x='${{a35}}'/>"),
        "grows beyond 4000000 bytes",
    );
    for expression in
        ["['word', 'word'] * 99999999", "','.join(map(str, range(99999))).replace(',', 'word' * 99)"]
    {
        assert_refused(&format!("<gazebo x=\"${{{expression}}}\"/>"), "grows beyond");
    }
    let calls: Vec<String> = (0..30)
        .map(|i| format!("<xacro:macro name='m{i}'><xacro:m{0}/><xacro:m{0}/></xacro:macro>", i + 1))
        .collect();
    let calls = calls.concat();
    assert_refused(
        &format!("{calls}<xacro:macro name='m30'><a/></xacro:macro><gazebo><xacro:m0/></gazebo>"),
        "more than 500000 elements",
    );
    let blocks = "<xacro:macro name='twice' params='n *b'><xacro:if value='${n}'><xacro:twice n='${n - 1}'><b>\
        <xacro:insert_block name='b'/><xacro:insert_block name='b'/></b></xacro:twice></xacro:if></xacro:macro>";
    assert_refused(
        &format!("{blocks}<gazebo><xacro:twice n='40'><a/></xacro:twice></gazebo>"),
        "more than 500000 elements",
    );
}

#[test]
fn sdf_includes_that_fan_out() {
    let folder = Folder::new();
    for i in 0..40 {
        let include = format!("<include><uri>model://m{}</uri></include>", i + 1);
        let other = include.replace("</uri>", "</uri><name>other</name>");
        let text =
            format!("<sdf version='1.6'><model name='m{i}'><link name='l'/>{include}{other}</model></sdf>");
        folder.write(&format!("m{i}/model.sdf"), text);
    }
    folder.write("m40/model.sdf", "<sdf version='1.6'><model name='m40'><link name='l'/></model></sdf>");
    let start = Instant::now();
    let (_, problems) = folder.load("1.6", "<include><uri>model://m0</uri></include>", false);
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
    assert!(problems[0].to_string().contains("more than 500000 elements"), "{}", problems[0]);
}

#[test]
fn a_name_that_occurs_ten_thousand_times() {
    const COUNT: usize = 10_000;
    let start = Instant::now();
    let links = "<link name='l'/>".repeat(COUNT);
    let model = |links: &str| format!("<model name='m'><static>true</static>{links}</model>");
    for content in [model(&links), model("<link name='l'/>").repeat(COUNT)] {
        let (world, problems) = Folder::new().load("1.6", &content, true);
        let world = world.unwrap();
        let names: HashSet<&str> = match &world.models[..] {
            [model] => model.links.iter().map(|link| link.name.as_str()).collect(),
            models => models.iter().map(|model| model.name.as_str()).collect(),
        };
        assert_eq!((names.len(), problems.len()), (COUNT, COUNT - 1));
    }
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}

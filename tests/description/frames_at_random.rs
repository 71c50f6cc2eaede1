//! A hundred worlds with random models, frames and includes. The place of everything is composed while the world is written,
//! with matrices, and compared with what is loaded.

use crate::sdf::Folder;
use belvedere::description::model::Model;
use belvedere_sensors::Pose;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Numbers at random: the generator of Steele and others, `SplitMix64`.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn is(&mut self, share: f64) -> bool {
        self.number(0.0, 1.0) < share
    }

    fn number(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.next() >> 11) as f64 / (1u64 << 53) as f64;
        low + unit * (high - low)
    }

    fn vector(&mut self, most: f64) -> DVec3 {
        DVec3::new(self.number(-most, most), self.number(-most, most), self.number(-most, most))
    }
}

/// A frame that can be named: its place in the scope, and the link that it moves with.
#[derive(Clone)]
struct Named {
    at: DAffine3,
    link: String,
}

/// A joint, with what is to be found of it.
struct Hinge {
    parent: String,
    child: String,
    /// Its place and axis in the scope.
    at: DVec3,
    axis: DVec3,
}

/// What a model or world is to be like. All names are those by which its scope calls them.
#[derive(Default)]
struct Scope {
    frames: BTreeMap<String, Named>,
    links: BTreeMap<String, DAffine3>,
    visuals: BTreeMap<String, DAffine3>,
    joints: BTreeMap<String, Hinge>,
}

impl Scope {
    fn pick(&self, random: &mut Random) -> (String, Named) {
        let (name, named) = self.frames.iter().nth(random.below(self.frames.len())).unwrap();
        (name.clone(), named.clone())
    }

    /// Takes over what is inside a model, which stands at `at`.
    fn take(&mut self, inside: Scope, at: DAffine3, rename: &dyn Fn(&str) -> String) {
        for (name, Named { at: inner, link }) in inside.frames {
            self.frames.insert(rename(&name), Named { at: at * inner, link: rename(&link) });
        }
        self.links.extend(inside.links.into_iter().map(|(name, inner)| (rename(&name), at * inner)));
        self.visuals.extend(inside.visuals.into_iter().map(|(name, inner)| (name, at * inner)));
        self.joints.extend(inside.joints.into_iter().map(|(name, hinge)| {
            let (parent, child) = (rename(&hinge.parent), rename(&hinge.child));
            let place = at.transform_point3(hinge.at);
            (rename(&name), Hinge { parent, child, at: place, axis: at.transform_vector3(hinge.axis) })
        }));
    }
}

struct Generator<'f> {
    random: Random,
    folder: &'f Folder,
    names: usize,
}

impl Generator<'_> {
    fn name(&mut self, kind: &str) -> String {
        self.names += 1;
        format!("{kind}{}", self.names)
    }

    /// A `<pose>` relative to something of the scope, and the place that it means.
    fn pose(&mut self, scope: &Scope, usual: DAffine3, must_say: bool) -> (String, DAffine3) {
        let (xyz, rpy) = (self.random.vector(3.0), self.random.vector(3.0));
        let turn =
            DMat3::from_rotation_z(rpy.z) * DMat3::from_rotation_y(rpy.y) * DMat3::from_rotation_x(rpy.x);
        let written = DAffine3::from_mat3_translation(turn, xyz);
        let numbers = format!("{} {} {} {} {} {}", xyz.x, xyz.y, xyz.z, rpy.x, rpy.y, rpy.z);
        if scope.frames.is_empty() || !must_say && self.random.is(0.3) {
            return (format!("<pose>{numbers}</pose>"), usual * written);
        }
        let (frame, Named { at, .. }) = scope.pick(&mut self.random);
        (format!("<pose relative_to='{frame}'>{numbers}</pose>"), at * written)
    }

    fn link(&mut self, scope: &mut Scope) -> String {
        let name = self.name("link");
        let (pose, at) = self.pose(scope, DAffine3::IDENTITY, false);
        scope.frames.insert(name.clone(), Named { at, link: name.clone() });
        scope.links.insert(name.clone(), at);
        let visual = self.name("visual");
        let (visual_pose, visual_at) = self.pose(scope, at, false);
        scope.visuals.insert(visual.clone(), visual_at);
        format!(
            "<link name='{name}'>{pose}<visual name='{visual}'>{visual_pose}<geometry><sphere><radius>1</radius></sphere>\
             </geometry></visual></link>\n"
        )
    }

    fn frame(&mut self, scope: &mut Scope, root: &Named) -> String {
        let name = self.name("frame");
        let attached =
            (!scope.frames.is_empty() && self.random.is(0.7)).then(|| scope.pick(&mut self.random));
        let attribute = attached.as_ref().map_or_else(String::new, |(to, _)| format!(" attached_to='{to}'"));
        let to = attached.map_or_else(|| root.clone(), |(_, named)| named);
        let (pose, at) = self.pose(scope, to.at, false);
        scope.frames.insert(name.clone(), Named { at, link: to.link });
        format!("<frame name='{name}'{attribute}>{pose}</frame>\n")
    }

    fn joint(&mut self, scope: &mut Scope) -> String {
        let ((parent, parent_of), (child, child_of)) =
            (scope.pick(&mut self.random), scope.pick(&mut self.random));
        if parent_of.link == child_of.link {
            return String::new();
        }
        let name = self.name("joint");
        let (pose, at) = self.pose(scope, child_of.at, false);
        let axis = self.random.vector(1.0);
        let (attribute, axis_in) = if self.random.is(0.5) {
            let (frame, named) = scope.pick(&mut self.random);
            (format!(" expressed_in='{frame}'"), named.at)
        } else {
            (String::new(), at)
        };
        let hinge = Hinge {
            parent: parent_of.link,
            child: child_of.link.clone(),
            at: at.translation,
            axis: axis_in.transform_vector3(axis).normalize(),
        };
        scope.joints.insert(name.clone(), hinge);
        scope.frames.insert(name.clone(), Named { at, link: child_of.link });
        format!(
            "<joint name='{name}' type='revolute'>{pose}<parent>{parent}</parent><child>{child}</child>\
             <axis><xyz{attribute}>{} {} {}</xyz></axis></joint>\n",
            axis.x, axis.y, axis.z
        )
    }

    /// A model's content as text, and what is in it. `__model__` is one of its frames.
    fn model(&mut self, depth: usize) -> (String, Scope) {
        let mut scope = Scope::default();
        // The first link is the canonical one, and no frame is called `__model__` before there is one.
        let first = self.link(&mut scope);
        let canonical = scope.links.keys().next().unwrap().clone();
        let root = Named { at: DAffine3::IDENTITY, link: canonical };
        scope.frames.insert("__model__".into(), root.clone());
        let mut parts = Vec::new();
        for _ in 0..self.random.below(12) {
            parts.push(match self.random.below(if depth < 3 { 10 } else { 7 }) {
                0 | 1 => self.link(&mut scope),
                2..5 => self.frame(&mut scope, &root),
                5 | 6 => self.joint(&mut scope),
                7 | 8 => self.nested(&mut scope, depth + 1),
                _ => self.include(&mut scope, depth + 1, true),
            });
        }
        let mut text = first;
        while !parts.is_empty() {
            let next = self.random.below(parts.len());
            text.push_str(&parts.swap_remove(next));
        }
        (text, scope)
    }

    /// Draws a frame that places a model whose content is known.
    fn placement(&mut self, inside: &Scope) -> Option<(String, DAffine3)> {
        if self.random.is(0.4) {
            return None;
        }
        let (frame, named) = inside.pick(&mut self.random);
        Some((frame, named.at))
    }

    fn nested(&mut self, scope: &mut Scope, depth: usize) -> String {
        let (text, inside) = self.model(depth);
        let name = self.name("model");
        let (pose, placed_at) = self.pose(scope, DAffine3::IDENTITY, false);
        let placement = self.placement(&inside);
        let attribute =
            placement.as_ref().map_or_else(String::new, |(frame, _)| format!(" placement_frame='{frame}'"));
        let at = placement.map_or(placed_at, |(_, inner)| placed_at * inner.inverse());
        Self::add(scope, inside, &name, at);
        format!("<model name='{name}'{attribute}>{pose}\n{text}</model>\n")
    }

    fn add(scope: &mut Scope, inside: Scope, name: &str, at: DAffine3) {
        let link = inside.frames["__model__"].link.clone();
        scope.take(inside, at, &|inner| format!("{name}::{inner}"));
        scope.frames.insert(name.to_owned(), Named { at, link: format!("{name}::{link}") });
    }

    fn include(&mut self, scope: &mut Scope, depth: usize, may_merge: bool) -> String {
        let (text, mut inside) = self.model(depth);
        let file = self.name("file");
        let own_placement = self.placement(&inside);
        let (own_pose, own_at) = self.pose(&Scope::default(), DAffine3::IDENTITY, false);
        let attribute = own_placement
            .as_ref()
            .map_or_else(String::new, |(frame, _)| format!(" placement_frame='{frame}'"));
        self.folder.write(
            &format!("{file}/model.sdf"),
            format!("<sdf version='1.9'><model name='{file}'{attribute}>{own_pose}{text}</model></sdf>"),
        );
        let mut include = format!("<uri>model://{file}</uri>");
        let mut at = own_placement.as_ref().map_or(own_at, |(_, inner)| own_at * inner.inverse());
        if self.random.is(0.6) {
            let (pose, placed_at) = self.pose(scope, DAffine3::IDENTITY, false);
            let placement = self.placement(&inside);
            include.push_str(&pose);
            if let Some((frame, _)) = &placement {
                let _ = write!(include, "<placement_frame>{frame}</placement_frame>");
            }
            // The model keeps its own frame unless the <include> names another one, as in libsdformat 12.3.
            let placement = placement.or(own_placement);
            at = placement.map_or(placed_at, |(_, inner)| placed_at * inner.inverse());
        }
        if may_merge && self.random.is(0.3) {
            // Its parts keep their names; only the name of its own frame is another one.
            let link = inside.frames.remove("__model__").unwrap().link;
            let proxy = format!("_merged__{file}__model__");
            scope.take(inside, at, &|inner| inner.to_owned());
            scope.frames.insert(proxy, Named { at, link });
            return format!("<include merge='true'>{include}</include>\n");
        }
        let mut name = file;
        if self.random.is(0.5) {
            name = self.name("model");
            let _ = write!(include, "<name>{name}</name>");
        }
        Self::add(scope, inside, &name, at);
        format!("<include>{include}</include>\n")
    }

    fn world(&mut self) -> (String, Scope) {
        let mut scope = Scope::default();
        let root = Named { at: DAffine3::IDENTITY, link: String::new() };
        let mut parts: Vec<String> = (0..4)
            .map(|_| match self.random.below(4) {
                0 | 1 => self.nested(&mut scope, 0),
                2 => self.include(&mut scope, 0, false),
                _ => self.frame(&mut scope, &root),
            })
            .collect();
        parts.reverse();
        (parts.concat(), scope)
    }
}

#[track_caller]
fn assert_at(found: Pose, expected: DAffine3, what: &str) {
    for point in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z] {
        let (found, expected) = (found.transform_point(point), expected.transform_point3(point));
        assert!((found - expected).length() < 1e-9, "{what}: {found} is not {expected}");
    }
}

/// Compares a model with what was drawn, and returns how many links and joints it has.
fn compare(model: &Model, expected: &Scope, what: &str) -> [usize; 2] {
    let full = |name: &str| format!("{}::{name}", model.name);
    for link in &model.links {
        let name = full(&link.name);
        let at = model.world_from_model * link.model_from_link;
        assert_at(at, expected.links[&name], &format!("{what}, {name}"));
        for visual in &link.visuals {
            let at = at * visual.link_from_visual;
            assert_at(at, expected.visuals[&visual.name], &format!("{what}, {}", visual.name));
        }
    }
    let canonical = full(&model.links[model.canonical_link].name);
    assert_eq!(canonical, expected.frames[&model.name].link, "{what}");
    for joint in &model.joints {
        let (name, [parent, child]) =
            (full(&joint.name), [joint.parent, joint.child].map(|link| &model.links[link]));
        let hinge = &expected.joints[&name];
        assert_eq!(
            [full(&parent.name), full(&child.name)],
            [hinge.parent.clone(), hinge.child.clone()],
            "{what}, {name}"
        );
        let child_at = model.world_from_model * child.model_from_link;
        assert!((child_at.transform_point(joint.pivot) - hinge.at).length() < 1e-9, "{what}, {name}");
        assert!((child_at.transform_vector(joint.axis) - hinge.axis).length() < 1e-9, "{what}, {name}");
        let parent_at = model.world_from_model * parent.model_from_link;
        assert_at(
            parent_at * joint.parent_from_child,
            expected.links[&hinge.child],
            &format!("{what}, {name}"),
        );
    }
    [model.links.len(), model.joints.len()]
}

#[test]
fn a_hundred_worlds_stand_where_they_were_drawn() {
    let mut found = [0; 2];
    for seed in 0..100 {
        let folder = Folder::new();
        let mut generator = Generator { random: Random(seed), folder: &folder, names: 0 };
        let (text, expected) = generator.world();
        let (world, problems) = folder.load("1.9", &text, false);
        let what = format!("seed {seed}");
        assert!(problems.is_empty(), "{what}: {problems:#?}\n{text}");
        let world = world.unwrap();
        let [mut links, mut joints] = [0; 2];
        for model in &world.models {
            let [more, more_joints] = compare(model, &expected, &what);
            (links, joints) = (links + more, joints + more_joints);
        }
        assert_eq!([links, joints], [expected.links.len(), expected.joints.len()], "{what}");
        found = [found[0] + links, found[1] + joints];
    }
    assert!(found[0] > 1000 && found[1] > 200, "{found:?}");
}

//! Looks in worlds: colours, highlights, alpha, roughness and metalness, normal maps, fog and sky.

use crate::sdf;
use crate::sdf::*;
use belvedere::description::Severity;
use belvedere::description::model::{Channel, PbrMaps};
use belvedere_sensors::scene::{Air, Fog, FogLaw, Pbr, Sky, TextureAlpha};

#[test]
fn materials() {
    let folder = Folder::new();
    folder.write("tags/materials/textures/a.png", b"");
    folder.write(
        "tags/materials/scripts/tags.material",
        "material Base { technique { pass { ambient 0.5 0.5 0.5\n diffuse 1 0 0\n } } }
         material Tag : Base { technique { pass { texture_unit { texture a.png\n scale 0.25 0.5\n } } } }",
    );
    let script =
        "<script><uri>model://tags/materials/scripts</uri><uri>model://tags/materials/textures</uri>";
    let look = |material: String| {
        let content = box_visual(&format!("<material>{material}</material>"));
        let (world, problems) = folder.load("1.6", &content, false);
        assert!(problems.is_empty(), "{problems:#?}");
        world.unwrap().models[0].links[0].visuals[0].material.clone()
    };
    let tag = look(format!("{script}<name>Tag</name></script>"));
    assert_eq!((tag.ambient, tag.diffuse, tag.texture_repeat), ([0.5; 3], [1.0, 0.0, 0.0], [4.0, 2.0]));
    assert!(tag.texture.unwrap().is_absolute());
    // Colours override those of the script; a single colour is used for both lights.
    let blue = look(format!("{script}<name>Tag</name></script><diffuse>0 0 1 1</diffuse>"));
    assert_eq!((blue.ambient, blue.diffuse), ([0.5; 3], [0.0, 0.0, 1.0]));
    let green = look("<diffuse>0 1 0 1</diffuse><emissive>0.1 0 0 1</emissive>".into());
    assert_eq!(
        (green.ambient, green.diffuse, green.emissive),
        ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.0, 0.0])
    );
    let pbr = look("<pbr><metal><albedo_map>tags/materials/textures/a.png</albedo_map></metal></pbr>".into());
    assert!(pbr.texture.unwrap().ends_with("a.png") && pbr.diffuse == [1.0; 3]);
    let grey = look(
        "<script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Grey</name></script>"
            .into(),
    );
    assert_eq!((grey.diffuse, grey.specular, grey.shininess), ([0.7; 3], [0.01; 3], 1.5));
}

#[test]
fn gloss_and_alpha() {
    let folder = Folder::new();
    folder.write("tags/materials/textures/a.png", b"");
    folder.write(
        "tags/materials/scripts/tags.material",
        "material Fence { technique { pass { diffuse 1 1 1 0.5\n specular 0.1 0.2 0.3 12.5\n alpha_rejection greater 127\n
         texture_unit { texture a.png } } } }",
    );
    let look = |visual: String| {
        let geometry = "<geometry><box><size>1 1 1</size></box></geometry>";
        let (world, problems) = folder.load("1.6", &sdf::visual(&format!("{geometry}{visual}")), false);
        assert!(problems.is_empty(), "{problems:#?}");
        let material = world.unwrap().models[0].links[0].visuals[0].material.clone();
        (material.specular, material.shininess, material.alpha, material.texture_alpha)
    };
    let material = |text: &str| look(format!("<material>{text}</material>"));
    let opaque = TextureAlpha::Ignored;
    let shiny = "<diffuse>1 1 1 0.5</diffuse><specular>0.4 0.5 0.6 1</specular>";
    assert_eq!(material(shiny), ([0.4, 0.5, 0.6], 0.0, 0.5, opaque), "no shininess, no highlight");
    let glossy = format!("{shiny}<shininess>30</shininess>");
    assert_eq!(material(&glossy), ([0.4, 0.5, 0.6], 30.0, 0.5, opaque));
    let glass = look(format!("<transparency>0.2</transparency><material>{glossy}</material>"));
    assert_eq!(glass, ([0.4, 0.5, 0.6], 30.0, 0.4, opaque));
    assert_eq!(look("<transparency>0.25</transparency>".into()).2, 0.75);
    let script = "<script><uri>model://tags/materials/scripts</uri><uri>model://tags/materials/textures</uri>\
                  <name>Fence</name></script>";
    let cut_out = TextureAlpha::CutOut { least: 0.5 };
    assert_eq!(material(script), ([0.1, 0.2, 0.3], 12.5, 0.5, cut_out));
    let dull = format!("{script}<specular>1 1 1 1</specular>");
    assert_eq!(
        material(&dull),
        ([1.0; 3], 0.0, 0.5, cut_out),
        "as in Gazebo, the script's shininess is ignored"
    );
    let pbr = "<pbr><metal><albedo_map>tags/materials/textures/a.png</albedo_map></metal></pbr>";
    assert_eq!(material(pbr), ([0.0; 3], 0.0, 1.0, cut_out));
}

#[test]
fn roughness_and_metalness() {
    let folder = Folder::new();
    folder.write("tags/materials/textures/a.png", b"");
    folder.write(
        "tags/materials/scripts/tags.material",
        "material Tag { technique { pass { diffuse 1 0 0 } } }",
    );
    let load = |material: &str| {
        let content = box_visual(&format!("<material>{material}</material>"));
        let (world, problems) = folder.load("1.6", &content, false);
        (world.map(|world| world.models[0].links[0].visuals[0].material.clone()), problems)
    };
    let look = |material: &str| {
        let (look, problems) = load(material);
        assert!(problems.is_empty(), "{material}: {problems:#?}");
        look.unwrap()
    };
    let white = [1.0; 3];
    let pbr = |roughness, metalness, highlights| Some(Pbr { roughness, metalness, highlights });
    for (text, expected) in [
        ("<metal><roughness>0.25</roughness><metalness>1</metalness></metal>", pbr(0.25, 1.0, white)),
        // The defaults of SDF.
        ("<metal><albedo_map>tags/materials/textures/a.png</albedo_map></metal>", pbr(0.5, 0.5, white)),
        ("<specular><glossiness>0.75</glossiness></specular>", pbr(0.25, 0.0, white)),
        ("<specular/>", pbr(1.0, 0.0, white)),
    ] {
        assert_eq!(look(&format!("<pbr>{text}</pbr>")).pbr, expected, "{text}");
    }
    let red = "<diffuse>1 0 0 1</diffuse><specular>0.5 0.25 0 1</specular>";
    let tinted = look(&format!("{red}<pbr><metal><metalness>0</metalness></metal></pbr>"));
    assert_eq!((tinted.diffuse, tinted.pbr), ([1.0, 0.0, 0.0], pbr(0.5, 0.0, [0.5, 0.25, 0.0])));
    assert_eq!(look(red).pbr, None);
    // A script is the look of Gazebo classic, and `<pbr>` that of its successors.
    let script = "<script><uri>model://tags/materials/scripts</uri><name>Tag</name></script>";
    assert_eq!(look(&format!("{script}<pbr><metal/></pbr>")).pbr, None);

    let (_, problems) = load("<pbr><metal><roughness>1.5</roughness></metal></pbr>");
    assert!(
        problems[0].to_string().contains("<roughness> is 1.5; write a number from 0 to 1"),
        "{problems:?}"
    );
}

#[test]
fn maps_of_pbr() {
    let folder = Folder::new();
    let load = |metal: &str, more: &str| {
        let look = format!("<material>{more}<pbr><metal>{metal}</metal></pbr></material>");
        let (world, problems) = folder.load("1.6", &box_visual(&look), false);
        (world.unwrap().models[0].links[0].visuals[0].material.clone(), problems)
    };
    for name in ["r", "m", "e"] {
        folder.write(&format!("tags/materials/textures/{name}.png"), b"");
    }
    let map = |of: &str| {
        let file = &of[..1];
        format!("<{of}_map>tags/materials/textures/{file}.png</{of}_map>")
    };
    let (look, problems) = load(&["roughness", "metalness", "emissive"].map(map).concat(), "");
    assert!(problems.is_empty(), "{problems:?}");
    let file = |channel: &Option<Channel>| {
        let channel = channel.as_ref().unwrap();
        (channel.path.file_name().unwrap().to_str().unwrap().to_owned(), channel.channel)
    };
    assert_eq!(file(&look.pbr_maps.roughness), ("r.png".into(), 0));
    assert_eq!(file(&look.pbr_maps.metalness), ("m.png".into(), 0));
    assert!(look.emissive_map.unwrap().ends_with("e.png"));
    // A map is multiplied by the number, and that is 0.5 if the file does not say it; without an emissive colour, it is
    // the map alone that counts.
    let pbr = look.pbr.unwrap();
    assert_eq!(([pbr.roughness, pbr.metalness], look.emissive), ([0.5; 2], [1.0; 3]));
    let red = "<emissive>1 0 0 1</emissive>";
    assert_eq!(load(&map("emissive"), red).0.emissive, [1.0, 0.0, 0.0]);
    assert_eq!(load("", red).0.emissive, [1.0, 0.0, 0.0]);
    assert_eq!((load("", "").0.emissive, load("", "").0.pbr_maps), ([0.0; 3], PbrMaps::default()));
    // A script is the look of Gazebo classic.
    let (classic, problems) = load(&map("roughness"), "<script><name>Gazebo/Grey</name></script>");
    assert_eq!((classic.pbr_maps, classic.emissive_map), (PbrMaps::default(), None));
    assert!(problems.is_empty(), "{problems:?}");
    let (_, problems) = load(&map("roughness").replace("r.png", "gone.png"), "");
    assert!(
        problems[0].severity == Severity::Warning && problems[0].to_string().contains("gone.png"),
        "{problems:?}"
    );
}

#[test]
fn fog_and_sky() {
    let air = |scene: &str| good("1.6", &format!("<scene>{scene}</scene>")).air;
    let fog = |inside: &str| air(&format!("<fog>{inside}</fog>")).fog;
    let white = [1.0; 3];
    for (inside, expected) in [
        (
            "<type>linear</type>",
            Some(Fog { colour: white, law: FogLaw::Linear { start_m: 1.0, end_m: 100.0 } }),
        ),
        (
            "<type>exp</type><density>0.25</density><color>1 0.5 0 1</color>",
            Some(Fog { colour: [1.0, 0.5, 0.0], law: FogLaw::Exponential { density_per_m: 0.25 } }),
        ),
        (
            "<type>exp2</type>",
            Some(Fog { colour: white, law: FogLaw::ExponentialSquared { density_per_m: 1.0 } }),
        ),
        ("<type>none</type><density>0.25</density>", None),
        ("", None),
    ] {
        assert_eq!(fog(inside), expected, "{inside}");
    }
    assert_eq!(air("<sky><time>10</time></sky>").sky, Some(Sky::DAY));
    assert_eq!(air("<ambient>1 1 1 1</ambient>"), Air::default());
    for (inside, words) in [
        (
            "<type>linear</type><start>9</start><end>9</end>",
            "it starts at 9 m and ends at 9 m: write an <end>",
        ),
        ("<type>quadratic</type>", "the <type> 'quadratic' is unknown, as it is to Gazebo: write linear"),
        ("<type>exp</type><density>-1</density>", "<density> is -1: write a number from 0"),
    ] {
        let content = format!("<scene><fog>{inside}</fog></scene>");
        let (_, problems) = Folder::new().load("1.6", &content, false);
        let [problem] = &problems[..] else { panic!("{inside}: {problems:#?}") };
        assert!(problem.to_string().replace("; ", ": ").contains(words), "{problem}");
    }
}

#[test]
fn normal_maps() {
    let folder = Folder::new();
    folder.write("tags/materials/textures/n.png", b"");
    let load = |material: &str| {
        let (world, problems) =
            folder.load("1.6", &box_visual(&format!("<material>{material}</material>")), false);
        (world.unwrap().models[0].links[0].visuals[0].material.normal_map.clone(), problems)
    };
    let shader = "<script><uri>model://tags/materials/textures</uri><name>Gazebo/Grey</name></script>\
                  <shader type='normal_map_tangent_space'><normal_map>n.png</normal_map></shader>";
    let pbr = "<pbr><metal><normal_map>tags/materials/textures/n.png</normal_map></metal></pbr>";
    for material in [shader, pbr] {
        let (map, problems) = load(material);
        assert!(problems.is_empty() && map.unwrap().ends_with("n.png"), "{material}: {problems:#?}");
    }
    for (material, words) in [
        (shader.replace("tangent", "object"), "<shader> is ignored"),
        (pbr.replace("<normal_map>", "<normal_map type='object'>"), "<normal_map> is ignored"),
        (pbr.replace("n.png", "gone.png"), "gone.png"),
    ] {
        let (map, problems) = load(&material);
        assert!(
            map.is_none() && matches!(&problems[..], [only] if only.to_string().contains(words)),
            "{problems:#?}"
        );
    }
}

/// Pictures in TIFF are not read. Each place that can name one says so, and the remedy names formats that are.
#[test]
fn a_picture_in_tiff_is_told_with_the_formats_that_are_read() {
    let folder = Folder::new();
    folder.write("t.tif", b"II*\0\x08\0\0\0\0\0\0\0\0\0");
    folder.write("m/a.material", "material A { technique { pass { texture_unit { texture t.tif\n } } } }");
    folder.write("m/t.tif", b"II*\0");
    folder.write("box.obj", "mtllib box.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    folder.write("box.mtl", "newmtl m\nmap_Kd t.tif\n");
    let map = "<material><pbr><metal><albedo_map>t.tif</albedo_map></metal></pbr></material>";
    let script = "<material><script><uri>file://m</uri><name>A</name></script></material>";
    let mesh = "<geometry><mesh><uri>box.obj</uri></mesh></geometry>";
    let terrain = "<geometry><heightmap><uri>t.tif</uri><size>1 1 1</size></heightmap></geometry>";
    for content in [box_visual(map), box_visual(script), visual(mesh), visual(terrain)] {
        let (world, mut problems) = folder.load("1.6", &content, false);
        if let (Some(world), true) = (world, problems.is_empty()) {
            let built = belvedere::simulation::Simulation::builder(world).build();
            problems = built.map(|simulation| simulation.notes().to_vec()).unwrap_or_default();
        }
        let [problem] = &problems[..] else { panic!("{content}: {problems:#?}") };
        let text = problem.to_string();
        let (what, remedy) = text.split_once("; ").unwrap();
        assert!(what.contains("t.tif") && remedy.to_lowercase().contains("png"), "{text}");
    }
}

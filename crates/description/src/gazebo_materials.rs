//! The materials that are built into Gazebo classic: `Gazebo/Grey`, `Gazebo/Wood`, …
//!
//! Robots name them in `<gazebo reference="…"><material>Gazebo/Grey</material>`, worlds in
//! `<material><script><name>Gazebo/Grey</name>`. Ambient, diffuse and emissive colours, gloss and alpha are those of Gazebo
//! classic 11's own material script. One thing differs:
//!
//! - Materials with an image (wood, bricks, …) have a typical mean colour instead: the images belong to Gazebo
//!   and are not shipped.

use super::model::Material;

/// One row: the name after `Gazebo/`, ambient, diffuse, emissive.
type Row = (&'static str, [f32; 3], [f32; 3], [f32; 3]);

const BLACK: [f32; 3] = [0.0; 3];

/// Returns a row whose ambient and diffuse colours are the same, without emission.
const fn plain(name: &'static str, color: [f32; 3]) -> Row {
    (name, color, color, BLACK)
}

/// Returns a row of a surface that emits light.
const fn glowing(name: &'static str, color: [f32; 3]) -> Row {
    (name, color, color, color)
}

#[rustfmt::skip]
const MATERIALS: &[Row] = &[
    // Plain colours.
    ("Grey", [0.3; 3], [0.7; 3], BLACK),
    plain("DarkGrey", [0.175; 3]),
    plain("White", [1.0; 3]),
    plain("FlatBlack", [0.1; 3]),
    plain("Black", BLACK),
    plain("Red", [1.0, 0.0, 0.0]),
    plain("RedBright", [0.87, 0.26, 0.07]),
    plain("Green", [0.0, 1.0, 0.0]),
    plain("Blue", [0.0, 0.0, 1.0]),
    ("SkyBlue", [0.13, 0.44, 0.70], [0.0, 0.0, 1.0], BLACK),
    plain("Yellow", [1.0, 1.0, 0.0]),
    plain("ZincYellow", [0.9725, 0.9529, 0.2078]),
    plain("DarkYellow", [0.7, 0.7, 0.0]),
    plain("Purple", [1.0, 0.0, 1.0]),
    plain("Turquoise", [0.0, 1.0, 1.0]),
    plain("Orange", [1.0, 0.5088, 0.0468]),
    plain("Indigo", [0.33, 0.0, 0.5]),
    plain("JointAnchor", [1.0; 3]),
    // Gazebo uses vertex colours, which shapes do not have.
    plain("PointCloud", [1.0; 3]),
    ("Gold", [0.4, 0.248_69, 0.020_759], [0.8, 0.648_69, 0.120_759], BLACK),
    ("Pioneer2Body", [0.481_193, 0.000_123, 0.000_123], [0.681_193, 0.000_923, 0.000_923], BLACK),
    // Emissive materials.
    glowing("WhiteGlow", [1.0; 3]),
    glowing("RedGlow", [1.0, 0.0, 0.0]),
    glowing("GreenGlow", [0.0, 1.0, 0.0]),
    glowing("BlueGlow", [0.0, 0.0, 1.0]),
    glowing("YellowGlow", [1.0, 1.0, 0.0]),
    glowing("PurpleGlow", [1.0, 0.0, 1.0]),
    glowing("TurquoiseGlow", [0.0, 1.0, 1.0]),
    glowing("TurquoiseGlowOutline", [0.0, 1.0, 1.0]),
    glowing("LightOn", [0.0, 1.0, 0.0]),
    glowing("LightOff", [1.0, 0.0, 0.0]),
    // Transparent: see ALPHAS. The overlays are unlit in Gazebo.
    plain("RedTransparent", [1.0, 0.0, 0.0]),
    plain("GreenTransparent", [0.0, 1.0, 0.0]),
    plain("BlueTransparent", [0.0, 0.0, 1.0]),
    plain("DarkMagentaTransparent", [0.6, 0.0, 0.6]),
    plain("GreyTransparent", [0.5; 3]),
    plain("BlackTransparent", BLACK),
    plain("YellowTransparent", [1.0, 1.0, 0.0]),
    plain("OrangeTransparent", [1.0, 0.44, 0.0]),
    plain("LightBlueLaser", [0.5, 0.5, 1.0]),
    plain("BlueLaser", [0.0, 0.0, 1.0]),
    plain("RedTransparentOverlay", [1.0, 0.0, 0.0]),
    plain("GreenTransparentOverlay", [0.0, 1.0, 0.0]),
    plain("BlueTransparentOverlay", [0.0, 0.0, 1.0]),
    plain("OrangeTransparentOverlay", [1.0, 0.5088, 0.0468]),
    plain("DarkOrangeTransparentOverlay", [0.6, 0.305, 0.028]),
    // Images in Gazebo; here a mean colour of our choice.
    plain("Wood", [0.62, 0.45, 0.28]),
    plain("WoodFloor", [0.60, 0.42, 0.25]),
    plain("WoodPallet", [0.66, 0.54, 0.38]),
    plain("Bricks", [0.55, 0.31, 0.24]),
    plain("CeilingTiled", [0.80, 0.80, 0.78]),
    plain("PaintedWall", [0.83, 0.81, 0.74]),
    plain("PioneerBody", [0.60, 0.05, 0.05]),
    plain("BuildingFrame", [0.70, 0.68, 0.64]),
    plain("Grass", [0.27, 0.40, 0.17]),
    plain("Steps", [0.55, 0.53, 0.50]),
    plain("Road", [0.30, 0.30, 0.30]),
    plain("Residential", [0.33, 0.33, 0.33]),
    plain("Tertiary", [0.33, 0.33, 0.33]),
    plain("Secondary", [0.32, 0.32, 0.32]),
    plain("Primary", [0.32, 0.32, 0.32]),
    plain("Trunk", [0.31, 0.31, 0.31]),
    plain("Motorway", [0.30, 0.30, 0.30]),
    plain("Lane_1", [0.32, 0.32, 0.32]),
    plain("Lanes_2", [0.32, 0.32, 0.32]),
    plain("Lanes_4", [0.31, 0.31, 0.31]),
    plain("Lanes_6", [0.30, 0.30, 0.30]),
    plain("Pedestrian", [0.58, 0.57, 0.55]),
    plain("Footway", [0.58, 0.57, 0.55]),
    plain("Runway", [0.35, 0.35, 0.35]),
    plain("CoM", [0.50, 0.50, 0.25]),
    plain("GreyGradientSky", [0.60, 0.60, 0.60]),
    plain("CloudySky", [0.55, 0.66, 0.80]),
    plain("Editor", [0.70, 0.70, 0.70]),
    plain("EditorPlane", [0.70, 0.70, 0.70]),
];

/// Name, highlight colour and shininess of a glossy material.
type Gloss = (&'static str, [f32; 3], f32);

#[rustfmt::skip]
const GLOSS: &[Gloss] = &[
    ("Grey", [0.01; 3], 1.5),
    ("DarkGrey", [0.175; 3], 1.5),
    ("White", [0.1; 3], 128.0),
    ("FlatBlack", [0.01; 3], 1.0),
    ("Black", [0.1; 3], 5.0),
    ("Red", [0.1; 3], 1.0),
    ("RedBright", [0.87, 0.26, 0.07], 1.0),
    ("Green", [0.1; 3], 1.0),
    ("Blue", [0.1; 3], 1.0),
    ("SkyBlue", [0.1; 3], 1.0),
    ("ZincYellow", [0.9725, 0.9529, 0.2078], 1.0),
    ("Purple", [0.1; 3], 1.0),
    ("Turquoise", [0.1; 3], 1.0),
    ("Orange", [0.5; 3], 128.0),
    ("Gold", [0.4; 3], 12.5),
    ("Pioneer2Body", [0.5; 3], 12.5),
    ("PioneerBody", [0.5, 0.0, 0.0], 10.0),
    ("WhiteGlow", [0.1; 3], 128.0),
    ("RedGlow", [1.0, 0.0, 0.0], 128.0),
    ("GreenGlow", [0.1; 3], 1.0),
    ("BlueGlow", [0.1; 3], 1.0),
    ("PurpleGlow", [0.1; 3], 1.0),
    ("TurquoiseGlow", [0.1; 3], 1.0),
    ("TurquoiseGlowOutline", [0.1; 3], 128.0),
    ("Wood", [0.2; 3], 12.5),
    ("Bricks", [0.2; 3], 12.5),
    ("Road", [0.01; 3], 2.0),
    ("Residential", [0.01; 3], 2.0),
    ("Tertiary", [0.01; 3], 2.0),
    ("Primary", [0.01; 3], 2.0),
    ("Trunk", [0.01; 3], 2.0),
    ("Motorway", [0.01; 3], 2.0),
    ("Lanes_4", [0.01; 3], 2.0),
    ("Lanes_6", [0.01; 3], 2.0),
    ("Pedestrian", [0.01; 3], 2.0),
    ("Footway", [0.01; 3], 2.0),
];

/// Other names of materials. Gazebo's own script defines `Gray` and `DarkGray` as `Grey` and `DarkGrey`. `Torquoise` was
/// misspelt there for years, and many robots use that name.
const ALIASES: [(&str, &str); 3] = [("Gray", "Grey"), ("DarkGray", "DarkGrey"), ("Torquoise", "Turquoise")];

/// Alphas of the lasers, and of one material whose alpha is not [`TRANSPARENT`].
const ALPHAS: [(&str, f32); 3] = [("BlueLaser", 0.4), ("LightBlueLaser", 0.4), ("OrangeTransparent", 0.4)];

/// Alpha of all other materials with "Transparent" in their name.
const TRANSPARENT: f32 = 0.5;

fn alpha(name: &str) -> f32 {
    let named = ALPHAS.iter().find(|(row, _)| *row == name).map(|&(_, alpha)| alpha);
    named.unwrap_or(if name.contains("Transparent") { TRANSPARENT } else { 1.0 })
}

/// Returns a built-in material by its full name, such as `Gazebo/Grey`. None if Gazebo has no such material.
///
/// ```
/// use belvedere_description::gazebo_materials::gazebo_material;
/// let grey = gazebo_material("Gazebo/Grey").unwrap();
/// assert_eq!((grey.ambient, grey.diffuse), ([0.3; 3], [0.7; 3]));
/// assert_eq!(gazebo_material("Gazebo/GreenTransparent").unwrap().alpha, 0.5);
/// assert!(gazebo_material("Gazebo/Graay").is_none());
/// ```
pub fn gazebo_material(name: &str) -> Option<Material> {
    let short = name.strip_prefix("Gazebo/")?;
    let short = ALIASES.iter().find(|(alias, _)| *alias == short).map_or(short, |(_, name)| name);
    let gloss = GLOSS.iter().find(|(row, ..)| *row == short);
    let (specular, shininess) =
        gloss.map_or(([0.0; 3], 0.0), |&(_, specular, shininess)| (specular, shininess));
    MATERIALS.iter().find(|(row, ..)| *row == short).map(|&(_, ambient, diffuse, emissive)| Material {
        diffuse,
        ambient,
        emissive,
        specular,
        shininess,
        alpha: alpha(short),
        ..Material::default()
    })
}

/// Returns all built-in names with their prefix, for "did you mean".
pub fn gazebo_material_names() -> impl Iterator<Item = String> {
    MATERIALS.iter().map(|(name, ..)| format!("Gazebo/{name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_of_grey_are_one() {
        for (alias, name) in [("Gazebo/Gray", "Gazebo/Grey"), ("Gazebo/DarkGray", "Gazebo/DarkGrey")] {
            assert_eq!(gazebo_material(alias), gazebo_material(name));
            assert!(gazebo_material(alias).is_some());
        }
        for name in ["CoM", "GreyGradientSky", "CloudySky", "Editor", "EditorPlane", "PointCloud"] {
            assert!(gazebo_material(&format!("Gazebo/{name}")).is_some(), "{name}");
        }
    }
}

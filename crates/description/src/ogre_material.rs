//! Ogre `.material` scripts, as far as they define how a surface looks: `ambient`, `diffuse` with its alpha, `specular`,
//! `emissive`, `scene_blend alpha_blend`, `alpha_rejection greater`, and the first texture with its `scale`, of the first
//! technique. Shaders, other kinds of blending and further layers are ignored.

mod script;

use super::diagnostics::{Diagnostics, Problem, Source};
use super::xml::read_text;
use belvedere_sensors::scene::TextureAlpha;
use script::{Statement, problem, statements};
use std::collections::HashMap;
use std::path::Path;

/// One `material` of a script. None means that the script does not define the value.
#[derive(Debug, Clone, PartialEq)]
pub struct OgreMaterial {
    /// Name after `material`.
    pub name: String,
    /// Name after the colon: the material from which undefined values are inherited.
    pub parent: Option<String>,
    /// Colour under ambient light.
    pub ambient: Option<[f32; 3]>,
    /// Colour under lamps.
    pub diffuse: Option<[f32; 3]>,
    /// Emitted colour.
    pub emissive: Option<[f32; 3]>,
    /// Colour of highlights, and shininess.
    pub specular: Option<[f32; 4]>,
    /// Alpha of the diffuse colour.
    pub alpha: Option<f32>,
    /// How the alpha of the texture is interpreted.
    pub texture_alpha: Option<TextureAlpha>,
    /// File name of the texture, and where the script names it.
    pub texture: Option<(String, Source)>,
    /// Repetitions of the texture: the inverse of Ogre's `scale`.
    pub texture_repeat: Option<[f32; 2]>,
    /// File and line that define it.
    pub source: Source,
}

/// Reads every material of a script.
///
/// # Errors
/// If the file cannot be read, or at the first line that cannot be understood.
pub fn parse_file(path: &Path) -> Result<Vec<OgreMaterial>, Problem> {
    parse(&read_text(path)?, path)
}

/// Reads every material of a script that came from `path`.
///
/// # Errors
/// At the first line that cannot be understood.
///
/// ```
/// use belvedere_description::ogre_material::parse;
/// let script = "material Tag { technique { pass { texture_unit { texture tag.png\n scale 0.5 0.25 } } } }";
/// let tag = &parse(script, "tag.material".as_ref()).unwrap()[0];
/// assert_eq!(tag.texture.as_ref().unwrap().0, "tag.png");
/// assert_eq!(tag.texture_repeat, Some([2.0, 4.0]));
/// ```
pub fn parse(text: &str, path: &Path) -> Result<Vec<OgreMaterial>, Problem> {
    let mut materials = Vec::new();
    for statement in &statements(text, path)? {
        if statement.words.first().is_some_and(|word| word == "material") {
            materials.push(material(statement, path)?);
        }
    }
    Ok(materials)
}

/// The greatest number of materials that one inherits from, one through another.
const MOST_PARENTS: usize = 100;

/// The materials of some scripts, by name. The first one of a name is used.
#[derive(Debug, Default)]
pub struct Library {
    materials: Vec<OgreMaterial>,
    by_name: HashMap<String, usize>,
}

impl Library {
    /// Creates a library of materials, in the order of their scripts.
    pub fn new(materials: Vec<OgreMaterial>) -> Self {
        let mut by_name = HashMap::new();
        for (index, material) in materials.iter().enumerate() {
            by_name.entry(material.name.clone()).or_insert(index);
        }
        Self { materials, by_name }
    }

    /// Returns the names of its materials, in the order of their scripts.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.materials.iter().map(|material| material.name.as_str())
    }

    fn find(&self, name: &str) -> Option<&OgreMaterial> {
        self.by_name.get(name).map(|index| &self.materials[*index])
    }

    /// Returns the material of that name with everything it inherits. A missing parent or a circle of parents is an
    /// error.
    pub fn inherited(&self, name: &str, diagnostics: &mut Diagnostics) -> Option<OgreMaterial> {
        let mut merged = self.find(name)?.clone();
        let mut passed = vec![name.to_owned()];
        while let Some(parent_name) = merged.parent.take() {
            let Some(parent) = self.find(&parent_name) else {
                diagnostics.error(
                    &merged.source,
                    format!(
                        "the material '{name}' inherits from '{parent_name}', which is in none of its scripts"
                    ),
                    "name the folder of that script in a <uri> too",
                );
                return Some(merged);
            };
            if passed.contains(&parent_name) {
                diagnostics.error(
                    &merged.source,
                    format!("the material '{name}' inherits from itself"),
                    "break the circle of ':'",
                );
                return Some(merged);
            }
            if passed.len() > MOST_PARENTS {
                diagnostics.error(
                    &merged.source,
                    format!("the material '{name}' inherits from more than {MOST_PARENTS} others"),
                    "write what it inherits into the material itself",
                );
                return Some(merged);
            }
            merged.ambient = merged.ambient.or(parent.ambient);
            merged.diffuse = merged.diffuse.or(parent.diffuse);
            merged.emissive = merged.emissive.or(parent.emissive);
            merged.specular = merged.specular.or(parent.specular);
            merged.alpha = merged.alpha.or(parent.alpha);
            merged.texture_alpha = merged.texture_alpha.or(parent.texture_alpha);
            merged.texture = merged.texture.or_else(|| parent.texture.clone());
            merged.texture_repeat = merged.texture_repeat.or(parent.texture_repeat);
            merged.parent.clone_from(&parent.parent);
            passed.push(parent_name);
        }
        Some(merged)
    }
}

fn material(statement: &Statement, path: &Path) -> Result<OgreMaterial, Problem> {
    // `material NAME`, `material NAME : PARENT`, also written `NAME: PARENT` and `NAME :PARENT`.
    let header = statement.words[1..].join(" ");
    let (name, parent) = match header.split_once(" :").or_else(|| header.split_once(": ")) {
        Some((name, parent)) => (name.trim(), Some(parent.trim())),
        None => (header.trim(), None),
    };
    if name.is_empty() {
        return Err(problem(
            path,
            statement.line,
            "'material' has no name".into(),
            "write material NAME { … }",
        ));
    }
    let mut material = OgreMaterial {
        name: name.to_owned(),
        parent: parent.filter(|parent| !parent.is_empty()).map(str::to_owned),
        ambient: None,
        diffuse: None,
        emissive: None,
        specular: None,
        alpha: None,
        texture_alpha: None,
        texture: None,
        texture_repeat: None,
        source: Source::new(path, statement.line),
    };
    let technique =
        statement.block.iter().find(|child| child.words.first().is_some_and(|w| w == "technique"));
    for pass in technique.iter().flat_map(|technique| &technique.block) {
        if pass.words.first().is_some_and(|word| word == "pass") {
            read_pass(pass, path, &mut material)?;
        }
    }
    Ok(material)
}

/// Reads from a pass the values that no earlier pass has defined.
fn read_pass(pass: &Statement, path: &Path, material: &mut OgreMaterial) -> Result<(), Problem> {
    for statement in &pass.block {
        let Some(word) = statement.words.first() else { continue };
        match word.as_str() {
            "ambient" => set(&mut material.ambient, color(statement, path)?),
            "diffuse" => {
                set(&mut material.diffuse, color(statement, path)?);
                material.alpha = material.alpha.or(alpha(statement, path)?);
            }
            "specular" => material.specular = material.specular.or(specular(statement, path)?),
            "scene_blend" if statement.words.get(1).is_some_and(|kind| kind == "alpha_blend") => {
                material.texture_alpha = material.texture_alpha.or(Some(TextureAlpha::Blended));
            }
            "alpha_rejection" => {
                material.texture_alpha = cut_out(statement, path)?.or(material.texture_alpha);
            }
            "emissive" => set(&mut material.emissive, color(statement, path)?),
            "texture_unit" if material.texture.is_none() => {
                for line in &statement.block {
                    match line.words.first().map(String::as_str) {
                        Some("texture") => {
                            material.texture =
                                line.words.get(1).map(|file| (file.clone(), Source::new(path, line.line)));
                        }
                        Some("scale") => material.texture_repeat = Some(repeat(line, path)?),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn set(slot: &mut Option<[f32; 3]>, value: Option<[f32; 3]>) {
    *slot = slot.or(value);
}

/// Reads the finite numbers after the keyword.
fn values(statement: &Statement, path: &Path) -> Result<Vec<f32>, Problem> {
    statement.words[1..]
        .iter()
        .map(|word| match word.parse::<f32>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(problem(
                path,
                statement.line,
                format!("'{}': '{word}' is not a finite number", statement.words.join(" ")),
                "write numbers separated by spaces",
            )),
        })
        .collect()
}

/// Reads `keyword r g b [a …]`; none for `vertexcolour`.
fn color(statement: &Statement, path: &Path) -> Result<Option<[f32; 3]>, Problem> {
    if statement.words.get(1).is_some_and(|word| word.starts_with("vertexcolo")) {
        return Ok(None);
    }
    match values(statement, path)?[..] {
        [r, g, b, ..] => Ok(Some([r, g, b])),
        _ => Err(problem(
            path,
            statement.line,
            format!("'{}': a colour has at least three numbers", statement.words.join(" ")),
            "write red, green and blue between 0 and 1",
        )),
    }
}

/// Reads the alpha of `keyword r g b a`; none if it is absent.
fn alpha(statement: &Statement, path: &Path) -> Result<Option<f32>, Problem> {
    if statement.words.len() < 5 {
        return Ok(None);
    }
    Ok(values(statement, path)?.get(3).copied())
}

/// Reads `specular r g b [a] shininess`.
fn specular(statement: &Statement, path: &Path) -> Result<Option<[f32; 4]>, Problem> {
    if statement.words.get(1).is_some_and(|word| word.starts_with("vertexcolo")) {
        return Ok(None);
    }
    match values(statement, path)?[..] {
        [r, g, b, shininess] | [r, g, b, _, shininess] => Ok(Some([r, g, b, shininess])),
        _ => Err(problem(
            path,
            statement.line,
            format!("'{}': a specular colour has four or five numbers", statement.words.join(" ")),
            "write red, green, blue, optionally alpha, and the shininess",
        )),
    }
}

/// Reads `alpha_rejection greater N` or `greater_equal N`, N of 255; other functions are ignored.
fn cut_out(statement: &Statement, path: &Path) -> Result<Option<TextureAlpha>, Problem> {
    let words: Vec<_> = statement.words.iter().map(String::as_str).collect();
    let [_, function @ ("greater" | "greater_equal"), value, ..] = words[..] else { return Ok(None) };
    match value.parse::<f32>() {
        Ok(value) if (0.0..=255.0).contains(&value) => {
            let least = if function == "greater" { value + 0.5 } else { value };
            Ok(Some(TextureAlpha::CutOut { least: (least / 255.0).min(1.0) }))
        }
        _ => Err(problem(
            path,
            statement.line,
            format!("'{}': '{value}' is not a number from 0 to 255", words.join(" ")),
            "write alpha_rejection greater 128",
        )),
    }
}

/// Reads `scale u v` as numbers of repetitions.
fn repeat(statement: &Statement, path: &Path) -> Result<[f32; 2], Problem> {
    match values(statement, path)?[..] {
        [u, v, ..] if u != 0.0 && v != 0.0 => Ok([1.0 / u, 1.0 / v]),
        _ => Err(problem(
            path,
            statement.line,
            format!("'{}': not a scale", statement.words.join(" ")),
            "write two numbers other than 0",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_may_have_a_third_number() {
        let script = "material M { technique { pass { texture_unit { texture a.png\n scale 0.5 2 1 } } } }";
        assert_eq!(parse(script, Path::new("m.material")).unwrap()[0].texture_repeat, Some([2.0, 0.5]));
    }

    const SCRIPT: &str = "
        // tags
        material Base
        {
          technique { pass {
            ambient 0.5 0.5 0.5 1
            diffuse 1 0 0 0.5
            specular 0.1 0.2 0.3 1 12.5
            alpha_rejection greater 127
            texture_unit paint { texture base.png
              scale 0.5 0.5 }
          } }
        }
        /* one
           more */ material Tags/One : Base
        {
          technique t
          {
            pass
            {
              texture_unit
              {
                texture \"one 1.png\"
              }
            }
          }
        }
        vertex_program x glsl { source a.vert }
    ";

    #[test]
    fn inherits_what_is_not_said() {
        let materials = parse(SCRIPT, Path::new("a.material")).unwrap();
        assert_eq!(materials.len(), 2);
        let mut diagnostics = Diagnostics::default();
        let one = Library::new(materials).inherited("Tags/One", &mut diagnostics).unwrap();
        assert_eq!((one.diffuse, one.alpha), (Some([1.0, 0.0, 0.0]), Some(0.5)));
        assert_eq!(one.specular, Some([0.1, 0.2, 0.3, 12.5]));
        assert_eq!(one.texture_alpha, Some(TextureAlpha::CutOut { least: 0.5 }));
        let (file, source) = one.texture.unwrap();
        assert_eq!((file.as_str(), source.to_string().as_str()), ("one 1.png", "a.material:23"));
        assert_eq!(one.texture_repeat, Some([2.0, 2.0]));
        assert!(diagnostics.problems().is_empty());
    }

    #[test]
    fn errors_name_their_line() {
        for (script, line) in [
            ("material A\n{\n technique {", 3),
            ("}\n", 1),
            ("material A\n{ technique { pass {\n diffuse 1 nan 0\n} } }", 3),
            ("material A { technique { pass { texture_unit {\n scale 0 1 } } } }", 2),
            ("material A { technique { pass {\n\n specular 1 1 1 } } }", 3),
            ("material A { technique { pass {\n alpha_rejection greater 256 } } }", 2),
            ("material {\n}", 1),
            (&format!("material A\n{}", "{".repeat(2_000_000)), 2),
        ] {
            let problem = parse(script, Path::new("a.material")).unwrap_err();
            assert_eq!(problem.source.line, line, "{script}: {problem}");
        }
    }

    #[test]
    fn a_circle_of_parents_is_an_error() {
        let materials = parse("material A : B {}\nmaterial B : A {}", Path::new("a.material")).unwrap();
        let mut diagnostics = Diagnostics::default();
        Library::new(materials).inherited("A", &mut diagnostics);
        assert!(diagnostics.has_errors());
    }
}

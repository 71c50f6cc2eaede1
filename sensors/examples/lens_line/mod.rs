//! Parses a lens from one line of text: its model, fx fy cx cy skew, and the model's parameters. Those of `wide_angle`
//! are c1 c2 c3 f, fun (id, sin or tan) and the cutoff angle. An equirectangular lens has only width and height.

use belvedere_sensors::optics::{
    AngleFunction, BrownConrady, DoubleSphere, Equirectangular, Eucm, Intrinsics, KannalaBrandt, Lens,
    Mapping, Mei, Pinhole, WideAngle,
};
use std::error::Error;

/// Parses words as numbers.
pub(crate) fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vec<f64>, Box<dyn Error>> {
    words.map(|word| word.parse().map_err(|_| format!("`{word}` is not a number").into())).collect()
}

/// The lens that a line describes.
pub(crate) fn parse_lens(line: &str) -> Result<Box<dyn Lens>, Box<dyn Error>> {
    let mut words: Vec<&str> = line.split_whitespace().collect();
    if words.is_empty() {
        return Err("the first line is empty: it must be a model and its parameters".into());
    }
    let model = words.remove(0);
    // This is the only word among numbers.
    let function =
        words.iter().position(|word| ["id", "sin", "tan"].contains(word)).map(|at| words.remove(at));
    let all = numbers(words.into_iter())?;
    if let ("equirectangular", &[width, height]) = (model, &all[..]) {
        return Ok(Box::new(Equirectangular::new(width as u32, height as u32)?));
    }
    let &[fx, fy, cx, cy, skew, ref parameters @ ..] = &all[..] else {
        return Err(format!("`{model}` must be followed by fx fy cx cy skew and its parameters").into());
    };
    let intrinsics = Intrinsics { fx, fy, cx, cy, skew };
    Ok(match (model, parameters, function) {
        ("pinhole", [], None) => Box::new(Pinhole::new(intrinsics)?),
        ("brown_conrady", coefficients, None) => Box::new(BrownConrady::new(intrinsics, coefficients)?),
        ("kannala_brandt", &[k1, k2, k3, k4], None) => {
            Box::new(KannalaBrandt::new(intrinsics, [k1, k2, k3, k4])?)
        }
        ("eucm", &[alpha, beta], None) => Box::new(Eucm::new(intrinsics, alpha, beta)?),
        ("double_sphere", &[xi, alpha], None) => Box::new(DoubleSphere::new(intrinsics, xi, alpha)?),
        ("mei", &[xi, k1, k2, p1, p2], None) => Box::new(Mei::new(intrinsics, xi, [k1, k2, p1, p2])?),
        ("wide_angle", &[c1, c2, c3, f, cutoff], Some(function)) => {
            let fun = match function {
                "id" => AngleFunction::Identity,
                "sin" => AngleFunction::Sin,
                _ => AngleFunction::Tan,
            };
            Box::new(WideAngle::new(intrinsics, Mapping { c1, c2, c3, f, fun }, cutoff)?)
        }
        _ => return Err(format!("there is no lens `{model}` with {} parameters", parameters.len()).into()),
    })
}

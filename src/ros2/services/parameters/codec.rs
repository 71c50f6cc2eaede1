//! Requests and responses of the parameter services, in CDR.

use super::MOST_PARAMETERS;
use super::table::{Parameter, Value};
use crate::ros2::cdr::{Cdr, Unreadable};
use belvedere_bridge::RosBytes;

/// The most elements of an array that a request gives for a parameter. No parameter is an array.
const MOST_ELEMENTS: usize = 100_000;

/// Reads a value.
fn read(from: &mut Cdr<'_>) -> Result<Value, Unreadable> {
    let number = from.u8()?;
    let (bool, integer, double) = (from.bool()?, from.i64()?, from.f64()?);
    from.text()?;
    // Arrays of bytes and bools, of integers and doubles, and of strings.
    from.list(MOST_ELEMENTS, Cdr::u8)?;
    from.list(MOST_ELEMENTS, Cdr::u8)?;
    from.list(MOST_ELEMENTS, Cdr::i64)?;
    from.list(MOST_ELEMENTS, Cdr::f64)?;
    from.list(MOST_ELEMENTS, Cdr::text)?;
    Ok(match number {
        0 => Value::NotSet,
        1 => Value::Bool(bool),
        2 => Value::Integer(integer),
        3 => Value::Double(double),
        other => Value::of_other_type(other),
    })
}

/// Writes a value.
fn write(value: Value, to: &mut RosBytes<'_>) {
    to.u8(value.number());
    to.u8(u8::from(value == Value::Bool(true)));
    to.i64(if let Value::Integer(number) = value { number } else { 0 });
    to.f64(if let Value::Double(number) = value { number } else { 0.0 });
    to.text("");
    for _array in 0..5 {
        to.count(0);
    }
}

/// Reads the names of a request.
pub(super) fn names(body: &[u8]) -> Result<Vec<&str>, Unreadable> {
    Cdr::new(body)?.list(MOST_PARAMETERS, Cdr::text)
}

/// Reads the prefixes of a request, and how many levels below them are wanted; 0 for all.
pub(super) fn prefixes(body: &[u8]) -> Result<(Vec<&str>, u64), Unreadable> {
    let mut from = Cdr::new(body)?;
    Ok((from.list(MOST_PARAMETERS, Cdr::text)?, from.u64()?))
}

/// Reads the parameters of a request.
pub(super) fn parameters(body: &[u8]) -> Result<Vec<(&str, Value)>, Unreadable> {
    Cdr::new(body)?.list(MOST_PARAMETERS, |from| Ok((from.text()?, read(from)?)))
}

/// Writes a list of texts.
pub(super) fn write_texts(to: &mut RosBytes<'_>, texts: &[&str]) {
    to.count(texts.len());
    for text in texts {
        to.text(text);
    }
}

/// Writes the values of parameters; those that do not exist are not set.
pub(super) fn write_values(to: &mut RosBytes<'_>, found: &[Option<&Parameter>]) {
    to.count(found.len());
    for found in found {
        write(found.map_or(Value::NotSet, |known| known.value), to);
    }
}

/// Writes the types of parameters; those that do not exist are not set.
pub(super) fn write_types(to: &mut RosBytes<'_>, found: &[Option<&Parameter>]) {
    to.count(found.len());
    for found in found {
        to.u8(found.map_or(Value::NotSet, |known| known.value).number());
    }
}

/// Writes the description of a parameter, or for one that does not exist, why not.
pub(super) fn write_descriptor(to: &mut RosBytes<'_>, name: &str, found: Result<&Parameter, String>) {
    let (value, description, setting) = match found {
        Ok(known) => (known.value, known.description.to_owned(), known.setting),
        Err(reason) => (Value::NotSet, reason, None),
    };
    to.text(name);
    to.u8(value.number());
    to.text(&description);
    to.text("");
    to.u8(u8::from(setting.is_none()));
    // The type never changes.
    to.u8(0);
    to.count(usize::from(setting.is_some()));
    if let Some(setting) = setting {
        // Every number between the limits is allowed.
        for number in [setting.min, setting.max, 0.0] {
            to.f64(number);
        }
    }
    to.count(0);
}

/// Writes parameters with their values.
pub(super) fn write_parameters(to: &mut RosBytes<'_>, parameters: &[(&str, Value)]) {
    to.count(parameters.len());
    for (name, value) in parameters {
        to.text(name);
        write(*value, to);
    }
}

/// Writes the result of a change.
pub(super) fn write_result(to: &mut RosBytes<'_>, result: &Result<(), String>) {
    to.u8(u8::from(result.is_ok()));
    to.text(result.as_ref().err().map_or("", String::as_str));
}

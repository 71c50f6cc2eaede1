//! `'…' % values`, like C's printf.

use super::format::{Spec, truncated};
use super::items::printed;
use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::Value;
use num_bigint::BigInt;
use num_traits::Signed;
use std::iter::Peekable;
use std::str::Chars;

/// The values that a template uses, one after the other.
struct Values<'a> {
    all: &'a [Value],
    next: usize,
    /// The dictionary in which `%(name)s` is looked up.
    map: Option<&'a Value>,
}

fn bad(template: &str, what: &str) -> Fault {
    let shown = Value::text(template).shown();
    Fault::new(
        format!("'{shown}' % …: {what}"),
        "give as many values as there are % in the text, %% for a plain %",
    )
}

/// Fills the placeholders of a template.
pub(super) fn format(template: &str, values: &Value, work: &Work) -> Result<String, Fault> {
    let single = [values.clone()];
    let (all, is_tuple) = match values {
        Value::Tuple(tuple) => (tuple.items.as_slice(), true),
        _ => (single.as_slice(), false),
    };
    let map = if let Value::Map(_) = values { Some(values) } else { None };
    let mut values = Values { all, next: 0, map };
    let mut out = String::new();
    let mut rest = template.chars().peekable();
    let mut uses_names = false;
    while let Some(c) = rest.next() {
        if c != '%' {
            out.push(c);
        } else if rest.peek() == Some(&'%') {
            rest.next();
            out.push('%');
        } else {
            uses_names |= place(template, &mut rest, &mut values, &mut out)?;
            work.take(1 + sized(out.len())? / 64)?;
        }
    }
    // An unused dictionary or list is not an error.
    let may_be_left = uses_names || (!is_tuple && matches!(values.all, [Value::Map(_) | Value::List(_)]));
    if values.next < values.all.len() && !may_be_left {
        return Err(bad(template, "there are more values than placeholders"));
    }
    Ok(out)
}

impl Values<'_> {
    fn take(&mut self, template: &str) -> Result<Value, Fault> {
        let value = self
            .all
            .get(self.next)
            .ok_or_else(|| bad(template, "there are fewer values than placeholders"))?;
        self.next += 1;
        Ok(value.clone())
    }
}

/// Reads a number of digits, or the `*` that takes it from the values.
fn count(template: &str, rest: &mut Peekable<Chars<'_>>, values: &mut Values<'_>) -> Result<i64, Fault> {
    if rest.next_if_eq(&'*').is_some() {
        let value = values.take(template)?;
        return value.small_integer().ok_or_else(|| bad(template, "'*' needs an integer"));
    }
    let mut count = 0_i64;
    while let Some(digit) = rest.peek().and_then(|c| c.to_digit(10)) {
        rest.next();
        count = count.saturating_mul(10).saturating_add(i64::from(digit));
    }
    Ok(count)
}

/// Writes one placeholder, and returns true if it names its value.
fn place(
    template: &str,
    rest: &mut Peekable<Chars<'_>>,
    values: &mut Values<'_>,
    out: &mut String,
) -> Result<bool, Fault> {
    let mut named = None;
    if rest.next_if_eq(&'(').is_some() {
        let mut name = String::new();
        let mut depth = 1;
        for c in rest.by_ref() {
            depth += i32::from(c == '(') - i32::from(c == ')');
            if depth == 0 {
                break;
            }
            name.push(c);
        }
        let map =
            values.map.filter(|_| depth == 0).ok_or_else(|| bad(template, "'%(' needs a dictionary"))?;
        let Value::Map(map) = map else { return Err(bad(template, "'%(' needs a dictionary")) };
        let key = super::key(&Value::text(name.as_str()))?;
        let value = map.entries.borrow().get(&key).cloned();
        named = Some(value.ok_or_else(|| bad(template, &format!("the dictionary has no '{name}'")))?);
    }
    let mut flags = String::new();
    while let Some(flag) = rest.next_if(|c| "-+ 0#".contains(*c)) {
        if !flags.contains(flag) {
            flags.push(flag);
        }
    }
    let mut width = count(template, rest, values)?;
    let mut is_left = flags.contains('-');
    if width < 0 {
        is_left = true;
        width = width.saturating_neg();
    }
    let precision =
        if rest.next_if_eq(&'.').is_some() { Some(count(template, rest, values)?.max(0)) } else { None };
    while rest.next_if(|c| "hlL".contains(*c)).is_some() {}
    let kind = rest.next().ok_or_else(|| bad(template, "a placeholder is incomplete"))?;
    let is_named = named.is_some();
    let value = match named {
        Some(value) => value,
        None => values.take(template)?,
    };
    let sign = if flags.contains('+') {
        Some('+')
    } else if flags.contains(' ') {
        Some(' ')
    } else {
        None
    };
    let is_zero = flags.contains('0') && !is_left;
    let spec = Spec {
        fill: is_zero.then_some('0'),
        align: Some(match (is_left, is_zero) {
            (true, _) => '<',
            (_, true) => '=',
            _ => '>',
        }),
        sign,
        is_zero: false,
        is_alternate: flags.contains('#'),
        width: usize::try_from(width).unwrap_or(usize::MAX),
        grouping: None,
        precision: precision.map(|precision| usize::try_from(precision).unwrap_or(usize::MAX)),
        kind: Some(kind),
    };
    spec.check()?;
    out.push_str(&conversion(template, kind, &value, spec)?);
    Ok(is_named)
}

fn conversion(template: &str, kind: char, value: &Value, spec: Spec) -> Result<String, Fault> {
    let wrong = || bad(template, &format!("%{kind} cannot write {} ('{}')", value.kind(), value.shown()));
    let plain = |spec: Spec| Spec {
        fill: None,
        align: spec.align.map(|align| if align == '=' { '>' } else { align }),
        sign: None,
        is_alternate: false,
        ..spec
    };
    match kind {
        's' => plain(spec).text(&printed(value)?),
        'r' | 'a' => {
            let text = if let Value::Text(_) = value { value.repr() } else { printed(value)? };
            if kind == 'a' && !text.is_ascii() {
                return Err(wrong());
            }
            plain(spec).text(&text)
        }
        'c' => match value {
            Value::Text(text) if text.chars().count() == 1 => {
                plain(Spec { precision: None, ..spec }).text(text)
            }
            Value::Int(_) | Value::Bool(_) => {
                let spec = Spec { precision: None, ..plain(spec) };
                spec.integer(&value.integer().ok_or_else(wrong)?, value)
            }
            _ => Err(wrong()),
        },
        'd' | 'i' | 'u' => {
            let int = truncated(value).ok_or_else(wrong)?;
            integer(&int, value, &Spec { kind: Some('d'), is_alternate: false, ..spec })
        }
        'x' | 'X' | 'o' => integer(&value.integer().ok_or_else(wrong)?, value, &spec),
        'e' | 'E' | 'f' | 'F' | 'g' | 'G' => spec.float(
            value
                .number()
                .filter(|float| float.is_finite() || matches!(value, Value::Float(_)))
                .ok_or_else(wrong)?,
            value,
        ),
        other => Err(bad(template, &format!("'%{other}' has no meaning"))),
    }
}

/// Formats an integer. The precision is the minimum number of digits.
fn integer(int: &BigInt, value: &Value, spec: &Spec) -> Result<String, Fault> {
    let Some(precision) = spec.precision else { return spec.integer(int, value) };
    let bare = Spec { kind: spec.kind, ..Spec::default() };
    let digits = bare.integer(&int.abs(), value)?;
    let prefix = match spec.kind {
        Some('x') if spec.is_alternate => "0x",
        Some('X') if spec.is_alternate => "0X",
        Some('o') if spec.is_alternate => "0o",
        _ => "",
    };
    let sign = match spec.sign {
        _ if int.is_negative() => "-",
        Some('+') => "+",
        Some(_) => " ",
        None => "",
    };
    let zeros = "0".repeat(precision.saturating_sub(digits.len()));
    let text = format!("{zeros}{digits}");
    let missing = spec.width.saturating_sub(sign.len() + prefix.len() + text.len());
    Ok(match spec.align {
        Some('<') => format!("{sign}{prefix}{text}{}", " ".repeat(missing)),
        Some('=') => format!("{sign}{prefix}{}{text}", "0".repeat(missing)),
        _ => format!("{}{sign}{prefix}{text}", " ".repeat(missing)),
    })
}

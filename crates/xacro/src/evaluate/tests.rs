use super::*;
use crate::expression::parse;

struct Table(usize);

impl Names for Table {
    fn get(&mut self, name: &str) -> Result<Option<Value>, Fault> {
        Ok(match name {
            "x" => Some(Value::int(7)),
            "words" => Some(Value::text("a b c")),
            _ => None,
        })
    }
    fn call(&mut self, _: &str, _: &Arguments) -> Option<Result<Value, Fault>> {
        None
    }
    fn undefined(&self, name: &str) -> Fault {
        Fault::new(format!("undefined property '{name}'"), "")
    }
    fn enter(&mut self, levels: usize) -> Result<(), Fault> {
        self.0 += levels;
        if self.0 > 700 { Err(Fault::new("this is nested more than 300 deep", "")) } else { Ok(()) }
    }
    fn leave(&mut self, levels: usize) {
        self.0 -= levels;
    }
}

fn eval(text: &str) -> String {
    let value = parse(text).and_then(|expression| evaluate(&expression, &mut Table(0), &Work::default()));
    match value.and_then(|value| functions::printed(&value)) {
        Ok(value) => value,
        Err(fault) => format!("error: {}", fault.what),
    }
}

#[test]
fn names_are_found() {
    for (text, printed) in [
        ("60.0*M_PI/180.0", "1.0471975511965976"),
        ("'yes' if x > 5 else 'no'", "yes"),
        ("x and 0 or 'fallback'", "fallback"),
        ("words.split()[-1]", "c"),
        ("'a' + str(x) + \"b\"", "a7b"),
        ("radians(180) == pi", "True"),
        ("math.sqrt(2)", "1.4142135623730951"),
        ("sum(range(5))", "10"),
        ("python.abs(-x)", "7"),
        ("[x for x in 'ab'] + [x]", "['a', 'b', 7]"),
    ] {
        assert_eq!(eval(text), printed, "{text}");
    }
}

#[test]
fn faults_are_reported() {
    for (text, error) in [
        ("y", "undefined property 'y'"),
        ("y.strip()", "undefined property 'y'"),
        ("1/0", "division by zero"),
        ("1 +", "ends too early"),
        ("(1", "')' is missing"),
        ("é §", "has no meaning"),
        ("'a' + 1", "do not go together"),
        ("foo(1)", "unknown function 'foo'"),
        ("[1][4]", "outside"),
        ("'a' < 1", "no order"),
        ("", "ends too early"),
        ("1 2", "not expected"),
        ("sqrt(-1)", "sqrt(-1)"),
        ("010", "leading zero"),
        ("1_", "not a number"),
        ("2j", "complex"),
        ("f'{x}'", "f-strings"),
        ("(y := 3)", "':='"),
        ("{1, 2}", "no order"),
        ("list({1, 2})", "no order"),
        ("map(str, [1])", "differs in each run"),
        ("len", "differs in each run"),
        ("x.__class__", "two underscores"),
        ("{[1]: 2}", "cannot be a key"),
        ("'%d' % 'a'", "%d cannot write"),
        ("'%s %s' % 1", "fewer values"),
        ("'%s' % (1, 2)", "more values"),
        ("'{}'.format()", "no value"),
        ("'{'.format()", "not closed"),
        ("lambda: 1", "differs in each run"),
        ("(lambda a: a)()", "no value for 'a'"),
        ("[i for i, j in [1]]", "no items"),
        ("for", "not expected"),
        ("1 if 2", "without 'else'"),
        ("{'a': 1}.a", "no attribute 'a'"),
        ("sorted([1, 'a'])", "no order"),
        ("sorted([1, nan])", "no order"),
        ("(lambda l: l.append(l))([])", "nested too deeply"),
        ("'é'.isdigit() or '½'.isdigit()", "is a digit is not known"),
    ] {
        let result = eval(text);
        assert!(result.starts_with("error:") && result.contains(error), "{text}: {result}");
    }
}

#[test]
fn unlimited_growth_is_a_fault() {
    for (text, error) in [
        ("'a' * 10**9", "grows beyond"),
        ("[0] * 10**9", "grows beyond"),
        ("2 ** 10**9", "14000 bits"),
        ("1 << 10**9", "14000 bits"),
        ("3 ** 10**30", "14000 bits"),
        ("'%1000000000d' % 1", "grows beyond"),
        ("'%.1000000000f' % 1", "precision"),
        ("'%*d' % (10**9, 1)", "grows beyond"),
        ("'{:1000000000}'.format(1)", "grows beyond"),
        ("'{:.1000000000f}'.format(1.0)", "precision"),
        ("'a'.ljust(10**9)", "grows beyond"),
        ("'a'.zfill(10**9)", "grows beyond"),
        ("[i for i in range(10**9)]", "grows beyond"),
        ("list(range(10**12))", "grows beyond"),
        ("sum(i for i in range(10**9))", "grows beyond"),
        ("[[i for i in range(1000)] for j in range(1000)]", "grows beyond"),
        ("max(len([i for i in range(90000)]) for j in range(90000))", "steps"),
        ("(lambda f: f(f))(lambda f: f(f))", "more than 300 deep"),
        ("(lambda f: f(f, 1))(lambda f, n: f(f, n + 1) + 1)", "more than 300 deep"),
        ("(lambda l: [l.append(1) for i in range(10**7)])([])", "grows beyond"),
        ("(lambda l: [l.append('a' * 4000) for i in range(90000)] and 0)([])", "steps"),
        ("(lambda l: [l.extend(l) for i in range(90)])([1])", "grows beyond"),
        ("factorial(10**9)", "14000 bits"),
        ("comb(10**9, 10**8)", "14000 bits"),
        ("int('9' * 100000)", "has no value"),
        ("'a'.replace('', 'b' * 1000000).replace('', 'b' * 10)", "grows beyond"),
        ("'ab'.join(['c' * 1000] * 100000)", "grows beyond"),
        ("round(1, -10**9)", "14000 bits"),
        ("'\\t'.expandtabs(10**9)", "grows beyond"),
    ] {
        let begin = std::time::Instant::now();
        let result = eval(text);
        assert!(result.starts_with("error:") && result.contains(error), "{text}: {result}");
        assert!(begin.elapsed().as_secs() < 60, "{text}: {:?}", begin.elapsed());
    }
    for text in [
        "(".repeat(100_000),
        "1+".repeat(100_000),
        "-".repeat(900),
        "[".repeat(900),
        "not ".repeat(900),
        "lambda:".repeat(300),
        "[1 for a in ".repeat(200),
        "1**".repeat(400),
        "1 if 1 else ".repeat(200),
    ] {
        assert!(eval(&text).contains("error"));
    }
    // A chain of the greatest allowed length.
    assert_eq!(eval(&("1+".repeat(499) + "1")), "500");
    let deep = "(lambda f: f(f, 25))(lambda f, n: f(f, n - 1) + 1 if n > 0 else 0)";
    assert_eq!(eval(deep), "25");
}

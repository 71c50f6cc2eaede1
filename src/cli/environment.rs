//! Parses a command line whose options may also come from environment variables.
//!
//! clap treats a value from the environment like one that was typed: its messages show the option as if it was needed,
//! and it conflicts with options that were typed. A user who has set a variable once for all commands knows neither.

use clap::builder::Resettable;
use clap::error::ErrorKind;
use clap::{Arg, Command, Parser};
use std::ffi::OsString;

/// Parses a command line. An option that is typed takes precedence over a variable of an option that it excludes.
///
/// # Errors
/// Those of clap, in which no option appears that was not typed.
pub(super) fn parse<C: Parser>(words: &[OsString]) -> Result<C, clap::Error> {
    let error = match C::try_parse_from(words) {
        Err(error) if error.use_stderr() => error,
        parsed => return parsed,
    };
    let again = |is_left_out: fn(&Command, &Arg) -> bool| {
        let matches = without(C::command(), is_left_out).try_get_matches_from(words);
        matches.and_then(|mut matches| C::from_arg_matches_mut(&mut matches))
    };
    if error.kind() == ErrorKind::ArgumentConflict
        && let Ok(parsed) = again(is_excluded_by_another)
    {
        return Ok(parsed);
    }
    match again(|_, _| true) {
        Err(typed) if typed.kind() == error.kind() => Err(typed),
        // The value of a variable is wrong.
        _ => Err(error),
    }
}

/// Returns a command and its subcommands without the variables of some options.
fn without(command: Command, is_left_out: fn(&Command, &Arg) -> bool) -> Command {
    let left_out: Vec<String> = command
        .get_arguments()
        .filter(|arg| arg.get_env().is_some() && is_left_out(&command, arg))
        .map(|arg| arg.get_id().to_string())
        .collect();
    command
        .mut_args(|arg| {
            let is_named = left_out.iter().any(|id| arg.get_id() == id.as_str());
            if is_named { arg.env(Resettable::Reset) } else { arg }
        })
        .mut_subcommands(|inner| without(inner, is_left_out))
}

/// Returns true if another option cannot be combined with this one.
fn is_excluded_by_another(command: &Command, arg: &Arg) -> bool {
    command.get_arguments().any(|other| {
        command.get_arg_conflicts_with(other).iter().any(|excluded| excluded.get_id() == arg.get_id())
    })
}

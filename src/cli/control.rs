//! `belvedere control`: pauses, steps and resets a running simulation, moves, adds and removes models, and changes
//! sensor settings.

mod order;
mod report;

use super::error::CliError;
use super::follow::{DomainArgs, check_topics, print_line, seconds};
use belvedere_bridge::{Node, SimulationControl};
use order::Order;
use report::Report;
use std::time::Duration;

/// Control a running simulation.
///
/// Commands are applied between two frames. Each prints the simulated time at which it was applied. A command that is
/// refused prints the reason and exits with code 1.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere control pause
  belvedere control step 100
  belvedere control query crate
  belvedere control move crate 1.5,0,0.1,90
  belvedere control spawn crate.sdf --name second_crate --pose 2,0,0.5,0
  belvedere control spawn my_robot.urdf.xacro use_camera:=true --namespace carl
  belvedere control delete second_crate
  belvedere control configure camera1 update_rate=15 exposure=0.5
  belvedere control reset --domain lab")]
pub struct ControlArgs {
    #[command(subcommand)]
    what: What,
    #[command(flatten)]
    global: GlobalArgs,
}

#[derive(Clone, Debug, clap::Args)]
struct GlobalArgs {
    #[command(flatten)]
    domain: DomainArgs,
    /// How long to wait for the simulator's answer
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "5", global = true)]
    timeout: Duration,
}

impl GlobalArgs {
    fn no_answer(&self) -> CliError {
        CliError::NoAnswer { domain: self.domain.domain.clone(), waited: self.timeout }
    }
}

#[derive(Clone, Debug, clap::Subcommand)]
enum What {
    #[command(flatten)]
    Order(Order),
    #[command(flatten)]
    Report(Report),
}

/// Runs the command.
///
/// # Errors
/// [`CliError::NoSimulator`], [`CliError::Refused`] with the simulator's reason, [`CliError::NoAnswer`]; a file that
/// cannot be read or does not describe a model; failures of the bridge and of standard output.
pub fn run(args: &ControlArgs) -> Result<(), CliError> {
    let node = Node::open(&args.global.domain.domain, "belvedere control")?;
    check_topics(&node, &args.global.domain.domain, &[])?;
    match &args.what {
        What::Order(order) => send(order, &node, &args.global),
        What::Report(report) => report.print(&node, &args.global),
    }
}

/// Sends an order and prints the simulated time at which it was applied.
fn send(order: &Order, node: &Node, global: &GlobalArgs) -> Result<(), CliError> {
    let message = order.message()?;
    let result = SimulationControl::open(node)?.call(&message.command, &message.text, global.timeout)?;
    let result = result.ok_or_else(|| global.no_answer())?;
    let operation = order.word();
    if result.done != 1 {
        return Err(CliError::Refused { operation, reason: order.refusal(&message, result.reason.as_str()) });
    }
    print_line(&format!("{operation}: done at {:.9} s", result.time_ns as f64 * 1e-9))
}

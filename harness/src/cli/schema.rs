//! `gravel schema`: JSON schemas of plans, cases and problems, for editors.

use crate::cli::keys;
use crate::plan::{Entry, Plan, PlannedMethod, methods};
use crate::terminal::{say, say_table};
use anyhow::Result;
pub(crate) use cases::schema as of;
use cases::{Case, Frozen};
use clap::ValueEnum;
use contact::{Discs, RoughDiscs, RoughSpheres, Spheres};
use serde_json::{Map, Value, json};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Kind of file that the schema describes
    what: What,
    /// The keys as a table of Markdown: what each takes, whether it may be left out, and what it means
    #[arg(long)]
    markdown: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum What {
    /// harness/plans/*.toml
    Plan,
    /// cases/*.toml
    Case,
    /// cases/frozen/*.json: the file of a contact problem
    Problem,
    /// The file of a contact problem with friction
    RoughProblem,
    /// The file of a contact problem of spheres
    SphereProblem,
    /// The file of a contact problem of spheres with friction
    RoughSphereProblem,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let schema = match args.what {
        What::Plan => plan(),
        What::Case => of::<Case>(),
        What::Problem => Frozen::<Discs>::schema(),
        What::RoughProblem => Frozen::<RoughDiscs>::schema(),
        What::SphereProblem => Frozen::<Spheres>::schema(),
        What::RoughSphereProblem => Frozen::<RoughSpheres>::schema(),
    };
    if args.markdown {
        return say_table(&["key", "takes", "means"], &keys::rows(&schema));
    }
    say(format_args!("{}", serde_json::to_string_pretty(&schema)?))
}

/// The methods with their settings; and, in the quick form, the plan's keys once more.
fn plan() -> Value {
    let mut plan = of::<Plan>();
    plan["properties"]["methods"]["items"] =
        json!({ "oneOf": methods().map(planned_method).collect::<Vec<_>>() });
    let mut quick = plan["properties"].clone();
    if let Some(keys) = quick.as_object_mut() {
        keys.remove("name");
        keys.remove("quick");
        // Their keys replace those of the plan one by one.
        for table in ["stop", "simulate"] {
            keys[table].as_object_mut().into_iter().for_each(|table| drop(table.remove("required")));
        }
    }
    plan["properties"]["quick"]["properties"] = quick;
    plan["properties"]["quick"]["additionalProperties"] = false.into();
    plan
}

fn planned_method(entry: Entry) -> Value {
    let settings = entry.settings();
    let axes: Map<String, Value> = settings.iter().map(|(key, value)| (key.clone(), axis(value))).collect();
    let mut method = of::<PlannedMethod>();
    let keys = &mut method["properties"];
    keys["method"] = json!({ "const": entry.name(), "description": entry.what() });
    for (table, settings) in [("set", settings), ("zip", axes.clone()), ("axes", axes)] {
        keys[table]["properties"] = settings.into();
        keys[table]["additionalProperties"] = false.into();
    }
    method
}

/// A list of values, or a range.
fn axis(value: &Value) -> Value {
    json!({ "anyOf": [
        { "type": "array", "items": value, "minItems": 1 },
        { "type": "string", "pattern": r"^(lin|geom)\(.*\)$|^-?[0-9]+\.\.-?[0-9]+$" },
    ] })
}

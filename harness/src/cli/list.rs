//! `gravel list`: what there is.

use crate::cli::schema::takes;
use crate::plan::{Plan, methods};
use crate::problems::{Kind, Root, size, stem};
use crate::terminal::say;
use anyhow::Result;
use cases::{Case, Frozen};
use clap::ValueEnum;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// What to list
    what: What,
}

#[derive(Clone, Copy, ValueEnum)]
enum What {
    /// Cases, and the problems that were frozen from them
    Cases,
    /// Methods, with their settings and defaults
    Methods,
    /// Plans
    Plans,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    match args.what {
        What::Cases => {
            say(format_args!("cases"))?;
            for path in root.all(Kind::Case)? {
                say(format_args!("  {:<24}{}", stem(&path), Case::read(&path, &[])?.why))?;
            }
            say(format_args!("frozen problems"))?;
            for path in root.all(Kind::Frozen)? {
                let frozen = Frozen::read(&path)?;
                say(format_args!("  {:<24}{}", stem(&path), size(&frozen.problem)))?;
            }
        }
        What::Methods => {
            for entry in methods() {
                say(format_args!("{:<16}{}", entry.name, entry.what))?;
                if let Some(external) = entry.external() {
                    match external.version() {
                        Ok(version) => say(format_args!("      another code, installed: {version}"))?,
                        Err(why) => {
                            say(format_args!(
                                "      another code, not installed ({why}); this installs it:"
                            ))?;
                            say(format_args!("          {}", external.install()))?;
                        }
                    }
                }
                let settings = entry.settings();
                for (key, default) in entry.defaults()? {
                    let default = if default.is_null() { "none".to_owned() } else { default.to_string() };
                    let setting = &settings[&key];
                    say(format_args!("  {key} = {default}: {}", takes(setting)))?;
                    say(format_args!("      {}", setting["description"].as_str().unwrap_or_default()))?;
                }
            }
        }
        What::Plans => {
            for path in root.all(Kind::Plan)? {
                say(format_args!("{:<20}{}", stem(&path), Plan::read(&path, false)?.why))?;
            }
        }
    }
    Ok(())
}

//! `ferntast link keys`.

use std::{path::PathBuf, process::ExitCode};

use clap::Subcommand;
use ferntast_nodes::process::link_keys::{LinkKeyError, LinkKeys};
use serde_json::json;

use crate::output::{Failure, print_json};

/// Make, show and exchange the keys without which two hosts do not meet.
///
/// As with ssh and WireGuard, each host has a private key, which stays there, and a
/// public one, which others may know. An arm obeys the hosts whose keys it was given,
/// and an operator's end talks to no other arm.
#[derive(Debug, clap::Args)]
#[command(after_help = "On both hosts:\n  \
    ferntast link keys new\n\
Then on the operator's host, with the key that the arm's host has shown, and the other way round:\n  \
    ferntast link keys add arm KEY\n  \
    ferntast link keys add operator KEY\n\
A session whose ends are on one host needs none of this.")]
pub struct Arguments {
    #[command(subcommand)]
    what: What,

    /// Folder with the keys (else FERNTAST_LINK_KEYS, else ~/.config/ferntast/link).
    #[arg(long, value_name = "DIR", global = true)]
    keys: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Make this host's key.
    New,
    /// Show this host's public key, and the hosts that it knows.
    Show,
    /// Know another host by its public key. To know it no longer, take its line out of known_hosts in the folder.
    Add {
        /// What to call it.
        name: String,
        /// Its public key: the 88 characters that `ferntast link keys show` says there.
        key: String,
    },
}

/// Does it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let keys = LinkKeys::of(arguments.keys).map_err(Failure::refused)?;
    match arguments.what {
        What::New => {
            keys.make().map_err(Failure::refused)?;
            show(&keys, json)?;
            if !json {
                println!(
                    "On the other host: ferntast link keys add NAME KEY, with this key and a name for this host."
                );
            }
        }
        What::Show => show(&keys, json)?,
        What::Add { name, key } => {
            keys.add(&name, &key).map_err(Failure::refused)?;
            show(&keys, json)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn show(keys: &LinkKeys, json: bool) -> Result<(), Failure> {
    let refused = |error: LinkKeyError| Failure::refused(error);
    let own = keys.own().map_err(refused)?.map(|own| own.public());
    let known = keys.known().map_err(refused)?;
    let folder = keys.folder();
    if json {
        let known: Vec<_> = known
            .iter()
            .map(|(name, key)| json!({"name": name, "key": key.to_string()}))
            .collect();
        return print_json(&json!({
            "folder": folder,
            "key": own.map(|own| own.to_string()),
            "known": known,
        }));
    }
    match own {
        Some(own) => println!("{own}  this host"),
        None => println!("this host has no key yet: ferntast link keys new"),
    }
    for (name, key) in known {
        println!("{key}  {name}");
    }
    println!("(in {})", folder.display());
    Ok(())
}

//! `info`: version, vector instructions and graphics adapters.

use super::console::{print, print_json};
use super::failure::{Failure, Status};
use super::options::processors;
use crate::sim;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;

const NOTE: &str = "\
Without a graphics adapter, it names the packages to install; only bodies in space need one.";

/// Print the version, and the vector instructions and graphics adapters that are used on this machine
#[derive(Args, Debug)]
#[command(after_help = NOTE)]
pub(super) struct Info {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let threads = processors();
        let version = env!("CARGO_PKG_VERSION");
        let machine = format!("{} {}", std::env::consts::ARCH, std::env::consts::OS);
        let (instructions, bits) = sim::vectors();
        let (adapters, as_json) = graphics();
        if self.json {
            print_json(&json!({
                "version": version,
                "machine": machine,
                "threads": threads,
                "vectors": { "instructions": instructions, "bits": bits },
                "pictures": cfg!(feature = "render"),
                "adapters": as_json,
            }))?;
            return Ok(Status::Done);
        }
        let mut text = format!("localshape {version}\n");
        let mut line = |head: &str, what: &str| writeln!(text, "  {head:<12}{what}").expect("writing to a string");
        line("machine", &format!("{machine}, {threads} thread{}", if threads == 1 { "" } else { "s" }));
        line("vectors", &format!("{instructions}, {bits} bits"));
        for (number, adapter) in adapters.iter().enumerate() {
            line(if number == 0 { "adapters" } else { "" }, adapter);
        }
        print(&text)?;
        Ok(Status::Done)
    }
}

/// The graphics adapters of this machine in lines of text, and as JSON.
#[cfg(feature = "render")]
fn graphics() -> (Vec<String>, Vec<Value>) {
    let (adapters, chosen) = crate::gpu::adapters();
    if adapters.is_empty() {
        return (vec![format!("none: {}", crate::gpu::InitError::NoAdapter)], Vec::new());
    }
    let both = adapters.into_iter().enumerate().map(|(at, adapter)| {
        let is_chosen = chosen == Some(at);
        let entry = json!({
            "name": adapter.name,
            "type": adapter.device_type,
            "backend": adapter.backend,
            "driver": adapter.driver,
            "driver_info": adapter.driver_info,
            "chosen": is_chosen,
        });
        (format!("{adapter}{}", if is_chosen { ", chosen by --adapter auto" } else { "" }), entry)
    });
    both.unzip()
}

/// Without pictures no adapter is listed.
#[cfg(not(feature = "render"))]
fn graphics() -> (Vec<String>, Vec<Value>) {
    (vec!["not searched: this program was built without the feature `render`".to_owned()], Vec::new())
}

//! `info`: version, processor features and graphics adapters.

use super::console::{print, print_json};
use super::failure::{Failure, Status};
use super::options::processors;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;

const NOTE: &str = "\
If there is no graphics adapter, it says what to install; `simulate` needs none.";

/// Print the version, and the processor features and graphics adapters of this machine
#[derive(Args, Debug)]
#[command(after_help = NOTE)]
pub(super) struct Info {
    /// Print it as one JSON document
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let threads = processors();
        let version = env!("CARGO_PKG_VERSION");
        let machine = format!("{} {}", std::env::consts::ARCH, std::env::consts::OS);
        let (used, present) = processor_features();
        let (adapters, as_json) = graphics();
        if self.json {
            print_json(&json!({
                "version": version,
                "machine": machine,
                "threads": threads,
                "processor_features": { "used": used, "present": present },
                "pictures": cfg!(feature = "render"),
                "adapters": as_json,
            }))?;
            return Ok(Status::Done);
        }
        let list = |features: &[&str]| if features.is_empty() { "none".to_owned() } else { features.join(", ") };
        let mut text = format!("localshape {version}\n");
        let mut line = |head: &str, what: &str| writeln!(text, "  {head:<12}{what}").expect("writing to a string");
        line("machine", &format!("{machine}, {threads} thread{}", if threads == 1 { "" } else { "s" }));
        line("features", &format!("{} in use; the processor has {}", list(&used), list(&present)));
        for (number, adapter) in adapters.iter().enumerate() {
            line(if number == 0 { "adapters" } else { "" }, adapter);
        }
        print(&text)?;
        Ok(Status::Done)
    }
}

/// Vector features that this program was built to use, and those that the processor has.
fn processor_features() -> (Vec<&'static str>, Vec<&'static str>) {
    let (mut used, mut present) = (Vec::new(), Vec::new());
    macro_rules! look {
        ($detected:ident: $($name:tt)*) => {$(
            if cfg!(target_feature = $name) { used.push($name); }
            if std::arch::$detected!($name) { present.push($name); }
        )*};
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    look!(is_x86_feature_detected: "sse2" "sse4.1" "avx" "avx2" "fma" "avx512f");
    #[cfg(target_arch = "aarch64")]
    look!(is_aarch64_feature_detected: "neon" "sve" "sve2");
    (used, present)
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

/// Without pictures no adapter is searched for.
#[cfg(not(feature = "render"))]
fn graphics() -> (Vec<String>, Vec<Value>) {
    (vec!["not searched: this program was built without the feature `render`".to_owned()], Vec::new())
}

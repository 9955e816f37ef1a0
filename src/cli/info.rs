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
        let graphics = Graphics::find();
        if self.json {
            print_json(&json!({
                "version": version,
                "machine": machine,
                "threads": threads,
                "processor_features": { "used": used, "present": present },
                "pictures": cfg!(feature = "render"),
                "adapters": graphics.json(),
            }))?;
            return Ok(Status::Done);
        }
        let list = |features: &[&str]| if features.is_empty() { "none".to_owned() } else { features.join(", ") };
        let mut text = format!("localshape {version}\n");
        let mut line = |head: &str, what: &str| writeln!(text, "  {head:<12}{what}").expect("writing to a string");
        line("machine", &format!("{machine}, {threads} thread{}", if threads == 1 { "" } else { "s" }));
        line("features", &format!("{} in use; the processor has {}", list(&used), list(&present)));
        for (number, adapter) in graphics.lines().iter().enumerate() {
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

/// The graphics adapters of this machine and the number of the one that would be chosen.
#[cfg(feature = "render")]
struct Graphics(Vec<crate::gpu::AdapterDescription>, Option<usize>);

#[cfg(feature = "render")]
impl Graphics {
    fn find() -> Self {
        let (adapters, chosen) = crate::gpu::adapters();
        Self(adapters, chosen)
    }

    fn lines(&self) -> Vec<String> {
        if self.0.is_empty() {
            return vec![format!("none: {}", crate::gpu::InitError::NoAdapter)];
        }
        let line = |(at, adapter): (usize, &crate::gpu::AdapterDescription)| {
            let mark = if self.1 == Some(at) { ", chosen by --adapter auto" } else { "" };
            format!("{adapter}{mark}")
        };
        self.0.iter().enumerate().map(line).collect()
    }

    fn json(&self) -> Value {
        let entry = |(at, adapter): (usize, &crate::gpu::AdapterDescription)| {
            json!({
                "name": adapter.name,
                "type": adapter.device_type,
                "backend": adapter.backend,
                "driver": adapter.driver,
                "driver_info": adapter.driver_info,
                "chosen": self.1 == Some(at),
            })
        };
        self.0.iter().enumerate().map(entry).collect()
    }
}

/// Without pictures no adapter is looked for.
#[cfg(not(feature = "render"))]
struct Graphics;

#[cfg(not(feature = "render"))]
impl Graphics {
    fn find() -> Self {
        Self
    }

    fn lines(&self) -> Vec<String> {
        vec!["not searched: this program was built without the feature `render`".to_owned()]
    }

    fn json(&self) -> Value {
        json!([])
    }
}
